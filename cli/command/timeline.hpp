/// Doing things at their times while the bus stays awake: waits until an absolute time, takes what comes from
/// the bus meanwhile, and repeats a held set point every 100 ms. Shared by drive and run.
///
/// The robot only does what is commanded now. No set point is given to a queue while the one before it has
/// not left; when none has left for as long as the motors' watchdog waits, or when this program did not run
/// for so long, the hold ends, and the set point of rest is the next that can leave. No hold begins while
/// another program commands the motors, unless that is allowed; of two that begin at once both end.
///
/// Frames that are sent again and again go at times that do not drift. A turn that comes too late, because
/// this program did not run or the bus did not take what came before, is left out and counted.
///
/// A message of J1939 that takes several frames is sent beside all that, one frame after another.
///
/// A board that refuses a set point that is held ends the command; what else a board refuses is said, and the
/// command goes on.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ocm/can/bus.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/command/broadcasts.hpp"
#include "cli/command/guarded.hpp"
#include "cli/command/other_commander.hpp"
#include "cli/command/presence_watch.hpp"
#include "cli/command/refusal_watch.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/words/command.hpp"

namespace ocm::cli {

class Timeline {
 public:
  using Clock = Live::Clock;
  /// Whether a hold begins beside another program's.
  enum class Others : bool { refused, allowed };
  /// `verb` is for messages. `on_receive` gets every frame that comes while waiting; empty: they are
  /// discarded.
  Timeline(transport::Bus& bus, const protocol::Catalogue& catalogue, std::string verb, Others others,
           Confirm confirm, std::function<void(const can::Received&)> on_receive);

  /// Waits as long as it takes to hear another program that commands the motors, where one is refused. False:
  /// a signal came first.
  /// Where the sensor of what the boards do by themselves was not heard meanwhile, it is asked for one sample
  /// before the end. The request has left when this returns, if the bus can tell: no set point waits behind
  /// it. Leaves through cli::fail if it has not left within client::longest_without_set_point.
  [[nodiscard]] bool listen_first(base::Duration duration = client::listen_before_hold);
  /// Asks as listen_first does, and waits for nothing: what is answered in the next waits counts for a hold
  /// that begins in a while.
  void ask();
  /// Whether listen_first or `ask` has had to ask.
  [[nodiscard]] bool has_asked() const { return asked_; }
  /// What this program has commanded goes on without it: that it was stopped for a while makes nothing out of
  /// date.
  void forgive_a_stop() {
    stood_still_ = {};
    awake_ = Clock::now();
  }
  /// A board has refused something, which was said.
  [[nodiscard]] bool has_refused() const { return refused_; }
  /// What is sent next has a board drive by itself, which no watchdog ends.
  void expect_motion() { outgoing_.otherwise_after_the_next(still_travelling); }
  /// The caller says itself that the board is silent: finish() does not.
  void leave_silence_to_caller() {
    answer_is_due_ = false;
    presence_.waive();
  }
  /// Leaves if another program that commands the motors was heard, where one is refused. Before a hold that
  /// may begin later; `carry_out` looks, too.
  void expect_no_other();
  /// An end that nothing foresaw, such as an output that cannot be written: the motors rest all the same.
  ~Timeline();
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  /// Sends a command's frames, again and again if it says so, and takes over, or ends, its hold. A broadcast
  /// begins, and is whole when wait_for_end has returned true. Leaves if
  /// another program commands the motors that it would hold, and was heard.
  void carry_out(const client::Command& command);
  /// The same without a hold: the board's watchdog ends it.
  void carry_out_once(const client::Command& command);
  /// Waits until `until`, repeating and receiving. False: a signal came first.
  [[nodiscard]] bool wait(Clock::time_point until);
  /// The same until a step is due; leaves if this program did not run meanwhile: the command is then
  /// out of date. A bus that is slow to take the steps before makes a step late, and no more.
  [[nodiscard]] bool wait_for_step(Clock::time_point due);
  /// Until the hold, broadcasts, and all that is sent again and again, are over (--for) or a signal comes.
  /// False: a signal.
  [[nodiscard]] bool wait_for_end();
  /// Ends a hold: sends the set point of rest. Nothing without a hold.
  void rest();
  /// rest(), and what was sent has left; leaves through cli::fail, loudly, if not. Then, unless a signal
  /// came, listens for the refusal of what was sent last, and asks the boards that got set points and have
  /// sent nothing. False, which was said: a board has refused something or does not answer, or another node
  /// has broadcast beside a message of several frames.
  [[nodiscard]] bool finish();

