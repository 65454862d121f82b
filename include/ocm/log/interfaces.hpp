/// The names of the CAN interfaces of a log, numbered in the order in which they come up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

namespace ocm::log {

class Interfaces {
 public:
  static constexpr std::size_t most =
      4096;  ///< a log with more is damaged; the last number stands for the rest

  /// The number of `name`, which is new or known. O(1) for the name of the call before, O(names) otherwise.
  std::uint16_t number(std::string_view name) {
    if (last_ < names_.size() && names_[last_] == name) return last_;
    for (last_ = 0; last_ < names_.size(); ++last_)
      if (names_[last_] == name) return last_;
    if (names_.size() < most) names_.emplace_back(name);
    return last_ = static_cast<std::uint16_t>(names_.size() - 1);
  }
  /// One more, whatever the others are called: for formats that number them.
  std::uint16_t add(std::string_view name) {
    if (names_.size() < most) names_.emplace_back(name);
    return static_cast<std::uint16_t>(names_.size() - 1);
  }
  [[nodiscard]] std::size_t size() const noexcept { return names_.size(); }
  /// "" for a number that was not given out. Valid as long as this is.
  [[nodiscard]] std::string_view name(std::uint16_t number) const noexcept {
    return number < names_.size() ? std::string_view{names_[number]} : std::string_view{};
  }

 private:
  std::deque<std::string> names_;  // views of names stay valid while others are added
  std::uint16_t last_ = 0;
};

}  // namespace ocm::log
