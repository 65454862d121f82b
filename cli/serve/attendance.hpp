/// Viewers for whom robots drive are asked again and again whether they are there: a computer that was
/// switched off closes no connection. Pure: the time is handed in.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"

#include "cli/serve/viewers.hpp"

namespace ocm::cli::serve {

class Attendance {
 public:
  /// From one question to the next.
  static constexpr base::Duration interval = std::chrono::milliseconds{500};
  /// Questions without an answer: 2 s, as long as a program on the central's line may be silent. Counted, so
  /// that a server that was stopped itself does not take its own silence for theirs.
  static constexpr unsigned most_unanswered = 4;

  /// Of the viewers for whom robots drive: those that say nothing any more; the others are asked. To be
  /// called often; does something each `interval`.
  [[nodiscard]] std::vector<ViewerId> silent(const std::vector<ViewerId>& driving, Viewers& viewers,
                                             base::Time now) {
    if (now < next_) return {};
    next_ = now + interval;
    std::erase_if(asked_, [&](const auto& each) {
      return std::find(driving.begin(), driving.end(), each.first) == driving.end();
    });
    std::vector<ViewerId> silent;
    for (const ViewerId viewer : driving) {
      const std::uint64_t heard = viewers.heard(viewer);
      Asked& asked = asked_.try_emplace(viewer, Asked{heard}).first->second;
      if (std::exchange(asked.heard, heard) != heard) asked.unanswered = 0;
      if (asked.unanswered++ == most_unanswered) {
        silent.push_back(viewer);
        asked_.erase(viewer);
      } else {
        viewers.ask(viewer);
      }
    }
    return silent;
  }

 private:
  struct Asked {
    std::uint64_t heard = 0;
    unsigned unanswered = 0;
  };
  std::map<ViewerId, Asked> asked_;
  base::Time next_{};
};

}  // namespace ocm::cli::serve
