/// CAN FD frames that wait somewhere, by number, so that what queues classic frames stays small. Places are
/// used again; memory grows to the most frames that ever waited at once, 72 bytes each. O(1). Host only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "ocm/can/any_frame.hpp"

namespace ocm::simulation {

class FdStore {
 public:
  /// Its number, which is never 0.
  [[nodiscard]] std::uint32_t keep(const can::AnyFrame& frame) {
    if (free_.empty()) {
      frames_.push_back(frame);
      if (free_.capacity() < frames_.size()) free_.reserve(2 * frames_.size());
      return static_cast<std::uint32_t>(frames_.size());
    }
    const std::uint32_t number = free_.back();
    free_.pop_back();
    frames_[number - 1] = frame;
    return number;
  }
  /// Of a frame that is kept; 0: nothing happens.
  void release(std::uint32_t number) noexcept {
    if (number != 0) free_.push_back(number);  // there is room: see `keep`
  }
  /// A frame that is kept.
  [[nodiscard]] const can::AnyFrame& operator[](std::uint32_t number) const noexcept {
    return frames_[number - 1];
  }
  /// How many are kept.
  [[nodiscard]] std::size_t size() const noexcept { return frames_.size() - free_.size(); }

 private:
  std::deque<can::AnyFrame> frames_;
  std::vector<std::uint32_t> free_;
};

}  // namespace ocm::simulation
