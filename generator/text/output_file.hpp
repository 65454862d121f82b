/// Writes a generated file so that no program ever reads half of one.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "generator/spec/problem.hpp"

namespace ocm::generate {

/// All of `text` to an open file; false: errno says why.
[[nodiscard]] bool write_all(int file, std::string_view text);

/// In one step: a reader sees the old file or the new one, and a full disk leaves the old one. "-" is the
/// standard output; a pipe or a device is written to as it is. A link stays one, a mode stays the same.
/// What went wrong, if anything did.
[[nodiscard]] std::optional<spec::Problem> write_file(const std::string& path, std::string_view text);

}  // namespace ocm::generate
