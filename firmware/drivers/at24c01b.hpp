/// EEPROM AT24C01BN on I2C: 128 bytes in pages of 8, kept without power.
///
/// After a page is written the part does not acknowledge for up to 5 ms: `ready` asks, nothing here waits.
/// Errors: no_answer, away or busy writing; bad_length, over the end of a page; bus_fault.
/// [data sheet: Atmel AT24C01B, 5156]
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"

#include "firmware/drivers/bus.hpp"

namespace ocm::firmware::drivers {

namespace at24c01b {

inline constexpr std::uint8_t address = 0x50;  ///< 1010, A2 to A0 low; the BN's are [data sheet, figure 7]
inline constexpr std::size_t bytes = 128;
inline constexpr std::size_t page = 8;                                       ///< [Page Write]
inline constexpr base::Duration write_cycle = std::chrono::milliseconds{5};  ///< [AC characteristics: t(WR)]

}  // namespace at24c01b

template <I2c Bus>
class At24c01b {
 public:
  explicit At24c01b(Bus& bus) noexcept : bus_(&bus) {}

  /// Any number of bytes: reading runs on over the ends of pages.
  base::Status read(std::uint8_t where, std::span<std::uint8_t> bytes) {
    if (where + bytes.size() > at24c01b::bytes) return base::Error::bad_length;
    const std::array<std::uint8_t, 1> pointer{where};
    return bus_->transfer(at24c01b::address, pointer, bytes);
  }

  /// Within one page: beyond its end the part would go on at the page's start.
  base::Status write(std::uint8_t where, std::span<const std::uint8_t> bytes) {
    if (where % at24c01b::page + bytes.size() > at24c01b::page) return base::Error::bad_length;
    std::array<std::uint8_t, 1 + at24c01b::page> frame{where};
    std::copy(bytes.begin(), bytes.end(), frame.begin() + 1);
    return bus_->transfer(at24c01b::address, std::span{frame}.first(1 + bytes.size()), {});
  }

  /// It is there and not busy writing. [data sheet, Acknowledge Polling]
  base::Status ready() { return bus_->transfer(at24c01b::address, {}, {}); }

 private:
  Bus* bus_;
};

}  // namespace ocm::firmware::drivers
