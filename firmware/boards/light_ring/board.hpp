/// LightRing, the top board: eight coloured lights. The same code runs on the board, with a driver, and on a
/// host, with a simulated world.
///
/// No heap, no exceptions. Not reentrant.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/controller.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/samples.hpp"

namespace ocm::firmware::boards::light_ring {

/// What the board needs of its lights, numbered from 0.
template <class H>
concept Hardware = requires(H& hardware, std::size_t light, Colour colour) {
  hardware.set_light(light, colour);
};

template <Hardware H, can::Sender Bus>
class Board {
 public:
  /// Both must outlive the board.
  Board(H& hardware, Bus& bus) noexcept : hardware_(&hardware), controller_(bus) {
    controller_.template accept<amiro::Led>([this](std::uint8_t instance, const amiro::Led& led) {
      hardware_->set_light(instance - 1U, Colour{led.red, led.green, led.blue});
    });
  }
  Board(const Board&) = delete;  // the controller holds this address
  Board& operator=(const Board&) = delete;

  void receive(const can::Frame& frame, base::Time now) noexcept { controller_.receive(frame, now); }
  void poll(base::Time now) noexcept { controller_.poll(now); }
  [[nodiscard]] base::Time next_event() const noexcept { return controller_.next_event(); }
  [[nodiscard]] bool waiting() const noexcept { return controller_.waiting(); }
  [[nodiscard]] const protocol::Counters& counters() const noexcept { return controller_.counters(); }

 private:
  H* hardware_;
  controller::Controller<amiro::LightRing, Bus> controller_;
};

}  // namespace ocm::firmware::boards::light_ring
