/// Whole texts that were looked at once, and must stay as they are: with OCM_WRITE_GOLDEN=1 the files are
/// written again, to be read in review.
#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <catch2/catch.hpp>

namespace ocm::test {

/// Of a file of the tree.
inline std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream{std::string{OCM_SOURCE_DIR} + "/" + path, std::ios::binary}.rdbuf();
  return text.str();
}

inline void is_as_in(const std::string& path, const std::string& text) {
  if (std::getenv("OCM_WRITE_GOLDEN") != nullptr)
    std::ofstream{std::string{OCM_SOURCE_DIR} + "/" + path, std::ios::binary} << text;
  INFO(path);
  CHECK(text == text_of(path));
}

}  // namespace ocm::test
