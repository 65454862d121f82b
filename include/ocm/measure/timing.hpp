/// How regularly the samples of one topic come: rate, jitter, gaps, missing samples. Times are those of the
/// bus, one after another; all distances count, not a window of the newest. A request begins a new stretch:
/// the distance across it is no fault and in no figure.
///
/// Pure: reads no clock, allocates nothing; about 250 bytes a stream and O(1) a sample. Times that go back
/// begin a new stretch, too, and are counted.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"

namespace ocm::measure {

/// Where the period comes from that missing samples and lateness are measured by.
enum class PeriodFrom : std::uint8_t {
  nothing,   ///< there is none: neither is measured
  request,   ///< an operator asked for it
  spec,      ///< no request came; the topic's usual period, which the samples have, or that of a message
  measured,  ///< no request came; the median of the first distances
};

/// The figures of a stream. Durations are in nanoseconds.
struct Timing {
  std::uint64_t count = 0;      ///< samples
  std::uint64_t distances = 0;  ///< between two samples of one stretch; without any, no rate and no jitter
  double rate_hz = 0;           ///< distances by the time they take together
  double mean_ns = 0;           ///< of the distances
  double jitter_ns = 0;         ///< their standard deviation, each from the mean of its stretch
  std::int64_t spread_ns = 0;   ///< longest less shortest of a stretch, where that is greatest
  /// Between the earliest and the latest sample against the grid of the period, within 100 samples at most:
  /// so clocks that differ by 100 ppm make it wrong by 1 % of the period. 0 for a measured period.
  std::int64_t lateness_ns = 0;
  std::int64_t gap_ns = 0;  ///< longest time without a sample where samples were due
  base::Time gap_from{};    ///< when it began
  std::uint64_t missing = 0;
  std::uint64_t backwards = 0;  ///< samples older than the one before
  std::int64_t period_ns = 0;   ///< the newest, also when it was stopped since; 0: none
  PeriodFrom period_from = PeriodFrom::nothing;
  /// Samples come clearly more often than the stated period: on events, too, or from several senders. Then
  /// they have no lateness.
  bool faster = false;
  bool due = false;    ///< samples are to come, every period: they were asked for, or have come so
  base::Time since{};  ///< the last sample, or the request if that is newer
};

namespace detail {

/// `distance` in whole periods, rounded half up. `period` is above zero.
[[nodiscard]] constexpr std::int64_t periods_in(std::int64_t distance, std::int64_t period) noexcept {
  return distance / period + (distance % period >= period - period / 2 ? 1 : 0);
}

/// Mean, deviation and spread in one pass. [Welford 1962]
class Distances {
 public:
  void add(std::int64_t distance) noexcept {
    ++count_;
    sum_ += static_cast<double>(distance);
    if (++here_ == 1) shortest_ = longest_ = distance;
    shortest_ = std::min(shortest_, distance);
    longest_ = std::max(longest_, distance);
    const double off = static_cast<double>(distance) - mean_;
    mean_ += off / static_cast<double>(here_);
    squares_ += off * (static_cast<double>(distance) - mean_);
    spread_ = std::max(spread_, longest_ - shortest_);
  }
  void end_stretch() noexcept { here_ = 0; }
  void into(Timing& timing) const noexcept {
    timing.distances = count_;
    if (count_ == 0) return;
    timing.mean_ns = sum_ / static_cast<double>(count_);
    timing.rate_hz = sum_ > 0 ? static_cast<double>(count_) * 1e9 / sum_ : 0;
    timing.jitter_ns = std::sqrt(squares_ / static_cast<double>(count_));
    timing.spread_ns = spread_;
  }

 private:
  std::uint64_t count_ = 0;
  double sum_ = 0;
  double squares_ = 0;  // of what the distances are off their stretch's mean
  std::int64_t spread_ = 0;
  std::uint64_t here_ = 0;  // in this stretch
  double mean_ = 0;
  std::int64_t shortest_ = 0;
  std::int64_t longest_ = 0;
};

/// Distances against a period. One of more than one and a half periods means that samples are missing, or
/// that one came late: then those after it come early, and make up for it.
class Grid {
 public:
  void start(std::int64_t period) noexcept {
    settle();
    period_ = period;
    begin_window();
  }
  void add(std::int64_t distance) noexcept {
    if (period_ <= 0) return;
    if (owed_ > 0 && distance <= period_ / 2) {  // half a period late counts as one owed: it is rounded up
      --owed_;
      caught_up_ += distance - period_;
      return;
    }
    settle();
    const std::int64_t periods = periods_in(distance, period_);
    if (periods <= 1) return step(distance - period_);
    owed_ = periods - 1;
    behind_by_ = distance - period_;
  }
  /// Nothing came for so long, and nothing will.
  void silence(std::int64_t time) noexcept {
    if (period_ > 0)
      missing_ += static_cast<std::uint64_t>(std::max<std::int64_t>(periods_in(time, period_) - 1, 0));
  }
  /// What was a late sample a moment ago is now a missing one: nothing came to make up for it.
  void settle() noexcept {
    if (behind_by_ == 0) return;
    missing_ += static_cast<std::uint64_t>(owed_);
    if (owed_ > 1)
      begin_window();  // a pause: the grid behind it is another
    else
      step(behind_by_ - owed_ * period_);
    if (caught_up_ != 0) step(caught_up_);
    owed_ = behind_by_ = caught_up_ = 0;
  }
  [[nodiscard]] std::uint64_t missing() const noexcept { return missing_; }
  [[nodiscard]] std::int64_t lateness() const noexcept { return lateness_; }

 private:
  static constexpr std::size_t window = 100;

