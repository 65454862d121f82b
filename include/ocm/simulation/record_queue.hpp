/// What waits to be read by a client of the virtual bus: a bounded ring of records, handed to the kernel in
/// up to two pieces. O(1), but for growing; memory grows as needed, up to the limit. Host only.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <sys/uio.h>
#include <vector>

#include "ocm/transport/virtual_bus_protocol.hpp"

namespace ocm::simulation {

class RecordQueue {
 public:
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }
  bool push(const transport::virtual_bus::Record& record, std::size_t limit) {
    if (size_ >= limit) return false;
    if (size_ == ring_.size()) {
      std::rotate(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(head_), ring_.end());
      head_ = 0;
      ring_.resize(std::min(limit, std::max<std::size_t>(2 * size_, 64)));
    }
    ring_[wrap(head_ + size_++)] = record;
    return true;
  }
  /// All of them or none.
  bool push(std::span<const transport::virtual_bus::Record> records, std::size_t limit) {
    if (size_ > limit || records.size() > limit - size_) return false;
    for (const auto& record : records) push(record, limit);
    return true;
  }
  /// The i-th oldest, i below size().
  [[nodiscard]] const transport::virtual_bus::Record& operator[](std::size_t i) const noexcept {
    return ring_[wrap(head_ + i)];
  }
  /// The oldest `count` records, in up to two pieces.
  [[nodiscard]] std::array<iovec, 2> front(std::size_t count) noexcept {
    const std::size_t first = std::min(count, ring_.size() - head_);
    return {iovec{ring_.data() + head_, first * transport::virtual_bus::record_size},
            iovec{ring_.data(), (count - first) * transport::virtual_bus::record_size}};
  }
  void pop(std::size_t count) noexcept {
    head_ = wrap(head_ + count);
    size_ -= count;
  }

 private:
  [[nodiscard]] std::size_t wrap(std::size_t i) const noexcept {
    return i < ring_.size() ? i : i - ring_.size();
  }
  std::vector<transport::virtual_bus::Record> ring_;
  std::size_t head_ = 0;
  std::size_t size_ = 0;
};

}  // namespace ocm::simulation
