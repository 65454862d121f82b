#include "ocm/protocol/wire_hash.hpp"

#include <array>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace protocol_wire_hash_test {

using namespace ocm::protocol;

constexpr std::array<Field, 2> two_fields{{
    {"x", {0, 16, ByteOrder::little}, true, {175, -4}, {}, "deg/s", -28571, 28571, {}, false},
    {"y", {16, 16, ByteOrder::little}, true, {175, -4}, {}, "deg/s", -28571, 28571, {}, false},
}};

/// A catalogue of two topics that a test can change.
struct Robot {
  std::array<Field, 2> fields = two_fields;
  std::array<FrameLayout, 2> frames{{{"", TopicId{8}, 4, fields}, {"", TopicId{9}, 4, fields}}};
  std::array<Topic, 2> topics{};
  std::uint32_t bit_rate = 500'000;

  constexpr Robot() {
    for (std::size_t i = 0; i < topics.size(); ++i) {
      topics[i].name = i == 0 ? "gyroscope" : "accelerometer";
      topics[i].id = frames[i].id;
      topics[i].frames = {&frames[i], 1};
    }
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;
  [[nodiscard]] constexpr std::uint32_t hash() const { return wire_hash({"", bit_rate, {}, topics}); }
};

template <class Change>
constexpr bool changes(Change change) {
  Robot before;
  Robot after;
  change(after);
  return before.hash() != after.hash();
}

// What travels counts.
static_assert(changes([](Robot& r) { r.bit_rate = 1'000'000; }));
static_assert(changes([](Robot& r) { r.topics[0].id = TopicId{10}; }));
static_assert(changes([](Robot& r) { r.topics[1].kind = Kind::actuator; }));
static_assert(changes([](Robot& r) { r.frames[0].id = TopicId{10}; }));
static_assert(changes([](Robot& r) { r.frames[0].length = 6; }));
static_assert(changes([](Robot& r) { r.fields[1].position.start = 24; }));
static_assert(changes([](Robot& r) { r.fields[1].position.width = 12; }));
static_assert(changes([](Robot& r) { r.fields[1].position.order = ByteOrder::big; }));
static_assert(changes([](Robot& r) { r.fields[0].is_signed = false; }));
static_assert(changes([](Robot& r) { r.fields[0].scale = {1, -2}; }));
static_assert(changes([](Robot& r) { r.fields[0].offset = {-40, 0}; }));
static_assert(changes([](Robot& r) { r.fields[0].scale.exponent = -5; }));

static_assert(changes([](Robot& r) { r.fields[0].number = Number::float32; }));

template <class Change>
constexpr std::uint32_t hash_with(Change change) {
  Robot robot;
  change(robot);
  return robot.hash();
}
/// The first one is a message of this address.
constexpr auto message(Address address) {
  return [address](Robot& r) {
    r.topics[0].kind = Kind::message;
    r.frames[0].address = address;
  };
}
constexpr Address speed{Address::By::identifier, false, 0x123};
constexpr std::uint32_t with_speed = hash_with(message(speed));
static_assert(with_speed != hash_with(message({Address::By::pgn, false, 0x123})));
static_assert(with_speed != hash_with(message({Address::By::identifier, true, 0x123})));
static_assert(with_speed != hash_with(message({Address::By::identifier, false, 0x124})));

// What people call it does not, nor when it is sent, nor where it stands in the spec.
static_assert(!changes([](Robot& r) { r.topics[0].name = "gyro"; }));
static_assert(!changes([](Robot& r) { r.topics[0].source = "elsewhere"; }));
static_assert(!changes([](Robot& r) { r.fields[0].name = "roll"; }));
static_assert(!changes([](Robot& r) { r.fields[0].raw_max = 100; }));
static_assert(!changes([](Robot& r) { r.topics[0].period = {1, PeriodUnit::seconds}; }));
static_assert(!changes([](Robot& r) { std::swap(r.topics[0], r.topics[1]); }));
static_assert(!changes([](Robot& r) { r.frames[0].address = speed; }));  // a topic has none

// Two topics that exchange their frames are another spec.
static_assert(changes([](Robot& r) { std::swap(r.topics[0].frames, r.topics[1].frames); }));

TEST_CASE("wire_hash: FNV-1a, typed by hand for a catalogue that says nothing") {
  // FNV-1a of eight zero bytes: 0x811C9DC5 times 0x01000193 eight times over, modulo 2^32.
  std::uint32_t expected = 0x811C9DC5;
  for (int i = 0; i < 8; ++i) expected *= 0x01000193;
  CHECK(wire_hash({}) == expected);
  CHECK(wire_hash({}) == 0x9BE17165);
}

// Computed by hand in another language, from the rule in the header's comment and spec/topics.json. Boards
// that were flashed have these numbers: they change with what is said on the bus, and with nothing else.
static_assert(Robot{}.hash() == 0x32C9D8F7);
static_assert(with_speed == 0xAACB737C);
static_assert(hash_with(message({Address::By::pgn, true, 0x18FE'ECFE})) == 0x5DEF8F9A);
static_assert(hash_with([](Robot& r) { r.fields[0].number = Number::float64; }) == 0x3EC5D57B);
static_assert(wire_hash(amiro::catalogue) == 0xB206B975);
static_assert(amiro::wire_hash == 0xB206B975, "the generated header has it at compile time");

}  // namespace protocol_wire_hash_test
