#include "cli/record/writing.hpp"

#include <utility>

namespace ocm::cli::record {
namespace {

/// What was received goes to the kernel, and to the disk, at least so often.
constexpr std::chrono::milliseconds flush_period{1000};

}  // namespace

void Writing::run() {
  while (step(flush_period)) {
  }
}

bool Writing::step(std::chrono::milliseconds patience) {
  if (done_) return false;
  try {
    done_ = !write_next(patience);
  } catch (...) {
    failure_ = std::current_exception();
    failed_ = true;
    done_ = true;
  }
  return !done_;
}

bool Writing::write_next(std::chrono::milliseconds patience) {
  if (queue_->finished()) {
    tell_dropped();
    if (!files_->finish()) failed_ = true;
    return false;
  }
  if (auto block = queue_->pop(patience)) write(std::move(block));
  if (failed_ || (!live_ && Clock::now() - flushed_ < flush_period)) return true;
  flushed_ = Clock::now();
  if (!files_->flush()) failed_ = true;
  size_ = files_->size();
  return true;
}

void Writing::write(std::unique_ptr<Block> block) {
  if (!failed_) {
    tell_dropped();
    if (!files_->write(block->filled(), *interfaces_, block->fetched.time_since_epoch())) failed_ = true;
    size_ = files_->size();
  }
  queue_->give_back(std::move(block));
}

void Writing::tell_dropped() {
  const std::vector<std::uint64_t> dropped(dropped_.begin(), dropped_.end());
  files_->set_dropped(dropped, *interfaces_);
}

}  // namespace ocm::cli::record
