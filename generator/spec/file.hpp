/// Files of JSON: what all documents of the tool have in common, from the path to the order of the problems.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/spec/json.hpp"
#include "generator/spec/problem.hpp"

namespace ocm::spec {

/// A document is at most this large, unless its kind is smaller.
inline constexpr std::size_t max_document_bytes = 10'000'000;

/// The text of a file; nothing, and a problem, if it is missing, cannot be read or is larger than
/// `most` bytes. `example` is the path of such a file.
[[nodiscard]] std::optional<std::string> read_document(const std::filesystem::path& file,
                                                       std::string_view what, std::string_view example,
                                                       std::vector<Problem>& problems,
                                                       std::size_t most = max_document_bytes);

/// Whether there is a document to judge: after a syntax error there is none, after a member that is there
/// twice there is.
[[nodiscard]] bool has_document(const std::vector<Problem>& problems);

/// By line, those of one line as they were found.
void sort_by_line(std::vector<Problem>& problems, std::string_view file_name);

}  // namespace ocm::spec
