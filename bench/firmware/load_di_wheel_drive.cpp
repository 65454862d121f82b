// DiWheelDrive with its fast sensors every 50 ms: 8 of the robot's 17 fast sensor frames, at four levels; and
// what the behaviours report.
#include "bench/firmware/load.hpp"
#include "firmware/boards/di_wheel_drive/board.hpp"
#include "firmware/boards/di_wheel_drive/parts.hpp"

namespace bench = ocm::bench;
namespace di_wheel_drive = ocm::firmware::boards::di_wheel_drive;
using ocm::protocol::Priority;
using ocm::protocol::TopicId;

namespace {

constexpr std::array<bench::Asked, 5> asked{{
    {TopicId{0x09}, TopicId{0x09}, 1, Priority::low},     // accelerometer
    {TopicId{0x05}, TopicId{0x05}, 3, Priority::low},     // magnetometer
    {TopicId{0x04}, TopicId{0x04}, 1, Priority::medium},  // floor
    {TopicId{0x03}, TopicId{0x02}, 2, Priority::high},    // odometry
    {TopicId{0x08}, TopicId{0x08}, 1, Priority::urgent},  // gyroscope
}};
[[maybe_unused]] constexpr std::array<bench::Asked, 1> slow{{
    {amiro::Behaviour::id, amiro::Behaviour::id, 1, Priority::medium, amiro::Behaviour::period.duration()},
}};

}  // namespace

int main() {
  ocm::firmware::qemu::start_machine();
  static bench::LoadI2c compass{400'000};
  static bench::LoadI2c floor{400'000};
  std::copy_n("H43", 3, &compass.part(0, 0x1E)[10]);  // [HMC5883L data sheet, table 2]
  floor.part(0, 0x13)[0x81] = 0x21;                   // [VCNL4020 data sheet, table 2]
  floor.part(1, 0x77);                                // the multiplexer
  static bench::LoadSpi gyroscope{0xD3};              // [L3G4200D data sheet, WHO_AM_I]
  static bench::LoadSpi accelerometer{0x32};          // [LIS331DLH data sheet, WHO_AM_I]
  static bench::LoadMotors motors;
  static bench::LoadPins pins;
  using Real = di_wheel_drive::Parts<bench::LoadI2c, bench::LoadI2c, bench::LoadSpi, bench::LoadSpi,
                                     bench::LoadMotors, bench::LoadPins, ocm::firmware::chibios::Mutex>;
#if defined OCM_LOAD_BEHAVIOUR || defined OCM_LOAD_COSTS
  // A line under the front pair, whatever the registers say: it takes as long to read.
  struct Parts : Real {
    using Real::Real;
    bench::Longest look;
    ocm::base::Result<ocm::firmware::boards::FloorCounts> floor() noexcept {
      const auto counts = look.of([this] { return Real::floor(); });
      if (!counts) return counts.error;
      return ocm::firmware::boards::FloorCounts{5500, 9000, 9000, 5000};
    }
#ifdef OCM_LOAD_WITHOUT_CONTROL
    void control() = delete;  // the speed controllers are more urgent than all else
#endif
  };
#else
  using Parts = Real;
#endif
  static Parts parts{compass, floor, gyroscope, accelerometer, motors, pins};
#if defined OCM_LOAD_BEHAVIOUR || defined OCM_LOAD_COSTS
  amiro::Follow follow;
  follow.set_speed_m_per_s(0.1);
  static const ocm::can::Frame command = ocm::protocol::command(follow, Priority::medium);
#endif
#ifdef OCM_LOAD_BEHAVIOUR
  bench::measure_behaviour<di_wheel_drive::Board>("di_wheel_drive", asked, command, parts);
#elif defined OCM_LOAD_COSTS
  static constexpr auto all = bench::join(asked, slow);
  bench::measure_costs<di_wheel_drive::Board>("di_wheel_drive", all, parts, &command);
#else
  bench::measure<di_wheel_drive::Board>("di_wheel_drive", asked, slow, parts);
#endif
}
