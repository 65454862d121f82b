/// bxCAN, the CAN controller of the STM32F1 and F4: frames leave in the order of their identifiers, and none
/// twice.
///
/// The controller has three mailboxes and sends the lowest identifier of those that are in them. That alone
/// lets three frames of low priority keep an urgent one waiting outside. So whenever a frame waits that is
/// more urgent than one in a mailbox, the least urgent mailbox is aborted; when the abort is confirmed its
/// frame waits again, in front of its equals. A mailbox whose frame is on the wire at that moment cannot be
/// emptied: then the next one is. The controller says with TXOK whether an aborted frame was sent all the
/// same, and nothing else decides it [RM0008 24.7.2].
///
/// What holds, and is tested with the bus moving on between any two accesses to a register:
/// - a frame that `send` took is sent exactly once, or counted in `dropped`;
/// - frames of one identifier are sent in the order of `send`: at most one of them is in a mailbox, because
///   among equals the controller takes the lowest mailbox, not the oldest [RM0008 24.7.2];
/// - a frame waits for at most one less urgent frame of this board, the one that is on the wire already, as
///   long as the transmit interrupt is served within a frame. One more for each frame of its own identifier
///   that goes before it: the next can only be loaded when that one is done.
///
/// Frames wait in a pool of `capacity` slots. The less urgent ones may not fill it: each priority leaves
/// `reserve` slots more to those above, so a frame is refused only by frames at least as urgent.
///
/// What the board's filters let through comes in FIFO 0. All else on the bus can be overheard in FIFO 1, with
/// an interrupt of its own: `overhear`. The board's own frames never wait behind those of others.
///
/// Not reentrant: mask the controller's interrupts, or lock, around each call. Each is bounded: O(capacity)
/// for a frame moved. 24 bytes a slot. Errors: bad_identifier, bad_length as of can::validate; and for other
/// formats than base data frames, the only ones of the robot.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bit_timing.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/identifier.hpp"

#include "firmware/drivers/bxcan_filter.hpp"
#include "firmware/drivers/bxcan_registers.hpp"

namespace ocm::firmware::drivers::bxcan {

/// One number a cause; they wrap around.
struct Counters {
  std::uint32_t sent = 0;
  std::uint32_t received = 0;
  std::uint32_t refused = 0;   ///< `send` had no room
  std::uint32_t aborted = 0;   ///< left a mailbox for a more urgent frame, and waited again
  std::uint32_t dropped = 0;   ///< taken, and given up when the bus was lost
  std::uint32_t overruns = 0;  ///< times that the receive FIFO lost a frame, or several
  std::uint32_t bus_off = 0;   ///< times
  std::uint32_t passive = 0;   ///< times
  std::uint32_t overheard = 0;
  std::uint32_t overheard_lost = 0;  ///< times that FIFO 1 lost a frame, or several
  friend constexpr bool operator==(const Counters&, const Counters&) = default;
};

/// How the controller stands with the bus. [RM0008 24.7.6]
enum class BusState : std::uint8_t { active, warning, passive, off };

/// The error counters, and the last error that was seen: 0 none, 1 stuff, 2 form, 3 no acknowledge, 4 bit
/// recessive, 5 bit dominant, 6 CRC. [RM0008 24.9.2, CAN_ESR]
struct BusErrors {
  BusState state = BusState::active;
  std::uint8_t transmit = 0;
  std::uint8_t receive = 0;
  std::uint8_t last = 0;
  friend constexpr bool operator==(const BusErrors&, const BusErrors&) = default;
};

/// A board that is error passive and for so long neither sent nor received anything counts as cut off: alone
/// on the wire it would repeat its frame for ever, unacknowledged, and never go bus-off [ISO
/// 11898-1, 13.1.4]. Some three hundred attempts at 500 kbit/s; shorter than any watchdog of an actuator.
inline constexpr base::Duration silence_limit = std::chrono::milliseconds{100};

/// How often a register is read that hardware changes within a few clocks, before it is given up.
inline constexpr unsigned patience = 64;

template <Registers R, std::size_t capacity = 24, std::size_t reserve = 4>
class Bxcan {
  static_assert(capacity > (protocol::priority_levels - 1) * reserve + mailboxes);

