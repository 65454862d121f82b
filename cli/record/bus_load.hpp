/// How full a bus is: the bits of its frames, stuff bits as they really fall, against the bits that there
/// was time for. CAN FD frames, whose data go at another bit rate, and error frames are not in it.
#pragma once

#include <cstdint>
#include <span>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/measure/bus_load.hpp"

namespace ocm::cli::record {

class BusLoad {
 public:
  void add(const log::Entry& entry) noexcept {
    const auto frame = entry.classic();
    if (frame && frame->format != can::Format::error) bits_ += measure::bits_on_bus(*frame);
  }
  /// 0..1 since the last call, over the time that has passed since; 0 where the bit rate is not known.
  [[nodiscard]] double take(base::Duration passed, std::uint32_t bit_rate) noexcept {
    const double there_was = static_cast<double>(bit_rate) * static_cast<double>(passed.count()) * 1e-9;
    const double load = there_was > 0 ? static_cast<double>(bits_) / there_was : 0;
    bits_ = 0;
    return load;
  }

 private:
  std::uint64_t bits_ = 0;
};

}  // namespace ocm::cli::record
