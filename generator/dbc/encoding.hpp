/// The characters of DBC files: UTF-8 where the whole file is valid UTF-8, else Windows' code page 1252,
/// which Vector's editors write.
#pragma once

#include <string>
#include <string_view>

namespace ocm::dbc {

/// The file's text as UTF-8, without a byte order mark. Five bytes mean nothing in code page 1252 (81, 8D,
/// 8F, 90, 9D): they become U+FFFD.
[[nodiscard]] std::string to_utf8(std::string_view bytes);

/// Whether all of it is UTF-8. [RFC 3629]
[[nodiscard]] bool is_utf8(std::string_view bytes) noexcept;

}  // namespace ocm::dbc
