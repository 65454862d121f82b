/// The radio between a central and its robots' dongles, in virtual time: who is found, who has a link, which
/// packet arrives when, and which never does. The caller hands time in and moves the robots; the same calls
/// give the same air.
///
///     Radio radio{RadioModel{.range_m = 8}};
///     const std::size_t robot = radio.add({1, 2});
///     radio.advertise(robot, true, now);
///     radio.start_scan(now);
///     radio.advance(now, user);                       // at next_event(), or when it pleases
///
/// Each link has its connection events, an interval apart, and in each some packets go each way: that is the
/// bandwidth. Who hears nothing for the supervision time-out has lost the link; the two sides find out by
/// themselves. Order is kept each way of a link, and nothing of a link that has ended reaches the next one:
/// it is counted.
///
/// Bluetooth Low Energy repeats a packet until it is acknowledged, so that a bad link is slow; the log of
/// thesis 2, listing 15.1, has holes. `repeats` chooses.
///
/// Host side: memory is taken in `add` and for packets in the air. An event costs O(robots). A robot's luck
/// is its own: it does not depend on who else is there.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/link/packet.hpp"

namespace ocm::simulation {

/// Metres.
struct Place {
  double x_m = 0;
  double y_m = 0;
};

[[nodiscard]] inline double distance_m(Place a, Place b) noexcept {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

struct RadioModel {
  /// Beyond it nothing is heard. [Thesis 2, 15.1: good at 5 to 8 m in a room; the edge itself is decided]
  double range_m = 8;
  /// Share of packets lost at the range; it rises from none at a half of it in proportion. [decided]
  double loss_at_range = 0.5;
  double loss_everywhere = 0;  ///< share lost besides, by whatever else is in the air
  /// From the connection event to the other side's serial line.
  base::Duration delay = std::chrono::milliseconds{5};
  /// Between connection events. [nRF5 SDK, UART example: 20 to 75 ms]
  base::Duration interval = std::chrono::milliseconds{30};
  /// Packets each way in an event, at least 1. An nRF51 can have 6, hosts often fewer.
  unsigned packets = 4;
  /// [nRF5 SDK, UART example: 4 s]
  base::Duration supervision_timeout = std::chrono::seconds{4};
  base::Duration advertising_interval = std::chrono::milliseconds{100};
  /// An attempt to connect that has heard nothing of the robot ends.
  base::Duration attempt_timeout = std::chrono::seconds{5};
  std::size_t links = 3;  ///< at once [thesis 2, 4.3.1]
  bool repeats = false;   ///< a lost packet goes again, before any other; else it is lost for good
  std::uint64_t seed = 1;
};

/// Share of packets lost over this distance, 0 .. 1.
[[nodiscard]] constexpr double loss(const RadioModel& model, double distance) noexcept {
  if (!(distance <= model.range_m)) return 1;
  const double half = model.range_m / 2;
  const double by_range = distance <= half ? 0 : model.loss_at_range * (distance - half) / half;
  return by_range + (1 - by_range) * model.loss_everywhere;
}

/// What the radio calls, with the robot's number, in the order of time; `Radio::time` tells it.
template <class U>
concept RadioUser = requires(U& user, std::size_t robot, const mapper::link::Packet& packet, bool linked) {
  {
    user.next_for_robot(robot)
    } -> std::same_as<base::Result<mapper::link::Packet>>;  ///< the central's oldest
  {
    user.next_for_central(robot)
    } -> std::same_as<base::Result<mapper::link::Packet>>;  ///< the dongle's oldest
  user.at_robot(robot, packet);                             ///< the robot's dongle has received it
  user.at_central(robot, packet);                           ///< the central has
  user.found(robot);           ///< the central, which scans, has heard that it advertises
  user.connected(robot);       ///< at the central
  user.closed(robot);          ///< at the central: the link, or the attempt
  user.linked(robot, linked);  ///< at the robot's dongle
};

/// What became of the packets of one way: taken = delivered + lost + dropped, and those under way.
struct WayCounters {
  std::uint64_t taken = 0;      ///< from the queue of the sending side
  std::uint64_t delivered = 0;  ///< each once, in order
  std::uint64_t lost = 0;       ///< in the air, for good
  std::uint64_t repeated = 0;   ///< times that one went again
  std::uint64_t dropped = 0;    ///< under way when the link ended
  friend bool operator==(const WayCounters&, const WayCounters&) = default;
};

/// Of one robot.
struct RadioCounters {
  WayCounters to_robot;
  WayCounters to_central;
  std::uint64_t links = 0;             ///< that came about
  std::uint64_t robot_timeouts = 0;    ///< supervision time-outs at its dongle
  std::uint64_t central_timeouts = 0;  ///< the same at the central
  std::uint64_t refused = 0;  ///< attempts that the radio did not take: too many links, or one under way
  std::uint64_t failed = 0;   ///< attempts that heard nothing of the robot
  friend bool operator==(const RadioCounters&, const RadioCounters&) = default;
};

class Radio {
 public:
  explicit Radio(const RadioModel& model = {}) : model_(model) {
    model_.packets = std::max(model_.packets, 1U);
    model_.interval = std::max(model_.interval, base::Duration{1});
    model_.advertising_interval = std::max(model_.advertising_interval, base::Duration{1});
  }

  // --- the air ---

  /// A robot's dongle, which does not advertise yet. Numbers count from 0.
  std::size_t add(Place place = {}) {
    std::seed_seq seed{model_.seed, model_.seed >> 32, static_cast<std::uint64_t>(robots_.size())};
    robots_.push_back({.place = place, .luck = std::mt19937_64{seed}});
    return robots_.size() - 1;
  }
  void place_central(Place place) noexcept { central_ = place; }
  void move(std::size_t robot, Place place) noexcept { robots_[robot].place = place; }
  /// Whether the dongle advertises. It is not found while it has a link.
  void advertise(std::size_t robot, bool on, base::Time now) {
    step_to(now);
    Robot& r = robots_[robot];
    if (on && !r.advertises) r.advertisement = now + model_.advertising_interval;
    r.advertises = on;
    plan();
  }

  // --- the central ---

  void start_scan(base::Time now) {
    step_to(now);
    scanning_ = true;
    for (Robot& robot : robots_) listen_for(robot);
    plan();
  }
  void stop_scan() {
    scanning_ = false;
    plan();
  }
  /// `connected` or `closed` follows, in `advance`; a link that is there stays.
  void connect(std::size_t robot, base::Time now) {
    step_to(now);
    Robot& r = robots_[robot];
    if (attempt_ == robot) return;
    if (r.central_up) {
      report(Report::Kind::connected, robot);
    } else if (attempt_ || links() >= model_.links) {
      ++r.counters.refused;
      report(Report::Kind::closed, robot);
    } else {
      attempt_ = robot;
      attempt_ends_ = now + model_.attempt_timeout;
      listen_for(r);
    }
    plan();
  }
  /// Ends the link with its next event, or the attempt at once; `closed` follows.
  void disconnect(std::size_t robot, base::Time now) {
    step_to(now);
    if (attempt_ == robot) {
      attempt_.reset();
      report(Report::Kind::closed, robot);
    } else if (robots_[robot].central_up) {
      robots_[robot].closing = true;
    }
    plan();
  }
  /// The central restarts without a report: robots' dongles hear nothing, and find out by the time-out.
  void restart() {
    scanning_ = false;
    attempt_.reset();
    for (Robot& robot : robots_) close_central(robot);
    std::erase_if(reports_, [](const Report& r) { return r.kind < Report::Kind::linked; });
    plan();
  }

  // --- time ---

  /// All that happens until and at `now`, in order of time.
  template <RadioUser U>
  void advance(base::Time now, U& user) {
    while (next_ <= now) {
      step_to(next_);
      happen(user);
      plan();
    }
    step_to(now);
  }
  /// When something happens; base::never when nothing does until the next call.
  [[nodiscard]] base::Time next_event() const noexcept { return next_; }
  /// Of what happens now.
  [[nodiscard]] base::Time time() const noexcept { return time_; }

  // --- onlookers ---

  [[nodiscard]] const RadioModel& model() const noexcept { return model_; }
  [[nodiscard]] std::size_t robots() const noexcept { return robots_.size(); }
  [[nodiscard]] const RadioCounters& counters(std::size_t robot) const noexcept {
    return robots_[robot].counters;
  }
  [[nodiscard]] double distance(std::size_t robot) const noexcept {
    return distance_m(central_, robots_[robot].place);
  }
  /// Links of the central, and the attempt.
  [[nodiscard]] std::size_t links() const noexcept {
    return static_cast<std::size_t>(
               std::count_if(robots_.begin(), robots_.end(), [](const Robot& r) { return r.central_up; })) +
           (attempt_ ? 1 : 0);
  }

 private:
  /// One way of a link.
  enum class Way : std::uint8_t { to_robot, to_central };

  struct Robot {
    Place place{};
    std::mt19937_64 luck{};
    bool advertises = false;
    bool central_up = false;  ///< the link, as the central sees it
    bool robot_up = false;    ///< as the dongle does
    bool closing = false;     ///< the central ends it with the next event
    std::uint64_t link = 0;   ///< which one; packets know theirs
    base::Time advertisement{};
    base::Time event{};
    base::Time central_heard{};
    base::Time robot_heard{};
    std::array<std::optional<mapper::link::Packet>, 2> again{};  ///< a way's lost packet, to be repeated
    RadioCounters counters{};
  };
  struct Report {
    enum class Kind : std::uint8_t { found, connected, closed, linked, unlinked };
    Kind kind;
    std::size_t robot;
    base::Time time;
  };
  struct InTheAir {
    base::Time arrives;
    std::size_t robot;
    std::uint64_t link;
    Way way;
    bool goodbye;  ///< the central has ended the link
    mapper::link::Packet packet;
  };

  [[nodiscard]] static WayCounters& counters(Robot& robot, Way way) noexcept {
    return way == Way::to_robot ? robot.counters.to_robot : robot.counters.to_central;
  }
  [[nodiscard]] static std::optional<mapper::link::Packet>& again(Robot& robot, Way way) noexcept {
    return robot.again[static_cast<std::size_t>(way)];
  }

  void step_to(base::Time now) noexcept { time_ = std::max(time_, now); }
  void report(Report::Kind kind, std::size_t robot) { reports_.push_back({kind, robot, time_}); }
  [[nodiscard]] bool lost(Robot& robot) {
    const double share = loss(model_, distance_m(central_, robot.place));
    return static_cast<double>(robot.luck() >> 11) * 0x1p-53 < share;
  }
  /// Advertisements that no central heard are over.
  void listen_for(Robot& robot) const noexcept {
    if (robot.advertisement > time_) return;
    const auto missed = (time_ - robot.advertisement) / model_.advertising_interval;
    robot.advertisement += (missed + 1) * model_.advertising_interval;
  }
  [[nodiscard]] bool heard_of(std::size_t robot) const noexcept {
    const Robot& r = robots_[robot];
    return r.advertises && !r.robot_up && (scanning_ || attempt_ == robot);
  }
  void plan() noexcept {
    next_ = attempt_ ? attempt_ends_ : base::never;
    if (!reports_.empty()) next_ = std::min(next_, reports_.front().time);
    if (!air_.empty()) next_ = std::min(next_, air_.front().arrives);
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if (robots_[i].central_up || robots_[i].robot_up) next_ = std::min(next_, robots_[i].event);
      if (heard_of(i)) next_ = std::min(next_, robots_[i].advertisement);
    }
  }

  /// Whatever is due now. Reports first: they are of before.
  template <class U>
  void happen(U& user) {
    while (!reports_.empty() && reports_.front().time <= time_) {
      const Report report = reports_.front();
      reports_.pop_front();
      tell(report, user);
    }
    while (!air_.empty() && air_.front().arrives <= time_) {
      const InTheAir arrived = air_.front();
      air_.pop_front();
      deliver(arrived, user);
    }
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if ((robots_[i].central_up || robots_[i].robot_up) && robots_[i].event <= time_) meet(i, user);
      if (heard_of(i) && robots_[i].advertisement <= time_) advertisement(i);
    }
    if (attempt_ && attempt_ends_ <= time_) {
      ++robots_[*attempt_].counters.failed;
      report(Report::Kind::closed, *attempt_);
      attempt_.reset();
    }
  }
  template <class U>
  static void tell(const Report& report, U& user) {
    switch (report.kind) {
      case Report::Kind::found:
        return user.found(report.robot);
      case Report::Kind::connected:
        return user.connected(report.robot);
      case Report::Kind::closed:
        return user.closed(report.robot);
      case Report::Kind::linked:
      case Report::Kind::unlinked:
        return user.linked(report.robot, report.kind == Report::Kind::linked);
    }
  }

