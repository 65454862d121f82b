/// The last seconds of the bus, kept in memory, and written as a log when something went wrong: what led to a
/// fall-back. Bounded in memory and on the disk. What it keeps is on the disk, too, all but the last half
/// second: a run that is killed loses no more. In the order of time: a frame that was received is stamped by
/// the kernel or the bus, and may be read only after a later one was sent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/operate/spool.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli::operate {

struct BlackBoxOptions {
  std::string folder;  ///< empty: nothing is kept
  base::Duration lasting{10'000'000'000};
  std::uint32_t files = 20;  ///< the oldest are deleted, those of runs before first
};

class BlackBox {
 public:
  /// More frames than 1 Mbit/s has in 10 s.
  static constexpr std::size_t most_entries = 250'000;
  /// How long after a later entry an earlier one still finds its place.
  static constexpr base::Duration settling{100'000'000};

  /// Leaves through cli::fail if the folder cannot be made. `name` is the operator's. The catalogue must
  /// outlive it.
  BlackBox(BlackBoxOptions options, std::string name, std::string bus, const protocol::Catalogue& catalogue);

  [[nodiscard]] bool keeps() const noexcept { return !options_.folder.empty(); }
  void add(const log::Entry& entry, Clock::time_point now);

  /// What a run before has left that was killed, if one was. Leaves if that run goes on.
  [[nodiscard]] Spool::Recovered recover(base::Time wall);

  /// What is older than `settling` and was not taken before, for `spool`.
  [[nodiscard]] std::vector<log::Entry> take_fresh(base::Time wall);
  /// On one thread, which may be another one.
  [[nodiscard]] transport::Outcome<void> spool(std::span<const log::Entry> entries) {
    return spool_.append(entries, interfaces_);
  }
  /// The run ends by itself. On the same thread, or when that has ended.
  void end();

  /// What is in it, to be written by `write`, on any thread.
  struct Recording {
    std::string path;
    std::deque<log::Entry> entries;
  };
  /// Takes all that there is: the next recording begins behind it.
  [[nodiscard]] Recording take(Clock::time_point now, base::Time wall);
  /// Writes a recording as a candump log, then deletes the oldest of this operator's beyond `files`. On the
  /// thread of `spool`.
  [[nodiscard]] transport::Outcome<void> write(const Recording& recording);
  /// Frames that there was no room for in memory.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  struct Kept {
    Clock::time_point at;
    log::Entry entry;
  };
  void forget(Clock::time_point now);
  [[nodiscard]] std::string path(base::Time wall, std::string_view what = {}) const;
  void delete_oldest();

  BlackBoxOptions options_;
  std::string name_;
  const protocol::Catalogue* catalogue_;
  log::Interfaces interfaces_;
  std::deque<Kept> kept_;
  std::vector<log::Entry> fresh_;
  Spool spool_;
  /// Of this run, in the order in which they were kept. Names and times of files are by a wall clock that may
  /// be set, and begins in the past on a machine whose clock has no battery.
  std::vector<std::string> of_this_run_;
  std::uint64_t dropped_ = 0;
};

}  // namespace ocm::cli::operate
