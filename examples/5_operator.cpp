/// An operator: a program on the robot's Linux, or on a laptop at the bus. Give it a CAN interface, or
/// nothing for the simulator that `amiroctl sim` runs.
#include <cstdio>
#include <memory>

#include "ocm/client/robot.hpp"
#include "ocm/topics/amiro.hpp"
#include "ocm/transport/socketcan.hpp"
#include "ocm/transport/virtual_bus.hpp"

using namespace ocm;
using namespace std::chrono_literals;

int listen(transport::Bus& bus) {
  // snippet: operator
  client::Robot robot{bus, amiro::catalogue};
  if (!robot.publish<amiro::Gyroscope>(100ms, protocol::Priority::high)) return 1;
  for (int count = 0; count < 5; ++count) {
    const auto sample = robot.next(1s);
    if (!sample) return 1;
    if (const auto gyroscope = sample->as<amiro::Gyroscope>())
      std::printf("turning at %.4f deg/s\n", gyroscope->z_deg_per_s());
  }
  return robot.stop<amiro::Gyroscope>() ? 0 : 1;
  // endsnippet
}

// snippet: operator-bus
template <class Opened>
int listen_on(const Opened& bus) {
  if (bus) return listen(**bus);
  std::fprintf(stderr, "%s\n%s\n", bus.error.what.c_str(), bus.error.remedy.c_str());
  return 1;
}
// endsnippet

int main(int argc, char** argv) {
  return argc > 1 ? listen_on(transport::SocketCan::open(argv[1])) : listen_on(transport::VirtualBus::open());
}
