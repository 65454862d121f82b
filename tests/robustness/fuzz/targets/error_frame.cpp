// Error frames in words: always some, always printable, never too long for their text.
#include "ocm/can/error_frame.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input{data, size};
  can::Frame frame = input.any_frame();
  fuzz::expect(frame.format == can::Format::error || can::describe(frame).view().empty(),
               "of other frames nothing is said");
  frame.format = can::Format::error;
  const auto text = can::describe(frame);
  fuzz::expect(!text.overflowed(), "the text of an error frame fits");
  fuzz::expect(!text.view().empty(), "every error frame says something");
  for (const char c : text.view()) fuzz::expect(c >= ' ' && c <= '~', "the text is plain ASCII");
  fuzz::expect(!text.view().starts_with(", ") && !text.view().ends_with(", "), "commas stand between words");
  return 0;
}
