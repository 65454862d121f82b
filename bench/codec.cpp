// ns a frame: the generated codec against the same work in plain shifts.
//
//   codec [--check]     --check: compares the sums on a few thousand frames, and measures nothing
#include "bench/codec.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string_view>
#include <vector>

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

/// The best of many rounds: what the machine can do when nothing disturbs it.
class Best {
 public:
  template <class F>
  void round(std::size_t frames, F&& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    ns_ = std::min(ns_, took.count() / static_cast<double>(frames));
  }
  [[nodiscard]] double ns() const { return ns_; }

 private:
  double ns_ = 1e9;
};

struct Decoder {
  const char* name;
  std::uint64_t (*run)(std::span<const Frame>);
  Best best{};
};
struct Encoder {
  const char* name;
  void (*run)(std::span<const Numbers>, Payload*);
  Best best{};
};

[[noreturn]] void differ(const char* what, const char* one, const char* other) {
  std::fprintf(stderr, "codec: %s: %s and %s give different results\n", what, one, other);
  std::exit(1);
}

/// Rounds of all ways alternate: when the machine slows down, it slows all of them down.
void measure(const char* order, const Work& work, int rounds, bool print) {
  Decoder decoders[] = {
      {"by hand", decode_by_hand}, {"library", decode_by_library}, {"catalogue", decode_by_catalogue}};
  Encoder encoders[] = {{"by hand", encode_by_hand}, {"library", encode_by_library}};
  const std::size_t count = work.frames.size();
  const std::uint64_t sum = decode_by_hand(work.frames);
  std::vector<Payload> expected(count);
  encode_by_hand(work.numbers, expected.data());
  std::vector<Payload> frames(count);

  for (int round = 0; round < rounds; ++round) {
    for (Decoder& way : decoders) {
      std::uint64_t result = 0;
      way.best.round(count, [&] { result = way.run(work.frames); });
      if (result != sum) differ("decode", way.name, "by hand");
    }
    for (Encoder& way : encoders) {
      way.best.round(count, [&] { way.run(work.numbers, frames.data()); });
      if (frames != expected) differ("encode", way.name, "by hand");
      std::fill(frames.begin(), frames.end(), Payload{});
    }
  }
  if (!print) return;
  for (const Decoder& way : decoders)
    std::printf("decode  %-9s  %-9s  %6.2f ns/frame\n", order, way.name, way.best.ns());
  for (const Encoder& way : encoders)
    std::printf("encode  %-9s  %-9s  %6.2f ns/frame\n", order, way.name, way.best.ns());
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
