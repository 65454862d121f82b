/// Colours as people type them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"

namespace ocm::cli::words {

struct NamedColour {
  std::string_view name;
  std::array<std::uint8_t, 3> rgb;
};
inline constexpr NamedColour named_colours[] = {
    {"off", {0, 0, 0}},        {"black", {0, 0, 0}},      {"white", {255, 255, 255}},
    {"red", {255, 0, 0}},      {"green", {0, 255, 0}},    {"blue", {0, 0, 255}},
    {"yellow", {255, 255, 0}}, {"cyan", {0, 255, 255}},   {"magenta", {255, 0, 255}},
    {"orange", {255, 128, 0}}, {"purple", {128, 0, 255}}, {"pink", {255, 96, 160}}};

/// "100,50,120", "#643278", "red" or "off".
[[nodiscard]] inline base::Result<std::array<std::uint8_t, 3>> parse_colour(std::string_view text) {
  for (const auto& named : named_colours)
    if (text == named.name) return named.rgb;
  std::array<std::uint8_t, 3> rgb{};
  if (text.starts_with('#')) {
    const auto number = base::parse_unsigned(text.substr(1), 16);
    if (!number || text.size() != 7) return base::Error::bad_syntax;
    for (std::size_t i = 0; i < 3; ++i) rgb[i] = static_cast<std::uint8_t>(*number >> (16 - 8 * i));
    return rgb;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto comma = text.find(',');
    const auto number = base::parse_unsigned(text.substr(0, comma));
    if (!number || (comma == std::string_view::npos) != (i == 2)) return base::Error::bad_syntax;
    if (*number > 255) return base::Error::out_of_range;
    rgb[i] = static_cast<std::uint8_t>(*number);
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
  }
  return rgb;
}

}  // namespace ocm::cli::words
