/// Register model of the fuel gauge BQ27500. [data sheet: TI bq27500, SLUS785D]
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

/// What the gauge measured.
struct GaugeState {
  bool battery = true;
  bool full = false;
  std::uint16_t minutes_to_empty = 65535;
  std::uint16_t minutes_to_full = 65535;
  std::int16_t power_mw = 0;
  std::uint16_t state_of_charge_percent = 0;
  std::uint16_t voltage_mv = 0;
  std::int16_t current_ma = 0;
  std::uint16_t remaining_mah = 0;
  std::uint16_t temperature_dk = 2982;  ///< 0.1 K
};

class Bq27500Model : public I2cPart {
 public:
  Bq27500Model(Violations& violations, std::function<GaugeState()> state)
      : I2cPart(0x55), violations_(&violations), state_(std::move(state)) {}

  bool write(std::span<const std::uint8_t> bytes) override {
    if (bytes.empty()) return true;
    pointer_ = bytes[0];
    if (pointer_ > 0x7F) {  // [7.1: no acknowledge]
      violations_->add("bq27500: no command above 0x7F");
      return false;
    }
    const auto data = bytes.subspan(1);
    if (data.empty()) return true;
    if (pointer_ != 0x00 || data.size() != 2) {
      violations_->add("bq27500: only a subcommand of two bytes to Control() is written here");
      return false;
    }
    const unsigned subcommand = data[0] + 256U * data[1];
    answer_ = subcommand == 0x0001 ? 0x0500 : 0x0000;
    if (subcommand > 0x0012) violations_->add("bq27500: a subcommand that changes it");
    return true;
  }

  void read(std::span<std::uint8_t> bytes) override {
    if (pointer_ % 2 != 0 || bytes.size() % 2 != 0) violations_->add("bq27500: half a word read");
    refresh();
    for (std::uint8_t& byte : bytes) {
      byte = pointer_ < words_.size() ? words_[pointer_] : 0;
      ++pointer_;
    }
  }

 private:
  void power_up() override { answer_ = 0; }

  void refresh() {
    const GaugeState state = state_();
    const auto put = [this](std::size_t command, unsigned word) {
      words_[command] = static_cast<std::uint8_t>(word & 0xFF);
      words_[command + 1] = static_cast<std::uint8_t>(word >> 8 & 0xFF);
    };
    const auto power = static_cast<std::uint16_t>(state.power_mw);
    put(0x00, answer_);
    put(0x06, state.temperature_dk);
    put(0x08, state.voltage_mv);
    put(0x0A,
        (state.full ? 0x0200U : 0x0100U) | (state.battery ? 0x0008U : 0U) | (state.power_mw < 0 ? 1U : 0U));
    put(0x10, state.remaining_mah);
    put(0x14, static_cast<std::uint16_t>(state.current_ma));
    put(0x16, state.minutes_to_empty);
    put(0x18, state.minutes_to_full);
    put(0x24, power);
    put(0x2C, state.state_of_charge_percent);
  }

  Violations* violations_;
  std::function<GaugeState()> state_;
  std::array<std::uint8_t, 0x30> words_{};
  std::uint8_t pointer_ = 0;
  unsigned answer_ = 0;
};

}  // namespace ocm::sim
