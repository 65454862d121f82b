/// Names of at most 32 characters, as the DBC format has them.
#pragma once

#include <cstddef>
#include <set>
#include <string>

namespace ocm::generate {

/// Each name is given out once.
class DbcNames {
 public:
  static constexpr std::size_t longest = 32;

  /// A name that `unique` will be asked for: if it is one of DBC's, no longer name that begins with it gets
  /// it. A program that reads no long names would take one for the other.
  void expect(const std::string& full) {
    if (full.size() <= longest && identifier(full) == full) expected_.insert(full);
  }

  /// `full`, where it is such a name and free; otherwise what comes near it.
  std::string unique(const std::string& full, const std::string& suffix = {}) {
    const std::string stem = identifier(full);
    for (unsigned number = 1;; ++number) {
      const std::string tail = (number == 1 ? "" : "_" + std::to_string(number)) + suffix;
      std::string name = stem.substr(0, longest - tail.size()) + tail;
      if (name != full && expected_.contains(name)) continue;
      if (taken_.insert(name).second) return name;
    }
  }

 private:
  /// Letters, digits and underscores, and no digit first.
  static std::string identifier(std::string name) {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    for (char& c : name)
      if (!is_digit(c) && !(c >= 'a' && c <= 'z') && !(c >= 'A' && c <= 'Z')) c = '_';
    return name.empty() || is_digit(name.front()) ? '_' + name : name;
  }

  std::set<std::string> expected_;
  std::set<std::string> taken_;
};

}  // namespace ocm::generate
