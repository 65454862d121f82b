// ns a frame: the generated codec against the same work in plain shifts.
//
//   codec [--check]     --check: compares the sums on a few thousand frames, and measures nothing
#include "bench/codec.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string_view>
#include <vector>

#include "bench/times.hpp"

namespace {

using namespace ocm::bench;
using ocm::can::Frame;
using ocm::can::Payload;

struct Work {
  std::vector<Frame> frames;
  std::vector<Numbers> numbers;
};

/// With `random_order` off the topics come one after the other: what the codec costs without the guesses that
/// the processor gets wrong.
Work make_work(std::size_t count, bool random_order) {
  std::mt19937_64 random{20260101};
  Work work;
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

struct Decoder {
  const char* name;
  std::uint64_t (*run)(std::span<const Frame>);
  bool whole = true;  ///< decodes, so that its sum must be right
  Times times{};
};
struct Encoder {
  const char* name;
  void (*run)(std::span<const Numbers>, Payload*);
  Times times{};
};

[[noreturn]] void differ(const char* what, const char* one, const char* other) {
  std::fprintf(stderr, "codec: %s: %s and %s give different results\n", what, one, other);
  std::exit(1);
}

/// Rounds of all ways alternate: when the machine slows down, it slows all of them down.
void measure(const char* order, const Work& work, int rounds, bool tell) {
  Decoder decoders[] = {{"by hand", decode_by_hand},
                        {"library", decode_by_library},
                        {"catalogue", decode_by_catalogue},
                        {"switch alone", switch_alone, false}};
  Encoder encoders[] = {{"by hand", encode_by_hand}, {"library", encode_by_library}};
  const std::size_t count = work.frames.size();
  const std::uint64_t sum = decode_by_hand(work.frames);
  std::vector<Payload> expected(count);
  encode_by_hand(work.numbers, expected.data());
  std::vector<Payload> frames(count);

  for (int round = 0; round < rounds; ++round) {
    for (Decoder& way : decoders) {
      std::uint64_t result = 0;
      way.times.round(count, [&] { result = way.run(work.frames); });
      if (way.whole && result != sum) differ("decode", way.name, "by hand");
    }
    for (Encoder& way : encoders) {
      way.times.round(count, [&] { way.run(work.numbers, frames.data()); });
      if (frames != expected) differ("encode", way.name, "by hand");
      std::fill(frames.begin(), frames.end(), Payload{});
    }
  }
  if (!tell) return;
  for (const Decoder& way : decoders) print("decode", order, way.name, way.times, decoders[0].times);
  for (const Encoder& way : encoders) print("encode", order, way.name, way.times, encoders[0].times);
}

}  // namespace

int main(int argc, char** argv) {
  const bool check = argc == 2 && std::string_view{argv[1]} == "--check";
  if (argc > 1 && !check) {
    std::fputs("usage: codec [--check]\n", stderr);
    return 2;
  }
  // Few enough that they stay in the cache, many enough that no branch predictor learns their order.
  const std::size_t count = 20'000;
  const int rounds = check ? 1 : 1000;
  measure("random", make_work(count, true), rounds, !check);
  measure("in order", make_work(count, false), rounds, !check);
  return 0;
}
