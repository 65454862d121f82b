/// Gets the order to calibrate its compass to a robot whose radio loses packets, and knows what has become of
/// it. Each word has a number, and a robot begins only with one that is new, so a word is said again until
/// the robot answers: copies of it only ask. [docs/decisions/0029]
///
/// - It is asked first: that gives the number of the last calibration, and shows that it knows the sentence.
/// - The next number begins. A robot that turns says so each second; one that was not heard for a while is
///   asked.
/// - A calibration that was taken is being stored when the robot says how it ended: it is asked for a moment
///   longer, until it is.
///
/// Evidence and time go in, words come out; one robot. No heap, no clock, no I/O; O(1) a call; 40 bytes.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "ocm/base/time.hpp"
#include "ocm/mapper/link/sentence.hpp"

namespace ocm::mapper::server {

class Calibrator {
 public:
  enum class Phase : std::uint8_t {
    none,      ///< nothing was asked, or a new handshake or a stop has made it void
    asking,    ///< nothing heard yet: the robot may not know the sentence
    ordering,  ///< it is there, and has not begun
    turning,
    storing,  ///< it has ended, and was not stored yet
    done,     ///< `result` is how it ended
  };

  /// Between two words.
  static constexpr base::Duration period = std::chrono::milliseconds{700};
  /// A robot that turns says so each second: one that says nothing for so long is asked.
  static constexpr base::Duration listen = std::chrono::milliseconds{1500};
  /// From the end of a calibration until it must be stored: writing takes some 50 ms.
  static constexpr base::Duration storing = std::chrono::seconds{4};

  /// Turn around once. `only_ask`: say how the last one ended.
  constexpr void begin(base::Time now, bool only_ask = false) noexcept {
    *this = {};
    phase_ = Phase::asking;
    only_ask_ = only_ask;
    due_ = now;
  }
  /// A handshake, the end of a link, a stop: the robot does not turn any more.
  constexpr void restart() noexcept { phase_ = Phase::none; }

  constexpr void hear(const link::Calibration& said, base::Time now) noexcept {
    if (phase_ == Phase::none || phase_ == Phase::done) return;
    const bool turns = said.verdict == link::Calibration::turning;
    if (phase_ == Phase::asking) {
      number_ = said.number;
      if (only_ask_) return finish(said);
      if (!turns) {  // else another program has begun one: that will do
        number_ = static_cast<std::int16_t>(said.number % link::Calibrate::fields[0].max + 1);
        phase_ = Phase::ordering;
        due_ = now;
        return;
      }
    }
    if (said.number != number_) return;  // of before the order
    if (turns) {
      phase_ = Phase::turning;
      due_ = now + listen;
      return;
    }
    if (phase_ != Phase::storing) stored_by_ = now + storing;
    const bool taken = said.verdict == link::Calibration::good || said.verdict == link::Calibration::poor;
    if (!taken || said.use != link::Calibration::until_off || now >= stored_by_) return finish(said);
    phase_ = Phase::storing;
    result_ = said;
    due_ = now + period / 2;
  }

  /// To be called after each evidence, and each 50 ms.
  [[nodiscard]] constexpr std::optional<link::Calibrate> next(base::Time now) noexcept {
    if (phase_ == Phase::storing && now >= stored_by_ + storing) phase_ = Phase::done;
    if (phase_ == Phase::none || phase_ == Phase::done || now < due_) return std::nullopt;
    due_ = now + period;
    ++times_said_;
    return link::Calibrate{phase_ == Phase::asking ? std::int16_t{0} : number_};
  }

  [[nodiscard]] constexpr Phase phase() const noexcept { return phase_; }
  /// The robot may turn: it got the sentence, and has not said how that ended.
  [[nodiscard]] constexpr bool may_turn() const noexcept {
    return phase_ == Phase::ordering || phase_ == Phase::turning;
  }
  /// In `done`.
  [[nodiscard]] constexpr const link::Calibration& result() const noexcept { return result_; }
  [[nodiscard]] constexpr unsigned times_said() const noexcept { return times_said_; }

 private:
  constexpr void finish(const link::Calibration& said) noexcept {
    result_ = said;
    phase_ = Phase::done;
  }

  link::Calibration result_{};
  base::Time due_{};
  base::Time stored_by_{};
  unsigned times_said_ = 0;
  std::int16_t number_ = 0;
  Phase phase_ = Phase::none;
  bool only_ask_ = false;
};

}  // namespace ocm::mapper::server
