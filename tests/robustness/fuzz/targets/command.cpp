// Commands, one word a line, so that a word may hold anything, as those of a command line do: never a crash,
// and every error names one of the words or the place behind the last.
#include "cli/words/command.hpp"

#include <vector>

#include "ocm/topics/amiro.hpp"

#include "tests/generator/golden/ferry.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

namespace {

void check(std::span<const std::string_view> words, const protocol::Catalogue& catalogue) {
  const auto command = cli::words::CommandParser{catalogue}.parse_line(words);
  if (!command) {
    fuzz::expect(command.error.word <= words.size(), "an error lies at a word or behind the last");
    fuzz::expect(!command.error.what.empty() && !command.error.remedy.empty(), "an error has words");
    return;
  }
  fuzz::expect(!command->frames.empty() || !command->fd_frames.empty() || command->broadcast,
               "a command sends something");
  for (const auto& frame : command->frames)
    fuzz::expect(can::validate(frame).ok() && frame.format != can::Format::error,
                 "a command's frames can be sent");
  for (const auto& frame : command->fd_frames)
    fuzz::expect(can::validate(frame).ok() && frame.is_fd(), "a command's CAN FD frames can be sent");
  if (command->hold) {
    fuzz::expect(command->hold->frame == command->frames.front(), "what is held is what was sent");
    fuzz::expect(
        command->hold->rest.id == command->hold->frame.id && command->hold->rest.data == can::Payload{},
        "a hold ends at rest");
    fuzz::expect(command->hold->lasting.count() >= 0, "a hold does not last less than nothing");
  }
  if (command->answers != nullptr)
    fuzz::expect(command->answers->kind == protocol::Kind::sensor, "sensors answer");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = fuzz::text_of(data, size);
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const auto newline = text.find('\n');
    words.push_back(text.substr(0, newline));
    text = newline == std::string_view::npos ? std::string_view{} : text.substr(newline + 1);
  }
  check(words, amiro::catalogue);
  check(words, ferry::catalogue);
  return 0;
}
