// A log in comma-separated values: whatever it is, it is read to its end; what is read can exist, and is
// written and read again to the same.
#include "ocm/log/csv.hpp"

#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/log_entries.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  (void)log::CsvReader::recognises(text);
  log::MemorySource source{text};
  log::Input input{source, fuzz::small_room};
  log::CsvReader reader{input};
  const auto entries = fuzz::read_all(reader);

  log::CsvWriter writer;
  log::Bytes out;
  writer.begin(out);
  writer.write(out, entries, reader.interfaces());
  log::MemorySource again_source{out.view()};
  log::Input again_input{again_source, fuzz::small_room};
  log::CsvReader again{again_input};
  const auto reread = fuzz::read_all(again);
  fuzz::expect(again.complaints().total() == 0, "what is written is read without complaint");
  fuzz::expect(reread.size() == entries.size(), "what is written is read whole");
  for (std::size_t i = 0; i < entries.size(); ++i)
    fuzz::expect(reread[i] == entries[i], "an entry that is written is read the same");
  return 0;
}
