// ns a frame of plain messages: the header generated of a DBC file against the same work in plain shifts.
//
//   messages [--check]     --check: compares the sums on a few thousand frames, and measures nothing
#include "bench/messages.hpp"

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

/// How many bits each field of a message has, in the order of `identifiers`; below zero those with a sign. Of
/// the last one its second page.
constexpr int widths[][7] = {{16, -12, 8, 8, 1, 1, 4},
                             {3, -4, 8, 16},
                             {16, 16, 16, 16},
                             {16, -12, 12, 1, 2, -16},
                             {1, 1, 1, 1, 1, 1, 7},
                             {2, 2, 1, 1, 8},
                             {2, 2},
                             {16, -16, 8, -8, 3},
                             {-32, -32},
                             {16, 8, 1}};

struct Work {
  std::vector<Frame> frames;
  std::vector<CarNumbers> numbers;
};

/// With `random_order` off the messages come one after the other: what the codec costs without the guesses
/// that the processor gets wrong.
Work make_work(std::size_t count, bool random_order) {
  std::mt19937_64 random{20261124};
  Work work;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t message = (random_order ? random() : i) % identifiers.size();
    Frame frame{identifiers[message], 8, {}};
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    // Pages in turn with the messages, four and one that is empty.
    if (frame.id == 0x400) frame.data[0] = static_cast<std::uint8_t>((random_order ? random() : i / 10) % 5);
    CarNumbers numbers{identifiers[message], {}};
    for (std::size_t f = 0; f < numbers.field.size(); ++f) {
      const int width = widths[message][f];
      if (width == 0) continue;
      const std::uint64_t bits = random();
      numbers.field[f] = width < 0
                             ? static_cast<std::int32_t>(static_cast<std::int64_t>(bits) >> (64 + width))
                             : static_cast<std::int32_t>(bits >> (64 - width));
    }
    work.frames.push_back(frame);
    work.numbers.push_back(numbers);
  }
  return work;
}

struct Decoder {
  const char* name;
  std::uint64_t (*run)(std::span<const Frame>);
  Times times{};
};
struct Encoder {
  const char* name;
  void (*run)(std::span<const CarNumbers>, Payload*);
  Times times{};
};

[[noreturn]] void differ(const char* what, const char* one) {
  std::fprintf(stderr, "messages: %s: %s and by hand give different results\n", what, one);
  std::exit(1);
}

/// Rounds of all ways alternate: when the machine slows down, it slows all of them down.
void measure(const char* order, const Work& work, int rounds, bool tell) {
  std::vector<Decoder> decoders{
      {"by hand", decode_car_by_hand}, {"library", decode_car_by_library}, {"table", decode_car_by_table}};
  if (has_vectors()) decoders.push_back({"table, AVX2", decode_car_by_vectors});
  Encoder encoders[] = {{"by hand", encode_car_by_hand}, {"library", encode_car_by_library}};
  const std::size_t count = work.frames.size();
  const std::uint64_t sum = decode_car_by_hand(work.frames);
  std::vector<Payload> expected(count);
  encode_car_by_hand(work.numbers, expected.data());
  std::vector<Payload> frames(count);
  for (int round = 0; round < rounds; ++round) {
    for (Decoder& way : decoders) {
      std::uint64_t result = 0;
      way.times.round(count, [&] { result = way.run(work.frames); });
      if (result != sum) differ("decode", way.name);
    }
    for (Encoder& way : encoders) {
      way.times.round(count, [&] { way.run(work.numbers, frames.data()); });
      if (frames != expected) differ("encode", way.name);
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
    std::fputs("usage: messages [--check]\n", stderr);
    return 2;
  }
  // Few enough that they stay in the cache, many enough that no branch predictor learns their order.
  const std::size_t count = 20'000;
  const int rounds = check ? 1 : 1000;
  measure("random", make_work(count, true), rounds, !check);
  measure("in order", make_work(count, false), rounds, !check);
  return 0;
}
