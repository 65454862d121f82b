// Scripts: every error has words and lies on the line that it names; a script without errors has steps in the
// order of their times, and each step's words stand for the same frames again. For the robot, and for another
// one.
#include "cli/words/script.hpp"

#include <string>
#include <vector>

#include "ocm/topics/amiro.hpp"

#include "tests/generator/golden/ferry.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

namespace {

/// As parse_script sees them: a carriage return at the end does not count.
std::vector<std::size_t> line_lengths(std::string_view text) {
  std::vector<std::size_t> lengths{0};
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\n') {
      ++lengths.back();
      continue;
    }
    if (lengths.back() != 0 && text[i - 1] == '\r') --lengths.back();
    lengths.push_back(0);
  }
  if (lengths.back() != 0 && text.back() == '\r') --lengths.back();
  return lengths;
}

void check(std::string_view text, const protocol::Catalogue& catalogue) {
  const auto script = cli::words::parse_script(text, catalogue);
  const auto lengths = line_lengths(text);
  fuzz::expect(!script.steps.empty() || !script.errors.empty(), "a script has steps or errors");
  std::size_t last = 0;
  for (const auto& error : script.errors) {
    fuzz::expect(error.line > last && error.line <= lengths.size(), "errors come in the order of the lines");
    last = error.line;
    fuzz::expect(error.column >= 1 && error.column <= lengths[error.line - 1] + 1,
                 "an error's column lies within its line, or one behind");
    fuzz::expect(!error.what.empty() && !error.remedy.empty(), "an error has words");
  }
  base::Duration before{0};
  for (const auto& step : script.steps) {
    fuzz::expect(step.at >= before, "steps come in the order of their times");
    before = step.at;
    bool sends = false;
    step.command.each_frame([&](const can::AnyFrame& frame) {
      sends = true;
      fuzz::expect(can::validate(frame).ok(), "a step's frames can exist");
    });
    fuzz::expect(sends, "a step sends something");
    const auto again = cli::words::parse_script(cli::words::to_text(step.at) + " " + step.text, catalogue);
    fuzz::expect(again.errors.empty() && again.steps.size() == 1 && again.steps[0].at == step.at &&
                     again.steps[0].command.frames == step.command.frames &&
                     again.steps[0].command.fd_frames == step.command.fd_frames,
                 "a step's text stands for the same frames");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::text_of(data, size), amiro::catalogue);
  check(fuzz::text_of(data, size), ferry::catalogue);
  return 0;
}
