/// bxCAN as its reference manual describes it, register by register, for tests on a host: mailboxes with
/// their states, the order among them, aborts, receive FIFOs, filter banks, error counters, bus-off. Written
/// from RM0008 24 without a look at the driver. What a program must not do is recorded in `violations`.
///
/// The bus is in the hands of the test: `begin` arbitrates, `end` finishes what is on the wire, `deliver`
/// brings another node's frame. `on_access` runs before each access of the program to a register, so that a
/// test can let the bus move on at any such point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ocm/can/frame.hpp"

#include "firmware/drivers/bxcan_registers.hpp"

namespace ocm::sim {

class BxcanModel {
 public:
  using Register = firmware::drivers::bxcan::Register;

  /// How an attempt on the wire ends.
  enum class End : std::uint8_t {
    acknowledged,
    lost_arbitration,  ///< another node's lower identifier goes first
    no_acknowledge,
    bit_error,
  };
  enum class MailboxState : std::uint8_t { empty, pending, scheduled, transmit };  // [RM0008 figure 226]

  std::function<void()> on_access;      ///< before each access of the program
  unsigned abort_delay = 0;             ///< accesses until an abort that need not wait is seen
  bool dominant = false;                ///< the bus is held dominant: no node can join
  unsigned handshake_delay = 2;         ///< accesses until INAK and RFOM follow
  std::vector<std::string> violations;  ///< of the rules of the manual, by the program
  std::vector<can::Frame> transmitted;  ///< what was acknowledged, in order
  std::array<bool, 14> filters_used{};  ///< banks that accepted something

  // --- the program's side ---

  std::uint32_t read(Register which) {
    tick();
    const auto offset = static_cast<std::size_t>(which);
    switch (which) {
      case Register::mcr:
        return mcr_;
      case Register::msr:
        return msr();
      case Register::tsr:
        return tsr();
      case Register::rf0r:
        return rfr(fifo_);
      case Register::rf1r:
        return rfr(fifo1_);
      case Register::ier:
        return ier_;
      case Register::esr:
        return esr();
      case Register::btr:
        return btr_;
      case Register::fmr:
        return fmr_;
      case Register::fm1r:
        return fm1r_;
      case Register::fs1r:
        return fs1r_;
      case Register::ffa1r:
        return ffa1r_;
      case Register::fa1r:
        return fa1r_;
      default:
        break;
    }
    if (offset >= 0x180 && offset < 0x1B0) return mailbox_[(offset - 0x180) / 0x10].words[offset % 0x10 / 4];
    if (offset >= 0x1B0 && offset < 0x1C0) return fifo_.words(offset % 0x10 / 4);
    if (offset >= 0x1C0 && offset < 0x1D0) return fifo1_.words(offset % 0x10 / 4);
    if (offset >= 0x240 && offset < 0x240 + 14 * 8) return banks_[(offset - 0x240) / 8][offset % 8 / 4];
    violation("read of a register that is not there");
    return 0;
  }

  void write(Register which, std::uint32_t value) {
    tick();
    const auto offset = static_cast<std::size_t>(which);
    if (offset >= 0x180 && offset < 0x1B0)
      return write_mailbox((offset - 0x180) / 0x10, offset % 0x10 / 4, value);
    if (offset >= 0x240 && offset < 0x240 + 14 * 8) {
      const std::size_t bank = (offset - 0x240) / 8;
      if ((fmr_ & 1) == 0 && (fa1r_ >> bank & 1) != 0) return violation("filter changed while it is active");
      banks_[bank][offset % 8 / 4] = value;
      return;
    }
    switch (which) {
      case Register::mcr:
        return write_mcr(value);
      case Register::msr:
        if ((value & 1U << 2) != 0) erri_ = false;
        return;
      case Register::tsr:
        return write_tsr(value);
      case Register::rf0r:
        return write_rfr(fifo_, value);
      case Register::rf1r:
        return write_rfr(fifo1_, value);
      case Register::ier:
        ier_ = value;
        return;
      case Register::btr:
        if (!initialising_) return violation("bit timing written outside initialisation");
        btr_ = value;
        return;
      case Register::fmr:
        fmr_ = value;
        return;
      case Register::fa1r:
        fa1r_ = value;
        return;
      case Register::fm1r:
        return write_filter_setting(fm1r_, value);
      case Register::fs1r:
        return write_filter_setting(fs1r_, value);
      case Register::ffa1r:
        return write_filter_setting(ffa1r_, value);
      default:
        violation("write to a register that cannot be written");
    }
  }

