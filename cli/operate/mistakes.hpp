/// What is wrong with an operator file as a whole: reflective's findings, each with its place in the file and
/// what would mend it.
#pragma once

#include <string_view>
#include <vector>

#include "cli/operate/operator_file.hpp"
#include "generator/spec/problem.hpp"

namespace ocm::cli::operate {

/// Appends a problem a finding, in the order of reflective::check. The tables of `file` must be complete.
void report_mistakes(const OperatorFile& file, std::string_view file_name,
                     std::vector<spec::Problem>& problems);

}  // namespace ocm::cli::operate
