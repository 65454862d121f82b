#include "ocm/simulation/radio.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace simulation_radio_test {

using namespace ocm;
using namespace std::chrono_literals;
using mapper::link::Packet;
using simulation::Place;
using simulation::Radio;
using simulation::RadioModel;
using simulation::WayCounters;
using test::Random;

base::Time at(base::Duration time) {
  return base::Time{time};
}
std::int64_t ms(base::Time time) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(time.time_since_epoch()).count();
}

/// A packet that is a number.
Packet numbered(std::uint32_t number) {
  Packet packet;
  for (int i = 0; i < 4; ++i) (void)packet.push(static_cast<std::uint8_t>(number >> (8 * i)));
  return packet;
}
std::uint32_t number_of(const Packet& packet) {
  std::uint32_t number = 0;
  for (int i = 0; i < 4; ++i)
    number |= static_cast<std::uint32_t>(packet.data[static_cast<std::size_t>(i)]) << (8 * i);
  return number;
}

/// Both sides of the radio: what waits to be sent, and all that was reported.
struct Air {
  explicit Air(const RadioModel& model = {}, std::size_t robots = 1) : radio{model} {
    for (std::size_t i = 0; i < robots; ++i) radio.add();
    to_robot.resize(robots);
    to_central.resize(robots);
    got_robot.resize(robots);
    got_central.resize(robots);
    dongle_linked.resize(robots);
    central_linked.resize(robots);
  }

  struct Got {
    base::Time time;
    std::uint32_t number;
  };
  Radio radio;
  std::vector<std::deque<Packet>> to_robot, to_central;
  std::vector<std::vector<Got>> got_robot, got_central;
  std::vector<bool> dongle_linked, central_linked;
  std::string log;  ///< reports: "200 linked 0;", in ms

  static base::Result<Packet> pop(std::deque<Packet>& queue) {
    if (queue.empty()) return base::Error::no_answer;
    const Packet packet = queue.front();
    queue.pop_front();
    return packet;
  }
  void note(const char* what, std::size_t robot) {
    log += std::to_string(ms(radio.time())) + " " + what + " " + std::to_string(robot) + ";";
  }
  base::Result<Packet> next_for_robot(std::size_t robot) { return pop(to_robot[robot]); }
  base::Result<Packet> next_for_central(std::size_t robot) { return pop(to_central[robot]); }
  void at_robot(std::size_t robot, const Packet& packet) {
    CHECK(dongle_linked[robot]);
    got_robot[robot].push_back({radio.time(), number_of(packet)});
  }
  void at_central(std::size_t robot, const Packet& packet) {
    CHECK(central_linked[robot]);
    got_central[robot].push_back({radio.time(), number_of(packet)});
  }
  void found(std::size_t robot) { note("found", robot); }
  void connected(std::size_t robot) {
    central_linked[robot] = true;
    note("connected", robot);
  }
  void closed(std::size_t robot) {
    central_linked[robot] = false;
    note("closed", robot);
  }
  void linked(std::size_t robot, bool on) {
    CHECK(dongle_linked[robot] != on);
    dongle_linked[robot] = on;
    note(on ? "linked" : "unlinked", robot);
  }

  std::string run(base::Duration until) {
    radio.advance(at(until), *this);
    return std::exchange(log, {});
  }
  /// A link with each robot, without a word about it.
  base::Duration link_all() {
    base::Duration now{};
    for (std::size_t i = 0; i < radio.robots(); ++i) radio.advertise(i, true, at(now));
    for (std::size_t i = 0; i < radio.robots(); ++i) {
      radio.connect(i, at(now));
      while (!central_linked[i]) run(now += 10ms);
    }
    log.clear();
    return now;
  }
};

TEST_CASE("the share of lost packets over the distance") {
  const RadioModel model{.range_m = 8, .loss_at_range = 0.5};
  CHECK(loss(model, 0) == 0);
  CHECK(loss(model, 4) == 0);
  CHECK(loss(model, 6) == 0.25);
  CHECK(loss(model, 8) == 0.5);
  CHECK(loss(model, 8.001) == 1);
  CHECK(loss(model, std::nan("")) == 1);
  const RadioModel noisy{.range_m = 8, .loss_at_range = 0.5, .loss_everywhere = 0.1};
  CHECK(loss(noisy, 0) == 0.1);
  CHECK(loss(noisy, 8) == Approx(0.55));
  CHECK(loss(noisy, 9) == 1);
}

