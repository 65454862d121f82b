// How long a verb listens for refusals, and what it makes of them.
#include "cli/command/refusal_watch.hpp"

#include <string>
#include <vector>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/typed_frames.hpp"

namespace tool_clock_refusal_watch_test {

using namespace ocm;
using namespace ocm::test;
using cli::Confirm;
using cli::RefusalWatch;

/// A watch and a bus that has the refusals at their times.
struct Bench {
  explicit Bench(const Frames& refusals, Confirm confirm = Confirm::yes)
      : bus(world, bus_with(refusals)), watch(amiro::catalogue, "set", confirm) {}

  /// Sends them, and listens; how long, in ms.
  std::int64_t listens(const std::vector<can::Frame>& frames) {
    watch.prepare(bus, frames);
    watch.sent(frames);
    const Moment begin = world.now();
    watch.listen(bus);
    return (world.now() - begin) / 1ms;
  }
  /// Whether it tells of refusals, and what it says.
  std::string tells() {
    Captured said{STDERR_FILENO};
    const bool any = watch.tell();
    return (any ? "true: " : "false: ") + said.text();
  }

  World world{1};
  PlayedBus bus;
  RefusalWatch watch;
};

std::vector<can::Frame> led() {
  return {frame("23C#010203")};
}
std::vector<can::Frame> two() {
  return {frame("23C#010203"), frame("201#0100000000000000")};
}
// The first refusal of a board, of its number and for a reason. [spec/topics.json]
constexpr const char* light_not_served = "759#3C08010000000000";
constexpr const char* motors_not_served = "71D#0108010000000000";
constexpr const char* light_bad_length = "759#3C03010000000000";

TEST_CASE("refusals: for what no board refuses it listens 100 ms, and says nothing") {
  Bench bench{{}};
  CHECK(bench.listens(led()) == 100);
  CHECK(bench.tells() == "false: ");
  bench.watch.leave_if_refused();
}

TEST_CASE("refusals: of one frame the refusal is the end, of several all may be refused") {
  Bench one{{{20ms, light_bad_length}}};
  CHECK(one.listens(led()) == 20);
  CHECK(one.watch.refused().size() == 1);
  CHECK_THAT(one.tells(),
             Catch::StartsWith("true: amiroctl: set: light_ring refuses led_1: bad_length (the board expects "
                               "another number of bytes)\n"));
  CHECK(one.watch.refused().empty());
  CHECK(one.tells() == "true: ");  // it was
  CHECK_THROWS_AS(one.watch.leave_if_refused(), cli::Exit);
  Bench both{{{20ms, light_bad_length}, {30ms, motors_not_served}}};
  CHECK(both.listens(two()) == 100);
  CHECK(both.watch.refused().size() == 2);
}

TEST_CASE("refusals: of one frame that is refused already no other refusal is listened for") {
  Bench bench{{}};
  bench.watch.prepare(bench.bus, led());
  bench.watch.sent(led());
  CHECK(bench.watch.take({{}, frame(light_bad_length)}));
  const Moment begin = bench.world.now();
  bench.watch.listen(bench.bus);
  CHECK(bench.world.now() - begin < 1ms);
  CHECK(bench.watch.refused().size() == 1);
}

TEST_CASE("refusals: what could be asked for instead goes in place of a remedy") {
  Bench bench{{{20ms, light_bad_length}}};
  CHECK(bench.listens(led()) == 20);
  bench.watch.offer("ask for less");
  CHECK_THAT(bench.tells(), Catch::EndsWith("\n          ask for less\n"));
}

TEST_CASE("refusals: what came before, or late, or was not sent, is none of it") {
  Bench before{{{0ms, light_bad_length}}};
  before.world.pass(1ms);
  CHECK(before.listens(led()) == 100);
  CHECK(before.watch.refused().empty());
  Bench other{{{20ms, motors_not_served}}};
  CHECK(other.listens(led()) == 100);
  CHECK(other.watch.refused().empty());
}

TEST_CASE("refusals: --no-confirm listens for none") {
  Bench bench{{{0ms, light_bad_length}}, Confirm::no};
  bench.world.pass(1ms);
  CHECK(bench.listens(led()) == 0);
  CHECK_FALSE(bench.watch.take({{}, frame(light_bad_length)}));
  CHECK(bench.watch.refused().empty());
}

TEST_CASE("refusals: of a stop, what is not served is at rest, but for the motors") {
  Bench bench{{{20ms, light_not_served}, {30ms, motors_not_served}}};
  CHECK(bench.listens(two()) == 100);
  bench.watch.forgive_unserved();
  REQUIRE(bench.watch.refused().size() == 1);
  CHECK(bench.watch.refused()[0].topic->name == "motors");
  Bench wrong{{{20ms, light_bad_length}}};
  CHECK(wrong.listens(led()) == 20);
  wrong.watch.forgive_unserved();
  CHECK(wrong.watch.refused().size() == 1);
}

TEST_CASE("refusals: a signal leaves") {
  Bench bench{{}};
  bench.world.interrupt(World::start + 30ms, 2);
  try {
    static_cast<void>(bench.listens(led()));
    CHECK(false);
  } catch (const cli::Exit& exit) {
    CHECK(exit.code == 130);
  }
}

}  // namespace tool_clock_refusal_watch_test
