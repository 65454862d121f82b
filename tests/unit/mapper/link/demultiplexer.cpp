#include "ocm/mapper/link/demultiplexer.hpp"

#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/packet.hpp"

#include "unit/mapper/link/link_testing.hpp"

namespace mapper_link_demultiplexer_test {

using namespace ocm::mapper::link;
using ocm::test::Random;

struct Heard {
  int robot;
  Sentence sentence;
};
template <std::size_t N>
std::vector<Heard> feed(Demultiplexer<N>& ears, std::string_view stream) {
  std::vector<Heard> out;
  for (const char c : stream) {
    const auto heard = ears.feed(static_cast<std::uint8_t>(c));
    if (heard.kind != Kind::none) out.push_back({heard.robot, ears.ear(heard.robot).sentence()});
  }
  return out;
}
constexpr bool heard_by_the_compiler() {
  Demultiplexer<2> ears;
  int updates = 0;
  int idle = 0;
  for (const char c : ocm::test::listing_15_1) {
    const Kind kind = ears.feed(static_cast<std::uint8_t>(c)).kind;
    updates += kind == Kind::update ? 1 : 0;
    idle += kind == Kind::idle ? 1 : 0;
  }
  const Packet packet = *pack({1, ocm::test::first_of_listing});
  for (const std::uint8_t byte : packet.bytes()) updates += ears.feed(byte).kind == Kind::update ? 1 : 0;
  return updates == 3 && idle == 2;
}
static_assert(heard_by_the_compiler());

std::string text(const Packet& packet) {
  std::string out;
  for (const std::uint8_t byte : packet.bytes()) out += static_cast<char>(byte);
  return out;
}

TEST_CASE("listing 15.1 as it came from the central holds U, IDL, IDL, U, and the quality has fallen") {
  Demultiplexer<1> ears;
  const auto heard = feed(ears, ocm::test::listing_15_1);
  REQUIRE(heard.size() == 4);
  CHECK(heard[0].sentence.as<Update>().value == ocm::test::first_of_listing);
  CHECK(heard[1].sentence.kind == Kind::idle);
  CHECK(heard[2].sentence.kind == Kind::idle);
  CHECK(heard[3].sentence.as<Update>().value == ocm::test::last_of_listing);
  CHECK(ears.ear(0).text().faults().total() == 21);  // counted by hand in reader.cpp
  CHECK(ears.ear(0).quality().below(500));
  CHECK(ears.of_no_robot() == 0);
  CHECK(ears.broken_prefixes() == 0);
}

TEST_CASE(
    "packets of several robots, text and packed, in any order: each robot's sentences, in its order, and no "
    "others") {
  Random random{17};
  constexpr std::size_t robots = 4;
  Demultiplexer<robots> ears;
  std::deque<Packet> waiting[robots];
  std::deque<Update> sent[robots];
  std::uint8_t sequence[robots]{};
  std::size_t heard_count = 0;
  for (int n = 0; n < 20'000; ++n) {
    const std::size_t r = random.below(robots);
    if (waiting[r].size() < 3) {
      const Update update = ocm::test::random_sentence<Update>(random);
      sent[r].push_back(update);
      if (random.below(2) == 0) {
        waiting[r].push_back(*pack({sequence[r]++, update}));
      } else {
        const Line line = *write(update);
        for (std::string_view rest = line.view(); !rest.empty();) waiting[r].push_back(take_packet(rest));
      }
    }
    const std::string stream =
        std::string{write_prefix(static_cast<std::uint8_t>(r), "AVR").view()} + text(waiting[r].front());
    waiting[r].pop_front();
    for (const Heard& heard : feed(ears, stream)) {
      REQUIRE(heard.robot == static_cast<int>(r));
      REQUIRE(heard.sentence.as<Update>().value == sent[r].front());
      sent[r].pop_front();
      ++heard_count;
    }
  }
  CHECK(heard_count > 5'000);
  for (std::size_t r = 0; r < robots; ++r) {
    CHECK(sent[r].size() <= 3);
    CHECK(ears.ear(r).text().faults().total() == 0);
    CHECK(ears.ear(r).packed().faults() == PackedFaults{});
    CHECK(ears.ear(r).quality().per_mille() == 1000);
  }
}

TEST_CASE("one robot's torn sentence is not completed by another's, nor by one whose prefix is broken") {
  Demultiplexer<2> ears;
  CHECK(feed(ears, "[0]:A:{S,I[1]:B:DL}\n").empty());
  CHECK(feed(ears, "[0]:A:{S,I[0:A:DL}\n").empty());
  CHECK(ears.broken_prefixes() == 1);
  CHECK(ears.of_no_robot() == 7);  // the first wrong character and what follows
  CHECK(feed(ears, "[7]:C:{S,IDL}\n").empty());
  CHECK(ears.of_no_robot() == 7 + 8);
  CHECK(feed(ears, "[1]:B:{S,IDL}\n").size() == 1);
  CHECK(feed(ears, "[2]:C:{S,IDL}\n").empty());  // the first that there is no room for
  CHECK(ears.of_no_robot() == 7 + 8 + 8);
}

TEST_CASE("what comes before the first prefix belongs to no robot") {
  Demultiplexer<2> ears;
  CHECK(feed(ears, "{S,IDL}\n").empty());
  CHECK(ears.of_no_robot() == 8);
  CHECK(ears.ear(0).text().heard() == 0);
  CHECK(feed(ears, "[0]:A:{S,IDL}\n").size() == 1);
  CHECK(ears.of_no_robot() == 8);
}

TEST_CASE("text and packed bytes tear each other, and neither is taken for the other") {
  const Update update{-177, -61, -68, 49, 12, 30, 45, 80};
  Ear ear;
  const auto feed_all = [&](std::string_view bytes) {
    int heard = 0;
    for (const char c : bytes) heard += ear.feed(static_cast<std::uint8_t>(c)) != Kind::none ? 1 : 0;
    return heard;
  };
  const std::string packed = text(*pack({1, update}));
  CHECK(feed_all("{U,1,2" + packed + ",3,4,5,6,7,8}\n") == 1);
  CHECK(ear.sentence().as<Update>().value == update);
  CHECK(ear.text().faults() == ReaderFaults{.unclosed = 1, .headless = 1});
  CHECK(feed_all(packed.substr(0, 10) + "{S,IDL}\n" + packed.substr(10)) == 1);
  CHECK(ear.sentence().kind == Kind::idle);
  CHECK(ear.packed().faults().torn == 1);
}

TEST_CASE(
    "a handshake, or a new link, lets the numbers of packed updates begin again, and a new link is trusted") {
  Ear ear;
  const auto feed_all = [&](std::string_view bytes) {
    for (const char c : bytes) (void)ear.feed(static_cast<std::uint8_t>(c));
  };
  feed_all(text(*pack({100, {}})));
  feed_all("{H,15}\n" + text(*pack({0, {}})));
  CHECK(ear.packed().heard() == 2);
  for (int n = 0; n < 30; ++n) feed_all("}");
  CHECK(ear.quality().below(200));
  feed_all("{U,1");
  ear.restart();
  CHECK(ear.quality().per_mille() == 1000);
  CHECK(ear.text().faults().unclosed == 1);
  feed_all(text(*pack({200, {}})));
  CHECK(ear.packed().heard() == 3);
  CHECK(ear.packed().faults() == PackedFaults{});
  CHECK(ear.quality().per_mille() == 1000);  // what was begun on the old link is not the new one's
}

TEST_CASE("an update that is lost lowers the quality when its number is missed") {
  Ear ear;
  for (const std::uint8_t sequence : {std::uint8_t{0}, std::uint8_t{5}})
    for (const char c : text(*pack({sequence, {}}))) (void)ear.feed(static_cast<std::uint8_t>(c));
  CHECK(ear.packed().faults().lost == 4);
  CHECK(ear.quality().per_mille() < 800);
}

}  // namespace mapper_link_demultiplexer_test
