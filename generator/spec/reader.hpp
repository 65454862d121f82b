/// From JSON to a checked model. Steps of `parse`; not for other use.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "generator/spec/json.hpp"
#include "generator/spec/model.hpp"
#include "generator/spec/problem.hpp"

namespace ocm::spec {

/// Appends every problem that it finds, and of messages every doubt. The model is complete only when it found
/// no problem.
[[nodiscard]] Model read_model(const Node& root, std::string_view file_name, std::vector<Problem>& problems,
                               std::vector<Problem>& doubts);

/// What the JSON schema finds, where `problems` has nothing yet: the two say the same of a spec's form, but
/// the reader says it better.
void validate_by_schema(const Node& root, std::string_view file_name, std::vector<Problem>& problems);

}  // namespace ocm::spec
