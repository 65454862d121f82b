// The adapter's side, driven by any text with frames of the bus between: only an open channel sends or hears,
// every line has one answer, and the host's reader understands each of them.
#include "ocm/can/slcan_adapter.hpp"

#include "ocm/can/slcan_host.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using can::slcan::Adapter;
using can::slcan::Answer;

namespace {

/// A CAN controller that has room now and then.
struct Mailboxes {
  const Adapter& adapter;
  std::uint64_t count = 0;
  base::Result<bool> send(const can::Frame& frame) {
    fuzz::expect(adapter.channel() == Adapter::Channel::open, "only an open channel sends");
    fuzz::expect(can::validate(frame).ok() && frame.format != can::Format::error, "what is sent can exist");
    return ++count % 3 != 0;
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Adapter adapter;
  Mailboxes bus{adapter};
  can::slcan::AnswerReader host;
  base::Time now{};
  // A byte above 0x7F is an event on the bus, for it could be noise only; the others are the host's.
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint8_t byte = data[i];
    now += std::chrono::milliseconds{byte};
    if (byte >= 0xC0) {
      adapter.report(byte & 0x3FU);
      continue;
    }
    if (byte >= 0x80) {
      fuzz::Input rest{data + i, size - i};
      const can::Frame frame = byte % 2 == 0 ? rest.frame() : rest.any_frame();
      const auto line = adapter.hear(frame, now);
      fuzz::expect(line.view().empty() || adapter.channel() != Adapter::Channel::closed,
                   "only an open channel hears");
      fuzz::expect(!line.overflowed(), "the line of a frame fits");
      Answer answer;
      for (const char c : line.view()) answer = host.feed(c);
      fuzz::expect(line.view().empty() || (answer.kind == Answer::Kind::frame &&
                                           answer.frame.id == frame.id && answer.stamped == adapter.stamps()),
                   "the host reads the frame that was heard");
      continue;
    }
    const auto reply = adapter.feed(static_cast<char>(byte), bus);
    fuzz::expect(reply.view().empty() == (byte != '\r'), "every line has an answer, and nothing else has");
    fuzz::expect(!reply.overflowed(), "an answer fits");
    Answer answer;
    for (const char c : reply.view()) answer = host.feed(c);
    fuzz::expect(reply.view().empty() || answer.kind != Answer::Kind::none,
                 "the host understands every answer");
    fuzz::expect(
        adapter.channel() == Adapter::Channel::closed || can::slcan::bit_rate_code(adapter.bit_rate()).ok(),
        "an open channel has a bit rate");
  }
  fuzz::expect(host.faults().total() == 0, "an adapter says nothing that its host does not know");
  return 0;
}
