/// The text of the spec that amiroctl's catalogue is compiled from, so that an installed tool needs no file.
#pragma once

#include <string_view>

namespace ocm::generate {

/// The file's name, for messages and first lines.
inline constexpr std::string_view robot_spec_name = "topics.json";

[[nodiscard]] std::string_view robot_spec_text() noexcept;

}  // namespace ocm::generate