  [[nodiscard]] bool transmit_interrupt() const {
    bool done = false;
    for (const Mailbox& mailbox : mailbox_) done = done || mailbox.completed;
    return done && (ier_ & 1) != 0;
  }
  [[nodiscard]] bool receive_interrupt() const { return !fifo_.frames.empty() && (ier_ & 2) != 0; }
  [[nodiscard]] bool receive_interrupt_of_fifo_1() const {
    return !fifo1_.frames.empty() && (ier_ & 0x10) != 0;
  }
  [[nodiscard]] bool error_interrupt() const { return erri_; }

  // --- the bus's side ---

  /// The bus is idle and every node may start. The frame that this controller puts on the wire, if any.
  std::optional<can::Frame> begin() {
    if (initialising_ || asleep_ || bus_off_ || on_wire_) return std::nullopt;
    const auto next = scheduled();
    if (!next) return std::nullopt;
    mailbox_[*next].state = MailboxState::transmit;
    on_wire_ = *next;
    return frame(*next);
  }

  /// What is on the wire ends like this.
  void end(End how) {
    if (!on_wire_) return;
    const std::size_t n = *on_wire_;
    Mailbox& mailbox = mailbox_[n];
    on_wire_.reset();
    mailbox.alst = how == End::lost_arbitration;
    mailbox.terr = how == End::no_acknowledge || how == End::bit_error;
    if (how == End::acknowledged) {
      transmitted.push_back(frame(n));
      if (tec_ > 0) --tec_;
      last_error_ = 0;
      complete(mailbox, true);
      return update_errors();
    }
    if (mailbox.terr) {
      last_error_ = how == End::no_acknowledge ? 3 : 4;
      // An error passive transmitter that misses only the acknowledge does not count it. [ISO
      // 11898-1, 13.1.4]
      if (!(how == End::no_acknowledge && tec_ > 127)) tec_ += 8;
      update_errors();
    }
    if (mailbox.abort || (mcr_ & 1U << 4) != 0)
      complete(mailbox, false);
    else
      mailbox.state = MailboxState::pending;
  }

  [[nodiscard]] bool on_wire() const { return on_wire_.has_value(); }

  /// Another node's frame was on the bus. Whether it passed a filter.
  bool deliver(const can::Frame& received) {
    if (initialising_ || asleep_ || bus_off_) return false;
    if (rec_ > 127)
      rec_ = 120;  // "between 119 and 127" [ISO 11898-1, 13.1.4]
    else if (rec_ > 0)
      --rec_;
    update_errors();
    const auto fifo = filtered(received);
    if (!fifo) return false;
    Fifo& into = *fifo == 0 ? fifo_ : fifo1_;
    if (into.frames.size() == 3) {
      into.overrun = true;
      if ((mcr_ & 1U << 3) == 0) into.frames.back() = received;
    } else {
      into.frames.push_back(received);
    }
    return true;
  }
  /// A frame of another node was broken.
  void disturb(std::uint8_t error = 1) {
    last_error_ = error;
    ++rec_;
    update_errors();
  }

  /// So many times 11 recessive bits were seen.
  void recessive(unsigned times) {
    if (!bus_off_ || (mcr_ & 1U << 6) == 0) return;
    recovery_ += times;
    if (recovery_ < 128) return;  // [RM0008 24.7.6]
    bus_off_ = false;
    tec_ = 0;
    rec_ = 0;
    recovery_ = 0;
    update_errors();
  }

  [[nodiscard]] MailboxState state(std::size_t n) const {
    const auto next = scheduled();
    if (next == n && !on_wire_) return MailboxState::scheduled;
    return mailbox_[n].state;
  }
  [[nodiscard]] unsigned transmit_errors() const { return tec_; }
  [[nodiscard]] bool initialising() const { return initialising_; }

