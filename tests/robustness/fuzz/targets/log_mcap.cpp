// An MCAP file: whatever it is, it is read to its end; what is read can exist, and is written and read again
// to the same, interfaces and what was recorded of them included.
#include "ocm/log/mcap.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"
#include "tests/robustness/fuzz/log_entries.hpp"

using namespace ocm;

namespace {

/// In place of zstd: a byte said twice is one.
std::size_t unpack(std::string_view packed, std::span<char> into) {
  std::size_t size = 0;
  for (std::size_t i = 0; i < packed.size() && size < into.size(); ++i, ++size) {
    into[size] = packed[i];
    if (i + 1 < packed.size() && packed[i + 1] == packed[i]) ++i;
  }
  return size;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  (void)log::McapReader::recognises(text);
  log::MemorySource source{text};
  log::Input input{source, fuzz::small_room};
  log::McapReader reader{input, unpack};
  const auto entries = fuzz::read_all(reader);
  fuzz::expect(reader.interfaces().size() <= log::Interfaces::most, "interfaces have a limit");

  log::McapWriter writer{"fuzz", {{"key", "value"}}};
  log::Bytes out;
  writer.begin(out);
  const std::size_t half = entries.size() / 2;
  writer.write(out, std::span{entries}.first(half), reader.interfaces());
  writer.flush(out);
  writer.write(out, std::span{entries}.subspan(half), reader.interfaces());
  writer.recorded(out, reader.recorded());
  writer.finish(out);
  fuzz::expect(!writer.lost().any(), "nothing is lost");
  log::MemorySource again_source{out.view()};
  log::Input again_input{again_source, fuzz::small_room};
  log::McapReader again{again_input};
  const auto reread = fuzz::read_all(again);
  fuzz::expect(again.complaints().total() == 0, "what is written is read without complaint");
  fuzz::expect(reread == entries, "what is written is read the same");
  for (std::uint16_t i = 0; i < reader.interfaces().size(); ++i)
    fuzz::expect(again.interfaces().name(i) == reader.interfaces().name(i), "an interface keeps its name");
  for (std::size_t i = 0; i < reader.recorded().size(); ++i)
    fuzz::expect(again.recorded()[i].dropped == reader.recorded()[i].dropped, "what was recorded is kept");
  return 0;
}
