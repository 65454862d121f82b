#include "ocm/controller/line_parts.hpp"

#include <catch2/catch.hpp>

using namespace ocm;
using controller::LineParts;

namespace {

struct Parts {
  controller::WheelTicks ticks() { return {}; }
  base::Result<float> gyro() { return 0.0F; }
  base::Result<sensing::Field> field() { return sensing::Field{}; }
  base::Result<float> infrared(std::size_t) { return 0.0F; }
  void drive(motion::Efforts) {}
  void turn_tower(std::int32_t) {}
  void show(controller::Lights) {}
  bool linked() { return false; }
  std::size_t send(std::span<const std::uint8_t> bytes) { return bytes.size(); }
};
static_assert(LineParts<Parts>);

struct WithoutTower : private Parts {
  using Parts::drive, Parts::field, Parts::gyro, Parts::infrared, Parts::linked, Parts::send, Parts::show,
      Parts::ticks;
};
static_assert(!LineParts<WithoutTower>);

/// A gyro that cannot fail is none.
struct SureGyro : Parts {
  float gyro() { return 0.0F; }
};
static_assert(!LineParts<SureGyro>);

TEST_CASE("line parts: lamps and ticks are compared by what they hold", "[line_parts]") {
  CHECK(controller::WheelTicks{1, 2} == controller::WheelTicks{1, 2});
  CHECK_FALSE(controller::WheelTicks{1, 2} == controller::WheelTicks{2, 1});
  CHECK_FALSE(controller::Lights{.green = true} == controller::Lights{.yellow = true});
}

}  // namespace
