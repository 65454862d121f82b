#include <algorithm>

#include <fmt/format.h>

#include "cli/analyse/set.hpp"

namespace ocm::cli::analyse {

void order_bus(BusSet& set, std::string_view file, std::vector<Mistake>& mistakes) {
  const auto key = [](const BusEntry& entry) { return can::arbitration_key(entry.head); };
  std::stable_sort(set.entries.begin(), set.entries.end(),
                   [&key](const BusEntry& a, const BusEntry& b) { return key(a) < key(b); });
  for (std::size_t i = 1; i < set.entries.size(); ++i) {
    const BusEntry& first = set.entries[i - 1];
    const BusEntry& second = set.entries[i];
    if (key(first) != key(second)) continue;
    mistakes.push_back(
        {second.line == 0 ? std::string{file} : fmt::format("{}:{}", file, second.line),
         fmt::format("'{}' has the identifier 0x{:X} of '{}'{}", second.name, second.head.id, first.name,
                     first.line == 0 ? "" : fmt::format(" in line {}", first.line)),
         "who has the same identifier collides: give each its own"});
  }
  if (set.entries.size() > most_messages)
    mistakes.push_back({std::string{file}, fmt::format("{} messages", set.entries.size()),
                        fmt::format("at most {}", most_messages)});
}

}  // namespace ocm::cli::analyse
