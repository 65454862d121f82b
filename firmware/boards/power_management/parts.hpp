/// The parts of PowerManagement on its buses: what its Board asks for, by the real drivers. Which pins and
/// addresses, and from where that is known: docs/parts.md.
///
/// Who may call what: each sensor one level at a time; `maintain` one low level; `calibrate_ring` and what is
/// said for the status frames any. Buses that several of these share lock inside, and `Lock` (with priority
/// inheritance where levels preempt) guards the multiplexers.
///
/// No heap, no waiting: a part that is away answers Error::no_answer at once, and `maintain` looks for it. A
/// ring sample, of proximity or of light, is 16 transfers, 6 ms at 100 kbit/s; one of the gauges 8, 5 ms.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/boards/part_set.hpp"
#include "firmware/boards/power_management/board.hpp"
#include "firmware/boards/samples.hpp"
#include "firmware/drivers/bq27500.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/drivers/calibration.hpp"
#include "firmware/drivers/part.hpp"
#include "firmware/drivers/pca9544.hpp"
#include "firmware/drivers/vcnl4020.hpp"

namespace ocm::firmware::boards::power_management {

/// Numbers of buses and pins, for code that names them. [AMiRo-OS 1.0, PowerManagement: global.hpp]
namespace wiring {
inline constexpr std::uint8_t back_i2c = 1;        ///< I2C1, 100 kbit/s: multiplexer, gauge of P8
inline constexpr std::uint8_t front_i2c = 2;       ///< I2C2, 100 kbit/s: multiplexer, gauge of P7, EEPROM
inline constexpr std::uint8_t plugged_pin = 0x01;  ///< input bit 0: PC8, PATH_DC; high: plugged in

/// Where ring sensor i + 1 is: bus and channel of its multiplexer.
struct RingPlace {
  std::uint8_t i2c;
  std::uint8_t channel;
};
inline constexpr std::array<RingPlace, 8> ring{{{back_i2c, 1},
                                                {back_i2c, 3},
                                                {back_i2c, 2},
                                                {front_i2c, 0},
                                                {front_i2c, 1},
                                                {front_i2c, 3},
                                                {front_i2c, 2},
                                                {back_i2c, 0}}};
}  // namespace wiring

/// Bits of `absent()`.
namespace part {
inline constexpr std::uint8_t gauge_p7 = 0x01;
inline constexpr std::uint8_t gauge_p8 = 0x02;
inline constexpr std::uint8_t eeprom = 0x04;
inline constexpr std::uint8_t ring = 0x08;  ///< one of the eight or more: which, says `absent_ring()`
}  // namespace part

template <drivers::I2c BackBus, drivers::I2c FrontBus, drivers::Inputs Pins,
          drivers::Mutex Lock = drivers::NoMutex>
class Parts : public PartSet<Parts<BackBus, FrontBus, Pins, Lock>, 11> {
  friend PartSet<Parts, 11>;

 public:
  static constexpr std::size_t ring_sensors = 8;
  static constexpr std::size_t ring_first =
      3;  ///< part number of ring sensor 1; 0 gauge P7, 1 gauge P8, 2 EEPROM
  static_assert(Parts::parts == ring_first + ring_sensors);

  /// All must outlive the parts.
  Parts(BackBus& back, FrontBus& front, Pins& pins)
      : pins_(&pins),
        back_multiplexer_(back),
        front_multiplexer_(front),
        gauge_p7_(front),
        gauge_p8_(back),
        calibration_(front) {}
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  /// Once, before anything else: each part is tried once.
  void start(base::Time now) { this->start_parts(now); }

  /// To be called every 10 ms or so on a low level: looks after one part, or takes one step of a calibration.
  void maintain(base::Time now) {
    if (calibration_.driver().busy())
      return calibration_.driver().step([this](std::size_t sensor) { return raw_ring(sensor); });
    this->maintain_one(now);
  }

  // --- what the board asks for ---

  /// Both gauges must answer: what half of the batteries say would be taken for all.
  base::Result<GaugeReading> gauge() {
    const auto p7 = gauge_p7_.use([](auto& part) { return part.read(); });
    if (!p7) return p7.error;
    const auto p8 = gauge_p8_.use([](auto& part) { return part.read(); });
    if (!p8) return p8.error;
    return drivers::bq27500::combine(*p7, *p8, (pins_->read() & wiring::plugged_pin) != 0);
  }

  /// Each by itself, one that is not inserted as zeros; both gauges must answer.
  base::Result<BatteryReadings> batteries() {
    const auto p7 = gauge_p7_.use([](auto& part) { return part.measure(); });
    if (!p7) return p7.error;
    const auto p8 = gauge_p8_.use([](auto& part) { return part.measure(); });
    if (!p8) return p8.error;
    return BatteryReadings{*p7, *p8};
  }

