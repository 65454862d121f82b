#include "cli/command/presence_watch.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "ocm/protocol/request.hpp"

#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"

namespace ocm::cli {
namespace {

constexpr base::Duration patience = std::chrono::seconds{2};

}  // namespace

void PresenceWatch::sent(const client::Command& command) {
  for (const can::Frame& frame : command.frames)
    if (!command.ends_hold || commanded_motors(index_, frame) != nullptr) presence_.sent(frame);
}

std::vector<const protocol::Topic*> PresenceWatch::questions() const {
  if (waived_) return {};
  return presence_.unheard();
}

bool PresenceWatch::take(const can::Received& received) {
  presence_.take(received.frame);
  const auto subject = index_.subject(received.frame.id, received.frame.format);
  return subject.frame && std::find(asked_.begin(), asked_.end(), subject.topic) != asked_.end();
}

void PresenceWatch::ask(const transport::Bus& bus, Outgoing& outgoing) {
  bus_ = &bus;
  for (const auto* const status : questions()) {
    const auto request = protocol::once(status->id, status->priority);
    if (!outgoing.is_taken(request, std::chrono::seconds{1})) return;
    asked_.push_back(status);
  }
}

Over PresenceWatch::listen(Live& live, const std::function<void(const can::Received&)>& take) {
  if (!is_due()) return Over::enough;
  const Over over = live.receive(Live::Clock::now() + patience, [&](const can::Received& received) {
    take(received);
    return is_due();
  });
  // With a simulated bus its robot has gone.
  if (over == Over::signal || (over == Over::gone && bus_->is_simulated())) waived_ = true;
  return over;
}

bool PresenceWatch::tell(std::string_view otherwise) {
  if (waived_ || !is_due()) return false;
  std::vector<std::string_view> names;
  for (const auto* const status : presence_.unheard()) names.push_back(catalogue_->board_name(*status));
  const bool one = names.size() == 1;
  complain({fmt::format("{}: {} {} not answer, so nothing shows that {} done it{}{}", verb_,
                        fmt::join(names, " and "), one ? "does" : "do", one ? "it has" : "they have",
                        otherwise.empty() ? "" : "; ", otherwise),
            fmt::format("{} powered and on {}? `amiroctl doctor` says which boards are there; "
                        "--no-confirm does not ask",
                        one ? "is it" : "are they", bus_->name())});
  return true;
}

}  // namespace ocm::cli
