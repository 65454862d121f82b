// The seconds, the ends and the losses of a bus that is listened to.
#include "cli/watch/listening.hpp"

#include <vector>

#include "tests/tool/clock/played_bus.hpp"

namespace tool_clock_listening_test {

using namespace ocm;
using namespace ocm::test;
using cli::Over;

struct Heard {
  Over over = Over::signal;
  std::size_t frames = 0;
  std::vector<std::uint64_t> lost;
  std::vector<std::int64_t> seconds;  ///< when each was over, in ms from the start
  std::int64_t end = 0;               ///< in ms
};

Heard listen(World& world, PlayedBus::Conditions conditions, const cli::ListenLimits& limits) {
  PlayedBus bus{world, std::move(conditions)};
  Heard heard;
  const auto ms = [&world] { return (world.now() - World::start) / 1ms; };
  heard.over = cli::listen(
      bus, limits,
      [&](auto entries, const auto& interfaces) {
        heard.frames += entries.size();
        CHECK(interfaces.name(entries.front().interface) == "can0");
      },
      [&](auto name, auto frames) {
        CHECK(name == "can0");
        heard.lost.push_back(frames);
      },
      [&] { heard.seconds.push_back(ms()); });
  heard.end = ms();
  return heard;
}

using Times = std::vector<std::int64_t>;

TEST_CASE("listening: each second is said when it is over, up to the end of the time") {
  World world{1};
  const Heard heard = listen(world, {}, {3500ms});
  CHECK(heard.over == Over::time);
  CHECK(heard.seconds == Times{1000, 2000, 3000});
  CHECK(heard.end == 3500);
  CHECK(heard.frames == 0);
  CHECK(heard.lost.empty());
}

TEST_CASE(
    "listening: seconds in which this program did not run are one, and the next is no sooner than half "
    "a second later") {
  const auto stopped = [](Duration lasting) {
    World world{1};
    world.stop(World::start + 900ms, lasting);
    return listen(world, {}, {3900ms}).seconds;
  };
  CHECK(stopped(50ms) == Times{1000, 2000, 3000});
  CHECK(stopped(550ms) == Times{1450, 2000, 3000});
  CHECK(stopped(650ms) == Times{1550, 2550, 3550});
  CHECK(stopped(1900ms) == Times{2800, 3800});
}

TEST_CASE("listening: so many frames are enough, and each is taken") {
  World world{1};
  PlayedBus::Conditions conditions;
  for (int i = 1; i <= 5; ++i) conditions.incoming.push_back({World::start + i * 100ms, {0x601, 8, {}}});
  const Heard heard = listen(world, std::move(conditions), {{}, 3});
  CHECK(heard.over == Over::enough);
  CHECK(heard.frames == 3);
  CHECK(heard.end == 300);
}

TEST_CASE("listening: what was lost is said once") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.listens_to = 2;
  world.stop(World::start + 90ms, 200ms);
  world.stop(World::start + 1500ms, 200ms);
  for (const int at : {100, 110, 120, 130, 140, 1550, 1560, 1570})
    conditions.incoming.push_back({World::start + at * 1ms, {0x601, 8, {}}});
  const Heard heard = listen(world, std::move(conditions), {3500ms});
  CHECK(heard.frames == 4);
  CHECK(heard.lost == std::vector<std::uint64_t>{3, 1});
}

TEST_CASE("listening: a signal and a bus that is gone are ends") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.gone = World::start + 700ms;
  const Heard gone = listen(world, std::move(conditions), {});
  CHECK(gone.over == Over::gone);
  CHECK(gone.end == 700);
  world.interrupt(world.now() + 500ms, 2);
  const Heard ended = listen(world, {}, {});
  CHECK(ended.over == Over::signal);
  CHECK(ended.end == 1200);
}

}  // namespace tool_clock_listening_test
