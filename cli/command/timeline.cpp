#include "cli/command/timeline.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/text.hpp"

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/unhurried_messages.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

/// In which a board answers a request: a sample is sent some milliseconds after it.
constexpr base::Duration time_to_answer = std::chrono::milliseconds{40};
/// Not longer where there is always a frame.
constexpr base::Duration longest_look = std::chrono::milliseconds{10};
/// Nothing tells when a frame has left.
constexpr base::Duration look_again = std::chrono::milliseconds{1};

constexpr const char* ask_why = "`amiroctl operator why` says why it is there, and what leads from there";

}  // namespace

Timeline::Timeline(transport::Bus& bus, const protocol::Catalogue& catalogue, std::string verb, Others others,
                   Confirm confirm, std::function<void(const can::Received&)> on_receive)
    : bus_(&bus),
      verb_(std::move(verb)),
      on_receive_(std::move(on_receive)),
      others_(others),
      other_(catalogue, verb_),
      live_(bus),
      outgoing_(bus, verb_),
      refusals_(catalogue, verb_, confirm),
      presence_(catalogue, verb_, confirm) {}

Timeline::~Timeline() {
  if (held_ && !rest_after_all() && outgoing_.matters() && !outgoing_.robot_is_gone())
    remark(fmt::format("{}: {}", verb_, still_moving));
}

bool Timeline::listen_first(base::Duration duration) {
  if (others_ == Others::allowed) return true;
  const auto end = Clock::now() + duration;
  if (!wait(std::max(Clock::now(), end - time_to_answer))) return false;
  if (duration < time_to_answer) return wait(end);
  ask();
  if (!answer_is_due_) return wait(end);
  return answer_is_due_ = wait_for_answer(end);
}

void Timeline::ask() {
  const auto* const sensor = others_ == Others::allowed ? nullptr : other_.unheard_sensor();
  if (sensor == nullptr) return;
  // Of a bus that takes nothing the command itself will say so.
  const auto taken = bus_->send(sensor->request());
  asked_ = true;
  answer_is_due_ = taken && *taken;
}

bool Timeline::wait_for_answer(Clock::time_point end) {
  const auto late = Clock::now() + client::longest_without_set_point;
  for (;;) {
    const auto now = look_at_clock();
    const auto delivery = bus_->delivery();
    if (!delivery.known) return wait(end);
    // A request that was held up is answered later.
    if (delivery.pending == 0) return wait(std::max(end, now + time_to_answer));
    if (now >= late) outgoing_.expect_all_left({});
    if (!wait(now + look_again)) return false;
  }
}

bool Timeline::take(const can::Received& received) {
  other_.take(received, moving_);
  meet(received.frame);
  presence_.take(received);
  const bool refused = refusals_.take(received);
  if (on_receive_) on_receive_(received);
  return !refused && !other_.has_stopped() && !other_.has_begun_too();
}

void Timeline::take_what_waits() {
  const auto late = Clock::now() + longest_look;
  while (Clock::now() < late) {
    const auto received = bus_->receive({});
    if (!received) break;
    static_cast<void>(take(*received));
  }
  tell_refusals();
}

void Timeline::expect_no_other() {
  if (others_ == Others::allowed) return;
  take_what_waits();  // this program may not have run while it should have listened
  if (!other_.is_heard()) return;
  if (const auto own = commanded_by_operator(); own.again_and_again)
    fail({fmt::format("{}: {} is in {}, where it commands {} itself", verb_, own.who, own.configuration,
                      other_.motors()),
          ask_why});
  other_.refuse_if_heard();
}

Guarded::Own Timeline::commanded_by_operator() {
  auto* const guarded = dynamic_cast<Guarded*>(bus_);
  return guarded == nullptr ? Guarded::Own{} : guarded->commands_itself(other_.last());
}

