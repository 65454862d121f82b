#include "cli/record/recorder.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <poll.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/error_frame.hpp"
#include "ocm/host/system_time.hpp"

#include "cli/record/names.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/terminal.hpp"

namespace ocm::cli::record {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using transport::BusState;

/// A frame waits this long for others before it goes to the writing thread.
constexpr milliseconds hand_over_period{100};
/// The kernel's queue has its time on each frame already: fetching them in a bunch costs less.
constexpr milliseconds fetch_pause{4};
/// A bunch of this many came before the pause was over: the bus is too busy for one.
constexpr std::size_t busy = Capture::batch;
constexpr milliseconds look_period{200};
constexpr milliseconds longest_wait{200};  // bounds how long a signal that comes just before goes unseen
/// What was received goes to the kernel, and to the disk, at least so often.
constexpr milliseconds flush_period{1000};

/// Signals are for the thread that receives: its waits end with them.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_{};
};

void erase_line() {
  fmt::print(stderr, "\r\x1b[K");
}

}  // namespace

Recorder::Recorder(std::vector<Port> ports, Filters filters, Files& files, Limits limits, bool live)
    : ports_(std::move(ports)),
      filters_(std::move(filters)),
      files_(&files),
      limits_(limits),
      live_(live),
      on_terminal_(isatty(STDERR_FILENO) != 0),
      dropped_(ports_.size()) {
  for (Port& port : ports_) {
    port.number = interfaces_.add(port.capture->name());
    patient_ = patient_ && port.capture->keeps_times();
  }
  begin_ = handed_over_ = looked_ = shown_ = Clock::now();
  const SignalsBlocked blocked;
  writer_ = std::thread{[this] { write_all(); }};
}

Recorder::~Recorder() {
  queue_.close();
  if (writer_.joinable()) writer_.join();
}

void Recorder::run() {
  const auto end = limits_.duration > base::Duration::zero()
                       ? begin_ + std::chrono::duration_cast<Clock::duration>(limits_.duration)
                       : Clock::time_point::max();
  while (interrupted() == 0 && !disk_failed_ && ended_.what.empty()) {
    const std::size_t count = drain();
    if (limits_.count != 0 && received_ >= limits_.count) break;
    const auto now = Clock::now();
    if (now >= end) break;
    if (live_ || now - handed_over_ >= hand_over_period) hand_over();
    if (now - looked_ >= look_period) look();
    if (on_terminal_ && now - shown_ >= seconds{1}) show_progress();
    if (count < busy) wait();
  }
  // What came before the end is recorded; what comes now is not.
  if (limits_.count == 0) static_cast<void>(drain());
  emit(merge_.take_all());
  look();
  hand_over();
  lasted_ = Clock::now() - begin_;
  queue_.close();
  writer_.join();
  if (on_terminal_) erase_line();
  if (writer_failure_ != nullptr) std::rethrow_exception(writer_failure_);
}

/// What waits on all buses.
std::size_t Recorder::drain() {
  fetched_ = Clock::now();
  if (ports_.size() == 1) return drain_into_blocks(ports_.front());
  std::size_t count = 0;
  for (Port& port : ports_) count += drain_into_merge(port);
  emit(merge_.take());
  return count;
}

std::size_t Recorder::drain_into_blocks(Port& port) {
  std::size_t count = 0;
  // Bounded, so that a flood does not keep us from looking at the clock.
  for (int round = 0; round < 16; ++round) {
    const std::span<log::Entry> room = room_in_block();
    const std::size_t more = room.empty() ? 0 : port.capture->read(room, port.number);
    account(port, room.first(more));
    keep(port, more);
    count += more;
    if (more < std::min(room.size(), Capture::batch)) break;
  }
  return count;
}

std::size_t Recorder::drain_into_merge(Port& port) {
  std::array<log::Entry, Capture::batch> entries;
  std::size_t count = 0;
  for (int round = 0; round < 16; ++round) {
    const std::size_t more = port.capture->read(entries, port.number);
    account(port, std::span{entries}.first(more));
    merge_.add(std::span{entries}.first(more));
    count += more;
    if (more < entries.size()) break;
  }
  return count;
}

void Recorder::emit(std::span<const log::Entry> entries) {
  for (const auto& entry : entries) {
    const std::span<log::Entry> room = room_in_block();
    if (room.empty()) return;  // -n is reached
    room.front() = entry;
    keep(ports_[entry.interface], 1);
  }
}

/// Where the next entries go: a block on its way to the disk, or, when all are, one that is thrown away.
std::span<log::Entry> Recorder::room_in_block() {
  if (block_ == nullptr) block_ = queue_.take();
  Block& block = block_ != nullptr ? *block_ : unwanted_;
  const std::span<log::Entry> room = std::span{block.entries}.subspan(block.count);
  if (limits_.count == 0) return room;
  return room.first(
      static_cast<std::size_t>(std::min<std::uint64_t>(room.size(), limits_.count - received_)));
}

/// This many entries were put where `room_in_block` said.
void Recorder::keep(Port& port, std::size_t count) {
  if (block_ == nullptr) {
    port.lost_here += count;
    return;
  }
  received_ += count;
  block_->count += count;
  block_->fetched = fetched_;
  if (block_->full()) hand_over();
}

