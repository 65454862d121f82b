// ns a frame: the generated codec against the same work in plain shifts.
//
//   codec [--check]     --check: compares the sums on a few thousand frames, and measures nothing
#include "bench/codec.hpp"

#include <random>

#include "bench/ways.hpp"

namespace {

using namespace ocm::bench;
using ocm::can::Frame;

Work<Numbers> make_work(std::size_t count, bool random_order) {
  std::mt19937_64 random{20260101};
  Work<Numbers> work;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t topic = topics[(random_order ? random() : i) % topics.size()];
    // Motors and LEDs are commanded, the others are sensors.
    const bool command = topic == 0x01 || topic >= 0x3C;
    Frame frame{(command ? 0x200U : 0x600U) | topic, 8, {}};
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    Numbers numbers{topic, {}};
    for (auto& field : numbers.field) field = static_cast<std::int32_t>(random());
    work.frames.push_back(frame);
    work.numbers.push_back(numbers);
  }
  return work;
}

}  // namespace

int main(int argc, char** argv) {
  return Ways<Numbers>{"codec",
                       {{"by hand", decode_by_hand},
                        {"library", decode_by_library},
                        {"catalogue", decode_by_catalogue},
                        {"switch alone", switch_alone, false}},
                       {{"by hand", encode_by_hand}, {"library", encode_by_library}}}
      .main(argc, argv, make_work);
}