void Timeline::send(const can::Frame& frame, bool held) {
  const bool set_point = other_.is_set_point(frame);
  other_.send(frame);
  if (set_point) outgoing_.otherwise_after_the_next(still_moving);
  if (other_.is_behaviour(frame)) outgoing_.otherwise_after_the_next(still_travelling);
  hand_over(frame);
  behind_ = set_point || held ? 0 : behind_ + 1;
  refusals_.sent(frame, set_point && moving_);
  if (set_point) moving_ = !is_rest(frame);
}

void Timeline::send_fd(const can::AnyFrame& frame) {
  hand_over(frame);
  ++behind_;
}

void Timeline::hand_over(const can::AnyFrame& frame) {
  outgoing_.looks_from(awake_);
  outgoing_.send(frame);
  // A slow bus is waited for; a stop of this program meanwhile is none.
  awake_ = outgoing_.looked();
  stood_still_ = std::max(stood_still_, outgoing_.stood_still());
}

void Timeline::carry_out_once(const client::Command& command) {
  expect_awake();
  if (command.hold && !held_) expect_no_other();
  if (command.hold) outgoing_.otherwise_after_the_next(still_moving);  // a behaviour, too
  if (command.ends_hold) outgoing_.otherwise(still_moving);
  presence_.sent(command);
  for (const auto& frame : command.frames) send(frame, command.hold && frame == command.hold->frame);
  for (const auto& frame : command.fd_frames) send_fd(frame);
}

void Timeline::carry_out(const client::Command& command) {
  if (command.broadcast) {
    expect_awake();
    const auto now = look_at_clock();
    broadcasts_.begin(*command.broadcast, command.repeat, now);
    broadcast_due(now);
    return;
  }
  command.each_frame([this](const can::AnyFrame& frame) {
    repeated_.erase(std::remove_if(repeated_.begin(), repeated_.end(),
                                   [&](const Repeated& each) {
                                     return each.frame.id == frame.id && each.frame.format == frame.format;
                                   }),
                    repeated_.end());
  });
  const auto begin = Clock::now();
  const bool begins = command.hold && !held_ && others_ == Others::refused;
  carry_out_once(command);
  if (begins) other_.hold_begins(awake_);  // when the bus had it, however late this program looks next
  if (command.ends_hold) held_.reset();
  if (command.repeat) {
    const auto [period, lasting] = *command.repeat;
    const auto end = lasting.count() > 0 ? time_after(begin, lasting) : Clock::time_point::max();
    command.each_frame([&, each = period](const can::AnyFrame& frame) {
      repeated_.push_back({frame, each, begin + each, end, begin});
    });
  }
  if (!command.hold) return;
  const auto now = look_at_clock();
  const auto& hold = *command.hold;
  const auto end = hold.lasting.count() > 0 ? time_after(now, hold.lasting) : Clock::time_point::max();
  held_ = Held{hold, now + client::hold_period, end, now};
  // Just as its first set point left: no turn has been missed yet.
  if (stood_still_ >= client::longest_without_set_point) end_for_a_stop(stood_still_);
}

void Timeline::rest() {
  if (!held_) return;
  const can::Frame frame = held_->hold.rest;
  held_.reset();  // before sending: a failure must not come back here
  send(frame);
}

bool Timeline::finish() {
  rest();
  outgoing_.expect_all_left();
  if (interrupted() == 0) {
    const auto take = [this](const can::Received& received) {
      const bool own = presence_.take(received);
      refusals_.take(received);
      if (on_receive_ && !own) on_receive_(received);
    };
    static_cast<void>(live_.receive(refusals_.until(), [&](const can::Received& received) {
      take(received);
      return true;
    }));
    if (interrupted() == 0) presence_.ask(*bus_, outgoing_);
    static_cast<void>(presence_.listen(live_, take));
  }
  tell_refusals();
  const bool silent = presence_.tell();
  if (answer_is_due_ && !silent) other_.tell_unanswered();
  other_.sum_up();
  tell_unsent();
  return !refused_ && !silent && broadcasts_.counts().met == 0;
}

