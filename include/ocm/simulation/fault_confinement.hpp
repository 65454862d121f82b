/// The error counters by which a CAN node notices that the fault is its own, and leaves the bus before it
/// disturbs all others. A pure state machine: who sends, who receives and when is the caller's. constexpr, no
/// heap, a few comparisons a call. [ISO 11898-1, fault confinement]
///
/// Left out are the rules that need to know which node saw an error first: the 8 instead of 1 for a receiver
/// whose error flag is answered by others, and those for flags that stay dominant.
#pragma once

#include <algorithm>
#include <cstdint>

namespace ocm::simulation {

enum class FaultState : std::uint8_t {
  error_active,
  error_passive,  ///< a counter is above 127: after a frame of its own it lets others go first
  bus_off,        ///< the transmit counter was above 255: it takes no part
};

class FaultConfinement {
 public:
  static constexpr unsigned passive_from = 128;
  static constexpr unsigned bus_off_from = 256;
  /// So many times 11 recessive bits in a row end bus-off.
  static constexpr unsigned recovery_sequences = 128;
  static constexpr unsigned sequence_bits = 11;
  /// After intermission, before an error passive node follows a frame of its own by another.
  static constexpr unsigned suspend_bits = 8;

  /// A frame of its own was disturbed.
  constexpr void failed_to_send() noexcept {
    if (off()) return;
    transmit_errors_ += 8;
    if (transmit_errors_ >= bus_off_from) sequences_left_ = recovery_sequences;
  }
  constexpr void sent() noexcept {
    if (transmit_errors_ > 0 && !off()) --transmit_errors_;
  }
  /// A frame of another was disturbed. The counter ends at 255, as registers of 8 bits do.
  constexpr void failed_to_receive() noexcept {
    if (!off()) receive_errors_ = std::min(receive_errors_ + 1, 255U);
  }
  /// From above 127 it falls to a value between 119 and 127, which the standard leaves open: that of bxCAN,
  /// 120.
  constexpr void received() noexcept {
    if (off() || receive_errors_ == 0) return;
    receive_errors_ = receive_errors_ >= passive_from ? 120 : receive_errors_ - 1;
  }
  /// `count` times 11 recessive bits in a row were seen. The last one needed resets both counters.
  constexpr void saw_recessive(std::uint64_t count) noexcept {
    if (!off()) return;
    if (count >= sequences_left_)
      *this = {};
    else
      sequences_left_ -= static_cast<unsigned>(count);
  }

  [[nodiscard]] constexpr FaultState state() const noexcept {
    if (off()) return FaultState::bus_off;
    return std::max(transmit_errors_, receive_errors_) >= passive_from ? FaultState::error_passive
                                                                       : FaultState::error_active;
  }
  [[nodiscard]] constexpr unsigned transmit_errors() const noexcept { return transmit_errors_; }
  [[nodiscard]] constexpr unsigned receive_errors() const noexcept { return receive_errors_; }
  /// Until the end of bus-off; 0 in other states.
  [[nodiscard]] constexpr unsigned sequences_left() const noexcept { return sequences_left_; }
  /// Nothing went wrong, or all of it is forgotten.
  [[nodiscard]] constexpr bool clean() const noexcept {
    return transmit_errors_ == 0 && receive_errors_ == 0;
  }

 private:
  [[nodiscard]] constexpr bool off() const noexcept { return sequences_left_ != 0; }

  unsigned transmit_errors_ = 0;
  unsigned receive_errors_ = 0;
  unsigned sequences_left_ = 0;
};

}  // namespace ocm::simulation
