/// What is wrong with words that a person typed.
#pragma once

#include <cstddef>
#include <string>

namespace ocm::cli::words {

/// What is wrong with a command: at which word (its index), and what would be right.
struct WordError {
  std::size_t word = 0;
  std::string what;
  std::string remedy;
  friend bool operator==(const WordError&, const WordError&) = default;
};

}  // namespace ocm::cli::words
