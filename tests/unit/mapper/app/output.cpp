#include "ocm/mapper/app/output.hpp"

#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/packed.hpp"

#include "unit/mapper/app/app_testing.hpp"

namespace mapper_app_output_test {

using namespace app_testing;

struct Clock {
  base::Time now() const { return {}; }
};
struct Mutex {
  void lock() { ++depth, ++claims; }
  void unlock() { --depth; }
  static inline int depth = 0;
  static inline int claims = 0;
};
constexpr auto alive = [] { return true; };

struct Setup {
  explicit Setup(bool can_pack = true) : output{parts, clock, can_pack} { Mutex::claims = 0; }
  IdealParts parts{mapper::app::avr_robot};
  Clock clock;
  mapper::app::Output<IdealParts, Clock, Mutex> output;
};

TEST_CASE("mapper output: sentences, as the thesis has them", "[mapper_output]") {
  Setup setup;
  CHECK(setup.output.say(mapper::link::Kind::idle, alive));
  CHECK(setup.output.say(mapper::link::Kind::pong, alive));
  CHECK(setup.output.say(mapper::link::Update{1, -2, 90, 45, 10, 0, 80, 33}, alive));
  CHECK(setup.output.say(mapper::link::Handshake{.width = 20, .length = 21, .sensor2 = 90, .deadline = 5000},
                         alive));
  CHECK(setup.parts.sent == "{S,IDL}\n\t!\n{U,1,-2,90,45,10,0,80,33}\n{H,20,21,0,0,0,90,0,0,5000,20225,0}\n");
  CHECK(setup.output.counters().unsent == 0);
  CHECK(Mutex::claims == 5);
  CHECK(Mutex::depth == 0);
}

TEST_CASE("mapper output: a robot that cannot pack offers nothing, and stays with text", "[mapper_output]") {
  Setup setup{false};
  setup.output.hear(mapper::link::Kind::packed);
  (void)setup.output.say(mapper::link::Handshake{.deadline = 5000}, alive);
  (void)setup.output.say(mapper::link::Update{}, alive);
  CHECK(setup.parts.sent == "{H,0,0,0,0,0,0,0,0,5000,0,0}\n{U,0,0,0,0,0,0,0,0}\n");
}

TEST_CASE("mapper output: packed until the operator or the next link says otherwise", "[mapper_output]") {
  Setup setup;
  setup.output.hear(mapper::link::Kind::packed);
  CHECK(setup.output.say(mapper::link::Update{1, 2, 3, 4, 5, 6, 7, 8}, alive));
  CHECK(setup.parts.sent.size() == 20);
  CHECK(static_cast<std::uint8_t>(setup.parts.sent[0]) == mapper::link::packed_tag);
  setup.parts.sent.clear();
  SECTION("asked for text") {
    setup.output.hear(mapper::link::Kind::text);
  }
  SECTION("a new link") {
    setup.output.restart();
  }
  CHECK(setup.output.say(mapper::link::Update{}, alive));
  CHECK(setup.parts.sent == "{U,0,0,0,0,0,0,0,0}\n");
}

TEST_CASE("mapper output: nothing goes to a link that is gone", "[mapper_output]") {
  Setup setup;
  CHECK_FALSE(setup.output.say(mapper::link::Kind::idle, [] { return false; }));
  CHECK(setup.parts.sent.empty());
  CHECK(setup.output.counters().unsent == 1);
}

TEST_CASE("mapper output: numbers that no sentence holds are refused", "[mapper_output]") {
  Setup setup;
  CHECK_FALSE(setup.output.say(mapper::link::Update{.heading = 1000}, alive));
  CHECK(setup.parts.sent.empty());
  CHECK(setup.output.counters().out_of_range == 1);
}

TEST_CASE("mapper output: without room the rest of the sentence is lost, to the last byte",
          "[mapper_output]") {
  Setup setup;
  const std::string_view whole = "{U,-123,-123,-123,45,100,100,100,100}\n";  // 38 bytes, two packets
  const mapper::link::Update update{-123, -123, -123, 45, 100, 100, 100, 100};
  for (std::size_t room = 0; room <= 20; ++room) {
    setup.parts.sent.clear();
    setup.parts.room = room;  // for each packet
    CAPTURE(room);
    const std::uint32_t before = setup.output.counters().full;
    CHECK_FALSE((setup.output.say(update, alive) && room < 20));
    const std::uint32_t lost = setup.output.counters().full - before;
    CHECK(setup.parts.sent.size() + lost == whole.size());
    CHECK(whole.substr(0, setup.parts.sent.size()) == setup.parts.sent);
  }
  CHECK(setup.parts.sent == whole);
}

}  // namespace mapper_app_output_test
