/// What a driver did that the part's data sheet forbids, in words, for tests to look at. A model answers as
/// the part would, and adds a line here.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace ocm::sim {

class Violations {
 public:
  void add(std::string text) {
    if (texts_.size() < most) texts_.push_back(std::move(text));
  }
  [[nodiscard]] const std::vector<std::string>& texts() const noexcept { return texts_; }
  [[nodiscard]] bool none() const noexcept { return texts_.empty(); }
  void clear() noexcept { texts_.clear(); }

 private:
  static constexpr std::size_t most = 1000;  // a driver that repeats itself does not fill the memory
  std::vector<std::string> texts_;
};

}  // namespace ocm::sim
