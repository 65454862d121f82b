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

std::vector<const protocol::Topic*> PresenceWatch::signs() const {
  if (waived_) return {};
  return presence_.signs();
}

std::vector<const protocol::Topic*> PresenceWatch::questions() const {
  if (waived_) return {};
  return presence_.unheard();
}

std::vector<const protocol::Topic*> PresenceWatch::silent() const {
  auto all = questions();
  std::erase_if(all, [this](const protocol::Topic* status) {
    return std::find(asked_.begin(), asked_.end(), status) == asked_.end();
  });
  return all;
}

bool PresenceWatch::take(const can::Received& received) {
  presence_.take(received.frame);
  const auto subject = index_.subject(received.frame.id, received.frame.format);
  return subject.frame && std::find(asked_.begin(), asked_.end(), subject.topic) != asked_.end();
}

void PresenceWatch::ask(const transport::Bus& bus, Outgoing& outgoing) {
  bus_ = &bus;
  for (const auto* const status : questions()) {
    asked_.push_back(status);
    const auto request = protocol::once(status->id, status->priority);
    takes_ = takes_ && outgoing.is_taken(request, std::chrono::seconds{1});
  }
}

Over PresenceWatch::listen(Live& live, const std::function<void(const can::Received&)>& take) {
  if (!takes_ || silent().empty()) return Over::enough;
  const Over over = live.receive(Live::Clock::now() + patience, [&](const can::Received& received) {
    take(received);
    return !silent().empty();
  });
  cut_short_ = over == Over::signal;
  return over;
}

bool PresenceWatch::tell(std::string_view otherwise) {
  const auto unanswered = silent();
  if (unanswered.empty()) return false;
  std::vector<std::string_view> names;
  for (const auto* const status : unanswered) names.push_back(catalogue_->board_name(*status));
  const bool one = names.size() == 1;
  const std::string boards = fmt::format("{}", fmt::join(names, " and "));
  const std::string unknown =
      fmt::format("so nothing shows that {} done it{}{}", one ? "it has" : "they have",
                  otherwise.empty() ? "" : "; ", otherwise);
  if (bus_->state() == transport::BusState::closed)
    complain({fmt::format("{}: {} had not answered when the bus went: {}; {}", verb_, boards,
                          bus_->failure().what, unknown),
              bus_->failure().remedy});
  else if (cut_short_)
    complain({fmt::format("{}: interrupted before {} answered, {}", verb_, boards, unknown),
              "--no-confirm does not wait for an answer"});
  else if (!takes_)
    complain({fmt::format("{}: {} could not be asked, {}", verb_, boards, unknown), why_none_leaves(*bus_)});
  else
    complain({fmt::format("{}: {} {} not answer, {}", verb_, boards, one ? "does" : "do", unknown),
              fmt::format("{} powered and on {}? `amiroctl doctor` says which boards are there; "
                          "--no-confirm does not ask",
                          one ? "is it" : "are they", bus_->name())});
  return true;
}

}  // namespace ocm::cli
