/// Task sets as a C++ header: spec/tasks.json to include/ocm/analysis/task_sets.hpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "generator/spec/problem.hpp"

namespace ocm::generate {

/// The header. Appends to `problems` what is wrong with the sets; then there is none.
[[nodiscard]] std::string tasks_header(std::string_view json, std::string_view file_name,
                                       std::vector<spec::Problem>& problems);

}  // namespace ocm::generate
