/// Gets a set point, or a stop, to a robot whose radio loses packets, and knows what has become of it. The
/// link has no acknowledgement, so what the robot says next is the proof: a robot that has heard a set point
/// says no idle until the set point has ended; one that stands says idle each second, and updates say where.
///
/// - A stop is said again, three times a second, later once, until an idle proves that the robot stands.
/// Nothing ends that but the
///   caller. It pre-empts whatever was to be said.
/// - A set point is relative, so it is said again only once an idle and the update behind it prove that the
///   robot still stands where it stood; and it is worked out afresh from there. Two copies never add up.
/// - A robot that is not known to stand is stopped first: a set point begins at a known place.
/// - No leg is longer than `longest_leg_cm`, whatever was asked for: a longer way is driven in equal legs,
/// each
///   given when the last has ended. So a robot whose server has died or hangs drives that far, and no
///   farther. [docs/decisions/0026]
/// - A paused robot says no updates: it is unpaused.
///
/// Evidence and time go in, words come out; one robot. No heap, no clock, no I/O; O(1) a call; 160 bytes.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/mapper/link/sentence.hpp"

namespace ocm::mapper::server {

/// cm. A robot without a server drives no farther, nor for longer than 20 s. [decided: docs/decisions/0026]
inline constexpr int longest_leg_cm = 60;

struct SenderOptions {
  /// An idle so soon behind a word was under way before the robot heard it.
  base::Duration settle = std::chrono::milliseconds{300};
  /// Between two stops; besides, up to `jitter`, so that robots that share the radio do not keep step.
  base::Duration period = std::chrono::milliseconds{300};
  /// After `quick` of them more slowly: a robot that takes its time over a stop must come to say idle.
  base::Duration slow_period = std::chrono::milliseconds{700};
  unsigned quick = 10;
  base::Duration jitter = std::chrono::milliseconds{100};
  /// A robot that stands says idle each second: one that says none for so long is stopped first.
  base::Duration listen = std::chrono::milliseconds{1200};
  /// A robot that says idle but no update for so long is paused, or its updates are lost.
  base::Duration unseen = std::chrono::seconds{3};
};

/// What has become of what was asked for.
enum class Progress : std::uint8_t {
  none,     ///< nothing was asked, or a new handshake has made it void
  waiting,  ///< not said yet: the robot is not known to stand, or where
  said,     ///< nothing shows yet that it was heard
  heard,    ///< the robot has moved since
  reached,  ///< idle where it was sent
  ended,    ///< it has heard, and stands elsewhere: something stopped it
  stopping,
  stopped,  ///< idle: it stands
};

/// Nothing more will come of it by itself.
[[nodiscard]] constexpr bool is_final(Progress progress) noexcept {
  return progress == Progress::none || progress == Progress::reached || progress == Progress::ended ||
         progress == Progress::stopped;
}

class Sender {
 public:
  /// Kind::none: nothing is to be said now.
  struct Word {
    link::Kind kind = link::Kind::none;
    link::SetPoint set_point{};
  };

  constexpr explicit Sender(const SenderOptions& options = {}, std::uint32_t seed = 0) noexcept
      : options_(options), random_(seed * 2654435761U + 1) {}

  // --- what is asked for ---

  /// Turn, then drive, from where the robot is, or will have been stopped. {0, 0} is a stop.
  void go(const link::SetPoint& wanted, base::Time now) noexcept {
    if (wanted == link::SetPoint{}) return stop(now);
    wanted_ = wanted;
    legs_ = std::max(1, (std::abs(int{wanted.distance}) + longest_leg_cm - 1) / longest_leg_cm);
    times_said_ = corrections_ = 0;
    blocked_ = false;
    due_ = now + (standing_ ? base::Duration::zero() : options_.listen);
    since_ = now;
    progress_ = Progress::waiting;
  }
  void stop(base::Time now) noexcept {
    if (progress_ == Progress::stopping) return;
    times_said_ = 0;
    due_ = now;
    standing_ = placed_ = false;  // an idle from now on is the proof
    progress_ = Progress::stopping;
  }
  /// A handshake, or the end of a link: the robot stands, and knows of nothing. What was not said yet waits
  /// on.
  void restart() noexcept {
    if (progress_ != Progress::waiting) progress_ = Progress::none;
    standing_ = placed_ = pending_ = moving_ = false;
  }

  // --- what is heard of the robot ---

