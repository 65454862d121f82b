// What an adapter may say, and what a torn line may make of it: an answer is a frame that can exist, in time
// and in words; each fault is counted once; after any noise the next line is heard.
#include "ocm/can/slcan_host.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using can::slcan::Answer;

namespace {

void check(const Answer& answer) {
  fuzz::expect(answer.stamp < can::slcan::stamp_period, "a time stamp lies within its minute");
  if (answer.kind != Answer::Kind::frame) return;
  fuzz::expect(can::validate(answer.frame).ok(), "a frame that is heard can exist");
  const auto plain = can::slcan::encode(answer.frame);
  fuzz::expect(plain.ok() == (answer.frame.format != can::Format::error),
               "frames have a line, error frames none");
  if (!plain) {
    fuzz::expect(answer.frame.id != 0 && !answer.stamped, "an error frame has a class, and no time");
    return;
  }
  const auto line = answer.stamped ? can::slcan::encode(answer.frame, answer.stamp) : plain;
  fuzz::expect(line.ok() && !line->overflowed(), "the line of a frame fits");
  const auto again = can::slcan::parse_answer(line->view().substr(0, line->view().size() - 1));
  fuzz::expect(again.ok() && again->frame == answer.frame && again->stamped == answer.stamped &&
                   again->stamp == answer.stamp,
               "a line that is written is read equal");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  can::slcan::AnswerReader reader;
  std::uint64_t ends = 0;
  std::uint64_t answers = 0;
  for (const char c : fuzz::text_of(data, size)) {
    const Answer answer = reader.feed(c);
    ends += c == can::slcan::carriage_return || c == can::slcan::bell ? 1 : 0;
    answers += answer.kind != Answer::Kind::none ? 1 : 0;
    check(answer);
    // A BEL in the middle of a line is an answer, and ends a line that was torn.
    const auto& f = reader.faults();
    const std::uint64_t open = reader.mid_line() ? 1 : 0;
    fuzz::expect(answers + f.total() - f.torn <= 2 * ends + open, "what is not heard is counted once");
    fuzz::expect(answers + f.total() >= ends, "every line is heard or counted");
  }
  (void)reader.feed(can::slcan::carriage_return);
  Answer last;
  for (const char c : std::string_view{"T1F33445582122232425262728EA5F\r"}) last = reader.feed(c);
  fuzz::expect(last.kind == Answer::Kind::frame && last.stamp == 59'999 && last.frame.id == 0x1F33'4455,
               "after any noise the next line is heard");
  return 0;
}
