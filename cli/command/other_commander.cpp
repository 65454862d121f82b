#include "cli/command/other_commander.hpp"

#include <fmt/format.h>

#include "ocm/can/text.hpp"
#include "ocm/client/command.hpp"

#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {

void OtherCommander::take(const can::Received& received, bool holding) {
  if (const auto active = behaviour_.active_in(index_, received.frame)) active_ = active;
  const protocol::Topic* const motors = commanded_motors(index_, received.frame);
  if (motors == nullptr) return;
  const auto now = Clock::now();
  motors_ = motors;
  last_ = received.frame;
  recent_.push_back(now);
  while (now - recent_.front() > client::listen_before_hold) recent_.pop_front();
  if (!holding) return;
  stopped_ = stopped_ || is_rest(last_);
  begun_too_ = begun_too_ || (!stopped_ && hold_began_ && now - *hold_began_ < client::listen_before_hold);
  if (meanwhile_++ == 0 && !stopped_ && !begun_too_)
    remark(fmt::format(
        "{}: another program commands {}, too: {}; the robot follows the set point that came last", verb_,
        motors->name, can::to_text(last_).view()));
}

bool OtherCommander::is_heard() {
  const auto now = Clock::now();
  while (!recent_.empty() && now - recent_.front() > client::listen_before_hold) recent_.pop_front();
  return !recent_.empty() || is_a_board_active();
}

void OtherCommander::refuse_if_heard() {
  if (!is_heard()) return;
  if (recent_.empty())
    fail({fmt::format("{}: {} drives the wheels by itself, as another program has asked it to: {}", verb_,
                      catalogue_->board_name(behaviour_.topic()), *active_),
          "wait for its end, or `amiroctl behave none`; --force begins all the same, and ends it"});
  fail({fmt::format("{}: another program commands {}: {}, {} within {}", verb_, motors_->name,
                    can::to_text(last_).view(), counted(recent_.size(), "set point"),
                    words::to_text(client::listen_before_hold)),
        "end that program first; --force drives all the same, and the robot follows the set point that came "
        "last"});
}

void OtherCommander::tell_unanswered() const {
  if (unheard_sensor() == nullptr) return;
  remark(
      fmt::format("{}: {} has not answered, so it may be off; `amiroctl doctor` says which boards are there",
                  verb_, catalogue_->board_name(behaviour_.topic())));
}

void OtherCommander::sum_up() const {
  if (meanwhile_ != 0)
    remark(fmt::format("{}: {} of another program came meanwhile", verb_, counted(meanwhile_, "set point")));
}

}  // namespace ocm::cli
