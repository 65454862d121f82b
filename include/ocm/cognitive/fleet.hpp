/// The robots behind one central: what each of them is, where it is, and how good its link is. Takes the
/// stream of packets apart, confirms handshakes, says set points and stops until they are heard
/// (mapper/server/sender.hpp), and says when a robot should be called back before its link is gone, and when
/// it is. [Thesis 2, 4.5, 6.3, 15.3]
///
/// Bytes in, words for robots out, time handed in; no I/O. O(1) a byte. What belongs to no robot, and what
/// came when it could not be meant, is counted. Host only.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "ocm/base/time.hpp"
#include "ocm/cognitive/map.hpp"
#include "ocm/mapper/link/demultiplexer.hpp"
#include "ocm/mapper/link/format.hpp"
#include "ocm/mapper/server/calibrator.hpp"
#include "ocm/mapper/server/sender.hpp"

namespace ocm::cognitive {

struct FleetOptions {
  bool packed = true;                                      ///< ask robots that offer it for packed updates
  std::uint32_t good_from = 850;                           ///< per mille of whole sentences: well again
  std::uint32_t bad_below = 700;                           ///< to be called back
  motion::Point central{};                                 ///< where the central stands
  float range_m = std::numeric_limits<float>::infinity();  ///< of its radio
  float near_range = 0.9F;                                 ///< of the range: to be called back
  base::Duration deadline = std::chrono::seconds{5};       ///< silence of a robot that told none
  mapper::server::SenderOptions sender{};                  ///< how set points and stops are said
};

/// Why a robot should come back.
enum class Advice : std::uint8_t { stay, bad_link, far_away };

/// What the fleet knows of one robot.
struct Robot {
  std::string name{};
  bool linked = false;     ///< the central says so
  bool confirmed = false;  ///< its handshake came, and was answered
  bool idle = false;       ///< it stands, and nothing that was asked of it is left
  bool located = false;    ///< and `update` is of since it stands
  bool paused = false;
  bool lost = false;  ///< silent for its deadline, or without a link
  std::optional<mapper::link::Handshake> handshake{};
  std::optional<mapper::link::Update> update{};  ///< the newest
  base::Time updated{};
  base::Time heard{};  ///< its last word of any kind
  mapper::link::Kind last = mapper::link::Kind::none;
  base::Time told{};          ///< when the last set point, pause or unpause was said
  motion::Pose origin{};      ///< where its frame began, in the world
  bool origin_known = false;  ///< `set_origin` has said it
  Advice advice = Advice::stay;

  [[nodiscard]] Shape shape() const { return handshake ? shape_of(*handshake) : Shape{}; }
  /// In the world; where it began, before the first update.
  [[nodiscard]] motion::Pose pose() const { return update ? placed(origin, pose_of(*update)) : origin; }
};

/// They wrap.
struct FleetCounters {
  std::uint32_t handshakes = 0;
  std::uint32_t updates = 0;
  std::uint32_t idles = 0;
  std::uint32_t pongs = 0;
  std::uint32_t calibrations = 0;  ///< sentences about the compass
  std::uint32_t early_idles = 0;   ///< right behind a set point: meant the one before
  std::uint32_t lost = 0;          ///< times that a robot was
  std::uint32_t calls = 0;         ///< times that one should have come back
  std::uint32_t words = 0;         ///< set points and stops said, each time
};

/// Words for a robot.
struct Saying {
  std::size_t robot = 0;
  std::string words{};
};

class Fleet {
 public:
  static constexpr std::size_t most_robots = 128;  ///< on the list of a central

  explicit Fleet(const FleetOptions& options = {}) : options_(options) {
    for (std::size_t i = 0; i < most_robots; ++i)
      mouths_[i].sender = mapper::server::Sender{options.sender, static_cast<std::uint32_t>(i)};
  }

