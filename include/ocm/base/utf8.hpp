/// Text in UTF-8, as far as tables and columns need it.
#pragma once

#include <cstddef>
#include <string_view>

namespace ocm::base {

/// How many columns a terminal takes for it: bytes that continue a character take none. Characters that are
/// wider than one column, or combine with another, count as one.
[[nodiscard]] constexpr std::size_t columns(std::string_view text) noexcept {
  std::size_t count = 0;
  for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1U : 0U;
  return count;
}

}  // namespace ocm::base
