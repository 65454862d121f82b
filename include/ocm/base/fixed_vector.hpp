/// A vector with room for N elements inside itself: no heap, trivially usable in constexpr.
/// push_back into a full one is refused, never silently dropped.
#pragma once

#include <array>
#include <cstddef>

#include "ocm/base/result.hpp"

namespace ocm::base {

template <class T, std::size_t N>
class FixedVector {
 public:
  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  [[nodiscard]] constexpr bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] constexpr bool full() const noexcept { return size_ == N; }
  [[nodiscard]] static constexpr std::size_t capacity() noexcept { return N; }

  constexpr Status push_back(const T& item) noexcept {
    if (full()) return Error::full;
    items_[size_++] = item;
    return {};
  }
  constexpr void clear() noexcept { size_ = 0; }
  /// Removes the element at `index`, if there is one; the order of the others stays. O(N).
  constexpr void erase(std::size_t index) noexcept {
    if (index >= size_) return;
    for (std::size_t i = index + 1; i < size_; ++i) items_[i - 1] = items_[i];
    --size_;
  }

  constexpr T& operator[](std::size_t i) noexcept { return items_[i]; }
  constexpr const T& operator[](std::size_t i) const noexcept { return items_[i]; }
  constexpr T* begin() noexcept { return items_.data(); }
  constexpr T* end() noexcept { return items_.data() + size_; }
  constexpr const T* begin() const noexcept { return items_.data(); }
  constexpr const T* end() const noexcept { return items_.data() + size_; }

 private:
  std::array<T, N> items_{};
  std::size_t size_ = 0;
};

}  // namespace ocm::base
