#include "ocm/mapper/server/central_client.hpp"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/cognitive/testing/virtual_central.hpp"

namespace mapper_server_central_client_test {

using namespace std::chrono_literals;
using namespace ocm::mapper::server;
using ocm::base::Duration;
using ocm::base::Time;
using ocm::test::Random;
using ocm::test::VirtualCentral;
using Event = CentralEvent::Kind;

/// A client at a central. Time goes in steps of 10 ms; the serial line carries everything, unless `loses`.
struct Bench {
  VirtualCentral central;
  CentralClient client;
  std::vector<CentralEvent> events;
  bool loses = false;  ///< what the central says
  std::string answers;
  Time now{};

  void advance(Duration time) {
    for (const Time end = now + time; now < end;) {
      now += 10ms;
      central.advance(now);
      client.expire(now);
      central.write(client.take());
      const std::string said = std::exchange(central.to_server, {});
      answers += said;
      if (!loses) client.feed(said, now);
      central.write(client.take());
      while (auto event = client.next_event()) events.push_back(*event);
    }
  }
  int count(Event kind) const {
    int n = 0;
    for (const auto& event : events) n += event.kind == kind ? 1 : 0;
    return n;
  }
  std::string words() const { return events.empty() ? "" : events.back().words; }
};

TEST_CASE("central client: scans, lists, connects, speaks") {
  Bench bench;
  bench.central.add("AVR");
  bench.central.add("Arduino");
  bench.client.scan(500ms);
  bench.advance(2s);
  REQUIRE(bench.count(Event::listed) == 1);
  REQUIRE(bench.client.peers().size() == 2);
  CHECK(bench.client.peers()[1] == Peer{1, "C00000000002", "Arduino", false});
  bench.client.connect(0);
  bench.client.connect(1);
  bench.client.say(0, "{S,CON}\n");
  bench.client.say(1, "{U,90,50}\n");
  bench.advance(4s);
  CHECK(bench.count(Event::connected) == 2);
  CHECK(bench.count(Event::failed) == 0);
  CHECK(bench.client.peers()[0].linked);
  CHECK(bench.central.robots[0].heard == std::vector<std::string>{"{S,CON}\n"});
  CHECK(bench.central.robots[1].heard == std::vector<std::string>{"{U,90,50}\n"});
  CHECK(bench.client.idle());
  CHECK(bench.central.central.counters().refused_commands == 0);
}

TEST_CASE("central client: a list that is lost is asked for again, without another scan") {
  Bench bench;
  bench.central.add("AVR");
  bench.client.scan(20s);
  bench.advance(19900ms);
  bench.loses = true;
  bench.advance(500ms);
  bench.loses = false;
  CHECK(bench.count(Event::listed) == 0);
  bench.advance(10s);
  CHECK(bench.count(Event::listed) == 1);
  CHECK(bench.client.peers().size() == 1);
  CHECK(bench.client.counters().timeouts == 1);
}

TEST_CASE("central client: a list with more than there is room for is refused, and the one before stays") {
  Bench bench;
  bench.client = CentralClient{{.most_robots = 1}};
  bench.central.add("AVR");
  bench.client.scan(500ms);
  bench.advance(2s);
  CHECK(bench.count(Event::failed) == 0);
  bench.central.add("Arduino");
  bench.client.scan(500ms);
  bench.advance(2s);
  CHECK(bench.count(Event::failed) == 1);
  CHECK(bench.words() == "the central lists robot 1, and 1 is the most");
  CHECK(bench.client.peers().size() == 1);
  CHECK(bench.client.idle());
}

TEST_CASE("central client: takes over from a program that died in data mode, or within a command") {
  for (const char* rest :
       {"conn 0\n{U,9", "swi", "start\n", "conn 0\n", "*", "start\nlis", "0123456789012345678"}) {
    CAPTURE(rest);
    Bench bench;
    bench.central.add("AVR");
    bench.central.write("start\n");
    bench.advance(50ms);
    bench.central.write(rest);
    bench.advance(1s);
    bench.client.scan(300ms);
    bench.advance(3s);
    CHECK(bench.count(Event::failed) == 0);
    REQUIRE(bench.client.peers().size() == 1);
    bench.client.connect(0);
    bench.client.say(0, "{S,PAU}\n");
    bench.advance(3s);
    REQUIRE_FALSE(bench.central.robots[0].heard.empty());
    CHECK(bench.central.robots[0].heard.back() == "{S,PAU}\n");
    CHECK(bench.client.peers()[0].linked);
  }
}

TEST_CASE("central client: a link that is there already stays, and is said to be connected") {
  Bench bench;
  bench.central.add("AVR");
  bench.central.write("start\n");
  bench.advance(50ms);
  bench.central.write("conn 0\n{S,CON}\n");
  bench.loses = true;  // another program's
  bench.advance(1s);
  bench.loses = false;
  bench.client.scan(0s);
  bench.advance(100ms);
  bench.client.connect(0);
  bench.advance(100ms);
  CHECK(bench.count(Event::connected) == 1);
  CHECK(bench.answers.find("data 0") != std::string::npos);
  CHECK(bench.central.robots[0].heard == std::vector<std::string>{"{S,CON}\n"});
}

TEST_CASE("central client: refusals end a request with the central's own words") {
  Bench bench;
  for (const char* name : {"a", "b", "c", "d"}) bench.central.add(name);
  bench.client.scan(300ms);
  bench.advance(1s);
  for (unsigned i = 0; i < 4; ++i) bench.client.connect(i);
  bench.advance(5s);
  CHECK(bench.count(Event::connected) == 3);
  REQUIRE(bench.count(Event::failed) == 1);
  CHECK(bench.words() == "the central refuses d: no more links than 3; drop one");
  bench.client.say(3, "{}\n");
  bench.advance(1s);
  CHECK(bench.words() == "the central refuses d: no link to 3; conn first");
  bench.client.connect(9);
  bench.advance(1s);
  CHECK(bench.words() == "the central refuses robot 9: not in the list; see list");
  bench.client.drop(0);
  bench.advance(1s);
  CHECK(bench.count(Event::lost) == 1);
  bench.client.connect(3);
  bench.advance(2s);
  CHECK(bench.count(Event::connected) == 4);
}

TEST_CASE("central client: a robot that does not answer") {
  Bench bench;
  bench.central.add("AVR");
  bench.client.scan(300ms);
  bench.advance(1s);
  bench.central.robots[0].reachable = false;
  bench.client.connect(0);
  bench.advance(2s);
  CHECK(bench.count(Event::failed) == 1);
  CHECK(bench.words() == "the central refuses AVR: no link to 0");
  // One that never comes: the attempt is ended, so that others may be connected.
  bench.central.connecting = 60s;
  bench.client.connect(0);
  bench.advance(12s);
  REQUIRE(bench.count(Event::failed) == 2);
  CHECK(bench.central.central.links() == 0);
  bench.central.connecting = 100ms;
  bench.central.robots[0].reachable = true;
  bench.client.connect(0);
  bench.advance(2s);
  CHECK(bench.count(Event::connected) == 1);
}

TEST_CASE("central client: no central at the line") {
  Bench bench;
  bench.loses = true;
  bench.client.scan(1s);
  bench.client.say(0, "{}\n");
  bench.advance(2900ms);
  CHECK(bench.events.empty());
  bench.advance(200ms);
  REQUIRE(bench.count(Event::failed) == 1);
  CHECK(bench.words() == "the central does not answer");
  CHECK(bench.client.counters().timeouts == 3);
  bench.advance(2800ms);  // the next request has three attempts of its own
  CHECK(bench.count(Event::failed) == 1);
  CHECK(bench.client.counters().timeouts == 5);
  bench.advance(200ms);
  CHECK(bench.count(Event::failed) == 2);
  CHECK(bench.client.counters().timeouts == 6);
  CHECK(bench.client.idle());
}

TEST_CASE("central client: a line that answers nothing is a stray, and moves no request on") {
  CentralClient client;
  CHECK(client.scan(0ms));
  client.expire({});
  client.feed("command\nfound 0\n", {});  // settled
  REQUIRE(client.take() == "*\nstop\nstop\nlist\n");
  CHECK(client.counters().strays == 1);  // an answer to `*`, which `stop` ends
  // Neither the end of an old list nor an old scan is the answer to `stop`.
  client.feed("scanning\nend of list\n", {});
  CHECK(client.counters().strays == 3);
  client.feed("found 1\nfound 1\n0:C0000000000A:AVR\nend of list\n", {});
  CHECK(client.counters().strays == 4);
  CHECK(client.peers().size() == 1);
  CHECK(client.idle());
}

TEST_CASE("central client: the central is reset") {
  Bench bench;
  bench.central.add("AVR");
  bench.client.scan(300ms);
  bench.advance(1s);
  bench.client.connect(0);
  bench.advance(1s);
  bench.central.write("*\nreset\n");
  bench.advance(1s);
  CHECK(bench.count(Event::lost) == 1);
  CHECK_FALSE(bench.client.peers()[0].linked);
  bench.client.scan(300ms);
  bench.advance(1s);
  bench.client.connect(0);
  bench.advance(1s);
  CHECK(bench.count(Event::connected) == 2);
}

TEST_CASE("central client: each request waits for a busy central with a time of its own") {
  Bench bench;
  for (const char* name : {"a", "b", "c"}) bench.central.add(name);
  bench.client.scan(300ms);
  bench.advance(1s);
  bench.central.connecting = 6s;
  for (const unsigned robot : {0U, 2U}) {
    bench.central.write("conn 1\n");  // another program's
    bench.client.connect(robot);
    bench.advance(20s);
    CHECK(bench.client.peers()[robot].linked);
    bench.central.write("drop 1\n");
    bench.advance(1s);
  }
  CHECK(bench.count(Event::failed) == 0);
}

TEST_CASE("central client: the queue is bounded") {
  CentralClientOptions options;
  options.most_requests = 2;
  CentralClient client{options};
  CHECK(client.say(0, "a"));
  CHECK(client.say(0, "b"));
  CHECK_FALSE(client.say(0, "c"));
  CentralClient usual;
  for (int n = 0; n < 64; ++n) CHECK(usual.say(0, "a"));
  CHECK_FALSE(usual.say(0, "a"));
}

TEST_CASE(
    "central client: any requests, links that die, answers that get lost: all ends, no robot hears another's "
    "words") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    Random random{seed};
    Bench bench;
    const unsigned robots = 1 + random.below(4);
    for (unsigned i = 0; i < robots; ++i) bench.central.add("R" + std::to_string(i));
    bench.central.write(random.below(2) == 0 ? "start\n" : "swit");
    bench.client.scan(300ms);
    bench.advance(2s);
    unsigned requests = 1, said = 0;
    for (int i = 0; i < 120; ++i) {
      const unsigned index = random.below(robots);
      switch (random.below(8)) {
        case 0:
          bench.client.scan(random.below(2) == 0 ? 0ms : 200ms);
          ++requests;
          break;
        case 1:
        case 2:
          bench.client.connect(index);
          ++requests;
          break;
        case 3:
        case 4:
          bench.client.say(index, "{" + std::to_string(index) + "}\n");
          ++requests;
          ++said;
          break;
        case 5:
          bench.central.cut(index);
          break;
        case 6:
          if (random.below(4) == 0) bench.client.drop(index), ++requests;
          break;
        default:
          bench.loses = random.below(4) == 0;
          bench.central.robots[index].reachable = random.below(6) != 0;
          break;
      }
      bench.advance(Duration{10ms * random.below(60)});
    }
    bench.loses = false;
    for (int i = 0; i < 120 && !bench.client.idle(); ++i) bench.advance(2s);
    REQUIRE(bench.client.idle());
    // Settled again: what is requested now succeeds.
    for (auto& robot : bench.central.robots) robot.reachable = true;
    bench.client.scan(300ms);
    bench.advance(2s);
    REQUIRE(bench.client.peers().size() == robots);
    bench.client.connect(0);
    bench.client.say(0, "{0}\n");
    bench.advance(6s);
    if (bench.client.peers()[0].linked) {
      REQUIRE_FALSE(bench.central.robots[0].heard.empty());
      CHECK(bench.central.robots[0].heard.back() == "{0}\n");
    }
    CHECK(bench.client.peers()[0].linked == bench.central.robots[0].linked);
    for (unsigned i = 0; i < robots; ++i)
      for (const std::string& words : bench.central.robots[i].heard)
        REQUIRE(words == "{" + std::to_string(i) + "}\n");
    CHECK(bench.count(Event::said) <= static_cast<int>(said) + 1);
    CHECK(bench.count(Event::listed) + bench.count(Event::said) + bench.count(Event::failed) > 0);
    CHECK(requests > 1);
  }
}