void Timeline::tell_unsent() {
  const auto frames = [](std::uint64_t count) {
    return fmt::format("{} {} not sent", counted(count, "frame"), count == 1 ? "was" : "were");
  };
  if (withheld_ != 0)
    remark(fmt::format("{}: {} {} not sent, because the one before had not left", verb_,
                       counted(withheld_, "set point"), withheld_ == 1 ? "was" : "were"));
  if (left_out_ != 0)
    remark(fmt::format("{}: {}, because this program ran too late for {} time", verb_, frames(left_out_),
                       left_out_ == 1 ? "its" : "their"));
  if (not_taken_ != 0)
    remark(fmt::format("{}: {}, because {} had not taken those before", verb_, frames(not_taken_),
                       bus_->name()));
  const auto broadcasts = broadcasts_.counts();
  const auto messages = [](std::uint64_t count) { return counted(count, "broadcast"); };
  if (const auto late = broadcasts.late - told_.late; late != 0)
    remark(fmt::format("{}: {} left out or begun again, because this program or {} was too late", verb_,
                       messages(late), bus_->name()));
  if (const auto waited = broadcasts.waited - told_.waited; waited != 0)
    remark(fmt::format("{}: {} left out, because a source sends one at a time", verb_, messages(waited)));
  if (const auto met = broadcasts.met - told_.met; met > 1)  // the first was said as it came
    remark(fmt::format("{}: {} met others of the same source", verb_, messages(met)));
  if (!cut_) {
    if (const auto* const part = broadcasts_.unfinished(); part != nullptr)
      cut_ = true, remark(fmt::format("{}: {} was not sent to its end", verb_, part->message->name));
    for (const auto* const waiting : broadcasts_.waiting())
      cut_ = true, remark(fmt::format("{}: {} was not sent", verb_, waiting->message->name));
  }
  withheld_ = left_out_ = not_taken_ = 0;  // said
  told_ = broadcasts;
}

void Timeline::tell_refusals() {
  const auto& refused = refusals_.refused();
  const bool held = held_ && std::any_of(refused.begin(), refused.end(), [this](const client::Refused& each) {
                      return each.topic->role == protocol::Role::drive ||
                             each.topic->id == protocol::Identifier::decode(held_->hold.frame.id).topic;
                    });
  refused_ = refusals_.tell() || refused_;
  if (held) throw Exit{exit_failure};
}

bool Timeline::rest_after_all() {
  const can::Frame frame = held_->hold.rest;
  held_.reset();
  // One set point may still wait somewhere; nothing but rest comes behind it. Where that is an adapter that
  // has not answered, the bus gives it up about now, and has room only then.
  return outgoing_.is_taken(frame, client::hold_period) && outgoing_.all_left(std::chrono::seconds{1});
}

void Timeline::abandon(std::string what, std::string remedy) {
  const char* const done =
      other_.is_set_point(held_->hold.frame) ? "the motors were set to zero" : "it was set to zero";
  const bool rests = rest_after_all();
  other_.sum_up();
  tell_unsent();
  const char* const now = rests                 ? done
                          : outgoing_.matters() ? still_moving
                                                : "no set point has reached the robot";
  fail({fmt::format("{}: {}; {}", verb_, what, now), std::move(remedy)});
}

void Timeline::heed_another() {
  if (others_ == Others::refused && (other_.has_stopped() || (held_ && other_.has_begun_too())))
    end_for_another();
}

void Timeline::end_for_another() {
  if (!other_.has_stopped())
    abandon(fmt::format("another program began to command {} in the same moment: {}", other_.motors(),
                        can::to_text(other_.last()).view()),
            "end one of them, and give the command again; --force drives all the same");
  if (held_) static_cast<void>(rest_after_all());
  other_.sum_up();
  if (const auto own = commanded_by_operator(); !own.who.empty())
    fail({fmt::format("{}: {} is in {} and has set the motors to zero, which ends this {}", verb_, own.who,
                      own.configuration, verb_),
          ask_why});
  fail({fmt::format("{}: another program has set the motors to zero, which ends this {}", verb_, verb_),
        "--force goes on all the same"});
}

