// Driving by a page, on a bus and a clock that are played: when set points go out, what keeps them from it,
// and what viewers hear of it.
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/serve/control.hpp"
#include "cli/shared/set_points.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/tool/clock/question.hpp"

namespace tool_clock_page_drive_test {

using namespace ocm;
using namespace ocm::test;
using namespace ocm::cli::serve;
using Strings = std::vector<std::string>;

constexpr std::uint32_t motors = 0x201, behaviour = 0x60D, refusal = 0x71D;
constexpr const char* drives_already = "another viewer drives; stop it first, or wait";

can::Frame frame(std::uint32_t id, std::initializer_list<int> bytes) {
  can::Frame frame;
  frame.id = id;
  frame.dlc = static_cast<std::uint8_t>(bytes.size());
  std::transform(bytes.begin(), bytes.end(), frame.data.begin(),
                 [](int byte) { return static_cast<std::uint8_t>(byte); });
  return frame;
}
/// What the wheels' board says: it does nothing by itself, or travels.
can::Frame at_rest() {
  return frame(behaviour, {0, 0, 0, 0, 0, 0, 0, 0});
}
can::Frame travels() {
  return frame(behaviour, {1, 0, 0, 0, 0, 0, 0, 0});
}
/// Of another program.
can::Frame moves() {
  return frame(motors, {0x50, 0xC3, 0, 0, 0, 0, 0, 0});
}
can::Frame rests() {
  return frame(motors, {0, 0, 0, 0, 0, 0, 0, 0});
}

/// A page and the bus that it drives on; times are from the beginning.
struct Page {
  explicit Page(PlayedBus::Conditions conditions = {})
      : bus(world, std::move(conditions)),
        control(
            bus, amiro::catalogue, viewers, [this](const can::AnyFrame&) { ++shown; },
            [this] { return obstacle; }) {}

