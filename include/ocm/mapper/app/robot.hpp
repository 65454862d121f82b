/// The mapper's application, OCM layer 1: says who it is, obeys set points, tells where it is and what it
/// sees, stops in front of things and when its link dies, and finds its way home. [T2 chapters 4, 6 to 9]
///
///     ocm::mapper::app::Robot robot{parts, port, ocm::mapper::app::avr_robot};
///     robot.start();
///     ...
///     robot.receive(byte);     // interrupt of the UART
///     robot.link_changed();    // interrupt of the dongle's pin
///     robot.expire();          // the port's timer
///     robot.run(level);        // the context of a level, after the port was pended for it
///
/// Five tasks on four levels (docs/mapper.md has their response times):
///
/// | level | task | released |
/// |---|---|---|
/// | urgent | estimator | every 30 ms |
/// | high | movement | every 20 ms |
/// | high | communication | by a line, and every 100 ms to look after things |
/// | medium | pose controller | by the estimator, at its end |
/// | low | tower | every 200 ms |
///
/// Between tasks lie one-place queues, which count what was not taken, and two resources under the system's
/// mutex, which should inherit priorities: the pose, and the UART. All times are measured; a late step is a
/// longer step. Each cause of a refusal or a loss has a counter.
///
/// When the link dies the motors are off before `link_changed` returns, whatever any task was about to do,
/// and nothing that was said or ordered over it lives on. Pose and way home do: they start again when the
/// next operator confirms.
///
/// No heap, no exceptions. RAM and flash are in docs/mapper.md. Parts, port and model must outlive it.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/app/compass.hpp"
#include "ocm/mapper/app/counters.hpp"
#include "ocm/mapper/app/input.hpp"
#include "ocm/mapper/app/load.hpp"
#include "ocm/mapper/app/locator.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/app/motors.hpp"
#include "ocm/mapper/app/output.hpp"
#include "ocm/mapper/app/parts.hpp"
#include "ocm/mapper/app/pilot.hpp"
#include "ocm/mapper/app/state.hpp"
#include "ocm/mapper/app/tower.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"
#include "ocm/motion/pose_controller.hpp"
#include "ocm/motion/pose_estimator.hpp"
#include "ocm/scheduling/dispatcher.hpp"
#include "ocm/scheduling/mailbox.hpp"
#include "ocm/scheduling/port.hpp"
#include "ocm/scheduling/resource.hpp"
#include "ocm/sensing/tower.hpp"

namespace ocm::mapper::app {

/// The streams of a Robot, in the order in which those of one level and one moment run.
enum class Task : std::uint8_t { estimator, movement, communication, pose_controller, tower };
inline constexpr std::size_t task_count = 5;

template <RobotParts Parts, scheduling::Port Port, scheduling::Lockable Mutex = scheduling::NoMutex>
class Robot {
 public:
  using Level = scheduling::Level;
  using Release = scheduling::Release;

  static constexpr std::size_t input_bytes = 128;  ///< some seven packets

  Robot(Parts& parts, Port& port, const RobotModel& model) noexcept
      : parts_(&parts),
        port_(&port),
        model_(&model),
        dispatcher_(port),
        orders_(port),
        commands_(port),
        located_(port),
        locator_(model),
        compass_{.verdict = model.compass.calibrated ? link::Calibration::good : link::Calibration::none,
                 .fit = {.offset = model.compass.offset}},
        output_(parts, port, model.can_pack),
        pilot_(model.controller) {}
  Robot(Parts&, Port&, const RobotModel&&) = delete;  // the model must outlive the robot
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// Begins to measure and to advertise. Once, before all others.
  void start() noexcept {
    const base::Time now = port_->now();
    const Periods& periods = model_->periods;
    started_ = entered_ = supervision_due_ = now;
    last_communication_ = now - periods.communication_apart;
    last_estimate_ = last_control_ = now - periods.estimator;  // so that the first step is one
    last_movement_ = now - periods.movement;
    idle_at_start_ = port_idle();
    {
      [[maybe_unused]] const auto guard = port_->lock();
      parts_->drive({});
    }
    parts_->turn_tower(0);
    show();
    dispatcher_.start(stream(Task::estimator), periods.estimator, Level::urgent, now);
    dispatcher_.start(stream(Task::movement), periods.movement, Level::high, now);
    dispatcher_.start(stream(Task::tower), periods.tower, Level::low, now);
    attend_communication();
  }

