/// A board: what a firmware author writes. Here the bus is stdout and time is a loop; on a robot they are a
/// CAN controller and a timer.
#include <cstdio>

#include "ocm/can/text.hpp"
#include "ocm/controller/controller.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/topics/amiro.hpp"

using namespace ocm;
using namespace std::chrono_literals;

struct Printer {
  base::Result<bool> send(const can::Frame& frame) {
    const auto text = can::to_text(frame);
    std::printf("  -> %.*s\n", static_cast<int>(text.view().size()), text.view().data());
    return true;
  }
};

int main() {
  Printer bus;
  std::int32_t speed = 0;

  // snippet: board
  controller::Controller<amiro::DiWheelDrive, Printer> board{bus};
  board.serve<amiro::Gyroscope>([] { return base::Result<amiro::Gyroscope>{amiro::Gyroscope{62, 30, -4}}; });
  board.accept<amiro::Motors>([&](const amiro::Motors& target) { speed = target.x; });
  // endsnippet

  board.receive(*protocol::publish_every(amiro::Gyroscope::id, 100ms), base::Time{0ms});
  board.receive(protocol::command(amiro::Motors{50'000, 0}), base::Time{0ms});
  for (base::Time now{}; now <= base::Time{600ms}; now += 50ms) {
    std::printf("%3lld ms, speed %d um/s\n", static_cast<long long>(now.time_since_epoch() / 1ms),
                static_cast<int>(speed));
    board.poll(now);
  }
  return speed == 0 ? 0 : 1;  // the watchdog stopped the motors at 500 ms
}
