#include "cli/record/recorder.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <poll.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/error_frame.hpp"

#include "cli/record/names.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/terminal.hpp"
#include "cli/shared/unhurried_messages.hpp"

namespace ocm::cli::record {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using transport::BusState;

/// A frame waits this long for others before it goes to the writing thread.
constexpr milliseconds hand_over_period{100};
/// The kernel's queue has its time on each frame already: fetching them in a bunch costs less.
constexpr milliseconds fetch_pause{4};
/// Rounds of reading one bus between two looks at the clock.
constexpr int rounds_a_look = 16;
/// Of several buses so many looks are gathered before any frame is handed on, where more wait than one look
/// fetches: what is fetched next from one bus may be older than what came from another. Then it is a flood.
constexpr int looks_held_back = 16;
/// So long what came before the end is fetched.
constexpr seconds longest_end{1};
/// A bunch of this many came before the pause was over: the bus is too busy for one.
constexpr std::size_t busy = Capture::batch;
constexpr milliseconds look_period{200};
constexpr milliseconds longest_wait{200};  // bounds how long a signal that comes just before goes unseen

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

/// Where the terminal takes it: after Ctrl-S the recording goes on.
void erase_line() {
  static_cast<void>(write_now(STDERR_FILENO, "\r\x1b[K"));
}

/// Gives each its number in the log.
log::Interfaces number(std::vector<Port>& ports) {
  log::Interfaces interfaces;
  for (Port& port : ports) port.number = interfaces.add(port.capture->name());
  return interfaces;
}

}  // namespace

Recorder::Recorder(std::vector<Port> ports, Reopen reopen, Files& files, Limits limits, bool live)
    : ports_(std::move(ports)),
      reopen_(std::move(reopen)),
      files_(&files),
      limits_(limits),
      live_(live),
      on_terminal_(can_redraw(STDERR_FILENO)),
      interfaces_(number(ports_)),
      queue_(limits.blocks),
      writing_(queue_, files, interfaces_, live) {
  for (const Port& port : ports_) patient_ = patient_ && port.capture->keeps_times();
  begin_ = handed_over_ = looked_ = shown_ = Clock::now();
}

Recorder::~Recorder() {
  queue_.close();
  if (writer_.joinable()) writer_.join();
}

void Recorder::run() {
  {
    const SignalsBlocked blocked;
    writer_ = std::thread{[this] { writing_.run(); }};
  }
  receive();
  writer_.join();
  if (on_terminal_) erase_line();
  if (writing_.failure() != nullptr) std::rethrow_exception(writing_.failure());
}

void Recorder::receive() {
  const auto end = limits_.duration > base::Duration::zero() ? time_after(begin_, limits_.duration)
                                                             : Clock::time_point::max();
  while (interrupted() == 0 && !writing_.failed() && ended_.what.empty()) {
    const std::size_t count = drain();
    if (limits_.count != 0 && received_ >= limits_.count) break;
    const auto now = Clock::now();
    if (now >= end) break;
    if (live_ || now - handed_over_ >= hand_over_period) hand_over();
    if (now - looked_ >= look_period) look();
    if (on_terminal_ && now - shown_ >= seconds{1}) show_progress();
    if (count < busy) wait(end - now);
  }
  // What came before the end is recorded; what comes now is not.
  if (limits_.count == 0) drain_to_the_end();
  emit(merge_.take_all());
  look();
  hand_over();
  lasted_ = Clock::now() - begin_;
  queue_.close();
}

/// What waits on all buses.
std::size_t Recorder::drain() {
  fetched_ = Clock::now();
  if (ports_.size() == 1) return drain_into_blocks(ports_.front());
  std::size_t count = 0;
  bool all = true;
  for (Port& port : ports_) {
    const std::size_t more = drain_into_merge(port);
    all = all && more < rounds_a_look * Capture::batch;
    count += more;
  }
  if (!all && ++held_back_ < looks_held_back) return count;
  held_back_ = 0;
  emit(merge_.take());
  return count;
}

/// After a stop of this program thousands of frames may wait. A flood has no end, and is cut off.
void Recorder::drain_to_the_end() {
  const auto cut_off = Clock::now() + longest_end;
  while (drain() >= busy && Clock::now() < cut_off) {
  }
}

std::size_t Recorder::drain_into_blocks(Port& port) {
  std::size_t count = 0;
  // Bounded, so that a flood does not keep us from looking at the clock.
  for (int round = 0; round < rounds_a_look; ++round) {
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
  for (int round = 0; round < rounds_a_look; ++round) {
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
  for (const Port& port : ports_) writing_.set_dropped(port.number, port.lost());
  if (block_ == nullptr || block_->count == 0) return;
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
  auto opened = reopen_(port.name);
  if (!opened) return;
  port.lost_before += port.capture->lost();
  port.capture = std::move(opened.value);
  port.state = BusState::up;
  if (on_terminal_) erase_line();
  remark(fmt::format("{} is back", port.name));
}

/// For frames, and a little longer, so that they come in bunches; no longer than is left.
void Recorder::wait(base::Duration left) {
  base::Duration limit = longest_wait;
  if (block_ != nullptr && block_->count != 0) limit = hand_over_period;
  limit = std::min(limit, left);
  std::array<pollfd, 64> entries{};
  std::size_t count = 0;
  for (const Port& port : ports_) {
    if (port.state != BusState::closed && count < entries.size())
      entries[count++] = {port.capture->descriptor(), POLLIN, 0};
  }
  if (wait_for_input(std::span{entries}.first(count), limit) && patient_ && !live_) sleep_for(fetch_pause);
}

void Recorder::show_progress() {
  const auto now = Clock::now();
  const base::Duration passed = now - shown_;
  const double frames =
      static_cast<double>(received_ - shown_received_) * 1e9 / static_cast<double>(passed.count());
  std::string text = fmt::format("{}, {:.0f}/s", counted(received_, "frame"), frames);
  std::uint64_t lost = 0;
  for (Port& port : ports_) {
    lost += port.lost();
    const std::uint32_t rate = port.capture->bit_rate() != 0 ? port.capture->bit_rate() : limits_.bit_rate;
    text += fmt::format(", {} {:.0f} % full", port.name, 100 * port.load.take(passed, rate));
  }
  text += fmt::format(", {} lost, {}", lost, size_text(writing_.size()));
  std::error_code error;
  const auto folder = std::filesystem::absolute(files_->first_path(), error).parent_path();
  const auto space = std::filesystem::space(folder, error);
  if (!error) text += fmt::format(", {} free", size_text(space.available));
  // A line that breaks could not be erased. Its last column is left free: some terminals go on to the next
  // line.
  text.resize(std::min(text.size(), terminal_size(STDERR_FILENO).columns - 1));
  erase_line();
  static_cast<void>(write_now(STDERR_FILENO, text));
  shown_ = now;
  shown_received_ = received_;
}

}  // namespace ocm::cli::record