  void advertisement(std::size_t i) {
    Robot& robot = robots_[i];
    robot.advertisement += model_.advertising_interval;
    if (lost(robot)) return;
    if (scanning_) report(Report::Kind::found, i);
    if (attempt_ != i) return;
    attempt_.reset();
    robot.central_up = robot.robot_up = true;
    robot.closing = false;
    ++robot.link;
    robot.central_heard = robot.robot_heard = time_;
    robot.event = time_ + model_.interval;
    ++robot.counters.links;
    report(Report::Kind::linked, i);
    report(Report::Kind::connected, i);
  }

  /// A connection event: packets both ways; then either side looks how long it has heard nothing.
  template <class U>
  void meet(std::size_t i, U& user) {
    Robot& robot = robots_[i];
    robot.event += model_.interval;
    if (robot.central_up && robot.closing) {
      if (robot.robot_up && !lost(robot))
        air_.push_back({time_ + model_.delay, i, robot.link, Way::to_robot, true, {}});
      close_central(robot);
      report(Report::Kind::closed, i);
    } else if (robot.central_up && robot.robot_up) {
      if (transfer(i, Way::to_robot, [&] { return user.next_for_robot(i); })) robot.robot_heard = time_;
      if (transfer(i, Way::to_central, [&] { return user.next_for_central(i); })) robot.central_heard = time_;
    }
    if (robot.central_up && time_ - robot.central_heard >= model_.supervision_timeout) {
      ++robot.counters.central_timeouts;
      close_central(robot);
      report(Report::Kind::closed, i);
    }
    if (robot.robot_up && time_ - robot.robot_heard >= model_.supervision_timeout) {
      ++robot.counters.robot_timeouts;
      close_robot(i);
    }
  }
  /// Whether the other side has heard something, if only that there is nothing to say.
  template <class Next>
  bool transfer(std::size_t i, Way way, Next next) {
    Robot& robot = robots_[i];
    WayCounters& count = counters(robot, way);
    std::optional<mapper::link::Packet>& again = Radio::again(robot, way);
    bool heard = false;
    for (unsigned k = 0; k < model_.packets; ++k) {
      mapper::link::Packet packet;
      if (again) {
        packet = *again;
        ++count.repeated;
      } else {
        const auto fresh = next();
        if (!fresh) return heard || (k == 0 && !lost(robot));
        packet = *fresh;
        ++count.taken;
      }
      again.reset();
      if (!lost(robot)) {
        heard = true;
        air_.push_back({time_ + model_.delay, i, robot.link, way, false, packet});
      } else if (model_.repeats) {
        again = packet;
        return heard;
      } else {
        ++count.lost;
      }
    }
    return heard;
  }
  template <class U>
  void deliver(const InTheAir& arrived, U& user) {
    Robot& robot = robots_[arrived.robot];
    const bool up = arrived.way == Way::to_robot ? robot.robot_up : robot.central_up;
    if (!up || arrived.link != robot.link) {
      if (!arrived.goodbye) ++counters(robot, arrived.way).dropped;
      return;
    }
    if (arrived.goodbye) return close_robot(arrived.robot);
    ++counters(robot, arrived.way).delivered;
    if (arrived.way == Way::to_robot)
      user.at_robot(arrived.robot, arrived.packet);
    else
      user.at_central(arrived.robot, arrived.packet);
  }

  static void drop(Robot& robot, Way way) noexcept {
    if (again(robot, way)) ++counters(robot, way).dropped;
    again(robot, way).reset();
  }
  static void close_central(Robot& robot) noexcept {
    robot.central_up = robot.closing = false;
    drop(robot, Way::to_robot);
  }
  void close_robot(std::size_t i) {
    Robot& robot = robots_[i];
    robot.robot_up = false;
    drop(robot, Way::to_central);
    robot.advertisement = time_ + model_.advertising_interval;
    report(Report::Kind::unlinked, i);
  }

  RadioModel model_;
  Place central_{};
  std::vector<Robot> robots_;
  std::deque<Report> reports_;
  std::deque<InTheAir> air_;  ///< in order of arrival: the delay is the same for all
  std::optional<std::size_t> attempt_;
  base::Time attempt_ends_{};
  bool scanning_ = false;
  base::Time time_{};
  base::Time next_ = base::never;
};

}  // namespace ocm::simulation
