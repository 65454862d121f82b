// What others call a DBC file, or CSV: whatever is in it, each message is in the set that is analysed or left
// out with a reason, its identifiers differ, and every mistake has its place and its remedy.
#include "ocm/base/utf8.hpp"

#include "cli/analyse/set.hpp"
#include "generator/dbc/encoding.hpp"
#include "generator/dbc/reader.hpp"
#include "generator/spec/from_dbc.hpp"
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
                   signal.position.start < 8 * 1785,
               "a signal has a name and bits");
  fuzz::expect(ocm::base::is_utf8(signal.unit) && ocm::base::is_utf8(signal.comment), "text is UTF-8");
  fuzz::expect(signal.number == dbc::Signal::Number::integer ||
                   signal.position.width == (signal.number == dbc::Signal::Number::float32 ? 32 : 64),
               "a floating-point number has the width of one");
  fuzz::expect(signal.selector.has_value() != signal.selected.empty(), "a selector has values");
  std::size_t above = 0;
  for (auto at = signal.selector; at; at = message.signals[*at].selector)
    fuzz::expect(*at < message.signals.size() && ++above <= message.signals.size(),
                 "selectors do not go in a circle");
}

/// A text in UTF-8, which the file's bytes become and which becomes such bytes again.
void check_encoding(std::string_view bytes) {
  const std::string text = dbc::to_utf8(bytes);
  fuzz::expect(ocm::base::is_utf8(text), "what is read is UTF-8");
  fuzz::expect(dbc::as_utf8(text).has_value(), "and is taken as it is");
  const auto back = dbc::to_cp1252(text);
  fuzz::expect(!back || dbc::to_utf8(*back) == text, "what is written in code page 1252 is read again");
  fuzz::expect(!back || dbc::has_cp1252(text), "and all its characters are in it");
}

/// What the analysis of a bus makes of it.
void check_set(const spec::Model& model) {
  BusSet set;
  for (const spec::MessageModel& message : model.messages) {
    const std::size_t left_out = set.left_out.size();
    const std::size_t in_set = set.entries.size();
    for (const std::int64_t rate : {std::int64_t{1'000'000}, std::int64_t{0}}) {
      set.left_out.resize(left_out);
      set.entries.resize(in_set);
      if (auto entry = entry_of(message, "", rate, set.left_out)) set.entries.push_back(std::move(*entry));
    }
    const bool counted = set.entries.size() > in_set;
    const bool told = set.left_out.size() > left_out;
    fuzz::expect(counted || told, "a message is in the set, or is left out with a reason");
    if (told)
      fuzz::expect(set.left_out.back().name == message.name && !key_of(set.left_out.back().reason).empty() &&
                       counted == (set.left_out.back().reason == LeftOut::Reason::events),
                   "what is left out is named");
  }
  std::vector<Mistake> mistakes;
  order_bus(set, "x.dbc", mistakes);
  limit_clocks(set);
  for (const Mistake& mistake : mistakes)
    fuzz::expect(mistake.place.starts_with("x.dbc") && !mistake.what.empty() && !mistake.remedy.empty(),
                 "a mistake has its place and its remedy");
  for (std::size_t i = 0; i < set.entries.size(); ++i) {
    const BusEntry& entry = set.entries[i];
    fuzz::expect(can::validate(entry.head).ok(), "its frames can exist");
    fuzz::expect(entry.period > 0 && entry.jitter >= 0 && entry.offset >= 0, "its numbers mean something");
    fuzz::expect(i == 0 || !mistakes.empty() ||
                     can::arbitration_key(set.entries[i - 1].head) < can::arbitration_key(entry.head),
                 "it is in the order of arbitration, and identifiers differ");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::text_of(data, size);
  check_encoding(text);
  dbc::Reading reading = dbc::read(text);
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
  if (reading.document) {
    std::vector<spec::Problem> doubts;
    check_set(spec::model_of(std::move(*reading.document), "x.dbc", doubts));
    for (const spec::Problem& doubt : doubts)
      fuzz::expect(doubt.place.starts_with("x.dbc") && !doubt.what.empty() && !doubt.remedy.empty(),
                   "a doubt has its place and its remedy");
  }
  std::size_t before = 0;
  for (const Line& line : split_csv(text)) {
    fuzz::expect(line.number > before, "lines of a table have numbers that grow");
    fuzz::expect(!line.cells.empty(), "a line has a cell");
    before = line.number;
  }
  return 0;
}
