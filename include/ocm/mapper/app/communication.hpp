/// The mapper's communication task: hears what the operator says, answers, looks after link, lights and the
/// way home, and says what other tasks want to be said. [T2 chapters 4, 6]
///
/// A sentence is obeyed in the state in which it is heard. What is said is meant for the link that the job
/// began with, and for no later one. No heap; O(bytes heard) a job.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/app/measuring.hpp"
#include "ocm/mapper/app/output.hpp"
#include "ocm/mapper/app/shared.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"

namespace ocm::mapper::app {

template <RobotParts Parts, scheduling::Port Port, scheduling::Lockable Mutex>
class Communication {
 public:
  using Shared = app::Shared<Parts, Port, Mutex>;
  using Output = app::Output<Parts, Port, Mutex>;

  /// Both must outlive it.
  Communication(Shared& shared, Output& output) noexcept : shared_(shared), output_(output) {}

  /// A job.
  void run() noexcept {
    const base::Time now = shared_.port->now();
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      shared_.last_communication = now;
      shared_.line_waits = false;
    }
    hear_all();
    if (shared_.take(shared_.compass_wanted)) end_calibration();
    if (shared_.take(shared_.idle_wanted)) say_idle(shared_.moment());
    if (now >= shared_.supervision_due) supervise(now);
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      shared_.counters.heard = reader_.heard();
      shared_.counters.damaged = reader_.faults();
      shared_.counters.stray_bytes = reader_.stray();
    }
    shared_.attend_communication();
  }
  /// The lights.
  void show() noexcept {
    Lights wanted;
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      wanted = lights(shared_.state,
                      {shared_.port->now() - shared_.entered, handshaken_, shared_.compass_at_rest});
    }
    shared_.parts->show(wanted);
  }

 private:
  void hear_all() noexcept {
    for (std::size_t i = 0; i < Shared::input_bytes; ++i) {  // what comes meanwhile has its own release
      base::Result<std::uint8_t> byte;
      std::uint32_t links = 0;
      {
        [[maybe_unused]] const auto guard = shared_.lock();
        byte = shared_.input.pop();
        links = shared_.links;
      }
      if (links != heard_links_) {
        reader_.restart();
        output_.restart();
        heard_links_ = links;
      }
      if (!byte) return;
      hear(reader_.feed(static_cast<char>(*byte)));
    }
  }
  void hear(link::Kind kind) noexcept {
    switch (kind) {
      case link::Kind::confirm:
        return hear_confirm();
      case link::Kind::set_point:
        return hear_set_point();
      case link::Kind::pause:
        if (shared_.apply(Event::pause).idle) say_idle(shared_.moment());
        return;
      case link::Kind::unpause:
        (void)shared_.apply(Event::unpause);
        return;
      case link::Kind::packed:
      case link::Kind::text:
        if (!shared_.apply(Event::format).refused) output_.hear(kind);
        return;
      case link::Kind::calibrate:
        return hear_calibrate();
      case link::Kind::ping:
        if (shared_.apply(Event::ping).answer)
          say(link::Kind::pong, shared_.moment(), shared_.counters.pongs);
        return;
      case link::Kind::who:
        if (shared_.apply(Event::who).answer) say_handshake(shared_.moment());
        return;
      default:
        return;
    }
  }
  void hear_confirm() noexcept {
    // Held from before the reset on: who sees that there was one waits here for the pose, which is at zero.
    [[maybe_unused]] const auto claim = shared_.located.claim();
    if (!shared_.apply(Event::confirm).reset) return;  // refused, or the link has died: the way home is kept
    if (!shared_.locator.calibrated()) use_stored();
    shared_.locator.begin_at_zero();
    last_idle_ = shared_.port->now();
  }
  /// The calibration of before it was switched off.
  void use_stored() noexcept {
    const auto kept = shared_.parts->stored();
    if (!kept) return;
    shared_.locator.use(kept->offset);
    shared_.compass = {.verdict = judge(*kept, shared_.model->compass), .fit = *kept};
  }
  /// A number that is new begins; that of the last one only asks, so a copy of a word changes nothing.
  void hear_calibrate() noexcept {
    const std::int16_t number = reader_.sentence().as<link::Calibrate>()->number;
    const bool asks = number == 0 || number == calibration_;
    if (!shared_.apply(asks ? Event::compass : Event::calibrate).answer) return;
    if (!asks) {
      calibration_ = number;
      shared_.count(shared_.counters.calibrations);
      [[maybe_unused]] const auto claim = shared_.located.claim();
      shared_.compass = {.verdict = link::Calibration::stopped};  // unless it comes to an end
    }
    say_compass(shared_.moment());
  }
  void hear_set_point() noexcept {
    const auto wanted = reader_.sentence().as<link::SetPoint>();
    const bool stop = wanted->angle == 0 && wanted->distance == 0;
    const motion::SetPoint set_point = motion::set_point(wanted->angle, wanted->distance);
    [[maybe_unused]] const auto guard = shared_.lock();
    const Step step = shared_.apply_locked(stop ? Event::stop : Event::set_point);
    if (step.refused) return;
    shared_.idle_wanted = step.idle;
    if (!step.drive) return;
    shared_.orders.put_locked({.halt = false, .set_point = set_point});
    shared_.motion.busy = true;  // from now on no task says idle until this one has ended
  }

  void supervise(base::Time now) noexcept {
    {
      [[maybe_unused]] const auto guard = shared_.lock();
      do shared_.supervision_due += shared_.model->periods.supervision;
      while (shared_.supervision_due <= now);
    }
    shared_.look_at_link();
    const Moment at = shared_.moment();
    handshaken_ = false;
    if (at.state == State::connected) say_who(at, now);
    if (at.state == State::advertising) come_home(now);
    if (at.state == State::calibrating && now - last_compass_ >= shared_.model->times.idle) say_compass(at);
    if (obeys(at.state) && !at.motion.busy && now - last_idle_ >= shared_.model->times.idle) say_idle(at);
    show();
  }
  void say_who(const Moment& at, base::Time now) noexcept {
    if (shaken_links_ == at.links + 1 && now - last_handshake_ < shared_.model->times.handshake) return;
    shaken_links_ = at.links + 1;
    last_handshake_ = now;
    handshaken_ = true;
    say_handshake(at);
  }
  void say_handshake(const Moment& at) noexcept {
    if (output_.say(shared_.model->handshake, shared_.alive(at))) shared_.count(shared_.counters.handshakes);
  }
  void come_home(base::Time now) noexcept {
    [[maybe_unused]] const auto guard = shared_.lock();
    const base::Duration after = shared_.model->times.return_after;
    if (after == base::Duration::zero() || !shared_.may_return || now - shared_.lost_at < after) return;
    shared_.may_return = false;
    if (shared_.apply_locked(Event::return_due).state == State::returning) ++shared_.counters.returns;
  }
  void say(link::Kind kind, const Moment& at, std::uint32_t& counter) noexcept {
    if (output_.say(kind, shared_.alive(at))) shared_.count(counter);
  }
  void say_idle(const Moment& at) noexcept {
    if (!obeys(at.state)) return;
    last_idle_ = shared_.port->now();
    say(link::Kind::idle, at, shared_.counters.idles);
  }
  void say_compass(const Moment& at) noexcept {
    using Said = link::Calibration;
    last_compass_ = shared_.port->now();
    CompassReport report;
    bool calibrated = false;
    {
      [[maybe_unused]] const auto claim = shared_.located.claim();
      report = shared_.compass;
      calibrated = shared_.locator.calibrated();
    }
    const auto kept = shared_.parts->stored();
    const bool safe = kept && (!report.taken || *kept == report.fit);
    if (at.state == State::calibrating) report = {.verdict = Said::turning};
    const std::int16_t use = !calibrated ? Said::unused : safe ? Said::stored : Said::until_off;
    (void)output_.say(app::calibration(calibration_, report, use), shared_.alive(at));
  }
  /// What the turn found is kept, and said.
  void end_calibration() noexcept {
    const CompassReport report = shared_.compass_now();
    if (report.taken) shared_.parts->store(report.fit);
    const Moment at = shared_.moment();
    if (obeys(at.state)) say_compass(at);
  }

  Shared& shared_;
  Output& output_;
  link::Reader reader_{link::Direction::to_robot};
  std::uint32_t heard_links_ = 0;
  std::uint32_t shaken_links_ = 0;  ///< one more than the link that heard the last handshake
  base::Time last_handshake_{};
  base::Time last_idle_{};
  base::Time last_compass_{};
  std::int16_t calibration_ = 0;  ///< number of the last one
  bool handshaken_ = false;
};

}  // namespace ocm::mapper::app
