/// The machine that a part of the tool runs on in these tests: its time, its signals and its disk. All of it
/// is made of a seed, so that a run that fails can be repeated. world.cpp links in the places of
/// cli/shared/clock.cpp and cli/shared/interrupt.cpp: time passes when the code under test waits or looks at
/// the clock, and at no other time.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"

#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"

namespace ocm::test {

using namespace std::chrono_literals;
using base::Duration;
using Moment = cli::Clock::time_point;

class World {
 public:
  explicit World(std::uint64_t seed);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// The one of this run.
  [[nodiscard]] static World& now_running();

  // What a run is made of, before it begins:
  /// The program does not run for so long: SIGSTOP and SIGCONT, or a machine that sleeps.
  void stop(Moment at, Duration lasting) { stops_.push_back({at, lasting}); }
  /// The wall clock is set.
  void set_wall_clock(Moment at, Duration by) { steps_.push_back({at, by}); }
  void interrupt(Moment at, int signal) {
    signal_at_ = at;
    signal_ = signal;
  }
  /// What else runs: called with the time whenever some has passed, before the code under test goes on.
  std::function<void()> beside;
  /// When something can be read from a descriptor; Moment::max(): never.
  std::map<int, std::function<Moment()>> inputs;
  /// Takes what is written to a file; how much it takes, and why not more.
  std::function<cli::Written(int descriptor, std::string_view text)> disk;

  // Chance:
  [[nodiscard]] bool chance(double probability) {
    return std::uniform_real_distribution<>{}(random) < probability;
  }
  template <std::integral T>
  [[nodiscard]] T between(T least, T most) {
    return static_cast<T>(std::uniform_int_distribution<std::int64_t>{
        static_cast<std::int64_t>(least), static_cast<std::int64_t>(most)}(random));
  }
  [[nodiscard]] Duration between(Duration least, Duration most) {
    return Duration{between<std::int64_t>(least.count(), most.count())};
  }
  std::mt19937_64 random;

  // Time:
  [[nodiscard]] Moment now() const { return now_; }
  [[nodiscard]] base::Time wall_at(Moment time) const;
  /// Until `time`, or until a signal comes that was not there before; later, if the program is stopped
  /// meanwhile.
  void wait_until(Moment time);
  void pass(Duration duration) { wait_until(now_ + duration); }
  /// A signal that the program has seen, or would see now.
  [[nodiscard]] int signal() const { return now_ >= signal_at_ ? signal_ : 0; }
  [[nodiscard]] Moment signal_at() const { return signal_at_; }
  /// Whether the program was stopped for that long, or longer, within the time from `begin` to `end`.
  [[nodiscard]] bool was_stopped(Moment begin, Moment end, Duration least) const;

  static constexpr Moment start{std::chrono::hours{5}};

 private:
  struct Stop {
    Moment at;
    Duration lasting;
  };
  struct Step {
    Moment at;
    Duration by;
  };
  void go_to(Moment time);

  Moment now_ = start;
  Moment signal_at_ = Moment::max();
  int signal_ = 0;
  std::vector<Stop> stops_;
  std::vector<Stop> past_;
  std::vector<Step> steps_;
  bool beside_runs_ = false;
  World* before_;
};

/// What the code under test said on stderr is thrown away while one lives.
class Silence {
 public:
  Silence();
  ~Silence();
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  int stderr_ = -1;
};

}  // namespace ocm::test
