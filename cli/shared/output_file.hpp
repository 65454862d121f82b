/// Files that a verb makes, each in one step: a reader sees the old file or the new one.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "ocm/transport/bus.hpp"

namespace ocm::cli {

/// As generate::write_file does it; "-" is the standard output. What went wrong, if anything did.
[[nodiscard]] std::optional<transport::Failure> try_to_write(const std::string& path, std::string_view text);

/// Leaves through cli::fail when it cannot be written.
void write_file(const std::string& path, std::string_view text);

/// Why it cannot be written, as far as that is known before there is anything to write.
[[nodiscard]] std::optional<transport::Failure> cannot_write(const std::string& path);

/// Leaves with exit_usage where both are one regular file ("-": the standard input, the standard output): to
/// make the output would empty the input, or replace what cannot be made again.
void refuse_same_file(std::string_view verb, const std::string& in, const std::string& out);

}  // namespace ocm::cli
