/// Bytes from the dongle on their way from the UART's interrupt to the communication task: a ring of `N`,
/// whose caller locks around it. A byte without room is lost and counted: the sentence that it belongs to is
/// then damaged, and the reader counts that, too. O(1), N and 12 bytes, constexpr, no heap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"

namespace ocm::mapper::app {

template <std::size_t N>
requires(N > 0) class Input {
 public:
  constexpr void push(std::uint8_t byte) noexcept {
    if (size_ == N) {
      ++lost_;
      return;
    }
    bytes_[(first_ + size_++) % N] = byte;
  }
  /// The oldest; Error::no_answer when there is none.
  [[nodiscard]] constexpr base::Result<std::uint8_t> pop() noexcept {
    if (size_ == 0) return base::Error::no_answer;
    const std::uint8_t byte = bytes_[first_];
    first_ = (first_ + 1) % N;
    --size_;
    return byte;
  }
  /// They came over a link that is gone.
  constexpr void drop() noexcept {
    dropped_ += static_cast<std::uint32_t>(size_);
    size_ = 0;
  }

  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  /// So much has come that it should be read, whatever it is.
  [[nodiscard]] constexpr bool filling() const noexcept { return size_ * 2 >= N; }
  /// Bytes that found no room. It wraps, like the next.
  [[nodiscard]] constexpr std::uint32_t lost() const noexcept { return lost_; }
  [[nodiscard]] constexpr std::uint32_t dropped() const noexcept { return dropped_; }

 private:
  std::array<std::uint8_t, N> bytes_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::uint32_t lost_ = 0;
  std::uint32_t dropped_ = 0;
};

}  // namespace ocm::mapper::app