 public:
  constexpr explicit Bxcan(R registers) noexcept : registers_(registers) {}

  /// Sets all up and asks to join the bus, which the controller does after 11 recessive bits. Interrupts: a
  /// mailbox done, a frame received, error passive, bus-off. timed_out: the controller does not answer (no
  /// clock).
  ///
  /// Bus-off is left by hardware (ABOM), after 128 times 11 recessive bits: 2.8 ms at 500 kbit/s. The way by
  /// software leads through the initialisation mode, needs code to run at that moment, and gains nothing
  /// here: what the board does about a lost bus does not depend on it. Each time is counted.
  /// A full receive FIFO overwrites its newest frame (RFLM = 0): of two set points the later one counts.
  base::Status start(const can::BitTiming& timing, const FilterBanks& filters) noexcept {
    registers_.write(Register::mcr, mcr::inrq);  // leaves sleep, in which it is after reset
    if (!await(Register::msr, msr::inak | msr::slak, msr::inak)) return base::Error::timed_out;
    registers_.write(Register::mcr, mcr::inrq | mcr::abom);  // TXFP = 0: by identifier
    registers_.write(Register::btr, std::uint32_t{timing.sjw} << 24 | std::uint32_t{timing.ts2} << 20 |
                                        std::uint32_t{timing.ts1} << 16 | timing.brp);
    set_filters(filters);
    registers_.write(Register::ier, interrupts);
    registers_.write(Register::mcr, mcr::abom);
    return {};
  }

  /// Takes a frame; false: no room for one of this priority now.
  base::Result<bool> send(const can::Frame& frame) noexcept {
    if (const auto valid = can::validate(frame); !valid) return valid.error;
    if (frame.format != can::Format::base) return base::Error::bad_identifier;
    Slot* const slot = has_room(frame.id) ? free_slot() : nullptr;
    if (slot == nullptr) {
      ++counters_.refused;
      return false;
    }
    *slot = {frame, next_number_++, State::waiting};
    ++used_;
    pump();
    return true;
  }

  /// Whether `send` would take a frame with this identifier.
  [[nodiscard]] bool has_room(std::uint32_t id) const noexcept {
    const auto level = static_cast<std::size_t>(protocol::Identifier::decode(id).priority);
    return used_ + level * reserve < capacity;
  }

  /// To be called by the transmit interrupt (a mailbox is done).
  void on_transmit() noexcept { pump(); }

  /// The next received frame, oldest first; none: the FIFO is empty. To be called by the receive interrupt
  /// until it says so.
  std::optional<can::Frame> receive() noexcept { return take(0, counters_.received, counters_.overruns); }

  /// From now on FIFO 1 gets every frame that is not for the board, of every format, or none. Its filter was
  /// set up at the start, so that this is one bit: no frame is missed, as it would be while filters are set
  /// up [RM0008 24.7.4]. False: the board's own filters are not wide, or no bank is left.
  bool overhear(bool all) noexcept {
    if (overhearing_bank_ >= filter_banks) return false;
    const std::uint32_t active = (1U << overhearing_bank_) - 1U;  // the board's own
    registers_.write(Register::fa1r, active | (all ? 1U << overhearing_bank_ : 0U));
    registers_.write(Register::ier, interrupts | (all ? ier::fmpie1 : 0U));
    if (!all)
      for (std::size_t n = 0; n < receive_depth; ++n)
        static_cast<void>(overheard());  // not for the next time
    return true;
  }
  /// The next frame of FIFO 1; none: it is empty. To be called by its interrupt.
  std::optional<can::Frame> overheard() noexcept {
    return take(1, counters_.overheard, counters_.overheard_lost);
  }