/// A client to which each word of its central, and the time, comes by hand. It knows two robots.
struct Hand {
  explicit Hand(const CentralClientOptions& options = {}) : client{options} {
    client.scan(0ms);
    wait(0ms);
    hear("found 0\n");
    hear("found 2\n0:C0000000000A:AVR\n1:C0000000000B:B\nend of list\n");
    (void)client.take();
    (void)event();
  }
  void hear(std::string_view words) { client.feed(words, now); }
  void wait(Duration time) {
    now += time;
    client.expire(now);
  }
  /// The next event in words, or nothing.
  std::string event() {
    const auto next = client.next_event();
    if (!next) return "";
    constexpr const char* kinds[] = {"listed", "connected", "lost", "said", "failed"};
    return std::string{kinds[static_cast<int>(next->kind)]} + " " + std::to_string(next->index) +
           (next->saying ? ", not said" : "") + (next->words.empty() ? "" : ": " + next->words);
  }

  CentralClient client;
  Time now{1s};
};

TEST_CASE("central client: answers that are lost before a scan do not shorten it, one behind it does") {
  CentralClient client{{.most_attempts = 9}};
  CHECK(client.scan(5s));
  client.expire(Time{1s});
  CHECK(client.take() == "*\nstop\n");
  client.expire(Time{2s} - 1ns);
  CHECK(client.take().empty());
  client.expire(Time{2s});
  CHECK(client.take() == "*\nstop\n");
  client.feed("found 0\n", Time{2s});
  CHECK(client.take() == "start\n");
  client.expire(Time{3s});
  CHECK(client.take() == "*\nstop\n");
  client.feed("found 0\n", Time{3s});
  CHECK(client.take() == "start\n");
  client.feed("scanning\n", Time{3s});
  client.expire(Time{8s} - 1ns);
  CHECK(client.take().empty());
  client.expire(Time{8s});
  CHECK(client.take() == "stop\nlist\n");
  client.feed("found 1\n", Time{8s});
  client.expire(Time{9s});  // and the list was lost
  CHECK(client.take() == "*\nstop\n");
  client.feed("found 1\n", Time{9s});
  CHECK(client.take() == "stop\nlist\n");
  CHECK(client.counters().timeouts == 3);
  CHECK(client.counters().settled == 4);
}

