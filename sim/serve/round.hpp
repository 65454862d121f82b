/// One round of a simulator's loop: what is due, for as long as others can wait. A simulator that has more to
/// do than its machine does in the time would hear neither its clients nor Ctrl-C again.
///
///     Round round{now};
///     for (base::Time next; round.takes(next = next_event());) { ... what is due at `next` ... }
///     server.poll(round.reached(), hear);
///     lateness.note(round, clock);
///
/// Nothing is left out: what a round does not reach is for the next one, and the simulated time is late.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <string_view>

#include <fmt/format.h>

#include "ocm/base/time.hpp"

#include "sim/serve/clock.hpp"

namespace ocm::sim {

class Round {
 public:
  /// Decided: a signal is heard at once, as far as a person sees.
  static constexpr std::chrono::milliseconds longest{50};

  explicit Round(base::Time until)
      : until_(until), reached_(until), end_(std::chrono::steady_clock::now() + longest) {}

  /// Whether what is due at `next` belongs to this round. It is carried out before the next call.
  [[nodiscard]] bool takes(base::Time next) {
    constexpr unsigned between_looks = 64;
    if (next > until_) {
      reached_ = until_;
      return false;
    }
    // Not before something was done, or there would be no progress.
    if (++events_ % between_looks == 0 && std::chrono::steady_clock::now() >= end_) return false;
    reached_ = next;
    return true;
  }
  /// The time that the simulation has come to; less than it should have, if the round was cut short.
  [[nodiscard]] base::Time reached() const noexcept { return reached_; }

 private:
  base::Time until_;
  base::Time reached_;
  std::chrono::steady_clock::time_point end_;
  unsigned events_ = 0;
};

/// How late a simulation is; reports once when it cannot keep up.
class Lateness {
 public:
  /// Decided: seldom by a busy machine, soon where it will never be better.
  static constexpr base::Duration worth_a_line = std::chrono::seconds{1};

  /// In a row. A program that was stopped for a while (Ctrl-Z) has caught up before.
  static constexpr unsigned enough_rounds = 10;

  explicit Lateness(std::function<void(std::string_view)> report) : report_(std::move(report)) {}

  void note(const Round& round, const SimulatedClock& clock) {
    now_ = clock.behind(round.reached());
    late_rounds_ = now_ < worth_a_line ? 0 : late_rounds_ + 1;
    if (late_rounds_ < enough_rounds || is_said_) return;
    is_said_ = true;
    report_(
        "the simulation is late: more is due than this machine can do; its times are right, but it is slower "
        "than they say. Are all periods of the spec right, and is --speed too high?");
  }
  /// At the end.
  void sum_up() const {
    if (is_said_ && now_ >= worth_a_line)
      report_(fmt::format("late              by {:.1f} s at the end: what was due then was not sent",
                          std::chrono::duration<double>(now_).count()));
  }

 private:
  std::function<void(std::string_view)> report_;
  base::Duration now_{};
  unsigned late_rounds_ = 0;
  bool is_said_ = false;
};

}  // namespace ocm::sim
