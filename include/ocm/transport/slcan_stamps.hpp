/// The time stamps of SLCAN adapters, milliseconds that start again every minute, as times of this machine.
/// Pure: the arrival is handed in. O(1). Host only.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/can/slcan_codec.hpp"

namespace ocm::transport {

/// Maps the milliseconds of an adapter, which start again every minute, to the clock that stamps the arrival.
/// A frame cannot come before it was sent: the smallest delay seen is taken for none. The two clocks may
/// differ by 200 ppm.
class StampClock {
 public:
  [[nodiscard]] base::Time map(std::uint16_t stamp, base::Time arrival) noexcept {
    constexpr base::Duration turn = std::chrono::milliseconds{can::slcan::stamp_period};
    if (!started_) {
      started_ = true;
      offset_ = arrival.time_since_epoch();
      count_ = base::Duration::zero();
    } else {
      const base::Duration step = std::chrono::milliseconds{(stamp + can::slcan::stamp_period - last_stamp_) %
                                                            can::slcan::stamp_period};
      const base::Duration elapsed = std::max(arrival - last_arrival_, base::Duration::zero());
      // Whole minutes without a frame are seen by the other clock only.
      const base::Duration rest = elapsed - step + turn / 2;
      const std::int64_t turns = rest >= base::Duration::zero() ? rest / turn : -1;
      count_ += step + turns * turn;
      offset_ = std::min(offset_ + elapsed / 5000, arrival.time_since_epoch() - count_);
      if (arrival.time_since_epoch() - (offset_ + count_) > longest_delay)  // the adapter restarted
        offset_ = arrival.time_since_epoch() - count_;
    }
    last_stamp_ = stamp;
    last_arrival_ = arrival;
    return base::Time{offset_ + count_};
  }

 private:
  /// No adapter keeps a frame for longer, nor a program that reads.
  static constexpr base::Duration longest_delay = std::chrono::seconds{5};
  bool started_ = false;
  std::uint16_t last_stamp_ = 0;
  base::Time last_arrival_{};
  base::Duration count_{};   ///< of the adapter, since the first frame
  base::Duration offset_{};  ///< our clock when `count_` was 0
};

}  // namespace ocm::transport
