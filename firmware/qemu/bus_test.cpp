// Sends what tests/firmware/qemu/test_bus.py expects to hear, in its order: the emulated CAN controller's
// arbitration and its pace, with the kernel under it. Exit code 0, or the first broken promise on stderr.
#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"

#include "firmware/chibios/port.hpp"
#include "firmware/qemu/machine.hpp"
#include "firmware/qemu/slcan_bus.hpp"

namespace {

using namespace std::chrono_literals;
namespace base = ocm::base;
namespace can = ocm::can;
namespace chibios = ocm::firmware::chibios;
using ocm::firmware::qemu::SlcanBus;

void require(bool holds, const char* what) {
  if (!holds) ocm::firmware::qemu::leave(what, 1);
}

bool send(SlcanBus& bus, std::uint32_t id) {
  const auto sent = bus.send({.id = id, .dlc = 8, .data = {}, .format = can::Format::base});
  require(sent.ok(), "a frame that exists was refused for good");
  return *sent;
}

void expect(SlcanBus& bus, chibios::BusEvent event) {
  can::Frame frame;
  require(bus.wait(frame) == event, "another event than was due");
}

}  // namespace

int main() {
  ocm::firmware::qemu::start_machine();
  static ocm::firmware::qemu::Uart line{1};
  static chibios::Port port;
  static SlcanBus bus{line, port};
  bus.start();
  can::Frame frame;
  require(bus.wait(frame) == chibios::BusEvent::frame && frame.id == 0x123, "the host's frame did not come");

  const base::Time begin = port.now();
  {
    const auto lock = port.lock();
    require(send(bus, 0x7F0), "an idle bus takes a frame");  // is on the wire, its place is free again
    require(send(bus, 0x7F3), "a place");
    require(send(bus, 0x7F1), "a place");
    require(send(bus, 0x7F2), "a place");
    require(!send(bus, 0x7EF), "a level has three places");
    require(send(bus, 0x4FF), "an urgent frame finds a place whatever waits below");
    require(send(bus, 0x601), "medium too");
    require(!*bus.send({.id = 0x7EF, .dlc = 1, .data = {}, .format = can::Format::base}), "still full");
    require(!bus.send({.id = 0x800, .dlc = 1, .data = {}, .format = can::Format::base}).ok(),
            "no such frame");
  }
  // Heard: 7F0, then by identifier 4FF, 601, 7F1, 7F2, 7F3. The receiver learns of each place that becomes
  // free; those of one look are one.
  expect(bus, chibios::BusEvent::writable);
  for (bool sent = false; !sent;) {
    expect(bus, chibios::BusEvent::writable);
    const auto lock = port.lock();
    sent = send(bus, 0x7EF);  // at the end of 7F1's wait, so between 7F1 and 7F2
  }
  const base::Duration bits =
      2us * can::frame_bits({.id = 0x7F0, .dlc = 8, .data = {}, .format = can::Format::base});
  require(port.now() - begin > 3 * bits * 9 / 10, "frames that take no time");
  static_cast<void>(bus.wait(frame));  // the host says when it has heard all
  while (frame.id != 0x124) static_cast<void>(bus.wait(frame));
  ocm::firmware::qemu::leave("all kept", 0);
}
