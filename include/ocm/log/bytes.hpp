/// A growing run of bytes that writers append to and the file's owner empties: memory is taken once
/// and kept, nothing is cleared before it is written.
#pragma once

#include <bit>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

namespace ocm::log {

class Bytes {
 public:
  [[nodiscard]] std::string_view view() const noexcept { return {bytes_.get(), size_}; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }
  /// Back to the `size` that it had: what was appended since is gone.
  void cut(std::size_t size) noexcept { size_ = size; }

  /// Room for `count` bytes at the end, not yet part of the run: write there, then `grow` by what was
  /// written.
  [[nodiscard]] char* room(std::size_t count) {
    if (capacity_ - size_ < count) enlarge(count);
    return bytes_.get() + size_;
  }
  void grow(std::size_t count) noexcept {
    size_ += count;
    assert(size_ <= capacity_);
  }
  /// `end` is within the last `room`: the first byte that was not written.
  void grow_to(const char* end) noexcept {
    size_ = static_cast<std::size_t>(end - bytes_.get());
    assert(size_ <= capacity_);
  }

  void append(std::string_view text) {
    if (text.empty()) return;
    std::memcpy(room(text.size()), text.data(), text.size());
    grow(text.size());
  }
  void append(char c) {
    *room(1) = c;
    grow(1);
  }
  void zeros(std::size_t count) {
    if (count == 0) return;
    std::memset(room(count), 0, count);
    grow(count);
  }
  /// The bytes of a number; this library's hosts are little endian.
  template <std::integral T>
  void little(T number) {
    static_assert(std::endian::native == std::endian::little);
    std::memcpy(room(sizeof number), &number, sizeof number);
    grow(sizeof number);
  }
  /// Overwrites at `place` what was appended there.
  template <std::integral T>
  void little_at(std::size_t place, T number) noexcept {
    std::memcpy(bytes_.get() + place, &number, sizeof number);
  }

 private:
  void enlarge(std::size_t count) {
    std::size_t larger = capacity_ == 0 ? std::size_t{1} << 16 : capacity_ * 2;
    while (larger - size_ < count) larger *= 2;
    std::unique_ptr<char[]> bytes{new char[larger]};  // not make_unique, which would clear them
    if (size_ != 0) std::memcpy(bytes.get(), bytes_.get(), size_);
    bytes_ = std::move(bytes);
    capacity_ = larger;
  }

  std::unique_ptr<char[]> bytes_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace ocm::log
