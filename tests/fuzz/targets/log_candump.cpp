// A candump log: whatever it is, it is read to its end; what is read can exist, and is written and read again
// to the same. The fast path and the careful one are compared line by line in tests/unit/log.
#include <string>
#include <vector>

#include "ocm/log/candump.hpp"

#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/log_entries.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  (void)log::CandumpReader::recognises(text);
  log::MemorySource source{text};
  log::Input input{source, fuzz::small_room};
  log::CandumpReader reader{input};
  const auto entries = fuzz::read_all(reader);
  fuzz::expect(entries.size() + reader.complaints().total() <= size, "no more is read than is there");

  log::CandumpNanoWriter writer;
  log::Bytes out;
  writer.write(out, entries, reader.interfaces());
  log::MemorySource again_source{out.view()};
  log::Input again_input{again_source, fuzz::small_room};
  log::CandumpReader again{again_input};
  const auto reread = fuzz::read_all(again);
  fuzz::expect(again.complaints().total() == 0, "what is written is read without complaint");
  fuzz::expect(reread.size() == entries.size(), "what is written is read whole");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto name = again.interfaces().name(reread[i].interface);
    log::Entry expected = entries[i];
    expected.interface = reread[i].interface;
    fuzz::expect(reread[i] == expected, "an entry that is written is read the same");
    fuzz::expect(writer.lost().any() || name == reader.interfaces().name(entries[i].interface),
                 "its interface keeps its name, or a loss is counted");
  }
  return 0;
}
