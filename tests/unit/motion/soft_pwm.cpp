#include "ocm/motion/soft_pwm.hpp"

#include <limits>

#include <catch2/catch.hpp>

namespace motion_soft_pwm_test {

using namespace ocm::motion;
using namespace std::chrono_literals;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

static_assert(duty(1.0F, 0.02F) == MotorDuty{true, 100} && duty(-0.5F, 0.02F) == MotorDuty{false, 50});
static_assert(duty(0.1F, 0.02F) == MotorDuty{true, 40}, "raised to what moves the motor");
static_assert(duty(-0.1F, 0.02F) == MotorDuty{false, 40});
static_assert(duty(0.01F, 0.02F).percent == 0 && duty(0.0F, 0.0F).percent == 0);
static_assert(duty(7.0F, 0.0F) == MotorDuty{true, 100} && duty(nan, 0.0F) == MotorDuty{});
static_assert(duty(std::numeric_limits<float>::infinity(), 0.0F) == MotorDuty{});

// Slots of 20 ms, 40 to 100 %. [T2 listing 10.1]
static_assert(on_time({true, 40}) == 8ms && on_time({true, 100}) == 20ms && on_time({true, 0}) == 0ms);
static_assert(on_time({true, 255}) == 20ms);

constexpr MotorDuty forty{true, 40};
static_assert(is_on(forty, 0ms) && is_on(forty, 7'999us) && !is_on(forty, 8ms) && !is_on(forty, 19'999us));
static_assert(is_on(forty, 20ms) && !is_on(forty, 28ms) && !is_on(forty, -1ms));

TEST_CASE("over a second a motor is on for its share", "[motion]") {
  for (int percent = 0; percent <= 100; percent += 10) {
    int on = 0;
    for (int ms = 0; ms < 1000; ++ms) {
      on += is_on({true, static_cast<std::uint8_t>(percent)}, std::chrono::milliseconds{ms}) ? 1 : 0;
    }
    CHECK(on == percent * 10);
  }
}

}  // namespace motion_soft_pwm_test
