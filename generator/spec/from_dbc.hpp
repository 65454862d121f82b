/// A DBC file as a spec: its messages are messages of the catalogue, its nodes are boards. Names stay as they
/// are; what a spec cannot hold is a doubt.
#pragma once

#include <string_view>
#include <vector>

#include "generator/dbc/document.hpp"
#include "generator/spec/model.hpp"
#include "generator/spec/problem.hpp"

namespace ocm::spec {

/// Whether a file's text is a DBC file's rather than JSON: by its name, else by its first word.
[[nodiscard]] bool is_dbc(std::string_view text, std::string_view file_name) noexcept;

/// Takes the document apart. Places of doubts are "file:line".
[[nodiscard]] Model model_of(dbc::Document document, std::string_view file_name,
                             std::vector<Problem>& doubts);

}  // namespace ocm::spec
