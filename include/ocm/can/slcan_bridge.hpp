/// A board that is on a CAN bus as an SLCAN adapter beside its own work: a host on the board's serial line
/// takes part in the bus through it. Frames of the bus, and those that the board itself sends, go up; frames
/// of the host go onto the bus and to the board.
///
///     line's context, below all that has deadlines          any context, interrupts too
///     ---------------------------------------------          ----------------------------
///     while (bridge.turn(line, bus, port) == Turn::more);    bridge.hear(frame, now);   // locked
///     (then wait for news)
///
/// What does not fit is thrown away and counted, never waited for: the bus and the board do not notice the
/// host. The host learns of it with F: frames that found no place (receive queue full, 0x01), frames or
/// characters lost below the bridge (overrun, 0x08), its own frames that were refused (0x02, and BEL at
/// once), the bus's state (0x04, 0x20), and each time that the bus was lost (0x80).
///
/// The line is open from O or L to C. There is no other end: a host of SLCAN that listens says nothing, so
/// its silence does not mean that it is gone. docs/decisions/0035-slcan-beside-the-bootloader.md
///
/// No heap; `hear` O(1), a copy of 24 bytes; `turn` at most `characters_a_turn` characters and
/// `frames_a_turn` lines. RAM: 24 bytes a place and some 200.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/slcan_adapter.hpp"
#include "ocm/can/slcan_codec.hpp"

namespace ocm::can::slcan {

/// How the bus is. The numbers count from any start and wrap around.
struct BusCondition {
  std::uint8_t states = 0;   ///< bits of `status::states`, as of now
  std::uint32_t faults = 0;  ///< times that the bus was lost
  std::uint32_t lost = 0;    ///< frames of the bus that were lost before `hear`
  friend constexpr bool operator==(const BusCondition&, const BusCondition&) = default;
};

/// The bus, and the board on it, as a host sees them. All but `listen` are called with the port's lock held.
template <class B>
concept BridgedBus = requires(B& bus, const Frame& frame, bool open) {
  { bus.board_has_room(frame) } -> std::same_as<bool>;      ///< true, too: it is not for the board
  { bus.send(frame) } -> std::same_as<base::Result<bool>>;  ///< onto the wire, as can::Sender
  bus.deliver(frame);                                       ///< to the board, for which there is room
  { bus.condition() } -> std::same_as<BusCondition>;
  bus.listen(open);  ///< from now on all frames of the bus are to be heard, or only the board's own
};

/// The line, which never waits. For one context.
template <class L>
concept BridgedLine = requires(L& line, char& character, std::string_view text) {
  { line.read(character) } -> std::same_as<bool>;  ///< false: nothing there
  { line.room() } -> std::same_as<std::size_t>;    ///< characters that `write` takes now
  line.write(text);                                ///< as far as there is room
  {
    line.lost()
    } -> std::same_as<std::uint32_t>;  ///< characters of the host's, as often as any; wraps around
};

/// One number a cause; they wrap around.
struct BridgeCounters {
  std::uint32_t heard = 0;       ///< frames that were to go up
  std::uint32_t written = 0;     ///< of these: are on the line
  std::uint32_t filtered = 0;    ///< ... the host's filter (M, m) does not let through
  std::uint32_t lost = 0;        ///< ... found no place
  std::uint32_t left = 0;        ///< ... waited when the host closed the channel
  std::uint32_t from_host = 0;   ///< frames of the host that were taken
  std::uint32_t no_room = 0;     ///< ... refused: the bus or the board had no room
  std::uint32_t impossible = 0;  ///< ... refused for good: the bus has no such frames
  friend constexpr bool operator==(const BridgeCounters&, const BridgeCounters&) = default;
};

enum class Turn : std::uint8_t {
  more,  ///< there is more to do at once
  done,  ///< not before a frame was heard, a character came, or the line has room
};

/// `Places`: frames that wait for the line.
template <std::size_t Places = 64>
class Bridge {
 public:
  /// A turn's bounds: the longest line of a host, and what the line carries in some 10 ms at 115200 bit/s.
  static constexpr std::size_t characters_a_turn = max_frame_line + 1;
  static constexpr std::size_t frames_a_turn = 4;
  /// A frame is written only where an answer has room besides: a host that asks is answered.
  static constexpr std::size_t room_for_answer = 8;
  static constexpr std::size_t room_for_frame = max_frame_line + 1 + room_for_answer;

  constexpr explicit Bridge(const AdapterInfo& info = {}) noexcept : adapter_(info) {}

