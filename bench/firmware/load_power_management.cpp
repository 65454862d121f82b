// PowerManagement with its sensors every 50 ms: 9 of the robot's 17 sensor frames.
#include "bench/firmware/load.hpp"
#include "firmware/boards/power_management/board.hpp"
#include "firmware/boards/power_management/parts.hpp"

namespace bench = ocm::bench;
namespace power_management = ocm::firmware::boards::power_management;
using ocm::protocol::Priority;
using ocm::protocol::TopicId;

namespace {

constexpr std::array<bench::Asked, 2> asked{{
    {TopicId{0x1E}, TopicId{0x1E}, 1, Priority::low},     // power
    {TopicId{0x1F}, TopicId{0x1F}, 8, Priority::medium},  // ring
}};

/// A gauge, and four of the ring's sensors, which are one behind a multiplexer that is always open.
void fit(bench::LoadI2c& bus) {
  static constexpr std::uint8_t device_type[] = {0x00, 0x05};  // [bq27500 data sheet, 4.1.1.1.2]
  auto& gauge = bus.part(0, 0x55, device_type);
  gauge[0x0A] = 0x08;  // a battery is there [bq27500 data sheet, table 4-4]
  gauge[0x2C] = 80;
  bus.part(1, 0x13)[0x81] = 0x21;
  bus.part(2, 0x77);
}

}  // namespace

int main() {
  ocm::firmware::qemu::start_machine();
  static bench::LoadI2c back{100'000};
  static bench::LoadI2c front{100'000};
  fit(back);
  fit(front);
  static bench::LoadPins pins;
  static power_management::Parts<bench::LoadI2c, bench::LoadI2c, bench::LoadPins,
                                 ocm::firmware::chibios::Mutex>
      parts{back, front, pins};
  bench::measure<power_management::Board>("power_management", asked, parts);
}
