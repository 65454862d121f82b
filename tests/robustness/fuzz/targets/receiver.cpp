// The receiver of samples, fed with any frames: every frame is counted once, and a sample holds the latest
// payload of each of its frames.
#include <map>
#include <tuple>

#include "ocm/client/sample.hpp"
#include "ocm/topics/amiro.hpp"

#include "tests/generator/golden/ferry.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using client::Meaning;

namespace {

template <class... Topics>
void check_typed(const client::Sample& sample, protocol::TopicList<Topics...>) {
  ((void)sample.as<Topics>(), ...);
}

void check(fuzz::Input input, const protocol::Catalogue& catalogue) {
  client::Receiver receiver{catalogue};
  std::map<std::tuple<const protocol::Topic*, std::uint8_t>, can::Payload> latest;
  std::uint64_t parts = 0;
  std::uint64_t taken = 0;
  while (!input.empty()) {
    const can::Frame frame = input.frame();
    const auto reception =
        receiver.take({base::Time{base::Duration{static_cast<std::int64_t>(++taken)}}, frame});
    const bool placed = reception.meaning == Meaning::part || reception.meaning == Meaning::sample ||
                        reception.meaning == Meaning::set_point;
    fuzz::expect(!placed || reception.frame.layout().dlc() == frame.dlc,
                 "a frame that is taken has its length");
    fuzz::expect(!reception.frame || reception.frame.topic == reception.topic, "a frame is one of its topic");
    if (reception.meaning == Meaning::part) ++parts;
    if (reception.meaning == Meaning::part || reception.meaning == Meaning::sample)
      latest[{reception.topic, reception.frame.frame}] = frame.data;
    if (reception.meaning != Meaning::sample) continue;

    const auto& sample = reception.sample;
    fuzz::expect(sample.topic == reception.topic && sample.bytes.size() == 8 * sample.topic->frames.size(),
                 "a sample is whole");
    for (std::uint8_t i = 0; i < sample.topic->frames.size(); ++i)
      fuzz::expect(sample.payload(i) == latest[std::tuple{sample.topic, i}], "a sample holds what came last");
    check_typed(sample, amiro::DiWheelDrive::sensors{});
    check_typed(sample, amiro::PowerManagement::sensors{});
  }
  const auto& c = receiver.counters();
  fuzz::expect(c.frames == taken, "every frame is counted");
  fuzz::expect(c.frames == c.errors + c.unknown + c.remote + c.commands + c.wrong_dlc + c.samples + parts,
               "every frame is counted once");
  fuzz::expect(c.incomplete <= parts, "an incomplete sample has a part");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check({data, size}, amiro::catalogue);
  check({data, size}, ferry::catalogue);
  return 0;
}
