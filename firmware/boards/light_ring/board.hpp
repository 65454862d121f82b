/// LightRing, the top board: eight coloured lights. The same code runs on the board, with a driver, and on a
/// host, with a simulated world.
///
/// No heap, no exceptions. Who may call what: ocm/controller/controller.hpp.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/controller.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/scheduling/cooperative.hpp"
#include "ocm/scheduling/port.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::light_ring {

/// What the board needs of its lights, numbered from 0.
template <class H>
concept Hardware = requires(H& hardware, std::size_t light, Colour colour) {
  hardware.set_light(light, colour);
};

/// Hardware that wants to be looked after.
template <class H>
concept Maintained = Hardware<H> && requires(H& hardware, base::Time now) {
  hardware.maintain(now);
};

template <Hardware H, can::Sender Bus, scheduling::Port P = scheduling::Cooperative>
class Board {
 public:
  using Controller = controller::Controller<amiro::LightRing, Bus, P>;

  /// All of them must outlive the board.
  Board(H& hardware, Bus& bus, controller::PortArgument<P> port = {}) noexcept
      : hardware_(&hardware), controller_(bus, port) {
    controller_.template accept<amiro::Led>([this](std::uint8_t instance, const amiro::Led& led) {
      hardware_->set_light(instance - 1U, Colour{led.red, led.green, led.blue});
    });
  }
  Board(const Board&) = delete;  // the controller holds this address
  Board& operator=(const Board&) = delete;

  void receive(const can::Frame& frame, base::Time now) noexcept { controller_.receive(frame, now); }
  /// On hardware that wants it, to be called every 10 ms or so on the low level.
  void maintain(base::Time now) noexcept requires Maintained<H> { hardware_->maintain(now); }
  void poll(base::Time now) noexcept requires std::same_as<P, scheduling::Cooperative> {
    controller_.poll(now);
  }
  [[nodiscard]] base::Time next_event() const noexcept requires std::same_as<P, scheduling::Cooperative> {
    return controller_.next_event();
  }
  [[nodiscard]] bool waiting() const noexcept { return controller_.waiting(); }
  [[nodiscard]] protocol::Counters counters() const noexcept { return controller_.counters(); }
  /// For a port's contexts, and for what the status frames say.
  [[nodiscard]] Controller& controller() noexcept { return controller_; }
  [[nodiscard]] const Controller& controller() const noexcept { return controller_; }

 private:
  H* hardware_;
  Controller controller_;
};

}  // namespace ocm::firmware::boards::light_ring
