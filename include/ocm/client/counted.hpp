/// A number of things, in words.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace ocm::client {

/// "1 frame", "2 frames" of "frame"; what follows the plural stands behind a star: "frame* given up".
[[nodiscard]] inline std::string counted(std::uint64_t number, std::string_view what) {
  const std::size_t end = std::min(what.find('*'), what.size());
  std::string text =
      std::to_string(number) + " " + std::string{what.substr(0, end)} + (number == 1 ? "" : "s");
  if (end != what.size()) text += what.substr(end + 1);
  return text;
}

}  // namespace ocm::client
