/// What was measured of a message: how far behind the grid of its period its frames came. A response time is
/// measured from below: within each run of 100 releases the earliest frame tells where the grid lies at the
/// latest, and the latest one how far behind it a frame came.
///
/// Set points that are held have a grid a run: what a person changes is sent at once and repeated from there,
/// so that a frame that comes early begins another grid, as does the first one behind rest or a pause.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace ocm::cli::analyse {

/// The times of frames are no finer: candump writes microseconds.
inline constexpr std::int64_t time_resolution = 1000;

/// Where the releases of a message are.
enum class Grid : std::uint8_t {
  of_sender,  ///< its sender's clock releases it every period
  of_run,     ///< a set point that is held: every period since it was changed
  none,       ///< it is sent on events: nothing is behind anything
};

/// Times are nanoseconds.
struct Measured {
  std::size_t count = 0;
  std::int64_t shortest = 0;  ///< distance of two frames; 0 with less than two
  std::int64_t longest = 0;
  std::int64_t mean = 0;
  std::int64_t lateness = 0;     ///< behind the grid of its period, at most
  std::int64_t response = 0;     ///< the longest was at least this
  unsigned greatest_length = 0;  ///< bytes
  bool other_period = false;     ///< than assumed, so that lateness and response mean nothing
  bool exceeds = false;          ///< its bound
};

/// Of the frames of one message, as they come. O(1) a frame.
class Meter {
 public:
  /// Releases of a run: clocks that drift apart by 100 ppm make 1 % of a period in so many.
  static constexpr std::size_t window = 100;

  /// `takes`: the frame, nanoseconds. `rests`: a set point that ends its run.
  void add(std::int64_t time, unsigned length, std::int64_t takes, std::int64_t period,
           Grid grid = Grid::of_sender, bool rests = false) {
    measured_.greatest_length = std::max(measured_.greatest_length, length);
    least_time_ = measured_.count == 0 ? takes : std::min(least_time_, takes);
    if (measured_.count == 0) {
      first_ = time;
      restart();
    } else {
      const std::int64_t distance = time - last_;
      measured_.shortest = measured_.count == 1 ? distance : std::min(measured_.shortest, distance);
      measured_.longest = std::max(measured_.longest, distance);
      // A pause of several periods is one of the sender, or lost frames: the grid goes on behind it.
      const bool skips_one = distance > period && distance - period >= period - period / 2;
      const bool pause = skips_one && distance - period - period / 2 >= period;
      const bool other_run = grid == Grid::of_run && (rested_ || skips_one);
      const std::int64_t behind = behind_ + distance - period - (skips_one ? period : 0);
      const bool other_grid = grid == Grid::none || (grid == Grid::of_run && behind < 0);
      if (pause || other_run || other_grid || ++in_window_ >= window) {
        restart();
      } else {
        behind_ = behind;
        earliest_ = std::min(earliest_, behind_);
        latest_ = std::max(latest_, behind_);
        measured_.lateness = std::max(measured_.lateness, latest_ - earliest_);
      }
    }
    last_ = time;
    rested_ = rests;
    ++measured_.count;
  }
  [[nodiscard]] Measured finish() const {
    Measured result = measured_;
    if (result.count > 1) result.mean = (last_ - first_) / static_cast<std::int64_t>(result.count - 1);
    if (result.count > 0) result.response = result.lateness + least_time_;
    return result;
  }

 private:
  void restart() {
    behind_ = earliest_ = latest_ = 0;
    in_window_ = 0;
  }
  Measured measured_;
  std::int64_t least_time_ = 0;
  std::int64_t first_ = 0;
  std::int64_t last_ = 0;
  std::int64_t behind_ = 0;  ///< the grid that the first of the window starts
  std::int64_t earliest_ = 0;
  std::int64_t latest_ = 0;
  std::size_t in_window_ = 0;
  bool rested_ = false;  ///< the last set point ended its run
};

}  // namespace ocm::cli::analyse