 private:
  struct Mailbox {
    std::array<std::uint32_t, 4> words{};
    MailboxState state = MailboxState::empty;
    bool completed = false, sent = false, alst = false, terr = false, abort = false;
    std::uint32_t request = 0;  ///< number of the request, for the order of requests
    unsigned abort_in = 0;      ///< accesses until a granted abort is seen; 0: none is under way
  };
  struct Fifo {
    std::deque<can::Frame> frames;
    bool overrun = false;
    bool releasing = false;
    unsigned release_in = 0;

    [[nodiscard]] std::uint32_t words(std::size_t which) const {
      if (frames.empty()) return 0xDEAD'BEEF;
      const can::Frame& frame = frames.front();
      switch (which) {
        case 0:
          return can::is_extended(frame.format)
                     ? frame.id << 3 | 4U | (can::is_remote(frame.format) ? 2U : 0U)
                     : frame.id << 21 | (can::is_remote(frame.format) ? 2U : 0U);
        case 1:
          return 0xABCD'0000 | frame.dlc;  // time stamp and filter match index are above
        default:
          break;
      }
      std::uint32_t word = 0;
      for (std::size_t i = 0; i < 4; ++i) word |= std::uint32_t{frame.data[4 * (which - 2) + i]} << 8 * i;
      return word;
    }
  };

  void violation(const char* text) { violations.emplace_back(text); }

  void tick() {
    if (on_access) on_access();
    for (Mailbox& mailbox : mailbox_)
      if (mailbox.abort_in > 0 && --mailbox.abort_in == 0 && mailbox.state == MailboxState::pending)
        complete(mailbox, false);
    for (Fifo* fifo : {&fifo_, &fifo1_})
      if (fifo->releasing && (fifo->release_in == 0 || --fifo->release_in == 0)) {
        fifo->releasing = false;
        if (!fifo->frames.empty()) fifo->frames.pop_front();
      }
    const bool wanted = (mcr_ & 1) != 0;
    if (wanted != initialising_ && !on_wire_ && (wanted || !dominant) &&
        (handshake_ == 0 || --handshake_ == 0)) {
      initialising_ = wanted;
      asleep_ = asleep_ && !wanted;
    }
  }

  static void complete(Mailbox& mailbox, bool sent) {
    mailbox.state = MailboxState::empty;
    mailbox.completed = true;
    mailbox.sent = sent;
    mailbox.abort = false;
    mailbox.abort_in = 0;
  }

  [[nodiscard]] can::Frame frame(std::size_t n) const {
    const auto& words = mailbox_[n].words;
    can::Frame result;
    const bool remote = (words[0] & 2) != 0;
    if ((words[0] & 4) != 0) {
      result.id = words[0] >> 3;
      result.format = remote ? can::Format::extended_remote : can::Format::extended;
    } else {
      result.id = words[0] >> 21;
      result.format = remote ? can::Format::base_remote : can::Format::base;
    }
    result.dlc = static_cast<std::uint8_t>(words[1] & 0xF);
    for (std::size_t i = 0; i < result.dlc && i < 8; ++i)
      result.data[i] = static_cast<std::uint8_t>(words[2 + i / 4] >> 8 * (i % 4));
    return result;
  }

  /// Which pending mailbox goes next: the lowest identifier, among equals the lowest mailbox; or with TXFP
  /// the order of the requests. [RM0008 24.7.2]
  [[nodiscard]] std::optional<std::size_t> scheduled() const {
    std::optional<std::size_t> best;
    for (std::size_t n = 0; n < 3; ++n) {
      if (mailbox_[n].state != MailboxState::pending) continue;
      if (!best) {
        best = n;
      } else if ((mcr_ & 1U << 2) != 0) {
        if (mailbox_[n].request < mailbox_[*best].request) best = n;
      } else if (can::arbitration_key(frame(n)) < can::arbitration_key(frame(*best))) {
        best = n;
      }
    }
    return best;
  }

