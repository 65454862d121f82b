// Config files: any text is settings, or has problems in words on a line that exists; a setting has a key and
// values, and stands on its line.
#include "cli/shared/config_file.hpp"

#include <algorithm>

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::text_of(data, size);
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  const auto file = cli::parse_config(text);
  for (const auto& problem : file.problems) {
    fuzz::expect(problem.line >= 1 && problem.line <= lines + 1,
                 "a problem is on a line that exists, or behind the last");
    fuzz::expect(!problem.what.empty() && !problem.remedy.empty(), "a problem has words and a remedy");
  }
  for (const auto& table : file.empty_tables)
    fuzz::expect(!table.name.empty() && table.line >= 1 && table.line <= lines,
                 "an empty table has a name and a line");
  for (const auto& setting : file.settings) {
    fuzz::expect(setting.line >= 1 && setting.line <= lines, "a setting is on a line that exists");
    for (const auto& value : setting.values)
      fuzz::expect(value.kind != cli::ValueKind::truth || value.text == "true" || value.text == "false",
                   "true is true, and false is false");
  }
  return 0;
}
