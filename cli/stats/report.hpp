/// Figures as a table for a person, as one JSON object, or as CSV.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ocm/protocol/topic.hpp"

#include "cli/stats/assertion.hpp"
#include "cli/stats/figures.hpp"

namespace ocm::cli::stats {

/// Topics that are shown; empty: all.
using Shown = std::vector<const protocol::Topic*>;

/// Lines without an end; every line is one on the terminal, colours take no room.
/// Where it is wider than `columns`, it has fewer of its own; lines that are wider even so go on below.
[[nodiscard]] std::vector<std::string> to_table(const Report& report, const Shown& shown, bool colour,
                                                std::size_t columns = SIZE_MAX);
[[nodiscard]] std::string to_json(const Report& report, const Shown& shown,
                                  std::span<const Assertion> assertions);
/// "never came: Driving (20 ms)", of those that are shown; empty: there is no such message.
[[nodiscard]] std::string never_came_text(const Report& report, const Shown& shown);
[[nodiscard]] std::string to_csv(const Report& report, const Shown& shown);

}  // namespace ocm::cli::stats
