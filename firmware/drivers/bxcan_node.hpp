/// A board on its CAN controller, and where a host is on the board's serial line, with it: frames received
/// wait here for the board, and everything on the bus is also heard by the host. An RTOS adds its lock,
/// interrupts and signals (firmware/chibios/stm32/can_bus.hpp).
///
/// Without a host nothing is added to what the controller's driver does. With one:
/// - a frame of the board's, or for it, is one copy more;
/// - frames that are not for the board come by an interrupt of their own, which takes at most three at a
/// time:
///   a FIFO's content;
/// - the host's frames have at most `places_of_host` of the controller's places at a time, so they never take
///   the board's own;
/// - what the host says to the board reaches it even when the CAN bus is lost.
///
/// Not reentrant: lock around each call. Each is bounded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bit_timing.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/slcan_bridge.hpp"
#include "ocm/can/slcan_codec.hpp"

#include "firmware/drivers/bxcan.hpp"
#include "firmware/drivers/bxcan_filter.hpp"

namespace ocm::firmware::drivers::bxcan {

/// Who hears everything while `overhear` is on.
struct Ear {
  void (*hear)(void* object, const can::Frame& frame, base::Time now) noexcept = nullptr;
  void* object = nullptr;
};

/// 1.5 ms of the shortest frames, back to back.
inline constexpr std::size_t received_places = 16;
/// A line at 115200 bit/s brings a frame in 0.5 ms at least, and the bus takes one away in 0.27 ms at most.
inline constexpr std::size_t places_of_host = 4;

template <Registers R>
class Node {
 public:
  constexpr explicit Node(R registers) noexcept : controller_(registers) {}

  base::Status start(const can::BitTiming& timing, const FilterBanks& filters) noexcept {
    filters_ = &filters;
    return controller_.start(timing, filters);
  }

  // --- the board's side ---

  /// As Bxcan::send. The host hears what was taken, a little before it is on the wire: so it also hears a
  /// board that is alone on its bus.
  base::Result<bool> send(const can::Frame& frame, base::Time now) noexcept {
    const auto taken = controller_.send(frame);
    if (taken.ok() && *taken) hear(frame, now);
    return taken;
  }
  /// Of the receive interrupt.
  void on_receive(base::Time now) noexcept {
    while (const auto frame = controller_.receive()) {
      hear(*frame, now);
      if (size_ == received_.size())
        ++missed_;
      else
        keep(*frame);
    }
  }
  /// The oldest frame that the board has not taken.
  std::optional<can::Frame> next() noexcept {
    if (size_ == 0) return std::nullopt;
    const can::Frame frame = received_[begin_];
    begin_ = (begin_ + 1) % received_.size();
    --size_;
    return frame;
  }
  /// Frames that came while all places were taken.
  [[nodiscard]] std::uint32_t missed() const noexcept { return missed_; }

  [[nodiscard]] Bxcan<R>& controller() noexcept { return controller_; }
  [[nodiscard]] const Bxcan<R>& controller() const noexcept { return controller_; }

  // --- the host's side: can::slcan::BridgedBus ---

  /// Before the first `listen`.
  void attach(const Ear& ear) noexcept { ear_ = ear; }
  void listen(bool all) noexcept { listening_ = controller_.overhear(all) && all; }
  [[nodiscard]] bool listening() const noexcept { return listening_; }
  /// Of FIFO 1's interrupt, which calls it at most `receive_depth` times: one FIFO's content. False: no
  /// frame.
  bool overhear(base::Time now) noexcept {
    const auto frame = controller_.overheard();
    if (frame) hear(*frame, now);
    return frame.has_value();
  }
  [[nodiscard]] bool board_has_room(const can::Frame& frame) const noexcept {
    return size_ < received_.size() || !filters_->accepts(frame);
  }
  base::Result<bool> send_of_host(const can::Frame& frame) noexcept {
    if (controller_.waiting() >= places_of_host && frame.format == can::Format::base) return false;
    return controller_.send(frame);
  }
  /// True: it is for the board, which has it now.
  bool deliver(const can::Frame& frame) noexcept {
    if (!filters_->accepts(frame)) return false;
    keep(frame);
    return true;
  }
  [[nodiscard]] can::slcan::BusCondition condition() const noexcept {
    namespace status = can::slcan::status;
    const BusState state = controller_.errors().state;
    can::slcan::BusCondition condition;
    if (state >= BusState::warning) condition.states |= status::warning;
    if (state >= BusState::passive) condition.states |= status::passive;
    condition.faults = controller_.counters().bus_off + controller_.counters().dropped;
    condition.lost = controller_.counters().overheard_lost + controller_.counters().overruns;
    return condition;
  }

 private:
  void hear(const can::Frame& frame, base::Time now) noexcept {
    if (listening_) ear_.hear(ear_.object, frame, now);
  }
  void keep(const can::Frame& frame) noexcept { received_[(begin_ + size_++) % received_.size()] = frame; }

  Bxcan<R> controller_;
  const FilterBanks* filters_ = nullptr;
  std::array<can::Frame, received_places> received_{};
  std::size_t begin_ = 0;
  std::size_t size_ = 0;
  std::uint32_t missed_ = 0;
  Ear ear_;
  bool listening_ = false;
};

}  // namespace ocm::firmware::drivers::bxcan
