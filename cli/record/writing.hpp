/// The end of a recording that writes: takes blocks from the queue to the files. In a thread of its own
/// (`run`), so that a disk that takes its time costs no frames, or step by step.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <vector>

#include "ocm/log/interfaces.hpp"

#include "cli/record/files.hpp"
#include "cli/record/queue.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli::record {

class Writing {
 public:
  /// `files` is open; `interfaces` has all its names. `live`: its reader waits for each frame (a pipe).
  Writing(Queue& queue, Files& files, const log::Interfaces& interfaces, bool live)
      : queue_(&queue), files_(&files), interfaces_(&interfaces), live_(live), dropped_(interfaces.size()) {}

  /// Until the queue is closed and all of it is written, and the files are finished. What it throws is in
  /// `failure`: an exception that leaves a thread would end the program with what was received before
  /// unwritten.
  void run();
  /// The same, one block at most; waits at most `patience` for it. false: it is done.
  [[nodiscard]] bool step(std::chrono::milliseconds patience);

  // For the thread that receives:
  /// Frames of an interface that were on the bus and could not be written, so far.
  void set_dropped(std::size_t interface, std::uint64_t frames) { dropped_[interface] = frames; }
  [[nodiscard]] bool failed() const noexcept { return failed_; }       ///< the files take no more
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }  ///< of the files
  /// What ended it, if it was an exception. Once it is done.
  [[nodiscard]] const std::exception_ptr& failure() const noexcept { return failure_; }

 private:
  [[nodiscard]] bool write_next(std::chrono::milliseconds patience);
  void write(std::unique_ptr<Block> block);
  void tell_dropped();

  Queue* queue_;
  Files* files_;
  const log::Interfaces* interfaces_;
  bool live_;
  bool done_ = false;
  Clock::time_point flushed_ = Clock::now();
  std::vector<std::atomic<std::uint64_t>> dropped_;  ///< by number of the interface
  std::atomic<bool> failed_{false};
  std::atomic<std::uint64_t> size_{0};
  std::exception_ptr failure_;
};

}  // namespace ocm::cli::record
