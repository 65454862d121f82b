// Messages of J1939 that take several frames, on a bus and a clock that are made of a seed: a listener, which
// is the library's, never hears a part of one message in another, whatever stops the program or the bus.
#include "cli/command/broadcasts.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <map>
#include <set>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/j1939/transport.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/command/timeline.hpp"
#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/unit/base/explore.hpp"

namespace tool_clock_broadcasts_test {

using namespace ocm;
using namespace ocm::test;
using cli::Timeline;

constexpr protocol::FrameLayout layout(std::uint32_t id, std::uint16_t length) {
  protocol::FrameLayout layout;
  layout.length = length;
  layout.address = {protocol::Address::By::pgn, true, id};
  return layout;
}
// Two of one source, one of another; 4, 7 and 3 frames.
constexpr std::array layouts{layout(0x18FEEC2A, 17), layout(0x18FECA2A, 40), layout(0x18FEEB2B, 9)};
constexpr std::array names{"Vehicle", "Trouble", "Component"};
constexpr std::array<protocol::Topic, 3> topics = [] {
  std::array<protocol::Topic, 3> out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].name = names[i];
    out[i].kind = protocol::Kind::message;
    out[i].board = protocol::no_board;
    out[i].frames = {&layouts[i], 1};
  }
  return out;
}();
constexpr protocol::Catalogue truck{"truck", 250'000, {}, topics};

/// The message with all its bytes the same.
client::Command command(std::size_t which, std::uint8_t value, std::optional<client::Repeat> repeat = {}) {
  client::Command command;
  command.broadcast =
      client::Broadcast{&topics[which], std::vector<std::uint8_t>(layouts[which].length, value)};
  command.repeat = repeat;
  return command;
}

/// What a listener makes of the frames, each when it has left.
struct Listener {
  explicit Listener(const std::vector<PlayedBus::Sent>& frames) {
    std::map<std::uint8_t, Moment> last;
    for (const auto& sent : frames) {
      if (sent.left == Moment::max()) continue;
      const std::uint8_t source = j1939::Identifier::decode(sent.frame.id).source;
      if (const auto before = last.find(source); before != last.end())
        CHECK(sent.taken - before->second >= j1939::broadcast_distance);
      last[source] = sent.taken;
      const auto heard =
          transport.take(sent.frame.id, sent.frame.bytes(), base::Time{sent.left.time_since_epoch()});
      if (heard != j1939::Heard::message) continue;
      const auto& message = transport.message();
      const auto id = message.id;
      const auto at = std::find_if(topics.begin(), topics.end(), [&](const protocol::Topic& topic) {
        const auto own = j1939::Identifier::decode(topic.frames[0].address.number);
        return own.pgn == id.pgn && own.source == id.source;
      });
      REQUIRE(at != topics.end());
      const auto which = static_cast<std::size_t>(at - topics.begin());
      CHECK(message.data.size() == layouts[which].length);
      CHECK(std::all_of(message.data.begin(), message.data.end(),
                        [&](std::uint8_t byte) { return byte == message.data[0]; }));
      values[which].push_back(message.data[0]);
      times[which].push_back(sent.left);
    }
  }
  j1939::Transport<4> transport;
  std::array<std::vector<std::uint8_t>, 3> values;
  std::array<std::vector<Moment>, 3> times;
};

TEST_CASE("broadcasts: once, and again and again, at times that do not drift") {
  const Silence silence;
  World world{1};
  PlayedBus bus{world, {}};
  Timeline timeline{bus, truck, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
  timeline.carry_out(command(0, 1));
  timeline.carry_out(command(2, 3, client::Repeat{250ms, 2s}));
  CHECK(timeline.wait_for_end());
  CHECK(timeline.finish());
  CHECK(world.now() - World::start >= 2s);
  const Listener heard{bus.sent()};
  CHECK(heard.values[0] == std::vector<std::uint8_t>{1});
  REQUIRE(heard.values[2].size() == 8);
  for (std::size_t i = 1; i < 8; ++i) {
    const Duration apart = heard.times[2][i] - heard.times[2][0] - static_cast<std::int64_t>(i) * 250ms;
    CHECK(std::chrono::abs(apart) < 2ms);
  }
}

TEST_CASE("broadcasts: what is to last for a nanosecond is sent once, and without an end until a signal") {
  const Silence silence;
  for (const Duration lasting : {1ns, 0ns}) {
    CAPTURE(lasting.count());
    World world{1};
    world.interrupt(World::start + 2s, SIGINT);
    PlayedBus bus{world, {}};
    Timeline timeline{bus, truck, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
    timeline.carry_out(command(0, 1, client::Repeat{500ms, lasting}));
    CHECK(timeline.wait_for_end() == (lasting > 0ns));
    CHECK(timeline.finish());
    CHECK(Listener{bus.sent()}.values[0].size() == (lasting > 0ns ? 1 : 4));
  }
}

TEST_CASE("broadcasts: a source has one at a time, and the next value waits for its turn") {
  const Silence silence;
  World world{1};
  PlayedBus bus{world, {}};
  Timeline timeline{bus, truck, "run", Timeline::Others::allowed, cli::Confirm::no, {}};
  timeline.carry_out(command(0, 1, client::Repeat{200ms, {}}));
  timeline.carry_out(command(1, 2));
  CHECK(timeline.wait_for_step(world.now() + 70ms));
  timeline.carry_out(command(0, 9));  // in the midst of the first
  CHECK(timeline.wait_for_end());
  CHECK(timeline.finish());
  const Listener heard{bus.sent()};
  CHECK(heard.values[0] == std::vector<std::uint8_t>{1, 9});
  CHECK(heard.values[1] == std::vector<std::uint8_t>{2});
  CHECK(heard.transport.counters().complete == 3);
  CHECK(heard.transport.counters().announced == 3);
}

TEST_CASE("broadcasts: what a signal cuts off is not announced again, and a stop begins it again") {
  const Silence silence;
  for (const bool signal : {true, false}) {
    World world{1};
    PlayedBus bus{world, {}};
    Timeline timeline{bus, truck, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
    if (signal)
      world.interrupt(World::start + 120ms, SIGINT);
    else
      world.stop(World::start + 120ms, 2s);
    timeline.carry_out(command(0, 1));
    CHECK(timeline.wait_for_end() != signal);
    CHECK(timeline.finish());
    Listener heard{bus.sent()};
    CHECK(bus.sent().size() == (signal ? 3 : 3 + 4));
    CHECK(heard.values[0].size() == (signal ? 0 : 1));
    CHECK(heard.transport.counters().timed_out == (signal ? 0 : 1));
  }
}

/// What is counted of messages whose frames a bus takes `delay` after they are due, and of a program that
/// does not run from `stop` on for `lasting`.
struct Counted {
  cli::Broadcasts broadcasts;
  Moment now = World::start;
  std::array<int, 3> rounds{};

  void begin(std::size_t which, std::optional<client::Repeat> repeat = {}) {
    broadcasts.begin(*command(which, 1).broadcast, repeat, now);
  }
  void advance(Duration delay = 0ms) {
    broadcasts.advance(now, [&](const can::AnyFrame& frame) {
      const auto bytes = frame.bytes();
      if (frame.id == 0x1CECFF2A || frame.id == 0x1CECFF2B)
        for (std::size_t i = 0; i < topics.size(); ++i)
          if (layouts[i].length == bytes[1]) ++rounds[i];
      return std::optional{now + delay};
    });
  }
  /// Until all is sent.
  void play(Moment stop, Duration lasting, Duration delay = 0ms) {
    advance(delay);
    while (!broadcasts.empty()) {
      now = std::max(now, broadcasts.next_event());
      if (stop <= now && now < stop + lasting) now = stop + lasting;
      advance(delay);
    }
  }
};

TEST_CASE("broadcasts: turns that a stop takes are late, and none is counted behind the end") {
  struct Row {
    Duration stop, lasting;
    int rounds;
    std::uint64_t late;
    Duration end = 2s;
  };
  // Every 500 ms for 2 s: at 0, 0.5, 1 and 1.5 s, each for 150 ms.
  for (const Row& row : {Row{700ms, 6s, 2, 2},     // 1 and 1.5 s
                         Row{580ms, 6s, 2, 3},     // 0.5 s, of which a part is sent, and the two behind it
                         Row{580ms, 800ms, 4, 1},  // 0.5 s begins again at 1.38 s, in the turn of 1 s
                         Row{580ms, 300ms, 4, 0},  // listeners wait for 0.5 s
                         Row{580ms, 720ms, 4, 0},  // and still do, 750 ms behind its last packet
                         Row{580ms, 720ms + 1ns, 4, 1},           // and no longer: it begins again
                         Row{510ms, 1200ms, 3, 2},                // 0.5 and 1 s
                         Row{5s, 1s, 4, 0},                       // it is over
                         Row{1400ms, 700ms, 3, 1},                // 1.5 s; 2 s is the end itself
                         Row{1580ms, 800ms, 4, 1},                // 1.5 s, of which a part is sent
                         Row{1400ms, 700ms, 4, 1, 2s + 1ns},      // 1.5 s; 2 s is before the end
                         Row{1400ms, 1200ms, 3, 2, 2s + 1ns}}) {  // 1.5 and 2 s
    INFO(row.stop.count() << ", " << row.lasting.count());
    Counted counted;
    counted.begin(0, client::Repeat{500ms, row.end});
    counted.play(World::start + row.stop, row.lasting);
    CHECK(counted.broadcasts.counts().late == row.late);
    CHECK(counted.broadcasts.counts().waited == 0);
    CHECK(counted.rounds[0] == row.rounds);
  }
}

TEST_CASE("broadcasts: what is sent once is over with its last frame, and did not wait if it is sent again") {
  Counted counted;
  counted.begin(0);
  counted.advance();
  while (counted.broadcasts.unfinished() != nullptr) {
    counted.now = counted.broadcasts.next_event();
    counted.advance();
  }
  CHECK(counted.now == World::start + 3 * j1939::broadcast_distance);
  CHECK(counted.broadcasts.next_event() <= counted.now);
  counted.begin(0);
  CHECK(counted.broadcasts.counts().waited == 0);
  CHECK(counted.broadcasts.size() == 1);
}

TEST_CASE(
    "broadcasts: what the bus does not take is tried again 5 ms later, and is late since the first time") {
  Counted counted;
  counted.begin(0);
  int tries = 0;
  const auto next_after = [&](Duration time) {
    counted.now = World::start + time;
    counted.broadcasts.advance(counted.now, [&](const can::AnyFrame&) {
      ++tries;
      return std::optional<Moment>{};
    });
    return counted.broadcasts.next_event();
  };
  CHECK(next_after(0ms) == World::start + 5ms);
  CHECK(next_after(5ms - 1ns) == World::start + 5ms);
  CHECK(tries == 1);
  CHECK(next_after(5ms) == World::start + 10ms);
  CHECK(tries == 2);
  CHECK(counted.broadcasts.held_up_since() == World::start);
  counted.now = World::start + 10ms;
  counted.advance();
  CHECK(counted.rounds[0] == 1);
  CHECK_FALSE(counted.broadcasts.held_up_since());
}

TEST_CASE("broadcasts: one that the bus holds up until listeners have given up begins again as it is tried") {
  Counted counted;
  counted.begin(0);
  counted.advance();
  const Moment given_up = World::start + j1939::timeout::t1;
  for (;;) {
    counted.now = counted.broadcasts.next_event();
    if (counted.now > given_up) break;
    counted.broadcasts.advance(counted.now, [](const can::AnyFrame&) { return std::optional<Moment>{}; });
  }
  CHECK(counted.now == given_up + 5ms);
  CHECK(counted.broadcasts.counts().late == 0);
  counted.advance();
  CHECK(counted.rounds[0] == 2);
  CHECK(counted.broadcasts.counts().late == 1);
}

TEST_CASE("broadcasts: only another message of the source makes one wait") {
  // Alone, and as often as it can be: every frame 1 ms late is a turn in 50.
  Counted alone;
  alone.begin(0, client::Repeat{200ms, 60s});
  alone.play(Moment::max() - 1s, 0s, 1ms);
  CHECK(alone.broadcasts.counts().late > 0);
  CHECK(alone.broadcasts.counts().waited == 0);
  CHECK(static_cast<std::uint64_t>(alone.rounds[0]) + alone.broadcasts.counts().late == 300);
  // Beside another, 350 ms of each 500 ms, it gets a turn between two of those.
  Counted both;
  both.begin(1, client::Repeat{500ms, 10s});
  both.begin(0, client::Repeat{200ms, 10s});
  both.play(Moment::max() - 1s, 0s);
  CHECK(both.broadcasts.counts().late == 0);
  CHECK(both.broadcasts.counts().waited > 0);
}

TEST_CASE("broadcasts: what another node broadcasts from the same source is met once a round") {
  constexpr auto packet = [](std::uint32_t id) {
    return can::Frame{id, 8, {1, 2, 3, 4, 5, 6, 7, 8}, can::Format::extended};
  };
  Counted counted;
  CHECK(counted.broadcasts.meet(packet(0x1CEBFF2A)) == nullptr);
  counted.begin(0);
  counted.advance();
  CHECK(counted.broadcasts.meet(packet(0x1CEBFF2B)) == nullptr);  // another source
  CHECK(counted.broadcasts.meet(packet(0x1CEB002A)) == nullptr);  // a connection
  CHECK(counted.broadcasts.meet(packet(0x18FEEC2A)) == nullptr);  // another group
  auto base = packet(0x2A);
  base.format = can::Format::base;
  CHECK(counted.broadcasts.meet(base) == nullptr);
  const auto* const met = counted.broadcasts.meet(packet(0x18ECFF2A));
  REQUIRE(met != nullptr);
  CHECK(met->message == &topics[0]);
  CHECK(counted.broadcasts.meet(packet(0x1CEBFF2A)) == nullptr);  // known
  CHECK(counted.broadcasts.counts().met == 1);
  counted.play(Moment::max() - 1s, 0s);
  CHECK(counted.broadcasts.meet(packet(0x1CEBFF2A)) == nullptr);
  counted.begin(0);
  counted.play(Moment::max() - 1s, 0s);
  CHECK(counted.broadcasts.counts().met == 1);
  // Each round is another one, however many frames it meets.
  counted.begin(0, client::Repeat{1s, 3s});
  while (!counted.broadcasts.empty()) {
    counted.now = counted.broadcasts.next_event();
    counted.advance();
    static_cast<void>(counted.broadcasts.meet(packet(0x1CEBFF2A)));
  }
  CHECK(counted.rounds[0] == 5);
  CHECK(counted.broadcasts.counts().met == 4);
}

TEST_CASE("broadcasts: what was to be sent once and waits is known") {
  Counted counted;
  counted.begin(0);
  counted.begin(1);
  counted.begin(2, client::Repeat{1s, {}});
  counted.advance();
  CHECK(counted.broadcasts.unfinished()->message == &topics[0]);
  REQUIRE(counted.broadcasts.waiting().size() == 1);
  CHECK(counted.broadcasts.waiting()[0]->message == &topics[1]);
}

TEST_CASE("broadcasts: what was to be sent once, waits, and is given other values counts as waited") {
  Counted counted;
  const auto waited = [&counted] { return counted.broadcasts.counts().waited; };
  counted.begin(0);
  counted.begin(1);
  counted.advance();
  counted.begin(1);
  CHECK(waited() == 1);
  CHECK(counted.broadcasts.size() == 2);
  counted.begin(1, client::Repeat{1s, {}});
  CHECK(waited() == 2);
  counted.begin(1);  // in the place of what was to come again and again
  CHECK(waited() == 2);
  counted.begin(0);  // behind the one that is under way
  CHECK(waited() == 2);
  CHECK(counted.broadcasts.size() == 3);
}

TEST_CASE("broadcasts: what was late, waited, met another or was cut off is said") {
  const auto said_of = [](const std::vector<client::Command>& commands, World& world,
                          PlayedBus::Conditions conditions = {}) {
    PlayedBus bus{world, std::move(conditions)};
    Captured said{STDERR_FILENO};
    Timeline timeline{bus, truck, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
    for (const auto& each : commands) timeline.carry_out(each);
    static_cast<void>(timeline.wait_for_end());
    const bool fine = timeline.finish();
    static_cast<void>(timeline.finish());  // what was said is not said again
    return said.text() + (fine ? "fine" : "not fine");
  };
  World calm{1};
  CHECK(said_of({command(0, 1, client::Repeat{500ms, 2s})}, calm) == "fine");
  World late{1};
  late.stop(World::start + 580ms, 6s);
  CHECK(said_of({command(0, 1, client::Repeat{500ms, 2s})}, late) ==
        "set: 3 broadcasts left out or begun again, because this program or can0 was too late\nfine");
  World once{1};
  once.stop(World::start + 80ms, 2s);
  CHECK(said_of({command(0, 1)}, once) ==
        "set: 1 broadcast left out or begun again, because this program or can0 was too late\nfine");
  World both{1};
  CHECK_THAT(
      said_of({command(1, 1, client::Repeat{500ms, 10s}), command(0, 1, client::Repeat{200ms, 10s})}, both),
      Catch::Matches("set: [0-9]+ broadcasts left out, because a source sends one at a time\nfine"));
  World cut{1};
  cut.interrupt(World::start + 80ms, SIGINT);
  CHECK(said_of({command(0, 1), command(1, 1)}, cut) ==
        "set: Vehicle was not sent to its end\nset: Trouble was not sent\nfine");
  World cut_alone{1};
  cut_alone.interrupt(World::start + 80ms, SIGINT);
  CHECK(said_of({command(0, 1)}, cut_alone) == "set: Vehicle was not sent to its end\nfine");
  World between{1};  // the first is whole, and the second has not begun
  between.interrupt(World::start + 170ms, SIGINT);
  CHECK(said_of({command(0, 1), command(1, 1)}, between) == "set: Trouble was not sent\nfine");
  const std::string first =
      "set: another node broadcasts from source 2A during Vehicle, so listeners may drop both\n";
  PlayedBus::Conditions conditions;
  for (const Duration at : {20ms, 30ms, 520ms, 1020ms, 1900ms})
    conditions.incoming.push_back(
        {World::start + at, {0x1CEBFF2A, 8, {1, 2, 3, 4, 5, 6, 7, 8}, can::Format::extended}});
  World met{1};
  CHECK(said_of({command(0, 1, client::Repeat{500ms, 2s})}, met, conditions) ==
        first + "set: 3 broadcasts met others of the same source\nnot fine");
  conditions.incoming.resize(2);
  World met_once{1};
  CHECK(said_of({command(0, 1, client::Repeat{500ms, 2s})}, met_once, conditions) == first + "not fine");
}

TEST_CASE("broadcasts: a bus that takes nothing ends the command") {
  const Silence silence;
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.down = {{World::start + 80ms, Moment::max()}};
  PlayedBus bus{world, conditions};
  Timeline timeline{bus, truck, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
  timeline.carry_out(command(0, 1));
  CHECK_THROWS_AS(timeline.wait_for_end(), cli::Exit);
  CHECK(world.now() - World::start < 1s);
}

TEST_CASE("broadcasts: while no frame leaves two of a message wait, and no more") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.stuck = {{World::start + 80ms, Moment::max()}};
  PlayedBus bus{world, conditions};
  Timeline timeline{bus, truck, "set", Timeline::Others::allowed, cli::Confirm::no, {}};
  const Leaving left = leaving([&] {
    timeline.carry_out(command(1, 2));
    static_cast<void>(timeline.wait_for_end());
  });
  CHECK(left.code == cli::exit_failure);
  CHECK_THAT(left.text, Catch::Contains("amiroctl: set: can0 has taken no frame for 50"));
  REQUIRE(bus.sent().size() == 4);  // of seven
  CHECK(bus.sent()[1].left != Moment::max());
  CHECK(bus.sent()[2].left == Moment::max());
}

/// Some at random times, with whatever stops program and bus for a while.
void play(std::uint64_t seed) {
  World world{seed};
  PlayedBus::Conditions conditions;
  conditions.room = world.between<std::size_t>(3, 20);
  conditions.frame_time = world.between(100us, 1ms);
  conditions.knows_delivery = world.chance(0.7);
  bool calm = true;
  const auto sometime = [&] { return World::start + world.between(0s, 6s); };
  if (world.chance(0.3)) {
    const Moment from = sometime();
    conditions.down.push_back({from, from + world.between(1ms, 400ms)});
    calm = false;
  }
  while (world.chance(0.3)) world.stop(sometime(), world.between(1ms, 3s)), calm = false;
  PlayedBus bus{world, conditions};
  std::array<std::set<std::uint8_t>, 3> meant;
  bool left = false;
  try {
    Timeline timeline{bus, truck, "run", Timeline::Others::allowed, cli::Confirm::no, {}};
    Moment at = world.now();
    for (std::uint8_t value = 1; value <= 8; ++value) {
      const auto which = world.between<std::size_t>(0, 2);
      std::optional<client::Repeat> repeat;
      if (world.chance(0.5))
        repeat = client::Repeat{j1939::broadcast_time(layouts[which].length) + world.between(0ms, 500ms),
                                world.between(1ms, 2s)};
      timeline.carry_out(command(which, value, repeat));
      meant[which].insert(value);
      at += world.between(0ms, 1s);
      if (!timeline.wait(at)) break;
    }
    static_cast<void>(timeline.wait_for_end());
    static_cast<void>(timeline.finish());
  } catch (const cli::Exit&) {
    left = true;
  }
  world.pass(10s);
  const Listener heard{bus.sent()};
  const auto& counters = heard.transport.counters();
  CHECK((counters.wrong_sequence == 0 && counters.lost_packet == 0 && counters.malformed == 0));
  CHECK(counters.stray == 0);
  for (std::size_t i = 0; i < 3; ++i)
    for (const std::uint8_t value : heard.values[i]) CHECK(meant[i].contains(value));
  if (!calm) return;
  CHECK_FALSE(left);
  CHECK(counters.complete == counters.announced);
  // The value that was given last is the one that holds.
  for (std::size_t i = 0; i < 3; ++i)
    if (!meant[i].empty()) {
      REQUIRE_FALSE(heard.values[i].empty());
      CHECK(heard.values[i].back() == *meant[i].rbegin());
    }
}

TEST_CASE("broadcasts: whatever happens to program and bus, no listener hears a wrong message") {
  const auto runs = static_cast<std::uint64_t>(explored(1000));
  const Silence silence;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    INFO("seed " << seed);
    play(seed);
  }
}

}  // namespace tool_clock_broadcasts_test
