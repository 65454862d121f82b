/// A study as text: a table for people, JSON, CSV, a picture.
#pragma once

#include <string>

#include "cli/analyse/study.hpp"

namespace ocm::cli::analyse {

/// `utilisation` and `messages` or `tasks`, one object and a line feed.
[[nodiscard]] std::string to_json(const Study& study);
/// One line a message or task, times in nanoseconds; empty cells where there is no bound.
[[nodiscard]] std::string to_csv(const Study& study);
/// By reason, with how many and which; empty if there is nothing.
[[nodiscard]] std::string left_out_text(const std::vector<LeftOut>& left_out);
[[nodiscard]] std::string to_table(const Study& study, const Advice& advice, bool colour);
/// What happens from the moment at which all are released at once, and what is left before each deadline.
[[nodiscard]] std::string to_svg(const Study& study);

}  // namespace ocm::cli::analyse
