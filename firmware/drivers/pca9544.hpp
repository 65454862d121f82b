/// I2C multiplexer PCA9544A: four channels, so that four parts of one address can share a bus.
///
/// Each transfer to a channel is two on the bus, select and talk, with `Lock` held over both: 0.05 ms more at
/// 400 kbit/s, 0.2 ms at 100. The channel is selected each time, so a multiplexer that was reset does no
/// harm. Errors: those of the bus.
/// [data sheet: TI PCA9544A, SCPS146D]
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"

#include "firmware/drivers/bus.hpp"

namespace ocm::firmware::drivers {

namespace pca9544 {

inline constexpr std::uint8_t address = 0x77;  ///< 1110, then A2 A1 A0, all high [figure 1; AMiRo-OS: 0x07]
inline constexpr std::uint8_t enable = 0x04;   ///< B2; B1 B0 are the channel [table 1]

}  // namespace pca9544

template <I2c Bus, Mutex Lock = NoMutex>
class Pca9544 {
 public:
  explicit Pca9544(Bus& bus) noexcept : bus_(&bus) {}
  Pca9544(const Pca9544&) = delete;  // its channels hold its address
  Pca9544& operator=(const Pca9544&) = delete;

  /// What is behind one channel: itself an I2C bus.
  class Channel {
   public:
    base::Status transfer(std::uint8_t address7, std::span<const std::uint8_t> write,
                          std::span<std::uint8_t> read) {
      return multiplexer_->transfer(number_, address7, write, read);
    }

   private:
    friend class Pca9544;
    constexpr Channel(Pca9544& multiplexer, std::uint8_t number) noexcept
        : multiplexer_(&multiplexer), number_(number) {}
    Pca9544* multiplexer_;
    std::uint8_t number_;
  };

  /// @param number 0..3
  [[nodiscard]] Channel channel(std::uint8_t number) noexcept { return {*this, number}; }

 private:
  base::Status transfer(std::uint8_t channel, std::uint8_t address7, std::span<const std::uint8_t> write,
                        std::span<std::uint8_t> read) {
    const Guard<Lock> guard{lock_};
    const std::array<std::uint8_t, 1> select{static_cast<std::uint8_t>(pca9544::enable | (channel & 3))};
    if (const auto done = bus_->transfer(pca9544::address, select, {}); !done) return done;
    return bus_->transfer(address7, write, read);
  }

  Bus* bus_;
  Lock lock_{};
};

}  // namespace ocm::firmware::drivers
