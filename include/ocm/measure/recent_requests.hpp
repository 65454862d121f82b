/// Streams as they would be without the newest requests: a request that its board refuses changes nothing,
/// and the refusal comes a while after it.
///
/// Pure: reads no clock. Some 300 bytes a request, for as long as its refusal may come and 64 of them at
/// most; O(requests) a sample, and none are kept where nothing was asked.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/measure/timing.hpp"

namespace ocm::measure {

class RecentRequests {
 public:
  /// Of more at a time the oldest can no longer be undone.
  static constexpr std::size_t most = 64;

  /// `stream` of topic `topic` is about to be asked for something, which may be refused for so long,
  /// `patience`; none, 0: it cannot be.
  void asked(std::size_t topic, base::Time time, base::Duration patience, const Stream& stream) {
    forget(time);
    if (patience.count() <= 0) return;
    if (kept_.size() == most) kept_.erase(kept_.begin());
    kept_.push_back({topic, time, patience, stream});
  }
  /// A sample came, which belongs to the stream without the request, too.
  void sample(std::size_t topic, base::Time time) noexcept {
    for (Kept& each : kept_)
      if (each.topic == topic) each.stream.sample(time);
  }
  /// The newest `count` requests for this topic, or as many as there were, are refused: gives `stream` what
  /// it is without them. How many they are.
  std::size_t refused(std::size_t topic, base::Time time, std::uint32_t count, Stream& stream) {
    forget(time);
    std::size_t undone = 0;
    for (std::size_t i = kept_.size(); i-- > 0 && undone < count;) {
      if (kept_[i].topic != topic) continue;
      stream = kept_[i].stream;
      kept_.erase(kept_.begin() + static_cast<std::ptrdiff_t>(i));
      ++undone;
    }
    return undone;
  }

 private:
  struct Kept {
    std::size_t topic = 0;
    base::Time time{};
    base::Duration patience{};
    Stream stream;  ///< without the request
  };
  /// Of those before `now` less their patience, and where a clock was set back.
  void forget(base::Time now) {
    std::erase_if(kept_, [now](const Kept& each) {
      return now - each.time > each.patience || each.time - now > each.patience;
    });
  }

  std::vector<Kept> kept_;  ///< the oldest first
};

}  // namespace ocm::measure
