/// What the rows can be sorted by.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "cli/bus_model/model.hpp"

namespace ocm::cli::top {

enum class Sort : std::uint8_t { spec, name, rate, jitter, age, share, changed, count };

/// All of them, in the order in which keys go through them, and what a line says of each.
inline constexpr std::array<std::pair<Sort, std::string_view>, 8> sorts{{{Sort::spec, "the spec"},
                                                                         {Sort::name, "name"},
                                                                         {Sort::rate, "rate"},
                                                                         {Sort::jitter, "jitter"},
                                                                         {Sort::age, "age"},
                                                                         {Sort::share, "share of the bus"},
                                                                         {Sort::changed, "last change"},
                                                                         {Sort::count, "count"}}};

/// What is greatest comes first, but for the names and the spec's order.
[[nodiscard]] bool is_before(Sort sort, const bus_model::Row& a, const bus_model::Row& b);

}  // namespace ocm::cli::top
