/// When a log begins to play: with the first viewer that looks at what is in it, so that it is seen from its
/// beginning. Pure: the time is handed in.
#pragma once

#include <chrono>
#include <cstddef>
#include <string_view>

#include "ocm/base/time.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli::serve {

class LogStart {
 public:
  /// What a person reads meanwhile.
  static constexpr std::string_view waits = "serve: the log plays from the moment that the page is opened";
  /// A viewer that subscribes to nothing of the log (a program that reads states) has it played so long after
  /// it came. [decided: a page subscribes within a tenth of it]
  static constexpr base::Duration patience = std::chrono::seconds{1};

  /// `subscribed`: a viewer has subscribed to something of the log; `viewers`: how many there are at all.
  /// Once true, always true.
  [[nodiscard]] bool plays(bool subscribed, std::size_t viewers, Clock::time_point now) {
    const bool has_viewers = viewers != 0;
    if (!has_viewers || !has_viewers_) came_ = now;
    has_viewers_ = has_viewers;
    plays_ = plays_ || subscribed || (has_viewers && now - came_ >= patience);
    return plays_;
  }
  /// A time bar was used.
  void begin() noexcept { plays_ = true; }

 private:
  bool plays_ = false;
  bool has_viewers_ = false;
  Clock::time_point came_{};  ///< when the first of them came
};

}  // namespace ocm::cli::serve
