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
#include "ocm/controller/controller.hpp"
#include "ocm/scheduling/admission.hpp"
#include "ocm/scheduling/cooperative.hpp"
#include "ocm/scheduling/port.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/node.hpp"
#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::light_ring {

/// What the board needs of its lights, numbered from 0.
template <class H>
concept Hardware = requires(H& hardware, std::size_t light, Colour colour) {
  hardware.set_light(light, colour);
};

/// Hardware that needs to be looked after.
template <class H>
concept Maintained = Hardware<H> && requires(H& hardware, base::Time now) {
  hardware.maintain(now);
};

template <Hardware H, can::Sender Bus, scheduling::Port P = scheduling::Cooperative,
          scheduling::Admission A = scheduling::AdmitAll>
class Board : public Node<amiro::LightRing, Bus, P, 0, A> {
  using Base = Node<amiro::LightRing, Bus, P, 0, A>;
  using Base::controller_;

 public:
  /// All of them must outlive the board.
  Board(H& hardware, Bus& bus, controller::PortArgument<P> port = {}) noexcept
      : Base(bus, port), hardware_(&hardware) {
    controller_.template accept<amiro::Led>([this](std::uint8_t instance, const amiro::Led& led) {
      hardware_->set_light(instance - 1U, Colour{led.red, led.green, led.blue});
    });
  }
  /// On hardware that needs it, to be called every 10 ms or so on the low level.
  void maintain(base::Time now) noexcept requires Maintained<H> { hardware_->maintain(now); }

 private:
  H* hardware_;
};

}  // namespace ocm::firmware::boards::light_ring
