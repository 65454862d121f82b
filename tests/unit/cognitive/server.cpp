#include "ocm/cognitive/server.hpp"

#include <chrono>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/cognitive/testing/virtual_central.hpp"

namespace cognitive_server_test {

using namespace std::chrono_literals;
using namespace ocm::cognitive;
using ocm::base::Duration;
using ocm::base::Time;
using ocm::mapper::link::Kind;
using ocm::test::Random;
using ocm::test::VirtualCentral;

struct Bench {
  VirtualCentral central;
  Server server;
  std::vector<ocm::mapper::server::CentralEvent> events;
  std::vector<std::pair<std::size_t, Kind>> heard;
  Time now{1s};

  void advance(Duration time) {
    for (const Time end = now + time; now < end;) {
      now += 10ms;
      central.advance(now);
      server.expire(now);
      central.write(server.take());
      server.feed(std::exchange(central.to_server, {}), now,
                  [this](std::size_t robot, Kind kind) { heard.emplace_back(robot, kind); });
      central.write(server.take());
      while (auto event = server.next_event()) events.push_back(*event);
    }
  }
  void connect_all() {
    server.client().scan(300ms);
    advance(1s);
    for (const ocm::mapper::server::Peer& peer :
         std::vector<ocm::mapper::server::Peer>{server.client().peers()})
      server.client().connect(peer.index);
    advance(3s);
  }
};

TEST_CASE("server: from nothing to two robots that drive") {
  Bench bench;
  bench.central.add("AVR");
  bench.central.add("Arduino");
  bench.connect_all();
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(bench.central.robots[i].confirmed);
    CHECK(bench.server.fleet().robot(i).confirmed);
    CHECK(bench.server.fleet().robot(i).update);
  }
  CHECK(bench.server.fleet().robot(1).name == "Arduino");
  bench.server.fleet().go(1, {90, 50}, bench.now);
  bench.advance(1500ms);
  CHECK(bench.central.robots[1].heard.back() == "{U,90,50}\n");
  CHECK(bench.server.fleet().robot(1).idle);
  CHECK(bench.server.unsaid() == 0);
  // Nothing of what both sent was torn by the answers between.
  CHECK(bench.server.fleet().quality_per_mille(0) == 1000);
  CHECK(bench.server.fleet().quality_per_mille(1) == 1000);
  CHECK(bench.server.client().stream().cut() == 0);
}

TEST_CASE("server: commands between the packets of robots tear no sentence") {
  Bench bench;
  bench.central.add("AVR");
  bench.central.add("Arduino");
  bench.connect_all();
  for (int i = 0; i < 100; ++i) {
    bench.server.fleet().ping(static_cast<std::size_t>(i % 2));
    if (i % 7 == 0) bench.server.client().scan(0s);
    bench.advance(70ms);
  }
  bench.advance(1s);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(bench.server.fleet().quality_per_mille(i) == 1000);
    CHECK(bench.server.fleet().ear(i).text().faults().total() == 0);
  }
  CHECK(bench.central.robots[0].heard.size() == 51);  // with the answer to the handshake
}

TEST_CASE("server: a link that dies is reported, and what is said into it fails in words") {
  Bench bench;
  bench.central.add("AVR");
  bench.connect_all();
  bench.events.clear();
  bench.central.cut(0);
  bench.advance(100ms);
  REQUIRE(bench.events.size() == 1);
  CHECK(bench.events[0].kind == ocm::mapper::server::CentralEvent::Kind::lost);
  CHECK(bench.server.fleet().robot(0).lost);
  bench.server.fleet().pause(0, bench.now);
  bench.server.client().scan(0s);  // leaves data mode
  bench.server.fleet().pause(0, bench.now);
  bench.advance(1s);
  REQUIRE_FALSE(bench.events.empty());
  CHECK(bench.server.fleet().robot(0).lost);
  // Connected again, it says who it is, again.
  bench.server.client().connect(0);
  bench.advance(3s);
  CHECK_FALSE(bench.server.fleet().robot(0).lost);
  CHECK(bench.central.robots[0].confirmed);
}

TEST_CASE("server: words for which there is no room are as if the air had lost them") {
  Server server{{}, {.most_requests = 1}};
  const Time now{1s};
  server.feed("[0]:A:{S,IDL}\n[0]:A:{U,0,0,0,0,0,0,0,0}\n", now);
  REQUIRE(server.client().scan(0s));  // the only place
  REQUIRE(server.fleet().go(0, {0, 20}, now));
  server.expire(now);
  CHECK(server.unsaid() == 1);
  CHECK(server.fleet().counters().words == 1);
  // So what follows can be said.
  server.fleet().stop(0, now + 1s);
  CHECK(server.fleet().counters().words == 2);
}

TEST_CASE("server: a central with more robots than the fleet has room for is refused") {
  const auto list = [](unsigned most, unsigned index) {
    Server server{{}, {.most_robots = most}};
    const Time now{1s};
    REQUIRE(server.client().scan(0s));
    server.expire(now);
    server.feed("found 0\n", now);  // it was stopped, whatever it did before
    server.feed("found 1\n" + std::to_string(index) + ":C0000000000A:AVR\nend of list\n", now);
    const auto event = server.next_event();
    REQUIRE(event);
    return event->kind == ocm::mapper::server::CentralEvent::Kind::listed ? "listed" : event->words;
  };
  CHECK(list(256, 127) == "listed");
  CHECK(list(256, 128) == "the central lists robot 128, and 128 is the most");
  CHECK(list(128, 128) == "the central lists robot 128, and 128 is the most");
  CHECK(list(2, 2) == "the central lists robot 2, and 2 is the most");
}

TEST_CASE("server: of a central that is silent it is known at once what has failed") {
  Server server;
  REQUIRE(server.client().connect(0));
  std::optional<ocm::mapper::server::CentralEvent> event;
  for (Time now{1s}; !event && now < Time{60s}; now += 50ms) {
    server.expire(now);
    event = server.next_event();
    CHECK(server.client().idle() == event.has_value());
  }
  REQUIRE(event);
  CHECK(event->kind == ocm::mapper::server::CentralEvent::Kind::failed);
}

TEST_CASE("server: links that die at any time: who is lost is lost, who is not is heard") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CAPTURE(seed);
    Random random{seed};
    Bench bench;
    for (const char* name : {"A", "B", "C"}) bench.central.add(name);
    bench.connect_all();
    for (int i = 0; i < 40; ++i) {
      if (random.below(3) == 0) bench.central.cut(random.below(3));
      if (random.below(2) == 0) bench.server.client().connect(random.below(3));
      if (random.below(2) == 0) bench.server.fleet().go(random.below(3), {0, 10}, bench.now);
      bench.advance(Duration{10ms * random.below(100)});
    }
    bench.advance(12s);
    for (std::size_t i = 0; i < 3; ++i) {
      REQUIRE(bench.server.fleet().robot(i).lost == !bench.central.robots[i].linked);
      if (bench.central.robots[i].linked) REQUIRE(bench.now - bench.server.fleet().robot(i).heard < 1s);
    }
  }
}

}  // namespace cognitive_server_test
