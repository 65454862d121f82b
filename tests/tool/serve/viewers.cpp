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

}  // namespace serve_viewers_test