TEST_CASE("what is not said of a radio is as the SDK, the thesis and the page of decisions have it") {
  const RadioModel model;
  CHECK(model.range_m == 8);
  CHECK(model.loss_at_range == 0.5);
  CHECK(model.loss_everywhere == 0);
  CHECK(model.delay == 5ms);
  CHECK(model.interval == 30ms);
  CHECK(model.packets == 4);
  CHECK(model.supervision_timeout == 4s);
  CHECK(model.advertising_interval == 100ms);
  CHECK(model.attempt_timeout == 5s);
  CHECK(model.links == 3);
  CHECK_FALSE(model.repeats);
  CHECK(model.seed == 1);
}

TEST_CASE("a distance is that between two places, wherever they are") {
  CHECK(simulation::distance_m({1, 2}, {4, 6}) == 5);
  CHECK(simulation::distance_m({-1, -2}, {-4, -6}) == 5);
  Air air;
  air.radio.place_central({3, 4});
  CHECK(air.radio.distance(0) == 5);  // a robot that is placed nowhere is at the origin
  air.radio.move(0, {6, 8});
  CHECK(air.radio.distance(0) == 5);
}

TEST_CASE("a radio sends at least one packet an event, and its events are at least a nanosecond apart") {
  const Radio radio{RadioModel{.interval = 0ms, .packets = 0, .advertising_interval = 0ms}};
  CHECK(radio.model().packets == 1);
  CHECK(radio.model().interval == 1ns);
  CHECK(radio.model().advertising_interval == 1ns);
}

