/// Register models of ST's gyroscope L3G4200D and accelerometer LIS331DLH, on SPI. They satisfy
/// firmware::drivers::Spi.
///
/// They share the SPI protocol, the places of their registers and the bits of CTRL_REG4 that count here.
/// [data sheets: L3G4200D, ST Doc ID 17116 Rev 3; LIS331DLH, ST Doc ID 15094 Rev 3; AN3393, 2.4]
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/parts/spi_device.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

class StMotionModel : public SpiDevice {
 public:
  using Axes = std::array<std::int16_t, 3>;  ///< as the output registers have them

  void set_present(bool present) { present_ = present; }
  void set_presence(std::function<bool()> presence) { presence_ = std::move(presence); }
  /// The next frames fail as a bus does.
  void set_stuck(bool stuck) noexcept { stuck_ = stuck; }

  base::Status transfer(const firmware::drivers::SpiSettings& settings, std::span<const std::uint8_t> out,
                        std::span<std::uint8_t> in) override {
    if (stuck_) return base::Error::bus_fault;
    if (!here()) {
      std::fill(in.begin(), in.end(), std::uint8_t{0xFF});  // the line is not driven, and pulled up
      return {};
    }
    if (settings.highest_clock_hz > 10'000'000) {
      violate("SPI clock above 10 MHz");
      std::fill(in.begin(), in.end(), std::uint8_t{0xA5});
      return {};
    }
    if (settings.mode != 3) violate("SPI mode " + std::to_string(settings.mode) + ": the clock idles high");
    if (settings.mode == 1 || settings.mode == 2) {  // taken at the other edge: everything is one bit late
      std::vector<std::uint8_t> late = shifted(out);
      exchange(late, in);
      const std::vector<std::uint8_t> answer = shifted(in);
      std::copy(answer.begin(), answer.end(), in.begin());
      return {};
    }
    exchange(out, in);
    return {};
  }

 protected:
  StMotionModel(std::string name, std::uint8_t identity, std::uint8_t ctrl_reg1, Violations& violations,
                PartClock now)
      : violations_(&violations),
        now_(std::move(now)),
        name_(std::move(name)),
        identity_(identity),
        reset_ctrl_reg1_(ctrl_reg1) {
    StMotionModel::power_up();
  }

  [[nodiscard]] virtual bool on() const = 0;                 ///< by CTRL_REG1
  [[nodiscard]] virtual base::Duration turn_on() const = 0;  ///< from then on to good samples
  [[nodiscard]] virtual Axes measure() const = 0;            ///< at the range of CTRL_REG4
  [[nodiscard]] virtual std::uint8_t reserved(std::uint8_t where) const = 0;  ///< bits that must be 0

  [[nodiscard]] std::uint8_t at(std::uint8_t where) const noexcept { return registers_[where]; }
  void violate(const std::string& what) { violations_->add(name_ + ": " + what); }

 private:
  static constexpr std::uint8_t who_am_i = 0x0F, first_control = 0x20, last_control = 0x24,
                                temperature = 0x26, status = 0x27, first_output = 0x28, last_output = 0x2D;

  [[nodiscard]] bool here() {
    const bool now = present_ && (!presence_ || presence_());
    if (now && away_) power_up();
    away_ = !now;
    return now;
  }

  void power_up() {
    registers_.fill(0);
    registers_[who_am_i] = identity_;
    registers_[first_control] = reset_ctrl_reg1_;
    was_on_ = false;
  }

  [[nodiscard]] static std::vector<std::uint8_t> shifted(std::span<const std::uint8_t> bytes) {
    std::vector<std::uint8_t> late;
    unsigned carry = 1;
    for (const std::uint8_t byte : bytes) {
      late.push_back(static_cast<std::uint8_t>(carry << 7 | byte >> 1));
      carry = byte & 1U;
    }
    return late;
  }

  void exchange(std::span<const std::uint8_t> out, std::span<std::uint8_t> in) {
    std::fill(in.begin(), in.end(), std::uint8_t{0xFF});
    if (out.size() < 2) return violate("a frame of fewer than 16 clocks");
    const bool reading = (out[0] & 0x80) != 0;
    const bool next = (out[0] & 0x40) != 0;
    std::uint8_t where = out[0] & 0x3F;
    if (!next && out.size() > 2) violate("several bytes without the MS bit: the address stays");
    if (reading) sample();
    for (std::size_t i = 1; i < out.size(); ++i) {
      if (reading)
        in[i] = registers_[where];
      else
        store(where, out[i]);
      if (next) where = (where + 1) & 0x3F;
    }
  }