TEST_CASE("central client: a central that scans already scans for as long as was asked for") {
  Hand hand;
  hand.client.scan(2s);
  hand.wait(0ms);
  CHECK(hand.client.take() == "start\n");
  hand.hear("error: scans already\n");
  hand.wait(2s - 1ns);
  CHECK(hand.client.take().empty());
  hand.wait(1ns);
  CHECK(hand.client.take() == "stop\nlist\n");
  CHECK(hand.client.counters().refused == 0);
  CHECK(hand.event().empty());
}

TEST_CASE("central client: a busy central is asked again until the time for a link is over") {
  Hand hand{{.connect = 600ms}};
  hand.client.connect(0);
  hand.wait(0ms);
  for (int times = 0; times < 2; ++times) {
    CHECK(hand.client.take() == "conn 0\n");
    hand.hear("error: still connecting to 1\n");
    hand.wait(300ms - 1ns);
    CHECK(hand.client.take().empty());
    hand.wait(1ns);
  }
  CHECK(hand.client.take() == "conn 0\n");
  CHECK(hand.event().empty());
  hand.hear("error: still connecting to 1\n");
  CHECK(hand.event() == "failed 0: the central is still busy with another link");
  CHECK(hand.client.idle());
}

TEST_CASE("central client: the first request of all waits as long for a busy central") {
  CentralClient client{{.connect = 600ms}};
  CHECK(client.connect(0));
  Time now{1s};
  client.expire(now);
  CHECK(client.take() == "*\nstop\n");
  client.feed("found 0\n", now);
  for (int times = 0; times < 2; ++times) {
    CHECK(client.take() == "conn 0\n");
    client.feed("error: still connecting to 1\n", now);
    now += 300ms;
    client.expire(now);
  }
  CHECK(client.take() == "conn 0\n");
  CHECK_FALSE(client.next_event().has_value());
  client.feed("error: still connecting to 1\n", now);
  const auto event = client.next_event();
  REQUIRE(event.has_value());
  CHECK(event->words == "the central is still busy with another link");
  CHECK(client.idle());
}