  void write_mailbox(std::size_t n, std::size_t word, std::uint32_t value) {
    Mailbox& mailbox = mailbox_[n];
    if (mailbox.state != MailboxState::empty) return violation("mailbox written while it is not empty");
    mailbox.words[word] = word == 0 ? value & ~1U : value;
    if (word != 0 || (value & 1) == 0) return;
    if ((mailbox.words[1] & 0xF) > 8) violation("DLC above 8");
    if (mailbox.completed) violation("mailbox requested before its last result was taken");
    mailbox.state = MailboxState::pending;  // the request clears what is said of the last one
    mailbox.completed = mailbox.sent = mailbox.alst = mailbox.terr = false;
    mailbox.request = ++requests_;
  }

  void write_tsr(std::uint32_t value) {
    for (std::size_t n = 0; n < 3; ++n) {
      Mailbox& mailbox = mailbox_[n];
      const std::uint32_t bits = value >> 8 * n;
      if ((bits & 1) != 0) mailbox.completed = mailbox.sent = mailbox.alst = mailbox.terr = false;
      if ((bits & 0x80) == 0 || mailbox.state == MailboxState::empty) continue;
      mailbox.abort = true;
      if (mailbox.state == MailboxState::transmit) continue;  // "can have two results"
      if (abort_delay == 0)
        complete(mailbox, false);
      else
        mailbox.abort_in = abort_delay;
    }
  }

  [[nodiscard]] std::uint32_t tsr() const {
    std::uint32_t value = 0;
    std::size_t next_empty = 0;
    bool full = true;
    for (std::size_t n = 3; n-- > 0;) {
      const Mailbox& mailbox = mailbox_[n];
      value |= (mailbox.completed ? 1U : 0U) << 8 * n;
      value |= (mailbox.sent ? 2U : 0U) << 8 * n;
      value |= (mailbox.alst ? 4U : 0U) << 8 * n;
      value |= (mailbox.terr ? 8U : 0U) << 8 * n;
      value |= (mailbox.abort ? 0x80U : 0U) << 8 * n;
      if (mailbox.state != MailboxState::empty) continue;
      value |= 1U << (26 + n);
      next_empty = n;
      full = false;
    }
    if (!full) value |= static_cast<std::uint32_t>(next_empty) << 24;  // CODE
    return value;
  }

  void write_mcr(std::uint32_t value) {
    if (((value ^ mcr_) & 1) != 0) handshake_ = handshake_delay;
    if ((value & 2) == 0) asleep_ = false;
    mcr_ = value & 0x1'00FF;
  }
  [[nodiscard]] std::uint32_t msr() const {
    return (initialising_ ? 1U : 0U) | (asleep_ ? 2U : 0U) | (erri_ ? 4U : 0U) | 0xC00;
  }

  [[nodiscard]] static std::uint32_t rfr(const Fifo& fifo) {
    return static_cast<std::uint32_t>(fifo.frames.size()) | (fifo.frames.size() == 3 ? 8U : 0U) |
           (fifo.overrun ? 0x10U : 0U) | (fifo.releasing ? 0x20U : 0U);
  }
  void write_rfr(Fifo& fifo, std::uint32_t value) {
    if ((value & 0x10) != 0) fifo.overrun = false;
    if ((value & 0x20) == 0) return;
    if (fifo.frames.empty() || fifo.releasing)
      return violation("release of an empty FIFO, or of one in release");
    fifo.releasing = true;
    fifo.release_in = handshake_delay;
  }

  void write_filter_setting(std::uint32_t& setting, std::uint32_t value) {
    if ((fmr_ & 1) == 0) return violation("filter set up outside its initialisation");
    setting = value;
  }