void Timeline::end_for_a_stop(Clock::duration lasting) {
  abandon(fmt::format("this program did not run for {}, so the {} has ended",
                      words::to_text(std::chrono::duration_cast<std::chrono::milliseconds>(lasting)),
                      other_.is_set_point(held_->hold.frame) ? "drive" : "behaviour"),
          "was it stopped, or did the machine sleep? Give the command again");
}

void Timeline::end_of_hold(Clock::time_point now) {
  const auto last_turn = held_->next - client::hold_period;
  if (now - last_turn >= client::longest_without_set_point) end_for_a_stop(now - last_turn);
  rest();
}

void Timeline::repeat(Clock::time_point now) {
  constexpr auto longest = client::longest_without_set_point;
  const auto in_words = [now](Clock::time_point since) {
    return words::to_text(std::chrono::duration_cast<std::chrono::milliseconds>(now - since));
  };
  const auto last_turn = held_->next - client::hold_period;
  if (now - last_turn >= longest) end_for_a_stop(now - last_turn);
  // Late set points are dropped: each holds only at its own time.
  held_->next += client::hold_period;  // absolute: no drift
  if (held_->next <= now) held_->next = now + client::hold_period;
  const auto delivery = bus_->delivery();
  const auto& obstruction = delivery.obstruction;
  if (!obstruction.what.empty() || (delivery.known && delivery.pending > behind_)) {
    ++withheld_;
    if (now - held_->left < longest) return;  // an interface may come back
    const std::string what =
        fmt::format("no set point has left {} for {}", bus_->name(), in_words(held_->left));
    if (!obstruction.what.empty()) abandon(fmt::format("{}: {}", what, obstruction.what), obstruction.remedy);
    abandon(what, why_none_leaves(*bus_));
  }
  const auto taken = bus_->send(held_->hold.frame);
  if (taken.error == base::Error::closed) {
    held_.reset();
    tell_unsent();
    outgoing_.leave_gone();
  }
  if (taken && *taken) {
    held_->left = now;
    behind_ = 0;
    refusals_.sent(held_->hold.frame, true);
  } else if (++withheld_; now - held_->left >= longest) {
    abandon(fmt::format("the transmit queue of {} has been full for {}", bus_->name(), in_words(held_->left)),
            why_none_leaves(*bus_));
  }
}

void Timeline::repeat_due(Clock::time_point now) {
  for (std::size_t i = 0; i < repeated_.size();) {
    if (now >= repeated_[i].next && repeated_[i].next < repeated_[i].end) send_again(repeated_[i], now);
    if (repeated_[i].next >= repeated_[i].end && now >= repeated_[i].end)
      repeated_.erase(repeated_.begin() + static_cast<std::ptrdiff_t>(i));
    else
      ++i;
  }
}

void Timeline::send_again(Repeated& repeated, Clock::time_point now) {
  // Of the turns that are over, the last is taken now, unless its time has ended meanwhile.
  const auto over = (now - repeated.next) / repeated.period;
  const auto planned = (repeated.end - repeated.next - Clock::duration{1}) / repeated.period + 1;
  left_out_ += static_cast<std::uint64_t>(std::min(over, planned));
  repeated.next += (over + 1) * repeated.period;  // absolute: no drift
  if (over >= planned) return;
  if (try_to_send(repeated.frame)) {
    repeated.left = now;
    return;
  }
  ++not_taken_;
  if (now - repeated.left < std::max<Clock::duration>(client::longest_without_set_point, 2 * repeated.period))
    return;  // an interface may come back
  give_up(now - repeated.left);
}

