/// The messages of a DBC file that have a cycle time.
#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"

#include "cli/analyse/set.hpp"
#include "generator/dbc/reader.hpp"

namespace ocm::cli::analyse {
namespace {

/// So many doubts are told one by one: a file may have hundreds, of which few matter for the load.
constexpr std::size_t most_doubts = 5;

/// 0: none, or longer than can be counted.
std::int64_t nanoseconds(const std::optional<base::Decimal>& milliseconds) {
  if (!milliseconds) return 0;
  const auto ns = base::divide_rounded(*milliseconds, base::Decimal{1, -6});
  return ns ? *ns : 0;
}

BusEntry entry_of(const dbc::Message& message) {
  BusEntry entry;
  entry.name = message.name;
  entry.line = message.line;
  entry.node = message.sender;
  entry.period = nanoseconds(message.cycle_ms);
  entry.head.id = message.id;
  entry.head.format =
      message.format == dbc::Message::Format::base ? can::Format::base : can::Format::extended;
  entry.head.dlc = static_cast<std::uint8_t>(message.length);
  return entry;
}

}  // namespace

BusSet parse_dbc(std::string_view text, const std::string& file, std::vector<Mistake>& mistakes) {
  const auto place = [&](std::size_t line) { return fmt::format("{}:{}", file, line); };
  const dbc::Reading reading = dbc::read(text);
  for (const dbc::Finding& problem : reading.problems)
    mistakes.push_back({place(problem.line), problem.what, problem.remedy});
  BusSet set;
  if (!reading.document) return set;

  std::string without;
  for (const dbc::Message& message : reading.document->messages) {
    if (message.length > can::max_dlc)
      mistakes.push_back({place(message.line), fmt::format("'{}' has {} bytes", message.name, message.length),
                          "0 to 8: classic CAN; CAN FD is not covered"});
    else if (BusEntry entry = entry_of(message); entry.period > 0)
      set.entries.push_back(std::move(entry));
    else
      without += (without.empty() ? "" : ", ") + message.name;
  }
  if (set.entries.empty() && mistakes.empty())
    mistakes.push_back({file,
                        reading.document->messages.empty() ? "no message" : "no message has a cycle time",
                        "BA_ \"GenMsgCycleTime\" BO_ 257 10; says every 10 ms"});
  if (!without.empty())
    set.remarks.push_back(fmt::format("Not in the set, as they have no cycle time: {}.", without));
  const std::size_t told = std::min(reading.doubts.size(), most_doubts);
  for (const dbc::Finding& doubt : std::span{reading.doubts}.first(told))
    set.remarks.push_back(fmt::format("{}: {}; {}.", place(doubt.line), doubt.what, doubt.remedy));
  if (told < reading.doubts.size())
    set.remarks.push_back(fmt::format("{}: {} more doubtful places.", file, reading.doubts.size() - told));
  order_bus(set, file, mistakes);
  return set;
}

}  // namespace ocm::cli::analyse