TEST_CASE("central client: the last index that a central may give is taken") {
  Hand hand;
  hand.client.scan(0ms);
  hand.wait(0ms);
  hand.hear("found 1\n255:C0000000000A:AVR\nend of list\n");
  CHECK(hand.event() == "listed 1");
  REQUIRE(hand.client.peers().size() == 1);
  CHECK(hand.client.peers()[0].index == 255);
}

TEST_CASE("central client: a link that does not come in its time is ended, one that does not end is named") {
  Hand hand;
  hand.client.connect(0);
  hand.wait(0ms);
  CHECK(hand.client.take() == "conn 0\n");
  hand.hear("connecting 0\n");
  hand.wait(10s - 1ns);
  CHECK(hand.event().empty());
  hand.wait(1ns);
  CHECK(hand.event() == "failed 0: no link to AVR came");
  CHECK(hand.client.take() == "*");
  hand.hear("command\n");
  CHECK(hand.client.take() == "drop 0\n");
  hand.hear("closing 0\n");
  hand.wait(10s - 1ns);
  CHECK(hand.event().empty());
  hand.wait(1ns);
  CHECK(hand.event() == "failed 0: the link to AVR does not end");
  CHECK(hand.client.counters().timeouts == 2);
  CHECK(hand.client.idle());
}