  /// To be called by the status change interrupt and, from `start` on, every 10 ms or so. True: since now the
  /// bus is lost. The frames that waited are then given up, and again every `silence_limit`, so that none is
  /// older than that when the bus comes back; `send` goes on taking frames, for something must be on the wire
  /// for others to acknowledge.
  bool watch(base::Time now) noexcept {
    registers_.write(Register::msr, msr::erri);
    const BusErrors errors = read_errors();
    if (errors.state == BusState::off && errors_.state != BusState::off) ++counters_.bus_off;
    if (errors.state == BusState::passive && errors_.state < BusState::passive) ++counters_.passive;
    errors_ = errors;

    // It does not leave its initialisation while the bus is held dominant.
    const bool joined = (registers_.read(Register::msr) & msr::inak) == 0;
    const bool well = joined && errors.state < BusState::passive;
    const std::uint32_t successes = counters_.sent + counters_.received;
    if (well || !watched_ || successes != successes_) last_success_ = now;
    watched_ = true;
    successes_ = successes;
    const bool lost = errors.state == BusState::off || (!well && now - last_success_ >= silence_limit);
    const bool fell = lost && !lost_;
    lost_ = lost;
    if (fell || (lost && now - last_given_up_ >= silence_limit)) {
      last_given_up_ = now;
      give_up();
    }
    return fell;
  }

  /// As of the last `watch`.
  [[nodiscard]] bool lost() const noexcept { return lost_; }
  [[nodiscard]] const BusErrors& errors() const noexcept { return errors_; }
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
  /// Frames that were taken and are not on the wire yet.
  [[nodiscard]] std::size_t waiting() const noexcept { return used_; }

 private:
  enum class State : std::uint8_t { free, waiting, loaded };
  struct Slot {
    can::Frame frame{};
    std::uint32_t number = 0;  ///< in the order of `send`
    State state = State::free;
  };
  struct Mailbox {
    Slot* slot = nullptr;   ///< nullptr: empty
    bool aborting = false;  ///< asked to let it go; not confirmed yet
    bool given_up = false;  ///< ... and it is not needed back
  };

  /// Lower is sent first. Base data frames only: the identifier is the arbitration key.
  static bool before(const Slot& a, const Slot& b) noexcept {
    if (a.frame.id != b.frame.id) return a.frame.id < b.frame.id;
    return static_cast<std::int32_t>(a.number - b.number) < 0;  // numbers wrap around
  }

  static constexpr std::uint32_t interrupts = ier::tmeie | ier::fmpie0 | ier::errie | ier::epvie | ier::bofie;

  std::optional<can::Frame> take(std::size_t fifo, std::uint32_t& frames, std::uint32_t& overruns) noexcept {
    const Register fill = of_fifo(Register::rf0r, fifo);
    const std::uint32_t status = registers_.read(fill);
    if ((status & rfr::fovr) != 0) {
      registers_.write(fill, rfr::fovr);
      ++overruns;
    }
    if ((status & rfr::fmp) == 0) return std::nullopt;
    can::Frame frame;
    const std::uint32_t id = registers_.read(of_fifo(Register::rir, fifo));
    const std::uint32_t length = registers_.read(of_fifo(Register::rdtr, fifo)) & 0xF;
    const std::uint32_t low = registers_.read(of_fifo(Register::rdlr, fifo));
    const std::uint32_t high = registers_.read(of_fifo(Register::rdhr, fifo));
    registers_.write(fill, rfr::rfom);
    await(fill, rfr::rfom, 0);  // until then the registers still show the frame that was read
    const bool extended = (id & tir::ide) != 0;
    const bool remote = (id & tir::rtr) != 0;
    frame.format = extended ? (remote ? can::Format::extended_remote : can::Format::extended)
                            : (remote ? can::Format::base_remote : can::Format::base);
    frame.id = id >> (extended ? tir::extended_id_shift : tir::base_id_shift);
    frame.dlc = static_cast<std::uint8_t>(length > can::max_dlc ? can::max_dlc : length);
    for (std::size_t i = 0; i < frame.bytes().size(); ++i)
      frame.data[i] = static_cast<std::uint8_t>((i < 4 ? low : high) >> 8 * (i % 4));
    ++frames;
    return frame;
  }

