// What others call a DBC file, or CSV: whatever is in it, a set that comes out without a mistake can be
// analysed, its identifiers differ, and every mistake has its place and its remedy. The readers belong to a
// program and not to a library: they are compiled here, with fmt in its headers.
#define FMT_HEADER_ONLY
#include "cli/analyse/dbc.cpp"

#include "cli/analyse/order.cpp"
#include "cli/analyse/split.cpp"
#include "generator/dbc/encoding.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using namespace ocm::cli::analyse;

namespace {

void check_findings(const std::vector<dbc::Finding>& findings) {
  for (std::size_t i = 0; i < findings.size(); ++i) {
    fuzz::expect(findings[i].line > 0 && !findings[i].what.empty() && !findings[i].remedy.empty(),
                 "a finding has its line and its remedy");
    fuzz::expect(i == 0 || findings[i - 1].line <= findings[i].line, "findings are in the order of the file");
  }
}

void check_signal(const dbc::Message& message, const dbc::Signal& signal) {
  fuzz::expect(!signal.name.empty() && signal.position.width >= 1 && signal.position.width <= 64 &&
                   signal.position.start < 512,
               "a signal has a name and bits");
  fuzz::expect(dbc::is_utf8(signal.unit) && dbc::is_utf8(signal.comment), "text is UTF-8");
  fuzz::expect(signal.number == dbc::Signal::Number::integer ||
                   signal.position.width == (signal.number == dbc::Signal::Number::float32 ? 32 : 64),
               "a floating-point number has the width of one");
  fuzz::expect(signal.selector.has_value() != signal.selected.empty(), "a selector has values");
  std::size_t above = 0;
  for (auto at = signal.selector; at; at = message.signals[*at].selector)
    fuzz::expect(*at < message.signals.size() && ++above <= message.signals.size(),
                 "selectors do not go in a circle");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::text_of(data, size);
  const dbc::Reading reading = dbc::read(text);
  fuzz::expect(reading.document.has_value() == reading.problems.empty(), "a file is read, or has problems");
  check_findings(reading.problems);
  check_findings(reading.doubts);
  if (reading.document)
    for (const dbc::Message& message : reading.document->messages) {
      fuzz::expect(message.id <= (message.format == dbc::Message::Format::base ? can::max_base_id
                                                                               : can::max_extended_id),
                   "an identifier is within its format");
      for (const dbc::Signal& signal : message.signals) check_signal(message, signal);
    }
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