TEST_CASE("central client: of refusals only those of the robot that is asked for end its request") {
  Hand hand;
  hand.client.connect(0);
  hand.wait(0ms);
  hand.hear("connecting 0\nerror: no link to 1\nerror: scans already\n");
  CHECK(hand.event().empty());
  CHECK(hand.client.counters().strays == 2);
  hand.hear("error: no link to 0\n");
  CHECK(hand.event() == "failed 0: the central refuses AVR: no link to 0");
  CHECK(hand.client.counters().refused == 1);
  CHECK(hand.client.counters().strays == 2);
  hand.hear("error: no link to 0\n");  // nothing is asked for
  CHECK(hand.client.counters().strays == 3);
}

TEST_CASE("central client: words that cannot be said are named as such, and the link as gone") {
  Hand hand;
  hand.client.connect(0);
  hand.wait(0ms);
  hand.hear("connecting 0\nconnected 0\n");
  CHECK(hand.event() == "connected 0");
  CHECK(hand.client.peers()[0].linked);
  (void)hand.client.take();
  hand.client.say(0, "{}\n");
  hand.client.say(1, "{}\n");
  hand.wait(0ms);
  CHECK(hand.client.take() == "{}\n*");
  CHECK(hand.event() == "said 0");
  hand.hear("command\n");
  CHECK(hand.client.take() == "switch 1\n");
  hand.hear("error: no link to 1; conn first\n");
  CHECK(hand.event() == "failed 1, not said: the central refuses B: no link to 1; conn first");
  CHECK(hand.client.peers()[0].linked);
  hand.client.say(0, "{}\n");
  hand.wait(0ms);
  CHECK(hand.client.take() == "switch 0\n");
  hand.hear("error: no link to 0; conn first\n");
  CHECK(hand.event() == "failed 0, not said: the central refuses AVR: no link to 0; conn first");
  CHECK_FALSE(hand.client.peers()[0].linked);
}

TEST_CASE("central client: answers and reports of another robot end no request") {
  Hand hand;
  hand.hear("connected 1\n");  // nothing is asked for
  CHECK(hand.event() == "connected 1");
  CHECK(hand.client.peers()[1].linked);
  hand.client.connect(0);
  hand.wait(0ms);
  CHECK(hand.client.take() == "conn 0\n");
  const auto strays = hand.client.counters().strays;
  hand.hear("connecting 1\ndata 1\n");
  CHECK(hand.client.counters().strays == strays + 2);
  hand.hear("connecting 0\nlost 1\nconnected 1\n");
  CHECK(hand.event() == "lost 1");
  CHECK(hand.event() == "connected 1");
  CHECK_FALSE(hand.client.idle());
  hand.hear("connected 0\n");
  CHECK(hand.event() == "connected 0");
  CHECK(hand.client.idle());
  hand.client.drop(0);
  hand.wait(0ms);
  CHECK(hand.client.take() == "*");
  hand.hear("command\n");
  CHECK(hand.client.take() == "drop 0\n");
  hand.hear("closing 1\n");
  CHECK(hand.client.counters().strays == strays + 3);
  hand.hear("closing 0\nclosed 1\n");
  CHECK(hand.event() == "lost 1");
  CHECK_FALSE(hand.client.idle());
  hand.hear("closed 0\n");
  CHECK(hand.event() == "lost 0");
  CHECK(hand.client.idle());
  CHECK_FALSE(hand.client.peers()[0].linked);
}