  bool await(Register which, std::uint32_t mask, std::uint32_t value) noexcept {
    for (unsigned i = 0; i < patience; ++i)
      if ((registers_.read(which) & mask) == value) return true;
    return false;
  }

  void set_filters(const FilterBanks& filters) noexcept {
    const std::uint32_t master = registers_.read(Register::fmr);  // CAN2's first bank stays what it is
    registers_.write(Register::fmr, master | fmr::finit);
    registers_.write(Register::fa1r, 0);
    registers_.write(Register::fm1r, 0);  // masks
    registers_.write(Register::fs1r, filters.wide ? (1U << filters.size) - 1U : 0);
    // The board's own into FIFO 0. The bank of all else is of 16 bits, and comes after those of 32.
    overhearing_bank_ = filters.wide ? filters.size : filter_banks;
    const bool spare = overhearing_bank_ < filter_banks;
    registers_.write(Register::ffa1r, spare ? 1U << overhearing_bank_ : 0U);
    for (std::size_t i = 0; i < filters.size; ++i) {
      registers_.write(of_bank(Register::fr1, i), filters.banks[i].fr1);
      registers_.write(of_bank(Register::fr2, i), filters.banks[i].fr2);
    }
    if (spare) {
      registers_.write(of_bank(Register::fr1, overhearing_bank_), 0);  // no bit must match
      registers_.write(of_bank(Register::fr2, overhearing_bank_), 0);
    }
    registers_.write(Register::fa1r, (1U << filters.size) - 1U);
    registers_.write(Register::fmr, master & ~fmr::finit);
  }

  Slot* free_slot() noexcept {
    for (Slot& slot : slots_)
      if (slot.state == State::free) return &slot;
    return nullptr;
  }

  bool in_a_mailbox(std::uint32_t id) const noexcept {
    for (const Mailbox& mailbox : mailboxes_)
      if (mailbox.slot != nullptr && mailbox.slot->frame.id == id) return true;
    return false;
  }

  /// The first of those that may be loaded.
  Slot* next() noexcept {
    Slot* best = nullptr;
    for (Slot& slot : slots_) {
      if (slot.state != State::waiting || (best != nullptr && !before(slot, *best))) continue;
      if (!in_a_mailbox(slot.frame.id)) best = &slot;
    }
    return best;
  }

  /// Takes note of what the mailboxes have done.
  void settle() noexcept {
    const std::uint32_t status = registers_.read(Register::tsr);
    for (std::size_t n = 0; n < mailboxes; ++n) {
      if ((status & tsr::at(tsr::rqcp, n)) == 0) continue;
      // Ones clear, zeros do nothing: no other mailbox is touched. It must be done before the mailbox is
      // loaded again, or the note of the next frame would be lost.
      registers_.write(Register::tsr, tsr::at(tsr::rqcp, n));
      Mailbox& mailbox = mailboxes_[n];
      if (mailbox.slot == nullptr) continue;  // a leftover of the program before
      if ((status & tsr::at(tsr::txok, n)) != 0) {
        ++counters_.sent;
        release(*mailbox.slot);
      } else if (mailbox.given_up) {
        ++counters_.dropped;
        release(*mailbox.slot);
      } else {
        ++counters_.aborted;
        mailbox.slot->state = State::waiting;  // with its old number: in front of its equals
      }
      mailbox = {};
    }
  }

  void release(Slot& slot) noexcept {
    slot.state = State::free;
    --used_;
  }

