#include "ocm/motion/soft_pwm.hpp"

#include <limits>

#include <catch2/catch.hpp>

namespace motion_soft_pwm_test {

using namespace ocm::motion;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

static_assert(duty(1.0F, 0.02F) == MotorDuty{true, 100} && duty(-0.5F, 0.02F) == MotorDuty{false, 50});
static_assert(duty(0.1F, 0.02F) == MotorDuty{true, 40}, "raised to what moves the motor");
static_assert(duty(-0.1F, 0.02F) == MotorDuty{false, 40});
static_assert(duty(0.01F, 0.02F).percent == 0 && duty(0.0F, 0.0F).percent == 0);
static_assert(duty(0.25F, 0.25F) == MotorDuty{true, 40}, "the dead band ends before it");
static_assert(MotorDuty{} == MotorDuty{true, 0}, "off");
static_assert(duty(7.0F, 0.0F) == MotorDuty{true, 100} && duty(nan, 0.0F) == MotorDuty{});
static_assert(duty(std::numeric_limits<float>::infinity(), 0.0F) == MotorDuty{});

TEST_CASE("between its bounds a motor gets the share that was asked for", "[motion]") {
  for (int percent = 40; percent <= 100; ++percent) {
    const float effort = static_cast<float>(percent) / 100.0F;
    CHECK(duty(effort, 0.02F) == MotorDuty{true, static_cast<std::uint8_t>(percent)});
    CHECK(duty(-effort, 0.02F) == MotorDuty{false, static_cast<std::uint8_t>(percent)});
  }
}

}  // namespace motion_soft_pwm_test
