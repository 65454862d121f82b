/// What a simulator that runs beside the user needs of the program around it, and how it ends.
#pragma once

#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/transport/bus.hpp"

namespace ocm::sim {

struct Shell {
  std::function<bool()> stop;                    ///< asked at least five times a second: whether to end
  std::function<void(std::string_view)> report;  ///< a line for the person
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
