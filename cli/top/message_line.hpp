/// Which message the last line of the screen shows: the newest, for a while.
#pragma once

#include <chrono>
#include <cstddef>

#include "ocm/base/time.hpp"

namespace ocm::cli::top {

class MessageLine {
 public:
  /// How long a message is shown.
  static constexpr base::Duration shown = std::chrono::seconds{5};

  /// Whether the newest message is shown; `count`: how many there have been.
  template <class TimePoint>
  [[nodiscard]] bool shows(std::size_t count, TimePoint now) {
    if (count != count_) {
      count_ = count;
      until_ = now.time_since_epoch() + shown;
    }
    return now.time_since_epoch() < until_;
  }

 private:
  std::size_t count_ = 0;
  base::Duration until_{};
};

}  // namespace ocm::cli::top
