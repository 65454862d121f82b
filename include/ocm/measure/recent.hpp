/// What happens now: rate and jitter of the newest samples, and how much of the last second's time was taken.
/// For a screen that is looked at while it changes; timing.hpp and bus_load.hpp say it of all that came.
///
/// Pure: reads no clock, allocates nothing. O(1) a sample; 140 bytes a stream, 60 a load.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"

namespace ocm::measure {

/// The distances between the newest samples: of the last two seconds, sixteen at most. The newest one counts
/// for longer, until the next sample is twice as late as it was: a stream that stops has no figures soon, and
/// a slow one has them between its samples.
class RecentTimes {
 public:
  static constexpr std::size_t most = 16;
  static constexpr base::Duration window = std::chrono::seconds{2};

  struct Figures {
    std::uint32_t distances = 0;  ///< without any, the others say nothing
    double rate_hz = 0;
    double jitter_ns = 0;  ///< standard deviation of the distances
  };

  /// A sample that is older than the one before drops all before it: a clock was set back.
  void add(base::Time time) noexcept {
    const std::int64_t distance = (time - last_).count();
    if (!any_ || distance < 0) {
      size_ = 0;
    } else {
      distances_[next_] = distance;
      next_ = (next_ + 1) % most;
      size_ = std::min(size_ + 1, most);
    }
    any_ = true;
    last_ = time;
  }
  /// A pause was meant: the distance across it counts for nothing.
  void restart() noexcept {
    any_ = false;
    size_ = 0;
  }

  [[nodiscard]] Figures figures(base::Time now) const noexcept {
    const auto newest = [this](std::size_t i) {
      return static_cast<double>(distances_[(next_ + most - 1 - i) % most]);
    };
    Figures out;
    const double silence = std::max(0.0, static_cast<double>((now - last_).count()));
    constexpr auto in_window = static_cast<double>(window.count());
    if (size_ == 0 || silence > std::max(in_window, 2 * newest(0))) return out;
    double reach = 0;
    while (out.distances < size_) {
      const double further = reach + newest(out.distances);
      if (out.distances > 0 && silence + further > in_window) break;
      reach = further;
      ++out.distances;
    }
    if (out.distances == 0) return out;
    const double mean = reach / out.distances;
    double squares = 0;
    for (std::size_t i = 0; i < out.distances; ++i) squares += (newest(i) - mean) * (newest(i) - mean);
    out.rate_hz = reach > 0 ? out.distances * 1e9 / reach : 0;
    out.jitter_ns = std::sqrt(squares / out.distances);
    return out;
  }

 private:
  std::array<std::int64_t, most> distances_{};
  std::size_t next_ = 0;
  std::size_t size_ = 0;
  base::Time last_{};
  bool any_ = false;
};

/// Bits on a bus in the last second, by tenths of it.
class RecentLoad {
 public:
  static constexpr base::Duration window = std::chrono::seconds{1};

  void add(base::Time time, unsigned bits) noexcept {
    const std::int64_t slot = slot_of(time);
    if (!any_ || slot <= newest_ - slots) restart(slot);  // the second: a clock was set back
    if (slot > newest_) advance(slot);
    bits_[index(std::min(slot, newest_))] += bits;
  }
  /// In the ten tenths of a second that were over last.
  [[nodiscard]] std::uint64_t bits(base::Time now) const noexcept {
    const std::int64_t slot = slot_of(now);
    return sum(slot - in_window, slot - 1);
  }
  /// 0..1, in those, of a bus of so many bits a second that has been listened to since `begin`: in less than
  /// that at first.
  [[nodiscard]] double share(base::Time now, base::Time begin, std::uint32_t bit_rate) const noexcept {
    if (bit_rate == 0) return 0;
    const std::int64_t slot = slot_of(now);
    const std::int64_t end = slot * slot_ns;
    const std::int64_t since = begin.time_since_epoch().count();
    const bool any_over = since + slot_ns / 2 <= end;
    const std::int64_t time = any_over ? std::min(end - since, window.count())
                                       : std::max(now.time_since_epoch().count() - since, slot_ns / 2);
    const std::uint64_t count = any_over ? bits(now) : sum(slot - 1, slot);
    return static_cast<double>(count) * 1e9 / static_cast<double>(time) / bit_rate;
  }

 private:
  static constexpr std::int64_t in_window = 10;
  static constexpr std::int64_t slots = in_window + 1;  ///< with the tenth that is not over
  static constexpr std::int64_t slot_ns = window.count() / in_window;

  [[nodiscard]] static constexpr std::int64_t slot_of(base::Time time) noexcept {
    const std::int64_t ns = time.time_since_epoch().count();
    return ns / slot_ns - (ns % slot_ns < 0 ? 1 : 0);
  }
  [[nodiscard]] static constexpr std::size_t index(std::int64_t slot) noexcept {
    return static_cast<std::size_t>((slot % slots + slots) % slots);
  }
  [[nodiscard]] std::uint64_t sum(std::int64_t first, std::int64_t last) const noexcept {
    std::uint64_t out = 0;
    if (!any_) return out;
    for (std::int64_t slot = std::max(first, newest_ - slots + 1); slot <= std::min(last, newest_); ++slot)
      out += bits_[index(slot)];
    return out;
  }
  void restart(std::int64_t slot) noexcept {
    bits_.fill(0);
    newest_ = slot;
    any_ = true;
  }
  void advance(std::int64_t slot) noexcept {
    const std::int64_t emptied = std::min(slot - newest_, slots);
    for (std::int64_t i = 0; i < emptied; ++i) bits_[index(slot - i)] = 0;
    newest_ = slot;
  }

  std::array<std::uint32_t, slots> bits_{};
  std::int64_t newest_ = 0;  ///< slot
  bool any_ = false;
};

}  // namespace ocm::measure
