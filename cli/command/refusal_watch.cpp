#include "cli/command/refusal_watch.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "cli/shared/filters.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/remedies.hpp"

namespace ocm::cli {
namespace {

/// The library takes time from its caller.
base::Time now() {
  return base::Time{Live::Clock::now().time_since_epoch()};
}

}  // namespace

void RefusalWatch::prepare(transport::Bus& bus, std::span<const can::Frame> frames,
                           std::vector<const protocol::Topic*> also) {
  if (confirm_)
    for (const auto& frame : frames)
      if (const auto* const topic = refusals_.refusal_topic(frame);
          topic != nullptr && std::find(also.begin(), also.end(), topic) == also.end())
        also.push_back(topic);
  if (also.empty()) return;  // no filter at all would let everything pass
  if (const auto filters = bus_filters(filters_for(also, false)))
    if (const auto subscribed = bus.subscribe(*filters); !subscribed) fail(subscribed.error);
  while (const auto received = bus.receive(base::Duration{0})) take(*received);
}

void RefusalWatch::sent(std::span<const can::Frame> frames) {
  for (const auto& frame : frames) sent(frame);
}

void RefusalWatch::sent(const can::Frame& frame, bool again) {
  if (!confirm_) return;
  ++commanded_;
  if (again)
    static_cast<void>(refusals_.repeated(frame, now()));
  else
    refusals_.sent(frame, now());
}

bool RefusalWatch::take(const can::Received& received) {
  if (!confirm_) return false;
  const auto refused = refusals_.take(received, now());
  if (refused) refused_.push_back(*refused);
  return refused.has_value();
}

Live::Clock::time_point RefusalWatch::until() const {
  const auto time = std::max(refusals_.listen_until(), base::Time{});  // of min() the clock's would overflow
  return Live::Clock::time_point{time.time_since_epoch()};
}

void RefusalWatch::listen(transport::Bus& bus, const std::function<void(const can::Received&)>& beside) {
  if (until() <= Live::Clock::now() || (commanded_ == 1 && !refused_.empty())) return;
  const Over over = Live{bus}.receive(until(), [&](const can::Received& received) {
    if (beside) beside(received);
    return !take(received) || commanded_ != 1;
  });
  // A bus that goes now has carried what was sent; that nothing more is heard of it is no failure of that.
  if (over == Over::signal) throw Exit{exit_code_after_interrupt(exit_failure)};
}

void RefusalWatch::forgive_unserved() {
  std::erase_if(refused_, [](const client::Refused& refused) {
    return refused.reason == "not_served" && refused.topic->role != protocol::Role::drive;
  });
}

bool RefusalWatch::tell() {
  for (const auto& refused : std::exchange(refused_, {})) {
    complain(
        {fmt::format("{}: {} refuses {}: {}", verb_, refused.board, refused.topic->name, describe(refused)),
         offer_.empty() ? remedy(refused) : offer_});
    told_ = true;
  }
  return told_;
}

void RefusalWatch::leave_if_refused() {
  if (tell()) throw Exit{exit_failure};
}

}  // namespace ocm::cli