  /// FIFO number when a filter accepts. [RM0008 24.7.4, figure 231]
  std::optional<unsigned> filtered(const can::Frame& received) {
    if ((fmr_ & 1) != 0) return std::nullopt;  // no reception while filters are set up
    const bool extended = can::is_extended(received.format);
    const bool remote = can::is_remote(received.format);
    const std::uint32_t id32 = (extended ? received.id << 3 | 4U : received.id << 21) | (remote ? 2U : 0U);
    const std::uint32_t base = extended ? received.id >> 18 : received.id;
    const std::uint32_t id16 =
        base << 5 | (remote ? 0x10U : 0U) | (extended ? 8U | (received.id >> 15 & 7) : 0U);
    // Those of 32 bits come first, lists before masks, lower numbers before higher. Each FIFO numbers its
    // filters by itself, so which of two FIFOs gets a frame is not said where only the numbers could tell.
    std::optional<std::size_t> best;
    const auto rank = [&](std::size_t n) { return 2 * (fs1r_ >> n & 1) + (fm1r_ >> n & 1); };
    for (std::size_t n = 0; n < banks_.size(); ++n) {
      if ((fa1r_ >> n & 1) == 0) continue;
      const bool list = (fm1r_ >> n & 1) != 0;
      const auto& [first, second] = banks_[n];
      bool accepted = false;
      if ((fs1r_ >> n & 1) != 0) {
        accepted =
            list ? id32 == (first & ~1U) || id32 == (second & ~1U) : ((id32 ^ first) & second & ~1U) == 0;
      } else {
        for (const std::uint32_t pair : {first, second}) {
          const std::uint32_t low = pair & 0xFFFF;
          const std::uint32_t high = pair >> 16;
          accepted = accepted || (list ? id16 == low || id16 == high : ((id16 ^ low) & high) == 0);
        }
      }
      if (!accepted) continue;
      if (best && rank(*best) == rank(n) && (ffa1r_ >> *best & 1) != (ffa1r_ >> n & 1))
        violation("it is not said which FIFO gets this frame");
      if (!best || rank(n) > rank(*best)) best = n;
    }
    if (!best) return std::nullopt;
    filters_used[*best] = true;
    return ffa1r_ >> *best & 1;
  }

  void update_errors() {
    const bool warning = tec_ >= 96 || rec_ >= 96;
    const bool passive = tec_ > 127 || rec_ > 127;
    const bool off = bus_off_ || tec_ > 255;
    const bool enabled = (ier_ & 1U << 15) != 0;
    if (enabled &&
        ((off && !bus_off_ && (ier_ & 1U << 10) != 0) || (passive && !passive_ && (ier_ & 1U << 9) != 0) ||
         (warning && !warning_ && (ier_ & 1U << 8) != 0)))
      erri_ = true;
    warning_ = warning;
    passive_ = passive;
    bus_off_ = off;
  }
  [[nodiscard]] std::uint32_t esr() const {
    return (warning_ ? 1U : 0U) | (passive_ ? 2U : 0U) | (bus_off_ ? 4U : 0U) |
           std::uint32_t{last_error_} << 4 | (tec_ & 0xFF) << 16 | (rec_ & 0xFF) << 24;
  }

  std::array<Mailbox, 3> mailbox_{};
  Fifo fifo_, fifo1_;
  std::array<std::array<std::uint32_t, 2>, 14> banks_{};
  std::optional<std::size_t> on_wire_;
  std::uint32_t mcr_ = 0x1'0002, btr_ = 0x0123'0000, ier_ = 0;  // [RM0008 24.9.2, reset values]
  std::uint32_t fmr_ = 0x2A1C'0E01, fm1r_ = 0, fs1r_ = 0, ffa1r_ = 0, fa1r_ = 0;
  std::uint32_t requests_ = 0;
  unsigned tec_ = 0, rec_ = 0, recovery_ = 0, handshake_ = 0;
  std::uint8_t last_error_ = 0;
  bool initialising_ = false, asleep_ = true, erri_ = false;
  bool warning_ = false, passive_ = false, bus_off_ = false;
};

/// What a driver holds: the model's registers.
class BxcanModelRegisters {
 public:
  explicit BxcanModelRegisters(BxcanModel& model) noexcept : model_(&model) {}
  std::uint32_t read(firmware::drivers::bxcan::Register which) { return model_->read(which); }
  void write(firmware::drivers::bxcan::Register which, std::uint32_t value) { model_->write(which, value); }

 private:
  BxcanModel* model_;
};
static_assert(firmware::drivers::bxcan::Registers<BxcanModelRegisters>);

}  // namespace ocm::sim
