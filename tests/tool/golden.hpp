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

/// Where two texts begin to differ, with some lines of both.
inline std::string difference(const std::string& before, const std::string& now) {
  std::istringstream old_text{before}, new_text{now};
  std::string old_line, new_line;
  std::size_t number = 0;
  do {
    ++number;
    if (!std::getline(old_text, old_line)) old_line = "(its end)";
    if (!std::getline(new_text, new_line)) new_line = "(its end)";
  } while (old_line == new_line && old_text && new_text);
  std::string text = "from line " + std::to_string(number) + " on:\n";
  for (int lines = 0; lines < 5 && (old_text || new_text); ++lines) {
    text += "- " + old_line + "\n+ " + new_line + "\n";
    if (!std::getline(old_text, old_line)) old_line = "(its end)";
    if (!std::getline(new_text, new_line)) new_line = "(its end)";
  }
  return text;
}

inline void is_as_in(const std::string& path, const std::string& text) {
  if (std::getenv("OCM_WRITE_GOLDEN") != nullptr)
    std::ofstream{std::string{OCM_SOURCE_DIR} + "/" + path, std::ios::binary} << text;
  const std::string before = text_of(path);
  if (text == before)
    SUCCEED();
  else
    FAIL_CHECK(path << " differs " << difference(before, text)
                    << "Is it as it should be? OCM_WRITE_GOLDEN=1 writes it again.");
}

}  // namespace ocm::test
