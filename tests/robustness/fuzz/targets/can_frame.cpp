// A frame as text: what parses can exist, prints, and reparses equal.
#include "ocm/can/text.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto frame = can::parse_frame(fuzz::text_of(data, size));
  if (!frame) return 0;
  fuzz::expect(can::validate(*frame).ok(), "a frame that parses can exist");
  const auto text = can::to_text(*frame);
  fuzz::expect(!text.overflowed(), "the text of a frame fits");
  const auto again = can::parse_frame(text.view());
  fuzz::expect(again.ok() && *again == *frame, "a frame that is printed reparses equal");
  return 0;
}
