#include "cli/serve/viewers.hpp"

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

namespace serve_viewers_test {

using namespace std::chrono_literals;
using ocm::cli::serve::ViewerId;
using ocm::cli::serve::Viewers;

constexpr ocm::base::Time start{1h};

/// All that is there for a viewer: "SUBSCRIPTION:PAYLOAD" of messages, texts as they are.
std::vector<std::string> all(Viewers& viewers, ViewerId viewer, ocm::base::Time now = start) {
  std::vector<std::string> out;
  while (const auto message = viewers.next(viewer, now)) {
    const std::string id = message->binary ? std::to_string(message->head[1]) + ":" : "";
    out.push_back(id + *message->payload);
  }
  return out;
}

TEST_CASE("viewers: each gets what it has subscribed to, from then on") {
  Viewers viewers{3};
  const ViewerId a = viewers.add();
  const ViewerId b = viewers.add();
  CHECK_FALSE(viewers.wanted(1));
  viewers.publish(1, 0, "too early");
  CHECK(viewers.size() == 0);
  CHECK(viewers.subscribe(a, {5, 1}).empty());
  CHECK(viewers.wanted(1));
  viewers.publish(1, 1, "one");
  viewers.publish(2, 1, "not wanted");
  CHECK(viewers.subscribe(b, {6, 1}).empty());
  CHECK(viewers.subscribe(b, {7, 2}).empty());
  viewers.publish(1, 2, "two");
  viewers.publish(2, 3, "three");
  CHECK(all(viewers, a) == std::vector<std::string>{"5:one", "5:two"});
  CHECK(all(viewers, b) == std::vector<std::string>{"6:two", "7:three"});
  CHECK(viewers.unsubscribe(b, 6).empty());
  viewers.publish(1, 4, "four");
  CHECK(all(viewers, a) == std::vector<std::string>{"5:four"});
  CHECK(all(viewers, b).empty());
  viewers.remove(a);
  CHECK_FALSE(viewers.wanted(1));
  CHECK(viewers.wanted(2));
  CHECK(viewers.lost() == 0);
}

TEST_CASE("viewers: subscriptions that cannot be are refused") {
  Viewers viewers{2};
  const ViewerId a = viewers.add();
  CHECK(viewers.subscribe(a, {1, 0}).empty());
  CHECK(viewers.subscribe(a, {2, 0}) == "channel 0 is subscribed to already");
  CHECK(viewers.subscribe(a, {1, 1}) == "subscription 1 is another one already");
  CHECK(viewers.subscribe(a, {3, 2}) == "there is no channel 2");
  CHECK(viewers.unsubscribe(a, 9) == "there is no subscription 9");
}

TEST_CASE("viewers: a slow one loses what is counted and told, and others nothing") {
  Viewers viewers{2, {1000, 4}};
  const ViewerId slow = viewers.add();
  const ViewerId quick = viewers.add();
  REQUIRE(viewers.subscribe(slow, {1, 0}).empty());
  REQUIRE(viewers.subscribe(quick, {2, 0}).empty());
  REQUIRE(viewers.subscribe(quick, {3, 1}).empty());
  std::size_t read = 0;
  for (int i = 0; i < 10; ++i) {
    viewers.publish(0, 0, std::to_string(i));
    viewers.publish(1, 0, "other");
    read += all(viewers, quick).size();
  }
  CHECK(read == 20);
  CHECK(viewers.lost(quick) == 0);
  // The newest four messages are there; two of them are its own.
  CHECK(viewers.next(slow, start)->payload->substr(0, 2) == "8");
  CHECK(viewers.lost(slow) == 8);
  CHECK(viewers.lost() == 8);
  CHECK(
      all(viewers, slow) ==
      std::vector<std::string>{
          R"({"op":"status","level":1,"message":"this viewer is too slow for what it asks: it has lost 8 messages","id":"loss"})",
          "1:9"});
  // The next loss is reported a second later, at the earliest.
  for (int i = 0; i < 10; ++i) viewers.publish(0, 0, "x");
  CHECK(all(viewers, slow, start + 500ms).size() == 4);
  CHECK(viewers.lost(slow) == 14);
  CHECK(all(viewers, slow, start + 999ms).empty());
  CHECK(all(viewers, slow, start + 1s).size() == 1);
}

TEST_CASE(
    "viewers: what is lost is known also where nothing of its channel follows, or its viewer has gone") {
  Viewers viewers{2, {1000, 4}};
  const ViewerId slow = viewers.add();
  const ViewerId other = viewers.add();
  REQUIRE(viewers.subscribe(slow, {1, 0}).empty());
  REQUIRE(viewers.subscribe(other, {2, 1}).empty());
  for (int i = 0; i < 10; ++i) viewers.publish(0, 0, "x");
  for (int i = 0; i < 10; ++i) viewers.publish(1, 0, "y");
  CHECK(viewers.lost(slow) == 10);
  CHECK(all(viewers, slow).size() == 1);  // a word about it
  CHECK(viewers.lost() == 16);            // six of the other
  for (int i = 0; i < 10; ++i) viewers.publish(0, 0, "x");
  CHECK(viewers.unsubscribe(slow, 1).empty());
  CHECK(viewers.lost(slow) == 16);
  viewers.remove(other);  // with four more
  CHECK(viewers.lost() == 26);
  REQUIRE(viewers.subscribe(slow, {3, 0}).empty());
  viewers.publish(0, 0, "new");
  CHECK(all(viewers, slow, start + 2s).back() == "3:new");
  CHECK(viewers.lost(slow) == 16);
}

TEST_CASE("viewers: whether anything waits for any of them") {
  Viewers viewers{1};
  CHECK_FALSE(viewers.anything_waits());
  const ViewerId a = viewers.add();
  const ViewerId b = viewers.add();
  CHECK_FALSE(viewers.anything_waits());
  REQUIRE(viewers.subscribe(b, {1, 0}).empty());
  viewers.publish(0, 0, "x");
  CHECK(viewers.anything_waits());
  CHECK(all(viewers, b).size() == 1);
  CHECK(viewers.anything_waits());  // the other has not passed over it yet
  CHECK(all(viewers, a).empty());
  CHECK_FALSE(viewers.anything_waits());
}

TEST_CASE("viewers: a single message that is lost is known at once, and the next loss a second later") {
  Viewers viewers{1, {1000, 2}};
  const ViewerId slow = viewers.add();
  REQUIRE(viewers.subscribe(slow, {1, 0}).empty());
  for (int i = 0; i < 3; ++i) viewers.publish(0, 0, "x");
  CHECK(all(viewers, slow).size() == 3);  // two, and a word about the one that is lost
  for (int i = 0; i < 3; ++i) viewers.publish(0, 0, "x");
  CHECK(all(viewers, slow, start + 999ms).size() == 2);
  CHECK(all(viewers, slow, start + 1s).size() == 1);
}

TEST_CASE("viewers: how much the queue of a server holds") {
  const auto kept = [](std::size_t messages, std::size_t bytes) {
    Viewers viewers{1};
    const ViewerId viewer = viewers.add();
    REQUIRE(viewers.subscribe(viewer, {1, 0}).empty());
    for (std::size_t i = 0; i < messages; ++i) viewers.publish(0, 0, std::string(bytes, 'x'));
    return messages - viewers.lost(viewer);
  };
  CHECK(kept(32'768, 1) == 32'768);
  CHECK(kept(32'769, 1) == 32'768);
  CHECK(kept(8, 1 << 20) == 8);
  CHECK(kept(9, 1 << 20) == 8);
}

TEST_CASE("viewers: whatever way a message comes, it has its own time") {
  Viewers viewers{2};
  const ViewerId viewer = viewers.add();
  const auto time_of_next = [&] { return static_cast<int>(viewers.next(viewer, start)->head[5]); };
  viewers.publish_state(0, 17, "state");
  REQUIRE(viewers.subscribe(viewer, {1, 0}).empty());
  CHECK(time_of_next() == 17);
  viewers.publish_state(0, 18, "state");
  CHECK(time_of_next() == 18);
  REQUIRE(viewers.subscribe(viewer, {2, 1}).empty());
  viewers.give(viewer, 1, 19, "before");
  CHECK(time_of_next() == 19);
  viewers.publish(1, 20, "sample");
  CHECK(time_of_next() == 20);
}

TEST_CASE("viewers: the queue has a bound in bytes, too") {
  Viewers viewers{1, {100, 1000}};
  const ViewerId viewer = viewers.add();
  REQUIRE(viewers.subscribe(viewer, {1, 0}).empty());
  for (int i = 0; i < 100; ++i) viewers.publish(0, 0, std::string(30, 'x'));
  CHECK(viewers.size() <= 100);
  CHECK(all(viewers, viewer).size() == 4);  // three, and a word about the loss
  CHECK(viewers.lost(viewer) == 97);
}

TEST_CASE("viewers: who subscribes to a state gets the newest at once") {
  Viewers viewers{2};
  viewers.publish_state(0, 1, "old");
  viewers.publish_state(0, 2, "new");
  const ViewerId viewer = viewers.add();
  REQUIRE(viewers.subscribe(viewer, {1, 0}).empty());
  CHECK(viewers.has_next(viewer));
  CHECK(all(viewers, viewer) == std::vector<std::string>{"1:new"});
  viewers.publish_state(0, 3, "newer");
  CHECK(all(viewers, viewer) == std::vector<std::string>{"1:newer"});
  // Again and again without reading: no more than one is kept.
  for (int i = 0; i < 100; ++i) {
    REQUIRE(viewers.unsubscribe(viewer, 1).empty());
    REQUIRE(viewers.subscribe(viewer, {1, 0}).empty());
  }
  CHECK(all(viewers, viewer).size() == 1);
  CHECK(viewers.lost() == 0);
}

TEST_CASE("viewers: what came before is given to who has just subscribed, unless more came since") {
  Viewers viewers{2};
  const ViewerId a = viewers.add();
  const ViewerId b = viewers.add();
  CHECK(viewers.subscribe(a, {5, 1}).empty());
  viewers.give(a, 1, 7, "before");
  viewers.give(a, 0, 7, "not subscribed");
  viewers.give(b, 1, 7, "not subscribed");
  CHECK(all(viewers, a) == std::vector<std::string>{"5:before"});
  CHECK(all(viewers, b).empty());
  CHECK(viewers.subscribe(b, {6, 1}).empty());
  viewers.publish(1, 8, "newer");
  viewers.give(b, 1, 7, "before");
  CHECK(all(viewers, b) == std::vector<std::string>{"6:newer"});
  CHECK(viewers.lost() == 0);
  viewers.give(99, 1, 7, "of no viewer");
}

TEST_CASE("viewers: texts go to one or to all, and a bounded number waits") {
  Viewers viewers{1};
  const ViewerId a = viewers.add();
  const ViewerId b = viewers.add();
  viewers.tell(a, "a");
  viewers.tell(0, "all");
  viewers.tell(99, "none");
  CHECK(all(viewers, a) == std::vector<std::string>{"a", "all"});
  CHECK(all(viewers, b) == std::vector<std::string>{"all"});
  for (int i = 0; i < 100; ++i) viewers.tell(a, "x");
  CHECK(all(viewers, a).size() == 65);
  CHECK(viewers.lost(a) == 36);
}

TEST_CASE("viewers: a producer and readers at once") {
  Viewers viewers{1, {1 << 20, 64}};
  std::vector<ViewerId> ids;
  for (int i = 0; i < 4; ++i) {
    ids.push_back(viewers.add());
    REQUIRE(viewers.subscribe(ids.back(), {1, 0}).empty());
  }
  constexpr std::uint64_t count = 20'000;
  std::thread producer{[&] {
    for (std::uint64_t i = 0; i < count; ++i) viewers.publish(0, i, "x");
  }};
  std::vector<std::uint64_t> got(ids.size());
  const auto read = [&] {
    for (std::size_t v = 0; v < ids.size(); ++v)
      while (const auto message = viewers.next(ids[v], start)) got[v] += message->binary ? 1 : 0;
  };
  for (int i = 0; i < 1000; ++i) read();
  producer.join();
  read();
  for (std::size_t v = 0; v < ids.size(); ++v) CHECK(got[v] + viewers.lost(ids[v]) == count);
}

TEST_CASE("viewers: the bounds of the queue are reached, and one message is kept however long it is") {
  Viewers bytes{1, {90, 1000}};
  const ViewerId a = bytes.add();
  REQUIRE(bytes.subscribe(a, {1, 0}).empty());
  for (int i = 0; i < 3; ++i) bytes.publish(0, 0, std::string(30, 'x'));
  CHECK(bytes.size() == 90);
  CHECK(all(bytes, a).size() == 3);
  bytes.publish(0, 0, std::string(500, 'y'));
  CHECK(bytes.size() == 500);
  CHECK(all(bytes, a) == std::vector<std::string>{"1:" + std::string(500, 'y')});
  CHECK(bytes.lost() == 0);
  bytes.publish(0, 0, "z");
  CHECK(bytes.size() == 1);
}

TEST_CASE("viewers: who has something to be sent") {
  Viewers viewers{1};
  CHECK(viewers.count() == 0);
  const ViewerId first = viewers.add();
  REQUIRE(viewers.subscribe(first, {1, 0}).empty());
  viewers.publish(0, 0, "x");
  CHECK(viewers.has_next(first));
  const ViewerId late = viewers.add();
  CHECK(viewers.count() == 2);
  CHECK_FALSE(viewers.has_next(late));  // what came before it is not for it
  viewers.tell(late, "a text");
  CHECK(viewers.has_next(late));
  CHECK(all(viewers, late) == std::vector<std::string>{"a text"});
  CHECK_FALSE(viewers.has_next(late));
  viewers.ask(late);
  CHECK(viewers.has_next(late));
  CHECK(viewers.take_asked(late));
  CHECK_FALSE(viewers.has_next(late));
  CHECK_FALSE(viewers.take_asked(late));
  CHECK(viewers.heard(late) == 0);
  viewers.hear(late);
  viewers.hear(late);
  CHECK(viewers.heard(late) == 2);
  CHECK(viewers.heard(first) == 0);
  // Of one that is not there nothing is known, and nothing happens.
  viewers.remove(first);
  viewers.remove(first);
  CHECK(viewers.count() == 1);
  CHECK_FALSE(viewers.has_next(first));
  CHECK_FALSE(viewers.next(first, start));
  CHECK(viewers.subscribe(first, {1, 0}).empty());
  CHECK(viewers.unsubscribe(first, 1).empty());
  CHECK_FALSE(viewers.wanted(0));
  viewers.hear(first);
  viewers.ask(first);
  viewers.greet(first, {"hello"});
  CHECK(viewers.heard(first) == 0);
  CHECK(viewers.lost(first) == 0);
  CHECK(viewers.add() != first);  // a number is never given twice
}

TEST_CASE(
    "viewers: answers come before what is lost is said, that before states, and these before messages") {
  Viewers viewers{2, {1000, 2}};
  const ViewerId viewer = viewers.add();
  REQUIRE(viewers.subscribe(viewer, {1, 0}).empty());
  for (int i = 0; i < 3; ++i) viewers.publish(0, 0, std::to_string(i));
  CHECK(viewers.next(viewer, start)->payload->substr(0, 1) == "1");  // and has lost one
  viewers.publish_state(1, 0, "state");
  REQUIRE(viewers.subscribe(viewer, {2, 1}).empty());
  viewers.tell(viewer, "answer");
  const auto said = all(viewers, viewer);
  REQUIRE(said.size() == 4);
  CHECK(said[0] == "answer");
  CHECK(said[1].find("it has lost 1 message\"") != std::string::npos);
  CHECK(said[2] == "2:state");
  CHECK(said[3] == "1:2");
}

}  // namespace serve_viewers_test