  /// True: it stands. False: the idle may be of before the last word.
  bool hear_idle(base::Time now) noexcept {
    if (moving_ || now - quiet_from_ < options_.settle) return false;
    if (!standing_) {
      standing_ = true;
      placed_ = false;
      since_ = now;
    }
    return true;
  }
  void hear_update(const link::Update& update, base::Time now) noexcept {
    place_ = {static_cast<float>(update.x), static_cast<float>(update.y), static_cast<float>(update.heading)};
    since_ = now;
    if (standing_) placed_ = true;
    if (progress_ == Progress::said && !moving_ && shows_hearing(place_)) progress_ = Progress::heard;
  }
  /// The last word has left: only now can the robot hear it.
  void out(base::Time now) noexcept {
    const bool overtaken = moving_ && progress_ == Progress::stopping;
    if (moving_) quiet_from_ = now;
    pending_ = moving_ = false;
    due_ = overtaken
               ? now
               : now + (times_said_ < options_.quick ? options_.period : options_.slow_period) + jitter();
  }
  /// Something else was said that the robot answers with an idle though it drives: a pause.
  void disturbed(base::Time now) noexcept { quiet_from_ = now; }

  // --- what is to be said ---

  /// To be called after each evidence, and each 50 ms. A word that was taken counts as on its way until
  /// `out`.
  [[nodiscard]] Word next(base::Time now) noexcept {
    if (progress_ == Progress::stopping) {
      if (standing_ && times_said_ != 0) {
        progress_ = Progress::stopped;
        return {};
      }
      return !pending_ && now >= due_ ? say({link::Kind::set_point, {}}) : Word{};
    }
    if (is_final(progress_) || pending_) return {};
    if (standing_ && placed_) return decide();
    if (now < due_) return {};
    if (standing_ && now - since_ >= options_.unseen) return say({link::Kind::unpause, {}});
    if (!standing_ && progress_ == Progress::waiting) return say({link::Kind::set_point, {}});
    return {};
  }

  [[nodiscard]] Progress progress() const noexcept { return progress_; }
  /// An idle came since the last set point. A handshake is none.
  [[nodiscard]] bool standing() const noexcept { return standing_; }
  /// And an update since: that is where it stands.
  [[nodiscard]] bool placed() const noexcept { return standing_ && placed_; }
  /// Of the stop or leg that is asked for, in all.
  [[nodiscard]] unsigned times_said() const noexcept { return times_said_; }
  /// It ended on its way, headed for the end of it: something in front of it stops a robot so.
  [[nodiscard]] bool blocked() const noexcept { return blocked_; }
  /// How far the robot stands from where it was to be; of `reached` and `ended`.
  [[nodiscard]] float off_cm() const noexcept { return distance(place_, aim_); }
  [[nodiscard]] float off_deg() const noexcept { return std::abs(turn(aim_.deg, place_.deg)); }

 private:
  /// In the robot's own frame: centimetres, degrees.
  struct Place {
    float x = 0;
    float y = 0;
    float deg = 0;
  };

  [[nodiscard]] static float turn(float from_deg, float to_deg) noexcept {
    return std::remainder(to_deg - from_deg, 360.0F);
  }
  [[nodiscard]] static float distance(const Place& a, const Place& b) noexcept {
    return std::hypot(a.x - b.x, a.y - b.y);
  }
  [[nodiscard]] static Place moved(const Place& from, const link::SetPoint& by) noexcept {
    constexpr float radians = 3.14159265F / 180.0F;
    const float deg = from.deg + static_cast<float>(by.angle);
    const auto way = static_cast<float>(by.distance);
    return {from.x + way * std::cos(deg * radians), from.y + way * std::sin(deg * radians), deg};
  }

  Word say(const Word& word) noexcept {
    pending_ = true;
    if (word.kind == link::Kind::set_point) ++times_said_;
    return word;
  }
  [[nodiscard]] base::Duration jitter() noexcept {
    random_ = random_ * 1664525U + 1013904223U;
    return options_.jitter * static_cast<std::int64_t>(random_ >> 16) / 65536;
  }