  void store(std::uint8_t where, std::uint8_t value) {
    if (where < first_control || where > last_control)
      return violate("write to register " + std::to_string(where) + ", which is not one of control");
    if ((value & reserved(where)) != 0) violate("reserved bits in register " + std::to_string(where));
    registers_[where] = value;
    if (on() && !was_on_) on_since_ = now_();
    was_on_ = on();
  }

  /// New data into the output registers, before they are read.
  void sample() {
    if (!on()) {
      registers_[status] = 0;
      return;
    }
    const bool settled = now_() - on_since_ >= turn_on();
    const Axes axes = settled ? measure() : Axes{};
    registers_[status] = settled ? 0x0F : 0x00;  // new data on all axes
    const bool big_endian = (registers_[0x23] & 0x40) != 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto word = static_cast<std::uint16_t>(axes[i]);
      const auto low = static_cast<std::uint8_t>(word & 0xFF), high = static_cast<std::uint8_t>(word >> 8);
      registers_[first_output + 2 * i] = big_endian ? high : low;
      registers_[first_output + 2 * i + 1] = big_endian ? low : high;
    }
  }

  Violations* violations_;
  PartClock now_;
  std::string name_;
  std::uint8_t identity_;
  std::uint8_t reset_ctrl_reg1_;
  std::array<std::uint8_t, 64> registers_{};
  base::Time on_since_{};
  bool was_on_ = false;
  bool present_ = true;
  bool away_ = false;
  bool stuck_ = false;
  std::function<bool()> presence_;
};

/// `rate()` is in 0.0175 deg/s.
class L3g4200dModel : public StMotionModel {
 public:
  L3g4200dModel(Violations& violations, PartClock now, std::function<firmware::boards::AngularRate()> rate)
      : StMotionModel("L3G4200D", 0xD3, 0x07, violations, std::move(now)), rate_(std::move(rate)) {}

 private:
  [[nodiscard]] bool on() const override { return (at(0x20) & 0x08) != 0; }  // PD
  [[nodiscard]] base::Duration turn_on() const override { return std::chrono::milliseconds{300}; }
  [[nodiscard]] std::uint8_t reserved(std::uint8_t where) const override {
    switch (where) {
      case 0x21:
        return 0xC0;
      case 0x23:
        return 0x08;
      case 0x24:
        return 0x20;
      default:
        return 0;
    }
  }
  [[nodiscard]] Axes measure() const override {
    static constexpr double mdps[] = {8.75, 17.5, 70, 70};  // by FS [table 4]
    const double scale = 17.5 / mdps[at(0x23) >> 4 & 3];
    const auto digit = [&](std::int16_t value, std::uint8_t enabled) {
      if ((at(0x20) & enabled) == 0) return std::int16_t{0};
      return static_cast<std::int16_t>(std::clamp(std::round(value * scale), -32768.0, 32767.0));
    };
    const firmware::boards::AngularRate rate = rate_();
    return {digit(rate.x, 0x01), digit(rate.y, 0x02), digit(rate.z, 0x04)};
  }

  std::function<firmware::boards::AngularRate()> rate_;
};

/// `force()` is in 1/1024 g.
class Lis331dlhModel : public StMotionModel {
 public:
  Lis331dlhModel(Violations& violations, PartClock now,
                 std::function<firmware::boards::SpecificForce()> force)
      : StMotionModel("LIS331DLH", 0x32, 0x07, violations, std::move(now)), force_(std::move(force)) {}

 private:
  [[nodiscard]] unsigned rate() const { return at(0x20) >> 3 & 3; }
  [[nodiscard]] bool on() const override { return (at(0x20) >> 5) != 0; }  // PM
  [[nodiscard]] base::Duration turn_on() const override {                  // 1/ODR + 1 ms
    static constexpr std::int64_t hertz[] = {50, 100, 400, 1000};
    return std::chrono::nanoseconds{1'000'000'000 / hertz[rate()]} + std::chrono::milliseconds{1};
  }
  [[nodiscard]] std::uint8_t reserved(std::uint8_t where) const override { return where == 0x24 ? 0xFC : 0; }
  [[nodiscard]] Axes measure() const override {
    static constexpr double per_g[] = {1024, 512, 0, 256};  // by FS [table 3]; 10 is none
    const double scale = per_g[at(0x23) >> 4 & 3] / 1024;
    const auto left_justified = [&](std::int16_t value, std::uint8_t enabled) {
      if ((at(0x20) & enabled) == 0) return std::int16_t{0};
      const double digit = std::clamp(std::floor(value * scale), -2048.0, 2047.0);
      return static_cast<std::int16_t>(static_cast<std::int16_t>(digit) * 16);
    };
    const firmware::boards::SpecificForce force = force_();
    return {left_justified(force.x, 0x01), left_justified(force.y, 0x02), left_justified(force.z, 0x04)};
  }

  std::function<firmware::boards::SpecificForce()> force_;
};

}  // namespace ocm::sim
