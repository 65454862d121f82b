/// The two batteries, their charger and the fuel gauges. Energy is counted in whole microjoules (1 mW for 1
/// ms), so that a thousand steps of 1 ms and one of 1 s come to the same.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "firmware/boards/samples.hpp"

namespace ocm::sim {

using firmware::boards::BatteryReadings;
using firmware::boards::Colour;
using firmware::boards::GaugeReading;

/// Who draws how much.
struct PowerModel {
  /// The boards alone. [thesis, figure 7.2: -930 mW]
  std::int64_t boards_mw = 930;
  /// One motor at the greatest wheel speed; less in proportion. [thesis, chapter 2: 1 W]
  std::int64_t motor_mw = 1000;
  /// One colour of one light at full brightness: 20 mA at 3.3 V. [decided]
  std::int64_t light_mw = 66;
  std::int64_t charger_mw = 5000;  ///< [decided]
  /// 4.08 Wh: 52 % last 137 minutes at 930 mW. [thesis, figure 7.2]
  std::int64_t capacity_uj = 14'688'000'000;
  /// Of a battery that is empty and one that is full: a straight line between. [decided]
  double empty_v = 3.3;
  double full_v = 4.1;
  /// There is no heat in this world: 25 degrees, always. [decided]
  std::uint16_t temperature_dk = 2982;
};

class Battery {
 public:
  Battery(const PowerModel& model, double state_of_charge, bool plugged) noexcept
      : model_(model),
        energy_uj_(
            std::llround(static_cast<double>(model.capacity_uj) * std::clamp(state_of_charge, 0.0, 1.0))),
        plugged_(plugged) {
    power_mw_ = static_cast<double>(plugged ? model.charger_mw - model.boards_mw : -model.boards_mw);
    if ((plugged && full()) || (!plugged && empty())) power_mw_ = 0;
    average_mw_ = power_mw_;
  }

  void set_plugged(bool plugged) noexcept { plugged_ = plugged; }
  [[nodiscard]] bool plugged() const noexcept { return plugged_; }
  [[nodiscard]] bool charging() const noexcept { return plugged_ && !full(); }
  [[nodiscard]] bool empty() const noexcept { return energy_uj_ == 0; }
  [[nodiscard]] std::int64_t energy_uj() const noexcept { return energy_uj_; }

  /// `load_mw` for `duration_ms`, during which nothing is switched.
  void step(std::int64_t load_mw, std::int64_t duration_ms) noexcept {
    const std::int64_t net_mw = (plugged_ ? model_.charger_mw : 0) - load_mw;
    energy_uj_ = std::clamp<std::int64_t>(energy_uj_ + net_mw * duration_ms, 0, model_.capacity_uj);
  }

  /// Once a second: the gauge looks. [BQ27500 data sheet] The time that is left comes from the mean of about
  /// a minute, so that a short drive does not halve it.
  void gauge() noexcept {
    power_mw_ = static_cast<double>(energy_uj_ - gauged_uj_) / 1000;  // uJ in a second are uW
    gauged_uj_ = energy_uj_;
    if (power_mw_ * average_mw_ <= 0) average_mw_ = power_mw_;  // plugged or unplugged: begin again
    average_mw_ += (power_mw_ - average_mw_) / 60;
  }

  [[nodiscard]] GaugeReading reading() const noexcept {
    GaugeReading reading;
    reading.plugged = plugged_;
    reading.charging = charging();
    reading.state_of_charge_percent =
        static_cast<std::uint8_t>((energy_uj_ * 100 + model_.capacity_uj / 2) / model_.capacity_uj);
    reading.power_mw = static_cast<std::int16_t>(std::clamp(std::round(power_mw_), -32768.0, 32767.0));
    const std::int64_t to_go = charging() ? model_.capacity_uj - energy_uj_ : energy_uj_;
    const double minutes = static_cast<double>(to_go) / (charging() ? average_mw_ : -average_mw_) / 60'000;
    // No power, or power the wrong way, says nothing about the time.
    if (minutes >= 0 && minutes < 65534.5) reading.minutes = static_cast<std::uint16_t>(std::lround(minutes));
    return reading;
  }

  /// Each of two equal batteries; what cannot be halved is the front one's.
  [[nodiscard]] BatteryReadings readings() const noexcept {
    const double part = static_cast<double>(energy_uj_) / static_cast<double>(model_.capacity_uj);
    const double voltage_v = model_.empty_v + (model_.full_v - model_.empty_v) * part;
    const double mean_v = (model_.empty_v + voltage_v) / 2;  // of what comes out until it is empty
    const std::int32_t power_mw = reading().power_mw;
    const std::int32_t behind_mw = power_mw / 2;
    BatteryReadings both;
    for (std::size_t i = 0; i < both.size(); ++i) {
      const double own_mw = i == 0 ? power_mw - behind_mw : behind_mw;
      both[i].voltage_mv = static_cast<std::uint16_t>(std::lround(voltage_v * 1000));
      both[i].current_ma = static_cast<std::int16_t>(std::lround(own_mw / voltage_v));
      both[i].remaining_mah =
          static_cast<std::uint16_t>(std::lround(static_cast<double>(energy_uj_) / 2 / 3'600'000 / mean_v));
      both[i].temperature_dk = model_.temperature_dk;
    }
    return both;
  }

 private:
  [[nodiscard]] bool full() const noexcept { return energy_uj_ == model_.capacity_uj; }

  PowerModel model_;
  std::int64_t energy_uj_;
  std::int64_t gauged_uj_ = energy_uj_;
  bool plugged_;
  double power_mw_ = 0;    // mean of the last whole second
  double average_mw_ = 0;  // and of about the last minute
};

}  // namespace ocm::sim
