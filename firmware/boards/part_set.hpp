/// The parts of a board by their numbers: looked after in turn, and what they say together. For a board's
/// parts.hpp to derive from.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"

namespace ocm::firmware::boards {

/// `Derived` befriends this and has `pick(self, number, what)`, which calls `what` with part number 0 .. N
/// - 1.
template <class Derived, std::size_t N>
class PartSet {
 public:
  static constexpr std::size_t parts = N;

  /// Failed starts, checks and reads of one part.
  [[nodiscard]] std::uint16_t faults(std::size_t number) const noexcept {
    std::uint16_t faults = 0;
    with(number, [&](const auto& each) { faults = each.faults(); });
    return faults;
  }
  /// Of all parts together.
  [[nodiscard]] std::uint32_t faults() const noexcept {
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < N; ++i) sum += faults(i);
    return sum;
  }

 protected:
  /// Tries each part once.
  void start_parts(base::Time now) {
    for (std::size_t i = 0; i < N; ++i) with(i, [now](auto& each) { each.maintain(now); });
  }
  /// Looks after the next part that needs it, at most one.
  void maintain_one(base::Time now) {
    for (std::size_t i = 0; i < N; ++i) {
      bool used = false;
      with(turn_, [&](auto& each) { used = each.maintain(now); });
      turn_ = (turn_ + 1) % N;
      if (used) return;
    }
  }
  /// Bit i: part number i does not answer; of the first `count`.
  [[nodiscard]] unsigned absent_bits(std::size_t count = N) const noexcept {
    unsigned bits = 0;
    for (std::size_t i = 0; i < count; ++i)
      with(i, [&](const auto& each) { bits |= static_cast<unsigned>(each.absent()) << i; });
    return bits;
  }

 private:
  template <class F>
  void with(std::size_t number, F what) {
    Derived::pick(static_cast<Derived&>(*this), number, what);
  }
  template <class F>
  void with(std::size_t number, F what) const {
    Derived::pick(static_cast<const Derived&>(*this), number, what);
  }

  std::size_t turn_ = 0;
};

}  // namespace ocm::firmware::boards
