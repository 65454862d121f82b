/// The characters of DBC files: UTF-8 where the whole file is valid UTF-8, else Windows' code page 1252,
/// which Vector's editors write.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ocm::dbc {

/// The file's text, without a byte order mark, if all of it is UTF-8.
[[nodiscard]] std::optional<std::string_view> as_utf8(std::string_view bytes) noexcept;
/// The file's text as UTF-8, without a byte order mark. Five bytes mean nothing in code page 1252 (81, 8D,
/// 8F, 90, 9D): they become U+FFFD.
[[nodiscard]] std::string to_utf8(std::string_view bytes);

/// Whether code page 1252 has all characters of a text.
[[nodiscard]] bool has_cp1252(std::string_view utf8) noexcept;

/// The same in code page 1252; nothing where it has not all characters, or where its bytes would be read as
/// UTF-8.
[[nodiscard]] std::optional<std::string> to_cp1252(std::string_view utf8);

}  // namespace ocm::dbc
