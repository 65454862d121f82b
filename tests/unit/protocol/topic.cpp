#include "ocm/protocol/topic.hpp"

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"
#include "unit/protocol/example_topics.hpp"

namespace protocol_topic_test {

using namespace std::chrono_literals;
using ocm::base::Decimal;
using ocm::base::Error;
using ocm::protocol::Direction;
using ocm::protocol::Field;
using ocm::protocol::Identifier;
using ocm::protocol::Kind;
using ocm::protocol::Priority;
using ocm::protocol::Topic;
using ocm::protocol::TopicId;
using ocm::test::catalogue;
using ocm::test::Lamp;
using ocm::test::Scale;

// --- fields ---

constexpr const Field& weight = ocm::test::weight_fields[0];

TEST_CASE("a raw number becomes exactly the physical value, and back") {
  // raw / 4 + 100
  STATIC_REQUIRE(*weight.physical(0) == Decimal{1, 2});
  STATIC_REQUIRE(*weight.physical(1) == Decimal{10025, -2});
  STATIC_REQUIRE(*weight.physical(-400) == Decimal{});
  STATIC_REQUIRE(*weight.physical(-401) == Decimal{-25, -2});
  for (std::int64_t raw = weight.raw_min; raw <= weight.raw_max; ++raw)
    REQUIRE(weight.raw_from(*weight.physical(raw)) == raw);
}

TEST_CASE("a physical value between two raw numbers goes to the nearer, halves away from zero") {
  STATIC_REQUIRE(*weight.raw_from({10012, -2}) == 0);   // 0.48 of a step
  STATIC_REQUIRE(*weight.raw_from({100125, -3}) == 1);  // half a step
  STATIC_REQUIRE(*weight.raw_from({99875, -3}) == -1);  // half a step below the offset
  STATIC_REQUIRE(*weight.raw_from({99876, -3}) == 0);
}

TEST_CASE("a physical value outside of the field's range is refused") {
  STATIC_REQUIRE(*weight.raw_from({}) == -400);
  STATIC_REQUIRE(weight.raw_from({-25, -2}).error == Error::out_of_range);
  STATIC_REQUIRE(*weight.raw_from({11, 2}) == 4000);
  STATIC_REQUIRE(weight.raw_from({110025, -2}).error == Error::out_of_range);
  STATIC_REQUIRE(weight.raw_from({1, 100}).error == Error::out_of_range);
  STATIC_REQUIRE(weight.raw_from({INT64_MIN, 0}).error == Error::out_of_range);
}

TEST_CASE("a field reads itself from a frame") {
  STATIC_REQUIRE(weight.raw({0xFF, 0xFF, 0xFF, 0xFE}) == -2);
  STATIC_REQUIRE(ocm::test::state_fields[0].raw({0x81}) == 0x81);
}

TEST_CASE("the catalogue's decoder agrees with the typed one") {
  ocm::test::Random random{1};
  for (int i = 0; i < 2'000; ++i) {
    const Scale sample{static_cast<std::int32_t>(random()), static_cast<std::uint8_t>(random())};
    REQUIRE(weight.raw(sample.encode(0)) == sample.weight);
    REQUIRE(ocm::test::state_fields[0].raw(sample.encode(1)) == sample.state);
  }
}

// --- the catalogue ---

TEST_CASE("a topic is found by its name and by each alias, and by nothing else") {
  const Topic* scale = catalogue.find("scale");
  REQUIRE(scale != nullptr);
  CHECK(scale->name == "scale");
  CHECK(catalogue.find("weight") == scale);
  CHECK(catalogue.find("w") == scale);
  CHECK(catalogue.find("lamp_2")->instance == 2);
  for (const auto other : {"", "Scale", "scal", "scale ", "lamp", "lamp_4"}) {
    INFO(other);
    CHECK(catalogue.find(other) == nullptr);
  }
}

TEST_CASE("a topic is found by the number of its requests or set points") {
  CHECK(catalogue.find(TopicId{0x10})->name == "scale");
  CHECK(catalogue.find(TopicId{0x32})->name == "lamp_3");
  // The second frame of a sensor takes no requests.
  CHECK(catalogue.find(TopicId{0x21}) == nullptr);
  CHECK(catalogue.find(TopicId{0x33}) == nullptr);
  CHECK(ocm::protocol::Catalogue{}.find("scale") == nullptr);
  CHECK(ocm::protocol::Catalogue{}.find(TopicId{0x10}) == nullptr);
}

TEST_CASE("an entry of the catalogue says what its type says") {
  const Topic& scale = catalogue.topics[0];
  CHECK(scale.id == Scale::id);
  CHECK(scale.kind == Kind::sensor);
  CHECK(scale.board == 1);
  CHECK(scale.priority == Priority::high);
  CHECK(scale.period == Scale::period);
  CHECK(scale.shortest_period == 10ms);
  CHECK(scale.deadline == 20ms);
  CHECK(scale.jitter == 1ms);
  CHECK(scale.source == "a data sheet");
  CHECK(scale.group.empty());
  CHECK(scale.instance == 0);

  const Topic& lamp = catalogue.topics[3];
  CHECK(lamp.id == TopicId{0x32});
  CHECK(lamp.kind == Kind::actuator);
  CHECK(lamp.role == ocm::protocol::Role::light);
  CHECK(lamp.timeout == 1s);
  CHECK(lamp.group == "lamp");
  CHECK(lamp.instance == 3);
}

// --- types ---

struct ForgetsToDecode {
  static constexpr TopicId id{1};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{};
  [[nodiscard]] ocm::can::Payload encode(std::size_t) const { return {}; }
};

TEST_CASE("a frame is as long as its spec says, by priority; the closed bound where none was computed") {
  using ocm::protocol::Priority;
  using ocm::protocol::worst_bits;
  constexpr ocm::protocol::FrameHead told{TopicId{0x10}, 4, {91, 90, 89, 88}};
  STATIC_REQUIRE(worst_bits(told, Priority::urgent) == 91);
  STATIC_REQUIRE(worst_bits(told, Priority::low) == 88);
  STATIC_REQUIRE(worst_bits(ocm::protocol::FrameHead{TopicId{0x10}, 4}, Priority::low) == 95);
  STATIC_REQUIRE(worst_bits(ocm::protocol::FrameLayout{"", TopicId{0x10}, 8, {}}, Priority::high) == 135);
}

TEST_CASE("what a board needs of a topic") {
  STATIC_REQUIRE(ocm::protocol::TopicType<Scale>);
  STATIC_REQUIRE(ocm::protocol::TopicType<Lamp>);
  STATIC_REQUIRE_FALSE(ocm::protocol::TopicType<ForgetsToDecode>);
  STATIC_REQUIRE_FALSE(ocm::protocol::TopicType<int>);
  using List = ocm::protocol::TopicList<Scale, Lamp>;
  STATIC_REQUIRE(List::size == 2);
  STATIC_REQUIRE(List::contains<Lamp>);
  STATIC_REQUIRE_FALSE(ocm::protocol::TopicList<Scale>::contains<Lamp>);
}

}  // namespace protocol_topic_test
