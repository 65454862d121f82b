/// What must hold of every log format that is read and written.
#pragma once

#include <span>
#include <vector>

#include "ocm/log/writer.hpp"

#include "tests/robustness/fuzz/log_entries.hpp"

namespace ocm::fuzz {

/// All that is in a log.
template <class R, class... More>
[[nodiscard]] std::vector<log::Entry> read_log(std::string_view bytes, log::Interfaces& interfaces,
                                               std::uint64_t& complaints, More... more) {
  log::MemorySource source{bytes};
  log::Input input{source, fuzz::small_room};
  R reader{input, more...};
  auto entries = read_all(reader);
  for (std::size_t i = 0; i < reader.interfaces().size(); ++i)
    interfaces.add(reader.interfaces().name(static_cast<std::uint16_t>(i)));
  complaints = reader.complaints().total();
  return entries;
}

/// Any bytes are read to their end, and what is read can exist. Written and read again it is the same, but
/// for what `forget` takes from an entry: what the writer says that it lost. `Again` reads what is written,
/// for a format that is only read.
template <class R, class W, class Again = R, class Forget>
void rewrite(std::string_view bytes, Forget forget) {
  (void)R::recognises(bytes);
  log::Interfaces interfaces, interfaces_again;
  std::uint64_t complaints = 0;
  const auto entries = read_log<R>(bytes, interfaces, complaints);
  expect(entries.size() + complaints <= bytes.size(), "no more is read than is there");
  W writer;
  log::Bytes out;
  writer.begin(out);
  writer.write(out, entries, interfaces);
  writer.finish(out);
  const auto again = read_log<Again>(out.view(), interfaces_again, complaints);
  expect(complaints == 0, "what is written is read without complaint");
  expect(again.size() == entries.size(), "what is written is read whole");
  const bool named = writer.lost().count(log::Lost::interface) == 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    log::Entry expected = entries[i];
    expected.interface = again[i].interface;
    forget(expected, writer.lost());
    expect(again[i] == expected, "an entry that is written is read the same");
    expect(!named || interfaces.name(entries[i].interface).empty() ||
               interfaces_again.name(again[i].interface) == interfaces.name(entries[i].interface),
           "its interface keeps its name, or a loss is counted");
  }
}

}  // namespace ocm::fuzz
