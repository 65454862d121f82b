/// What a board's processor is connected to, as models that stand in a world: its I2C buses and SPI devices
/// by their numbers, motors, pins. One interface for all boards, for the carrier of an emulated board's
/// transfers; what each returns satisfies the concepts of firmware/drivers/bus.hpp.
///
/// Host only, one thread. The world's owner lets its time pass.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>

#include "firmware/drivers/bus.hpp"
#include "sim/amiro/world.hpp"
#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/parts/spi_device.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

/// Two motors of a world with their encoders.
class MotorsModel {
 public:
  MotorsModel(World& world, Violations& violations) noexcept : world_(&world), violations_(&violations) {}

  /// The counters' low 16 bits; while the world has no encoders the last ones.
  [[nodiscard]] std::array<std::uint16_t, 2> encoders() {
    if (const auto ticks = world_->encoders())
      last_ = {static_cast<std::uint16_t>(ticks->left), static_cast<std::uint16_t>(ticks->right)};
    return last_;
  }
  void set_duty(std::int16_t left, std::int16_t right) {
    if (left == -32768 || right == -32768) violations_->add("motors: duty beyond all");
    if (!powered_ && (left != 0 || right != 0)) violations_->add("motors: duty without power");
    duty_ = {left, right};
    apply();
  }
  void set_power(bool on) {
    powered_ = on;
    apply();
  }
  [[nodiscard]] std::array<std::int16_t, 2> duty() const noexcept { return duty_; }
  [[nodiscard]] bool powered() const noexcept { return powered_; }

 private:
  void apply() {
    const double full = powered_ ? 32767.0 : 0;
    world_->set_duty(full == 0 ? 0 : duty_[0] / full, full == 0 ? 0 : duty_[1] / full);
  }

  World* world_;
  Violations* violations_;
  std::array<std::uint16_t, 2> last_{};
  std::array<std::int16_t, 2> duty_{};
  bool powered_ = false;
};
static_assert(firmware::drivers::MotorTimers<MotorsModel>);

class InputPins {
 public:
  explicit InputPins(std::function<std::uint8_t()> levels = {}) : levels_(std::move(levels)) {}
  [[nodiscard]] std::uint8_t read() const { return levels_ ? levels_() : std::uint8_t{0}; }

 private:
  std::function<std::uint8_t()> levels_;
};
static_assert(firmware::drivers::Inputs<InputPins>);

class OutputPins {
 public:
  explicit OutputPins(std::function<void(std::uint8_t)> changed = {}) : changed_(std::move(changed)) {}
  void write(std::uint8_t levels) {
    if (changed_) changed_(levels);
  }

 private:
  std::function<void(std::uint8_t)> changed_;
};
static_assert(firmware::drivers::Outputs<OutputPins>);

class BoardParts {
 public:
  virtual ~BoardParts() = default;
  BoardParts(const BoardParts&) = delete;
  BoardParts& operator=(const BoardParts&) = delete;

  /// A number that the board does not have is a bus, or a device, without parts.
  [[nodiscard]] virtual I2cBus& i2c(std::uint8_t) { return no_bus_; }
  [[nodiscard]] virtual SpiDevice& spi(std::uint8_t) { return no_device_; }
  /// On a board without motors they turn nothing.
  [[nodiscard]] virtual MotorsModel& motors() { return no_motors_; }
  [[nodiscard]] virtual InputPins& inputs() { return no_inputs_; }
  [[nodiscard]] virtual OutputPins& outputs() { return no_outputs_; }

  /// What drivers did that data sheets forbid.
  [[nodiscard]] Violations& violations() noexcept { return violations_; }

 protected:
  BoardParts() = default;

  Violations violations_;

 private:
  World empty_world_{};
  I2cBus no_bus_{violations_};
  NoSpiDevice no_device_;
  MotorsModel no_motors_{empty_world_, violations_};
  InputPins no_inputs_;
  OutputPins no_outputs_;
};

}  // namespace ocm::sim
