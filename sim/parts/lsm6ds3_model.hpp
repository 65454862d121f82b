/// Register model of the LSM6DS3, its gyroscope, on SPI. It satisfies firmware::drivers::Spi.
/// [data sheet: ST LSM6DS3, DocID026899 Rev 8; AN4650: ST application note, DocID027415 Rev 5]
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

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bus.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/parts/spi_device.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

class Lsm6ds3Model : public SpiDevice {
 public:
  /// rad/s about x, y and z.
  using Rates = firmware::boards::Axes<double>;

  Lsm6ds3Model(Violations& violations, PartClock now, std::function<Rates()> rates)
      : violations_(&violations), now_(std::move(now)), rates_(std::move(rates)) {
    power_up();
  }

  /// Takes the part off the board, or puts it back: it then begins as after power-up.
  void set_present(bool present) { present_ = present; }
  /// Whether it is there, asked each time; besides `set_present`.
  void set_presence(std::function<bool()> presence) { presence_ = std::move(presence); }
  /// The next frames fail as a bus does.
  void set_stuck(bool stuck) noexcept { stuck_ = stuck; }

  base::Status transfer(const firmware::drivers::SpiSettings& settings, std::span<const std::uint8_t> out,
                        std::span<std::uint8_t> in) override {
    if (stuck_) return base::Error::bus_fault;
    std::fill(in.begin(), in.end(), std::uint8_t{0xFF});  // the line is not driven, and pulled up
    if (!here()) return {};
    if (settings.highest_clock_hz > 10'000'000) {
      violate("SPI clock above 10 MHz");
      std::fill(in.begin(), in.end(), std::uint8_t{0xA5});
    } else if (settings.mode != 3) {
      violate("SPI mode " + std::to_string(settings.mode) + ": the clock idles high");
      std::fill(in.begin(), in.end(), std::uint8_t{0xA5});
    } else if (out.size() < 2) {
      violate("a frame of fewer than 16 clocks");
    } else {
      exchange(out, in);
    }
    return {};
  }

 private:
  static constexpr std::uint8_t who_am_i = 0x0F, ctrl2_g = 0x11, ctrl3_c = 0x12, ctrl10_c = 0x19,
                                status = 0x1E, outx_l_g = 0x22, increments = 0x04, big_endian = 0x02,
                                reset = 0x81;

  [[nodiscard]] bool here() {
    const bool now = present_ && (!presence_ || presence_());
    if (now && away_) power_up();
    away_ = !now;
    return now;
  }

  void power_up() {
    registers_.fill(0);
    registers_[who_am_i] = 0x69;
    registers_[ctrl3_c] = increments;
    registers_[0x18] = 0x38;  // CTRL9_XL and CTRL10_C: all axes [9.20, 9.21]
    registers_[ctrl10_c] = 0x38;
  }

  void exchange(std::span<const std::uint8_t> out, std::span<std::uint8_t> in) {
    const bool reading = (out[0] & 0x80) != 0;
    std::uint8_t where = out[0] & 0x7F;
    if ((registers_[ctrl3_c] & increments) == 0 && out.size() > 2)
      violate("several bytes without IF_INC: the address stays");
    if (reading) sample();
    for (std::size_t i = 1; i < out.size(); ++i) {
      if (reading)
        in[i] = registers_[where];
      else
        store(where, out[i]);
      if ((registers_[ctrl3_c] & increments) != 0) where = (where + 1) & 0x7F;
    }
  }

  void store(std::uint8_t where, std::uint8_t value) {
    if (where < 0x10 || where > ctrl10_c)
      return violate("write to register " + std::to_string(where) + ", which is not one of control");
    if (where == ctrl2_g && ((value & 0x01) != 0 || value >> 4 > 8)) violate("reserved bits in CTRL2_G");
    if (where == ctrl3_c && (value & reset) != 0) return power_up();
    const bool was_on = on();
    registers_[where] = value;
    if (on() && !was_on) on_since_ = now_();
  }

  [[nodiscard]] bool on() const { return registers_[ctrl2_g] >> 4 != 0; }  // ODR_G [table 51]

  /// New data into the output registers, before they are read.
  void sample() {
    const bool settled = on() && now_() - on_since_ >= std::chrono::milliseconds{80};
    registers_[status] = settled ? 0x02 : 0x00;  // GDA
    const Rates rates = settled ? rates_() : Rates{};
    const std::array<double, 3> axes{rates.x, rates.y, rates.z};
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const bool enabled = (registers_[ctrl10_c] >> (3 + i) & 1) != 0;
      const auto word = static_cast<std::uint16_t>(enabled ? digits(axes[i]) : std::int16_t{0});
      const auto low = static_cast<std::uint8_t>(word & 0xFF), high = static_cast<std::uint8_t>(word >> 8);
      const bool swapped = (registers_[ctrl3_c] & big_endian) != 0;
      registers_[outx_l_g + 2 * i] = swapped ? high : low;
      registers_[outx_l_g + 2 * i + 1] = swapped ? low : high;
    }
  }

  [[nodiscard]] std::int16_t digits(double rad_s) const {
    static constexpr double mdps[] = {8.75, 17.5, 35, 70};  // by FS_G [table 3]
    const double scale = (registers_[ctrl2_g] & 0x02) != 0 ? 4.375 : mdps[registers_[ctrl2_g] >> 2 & 3];
    const double digits = rad_s * 180 / 3.14159265358979 * 1000 / scale;
    return static_cast<std::int16_t>(std::clamp(std::round(digits), -32768.0, 32767.0));
  }

  void violate(const std::string& what) { violations_->add("LSM6DS3: " + what); }

  Violations* violations_;
  PartClock now_;
  std::function<Rates()> rates_;
  std::function<bool()> presence_;
  std::array<std::uint8_t, 128> registers_{};
  base::Time on_since_{};
  bool present_ = true;
  bool away_ = false;
  bool stuck_ = false;
};

}  // namespace ocm::sim
