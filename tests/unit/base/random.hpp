/// Seeded random numbers for tests: the same in every run, and with every standard library. Two calls in one
/// argument list come in the order that the compiler likes.
#pragma once

#include <cstdint>
#include <random>

namespace ocm::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_{seed} {}

  std::uint64_t word() { return engine_(); }
  std::uint32_t operator()() { return static_cast<std::uint32_t>(engine_() >> 32); }
  /// 0 .. n - 1
  std::uint32_t below(std::uint32_t n) { return operator()() % n; }
  int within(int low, int high) {
    return low + static_cast<int>(below(static_cast<std::uint32_t>(high - low + 1)));
  }
  /// Of random magnitude up to 2^most_bits - 1, so that small and large numbers both come often.
  std::int64_t digits(int most_bits = 63) {
    const auto magnitude = static_cast<std::int64_t>(word() >> (63 - within(0, most_bits - 1)));
    return word() % 2 == 0 ? magnitude : -magnitude;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace ocm::test
