/// How good a link is: the running share of sentences that came whole. A robot that drives out of reach tears
/// more and more of them before it is lost; `below` is the moment to call it back. [Thesis 2, 15.3]
///
/// Fixed point, no division; O(1) a sentence, 12 bytes, constexpr. Silence changes nothing: a deadline is the
/// caller's.
#pragma once

#include <cstdint>

namespace ocm::mapper::link {

/// Of one link. `good` and `bad` sentence by sentence, or `observe` with running totals.
class LinkQuality {
 public:
  /// A new link is trusted. One sentence weighs 1/16: half of what was is forgotten after 11.
  constexpr void good() noexcept { value_ = value_ - (value_ >> weight) + (one >> weight); }
  constexpr void bad() noexcept { value_ -= (value_ >> weight); }

  /// Follows counters that only grow, and may wrap: `heard` whole sentences and `failed` ones. Of what came
  /// between two calls the failed ones are taken first. O(difference), a hundred at most.
  constexpr void observe(std::uint32_t heard, std::uint32_t failed) noexcept {
    for (std::uint32_t n = bounded(failed - failed_); n != 0; --n) bad();
    for (std::uint32_t n = bounded(heard - heard_); n != 0; --n) good();
    heard_ = heard;
    failed_ = failed;
  }
  /// Trusted again, with the counters where they stand: the next link is not judged by the last.
  constexpr void restart() noexcept { value_ = one; }

  /// 0 .. 1000
  [[nodiscard]] constexpr std::uint32_t per_mille() const noexcept { return (value_ >> 8) * 1000 >> 16; }
  [[nodiscard]] constexpr bool below(std::uint32_t limit_per_mille) const noexcept {
    return per_mille() < limit_per_mille;
  }

 private:
  static constexpr std::uint32_t one = std::uint32_t{1} << 24;
  static constexpr unsigned weight = 4;
  /// After a hundred of a kind nothing of before is left to see.
  [[nodiscard]] static constexpr std::uint32_t bounded(std::uint32_t n) noexcept { return n < 100 ? n : 100; }

  std::uint32_t value_ = one;
  std::uint32_t heard_ = 0;
  std::uint32_t failed_ = 0;
};

}  // namespace ocm::mapper::link
