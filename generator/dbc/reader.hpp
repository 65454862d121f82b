/// Reads DBC files as they are in the wild: what is doubtful is loaded as people mean it and remarked upon
/// with its line; what would make frames mean something else than the file's author meant is a problem.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/dbc/document.hpp"

namespace ocm::dbc {

struct Finding {
  std::size_t line = 0;
  std::string what;    ///< what is wrong, naming the input
  std::string remedy;  ///< what would be right, or what was done about it
  friend bool operator==(const Finding&, const Finding&) = default;
};

struct Reading {
  std::optional<Document> document;  ///< there exactly when there are no problems
  std::vector<Finding> problems;     ///< the file cannot be used
  std::vector<Finding> doubts;       ///< the file is used; both in the order of the file
};

/// Any bytes are a problem at worst: throws std::bad_alloc only. Linear in the size of the file, but for
/// messages with thousands of signals. Source: Vector's DBC File Format 1.0.1, and 202 public files.
[[nodiscard]] Reading read(std::string_view bytes);

}  // namespace ocm::dbc