TEST_CASE(
    "central client: a link that is lost while it comes is none, and one that is there needs no other") {
  Hand hand;
  hand.client.connect(0);
  hand.wait(0ms);
  hand.hear("connecting 0\nlost 0\n");
  CHECK(hand.event() == "lost 0");
  CHECK(hand.event() == "failed 0: no link to AVR");
  CHECK(hand.client.idle());
  (void)hand.client.take();
  hand.client.connect(0);
  hand.wait(0ms);
  CHECK(hand.client.take() == "*");
  hand.hear("command\n");
  CHECK(hand.client.take() == "conn 0\n");
  hand.hear("data 0\n");
  CHECK(hand.event() == "connected 0");
  CHECK(hand.client.peers()[0].linked);
  hand.client.say(0, "{}\n");  // it is in data mode with that robot
  hand.wait(0ms);
  CHECK(hand.client.take() == "{}\n");
  CHECK(hand.event() == "said 0");
  // One that is lost without a word, and does not come again.
  const auto connect = [&hand] {
    hand.client.connect(1);
    hand.wait(0ms);
    CHECK(hand.client.take() == "*");
    hand.hear("command\n");
    CHECK(hand.client.take() == "conn 1\n");
  };
  connect();
  hand.hear("connecting 1\nconnected 1\n");
  CHECK(hand.event() == "connected 1");
  connect();
  hand.hear("connecting 1\nerror: no link to 1\n");
  CHECK(hand.event() == "failed 1: the central refuses B: no link to 1");
  CHECK_FALSE(hand.client.peers()[1].linked);
  CHECK(hand.client.peers()[0].linked);
}

TEST_CASE("central client: a request that a reset cuts short is begun again at once") {
  Hand hand;
  hand.client.connect(0);
  hand.wait(0ms);
  CHECK(hand.client.take() == "conn 0\n");
  hand.hear("reset\n");
  CHECK(hand.client.take() == "*\nstop\n");
  hand.hear("found 0\n");
  CHECK(hand.client.take() == "conn 0\n");
  CHECK(hand.client.counters().timeouts == 0);
}

TEST_CASE("central client: of a list that is not whole nothing is in the next") {
  Hand hand;
  hand.client.scan(0ms);
  hand.wait(0ms);
  CHECK(hand.client.take() == "stop\nlist\n");
  hand.hear("found 2\n1:C0000000000C:C\nend of list\n");
  CHECK(hand.client.counters().timeouts == 1);
  CHECK(hand.client.take() == "*\nstop\n");
  hand.hear("found 2\n");
  CHECK(hand.client.take() == "stop\nlist\n");
  hand.hear("found 2\n0:C0000000000C:C\n1:C0000000000D:D\nend of list\n");
  CHECK(hand.event() == "listed 2");
  REQUIRE(hand.client.peers().size() == 2);
  CHECK(hand.client.peers()[0].name == "C");
  CHECK(hand.client.peers()[1].name == "D");
}

TEST_CASE("central client: a new list keeps the link of the same robot at the same index, and no other") {
  Hand hand;
  hand.client.connect(0);
  hand.wait(0ms);
  hand.hear("connecting 0\nconnected 0\n");
  hand.client.scan(0ms);
  hand.wait(0ms);
  hand.hear("command\n");
  hand.hear("found 2\n0:C0000000000A:AVR\n1:C0000000000B:B\nend of list\n");
  REQUIRE(hand.client.peers().size() == 2);
  CHECK(hand.client.peers()[0].linked);
  CHECK_FALSE(hand.client.peers()[1].linked);
  hand.client.scan(0ms);
  hand.wait(0ms);
  hand.hear("found 2\n0:C0000000000C:C\n2:C0000000000A:AVR\nend of list\n");
  REQUIRE(hand.client.peers().size() == 2);
  CHECK(hand.client.peers()[1].index == 2);
  for (const Peer& peer : hand.client.peers()) CHECK_FALSE(peer.linked);
}

}  // namespace mapper_server_central_client_test