  /// The central has a link to this robot.
  void linked(std::size_t index, std::string_view name, base::Time now) {
    if (index >= most_robots) return;
    Robot& robot = robots_[index];
    if (robot.name != name)
      robot = Robot{.name = std::string{name}, .origin = robot.origin, .origin_known = robot.origin_known};
    if (!robot.linked) {
      ears_.restart(index);
      forget_words(index);
      robot.advice = Advice::stay;
    }
    robot.linked = true;  // once more, for another program that asked: the link is as good as it was
    robot.lost = false;
    robot.heard = now;
  }
  /// The link is gone: the robot stops by itself.
  void unlinked(std::size_t index) {
    if (index >= most_robots || !robots_[index].linked) return;
    robots_[index].linked = false;
    forget_words(index);
    mouths_[index].confirm_at = base::never;
    mouths_[index].asked_until = {};
    lose(robots_[index]);
  }
  /// Where the frame of a robot's poses is in the world: where it stood when it began.
  void set_origin(std::size_t index, const motion::Pose& origin) {
    if (index >= most_robots) return;
    robots_[index].origin = origin;
    robots_[index].origin_known = true;
  }

  /// The robots' bytes (CentralClient::take_robots). `heard(index, kind)` after each whole sentence.
  template <class Heard>
  void feed(std::string_view bytes, base::Time now, Heard&& heard) {
    for (const char c : bytes) {
      const auto sentence = ears_.feed(static_cast<std::uint8_t>(c));
      if (sentence.kind == mapper::link::Kind::none) continue;
      hear(sentence.robot, sentence.kind, now);
      heard(std::size_t{sentence.robot}, sentence.kind);
    }
  }
  void feed(std::string_view bytes, base::Time now) {
    feed(bytes, now, [](std::size_t, mapper::link::Kind) {});
  }
  /// Who is silent for too long is lost; what was not heard is said again, to a silent robot too. Each 50 ms.
  void expire(base::Time now) {
    for (std::size_t i = 0; i < most_robots; ++i) {
      Robot& robot = robots_[i];
      if (!robot.linked) continue;
      if (!robot.lost && now - robot.heard > deadline_of(robot)) lose(robot);
      speak(i, now);
    }
  }

  // --- what is to be said ---

  /// From where the robot stands, or will have been stopped; said until it is heard, in legs of at most
  /// `mapper::server::longest_leg_cm`. {0, 0} is a stop. False when a field is out of its range: then nothing
  /// is said.
  bool go(std::size_t index, const mapper::link::SetPoint& set_point, base::Time now) {
    if (index >= most_robots || !mapper::link::write(set_point)) return false;
    mouths_[index].sender.go(set_point, now);
    mouths_[index].calibrator.restart();
    robots_[index].idle = false;
    speak(index, now);
    return true;
  }
  /// Said until an idle proves that the robot stands.
  bool stop(std::size_t index, base::Time now) { return go(index, {0, 0}, now); }
  /// What has become of the last of them.
  [[nodiscard]] const mapper::server::Sender& sender(std::size_t index) const {
    return mouths_[index].sender;
  }
  /// It turns around once for its compass, where it stands; said until it is heard, and asked for until it
  /// has said how that ended. `only_ask`: how the last one ended. A stop or a set point ends it. A paused
  /// robot does not hear it.
  bool calibrate(std::size_t index, base::Time now, bool only_ask = false) {
    if (index >= most_robots) return false;
    mouths_[index].calibrator.begin(now, only_ask);
    speak(index, now);
    return true;
  }
  /// What has become of the last of them.
  [[nodiscard]] const mapper::server::Calibrator& calibrator(std::size_t index) const {
    return mouths_[index].calibrator;
  }
  bool pause(std::size_t index, base::Time now) { return hold(index, true, now); }
  bool unpause(std::size_t index, base::Time now) { return hold(index, false, now); }
  bool ping(std::size_t index) { return say(index, mapper::link::write(mapper::link::Kind::ping)->view()); }
  /// To a robot that was confirmed before: its handshake, which it says to no second program by itself. One
  /// that does not know the word is silent; what is known of its place stays.
  bool ask_who(std::size_t index, base::Time now) {
    if (index >= most_robots) return false;
    constexpr base::Duration answers = std::chrono::seconds{2};
    mouths_[index].asked_until = now + answers;
    return say(index, mapper::link::write(mapper::link::Kind::who)->view());
  }
  [[nodiscard]] std::optional<Saying> take() {
    if (sayings_.empty()) return std::nullopt;
    Saying saying = std::move(sayings_.front());
    sayings_.pop_front();
    return saying;
  }
  /// What was taken for this robot has gone out, or never will. Once for each saying, in their order.
  void out(std::size_t index, base::Time now) {
    if (index >= most_robots) return;
    Mouth& mouth = mouths_[index];
    if (mouth.out != mouth.queued && ++mouth.out == mouth.words) mouth.sender.out(now);
  }