  void begin_window() noexcept { off_ = earliest_ = latest_ = 0, in_window_ = 0; }
  void step(std::int64_t off_by) noexcept {
    if (++in_window_ >= window) return begin_window();
    off_ += off_by;
    earliest_ = std::min(earliest_, off_);
    latest_ = std::max(latest_, off_);
    lateness_ = std::max(lateness_, latest_ - earliest_);
  }

  std::int64_t period_ = 0;
  std::int64_t off_ = 0;  // the grid that the first of the window starts
  std::int64_t earliest_ = 0;
  std::int64_t latest_ = 0;
  std::size_t in_window_ = 0;
  std::int64_t owed_ = 0;       // samples that are missing, if none comes early
  std::int64_t behind_by_ = 0;  // of the sample after them, if none is missing
  std::int64_t caught_up_ = 0;
  std::uint64_t missing_ = 0;
  std::int64_t lateness_ = 0;
};

}  // namespace detail

/// What the spec's period is where no request came.
enum class Usual : std::uint8_t {
  if_seen,  ///< a topic's, which may have been asked for before the log began: the period if samples have it
  stated,   ///< a message's: the period, however the samples come
};

class Stream {
 public:
  Stream() = default;
  /// `usual` is the spec's period; zero: the stream has no period.
  explicit Stream(base::Duration usual, Usual is = Usual::if_seen) noexcept
      : usual_(usual.count()), learns_(usual.count() > 0), stated_(learns_ && is == Usual::stated) {
    if (!stated_) return;
    period_ = usual_;
    from_ = PeriodFrom::spec;
    due_ = true;
    grid_.start(period_);
  }

  void sample(base::Time time) noexcept {
    ++count_;
    const std::int64_t distance = (time - since_).count();
    if (state_ != State::idle && distance < 0) {
      ++backwards_;
      begin(State::idle);
    }
    if (state_ == State::asked) silence(distance);
    if (state_ == State::runs) {
      note_gap(distance);
      distances_.add(distance);
      if (learns_)
        learn(distance);
      else
        grid_.add(distance);
    }
    state_ = State::runs;
    since_ = time;
  }
  /// A request to publish every `period` came.
  void asked(base::Time time, base::Duration period) noexcept {
    end(time);
    period_ = period.count();
    from_ = PeriodFrom::request;
    due_ = true;
    learns_ = false;
    grid_.start(period_);
    begin(State::asked);
    since_ = time;
  }
  /// A request came to stop, or for one sample, which stops as well.
  void stopped(base::Time time) noexcept {
    end(time);
    due_ = false;
    learns_ = false;
    grid_.start(0);
    begin(State::idle);
  }
  /// As of `now`: what is due and did not come counts.
  [[nodiscard]] Timing timing(base::Time now) const noexcept {
    Stream ended = *this;
    ended.end(now);
    Timing timing;
    timing.count = count_;
    ended.distances_.into(timing);
    // A period that was measured is not exact enough to lay a grid by.
    if (ended.from_ != PeriodFrom::measured && !ended.faster_) timing.lateness_ns = ended.grid_.lateness();
    timing.faster = ended.faster_;
    timing.missing = ended.grid_.missing();
    timing.gap_ns = ended.gap_;
    timing.gap_from = ended.gap_from_;
    timing.backwards = backwards_;
    timing.period_ns = ended.period_;
    timing.period_from = ended.from_;
    timing.due = ended.due_ && ended.state_ != State::idle;
    timing.since = since_;
    return timing;
  }

 private:
  enum class State : std::uint8_t {
    idle,   // nothing is expected, or not known yet
    asked,  // a request came, and no sample after it
    runs,
  };
  static constexpr std::size_t first_distances = 9;

  void begin(State state) noexcept {
    state_ = state;
    distances_.end_stretch();
  }
  void end(base::Time time) noexcept {
    if (learns_ && learned_ > 0) decide();
    grid_.settle();
    if (state_ != State::idle && due_) silence((time - since_).count());
  }
  void silence(std::int64_t time) noexcept {
    if (time < 0) return;
    note_gap(time);
    grid_.silence(time);
  }
  void note_gap(std::int64_t distance) noexcept {
    if (distance <= gap_) return;
    gap_ = distance;
    gap_from_ = since_;
  }
  /// No request, so the first distances have to say what the period is; of a stated one, how they compare.
  void learn(std::int64_t distance) noexcept {
    early_[learned_++] = distance;
    if (learned_ == first_distances) decide();
  }
  void decide() noexcept {
    auto sorted = early_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>((learned_ - 1) / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(learned_));
    const std::int64_t off = *middle > usual_ ? *middle - usual_ : usual_ - *middle;
    faster_ = stated_ && *middle < usual_ - usual_ / 4;
    const bool as_usual = stated_ || off <= usual_ / 4;
    period_ = as_usual ? usual_ : *middle;
    from_ = as_usual ? PeriodFrom::spec : period_ > 0 ? PeriodFrom::measured : PeriodFrom::nothing;
    due_ = true;
    learns_ = false;
    grid_.start(period_);
    for (std::size_t i = 0; i < learned_; ++i) grid_.add(early_[i]);
  }

  State state_ = State::idle;
  std::uint64_t count_ = 0;
  std::uint64_t backwards_ = 0;
  base::Time since_{};  // the last sample, or the request if that is newer
  detail::Distances distances_;
  detail::Grid grid_;
  std::int64_t gap_ = 0;
  base::Time gap_from_{};
  std::int64_t usual_ = 0;
  std::int64_t period_ = 0;
  PeriodFrom from_ = PeriodFrom::nothing;
  bool due_ = false;  // samples, every period
  bool learns_ = false;
  bool stated_ = false;
  bool faster_ = false;
  std::array<std::int64_t, first_distances> early_{};
  std::size_t learned_ = 0;
};

}  // namespace ocm::measure