 private:
  struct Held {
    client::Hold hold;
    Clock::time_point next;
    Clock::time_point end;
    Clock::time_point left;  ///< when a set point was last sent, with none before it under way
  };
  struct Repeated {
    can::AnyFrame frame;
    base::Duration period;
    Clock::time_point next;
    Clock::time_point end;
    Clock::time_point left;  ///< when one was last sent, and little was under way
  };
  /// Until the request for the sensor of behaviours has left and can have been answered, at least until
  /// `end`. False: a signal came first.
  [[nodiscard]] bool wait_for_answer(Clock::time_point end);
  /// A frame from the bus. false: it ends the command, at once and not when the next step is due.
  [[nodiscard]] bool take(const can::Received& received);
  /// What has come and was not looked at.
  void take_what_waits();
  /// `held`: it is the set point of a hold.
  void send(const can::Frame& frame, bool held = false);
  /// What is no set point: a robot has no CAN FD.
  void send_fd(const can::AnyFrame& frame);
  /// To the bus, and counts the time that this took.
  void hand_over(const can::AnyFrame& frame);
  /// Says what a board refused; leaves if the motors are held and their board refuses that.
  void tell_refusals();
  /// Says which frames were not sent, and why; once, also where the command ends with an error.
  void tell_unsent();
  /// Leaves, with the motors at rest, if this program did not run for as long as a watchdog waits.
  void expect_awake();
  /// The time; notes for how long this program did not look where it should have.
  Clock::time_point look_at_clock();
  /// As long as it was to be held: rests, unless this program did not run up to then.
  void end_of_hold(Clock::time_point now);
  /// Sends the held set point again, if the last one has left.
  void repeat(Clock::time_point now);
  /// Sends what is sent again and again and is due; removes what is over.
  void repeat_due(Clock::time_point now);
  void send_again(Repeated& repeated, Clock::time_point now);
  /// Whether the bus took it; leaves if it is gone.
  [[nodiscard]] bool try_to_send(const can::AnyFrame& frame);
  /// Sends what is due of broadcasts; leaves if the bus has taken none for too long.
  void broadcast_due(Clock::time_point now);
  /// Says, once, that another node broadcasts from the source of a message under way.
  void meet(const can::Frame& frame);
  /// Leaves because the bus has taken nothing for so long.
  [[noreturn]] void give_up(Clock::duration lasting);
  /// Sends the set point of rest behind whatever waits; whether it has left.
  [[nodiscard]] bool rest_after_all();
  /// Ends the hold because of something that is wrong.
  [[noreturn]] void abandon(std::string what, std::string remedy);
  /// Ends the hold because this program did not run for so long.
  [[noreturn]] void end_for_a_stop(Clock::duration lasting);
  /// Ends the command, a hold or not, where another program has stopped the robot that it has set in motion,
  /// or began to hold it in the same moment.
  void heed_another();
  [[noreturn]] void end_for_another();
  /// Whether the set point that came last is of the operator that guards the bus.
  [[nodiscard]] Guarded::Own commanded_by_operator();

  transport::Bus* bus_;
  std::string verb_;
  std::function<void(const can::Received&)> on_receive_;
  Others others_;
  OtherCommander other_;
  std::optional<Held> held_;
  std::vector<Repeated> repeated_;  ///< one an identifier
  Broadcasts broadcasts_;
  Clock::time_point awake_ = Clock::now();  ///< when this program looks at the clock next, at the latest
  Clock::duration stood_still_{};           ///< the longest time that it was later
  bool asked_ = false;                      ///< for the sensor of behaviours
  bool answer_is_due_ = false;              ///< the request has left, and so long ago
  bool moving_ = false;                     ///< a set point of motors was sent, and none of rest after it
  Live live_;
  Outgoing outgoing_;
  RefusalWatch refusals_;
  PresenceWatch presence_;
  bool refused_ = false;
  /// Frames that were sent since the last set point of motors or of what is held: a queue keeps the order, so
  /// that it has left once no more than they wait.
  std::uint64_t behind_ = 0;
  std::uint64_t withheld_ = 0;   ///< set points that were due while none could leave
  std::uint64_t left_out_ = 0;   ///< turns of what is repeated: this program was late,
  std::uint64_t not_taken_ = 0;  ///< or the bus did not take what came before
  Broadcasts::Counts told_;      ///< of broadcasts
  bool cut_ = false;             ///< what was cut off, or waited, is said
};

}  // namespace ocm::cli
