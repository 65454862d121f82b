/// The frames that wait in a node of a simulated bus, and which of them it offers. Host side: memory for the
/// whole queue is taken at construction, 32 bytes a frame. `offer` and `take` are O(size) for mailboxes, O(1)
/// for a FIFO.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ocm/can/frame.hpp"

namespace ocm::simulation {

/// Which of its waiting frames a node offers to the bus.
enum class QueueOrder : std::uint8_t {
  fifo,           ///< the oldest: a socket of a host, a controller with a transmit FIFO
  by_identifier,  ///< the one that wins the arbitration; of equals the oldest: mailboxes
};

struct WaitingFrame {
  can::Frame frame{};
  std::uint32_t key = 0;    ///< can::arbitration_key
  std::uint32_t fd = 0;     ///< where the rest of a CAN FD frame is kept (FdStore); 0: a classic frame
  std::uint64_t ready = 0;  ///< first boundary at which it may start
};

/// A ring in order of hand-over.
class TransmitQueue {
 public:
  TransmitQueue() = default;
  /// Of `capacity` frames, at least 1.
  TransmitQueue(QueueOrder order, std::size_t capacity)
      : ring_(std::max<std::size_t>(capacity, 1) + 1), order_(order) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  /// Frames that it still takes.
  [[nodiscard]] std::size_t room() const noexcept {
    return size_ + 1 < ring_.size() ? ring_.size() - 1 - size_ : 0;
  }
  /// When the oldest may start. There is one.
  [[nodiscard]] std::uint64_t earliest() const noexcept { return (*this)[0].ready; }
  /// The i-th oldest, i below size().
  [[nodiscard]] const WaitingFrame& operator[](std::size_t i) const noexcept { return ring_[place(i)]; }

  /// What was pushed last, and nothing was taken since.
  [[nodiscard]] WaitingFrame& newest() noexcept { return ring_[place(size_ - 1)]; }
  /// There is room.
  void push(const WaitingFrame& item) noexcept { ring_[place(size_++)] = item; }
  /// What the node offers at a start of frame: its position, or size() for nothing.
  [[nodiscard]] std::size_t offer(std::uint64_t boundary) const noexcept {
    if (empty() || earliest() > boundary) return size_;
    std::size_t best = 0;
    if (order_ == QueueOrder::by_identifier)
      for (std::size_t i = 1; i < size_ && (*this)[i].ready <= boundary; ++i)
        if ((*this)[i].key < (*this)[best].key) best = i;
    return best;
  }
  /// The i-th oldest leaves.
  WaitingFrame take(std::size_t i) noexcept {
    const WaitingFrame item = (*this)[i];
    for (; i > 0; --i) ring_[place(i)] = ring_[place(i - 1)];
    head_ = place(1);
    --size_;
    return item;
  }
  /// Undoes the last `take`, of which nothing was taken since; what came since is behind it. There is place
  /// for this one frame beyond the capacity.
  void put_back(std::size_t i, const WaitingFrame& item) noexcept {
    head_ = head_ == 0 ? ring_.size() - 1 : head_ - 1;
    ++size_;
    for (std::size_t k = 0; k < i; ++k) ring_[place(k)] = ring_[place(k + 1)];
    ring_[place(i)] = item;
  }
  void clear() noexcept { size_ = 0; }

 private:
  [[nodiscard]] std::size_t place(std::size_t i) const noexcept {
    const std::size_t unwrapped = head_ + i;
    return unwrapped < ring_.size() ? unwrapped : unwrapped - ring_.size();
  }

  std::vector<WaitingFrame> ring_;  ///< one place more than the capacity
  std::size_t head_ = 0;
  std::size_t size_ = 0;
  QueueOrder order_ = QueueOrder::fifo;
};

}  // namespace ocm::simulation
