/// Register model of the magnetometer HMC5883L. [data sheet: Honeywell HMC5883L, form 900405 Rev E]
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

class Hmc5883lModel : public I2cPart {
 public:
  /// `field()` is in microgauss.
  Hmc5883lModel(Violations& violations, PartClock now, std::function<firmware::boards::MagneticField()> field)
      : I2cPart(0x1E), violations_(&violations), now_(std::move(now)), field_(std::move(field)) {
    Hmc5883lModel::power_up();
  }

  bool write(std::span<const std::uint8_t> bytes) override {
    if (bytes.empty()) return true;
    pointer_ = bytes[0];
    if (bytes.size() > 2)
      violations_->add("HMC5883L: several registers in one write: no increment is promised");
    if (bytes.size() > 1) store(bytes[1]);
    return true;
  }

  void read(std::span<std::uint8_t> bytes) override {
    for (std::uint8_t& byte : bytes) {
      byte = fetch(pointer_);
      ++pointer_;
    }
  }

 private:
  void power_up() override {
    configuration_ = {0x10, 0x20};
    mode_ = 0x01;
    data_.fill(0);
    read_.fill(false);
    locked_ = false;
    on_since_ = now_();
    pointer_ = 0;
  }

  void store(std::uint8_t value) {
    if (pointer_ == 0) {
      if ((value & 0x80) != 0) violations_->add("HMC5883L: bit 7 of configuration A is reserved");
      if ((value >> 2 & 7) == 7) violations_->add("HMC5883L: reserved output rate");
      configuration_[0] = value & 0x7F;
      locked_ = false;
    } else if (pointer_ == 1) {
      if ((value & 0x1F) != 0) violations_->add("HMC5883L: bits 4 to 0 of configuration B must be clear");
      configuration_[1] = value & 0xE0;
    } else if (pointer_ == 2) {
      if ((value & 0x7C) != 0) violations_->add("HMC5883L: reserved bits of the mode");
      mode_ = value & 0x83;
      locked_ = false;
      mode_since_ = now_();
    } else {
      violations_->add("HMC5883L: write to a register that can only be read");
    }
  }

  [[nodiscard]] std::uint8_t fetch(std::uint8_t where) {
    switch (where) {
      case 0:
      case 1:
        return configuration_[where];
      case 2:
        locked_ = true;
        read_.fill(false);
        return mode_;
      case 9:
        return static_cast<std::uint8_t>((locked_ ? 0x02 : 0x00) | (measuring() ? 0x01 : 0x00));
      case 10:
        return 0x48;
      case 11:
        return 0x34;
      case 12:
        return 0x33;
      default:
        return where < 9 ? output(where - 3U) : 0;
    }
  }

  [[nodiscard]] bool measuring() const { return (mode_ & 0x03) == 0; }

  [[nodiscard]] std::uint8_t output(std::size_t i) {
    if (!locked_) {
      measure();
      locked_ = true;
      read_.fill(false);
    }
    read_[i] = true;
    const std::uint8_t byte = data_[i];
    if (std::all_of(read_.begin(), read_.end(), [](bool r) { return r; })) locked_ = false;
    return byte;
  }

  void measure() {
    const base::Time now = now_();
    if (now - on_since_ < std::chrono::milliseconds{50}) return;  // the analogue part is not ready
    if (!measuring() || now - mode_since_ < std::chrono::milliseconds{6}) return;
    static constexpr double per_gauss[] = {1370, 1090, 820, 660, 440, 390, 330, 230};  // [table 9]
    const unsigned gain = configuration_[1] >> 5;
    const auto put = [&](std::size_t at, std::int32_t microgauss) {
      // 390 counts/G is 2.56 mG a count, which is how the world counts.
      const double count = gain == 5 ? microgauss / 2560.0 : microgauss * per_gauss[gain] * 1e-6;
      const double rounded = std::round(count);
      const auto word = static_cast<std::uint16_t>(
          static_cast<std::int16_t>(rounded < -2048 || rounded > 2047 ? -4096 : rounded));
      data_[at] = static_cast<std::uint8_t>(word >> 8);
      data_[at + 1] = static_cast<std::uint8_t>(word & 0xFF);
    };
    const firmware::boards::MagneticField field = field_();
    put(0, field.x);
    put(2, field.z);
    put(4, field.y);
  }

  Violations* violations_;
  PartClock now_;
  std::function<firmware::boards::MagneticField()> field_;
  std::array<std::uint8_t, 2> configuration_{};
  std::uint8_t mode_ = 0;
  std::array<std::uint8_t, 6> data_{};
  std::array<bool, 6> read_{};
  bool locked_ = false;
  std::uint8_t pointer_ = 0;
  base::Time on_since_{}, mode_since_{};
};

}  // namespace ocm::sim
