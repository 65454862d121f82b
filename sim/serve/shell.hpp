/// What a simulator that runs beside the user needs of the program around it, and how it ends.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/transport/bus.hpp"

#include "sim/serve/seen.hpp"

namespace ocm::sim {

struct Shell {
  std::function<bool()> stop;                    ///< asked at least five times a second: whether to end
  std::function<void(std::string_view)> report;  ///< a line for the person
  /// An onlooker, who may look at the world now, and is asked at least twenty times a second; none: there is
  /// no onlooker. `look` makes the picture, and is called only for a picture.
  std::function<void(const std::function<SeenWorld()>& look)> watch{};

  /// How long a loop may wait that would wait so long.
  [[nodiscard]] base::Duration limited(base::Duration wait) const {
    constexpr base::Duration longest = std::chrono::milliseconds{50};
    return watch ? std::min(wait, longest) : wait;
  }
};

/// Well, once `stop` said so; else with what keeps it from running.
struct Ending {
  std::vector<transport::Failure> failures{};
  bool misuse = false;  ///< the options are to blame, not the system

  Ending() = default;
  explicit Ending(transport::Failure failure, bool options = false) : misuse(options) {
    failures.push_back(std::move(failure));
  }
  [[nodiscard]] bool well() const noexcept { return failures.empty(); }
};

}  // namespace ocm::sim
