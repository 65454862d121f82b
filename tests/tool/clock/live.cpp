// What is served beside a bus: behind the frames that came before it, and in time all the same.
#include "cli/shared/live.hpp"

#include <vector>

#include "tests/tool/clock/played_bus.hpp"

namespace tool_clock_live_test {

using namespace ocm;
using namespace ocm::test;

constexpr int beside = 600;

/// Frames at such times, numbered.
PlayedBus::Conditions frames_at(const std::vector<Moment>& times) {
  PlayedBus::Conditions conditions;
  std::uint32_t number = 0;
  for (const Moment time : times) conditions.incoming.push_back({time, {0x100 + number++, 0, {}}});
  return conditions;
}

TEST_CASE("live: what is beside is served behind the frames that came before it") {
  World world{1};
  const Moment first = World::start + 50ms;
  // The program does not run while both come, first the frames.
  world.stop(first - 1ms, 20ms);
  PlayedBus bus{world, frames_at({first, first + 1ms, first + 2ms})};
  Moment ready = first + 3ms;
  world.inputs[beside] = [&] { return ready; };
  std::size_t taken = 0;
  std::vector<std::size_t> taken_before;
  cli::Live live{bus, [] {}, {beside, [&] {
                                taken_before.push_back(taken);
                                ready = Moment::max();
                              }}};
  const auto over = live.receive(World::start + 1s, [&](const can::Received&) {
    ++taken;
    return true;
  });
  CHECK(over == cli::Over::time);
  CHECK(taken == 3);
  CHECK(taken_before == std::vector<std::size_t>{3});
}

TEST_CASE("live: what is beside does not wait behind a bus that always has a frame") {
  World world{1};
  std::vector<Moment> times;
  for (int i = 0; i < 10'000; ++i) times.push_back(World::start + i * 100us);
  PlayedBus bus{world, frames_at(times)};
  Moment ready = World::start + 300ms;
  world.inputs[beside] = [&] { return ready; };
  std::vector<Moment> served;
  cli::Live live{bus, [] {}, {beside, [&] {
                                served.push_back(world.now());
                                ready = served.size() < 3 ? world.now() + 100ms : Moment::max();
                              }}};
  const auto over = live.receive(World::start + 1s, [&](const can::Received&) {
    world.pass(150us);  // it takes longer than to the next
    return true;
  });
  CHECK(over == cli::Over::time);
  REQUIRE(served.size() == 3);
  Moment due = World::start + 300ms;
  for (const Moment time : served) {
    CHECK(time >= due);
    CHECK(time - due <= 20ms + 1ms);
    due = time + 100ms;
  }
}

TEST_CASE("live: all frames that came before it are taken first, however many they are, and each time") {
  World world{1};
  const Moment first = World::start + 50ms, second = World::start + 150ms;
  std::vector<Moment> times;
  // The program does not run while they come, and then what is beside.
  for (const Moment begin : {first, second}) {
    world.stop(begin - 1ms, 20ms);
    for (int i = 0; i < 20; ++i) times.push_back(begin);
  }
  PlayedBus bus{world, frames_at(times)};
  Moment ready = first + 3ms;
  world.inputs[beside] = [&] { return ready; };
  std::size_t taken = 0;
  std::vector<std::size_t> taken_before;
  cli::Live live{bus, [] {}, {beside, [&] {
                                taken_before.push_back(taken);
                                ready = taken_before.size() == 1 ? second + 3ms : Moment::max();
                              }}};
  const auto over = live.receive(World::start + 1s, [&](const can::Received&) {
    world.pass(100us);
    ++taken;
    return true;
  });
  CHECK(over == cli::Over::time);
  CHECK(taken_before == std::vector<std::size_t>{20, 40});
}

TEST_CASE("live: beside a bus that always has a frame it is served in every second look, each 10 ms") {
  World world{1};
  std::vector<Moment> times;
  for (int i = 0; i < 10'000; ++i) times.push_back(World::start + i * 100us);
  PlayedBus bus{world, frames_at(times)};
  world.inputs[beside] = [] { return World::start; };  // it always has something, too
  std::vector<Moment> served;
  cli::Live live{bus, [] {}, {beside, [&] { served.push_back(world.now()); }}};
  const auto over = live.receive(World::start + 1s, [&](const can::Received&) {
    world.pass(150us);
    return served.size() < 4;
  });
  CHECK(over == cli::Over::enough);
  REQUIRE(served.size() == 4);
  for (std::size_t i = 1; i < served.size(); ++i) {
    CHECK(served[i] - served[i - 1] >= 20ms);
    CHECK(served[i] - served[i - 1] <= 21ms);
  }
}

TEST_CASE("live: on a silent bus it looks for a signal five times a second, and no more often") {
  World world{1};
  PlayedBus bus{world, {}};
  std::size_t steps = 0;  // of the time, three a look
  world.beside = [&] { ++steps; };
  cli::Live live{bus};
  CHECK(live.receive(World::start + 10s, [](const can::Received&) { return true; }) == cli::Over::time);
  CHECK(world.now() >= World::start + 10s);
  CHECK(world.now() < World::start + 10s + 1ms);
  CHECK(steps >= 100);
  CHECK(steps <= 300);
}

TEST_CASE("live: a bus that always has a frame is left behind a second of work, stopped or not") {
  for (const Duration stopped : {0s, 30s}) {
    World world{1};
    std::vector<Moment> times;
    for (int i = 0; i < 200'000; ++i) times.push_back(World::start + i * 100us);
    if (stopped > 0s) world.stop(World::start + 500ms, stopped);
    PlayedBus bus{world, frames_at(times)};
    cli::Live live{bus, [] {}};
    std::size_t taken = 0;
    const auto over = live.receive(World::start + 1s, [&](const can::Received&) {
      world.pass(150us);
      ++taken;
      return true;
    });
    CHECK(over == cli::Over::time);
    const Moment end = World::start + (stopped > 0s ? 500ms + stopped : Duration{1s});
    CHECK(world.now() > end + 1s - 200ms);
    CHECK(world.now() < end + 1s + 200ms);
    // 10,000 come in time, which is 1.5 s of work; the stop takes half a second of that.
    if (stopped == 0s) CHECK(taken >= 10'000);
    if (stopped > 0s) CHECK(taken > 9'000);
  }
}

TEST_CASE("live: a bus that always has a frame has that second of work each time") {
  World world{1};
  std::vector<Moment> times;
  for (int i = 0; i < 50'000; ++i) times.push_back(World::start + i * 100us);
  PlayedBus bus{world, frames_at(times)};
  cli::Live live{bus, [] {}};
  for (int turns = 0; turns < 2; ++turns) {
    const Moment until = world.now() + 500ms;
    const auto over = live.receive(until, [&](const can::Received&) {
      world.pass(150us);  // it takes longer than to the next
      return true;
    });
    CHECK(over == cli::Over::time);
    CHECK(world.now() > until + 1s - 20ms);
    CHECK(world.now() < until + 1s + 20ms);
  }
}

}  // namespace tool_clock_live_test
