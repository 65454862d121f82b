#include "cli/bus_model/feed.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <net/if.h>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "ocm/log/playback.hpp"
#include "ocm/transport/controller_state.hpp"

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::bus_model {
namespace {

/// So often the kernel is asked for the controller's state, which takes about 20 us.
constexpr base::Duration controller_interval = std::chrono::milliseconds{500};

}  // namespace

// Asked without a wait, `idle` says that nothing is left: see Live.
LiveFeed::LiveFeed(std::unique_ptr<transport::Bus> bus)
    : bus_(std::move(bus)),
      live_(*bus_, [] {}),
      index_(static_cast<int>(::if_nametoindex(std::string{bus_->name()}.c_str()))) {
  interfaces_.number(bus_->name());
}

Over LiveFeed::pump(Models& models) {
  const Over over = live_.receive_any(Clock::now(), [&](const transport::ReceivedAny& received) {
    clock_.take(received.time);
    models.take({received.time, received.frame, 0}, interfaces_);
    return true;
  });
  if (const auto missed = bus_->counters().lost; missed != told_) {
    models.lost(bus_->name(), missed - told_);
    told_ = missed;
  }
  if (index_ > 0 && Clock::now() >= next_look_) {
    next_look_ = Clock::now() + controller_interval;
    if (const auto now = transport::query_controller(index_))
      models.of(bus_->name()).controller_is(now->state, now->counters);
  }
  return over;
}

LogFeed::LogFeed(std::string path, std::string format, const protocol::Catalogue& catalogue)
    : path_(std::move(path)), format_(std::move(format)), catalogue_(&catalogue), batch_(log::batch) {
  std::error_code unreadable;
  if (path_ == "-" || std::filesystem::is_fifo(path_, unreadable))
    fail({"a log that comes through a pipe cannot be wound", "write it to a file, and name that"},
         exit_usage);
  logs::OpenedLog log{path_, format_, catalogue};
  bool any = false;
  base::Time last{};
  while (interrupted() == 0) {
    const std::size_t count = log.reader().read(batch_);
    if (count == 0) break;
    frames_ += count;
    for (std::size_t i = 0; i < count; ++i) {
      if (!any) first_ = last = batch_[i].time;
      any = true;
      last = std::max(last, batch_[i].time);
    }
  }
  log.complain();
  cut_ = log.ended_early();
  if (!any && interrupted() == 0)
    fail({fmt::format("{}: no frame in it", path_), "amiroctl stats FILE says what is in a log"});
  playing_.length = log::Playback::distance(last, first_);
  const log::Interfaces& named = log.reader().interfaces();
  for (std::uint16_t i = 0; i < named.size(); ++i) interfaces_.emplace_back(named.name(i));
  rewind();
}

void LogFeed::rewind() {
  log_ = std::make_unique<logs::OpenedLog>(path_, format_, *catalogue_);
  next_ = size_ = 0;
  played_ = 0;
  playing_.at = {};
  playing_.ended = false;
}

void LogFeed::go_to(base::Duration at, const Take& take) {
  at = std::clamp(at, base::Duration{0}, playing_.length);
  bool ran_out = false;
  while (interrupted() == 0) {
    if (next_ == size_) {
      next_ = 0;
      size_ = log_->reader().read(batch_);
      ran_out = size_ == 0 && interrupted() == 0;
      if (size_ == 0) break;
    }
    const log::Entry& entry = batch_[next_];
    if (log::Playback::distance(entry.time, first_) > at) break;
    take(entry, log_->reader().interfaces());
    ++next_;
    ++played_;
  }
  if (ran_out && played_ < frames_ && !std::exchange(shrank_, true))
    remark(fmt::format("{}: {} of {} frames are not there any more: was it cut, or replaced?", path_,
                       frames_ - played_, frames_));
  playing_.at = at;
  playing_.ended = at >= playing_.length;
}

void LogFeed::play(base::Duration time, const Take& take) {
  go_to(playing_.after(time), take);
}

}  // namespace ocm::cli::bus_model