bool Timeline::try_to_send(const can::AnyFrame& frame) {
  const auto delivery = bus_->delivery();
  // One of each may be under way: they may all be due at once.
  if (!delivery.obstruction.what.empty() ||
      (delivery.known && delivery.pending > repeated_.size() + broadcasts_.size()))
    return false;
  const auto sent = bus_->send_any(frame);
  if (sent.error == base::Error::closed) {
    tell_unsent();
    outgoing_.leave_gone();
  }
  if (!sent || !*sent) return false;
  ++behind_;
  if (const auto classic = frame.classic()) refusals_.sent(*classic);
  return true;
}

void Timeline::give_up(Clock::duration lasting) {
  tell_unsent();
  const auto obstruction = bus_->delivery().obstruction;
  const std::string what =
      fmt::format("{}: {} has taken no frame for {}", verb_, bus_->name(),
                  words::to_text(std::chrono::duration_cast<std::chrono::milliseconds>(lasting)));
  if (!obstruction.what.empty()) fail({fmt::format("{}: {}", what, obstruction.what), obstruction.remedy});
  fail({what, why_none_leaves(*bus_)});
}

void Timeline::broadcast_due(Clock::time_point now) {
  broadcasts_.advance(now, [this](const can::AnyFrame& frame) {
    return try_to_send(frame) ? std::optional{Clock::now()} : std::nullopt;
  });
  const auto since = broadcasts_.held_up_since();
  if (since && now - *since >= client::longest_without_set_point) give_up(now - *since);
}

void Timeline::meet(const can::Frame& frame) {
  const auto* const broadcast = broadcasts_.meet(frame);
  if (broadcast == nullptr || broadcasts_.counts().met != 1) return;
  remark(fmt::format("{}: another node broadcasts from source {:02X} during {}, so listeners may drop both",
                     verb_, frame.id & 0xFF, broadcast->message->name));
}

bool Timeline::wait(Clock::time_point until) {
  for (;;) {
    if (interrupted() != 0) return false;
    UnhurriedMessages::write();
    const auto now = look_at_clock();
    if (held_ && now >= held_->end) end_of_hold(now);
    if (held_ && now >= held_->next) {
      take_what_waits();  // a stop among it came before this set point
      heed_another();
      repeat(look_at_clock());
    }
    repeat_due(now);
    broadcast_due(now);
    if (now >= until) return true;
    // One that waited for its source may have been due before: that is no stop of this program.
    auto wake = std::min(until, std::max(now, broadcasts_.next_event()));
    if (held_) wake = std::min({wake, held_->next, held_->end});
    for (const Repeated& each : repeated_) wake = std::min(wake, std::min(each.next, each.end));
    awake_ = wake;
    const Over over = live_.receive(wake, [this](const can::Received& received) { return take(received); });
    tell_refusals();
    if (over == Over::gone) {
      held_.reset();
      tell_unsent();
      outgoing_.leave_gone();
    }
    heed_another();
  }
}

bool Timeline::wait_for_step(Clock::time_point due) {
  if (!wait(due)) return false;
  expect_awake();
  return true;
}

void Timeline::expect_awake() {
  look_at_clock();
  if (stood_still_ < client::longest_without_set_point) return;
  presence_.waive();  // an error, with or without an answer
  static_cast<void>(finish());
  fail({fmt::format("{}: this program did not run for {}, so no further command is sent", verb_,
                    words::to_text(std::chrono::duration_cast<std::chrono::milliseconds>(stood_still_))),
        "was it stopped, or did the machine sleep? Give the command again"});
}

Timeline::Clock::time_point Timeline::look_at_clock() {
  const auto now = Clock::now();
  stood_still_ = std::max(stood_still_, now - awake_);
  awake_ = now;
  return now;
}

bool Timeline::wait_for_end() {
  while (held_ || !repeated_.empty() || !broadcasts_.empty()) {
    auto until = std::min(Clock::now() + std::chrono::hours{1}, broadcasts_.next_event());
    if (held_) until = std::min(until, held_->end);
    for (const Repeated& each : repeated_) until = std::min(until, each.end);
    if (!wait(until)) return false;
  }
  return true;
}

}  // namespace ocm::cli