  /// A frame that was on the bus, or that the board has sent, at `now`. With the lock held.
  constexpr void hear(const Frame& frame, base::Time now) noexcept {
    if (!open_) return;
    ++counters_.heard;
    if (size_ == Places) {
      ++counters_.lost;
      return;
    }
    waiting_[(begin_ + size_++) % Places] = {frame, now};
  }
  /// Whether `hear` takes frames. With the lock held.
  [[nodiscard]] constexpr bool open() const noexcept { return open_; }
  [[nodiscard]] constexpr BridgeCounters counters() const noexcept { return counters_; }

  /// In the line's context: what the host has said first, then frames for it. `port` has `lock()`.
  template <BridgedLine L, BridgedBus B, class P>
  constexpr Turn turn(L& line, B& bus, P& port) noexcept {
    const bool talks = listen_to_host(line, bus, port);
    const bool hears = speak_to_host(line, port);
    return talks || hears ? Turn::more : Turn::done;
  }

  /// For the line's context.
  [[nodiscard]] constexpr const Adapter& adapter() const noexcept { return adapter_; }

 private:
  struct Heard {
    Frame frame{};
    base::Time time{};
  };

  /// Both or neither: the bus and the board that the host is on.
  template <class B, class P>
  class FromHost {
   public:
    constexpr FromHost(B& bus, P& port, BridgeCounters& counters) noexcept
        : bus_(&bus), port_(&port), counters_(&counters) {}
    constexpr base::Result<bool> send(const Frame& frame) noexcept {
      [[maybe_unused]] const auto guard = port_->lock();
      if (!bus_->board_has_room(frame)) {
        ++counters_->no_room;
        return false;
      }
      const base::Result<bool> sent = bus_->send(frame);
      if (!sent) {
        ++counters_->impossible;
      } else if (!*sent) {
        ++counters_->no_room;
      } else {
        ++counters_->from_host;
        bus_->deliver(frame);
      }
      return sent;
    }

   private:
    B* bus_;
    P* port_;
    BridgeCounters* counters_;
  };

  template <class L, class B, class P>
  constexpr void report(L& line, B& bus, P& port) noexcept {
    BusCondition now;
    std::uint32_t no_place = 0;
    {
      [[maybe_unused]] const auto guard = port.lock();
      now = bus.condition();
      no_place = counters_.lost;
    }
    const std::uint32_t characters = line.lost();
    std::uint8_t flags = now.states & status::states;
    if (no_place != no_place_) flags |= status::receive_queue_full;
    if (now.lost != condition_.lost || characters != characters_) flags |= status::overrun;
    if (now.faults != condition_.faults) flags |= status::bus_error;
    adapter_.report(flags);
    condition_ = now;
    no_place_ = no_place;
    characters_ = characters;
  }

  /// True: there may be more.
  template <class L, class B, class P>
  constexpr bool listen_to_host(L& line, B& bus, P& port) noexcept {
    FromHost<B, P> from_host{bus, port, counters_};
    for (std::size_t n = 0; n < characters_a_turn; ++n) {
      if (line.room() < room_for_answer) return false;
      char character = 0;
      if (!line.read(character)) return false;
      if (character == carriage_return) report(line, bus, port);  // an F that ends here is about now
      const bool was_open = adapter_.channel() != Adapter::Channel::closed;
      line.write(adapter_.feed(character, from_host).view());
      const bool is_open = adapter_.channel() != Adapter::Channel::closed;
      if (was_open != is_open) turn_to(is_open, bus, port);
    }
    return true;
  }

  template <class B, class P>
  constexpr void turn_to(bool open, B& bus, P& port) noexcept {
    if (!open) bus.listen(false);
    {
      [[maybe_unused]] const auto guard = port.lock();
      counters_.left += static_cast<std::uint32_t>(size_);
      size_ = 0;
      open_ = open;
    }
    if (open) bus.listen(true);
  }

  /// True: there is more, and room.
  template <class L, class P>
  constexpr bool speak_to_host(L& line, P& port) noexcept {
    for (std::size_t n = 0; n < frames_a_turn; ++n) {
      if (line.room() < room_for_frame) return false;
      Heard heard;
      {
        [[maybe_unused]] const auto guard = port.lock();
        if (size_ == 0) return false;
        heard = waiting_[begin_];
        begin_ = (begin_ + 1) % Places;
        --size_;
      }
      const Line text = adapter_.hear(heard.frame, heard.time);
      line.write(text.view());
      [[maybe_unused]] const auto guard = port.lock();
      ++(text.view().empty() ? counters_.filtered : counters_.written);
    }
    return true;
  }

  Adapter adapter_;
  std::array<Heard, Places> waiting_{};
  std::size_t begin_ = 0;
  std::size_t size_ = 0;
  bool open_ = false;
  BridgeCounters counters_;
  BusCondition condition_;  ///< as it was last reported
  std::uint32_t no_place_ = 0;
  std::uint32_t characters_ = 0;
};

}  // namespace ocm::can::slcan