  /// Brings the most urgent frames into the mailboxes. Ends: each turn loads a frame or aborts a mailbox that
  /// was not being aborted, and what is loaded is never less urgent than what it displaced.
  void pump() noexcept {
    settle();
    while (Slot* const slot = next()) {
      if (const auto empty = empty_mailbox()) {
        load(*empty, *slot);
      } else if (const auto victim = least_urgent_after(*slot)) {
        mailboxes_[*victim].aborting = true;
        registers_.write(Register::tsr, tsr::at(tsr::abrq, *victim));
        settle();
      } else {
        return;
      }
    }
  }

  [[nodiscard]] std::optional<std::size_t> empty_mailbox() const noexcept {
    for (std::size_t n = 0; n < mailboxes; ++n)
      if (mailboxes_[n].slot == nullptr) return n;
    return std::nullopt;
  }

  /// The mailbox to abort for this frame, if there is one that is worth it.
  [[nodiscard]] std::optional<std::size_t> least_urgent_after(const Slot& slot) const noexcept {
    std::optional<std::size_t> worst;
    for (std::size_t n = 0; n < mailboxes; ++n) {
      const Mailbox& mailbox = mailboxes_[n];
      if (mailbox.aborting || !before(slot, *mailbox.slot)) continue;
      if (!worst || before(*mailboxes_[*worst].slot, *mailbox.slot)) worst = n;
    }
    return worst;
  }

  void load(std::size_t n, Slot& slot) noexcept {
    const can::Frame& frame = slot.frame;
    std::array<std::uint32_t, 2> words{};
    for (std::size_t i = 0; i < frame.data.size(); ++i)
      words[i / 4] |= std::uint32_t{frame.data[i]} << 8 * (i % 4);
    const std::uint32_t id = frame.id << tir::base_id_shift;
    mailboxes_[n] = {&slot};
    slot.state = State::loaded;
    registers_.write(of_mailbox(Register::tir, n), id);
    registers_.write(of_mailbox(Register::tdtr, n), frame.dlc);
    registers_.write(of_mailbox(Register::tdlr, n), words[0]);
    registers_.write(of_mailbox(Register::tdhr, n), words[1]);
    registers_.write(of_mailbox(Register::tir, n), id | tir::txrq);
  }

  void give_up() noexcept {
    for (Slot& slot : slots_) {
      if (slot.state != State::waiting) continue;
      ++counters_.dropped;
      release(slot);
    }
    for (std::size_t n = 0; n < mailboxes; ++n) {
      if (mailboxes_[n].slot == nullptr) continue;
      mailboxes_[n].aborting = mailboxes_[n].given_up = true;
      registers_.write(Register::tsr, tsr::at(tsr::abrq, n));
    }
    pump();
  }

  BusErrors read_errors() noexcept {
    const std::uint32_t status = registers_.read(Register::esr);
    BusErrors errors;
    errors.transmit = static_cast<std::uint8_t>(status >> esr::tec_shift);
    errors.receive = static_cast<std::uint8_t>(status >> esr::rec_shift);
    errors.last = status >> esr::lec_shift & 7;
    errors.state = (status & esr::boff) != 0   ? BusState::off
                   : (status & esr::epvf) != 0 ? BusState::passive
                   : (status & esr::ewgf) != 0 ? BusState::warning
                                               : BusState::active;
    return errors;
  }

  R registers_;
  std::array<Slot, capacity> slots_{};
  std::array<Mailbox, mailboxes> mailboxes_{};
  std::size_t used_ = 0;
  std::size_t overhearing_bank_ = filter_banks;
  std::uint32_t next_number_ = 0;
  Counters counters_;
  BusErrors errors_;
  std::uint32_t successes_ = 0;
  base::Time last_success_{};
  base::Time last_given_up_{};
  bool watched_ = false;
  bool lost_ = false;
};

}  // namespace ocm::firmware::drivers::bxcan
