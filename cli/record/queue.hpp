/// From the thread that receives to the one that writes: blocks of entries, in order, as many as a slow disk
/// may need. The memory grows with the backlog, up to `most` blocks, and is used again; one lock a block.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "ocm/log/entry.hpp"
#include "ocm/log/reader.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli::record {

struct Block {
  std::size_t count = 0;
  Clock::time_point fetched;  ///< the newest of the entries
  std::array<log::Entry, log::batch> entries;
  [[nodiscard]] std::span<const log::Entry> filled() const noexcept {
    return std::span{entries}.first(count);
  }
  [[nodiscard]] bool full() const noexcept { return count == entries.size(); }
};

class Queue {
 public:
  /// 23 MB: 13 s of the fullest bus at 1 Mbit/s, which carries 20000 frames a second.
  static constexpr std::size_t default_most = 1024;

  explicit Queue(std::size_t most = default_most) : most_(most) {}

  /// An empty block to fill; null: all are on their way to the disk.
  [[nodiscard]] std::unique_ptr<Block> take() {
    const std::lock_guard guard{mutex_};
    if (!spare_.empty()) {
      auto block = std::move(spare_.back());  // the last one that came back is still in the cache
      spare_.pop_back();
      return block;
    }
    if (made_ == most_) return nullptr;
    ++made_;
    return std::make_unique<Block>();
  }
  void push(std::unique_ptr<Block> block) {
    {
      const std::lock_guard guard{mutex_};
      filled_.push_back(std::move(block));
    }
    something_.notify_one();
  }
  /// Nothing will be pushed any more.
  void close() {
    {
      const std::lock_guard guard{mutex_};
      closed_ = true;
    }
    something_.notify_one();
  }

  /// The oldest filled block; null: none came within `patience`, or the queue is closed and empty.
  [[nodiscard]] std::unique_ptr<Block> pop(std::chrono::milliseconds patience) {
    std::unique_lock lock{mutex_};
    if (patience.count() > 0)
      something_.wait_for(lock, patience, [this] { return closed_ || !filled_.empty(); });
    if (filled_.empty()) return nullptr;
    auto block = std::move(filled_.front());
    filled_.pop_front();
    return block;
  }
  /// What was popped and is written.
  void give_back(std::unique_ptr<Block> block) {
    block->count = 0;
    const std::lock_guard guard{mutex_};
    spare_.push_back(std::move(block));
  }
  [[nodiscard]] bool finished() const {
    const std::lock_guard guard{mutex_};
    return closed_ && filled_.empty();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable something_;
  std::deque<std::unique_ptr<Block>> filled_;
  std::vector<std::unique_ptr<Block>> spare_;
  std::size_t made_ = 0;
  std::size_t most_;
  bool closed_ = false;
};

}  // namespace ocm::cli::record
