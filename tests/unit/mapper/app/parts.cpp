#include "ocm/mapper/app/parts.hpp"

#include <catch2/catch.hpp>

namespace mapper_app_parts_test {

using namespace ocm;
using mapper::app::RobotParts;

struct Parts {
  mapper::app::WheelTicks ticks() { return {}; }
  base::Result<float> gyro() { return 0.0F; }
  base::Result<sensing::Field> field() { return sensing::Field{}; }
  base::Result<float> infrared(std::size_t) { return 0.0F; }
  void drive(motion::Efforts) {}
  void turn_tower(std::int32_t) {}
  void show(mapper::app::Lights) {}
  bool linked() { return false; }
  std::size_t send(std::span<const std::uint8_t> bytes) { return bytes.size(); }
  void store(const sensing::CompassFit&) {}
  base::Result<sensing::CompassFit> stored() { return base::Error::not_sampled; }
};
static_assert(RobotParts<Parts>);

struct WithoutTower : private Parts {
  using Parts::drive, Parts::field, Parts::gyro, Parts::infrared, Parts::linked, Parts::send, Parts::show,
      Parts::store, Parts::stored, Parts::ticks;
};
static_assert(!RobotParts<WithoutTower>);

/// A robot that forgets its calibration when it is switched off has to say so: `stored` is always
/// not_sampled.
struct WithoutMemory : private Parts {
  using Parts::drive, Parts::field, Parts::gyro, Parts::infrared, Parts::linked, Parts::send, Parts::show,
      Parts::ticks, Parts::turn_tower;
};
static_assert(!RobotParts<WithoutMemory>);

/// A gyro that cannot fail is none.
struct SureGyro : Parts {
  float gyro() { return 0.0F; }
};
static_assert(!RobotParts<SureGyro>);

TEST_CASE("mapper parts: lamps and ticks are compared by what they hold", "[mapper_parts]") {
  CHECK(mapper::app::WheelTicks{1, 2} == mapper::app::WheelTicks{1, 2});
  CHECK_FALSE(mapper::app::WheelTicks{1, 2} == mapper::app::WheelTicks{2, 1});
  CHECK_FALSE(mapper::app::Lights{.green = true} == mapper::app::Lights{.yellow = true});
}

}  // namespace mapper_app_parts_test
