// What others call a DBC file, or CSV: whatever is in it, a set that comes out without a mistake can be
// analysed, its identifiers differ, and every mistake has its place and its remedy. The readers belong to a
// program and not to a library: they are compiled here, with fmt in its headers.
#define FMT_HEADER_ONLY
#include "cli/analyse/dbc.cpp"

#include "cli/analyse/order.cpp"
#include "cli/analyse/split.cpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using namespace ocm::cli::analyse;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::text_of(data, size);
  std::vector<Mistake> mistakes;
  const BusSet set = parse_dbc(text, "x.dbc", mistakes);
  for (const Mistake& mistake : mistakes)
    fuzz::expect(mistake.place.starts_with("x.dbc") && !mistake.what.empty() && !mistake.remedy.empty(),
                 "a mistake has its place and its remedy");
  if (mistakes.empty()) {
    fuzz::expect(!set.entries.empty() && set.entries.size() <= most_messages,
                 "a set without a mistake has messages");
    for (std::size_t i = 0; i < set.entries.size(); ++i) {
      const BusEntry& entry = set.entries[i];
      fuzz::expect(can::validate(entry.head).ok(), "its frames can exist");
      fuzz::expect(entry.period > 0 && entry.jitter >= 0, "its numbers mean something");
      fuzz::expect(i == 0 || can::arbitration_key(set.entries[i - 1].head) < can::arbitration_key(entry.head),
                   "it is in the order of arbitration, and identifiers differ");
    }
  }
  std::size_t before = 0;
  for (const Line& line : split_csv(text)) {
    fuzz::expect(line.number > before, "lines of a table have numbers that grow");
    fuzz::expect(!line.cells.empty(), "a line has a cell");
    before = line.number;
  }
  return 0;
}