  // --- what is known ---

  /// index < most_robots; one that never was there has no name.
  [[nodiscard]] const Robot& robot(std::size_t index) const { return robots_[index]; }
  [[nodiscard]] std::uint32_t quality_per_mille(std::size_t index) const {
    return ears_.ear(index).quality().per_mille();
  }
  [[nodiscard]] const mapper::link::Ear& ear(std::size_t index) const { return ears_.ear(index); }
  [[nodiscard]] base::Duration deadline_of(const Robot& robot) const noexcept {
    if (!robot.handshake || robot.handshake->deadline <= 0) return options_.deadline;
    return std::chrono::milliseconds{robot.handshake->deadline};
  }
  /// Whether, and why, the robot should come back; it stays so until the link is well, and it is nearer.
  [[nodiscard]] Advice call_back(std::size_t index) const { return robots_[index].advice; }
  [[nodiscard]] const FleetCounters& counters() const noexcept { return counters_; }
  /// Bytes that belonged to no robot.
  [[nodiscard]] std::uint32_t of_no_robot() const noexcept { return ears_.of_no_robot(); }
  [[nodiscard]] const FleetOptions& options() const noexcept { return options_; }

 private:
  /// What goes to one robot: of `queued` sayings so many are `out`; number `words` is the sender's.
  struct Mouth {
    mapper::server::Sender sender{};
    mapper::server::Calibrator calibrator{};
    std::uint32_t queued = 0;
    std::uint32_t out = 0;
    std::uint32_t words = 0;
    base::Time asked_until{};             ///< a handshake until then is an answer
    base::Time confirm_at = base::never;  ///< once more: no update, no idle has shown that it was heard
  };

  /// Robots that share the radio do not keep step.
  [[nodiscard]] static base::Duration confirm_again(std::size_t index) noexcept {
    return std::chrono::milliseconds{500 + 20 * (index % 8)};
  }
  /// What the sender has to say, now that something was heard, or time has passed.
  void speak(std::size_t index, base::Time now) {
    using mapper::link::Kind;
    Mouth& mouth = mouths_[index];
    Robot& robot = robots_[index];
    if (now >= mouth.confirm_at) {
      mouth.confirm_at = now + confirm_again(index);
      (void)say(index, mapper::link::write(Kind::confirm)->view());
    }
    const bool busy = !is_final(mouth.sender.progress());
    const auto word = mouth.sender.next(now);
    if (word.kind == Kind::set_point) {
      ++counters_.words;
      robot.told = now;
      (void)say(index, mapper::link::write(word.set_point)->view());
    }
    if (word.kind == Kind::unpause) {
      robot.paused = false;
      (void)say(index, mapper::link::write(Kind::unpause)->view());
    }
    if (word.kind != Kind::none) mouth.words = mouth.queued;
    if (const auto order = mouth.calibrator.next(now)) (void)say(index, mapper::link::write(*order)->view());
    if (busy && is_final(mouth.sender.progress())) robot.idle = mouth.sender.standing();
    if (!busy && mouth.sender.standing()) robot.idle = true;
    if (mouth.calibrator.may_turn()) robot.idle = false;
    robot.located = robot.idle && mouth.sender.placed();
  }
  bool say(std::size_t index, std::string_view words) {
    if (index >= most_robots) return false;
    ++mouths_[index].queued;
    sayings_.push_back({index, std::string{words}});
    return true;
  }
  bool hold(std::size_t index, bool paused, base::Time now) {
    if (index >= most_robots) return false;
    robots_[index].paused = paused;
    robots_[index].told = now;
    mouths_[index].sender.disturbed(now);
    return say(index,
               mapper::link::write(paused ? mapper::link::Kind::pause : mapper::link::Kind::unpause)->view());
  }
  /// The robot stands, and knows of nothing that was said.
  void forget_words(std::size_t index) {
    mouths_[index].sender.restart();
    mouths_[index].calibrator.restart();
  }
  void lose(Robot& robot) {
    if (!robot.lost) ++counters_.lost;
    robot.lost = true;
    robot.idle = false;
  }

