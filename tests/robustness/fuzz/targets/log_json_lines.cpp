// JSON lines: what is read can exist, and written again and reread it is equal; whatever cannot be read has
// words.
#include "ocm/topics/amiro.hpp"

#include "cli/logs/json_lines.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"
#include "tests/robustness/fuzz/log_entries.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static cli::logs::JsonLineParser parser{amiro::catalogue};
  static cli::JsonText printer{amiro::catalogue};
  const std::string_view text = fuzz::text_of(data, size);
  log::Entry entry;
  std::string_view bus;
  if (!parser.parse(text, entry, bus)) {
    fuzz::expect(!parser.problem().what.empty() && !parser.problem().remedy.empty(), "a bad line has words");
    return 0;
  }
  fuzz::expect(fuzz::can_exist(entry), "what is read can exist");
  const std::string name{bus};
  log::Bytes line;
  fuzz::expect(printer.write(line, name, entry), "every frame is shown");
  log::Entry again;
  const auto whole = line.view();
  fuzz::expect(parser.parse(whole.substr(0, whole.size() - 1), again, bus), "what is written can be read");
  fuzz::expect(again == entry && bus == name, "what is written is reread equal");
  return 0;
}
