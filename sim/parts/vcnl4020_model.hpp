/// Register model of the sensor of proximity and ambient light VCNL4020. [data sheet: Vishay VCNL4020,
/// document 83476]
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "ocm/base/time.hpp"

#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

class Vcnl4020Model : public I2cPart {
 public:
  /// `counts()` is what the part measures at 200 mA, `light()` of ambient light.
  Vcnl4020Model(
      Violations& violations, PartClock now, std::function<std::uint16_t()> counts,
      std::function<std::uint16_t()> light = [] { return std::uint16_t{0}; })
      : I2cPart(0x13),
        violations_(&violations),
        now_(std::move(now)),
        counts_(std::move(counts)),
        light_(std::move(light)) {
    Vcnl4020Model::power_up();
  }

  bool write(std::span<const std::uint8_t> bytes) override {
    if (bytes.empty()) return true;
    pointer_ = bytes[0];
    if (pointer_ < first || pointer_ > last) {
      violate("register " + std::to_string(pointer_) + " is none");
      return false;
    }
    for (const std::uint8_t value : bytes.subspan(1)) {
      store(value);
      ++pointer_;
    }
    return true;
  }

  void read(std::span<std::uint8_t> bytes) override {
    measure();
    for (std::uint8_t& byte : bytes) {
      byte = pointer_ >= first && pointer_ <= last ? registers_[pointer_ - first] : 0xFF;
      if (pointer_ == result || pointer_ == result + 1) at(command) &= 0xDF;    // prox_data_rdy goes
      if (pointer_ == ambient || pointer_ == ambient + 1) at(command) &= 0xBF;  // als_data_rdy
      ++pointer_;
    }
  }

 private:
  static constexpr std::uint8_t first = 0x80, last = 0x90, command = 0x80, identity = 0x81, rate = 0x82,
                                led = 0x83, parameter = 0x84, ambient = 0x85, result = 0x87;

  void power_up() override {
    registers_.fill(0);
    at(command) = 0x80;
    at(identity) = 0x21;
    at(led) = 0x02;
    at(parameter) = 0x1D;
    at(0x8F) = 0x01;
    pointer_ = command;
  }

  [[nodiscard]] std::uint8_t& at(std::uint8_t where) { return registers_[where - first]; }
  void violate(const std::string& what) { violations_->add("VCNL4020: " + what); }
  [[nodiscard]] bool self_timed() { return (at(command) & 0x01) != 0; }

  void store(std::uint8_t value) {
    switch (pointer_) {
      case command:
        if ((value & 0x18) != 0 && (value & 0x01) != 0) violate("measurement on demand while self-timed");
        if ((value & 0x01) != 0 && !self_timed()) since_ = now_();
        at(command) = static_cast<std::uint8_t>(0x80 | (at(command) & 0x60) | (value & 0x1F));
        return;
      case rate:
        if (self_timed()) return violate("rate changed while self-timed");
        if ((value & 0xF8) != 0) violate("reserved bits of the rate");
        at(rate) = value & 0x07;
        return;
      case led:
        if ((value & 0x3F) > 20) violate("LED current above 200 mA");
        if ((value & 0xC0) != 0) violate("bits 7 and 6 of the LED current can only be read");
        at(led) = static_cast<std::uint8_t>(std::min(value & 0x3F, 20));
        return;
      case parameter:
        if (self_timed()) return violate("rate changed while self-timed");
        if ((value & 0x80) != 0) violate("continuous conversion is for measurements on demand");
        at(parameter) = value;
        return;
      case 0x89:
      case 0x8A:
      case 0x8B:
      case 0x8C:
      case 0x8D:
      case 0x8E:
        at(pointer_) = value;
        return;
      case 0x8F:
        return violate("the modulator's timing is the maker's");
      default:
        return violate("write to a register that can only be read");
    }
  }

  void measure() {
    measure_light();
    if (!self_timed() || (at(command) & 0x02) == 0) return;
    const base::Duration period =
        std::chrono::nanoseconds{512'000'000} / (1 << at(rate));  // 1.953125/s << rate
    if (now_() - since_ < period) return;
    const auto word = static_cast<std::uint16_t>(counts_() * at(led) / 20);
    at(result) = static_cast<std::uint8_t>(word >> 8);
    at(result + 1) = static_cast<std::uint8_t>(word & 0xFF);
    at(command) |= 0x20;
  }

  void measure_light() {
    static constexpr std::array<int, 8> a_second{1, 2, 3, 4, 5, 6, 8, 10};
    if (!self_timed() || (at(command) & 0x04) == 0) return;
    const base::Duration period =
        base::Duration{std::chrono::seconds{1}} / a_second[at(parameter) >> 4 & 0x07];
    if (now_() - since_ < period) return;
    const std::uint16_t word = light_();
    at(ambient) = static_cast<std::uint8_t>(word >> 8);
    at(ambient + 1) = static_cast<std::uint8_t>(word & 0xFF);
    at(command) |= 0x40;
  }

  Violations* violations_;
  PartClock now_;
  std::function<std::uint16_t()> counts_;
  std::function<std::uint16_t()> light_;
  std::array<std::uint8_t, last - first + 1> registers_{};
  std::uint8_t pointer_ = command;
  base::Time since_{};
};

}  // namespace ocm::sim