void Recorder::account(Port& port, std::span<const log::Entry> entries) {
  port.received += entries.size();
  for (const auto& entry : entries) {
    if (on_terminal_) port.load.add(entry);
    if (entry.format != can::Format::error) continue;
    ++port.errors;
    if (can::lost_in_controller(*entry.classic())) ++port.overflows;
  }
}

void Recorder::hand_over() {
  handed_over_ = Clock::now();
  if (block_ == nullptr || block_->count == 0) return;
  for (const Port& port : ports_) dropped_[port.number] = port.lost();
  queue_.push(std::move(block_));
}

void Recorder::look() {
  looked_ = Clock::now();
  for (Port& port : ports_) look(port);
}

void Recorder::look(Port& port) {
  if (port.state == BusState::closed) {
    reopen(port);
    return;
  }
  port.capture->look();
  const BusState state = port.capture->state();
  dropped_[port.number] = port.lost();
  if (state == std::exchange(port.state, state)) return;
  if (on_terminal_) erase_line();
  if (state == BusState::up) remark(fmt::format("{} is up again", port.name));
  if (state == BusState::down) remark(fmt::format("{} went down; waiting for it to come back", port.name));
  if (state != BusState::closed) return;
  const auto& failure = port.capture->failure();
  if (port.capture->may_return())
    remark(fmt::format("{}; waiting for it to come back", failure.what));
  else
    ended_ = failure;
}

void Recorder::reopen(Port& port) {
  auto opened = open_capture(port.name, filters_);
  if (!opened) return;
  port.lost_before += port.capture->lost();
  port.capture = std::move(opened.value);
  port.state = BusState::up;
  if (on_terminal_) erase_line();
  remark(fmt::format("{} is back", port.name));
}

/// For frames, and a little longer, so that they come in bunches.
void Recorder::wait() {
  auto limit = longest_wait;
  if (block_ != nullptr && block_->count != 0) limit = hand_over_period;
  std::array<pollfd, 64> entries{};
  nfds_t count = 0;
  for (const Port& port : ports_) {
    if (port.state != BusState::closed && count < entries.size())
      entries[count++] = {port.capture->descriptor(), POLLIN, 0};
  }
  if (::poll(entries.data(), count, static_cast<int>(limit.count())) <= 0 || !patient_ || live_) return;
  const timespec time = host::to_timespec(fetch_pause);
  ::nanosleep(&time, nullptr);
}

void Recorder::show_progress() {
  const auto now = Clock::now();
  const base::Duration passed = now - shown_;
  const double frames =
      static_cast<double>(received_ - shown_received_) * 1e9 / static_cast<double>(passed.count());
  std::string text = fmt::format("{} frames, {:.0f}/s", received_, frames);
  std::uint64_t lost = 0;
  for (Port& port : ports_) {
    lost += port.lost();
    const std::uint32_t rate = port.capture->bit_rate() != 0 ? port.capture->bit_rate() : limits_.bit_rate;
    text += fmt::format(", {} {:.0f} % full", port.name, 100 * port.load.take(passed, rate));
  }
  text += fmt::format(", {} lost, {}", lost, size_text(size_));
  std::error_code error;
  const auto folder = std::filesystem::absolute(files_->first_path(), error).parent_path();
  const auto space = std::filesystem::space(folder, error);
  if (!error) text += fmt::format(", {} free", size_text(space.available));
  // A line that breaks could not be erased. Its last column is left free: some terminals go on to the next
  // line.
  text.resize(std::min(text.size(), terminal_size(STDERR_FILENO).columns - 1));
  erase_line();
  fmt::print(stderr, "{}", text);
  std::fflush(stderr);
  shown_ = now;
  shown_received_ = received_;
}

// --- the thread that writes ---

/// An exception that leaves a thread would end the program with what was received before unwritten.
void Recorder::write_all() {
  try {
    write_blocks();
  } catch (...) {
    writer_failure_ = std::current_exception();
    disk_failed_ = true;
  }
}

void Recorder::write_blocks() {
  auto flushed = Clock::now();
  while (!queue_.finished()) {
    if (auto block = queue_.pop(flush_period)) write(std::move(block));
    if (disk_failed_ || (!live_ && Clock::now() - flushed < flush_period)) continue;
    flushed = Clock::now();
    if (!files_->flush()) disk_failed_ = true;
    size_ = files_->size();
  }
  std::vector<std::uint64_t> dropped(dropped_.begin(), dropped_.end());
  files_->set_dropped(dropped);
  if (!files_->finish()) disk_failed_ = true;
}

void Recorder::write(std::unique_ptr<Block> block) {
  if (!disk_failed_) {
    std::vector<std::uint64_t> dropped(dropped_.begin(), dropped_.end());
    files_->set_dropped(dropped);
    if (!files_->write(block->filled(), interfaces_, block->fetched.time_since_epoch())) disk_failed_ = true;
    size_ = files_->size();
  }
  queue_.give_back(std::move(block));
}

}  // namespace ocm::cli::record