TEST_CASE("each of the 64 bits of a seed makes another luck") {
  const auto found = [](std::uint64_t seed) {
    Air air{RadioModel{.loss_everywhere = 0.5, .seed = seed}};
    air.radio.advertise(0, true, at(0ms));
    air.radio.start_scan(at(0ms));
    return air.run(20s);  // of 200 advertisements, about a half
  };
  const std::string usual = found(1);
  CHECK(found(1) == usual);
  CHECK(found(2) != usual);
  CHECK(found(0x1'0000'0001) != usual);
  CHECK(found(0x8000'0000'0000'0001) != usual);
}

TEST_CASE("to advertise what advertises already changes nothing") {
  Air air;
  air.radio.advertise(0, true, at(0ms));
  air.radio.advertise(0, true, at(50ms));
  air.radio.start_scan(at(50ms));
  CHECK(air.run(150ms) == "100 found 0;");
}

TEST_CASE("a robot that begins to advertise during a scan is found, until it stops") {
  Air air;
  air.radio.start_scan(at(0ms));
  CHECK(air.radio.next_event() == base::never);
  air.radio.advertise(0, true, at(30ms));
  CHECK(air.radio.next_event() == at(130ms));
  CHECK(air.run(150ms) == "130 found 0;");
  air.radio.advertise(0, false, at(150ms));
  CHECK(air.radio.next_event() == base::never);
  CHECK(air.run(1s) == "");
}

TEST_CASE("a call takes the radio to its time, and a time of the past is the present") {
  Air air;
  air.radio.advertise(0, true, at(0ms));
  SECTION("advertise") {
    air.radio.advertise(0, false, at(50ms));
    CHECK(air.radio.time() == at(50ms));
  }
  SECTION("start_scan: the advertisements at 100 and 200 ms are over") {
    air.radio.start_scan(at(250ms));
    CHECK(air.run(350ms) == "300 found 0;");
  }
  SECTION("connect: so are they") {
    air.radio.connect(0, at(250ms));
    CHECK(air.run(350ms) == "300 linked 0;300 connected 0;");
  }
  SECTION("start_scan just as it advertises: that one is over, too") {
    air.radio.start_scan(at(100ms));
    CHECK(air.run(250ms) == "200 found 0;");
  }
  SECTION("connect, refused") {
    air.radio.connect(0, at(0ms));
    air.radio.connect(0, at(10ms));  // under way already: no report
    air.radio.add();
    air.radio.connect(1, at(70ms));
    CHECK(air.radio.next_event() == at(70ms));
    air.central_linked.resize(2);
    CHECK(air.run(80ms) == "70 closed 1;");
  }
  SECTION("disconnect") {
    air.radio.connect(0, at(0ms));
    air.radio.disconnect(0, at(70ms));
    CHECK(air.radio.next_event() == at(70ms));
    CHECK(air.run(80ms) == "70 closed 0;");
  }
  SECTION("advance, though nothing happens") {
    CHECK(air.run(150ms) == "");
    CHECK(air.radio.time() == at(150ms));
  }
  SECTION("the past") {
    CHECK(air.run(150ms) == "");
    air.radio.disconnect(0, at(20ms));
    CHECK(air.radio.time() == at(150ms));
  }
}

TEST_CASE("found, connected, packets, dropped: each at its millisecond") {
  Air air;
  air.radio.advertise(0, true, at(0ms));  // at 100, 200, ...
  CHECK(air.run(150ms) == "");            // without a scan
  air.radio.start_scan(at(150ms));
  CHECK(air.run(199ms) == "");
  CHECK(air.run(310ms) == "200 found 0;300 found 0;");
  air.radio.stop_scan();
  CHECK(air.radio.next_event() == base::never);
  air.radio.connect(0, at(320ms));
  CHECK(air.radio.links() == 1);
  CHECK(air.run(420ms) == "400 linked 0;400 connected 0;");

  // Events at 430, 460, ...: four packets each way in each.
  for (std::uint32_t i = 1; i <= 5; ++i) air.to_robot[0].push_back(numbered(i));
  air.to_central[0].push_back(numbered(6));
  CHECK(air.run(434ms) == "");
  CHECK(air.got_robot[0].empty());
  CHECK(air.run(435ms) == "");
  REQUIRE(air.got_robot[0].size() == 4);
  REQUIRE(air.got_central[0].size() == 1);
  CHECK(air.got_central[0][0].number == 6);
  air.to_robot[0].push_back(numbered(7));
  CHECK(air.run(600ms) == "");
  REQUIRE(air.got_robot[0].size() == 6);
  for (std::uint32_t i = 0; i < 6; ++i) CHECK(air.got_robot[0][i].number == (i < 5 ? i + 1 : 7));
  CHECK(air.got_robot[0][3].time == at(435ms));
  CHECK(air.got_robot[0][5].time == at(465ms));

  // The goodbye goes with the next event, at 610, and takes its time as packets do.
  air.radio.disconnect(0, at(600ms));
  air.to_robot[0].push_back(numbered(8));
  CHECK(air.run(2s) == "610 closed 0;615 unlinked 0;");
  CHECK(air.got_robot[0].size() == 6);
  CHECK(air.to_robot[0].size() == 1);  // the owner of the queue drops it
  CHECK(air.radio.counters(0).to_robot == WayCounters{6, 6, 0, 0, 0});
  CHECK(air.radio.counters(0).to_central == WayCounters{1, 1, 0, 0, 0});
  CHECK(air.radio.counters(0).links == 1);
  CHECK(air.radio.links() == 0);
  air.radio.start_scan(at(2s));  // it advertises again
  CHECK(air.run(2s + 100ms) == "2015 found 0;");
}

TEST_CASE("a robot that goes out of range: each side finds out by itself, after the time-out") {
  Air air;
  const auto now = air.link_all();  // events each 30 ms from 100 on
  CHECK(now == 100ms);
  CHECK(air.run(1s) == "");
  air.radio.move(0, {8.1, 0});
  air.to_central[0].push_back(numbered(1));
  air.to_robot[0].push_back(numbered(2));
  // Last heard at 1000; 5020 is an event (100 + 30 k).
  CHECK(air.run(5019ms) == "");
  CHECK(air.run(6s) == "5020 closed 0;5020 unlinked 0;");
  CHECK(air.radio.counters(0).central_timeouts == 1);
  CHECK(air.radio.counters(0).robot_timeouts == 1);
  CHECK(air.radio.counters(0).to_robot == WayCounters{1, 0, 1, 0, 0});
  CHECK(air.radio.counters(0).to_central == WayCounters{1, 0, 1, 0, 0});
  CHECK(air.got_robot[0].empty());

  // Not found there, found when it is back.
  air.radio.start_scan(at(6s));
  CHECK(air.run(8s) == "");
  air.radio.connect(0, at(8s));
  CHECK(air.run(14s) == "13000 closed 0;");  // an attempt of 5 s
  CHECK(air.radio.counters(0).failed == 1);
  air.radio.stop_scan();
  air.radio.move(0, {0, 7});
  air.radio.connect(0, at(14s));
  CHECK(air.run(16s) != "");
  CHECK(air.central_linked[0]);
  CHECK(air.radio.counters(0).links == 2);
}

TEST_CASE("back within the time-out, nothing has ended") {
  Air air;
  (void)air.link_all();
  CHECK(air.run(1s) == "");
  air.radio.move(0, {100, 0});
  CHECK(air.run(4900ms) == "");
  air.radio.move(0, {1, 0});
  CHECK(air.run(60s) == "");
}

TEST_CASE("a goodbye that is not heard: the robot's dongle keeps its link until the time-out") {
  Air air;
  (void)air.link_all();
  CHECK(air.run(1s) == "");
  air.radio.move(0, {9, 0});
  air.radio.disconnect(0, at(1s));
  CHECK(air.run(1100ms) == "1030 closed 0;");
  air.radio.move(0, {1, 0});
  air.radio.connect(0, at(1100ms));  // it does not advertise yet
  CHECK(air.run(5400ms) == "5020 unlinked 0;5120 linked 0;5120 connected 0;");
}

TEST_CASE("more links than there can be, and two attempts at once, are refused") {
  Air air{RadioModel{.links = 2}, 4};
  for (std::size_t i = 0; i < 4; ++i) air.radio.advertise(i, true, at(0ms));
  air.radio.connect(0, at(0ms));
  air.radio.connect(1, at(0ms));
  CHECK(air.run(50ms) == "0 closed 1;");
  CHECK(air.radio.counters(1).refused == 1);
  CHECK(air.run(150ms) == "100 linked 0;100 connected 0;");
  air.radio.connect(0, at(150ms));  // has one already
  CHECK(air.run(160ms) == "150 connected 0;");
  air.radio.connect(1, at(160ms));
  CHECK(air.run(250ms) == "200 linked 1;200 connected 1;");
  air.radio.connect(2, at(250ms));
  CHECK(air.run(900ms) == "250 closed 2;");
  air.radio.disconnect(0, at(900ms));
  CHECK(air.run(950ms) == "910 closed 0;915 unlinked 0;");
  air.radio.connect(3, at(950ms));
  CHECK(air.run(1s) == "1000 linked 3;1000 connected 3;");
  // An attempt that is called off.
  air.radio.disconnect(1, at(1s));
  CHECK(air.run(1050ms) == "1010 closed 1;1015 unlinked 1;");
  air.radio.connect(2, at(1050ms));
  air.radio.disconnect(2, at(1060ms));
  CHECK(air.run(2s) == "1060 closed 2;");
}

TEST_CASE("a central that restarts reports nothing about before, and robots run into their time-out") {
  Air air{RadioModel{}, 3};
  (void)air.link_all();
  air.run(1s);
  air.to_robot[0].push_back(numbered(1));
  air.to_central[1].push_back(numbered(2));
  air.run(1012ms);  // of 1 it is in the air since 1010, of 0 it waits for 1030
  air.radio.disconnect(2, at(1012ms));
  air.radio.restart();
  air.central_linked.assign(3, false);
  const std::string after = air.run(10s);
  CHECK(after.find("closed") == std::string::npos);
  CHECK(std::count(after.begin(), after.end(), ';') == 3);  // unlinked, each
  CHECK(air.got_central[1].empty());
  CHECK(air.radio.counters(1).to_central.dropped == 1);
  CHECK(air.radio.links() == 0);
  air.radio.start_scan(at(10s));
  CHECK(air.run(11s).find("found 2") != std::string::npos);
}

TEST_CASE("a central that restarts neither scans nor connects") {
  Air air;
  air.radio.advertise(0, true, at(0ms));
  air.radio.start_scan(at(0ms));
  air.radio.connect(0, at(0ms));
  air.radio.restart();
  CHECK(air.radio.links() == 0);
  CHECK(air.radio.next_event() == base::never);
  CHECK(air.run(10s) == "");
}

TEST_CASE("a central that restarts just as a link comes about: the dongle hears of the link, and loses it") {
  struct Restarting : Air {
    void found(std::size_t robot) {
      Air::found(robot);
      radio.restart();
    }
  } air;
  air.radio.advertise(0, true, at(0ms));
  air.radio.start_scan(at(0ms));
  air.radio.connect(0, at(0ms));
  air.radio.advance(at(5s), air);
  // Heard last at 100 ms; the first event 4 s later is that at 100 + 134 * 30.
  CHECK(air.log == "100 found 0;100 linked 0;4120 unlinked 0;");
}

TEST_CASE("lost packets are as many as the model says, each way, and both ways by themselves") {
  for (const double distance : {0.0, 4.5, 5.0, 6.0, 7.0, 8.0}) {
    for (const double everywhere : {0.0, 0.03}) {
      Air air{RadioModel{.loss_everywhere = everywhere, .supervision_timeout = 1h, .seed = 5}};
      auto now = air.link_all();
      air.radio.move(0, {0, -distance});
      constexpr std::uint32_t packets = 20'000;
      for (std::uint32_t i = 0; i < packets; ++i) {
        air.to_robot[0].push_back(numbered(i));
        air.to_central[0].push_back(numbered(i));
      }
      air.run(now + 30ms * (packets / 4) + 1s);
      const double share = loss(air.radio.model(), distance);
      const double bound = 5 * std::sqrt(packets * share * (1 - share));  // five sigma
      const auto lost_by = [](const std::vector<Air::Got>& got) {
        std::vector<bool> lost(packets, true);
        for (const auto& one : got) lost[one.number] = false;
        return lost;
      };
      const auto down = lost_by(air.got_robot[0]);
      const auto up = lost_by(air.got_central[0]);
      const auto count = [](const auto& lost) {
        return static_cast<double>(std::count(lost.begin(), lost.end(), true));
      };
      INFO("distance " << distance);
      CHECK(std::abs(count(down) - packets * share) <= bound);
      CHECK(std::abs(count(up) - packets * share) <= bound);
      double both = 0, two_in_a_row = 0;
      for (std::size_t i = 0; i < packets; ++i) both += down[i] && up[i] ? 1 : 0;
      for (std::size_t i = 1; i < packets; ++i) two_in_a_row += down[i - 1] && down[i] ? 1 : 0;
      const double square = share * share;
      // Neighbours overlap, which widens the second by no more than this.
      CHECK(std::abs(both - packets * square) <= 5 * std::sqrt(packets * square * (1 - square)));
      CHECK(std::abs(two_in_a_row - packets * square) <= 10 * std::sqrt(packets * square));
      const WayCounters& way = air.radio.counters(0).to_robot;
      CHECK(way.taken == packets);
      CHECK(way.delivered == air.got_robot[0].size());
      CHECK(way.delivered + way.lost == packets);
      CHECK(way.dropped == 0);
    }
  }
}

TEST_CASE("with repetition nothing is lost while the link lasts, order stays, and a bad link is slow") {
  base::Time last_good{};
  for (const double distance : {1.0, 8.0}) {
    Air air{RadioModel{.repeats = true}};
    auto now = air.link_all();
    air.radio.move(0, {distance, 0});
    for (std::uint32_t i = 0; i < 4000; ++i) {
      air.to_robot[0].push_back(numbered(i));
      air.to_central[0].push_back(numbered(i));
    }
    air.run(now + 10min);
    REQUIRE(air.got_robot[0].size() == 4000);
    REQUIRE(air.got_central[0].size() == 4000);
    for (std::uint32_t i = 0; i < 4000; ++i) {
      CHECK(air.got_robot[0][i].number == i);
      CHECK(air.got_central[0][i].number == i);
    }
    CHECK(air.radio.counters(0).to_robot.lost == 0);
    if (distance < 4) {
      CHECK(air.radio.counters(0).to_robot.repeated == 0);
      last_good = air.got_robot[0].back().time;
      CHECK(last_good == at(now + 1000 * 30ms + 5ms));
    } else {
      // An event goes on until its first loss: 1/2 + 1/4 + 1/8 + 1/16 packets on average, instead of 4.
      const double events = static_cast<double>((air.got_robot[0].back().time - at(now)) / 30ms);
      CHECK(events == Approx(4000 / 0.9375).epsilon(0.1));
      CHECK(air.radio.counters(0).to_robot.repeated > 3000);
    }
  }
}

TEST_CASE("a packet waits for its turn and its event, and no longer") {
  Random random{62};
  Air air{RadioModel{.delay = 7ms, .interval = 20ms, .packets = 3}};
  base::Duration now = air.link_all();
  std::vector<base::Time> latest;  // by number
  std::vector<base::Time> written;
  for (int step = 0; step < 3000; ++step) {
    now += base::Duration{random.below(25'000'000)};
    air.run(now);
    for (auto n = random.below(4); n > 0; --n) {
      air.to_robot[0].push_back(numbered(static_cast<std::uint32_t>(latest.size())));
      const auto events = static_cast<std::int64_t>((air.to_robot[0].size() + 2) / 3);
      written.push_back(at(now));
      latest.push_back(at(now + events * 20ms + 7ms));
    }
  }
  air.run(now + 10s);
  REQUIRE(air.got_robot[0].size() == latest.size());
  for (std::size_t i = 0; i < latest.size(); ++i) {
    CHECK(air.got_robot[0][i].number == i);
    CHECK(air.got_robot[0][i].time <= latest[i]);
    CHECK(air.got_robot[0][i].time >= written[i] + 7ms);
  }
}

TEST_CASE("links that come and go: order within a link, nothing of one in the next, all accounted for") {
  for (const bool repeats : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      constexpr std::size_t robots = 3;
      Random random{seed};
      Air air{RadioModel{.range_m = 5, .supervision_timeout = 200ms, .repeats = repeats, .seed = seed},
              robots};
      for (std::size_t i = 0; i < robots; ++i) air.radio.advertise(i, true, at(0s));
      base::Duration now{};
      std::uint32_t number = 0;
      std::array<std::uint32_t, robots> first_of_robot{}, first_of_central{};
      std::array<std::size_t, robots> seen_robot{}, seen_central{};
      for (int step = 0; step < 3000; ++step) {
        now += base::Duration{random.below(20'000'000)};
        const auto central_before = air.central_linked;
        air.run(now);
        for (std::size_t i = 0; i < robots; ++i) {
          // The owner of a queue drops it with its link: so do these. Numbers of the next link are higher.
          if (!air.dongle_linked[i]) air.to_central[i].clear();
          if (!air.central_linked[i]) air.to_robot[i].clear();
          for (auto& k = seen_robot[i]; k < air.got_robot[i].size(); ++k) {
            CHECK(air.got_robot[i][k].number >= first_of_robot[i]);
            first_of_robot[i] = air.got_robot[i][k].number + 1;
          }
          for (auto& k = seen_central[i]; k < air.got_central[i].size(); ++k) {
            CHECK(air.got_central[i][k].number >= first_of_central[i]);
            first_of_central[i] = air.got_central[i][k].number + 1;
          }
          if (!central_before[i] && air.central_linked[i]) first_of_central[i] = number;
        }
        const std::size_t i = random.below(robots);
        switch (random.below(12)) {
          case 0:
            air.radio.move(i, {random.below(8) * 1.0, 0});
            break;
          case 1:
            air.radio.connect(i, at(now));
            break;
          case 2:
            if (random.below(4) == 0) air.radio.disconnect(i, at(now));
            break;
          default:
            if (air.central_linked[i]) air.to_robot[i].push_back(numbered(number++));
            if (air.dongle_linked[i]) air.to_central[i].push_back(numbered(number++));
        }
      }
      std::uint64_t links = 0;
      for (std::size_t i = 0; i < robots; ++i) {
        air.to_robot[i].clear();
        air.to_central[i].clear();
        air.radio.disconnect(i, at(now));
      }
      air.run(now + 10s);
      for (std::size_t i = 0; i < robots; ++i) {
        const auto& counters = air.radio.counters(i);
        links += counters.links;
        for (const WayCounters& way : {counters.to_robot, counters.to_central})
          CHECK(way.taken == way.delivered + way.lost + way.dropped);
        CHECK(counters.to_robot.delivered == air.got_robot[i].size());
      }
      CHECK(links > 5);
    }
  }
}

TEST_CASE("what is long under way when its link ends does not arrive on the next one") {
  Air air{RadioModel{.delay = 1s, .supervision_timeout = 90ms}};
  const auto now = air.link_all();
  air.run(now + 1s);
  air.to_robot[0].push_back(numbered(1));
  air.to_central[0].push_back(numbered(2));
  air.run(now + 1030ms);
  CHECK(air.to_robot[0].empty());
  air.radio.move(0, {100, 0});
  air.run(now + 1200ms);
  CHECK_FALSE(air.central_linked[0]);
  CHECK_FALSE(air.dongle_linked[0]);
  air.radio.move(0, {1, 0});
  air.radio.connect(0, at(now + 1200ms));
  air.run(now + 1500ms);
  CHECK(air.central_linked[0]);
  CHECK(air.dongle_linked[0]);
  air.run(now + 3s);
  CHECK(air.got_robot[0].empty());
  CHECK(air.got_central[0].empty());
  CHECK(air.radio.counters(0).to_robot == WayCounters{1, 0, 0, 0, 1});
  CHECK(air.radio.counters(0).to_central == WayCounters{1, 0, 0, 0, 1});
}

TEST_CASE("a robot's luck does not depend on others, and is another with another seed") {
  const auto story = [](std::size_t robots, std::uint64_t seed) {
    Air air{RadioModel{.links = 8, .seed = seed}, robots};
    air.radio.move(0, {7, 0});
    for (std::size_t i = 0; i < robots; ++i) air.radio.advertise(i, true, at(0s));
    air.radio.connect(0, at(0s));
    air.run(1s);
    for (std::size_t i = 1; i < 3; ++i) {
      if (i < robots) air.radio.connect(i, at(i * 1s));
      air.run((i + 1) * 1s);
    }
    for (std::uint32_t i = 0; i < 500; ++i)
      for (std::size_t robot = 0; robot < robots; ++robot) air.to_central[robot].push_back(numbered(i));
    air.run(20s);
    std::vector<std::uint32_t> got;
    for (const auto& one : air.got_central[0]) got.push_back(one.number);
    return got;
  };
  CHECK(story(1, 1).size() > 250);
  CHECK(story(1, 1) == story(3, 1));
  CHECK(story(1, 1) != story(1, 2));
}

/// The rules once more, millisecond by millisecond and without luck: nothing is lost within the range and
/// everything beyond.
struct Naive {
  struct Robot {
    bool near = true, central_up = false, robot_up = false, closing = false;
    std::int64_t event = 0, advert = 100, central_heard = 0, robot_heard = 0, link = 0;
    std::deque<std::uint32_t> to_robot, to_central;
  };
  struct Flying {
    std::int64_t time;
    std::size_t robot;
    std::int64_t link;
    int what;  // 0 to the robot, 1 to the central, 2 goodbye
    std::uint32_t number;
  };
  std::vector<Robot> robots;
  std::deque<Flying> flying;
  int attempt = -1;
  std::int64_t attempt_ends = 0;
  std::vector<std::string> events;

  void note(std::int64_t now, const std::string& what, std::size_t robot) {
    events.push_back(std::to_string(now) + " " + what + " " + std::to_string(robot));
  }
  std::size_t links() const {
    std::size_t n = attempt >= 0 ? 1 : 0;
    for (const Robot& robot : robots) n += robot.central_up ? 1 : 0;
    return n;
  }
  void connect(std::size_t i, std::int64_t now) {
    if (attempt == static_cast<int>(i)) return;
    if (robots[i].central_up) return note(now, "connected", i);
    if (attempt >= 0 || links() >= 2) return note(now, "closed", i);
    attempt = static_cast<int>(i);
    attempt_ends = now + 5000;
  }
  void disconnect(std::size_t i, std::int64_t now) {
    if (attempt == static_cast<int>(i)) {
      attempt = -1;
      note(now, "closed", i);
    } else if (robots[i].central_up) {
      robots[i].closing = true;
    }
  }
  void millisecond(std::int64_t now) {
    while (!flying.empty() && flying.front().time == now) {
      const Flying f = flying.front();
      flying.pop_front();
      Robot& r = robots[f.robot];
      const bool up = f.what == 1 ? r.central_up : r.robot_up;
      if (!up || r.link != f.link) continue;
      if (f.what == 2) {
        r.robot_up = false;
        r.advert = now + 100;
        note(now, "unlinked", f.robot);
      } else {
        note(now, (f.what == 0 ? "down " : "up ") + std::to_string(f.number), f.robot);
      }
    }
    for (std::size_t i = 0; i < robots.size(); ++i) {
      Robot& r = robots[i];
      if ((r.central_up || r.robot_up) && r.event == now) {
        r.event += 30;
        if (r.central_up && r.closing) {
          if (r.robot_up && r.near) flying.push_back({now + 5, i, r.link, 2, 0});
          r.central_up = r.closing = false;
          note(now, "closed", i);
        } else if (r.central_up && r.robot_up) {
          for (int n = 0; n < 4 && !r.to_robot.empty(); ++n) {
            if (r.near) flying.push_back({now + 5, i, r.link, 0, r.to_robot.front()});
            r.to_robot.pop_front();
          }
          for (int n = 0; n < 4 && !r.to_central.empty(); ++n) {
            if (r.near) flying.push_back({now + 5, i, r.link, 1, r.to_central.front()});
            r.to_central.pop_front();
          }
          if (r.near) r.central_heard = r.robot_heard = now;
        }
        if (r.central_up && now - r.central_heard >= 300) {
          r.central_up = r.closing = false;
          note(now, "closed", i);
        }
        if (r.robot_up && now - r.robot_heard >= 300) {
          r.robot_up = false;
          r.advert = now + 100;
          note(now, "unlinked", i);
        }
      }
      while (r.advert < now) r.advert += 100;
      if (!r.robot_up && r.advert == now) {
        r.advert += 100;
        if (attempt == static_cast<int>(i) && r.near) {
          attempt = -1;
          r.central_up = r.robot_up = true;
          r.closing = false;
          ++r.link;
          r.central_heard = r.robot_heard = now;
          r.event = now + 30;
          note(now, "linked", i);
          note(now, "connected", i);
        }
      }
    }
    if (attempt >= 0 && attempt_ends == now) {
      note(now, "closed", static_cast<std::size_t>(attempt));
      attempt = -1;
    }
  }
};

TEST_CASE("random lives of three robots are as a plain model has them") {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    constexpr std::size_t robots = 3;
    Random random{seed};
    Air air{RadioModel{.range_m = 4, .loss_at_range = 0, .supervision_timeout = 300ms, .links = 2}, robots};
    Naive naive;
    naive.robots.resize(robots);
    for (std::size_t i = 0; i < robots; ++i) air.radio.advertise(i, true, at(0s));
    std::uint32_t number = 0;
    std::vector<std::string> events;
    for (std::int64_t now = 1; now < 20'000; ++now) {
      air.radio.advance(at(now * 1ms), air);
      naive.millisecond(now);
      if (random.below(10) != 0) continue;
      const std::size_t i = random.below(robots);
      switch (random.below(20)) {
        case 0:
          naive.robots[i].near = random.below(3) != 0;
          air.radio.move(i, {naive.robots[i].near ? 3.9 : 4.1, 0});
          break;
        case 1:
        case 2:
          air.radio.connect(i, at(now * 1ms));
          naive.connect(i, now);
          break;
        case 3:
          air.radio.disconnect(i, at(now * 1ms));
          naive.disconnect(i, now);
          break;
        default:
          air.to_robot[i].push_back(numbered(number));
          naive.robots[i].to_robot.push_back(number++);
          air.to_central[i].push_back(numbered(number));
          naive.robots[i].to_central.push_back(number++);
      }
    }
    // Of a millisecond the order across robots does not matter.
    const auto add = [&events](std::int64_t time, const std::string& what, std::size_t robot) {
      events.push_back(std::to_string(time) + " " + what + " " + std::to_string(robot));
    };
    for (std::size_t i = 0; i < robots; ++i) {
      for (const auto& got : air.got_robot[i]) add(ms(got.time), "down " + std::to_string(got.number), i);
      for (const auto& got : air.got_central[i]) add(ms(got.time), "up " + std::to_string(got.number), i);
      CHECK(air.got_robot[i].size() > 20);
    }
    for (std::size_t begin = 0; begin < air.log.size();) {
      const std::size_t end = air.log.find(';', begin);
      events.push_back(air.log.substr(begin, end - begin));
      begin = end + 1;
    }
    std::sort(events.begin(), events.end());
    std::sort(naive.events.begin(), naive.events.end());
    CHECK(events == naive.events);
  }
}

}  // namespace simulation_radio_test
