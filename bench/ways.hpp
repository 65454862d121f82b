/// Ways to decode and to encode the same frames, beside one another: what the benchmarks of the codec share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "ocm/can/frame.hpp"

#include "bench/times.hpp"

namespace ocm::bench {

template <class Numbers>
struct Work {
  std::vector<can::Frame> frames;
  std::vector<Numbers> numbers;
};

struct Decoder {
  const char* name;
  std::uint64_t (*run)(std::span<const can::Frame>);
  bool whole = true;  ///< decodes, so that its sum must be right
  Times times{};
};
template <class Numbers>
struct Encoder {
  const char* name;
  void (*run)(std::span<const Numbers>, can::Payload*);
  Times times{};
};

/// The first of each is by hand: all others must give what it gives, and are compared with it.
template <class Numbers>
struct Ways {
  const char* program;
  std::vector<Decoder> decoders;
  std::vector<Encoder<Numbers>> encoders;

  /// Rounds of all ways alternate: when the machine slows down, it slows all of them down. `order`: of the
  /// frames, as it is printed; nullptr: nothing is.
  void measure(const char* order, const Work<Numbers>& work, int rounds) {
    const std::size_t count = work.frames.size();
    const std::uint64_t sum = decoders.front().run(work.frames);
    std::vector<can::Payload> expected(count);
    encoders.front().run(work.numbers, expected.data());
    std::vector<can::Payload> frames(count);
    for (auto& way : decoders) way.times = {};
    for (auto& way : encoders) way.times = {};
    for (int round = 0; round < rounds; ++round) {
      for (auto& way : decoders) {
        std::uint64_t result = 0;
        way.times.round(count, [&] { result = way.run(work.frames); });
        if (way.whole && result != sum) differ("decode", way.name);
      }
      for (auto& way : encoders) {
        way.times.round(count, [&] { way.run(work.numbers, frames.data()); });
        if (frames != expected) differ("encode", way.name);
        std::fill(frames.begin(), frames.end(), can::Payload{});
      }
    }
    if (order == nullptr) return;
    for (const auto& way : decoders) print("decode", order, way.name, way.times, decoders.front().times);
    for (const auto& way : encoders) print("encode", order, way.name, way.times, encoders.front().times);
  }

  /// The program: `make_work(count, random_order)`. With random order off one kind of frame comes after the
  /// other: what the codec costs without the guesses that the processor gets wrong.
  template <class F>
  int main(int argc, char** argv, F&& make_work) {
    const bool check = argc == 2 && std::string_view{argv[1]} == "--check";
    if (argc > 1 && !check) {
      std::fprintf(stderr, "usage: %s [--check]\n", program);
      return 2;
    }
    // Few enough that they stay in the cache, many enough that no branch predictor learns their order.
    const std::size_t count = 20'000;
    const int rounds = check ? 1 : 1000;
    measure(check ? nullptr : "random", make_work(count, true), rounds);
    measure(check ? nullptr : "in order", make_work(count, false), rounds);
    return 0;
  }

 private:
  [[noreturn]] void differ(const char* what, const char* one) const {
    std::fprintf(stderr, "%s: %s: %s and by hand give different results\n", program, what, one);
    std::exit(1);
  }
};

}  // namespace ocm::bench