  void hear(std::size_t index, mapper::link::Kind kind, base::Time now) {
    if (index >= most_robots) return;
    Robot& robot = robots_[index];
    robot.heard = now;
    robot.last = kind;
    if (kind == mapper::link::Kind::update || kind == mapper::link::Kind::idle)
      mouths_[index].confirm_at = base::never;
    robot.lost = false;
    robot.linked = true;  // a robot that speaks has a link
    switch (kind) {
      case mapper::link::Kind::handshake:
        greet(index, robot, now);
        break;
      case mapper::link::Kind::update:
        update(index, robot, now);
        break;
      case mapper::link::Kind::idle:
        ++counters_.idles;
        robot.confirmed = true;
        if (!mouths_[index].sender.hear_idle(now)) ++counters_.early_idles;
        break;
      case mapper::link::Kind::pong:
        ++counters_.pongs;
        break;
      case mapper::link::Kind::calibration:
        ++counters_.calibrations;
        robot.confirmed = true;
        mouths_[index].calibrator.hear(*ears_.ear(index).sentence().as<mapper::link::Calibration>(), now);
        break;
      default:
        break;
    }
    judge(index, robot);
    speak(index, now);
  }
  /// It is said again each second until the robot hears the answer, which is repeated, too: a handshake is
  /// two packets, and comes whole less often than the answer.
  void greet(std::size_t index, Robot& robot, base::Time now) {
    ++counters_.handshakes;
    const bool confirmed_before = robot.confirmed;
    robot.handshake = ears_.ear(index).sentence().as<mapper::link::Handshake>().value;
    // A robot that has begun again says it each second: a later one is no answer.
    if (confirmed_before && now < mouths_[index].asked_until) return;
    robot.origin = robot.pose();  // its pose begins at 0 again, where it stands
    robot.update.reset();
    robot.confirmed = true;
    robot.idle = true;  // it waits for a set point
    robot.paused = false;
    robot.told = {};
    forget_words(index);
    mouths_[index].confirm_at = now + confirm_again(index);
    (void)say(index, mapper::link::answer(*robot.handshake, options_.packed).view());
  }
  void update(std::size_t index, Robot& robot, base::Time now) {
    ++counters_.updates;
    robot.confirmed = true;
    robot.update = ears_.ear(index).sentence().as<mapper::link::Update>().value;
    robot.updated = now;
    mouths_[index].sender.hear_update(*robot.update, now);
    // Paused robots send none: it was not heard.
    constexpr base::Duration in_flight = std::chrono::seconds{1};
    if (robot.paused && now - robot.told > in_flight) robot.paused = false;
  }
  void judge(std::size_t index, Robot& robot) {
    const mapper::link::LinkQuality& quality = ears_.ear(index).quality();
    const float far = distance_m(place(robot.pose()), options_.central);
    const bool before = robot.advice != Advice::stay;
    const bool was_far = robot.advice == Advice::far_away;  // a bad link is no reason to call it too far
    const float limit = options_.range_m * (was_far ? options_.near_range * 0.9F : options_.near_range);
    if (far > limit)
      robot.advice = Advice::far_away;
    else if (quality.below(before ? options_.good_from : options_.bad_below))
      robot.advice = Advice::bad_link;
    else
      robot.advice = Advice::stay;
    if (!before && robot.advice != Advice::stay) ++counters_.calls;
  }

  FleetOptions options_;
  mapper::link::Demultiplexer<most_robots> ears_;
  std::array<Robot, most_robots> robots_{};
  std::array<Mouth, most_robots> mouths_{};
  std::deque<Saying> sayings_;
  FleetCounters counters_{};
};

}  // namespace ocm::cognitive
