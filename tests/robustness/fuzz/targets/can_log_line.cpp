// A line of a candump log: what parses, prints, and reparses equal to the microsecond.
#include "ocm/can/text.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::text_of(data, size);
  const auto line = can::parse_log_line(text);
  if (!line) return 0;
  fuzz::expect(can::validate(line->frame).ok(), "a frame that parses can exist");
  fuzz::expect(fuzz::within(line->interface, text), "the interface points into the line");
  fuzz::expect(line->time >= base::Time{}, "a stamp is not negative");
  const auto printed = can::to_log_line(line->time, line->interface, line->frame);
  if (line->interface.size() > 15)
    return 0;  // longer than Linux has them: the text may overflow, and says so
  fuzz::expect(!printed.overflowed(), "the text of a line fits");
  const auto again = can::parse_log_line(printed.view());
  fuzz::expect(again.ok() && again->frame == line->frame && again->interface == line->interface,
               "a line that is printed reparses equal");
  fuzz::expect(line->time - again->time < base::Duration{1000} && again->time <= line->time,
               "a printed time is cut to microseconds");
  return 0;
}