  /// The robot stands, and has said where.
  Word decide() noexcept {
    if (progress_ == Progress::waiting) return begin();
    if (there()) {
      corrections_ = 0;
      if (--legs_ != 0) return leg();
      progress_ = off_cm() <= near_cm ? Progress::reached : Progress::ended;
      return {};
    }
    if (!shows_hearing(place_)) return leg();  // not heard: once more, from here
    constexpr unsigned most_corrections = 3;   // of a leg that two copies of a word made another one
    blocked_ = on_the_way();
    if (blocked_ || ++corrections_ > most_corrections) {
      progress_ = Progress::ended;
      return {};
    }
    return leg();
  }
  Word begin() noexcept {
    times_said_ = 0;
    aim_ = moved(place_, wanted_);
    return leg();
  }
  /// The next part of the way, from here.
  Word leg() noexcept {
    if (progress_ != Progress::said) times_said_ = 0;
    leg_from_ = place_;
    leg_ = link::SetPoint{wanted_.angle, static_cast<std::int16_t>(wanted_.distance / legs_)};
    // As it was asked for, unless the robot is elsewhere: a whole degree is lost in each rounding.
    const bool first =
        distance(moved(place_, wanted_), aim_) < 0.5F && turn(place_.deg + asked_deg(), aim_.deg) == 0;
    if (!first) leg_ = remaining();
    leg_aim_ = moved(place_, leg_);
    progress_ = Progress::said;
    standing_ = placed_ = false;
    moving_ = true;
    return say({link::Kind::set_point, leg_});
  }
  [[nodiscard]] float asked_deg() const noexcept { return static_cast<float>(wanted_.angle); }
  /// Straight to the aim, while it is ahead; close to it, behind it, and on a turn the heading is what is
  /// left.
  [[nodiscard]] link::SetPoint remaining() const noexcept {
    constexpr float close_cm = 10, ahead_deg = 20, degrees = 180.0F / 3.14159265F;
    const float way = distance(place_, aim_);
    float angle = turn(place_.deg, aim_.deg);
    float along = 0;
    if (wanted_.distance != 0) {
      const Place ahead = moved({0, 0, aim_.deg}, {0, 1});
      along = (aim_.x - place_.x) * ahead.x + (aim_.y - place_.y) * ahead.y;
      const bool backwards = wanted_.distance < 0;
      const float bearing =
          std::atan2(aim_.y - place_.y, aim_.x - place_.x) * degrees + (backwards ? 180 : 0);
      if (way > close_cm && std::abs(turn(aim_.deg, bearing)) <= ahead_deg) {
        angle = turn(place_.deg, bearing);
        along = backwards ? -way : way;
      }
    }
    const float part =
        std::clamp(along / static_cast<float>(legs_), -float{longest_leg_cm}, float{longest_leg_cm});
    return {static_cast<std::int16_t>(std::lround(angle)), static_cast<std::int16_t>(std::lround(part))};
  }

  // --- what a place proves ---

  static constexpr float near_cm = 8, near_deg = 8;  ///< so near is there
  static constexpr float small_cm = 3, small_deg = 4;
  static constexpr float least_cm = 1.5F, least_deg = 2;  ///< what a robot itself takes for there

  [[nodiscard]] float leg_turn() const noexcept { return std::abs(turn(0, static_cast<float>(leg_.angle))); }
  [[nodiscard]] float leg_way() const noexcept { return std::abs(static_cast<float>(leg_.distance)); }
  /// At the end of the leg, and not still at its beginning: half of a short leg is not near enough.
  [[nodiscard]] bool there() const noexcept {
    const float off = distance(place_, leg_aim_), off_deg = std::abs(turn(leg_aim_.deg, place_.deg));
    if (off > near_cm || off_deg > near_deg) return false;
    if (leg_way() >= small_cm && off <= leg_way() / 2) return true;
    if (leg_turn() > small_deg && off_deg <= leg_turn() / 2) return true;
    if (off <= least_cm && off_deg <= least_deg) return true;
    return off <= small_cm && shows_hearing(place_);
  }
  /// A robot that stands does not get anywhere; its heading alone may follow its compass for a while.
  [[nodiscard]] bool shows_hearing(const Place& now) const noexcept {
    constexpr float moved_cm = 2, most_needed_deg = 15;
    if (distance(now, leg_from_) >= moved_cm) return true;
    const float turned = std::abs(turn(leg_from_.deg, now.deg));
    return leg_turn() > small_deg && turned >= std::min(leg_turn() / 2, most_needed_deg);
  }
  /// Between beginning and end of the leg, and headed there: as something in front of it leaves it.
  [[nodiscard]] bool on_the_way() const noexcept {
    constexpr float aside_cm = 8, aside_deg = 15;
    if (std::abs(turn(leg_aim_.deg, place_.deg)) > aside_deg || leg_way() < small_cm) return false;
    const float done = distance(place_, leg_from_), left = distance(place_, leg_aim_);
    return done + left <= leg_way() + aside_cm && left <= leg_way() + least_cm;
  }

  SenderOptions options_;
  link::SetPoint wanted_{};
  link::SetPoint leg_{};
  Place place_{};  ///< of the last update
  Place aim_{};
  Place leg_from_{};
  Place leg_aim_{};
  base::Time due_{};         ///< the next word, if it is said by the clock
  base::Time since_{};       ///< the last update, or the idle before which none came
  base::Time quiet_from_{};  ///< the last word behind which an idle proves nothing for a while
  std::uint32_t random_;
  unsigned times_said_ = 0;
  unsigned corrections_ = 0;
  int legs_ = 1;  ///< left, with this one
  Progress progress_ = Progress::none;
  bool blocked_ = false;
  bool standing_ = false;
  bool placed_ = false;
  bool pending_ = false;  ///< a word is on its way to the central
  bool moving_ = false;   ///< and it is one that makes the robot move
};

}  // namespace ocm::mapper::server