  /// An error when one of the eight has none.
  base::Result<RingLight> ring_light() {
    RingLight counts{};
    for (std::size_t i = 0; i < ring_sensors; ++i) {
      const auto light = ring_[i].use([](auto& part) { return part.light(); });
      if (!light) return light.error;
      counts[i] = *light;
    }
    return counts;
  }

  /// Offset included, as the thesis's log has it. An error when one of the eight has none.
  base::Result<RingCounts> ring() {
    RingCounts counts{};
    for (std::size_t i = 0; i < ring_sensors; ++i) {
      const auto raw = raw_ring(i);
      if (!raw) return raw.error;
      counts[i] = *raw;
    }
    return counts;
  }

  /// Takes what the ring's sensors see now for their offset and keeps it in the EEPROM, or forgets it:
  /// nothing may be near meanwhile. It takes 16 samples of each sensor, 128 calls of `maintain`. Error::full
  /// while one is under way. [AMiRo-OS 1.0: CALIBRATE_PROXIMITY_RING]
  base::Status calibrate_ring(bool forget) noexcept { return calibration_.driver().request(forget); }
  [[nodiscard]] bool calibrating() const noexcept { return calibration_.driver().busy(); }
  /// How the last calibration ended.
  [[nodiscard]] base::Error calibration_error() const noexcept { return calibration_.driver().last(); }
  /// What was measured, for callers that need counts without it; `ring()` does not take it off.
  [[nodiscard]] std::uint16_t ring_offset(std::size_t sensor) const noexcept {
    return calibration_.driver().offset(sensor);
  }

  // --- for the status frames ---

  [[nodiscard]] std::uint8_t absent() const noexcept {
    return static_cast<std::uint8_t>(this->absent_bits(ring_first) | (absent_ring() != 0 ? part::ring : 0U));
  }
  /// Bit i: ring sensor i + 1 does not answer.
  [[nodiscard]] std::uint8_t absent_ring() const noexcept {
    unsigned bits = 0;
    for (std::size_t i = 0; i < ring_sensors; ++i) bits |= static_cast<unsigned>(ring_[i].absent()) << i;
    return static_cast<std::uint8_t>(bits);
  }

 private:
  /// A channel of either multiplexer, so that the eight sensors are of one type.
  class RingBus {
   public:
    RingBus(Parts& owner, std::size_t sensor) noexcept : parts_(&owner), place_(wiring::ring[sensor]) {}
    base::Status transfer(std::uint8_t address7, std::span<const std::uint8_t> write,
                          std::span<std::uint8_t> read) {
      if (place_.i2c == wiring::back_i2c)
        return parts_->back_multiplexer_.channel(place_.channel).transfer(address7, write, read);
      return parts_->front_multiplexer_.channel(place_.channel).transfer(address7, write, read);
    }

   private:
    Parts* parts_;
    wiring::RingPlace place_;
  };
  using RingSensor = drivers::Part<drivers::Vcnl4020<RingBus, true>>;

  base::Result<std::uint16_t> raw_ring(std::size_t sensor) {
    return ring_[sensor].use([](auto& part) { return part.read(); });
  }

  template <class Self, class F>
  static void pick(Self& self, std::size_t number, F what) {
    switch (number) {
      case 0:
        return what(self.gauge_p7_);
      case 1:
        return what(self.gauge_p8_);
      case 2:
        return what(self.calibration_);
      default:
        if (number < Parts::parts) what(self.ring_[number - ring_first]);
    }
  }
  Pins* pins_;
  drivers::Pca9544<BackBus, Lock> back_multiplexer_;
  drivers::Pca9544<FrontBus, Lock> front_multiplexer_;
  drivers::Part<drivers::Bq27500<FrontBus>> gauge_p7_;
  drivers::Part<drivers::Bq27500<BackBus>> gauge_p8_;
  drivers::Part<drivers::Calibration<FrontBus, ring_sensors>> calibration_;
  std::array<RingSensor, ring_sensors> ring_{RingSensor{RingBus{*this, 0}}, RingSensor{RingBus{*this, 1}},
                                             RingSensor{RingBus{*this, 2}}, RingSensor{RingBus{*this, 3}},
                                             RingSensor{RingBus{*this, 4}}, RingSensor{RingBus{*this, 5}},
                                             RingSensor{RingBus{*this, 6}}, RingSensor{RingBus{*this, 7}}};
};

}  // namespace ocm::firmware::boards::power_management