  // Interrupts
  /// A byte from the dongle.
  void receive(std::uint8_t byte) noexcept {
    {
      [[maybe_unused]] const auto guard = port_->lock();
      if (!app::has_link(state_)) {
        ++counters_.input_unlinked;
        return;
      }
      input_.push(byte);
      if (byte != '}' && !input_.filling()) return;
      line_waits_ = true;
    }
    attend_communication();
  }
  /// The dongle's pin changed. When the link is gone, the motors are off on return.
  void link_changed() noexcept { look_at_link(); }
  /// The port's timer went off.
  void expire() noexcept { dispatcher_.expire(); }

  // Levels
  /// Does what is due at `level`.
  void run(Level level) noexcept {
    dispatcher_.run(level, [this](const Release& release) {
      perform(release);
      return scheduling::Outcome::done;
    });
  }
  /// What `run` is made of, for a port that calls jobs itself: the job's effects are at its end.
  [[nodiscard]] bool take(Level level, Release& release) noexcept { return dispatcher_.take(level, release); }
  void finish(const Release& release) noexcept {
    perform(release);
    dispatcher_.done(release.stream);
  }

  // Looking on
  [[nodiscard]] State state() const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return state_;
  }
  [[nodiscard]] motion::Pose pose() noexcept {
    [[maybe_unused]] const auto claim = located_.claim();
    return locator_.estimate().pose;
  }
  [[nodiscard]] Locator locator() noexcept {
    [[maybe_unused]] const auto claim = located_.claim();
    return locator_;
  }
  /// How the last calibration of the compass ended, or what is stored.
  [[nodiscard]] CompassReport compass() noexcept {
    [[maybe_unused]] const auto claim = located_.claim();
    return compass_;
  }
  /// On the way to a set point.
  [[nodiscard]] bool busy() const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return motion_.busy;
  }
  [[nodiscard]] Counters counters() noexcept;
  [[nodiscard]] scheduling::Overload overload(Task task) const noexcept {
    return dispatcher_.overload(stream(task));
  }
  /// Since `start`, in which nothing of the robot ran: as the port has it, or else what its jobs left.
  [[nodiscard]] base::Duration idle() noexcept {
    if constexpr (port_measures_idle) return port_idle() - idle_at_start_;
    [[maybe_unused]] const auto guard = port_->lock();
    return port_->now() - started_ - load_.busy();
  }
  /// Since `start`.
  [[nodiscard]] base::Duration uptime() const noexcept { return port_->now() - started_; }
  /// What it cost to share the pose.
  [[nodiscard]] scheduling::Contention contention() noexcept { return located_.contention(); }

 private:
  static constexpr bool port_measures_idle = requires(Port & port) {
    { port.idle() } -> std::convertible_to<base::Duration>;
  };

  /// What was ordered last. It is void when the motors are switched off.
  struct Order {
    bool halt = false;  ///< something is in the way
    motion::SetPoint set_point{};
  };
  /// What the motors are to do, and since which switch-off that was decided: one of before is void.
  struct Command {
    motion::PoseCommand pose{};
    std::uint32_t epoch = 0;
  };
  /// What the robot is doing.
  struct Motion {
    motion::Movement movement = motion::Movement::standing;
    bool backwards = false;
    bool busy = false;
  };
  /// What a job goes by: all of one moment.
  struct Moment {
    State state{};
    Motion motion{};
    std::uint32_t epoch = 0;
    std::uint32_t resets = 0;
    std::uint32_t links = 0;
  };

  [[nodiscard]] static constexpr std::size_t stream(Task task) noexcept {
    return static_cast<std::size_t>(task);
  }
  [[nodiscard]] base::Duration port_idle() noexcept {
    if constexpr (port_measures_idle) return port_->idle();
    return {};
  }
  [[nodiscard]] static float seconds(base::Duration time) noexcept {
    return static_cast<float>(time.count()) * 1e-9F;
  }
  /// Since `last`, which becomes `now`.
  [[nodiscard]] static float step_s(base::Time& last, base::Time now) noexcept {
    const float dt_s = seconds(now - last);
    last = now;
    return dt_s;
  }

  [[nodiscard]] Moment moment() const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return moment_locked();
  }
  [[nodiscard]] Moment moment_locked() const noexcept { return {state_, motion_, epoch_, resets_, links_}; }
  void count(std::uint32_t& counter) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    ++counter;
  }

  // --- state ---------------------------------------------------------------------------------------------

  Step apply(Event event) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return apply_locked(event);
  }
  Step apply_locked(Event event) noexcept {
    const Step step = app::step(state_, event);
    if (step.state != state_) entered_ = port_->now();
    state_ = step.state;
    counters_.refused += step.refused ? 1U : 0U;
    if (step.motors_off || step.reset) halt_locked();
    if (step.reset) ++resets_;
    if (step.drop) drop_link_locked();
    return step;
  }
  /// Motors off, and whatever was ordered is void.
  void halt_locked() noexcept {
    ++epoch_;
    orders_.clear_locked();
    commands_.clear_locked();
    motion_ = {};
    parts_->drive({});
  }
  void drop_link_locked() noexcept {
    ++links_;
    ++counters_.links_lost;
    input_.drop();
    line_waits_ = idle_wanted_ = false;
    lost_at_ = port_->now();
    may_return_ = true;
  }
  void look_at_link() noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    const State before = state_;
    if (!parts_->linked()) {
      (void)apply_locked(Event::link_down);
    } else if (ready_) {
      (void)apply_locked(Event::link_up);
      if (state_ != before) ++counters_.links;
    }
  }

  // --- jobs ----------------------------------------------------------------------------------------------

  void perform(const Release& release) noexcept {
    Load::Begun begun;
    {
      [[maybe_unused]] const auto guard = port_->lock();
      begun = load_.begin(port_->now());
    }
    switch (static_cast<Task>(release.stream)) {
      case Task::estimator:
        estimate_pose();
        break;
      case Task::movement:
        move_wheels();
        break;
      case Task::communication:
        communicate();
        break;
      case Task::pose_controller:
        control_pose();
        break;
      case Task::tower:
        look_around();
        break;
    }
    [[maybe_unused]] const auto guard = port_->lock();
    load_.end(begun, port_->now());
  }

  // --- estimator (urgent) --------------------------------------------------------------------------------

  void estimate_pose() noexcept {
    const Moment at = moment();
    const Activity activity{at.motion.movement, !may_drive(at.state), at.state == State::calibrating};
    const float dt_s = step_s(last_estimate_, port_->now());
    const Readings readings{parts_->ticks(), parts_->gyro(), parts_->field()};
    bool ready = false;
    bool failed = false;
    bool corrected = false;
    {
      [[maybe_unused]] const auto claim = located_.claim();
      locator_.step(readings, activity, dt_s);
      ready = locator_.ready();
      failed = locator_.failed();
      corrected = locator_.corrected_at_rest();
    }
    {
      [[maybe_unused]] const auto guard = port_->lock();
      if (ready && !ready_) (void)apply_locked(Event::parts_answered);
      if (failed) (void)apply_locked(Event::parts_failed);
      ready_ = ready;
      compass_at_rest_ = corrected;
      counters_.control_skipped += control_due_ ? 1U : 0U;
      control_due_ = true;
    }
    dispatcher_.once(stream(Task::pose_controller), Level::medium, port_->now());
  }

  // --- movement (high) -----------------------------------------------------------------------------------

  void move_wheels() noexcept {
    const base::Time now = port_->now();
    const float dt_s = step_s(last_movement_, now);
    if (const auto command = commands_.take()) {
      command_ = *command;
      commanded_ = now;
    } else if (now - commanded_ > model_->times.command_lives &&
               command_.pose.movement != motion::Movement::standing) {
      command_.pose = {};
      count(counters_.motors_starved);
    }
    const MotorStep step = app::move(motors_, command_.pose, parts_->ticks(), dt_s, model_->motors);
    motors_ = step.state;
    // Between this look and the motors nothing can happen: the interrupt of a lost link comes before or
    // after.
    [[maybe_unused]] const auto guard = port_->lock();
    const bool stale = command_.epoch != epoch_;
    if (stale && command_.pose.movement != motion::Movement::standing) {
      ++counters_.commands_stale;
      command_ = {};
    }
    parts_->drive(stale ? motion::Efforts{} : step.efforts);
  }

  // --- communication (high) ------------------------------------------------------------------------------

  /// Has communication released when there is something to do, and no more often than it may.
  void attend_communication() noexcept {
    dispatcher_.once(stream(Task::communication), Level::high, [this] {
      const base::Time soonest = last_communication_ + model_->periods.communication_apart;
      const bool wanted = line_waits_ || idle_wanted_ || compass_wanted_;
      const base::Time due = wanted ? port_->now() : supervision_due_;
      return due < soonest ? soonest : due;
    });
  }

  void communicate() noexcept {
    const base::Time now = port_->now();
    {
      [[maybe_unused]] const auto guard = port_->lock();
      last_communication_ = now;
      line_waits_ = false;
    }
    hear_all();
    if (take(compass_wanted_)) end_calibration();
    if (take(idle_wanted_)) say_idle(moment());
    if (now >= supervision_due_) supervise(now);
    {
      [[maybe_unused]] const auto guard = port_->lock();
      counters_.heard = reader_.heard();
      counters_.damaged = reader_.faults();
      counters_.stray_bytes = reader_.stray();
    }
    attend_communication();
  }

  void hear_all() noexcept {
    for (std::size_t i = 0; i < input_bytes; ++i) {  // what comes meanwhile has its own release
      base::Result<std::uint8_t> byte;
      std::uint32_t links = 0;
      {
        [[maybe_unused]] const auto guard = port_->lock();
        byte = input_.pop();
        links = links_;
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
        if (apply(Event::pause).idle) say_idle(moment());
        return;
      case link::Kind::unpause:
        (void)apply(Event::unpause);
        return;
      case link::Kind::packed:
      case link::Kind::text:
        if (!apply(Event::format).refused) output_.hear(kind);
        return;
      case link::Kind::calibrate:
        return hear_calibrate();
      case link::Kind::ping:
        if (apply(Event::ping).answer) say(link::Kind::pong, moment(), counters_.pongs);
        return;
      case link::Kind::who:
        if (apply(Event::who).answer) say_handshake(moment());
        return;
      default:
        return;
    }
  }
  void hear_confirm() noexcept {
    if (state() == State::connected) {
      [[maybe_unused]] const auto claim = located_.claim();
      if (!locator_.calibrated()) use_stored();
      locator_.begin_at_zero();
    }
    if (apply(Event::confirm).reset) last_idle_ = port_->now();
  }
  /// The calibration of before it was switched off.
  void use_stored() noexcept {
    const auto kept = parts_->stored();
    if (!kept) return;
    locator_.use(kept->offset);
    compass_ = {.verdict = judge(*kept, model_->compass), .fit = *kept};
  }
  /// A number that is new begins; that of the last one only asks, so a copy of a word changes nothing.
  void hear_calibrate() noexcept {
    const std::int16_t number = reader_.sentence().as<link::Calibrate>()->number;
    const bool asks = number == 0 || number == calibration_;
    if (!apply(asks ? Event::compass : Event::calibrate).answer) return;
    if (!asks) {
      calibration_ = number;
      count(counters_.calibrations);
      [[maybe_unused]] const auto claim = located_.claim();
      compass_ = {.verdict = link::Calibration::stopped};  // unless it comes to an end
    }
    say_compass(moment());
  }
  void hear_set_point() noexcept {
    const auto wanted = reader_.sentence().as<link::SetPoint>();
    const bool stop = wanted->angle == 0 && wanted->distance == 0;
    const motion::SetPoint set_point = motion::set_point(wanted->angle, wanted->distance);
    [[maybe_unused]] const auto guard = port_->lock();
    const Step step = apply_locked(stop ? Event::stop : Event::set_point);
    if (step.refused) return;
    idle_wanted_ = step.idle;
    if (!step.drive) return;
    orders_.put_locked({.halt = false, .set_point = set_point});
    motion_.busy = true;  // from now on no task says idle until this one has ended
  }

  void supervise(base::Time now) noexcept {
    {
      [[maybe_unused]] const auto guard = port_->lock();
      do supervision_due_ += model_->periods.supervision;
      while (supervision_due_ <= now);
    }
    look_at_link();
    const Moment at = moment();
    handshaken_ = false;
    if (at.state == State::connected) say_who(at, now);
    if (at.state == State::advertising) come_home(now);
    if (at.state == State::calibrating && now - last_compass_ >= model_->times.idle) say_compass(at);
    if (obeys(at.state) && !at.motion.busy && now - last_idle_ >= model_->times.idle) say_idle(at);
    show();
  }
  void say_who(const Moment& at, base::Time now) noexcept {
    if (shaken_links_ == at.links + 1 && now - last_handshake_ < model_->times.handshake) return;
    shaken_links_ = at.links + 1;
    last_handshake_ = now;
    handshaken_ = true;
    say_handshake(at);
  }
  void say_handshake(const Moment& at) noexcept {
    if (output_.say(model_->handshake, alive(at))) count(counters_.handshakes);
  }
  void come_home(base::Time now) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    const base::Duration after = model_->times.return_after;
    if (after == base::Duration::zero() || !may_return_ || now - lost_at_ < after) return;
    may_return_ = false;
    if (apply_locked(Event::return_due).state == State::returning) ++counters_.returns;
  }
  void show() noexcept {
    Lights wanted;
    {
      [[maybe_unused]] const auto guard = port_->lock();
      wanted = lights(state_, {port_->now() - entered_, handshaken_, compass_at_rest_});
    }
    parts_->show(wanted);
  }

  /// The link that a job began with is still there.
  [[nodiscard]] auto alive(const Moment& at) const noexcept {
    return [this, links = at.links] {
      [[maybe_unused]] const auto guard = port_->lock();
      return links == links_ && app::has_link(state_) && parts_->linked();
    };
  }
  void say(link::Kind kind, const Moment& at, std::uint32_t& counter) noexcept {
    if (output_.say(kind, alive(at))) count(counter);
  }
  void say_idle(const Moment& at) noexcept {
    if (!obeys(at.state)) return;
    last_idle_ = port_->now();
    say(link::Kind::idle, at, counters_.idles);
  }
  void say_compass(const Moment& at) noexcept {
    using Said = link::Calibration;
    last_compass_ = port_->now();
    CompassReport report;
    bool calibrated = false;
    {
      [[maybe_unused]] const auto claim = located_.claim();
      report = compass_;
      calibrated = locator_.calibrated();
    }
    const auto kept = parts_->stored();
    const bool safe = kept && (!report.taken || *kept == report.fit);
    if (at.state == State::calibrating) report = {.verdict = Said::turning};
    const std::int16_t use = !calibrated ? Said::unused : safe ? Said::stored : Said::until_off;
    (void)output_.say(app::calibration(calibration_, report, use), alive(at));
  }
  /// What the turn found is kept, and said.
  void end_calibration() noexcept {
    const CompassReport report = compass();
    if (report.taken) parts_->store(report.fit);
    const Moment at = moment();
    if (obeys(at.state)) say_compass(at);
  }
  /// Whether that is to be done. An idle that was wanted is taken back by a set point that was heard
  /// meanwhile.
  [[nodiscard]] bool take(bool& wanted) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return std::exchange(wanted, false);
  }
  /// The next job of communication says so.
  void want_idle() noexcept {
    {
      [[maybe_unused]] const auto guard = port_->lock();
      idle_wanted_ = !motion_.busy;
    }
    attend_communication();
  }

  // --- pose controller (medium) --------------------------------------------------------------------------

  void control_pose() noexcept {
    const float dt_s = step_s(last_control_, port_->now());
    Moment at;
    base::Result<Order> order;
    {
      [[maybe_unused]] const auto guard = port_->lock();
      control_due_ = false;
      at = moment_locked();
      order = orders_.take_locked();  // given in this state, and not switched off since
    }
    if (at.epoch != controlled_epoch_) pilot_.stop();
    if (at.resets != controlled_resets_) pilot_.forget();
    controlled_epoch_ = at.epoch;
    controlled_resets_ = at.resets;

    motion::PoseCommand command;
    bool ended = false;
    if (at.state == State::calibrating) {
      command = turn_around(at);
    } else if (may_drive(at.state)) {
      const motion::Pose pose = this->pose();
      ended = order && obey(*order, at, pose);
      const auto step = at.state == State::returning ? pilot_.go_home(pose, dt_s) : pilot_.go(pose, dt_s);
      command = step.command;
      if (step.end == PilotEnd::home) (void)apply(Event::returned);
      if (step.end == PilotEnd::arrived) count(counters_.arrived);
      ended = ended || step.end == PilotEnd::arrived;
    }
    publish(at, command);
    if (ended) want_idle();
  }
  /// True: the robot stops here, in front of something.
  bool obey(const Order& order, const Moment& at, const motion::Pose& pose) noexcept {
    if (!order.halt) {
      count(counters_.set_points);
      pilot_.begin(order.set_point, pose);
      return false;
    }
    const bool drove = pilot_.driving();
    pilot_.stop();
    if (at.state == State::returning) {
      count(counters_.returns_blocked);
      pilot_.forget();
    }
    return drove;
  }
  /// Around once, while the estimator looks at the field; then the offset is known, or why not.
  motion::PoseCommand turn_around(const Moment& at) noexcept {
    const base::Time now = port_->now();
    const bool first = calibration_epoch_ != at.epoch;  // each begins with the motors switched off
    if (first) calibration_began_ = now;
    calibration_epoch_ = at.epoch;
    const bool late = now - calibration_began_ > model_->times.calibration_limit;
    bool done = false;
    {
      [[maybe_unused]] const auto claim = located_.claim();
      if (first) locator_.begin_calibration();
      done = late || locator_.turned_around();
    }
    if (!done) return {motion::Movement::rotating, 0.0F, model_->compass.calibration_effort, false};
    bool taken = false;
    {
      [[maybe_unused]] const auto claim = located_.claim();
      compass_ = locator_.end_calibration();  // before the state says that it is over: who asks then hears it
      taken = compass_.taken;
    }
    if (!taken) count(counters_.calibrations_failed);
    const Step step = apply(Event::calibrated);
    {
      [[maybe_unused]] const auto guard = port_->lock();
      compass_wanted_ = true;
    }
    if (step.idle) want_idle();
    return {};
  }
  void publish(const Moment& at, const motion::PoseCommand& command) noexcept {
    {
      [[maybe_unused]] const auto guard = port_->lock();
      counters_.control_rejected = pilot_.rejected();
      counters_.places_forgotten = pilot_.history().forgotten();
      if (at.epoch != epoch_) return;  // switched off meanwhile
      motion_.movement = command.movement;
      motion_.backwards = command.ahead < 0.0F;
      motion_.busy = pilot_.driving() || !orders_.empty_locked();
    }
    commands_.put({command, at.epoch});
  }

  // --- tower (low) ---------------------------------------------------------------------------------------

  void look_around() noexcept {
    const Moment at = moment();
    if (may_drive(at.state)) {
      const Distances seen = distances();
      if (at.state == State::confirmed) tell(at, seen);
      if (in_the_way(at.motion.movement, at.motion.backwards, sweep_.servo_deg, seen,
                     model_->minimum_distance_cm)) {
        [[maybe_unused]] const auto guard = port_->lock();
        ++counters_.collisions;
        // A set point that came while the tower looked is newer than what it saw.
        if (at.epoch == epoch_ && orders_.empty_locked()) orders_.put_locked({.halt = true, .set_point = {}});
      }
    }
    const bool parked = !may_drive(at.state) || at.state == State::calibrating;
    const sensing::Sweep before = sweep_;
    sweep_ = sensing::next(
        sweep_, sensing::tower_mode(!parked, at.state == State::paused, at.motion.movement), model_->sweep);
    if (sweep_ != before) parts_->turn_tower(sweep_.servo_deg);
  }
  [[nodiscard]] Distances distances() noexcept {
    Distances seen{};
    for (std::size_t sensor = 0; sensor < seen.size(); ++sensor) {
      const base::Result<float> volts = parts_->infrared(sensor);
      if (!volts) count(counters_.infrared);
      seen[sensor] = distance_cm(volts, model_->infrared);
    }
    return seen;
  }
  void tell(const Moment& at, const Distances& seen) noexcept {
    const auto wanted = [this, &at, alive = alive(at)] { return alive() && state() == at.state; };
    const auto update = app::update(pose(), sweep_.servo_deg, seen);
    if (!update)
      count(counters_.out_of_range);
    else if (output_.say(*update, wanted))
      count(counters_.updates);
  }

  Parts* parts_;
  Port* port_;
  const RobotModel* model_;
  scheduling::Dispatcher<task_count, Port> dispatcher_;

  // Behind the port's lock
  Input<input_bytes> input_;
  Counters counters_{};
  Load load_;
  State state_ = State::advertising;
  Motion motion_{};
  std::uint32_t epoch_ = 0;   ///< how often the motors were switched off
  std::uint32_t resets_ = 0;  ///< how many operators confirmed
  std::uint32_t links_ = 0;   ///< how many links died
  base::Time entered_{};      ///< into this state
  base::Time lost_at_{};
  base::Time last_communication_{};
  base::Time supervision_due_{};
  bool may_return_ = false;
  bool line_waits_ = false;
  bool idle_wanted_ = false;
  bool compass_wanted_ = false;  ///< a calibration has ended: to be kept, and said
  bool control_due_ = false;
  bool compass_at_rest_ = false;
  bool ready_ = false;  ///< gyro and compass are measured

  // Queues of one place
  scheduling::Mailbox<Order, Port> orders_;      ///< communication, tower -> pose controller
  scheduling::Mailbox<Command, Port> commands_;  ///< pose controller -> movement

  scheduling::Resource<Mutex, Port> located_;  ///< for the next two
  Locator locator_;
  CompassReport compass_;
  Output<Parts, Port, Mutex> output_;  ///< brings its own

  // Of one task each
  base::Time started_{};
  base::Duration idle_at_start_{};
  base::Time last_estimate_{};  // estimator
  base::Time last_movement_{};  // movement
  base::Time commanded_{};
  Command command_{};
  Motors motors_{};
  link::Reader reader_{link::Direction::to_robot};  // communication
  std::uint32_t heard_links_ = 0;
  std::uint32_t shaken_links_ = 0;  ///< one more than the link that heard the last handshake
  base::Time last_handshake_{};
  base::Time last_idle_{};
  base::Time last_compass_{};
  std::int16_t calibration_ = 0;  ///< number of the last one
  bool handshaken_ = false;
  base::Time last_control_{};  // pose controller
  base::Time calibration_began_{};
  Pilot pilot_;
  std::uint32_t controlled_epoch_ = 0;
  std::uint32_t controlled_resets_ = 0;
  std::uint32_t calibration_epoch_ = 0;  ///< in which it turns around
  sensing::Sweep sweep_{};               // tower
};

template <RobotParts Parts, scheduling::Port Port, scheduling::Lockable Mutex>
Counters Robot<Parts, Port, Mutex>::counters() noexcept {
  Counters result;
  {
    [[maybe_unused]] const auto guard = port_->lock();
    result = counters_;
    result.input_full = input_.lost();
    result.input_dropped = input_.dropped();
  }
  result.orders_lost = orders_.lost();
  result.commands_lost = commands_.lost();
  const OutputCounters output = output_.counters();
  result.unsent = output.unsent;
  result.out_of_range += output.out_of_range;
  result.output_full = output.full;
  const Locator known = locator();
  result.gyro = known.gyro_failed();
  result.compass = known.compass_failed();
  result.estimator = known.estimate().rejected;
  result.ticks_rejected = known.estimate().wheels.rejected;
  for (std::size_t task = 0; task < task_count; ++task) {
    const scheduling::Overload one = dispatcher_.overload(task);
    result.overload.missed += one.missed;
    result.overload.late += one.late;
    result.overload.overrun += one.overrun;
  }
  return result;
}

}  // namespace ocm::mapper::app