  void order(Order order) { control.carry_out(order); }
  void drives(double x_m_s, ViewerId viewer) {
    order({Order::Kind::publish, viewer, "/motors", "{\"x\":" + std::to_string(x_m_s) + "}"});
  }
  void line(std::string words, ViewerId viewer) {
    order({Order::Kind::publish, viewer, "/ocm/command", R"({"line":")" + words + "\"}"});
  }
  /// As the thread that has the bus does.
  void until(Duration time) {
    const Moment end = World::start + time;
    while (world.now() < end) {
      const auto next = control.next();
      const auto received = bus.receive(std::min(next.value_or(end), end) - world.now());
      if (received) control.heard(*received);
      control.advance();
    }
  }
  /// Presses and holds, ten times a second.
  void holds(double x_m_s, ViewerId viewer, Duration from, Duration to) {
    for (Duration time = from; time < to; time += 100ms) {
      until(time);
      drives(x_m_s, viewer);
    }
  }
  Strings told(ViewerId viewer) {
    Strings all;
    while (const auto message = viewers.next(viewer, base::Time{})) {
      std::string_view text{*message->payload};
      text.remove_prefix(text.find(R"("message":")") + 11);
      all.emplace_back(text.substr(0, text.find('"')));
    }
    return all;
  }
  /// Times of set points of motors that move, and of those that rest.
  std::vector<Duration> moving() {
    return times([](const can::Frame& each) { return each.id == motors && !cli::is_rest(each); });
  }
  std::vector<Duration> resting() {
    return times([](const can::Frame& each) { return each.id == motors && cli::is_rest(each); });
  }
  std::size_t questions() {
    return times([](const can::Frame& each) { return each == question(); }).size();
  }
  template <class Is>
  std::vector<Duration> times(Is is) {
    std::vector<Duration> all;
    for (const auto& each : bus.sent())
      if (is(each.frame)) all.push_back(each.taken - World::start);
    return all;
  }
  /// Of the newest frame that moves: micrometres a second.
  std::uint32_t newest_speed() {
    std::uint32_t speed = 0;
    for (const auto& each : bus.sent())
      if (each.frame.id == motors && !cli::is_rest(each.frame))
        speed = each.frame.data[0] + 256U * each.frame.data[1] + 65536U * each.frame.data[2];
    return speed;
  }

  World world{1};
  PlayedBus bus;
  Viewers viewers{1};
  ViewerId a = viewers.add(), b = viewers.add();
  std::size_t shown = 0;
  std::string obstacle;
  Control control;
};

bool is_about(Duration time, Duration expected) {
  return time >= expected && time < expected + 1ms;
}

TEST_CASE("page drive: nothing moves before the board could have said what it does by itself") {
  Page page;
  page.holds(0.1, page.a, 0ms, 1s);
  page.until(2s);
  CHECK(page.questions() == 1);
  const auto moving = page.moving();
  REQUIRE(moving.size() >= 13);  // from 0.1 s on, and half a second behind the last word at 0.9 s
  REQUIRE(moving.size() <= 14);
  CHECK(is_about(moving[0], 100ms));
  for (std::size_t i = 1; i < moving.size(); ++i)
    CHECK(is_about(moving[i] - moving[i - 1] + 1ms, 100ms + 1ms - 500us));
  const auto resting = page.resting();
  REQUIRE(resting.size() == 1);
  CHECK(is_about(resting[0], 1400ms));
  const Strings silent{"the page that drove was silent for half a second: the motors rest"};
  CHECK(page.told(page.a) == silent);
  CHECK(page.told(page.b) == silent);
  CHECK(page.shown == page.bus.sent().size());
  CHECK_FALSE(page.control.next());
}

TEST_CASE("page drive: a board that says that it is at rest is not waited for longer") {
  Page page{{.incoming = {{World::start + 30ms, at_rest()}}}};
  page.drives(0.1, page.a);
  page.until(50ms);
  REQUIRE(page.moving().size() == 1);
  CHECK(is_about(page.moving()[0], 30ms));
  // What it said holds for 0.3 s: another drive is not asked for.
  page.drives(0, page.a);
  page.until(320ms);
  page.drives(0.1, page.a);
  page.until(325ms);
  CHECK(page.moving().size() == 2);
  CHECK(page.questions() == 1);
  page.drives(0, page.a);
  page.until(340ms);
  page.drives(0.1, page.a);
  page.until(345ms);
  CHECK(page.moving().size() == 2);
  CHECK(page.questions() == 2);
  page.until(450ms);
  CHECK(page.moving().size() == 3);
  CHECK(page.told(page.a).empty());
}

TEST_CASE("page drive: a server that did not run while the board was asked gives it the time again") {
  Page page;
  page.drives(0.1, page.a);
  page.world.wait_until(World::start + 115ms);  // a little late, as on a busy machine
  page.control.advance();
  CHECK(page.moving().size() == 1);

  Page late;
  late.drives(0.1, late.a);
  late.world.wait_until(World::start + 125ms);  // it did not run: what the board has said may wait
  late.control.advance();
  CHECK(late.moving().empty());
  late.until(220ms);
  CHECK(late.moving().empty());
  late.until(230ms);
  REQUIRE(late.moving().size() == 1);
  CHECK(is_about(late.moving()[0], 225ms));
  CHECK(late.questions() == 1);
  CHECK(late.told(late.a).empty());
}

TEST_CASE("page drive: while the board drives by itself, a page does not") {
  Page page{{.incoming = {{World::start + 30ms, travels()}, {World::start + 600ms, at_rest()}}}};
  page.drives(0.1, page.a);
  page.until(200ms);
  CHECK(page.moving().empty());
  CHECK(page.told(page.a) ==
        Strings{"di_wheel_drive drives the wheels by itself: wait for its end, or stop the robot"});
  page.drives(0.1, page.a);  // it has just said so
  CHECK(page.questions() == 1);
  CHECK(page.told(page.a).size() == 1);
  CHECK(page.told(page.b).empty());
  page.until(601ms);
  page.drives(0.1, page.a);
  page.until(610ms);
  CHECK(page.moving().size() == 1);
}

TEST_CASE("page drive: what is said while the board is asked is what counts, and one viewer is asked for") {
  Page page;
  page.drives(0.1, page.a);
  page.until(20ms);
  page.drives(0.2, page.b);
  CHECK(page.told(page.b) == Strings{drives_already});
  page.drives(0.3, page.a);
  page.until(150ms);
  CHECK(page.questions() == 1);
  REQUIRE(page.moving().size() == 1);
  CHECK(page.newest_speed() == 300'000);
  page.drives(0.2, page.b);
  CHECK(page.told(page.b) == Strings{drives_already});
  CHECK(page.told(page.a).empty());
}

TEST_CASE("page drive: who lets go, goes away or stops all before the board was heard moves nothing") {
  for (const int how : {0, 1, 2}) {
    INFO(how);
    Page page;
    page.drives(0.1, page.a);
    page.until(20ms);
    if (how == 0) page.drives(0, page.a);
    if (how == 1) page.order({Order::Kind::gone, page.a});
    if (how == 2) page.line("stop all", page.b);
    page.until(1s);
    CHECK(page.moving().empty());
    CHECK(page.told(page.a).empty());
  }
  Page page;
  page.drives(0.1, page.a);
  page.until(20ms);
  page.order({Order::Kind::gone, page.b});
  page.until(150ms);
  CHECK(page.moving().size() == 1);
  page.order({Order::Kind::gone, page.a});
  page.until(151ms);
  CHECK(page.resting().size() == 1);
  page.until(1s);
  CHECK(page.moving().size() == 1);
}

TEST_CASE("page drive: a stop before the board was heard holds as one behind it does") {
  for (const int who : {0, 1, 2}) {
    INFO(who);
    PlayedBus::Conditions conditions;
    if (who == 2) conditions.incoming = {{World::start + 20ms, rests()}};
    Page page{conditions};
    page.drives(0.1, page.a);
    page.until(20ms);
    if (who == 0) page.drives(0, page.b);  // its "Stop the robot"
    if (who == 1) page.line("stop all", page.b);
    page.holds(0.1, page.a, 30ms, 900ms);  // it is held still
    CHECK(page.moving().empty());
    const Strings told = page.told(page.a);
    REQUIRE_FALSE(told.empty());
    CHECK(told.back() == "the drive was ended: release first, then drive again");
    page.drives(0, page.a);
    page.holds(0.1, page.a, 910ms, 1200ms);
    CHECK_FALSE(page.moving().empty());
  }
}

TEST_CASE("page drive: not while another program commands the motors") {
  Page page{{.incoming = {{World::start + 10ms, moves()}}}};
  page.until(20ms);
  page.drives(0.1, page.a);
  page.until(10ms + client::listen_before_hold - 1ms);
  page.drives(0.1, page.a);
  CHECK(page.told(page.a) ==
        Strings(2, "another program commands the motors: end it first, or stop the robot"));
  CHECK(page.bus.sent().empty());
  page.until(10ms + client::listen_before_hold + 1ms);
  page.drives(0.1, page.a);
  CHECK(page.questions() == 1);
  CHECK(page.told(page.a).empty());
}

TEST_CASE("page drive: another program's stop holds") {
  Page page{{.incoming = {{World::start + 10ms, rests()},
                          {World::start + 250ms, rests()},
                          {World::start + 260ms, rests()}}}};
  page.until(20ms);
  CHECK(page.told(page.a).empty());  // no viewer drove
  page.holds(0.1, page.a, 20ms, 300ms);
  page.until(320ms);
  CHECK(page.moving().back() < 250ms);
  REQUIRE(page.resting().size() == 1);
  CHECK(is_about(page.resting()[0], 250ms));
  CHECK(page.told(page.b) == Strings{"another program has stopped the robot"});
  page.holds(0.1, page.a, 320ms, 620ms);  // it is held still
  CHECK(page.moving().back() < 250ms);
  CHECK(page.told(page.a).size() >= 1);
}

TEST_CASE("page drive: no set point waits behind another, and rest is tried until it leaves") {
  Page page{{.stuck = {{World::start + 350ms, World::start + 900ms}}}};
  page.holds(0.1, page.a, 0ms, 500ms);
  CHECK(page.moving().size() <= 5);  // 100, 200, 300 ms, and at most two while none leaves
  CHECK(page.moving().back() < 500ms);
  page.drives(0, page.a);
  page.until(2s);
  REQUIRE(page.resting().size() == 1);
  CHECK(page.told(page.a).empty());

  // Who goes on hears why the robot does not move, once.
  Page stuck{{.stuck = {{World::start + 350ms, World::start + 1h}}}};
  stuck.holds(0.1, stuck.a, 0ms, 2500ms);
  CHECK(stuck.moving().size() == 4);
  const Strings told = stuck.told(stuck.a);
  REQUIRE(told.size() == 1);
  CHECK(told[0].starts_with("no set point leaves can0: no node acknowledges the frames"));

  Page down{{.down = {{World::start + 350ms, World::start + 903ms}}}};
  down.holds(0.1, down.a, 0ms, 500ms);
  down.until(450ms);
  CHECK(down.moving().size() == 3);
  CHECK_FALSE(down.told(down.a).empty());
  down.drives(0, down.a);
  down.until(600ms);
  CHECK(down.resting().empty());
  CHECK(down.control.next());
  down.until(2s);
  REQUIRE(down.resting().size() == 1);
  CHECK(down.resting()[0] >= 903ms);
  CHECK(down.resting()[0] < 915ms);
  CHECK_FALSE(down.control.next());
}

TEST_CASE("page drive: a rest that the bus does not take is tried a hundred times a second") {
  Page down{{.down = {{World::start + 250ms, World::start + 750ms}}}};
  down.holds(0.1, down.a, 0ms, 200ms);
  down.until(260ms);
  down.drives(0, down.a);
  const auto before = down.bus.counters().refused;
  CHECK(before > 0);
  down.until(660ms);
  CHECK(down.bus.counters().refused - before >= 35);
  CHECK(down.bus.counters().refused - before <= 41);
  CHECK(down.resting().empty());
  down.until(800ms);
  CHECK(down.resting().size() == 1);
}

TEST_CASE("page drive: why a bus takes nothing") {
  Page down{{.down = {{World::start, World::start + 1h}}}};
  down.line("publish gyro 50ms", down.a);
  CHECK(down.told(down.a) == Strings{"can0 is down; bring it up"});
  down.drives(0.1, down.a);  // the board cannot be asked: it is said at once
  CHECK(down.told(down.a) == Strings{"can0 is down; bring it up"});
  CHECK(down.shown == 0);

  Page full{{.room = 1, .stuck = {{World::start, World::start + 1h}}}};
  full.line("publish gyro 50ms", full.a);
  CHECK(full.told(full.a).empty());
  full.line("publish odom 50ms", full.a);
  const Strings told = full.told(full.a);
  REQUIRE(told.size() == 1);
  CHECK(told[0].starts_with("the bus takes no frame: no node acknowledges the frames"));
  CHECK(full.told(full.b).empty());
  CHECK(full.shown == 0);
}

TEST_CASE("page drive: what does not leave is said to who asked, and only stops go behind it") {
  Page page{
      {.room = 100, .stuck = {{World::start, World::start + 2s}, {World::start + 3s, World::start + 1h}}}};
  page.line("publish gyro 50ms", page.a);
  page.until(499ms);
  CHECK(page.told(page.a).empty());
  page.until(520ms);
  constexpr const char* stuck =
      "a frame has not left can0, and may leave later: no node acknowledges the frames";
  Strings told = page.told(page.a);
  REQUIRE(told.size() == 1);
  CHECK(told[0].starts_with(stuck));
  CHECK(page.told(page.b).empty());
  page.line("publish odom 50ms", page.a);
  page.line("led all red", page.b);
  page.order({Order::Kind::parameter, page.b, "/gyroscope/period_ms", {}, 20});
  CHECK(page.told(page.a).size() == 1);
  CHECK(page.told(page.b).size() == 2);
  CHECK(page.bus.sent().size() == 1);
  page.line("stop all", page.b);
  CHECK(page.bus.sent().size() > 5);
  told = page.told(page.b);
  REQUIRE(told.size() == 1);
  CHECK(told[0].ends_with(": is a board powered and connected, and is the bit rate the same?"));
  CHECK(told[0].find(" frames have not left can0, and may leave later") != std::string::npos);
  CHECK(page.shown == 0);
  page.until(2500ms);
  CHECK(page.shown == page.bus.sent().size());
  CHECK_FALSE(page.control.next());
  page.until(3100ms);
  page.line("publish gyro 50ms", page.a);
  CHECK(page.told(page.a).empty());
  page.until(3700ms);
  CHECK(page.told(page.a).size() == 1);
  CHECK(page.told(page.b).empty());

  // A travel that leaves when its viewer has gone ends at once.
  for (const bool ends : {false, true}) {
    Page late{{.room = 100, .stuck = {{World::start, World::start + 2s}}}};
    late.order({Order::Kind::publish, late.a, "/travel", R"({"distance":0.3,"speed":0.1})"});
    late.until(1s);
    if (ends) {
      CHECK_FALSE(late.control.rest().empty());
    } else {
      late.order({Order::Kind::gone, late.b});
      CHECK(late.bus.sent().size() == 1);
      late.order({Order::Kind::gone, late.a});
    }
    REQUIRE(late.bus.sent().size() == 2);
    CHECK(late.bus.sent()[1].frame == frame(0x20B, {0, 0, 0, 0, 0, 0, 0, 0}));
  }

  Page unknown{{.knows_delivery = false, .stuck = {{World::start, World::start + 1h}}}};
  unknown.line("publish gyro 50ms", unknown.a);
  unknown.until(1s);
  CHECK(unknown.told(unknown.a).empty());
  CHECK(unknown.shown == 1);
}

TEST_CASE("page drive: a board begins nothing by itself while another viewer or a program drives") {
  const auto travels_of = [](Page& page) {
    return page.times([](const can::Frame& each) { return each.id == 0x20B; }).size();
  };
  const Order travel{Order::Kind::publish, 2, "/travel", R"({"distance":0.3,"speed":0.1})"};
  Page page{{.incoming = {{World::start + 5s, moves()}}}};
  REQUIRE(page.b == 2);
  page.holds(0.1, page.a, 0ms, 300ms);
  page.order(travel);
  CHECK(page.told(page.b) == Strings{drives_already});
  page.line("travel 30cm", page.b);
  page.told(page.b);
  CHECK(travels_of(page) == 0);
  page.drives(0, page.a);
  page.order(travel);
  CHECK(page.told(page.b).empty());
  CHECK(travels_of(page) == 1);
  page.until(5100ms);
  page.order(travel);
  CHECK(page.told(page.b) == Strings{"another program commands the motors: end it first, or stop the robot"});
  CHECK(travels_of(page) == 1);
  page.until(6s);
  page.holds(0.1, page.b, 6s, 6500ms);  // its own drive is no obstacle
  page.order(travel);
  CHECK(page.told(page.b).empty());
  CHECK(travels_of(page) == 2);
}

TEST_CASE("page drive: a server that did not run does not follow what was said meanwhile") {
  for (const bool says_rest : {false, true}) {
    INFO(says_rest);
    Page page;
    if (says_rest) page.drives(0, page.a);
    page.until(50ms);
    page.holds(0.1, page.a, 50ms, 1s);
    const auto moved = page.moving().size();
    const auto rested = page.resting().size();
    page.world.wait_until(World::start + 4s);
    for (int i = 0; i < 5; ++i) page.drives(0.1, page.a);  // of one second, which waited
    CHECK(page.resting().size() == rested + 1);
    page.until(4400ms);
    CHECK(page.moving().size() == moved);
    CHECK(page.told(page.b) ==
          Strings{"serve did not run for 3.0 s: the motors rest; release, then drive again"});
    CHECK(page.told(page.a).size() == 2);  // that, and that it must release
    page.drives(0, page.a);
    page.until(5s);
    page.holds(0.1, page.a, 5s, 5300ms);
    CHECK(page.moving().size() > moved);
  }
  Page page;  // who does not drive is not told
  page.world.wait_until(World::start + 4s);
  page.line("publish gyro 50ms", page.a);
  CHECK(page.told(page.a).empty());
  CHECK(page.bus.sent().size() == 1);
}

TEST_CASE("page drive: what keeps commands back keeps no stop back") {
  Page page{{.room = 100}};
  page.obstacle = "an operator guards the robot";
  page.drives(0.1, page.a);
  page.line("publish gyro 50ms", page.a);
  page.order({Order::Kind::parameter, page.a, "/gyroscope/period_ms", {}, 50});
  CHECK(page.told(page.a) == Strings(3, page.obstacle));
  CHECK(page.bus.sent().empty());
  page.drives(0, page.a);
  page.line("stop all", page.a);
  CHECK(page.told(page.a).empty());
  CHECK(page.resting().size() == 2);  // the second line stops the motors, too
  CHECK(page.bus.sent().size() > 5);  // and each sensor's stop
  // One that drives already goes on.
  page.obstacle.clear();
  page.until(1s);
  page.drives(0.1, page.a);
  page.until(1200ms);
  page.obstacle = "an operator guards the robot";
  page.drives(0.2, page.a);
  CHECK(page.told(page.a).empty());
  CHECK(page.newest_speed() == 200'000);
}

TEST_CASE("page drive: a stop of all ends any viewer's drive, which must say rest before the next") {
  Page page{{.room = 100}};
  page.holds(0.1, page.a, 0ms, 300ms);
  page.drives(0, page.a);
  page.until(310ms);
  page.holds(0.1, page.a, 310ms, 600ms);
  const auto before = page.resting().size();
  page.line("stop all", page.b);
  CHECK(page.resting().size() == before + 2);  // of the drive, and of the line itself
  page.until(700ms);
  const auto moved = page.moving().size();
  page.drives(0.1, page.a);
  page.until(900ms);
  CHECK(page.moving().size() == moved);
  CHECK(page.told(page.a) == Strings{"the drive was ended: release first, then drive again"});
}

TEST_CASE("page drive: periods of sensors, and what is none") {
  Page page;
  page.order({Order::Kind::parameter, page.a, "/gyroscope/period_ms", {}, 50});
  REQUIRE(page.bus.sent().size() == 1);
  CHECK(page.bus.sent()[0].frame == frame(0x208, {1, 50, 0, 0}));
  page.order({Order::Kind::parameter, page.a, "/gyroscope/period_ms", {}, -1});
  CHECK(page.told(page.a) == Strings{"/gyroscope/period_ms: -1 ms is no period: 0 stops the sensor, 50 "
                                     "publishes it twenty times a second"});
  page.order({Order::Kind::parameter, page.a, "/nothing/period_ms", {}, 50});
  page.order({Order::Kind::playback, page.a, {}, "{}"});
  page.order({Order::Kind::publish, page.a, "/gyroscope", R"({"x":1})"});
  CHECK(page.told(page.a) == Strings{"/gyroscope: /gyroscope takes nothing: publish on the channel of an "
                                     "actuator, or lines on /ocm/command"});
  CHECK(page.bus.sent().size() == 1);
}

TEST_CASE("page drive: what a board refuses is said to all, by what was asked") {
  // The board names the number 8, and a period that it cannot keep.
  Page page{{.incoming = {{World::start + 5ms, frame(refusal, {8, 6, 1, 0, 0, 0, 0, 0})},
                          {World::start + 20ms, frame(refusal, {8, 6, 2, 0, 0, 0, 0, 0})}}}};
  page.until(10ms);
  CHECK(page.told(page.a).empty());  // another program asked
  page.line("publish gyro 50ms", page.a);
  page.until(30ms);
  const Strings told = page.told(page.b);
  REQUIRE(told.size() == 1);
  CHECK(
      told[0].starts_with("di_wheel_drive refuses gyroscope: bad_period (a period that the board cannot "
                          "keep); it accepts 1us to 65535s"));
}

TEST_CASE("page drive: a refusal is the answer to a frame that has left just before it") {
  Page page{{.stuck = {{World::start, World::start + 100ms}}}};
  page.line("publish gyro 50ms", page.a);
  CHECK(page.shown == 0);
  page.world.pass(150ms);  // it has left, and nothing has looked since
  page.control.heard({page.world.wall_at(page.world.now()), frame(refusal, {8, 6, 2, 0, 0, 0, 0, 0})});
  CHECK(page.shown == 1);
  const Strings told = page.told(page.b);
  REQUIRE(told.size() == 1);
  CHECK(told[0].starts_with("di_wheel_drive refuses gyroscope: bad_period"));
}

TEST_CASE("page drive: at the end the motors rest, or it is known that they may not") {
  Page page;
  page.holds(0.1, page.a, 0ms, 300ms);
  CHECK(page.control.rest().empty());
  CHECK(page.resting().size() == 1);
  CHECK(page.control.rest().empty());  // nothing is driven

  Page late{{.down = {{World::start + 250ms, World::start + 600ms}}}};
  late.holds(0.1, late.a, 0ms, 300ms);
  late.until(300ms);
  CHECK(late.control.rest().empty());
  REQUIRE(late.resting().size() == 1);
  CHECK(late.resting()[0] >= 600ms);

  Page down{{.down = {{World::start + 250ms, World::start + 1h}}}};
  down.holds(0.1, down.a, 0ms, 300ms);
  down.until(300ms);
  const Moment begin = down.world.now();
  CHECK(down.control.rest().starts_with(
      "serve: 1 frame did not leave can0, and may leave later; THE ROBOT MAY STILL MOVE"));
  CHECK(down.world.now() - begin >= 500ms);
  CHECK(down.world.now() - begin < 520ms);

  // A queue that takes the rest does not carry it.
  Page stuck{{.stuck = {{World::start + 250ms, World::start + 1h}}}};
  stuck.holds(0.1, stuck.a, 0ms, 300ms);
  stuck.until(320ms);
  CHECK(stuck.control.rest().find("; THE ROBOT MAY STILL MOVE") != std::string::npos);
  CHECK(stuck.resting().size() == 1);
  Page still{{.stuck = {{World::start, World::start + 1h}}}};
  still.line("publish gyro 50ms", still.a);
  CHECK(still.control.rest() == "serve: 1 frame did not leave can0, and may leave later");
  Page gone{{.gone = World::start + 250ms}};
  gone.holds(0.1, gone.a, 0ms, 300ms);
  gone.world.wait_until(World::start + 260ms);
  const Moment ended = gone.world.now();
  CHECK_FALSE(gone.control.rest().empty());
  CHECK(gone.world.now() - ended < 20ms);
}

TEST_CASE("page drive: what a board said that it does holds until it says otherwise") {
  PlayedBus::Conditions bus;
  bus.incoming = {{World::start + 10ms, travels()}, {World::start + 2s, at_rest()}};
  Page page{bus};
  page.until(1s);
  page.drives(0.1, page.a);  // it is asked, and does not answer
  page.until(1900ms);
  CHECK(page.questions() == 1);
  CHECK(page.moving().empty());
  CHECK(page.told(page.a) ==
        Strings{"di_wheel_drive drives the wheels by itself: wait for its end, or stop the robot"});
  page.until(2010ms);
  page.drives(0.1, page.a);
  CHECK(page.moving().size() == 1);
}

}  // namespace tool_clock_page_drive_test
