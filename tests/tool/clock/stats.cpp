// What stats and plot see of a live bus, on a bus and a clock that are made of a seed: stops of the program,
// a queue that overflows, a bus that goes away, signals. Every frame is taken or counted as lost.
#include <csignal>

#include "ocm/topics/amiro.hpp"

#include "cli/shared/clock.hpp"
#include "cli/stats/figures.hpp"
#include "cli/watch/listening.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/unit/base/explore.hpp"

namespace tool_clock_stats_test {

using namespace ocm;
using namespace ocm::test;
using cli::Over;

class Run {
 public:
  explicit Run(std::uint64_t seed) : world_(seed) {
    const auto sometime = [this] { return World::start + world_.between(0s, 8s); };
    Moment at = World::start;
    for (auto frames = world_.between(0, 800); frames > 0; --frames) {
      at += world_.chance(0.01) ? world_.between(0s, 2s) : world_.between(50us, 5ms);
      can::Frame frame{0x601, 8, {}};
      conditions_.incoming.push_back({at, frame});
    }
    conditions_.listens_to = world_.between<std::size_t>(1, 300);
    if (world_.chance(0.1)) conditions_.gone = sometime();
    while (world_.chance(0.4)) {
      stopped_ = true;
      world_.stop(sometime(), world_.between(1ms, 5s));
    }
    while (world_.chance(0.3)) world_.set_wall_clock(sometime(), world_.between(-3s, 3s));
    if (world_.chance(0.3)) world_.interrupt(sometime(), SIGINT);
    limits_.duration = world_.between(1ms, 8s);
    if (world_.chance(0.3)) limits_.count = world_.between<std::uint64_t>(1, 800);
  }

  void go() {
    PlayedBus bus{world_, conditions_};
    cli::stats::Collector collector{amiro::catalogue, [](std::string_view) {
                                      return measure::BitRates{500'000, 0};
                                    }};
    std::uint64_t taken = 0, lost = 0, seconds = 0;
    Moment last_second = World::start;
    bool bunched = false;
    const Over over = cli::listen(
        bus, limits_,
        [&](auto entries, const auto& interfaces) {
          collector.take(entries, interfaces);
          taken += entries.size();
        },
        [&](auto name, auto frames) {
          collector.lost(name, frames);
          lost += frames;
        },
        [&] {
          ++seconds;
          bunched = bunched || (seconds > 1 && world_.now() - last_second < 500ms);
          last_second = world_.now();
        });
    const Duration passed = world_.now() - World::start;
    const auto& counters = bus.counters();
    CHECK(taken == counters.received);
    CHECK(lost == counters.lost);
    CHECK_FALSE(bunched);
    CHECK(seconds <= static_cast<std::uint64_t>(passed / 1s));
    if (!stopped_) CHECK(seconds + 1 >= static_cast<std::uint64_t>(passed / 1s));
    if (over == Over::enough) CHECK(taken == limits_.count);
    if (over == Over::time) CHECK(passed >= *limits_.duration);
    if (over == Over::signal) CHECK(world_.signal() != 0);
    if (over == Over::gone) CHECK(world_.now() >= conditions_.gone);
    if (!stopped_) CHECK(passed <= *limits_.duration + 10ms);
    const auto buses = collector.buses();
    std::uint64_t frames = 0, drops = 0;
    for (const auto& each : buses) {
      frames += each.figures.counters.frames;
      drops += each.drops;
    }
    CHECK(frames == taken);
    CHECK(drops == lost);
  }

 private:
  World world_;
  PlayedBus::Conditions conditions_;
  cli::ListenLimits limits_;
  bool stopped_ = false;
};

TEST_CASE("stats: a step of the wall clock is no silence") {
  World world{1};
  const cli::ListenedUntil listened;
  const base::Time begin = cli::unix_time();
  world.set_wall_clock(World::start + 1s, 1h);
  world.set_wall_clock(World::start + 3s, -2h);
  const auto is_near = [](base::Time a, base::Time b) {
    return a - b < 1ms && b - a < 1ms;
  };  // looks take time
  world.pass(500ms);
  CHECK(is_near(listened.now(), begin + 500ms));
  world.pass(1500ms);
  CHECK(is_near(cli::unix_time(), begin + 1h + 2s));
  CHECK(is_near(listened.now(), begin + 2s));
  world.pass(2s);
  CHECK(is_near(listened.now(), begin - 1h + 4s));  // as the frames that come now
}

TEST_CASE("stats: whatever happens to program and bus, each frame is in the figures or counted as lost") {
  const auto runs = static_cast<std::uint64_t>(explored(1500));
  const Silence silence;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    INFO("seed " << seed);
    Run{seed}.go();
  }
}

}  // namespace tool_clock_stats_test
