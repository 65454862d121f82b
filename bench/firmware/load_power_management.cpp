// PowerManagement with its fast sensors every 50 ms: 9 frames; and the slow ones, which are on the same
// buses.
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
[[maybe_unused]] constexpr std::array<bench::Asked, 2> slow{{
    {TopicId{0x2B}, TopicId{0x2B}, 2, Priority::medium, amiro::Batteries::period.duration()},
    {TopicId{0x2D}, TopicId{0x2D}, 8, Priority::medium, amiro::RingLight::period.duration()},
}};

/// A gauge, and four of the ring's sensors, which are one behind a multiplexer that is always open.
void fit(bench::LoadI2c& bus) {
  static constexpr std::uint8_t device_type[] = {0x00, 0x05};  // [bq27500 data sheet, 4.1.1.1.2]
  auto& gauge = bus.part(0, 0x55, device_type);
  gauge[0x0A] = 0x08;  // a battery is there [bq27500 data sheet, table 4-4]
  gauge[0x2C] = 80;
  bus.part(1, 0x13)[0x81] = 0x21;
  bus.set_always(1, 0x80, 0x40);  // ambient light was measured [VCNL4020 data sheet, table 1]
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
  using Real =
      power_management::Parts<bench::LoadI2c, bench::LoadI2c, bench::LoadPins, ocm::firmware::chibios::Mutex>;
#ifdef OCM_LOAD_BEHAVIOUR
  // Something is near on all sides, whatever the registers say: it takes as long to read.
  struct Parts : Real {
    using Real::Real;
    bench::Longest look;
    ocm::base::Result<ocm::firmware::boards::RingCounts> ring() noexcept {
      const auto counts = look.of([this] { return Real::ring(); });
      if (!counts) return counts.error;
      return ocm::firmware::boards::RingCounts{2400, 2410, 2420, 2430, 2440, 2450, 2460, 2470};
    }
    [[nodiscard]] std::uint16_t ring_offset(std::size_t /*sensor*/) const noexcept { return 2300; }
  };
  static Parts parts{back, front, pins};
  amiro::Avoid avoid;
  avoid.set_speed_m_per_s(0.1);
  static const ocm::can::Frame command = ocm::protocol::command(avoid, Priority::medium);
  bench::measure_behaviour<power_management::Board>("power_management", asked, command, parts);
#else
  static Real parts{back, front, pins};
#ifdef OCM_LOAD_COSTS
  static constexpr auto all = bench::join(asked, slow);
  bench::measure_costs<power_management::Board>("power_management", all, parts);
#else
  bench::measure<power_management::Board>("power_management", asked, slow, parts);
#endif
#endif
}
