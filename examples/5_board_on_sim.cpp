/// A board that is a program of this machine, on the bus of `amiroctl sim`: firmware can be tried before
/// there is a board. It takes the place of one that the simulator leaves free:
///
///     amiroctl sim --without di_wheel_drive
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "ocm/controller/controller.hpp"
#include "ocm/topics/amiro.hpp"
#include "ocm/transport/virtual_bus.hpp"

using namespace ocm;
using namespace std::chrono_literals;

base::Time now() {
  return base::Time{std::chrono::steady_clock::now().time_since_epoch()};
}

int main() {
  const auto opened = transport::VirtualBus::open();
  if (!opened) {
    std::fprintf(stderr, "%s\n%s\n", opened.error.what.c_str(), opened.error.remedy.c_str());
    return 1;
  }
  // snippet: board-on-sim
  transport::VirtualBus& bus = **opened;
  std::int32_t speed = 0;  // um/s
  controller::Controller<amiro::DiWheelDrive, transport::VirtualBus> board{bus, now()};
  board.serve<amiro::Accelerometer>([&] {
    amiro::Accelerometer sample{};
    sample.x = static_cast<std::int16_t>(speed / 1000);
    return base::Result<amiro::Accelerometer>{sample};
  });
  board.accept<amiro::Motors>([&](const amiro::Motors& target) {
    speed = target.x;
    std::printf("%.3f m/s\n", target.x_m_per_s());
    std::fflush(stdout);
  });
  for (;;) {
    const auto left = std::clamp<base::Duration>(board.next_event() - now(), 0ms, 100ms);
    const auto received = bus.receive(left);
    if (received) board.receive(received->frame, now());
    if (!received && received.error == base::Error::closed) return 0;  // the simulator has ended
    board.poll(now());
  }
  // endsnippet
}
