// In which order frames of several buses are recorded.
#include "cli/record/merge.hpp"

#include <array>
#include <chrono>
#include <span>
#include <string>

#include <catch2/catch.hpp>
#include <fmt/format.h>

namespace tool_merge_test {

using namespace std::chrono_literals;
using namespace ocm;

log::Entry entry(std::uint16_t bus, base::Duration time) {
  return {base::Time{time}, can::Frame{0x123, 0, {}}, bus};
}
/// "BUS:MS ..."
std::string shown(std::span<const log::Entry> entries) {
  std::string text;
  for (const auto& each : entries)
    text +=
        fmt::format("{}{}:{}", text.empty() ? "" : " ", each.interface, each.time.time_since_epoch() / 1ms);
  return text;
}

TEST_CASE(
    "merge: in the order of their times, of one time that of the first bus; each bus in its own order") {
  cli::record::Merge merge;
  merge.add(std::array{entry(1, 2ms)});
  merge.add(std::array{entry(0, 2ms), entry(0, 3ms)});
  CHECK(shown(merge.take()).empty());    // none leaves in the round in which it came
  merge.add(std::array{entry(1, 1ms)});  // its clock was set back
  CHECK(shown(merge.take()) == "0:2 1:2 1:1 0:3");
  CHECK(shown(merge.take()).empty());
  merge.add(std::array{entry(2, 7ms)});
  CHECK(shown(merge.take_all()) == "2:7");
  CHECK(shown(merge.take_all()).empty());
}

}  // namespace tool_merge_test
