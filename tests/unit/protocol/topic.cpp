#include "ocm/protocol/topic.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

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

// What is not said.
static_assert(ocm::protocol::NamedValue{}.raw == 0);
static_assert(ocm::protocol::SelectorRange{}.first == 0 && ocm::protocol::SelectorRange{}.last == 0);
static_assert(Field{}.scale == Decimal{1, 0} && Field{}.offset == Decimal{} && !Field{}.is_signed);
static_assert(Field{}.raw_min == 0 && Field{}.raw_max == 0 && Field{}.start == 0 && !Field{}.flags);
static_assert(Field{}.min == Decimal{} && Field{}.max == Decimal{});
static_assert(Field{}.selector == ocm::protocol::no_selector);
static_assert(Field{}.derived_from == 0 && !Field{}.uncertainty);
static_assert(!ocm::protocol::Address{}.extended && ocm::protocol::Address{}.number == 0);
static_assert(!ocm::protocol::FrameLayout{}.fd && ocm::protocol::FrameLayout{}.bit_rate_switch);
static_assert(Topic{}.board == 0 && Topic{}.instance == 0);
static_assert(ocm::protocol::FrameRef{}.frame == 0 && ocm::protocol::Catalogue{}.bit_rate == 0);

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

TEST_CASE("the highest bit of an unsigned word is no sign") {
  Field field;
  field.position = {0, 64, ocm::protocol::ByteOrder::little};
  const auto of = [&field](std::uint64_t word) { return field.physical(static_cast<std::int64_t>(word)); };
  CHECK(*of(9'223'372'036'854'775'807) == Decimal{9'223'372'036'854'775'807, 0});
  CHECK(of(9'223'372'036'854'775'808U).error == Error::out_of_range);  // 19 digits, beyond 2^63
  CHECK(*of(9'223'372'036'854'775'810U) == Decimal{922'337'203'685'477'581, 1});
  CHECK(*of(18'446'744'073'709'551'610U) == Decimal{1'844'674'407'370'955'161, 1});
  CHECK(of(UINT64_MAX).error == Error::out_of_range);
  field.scale = {5, -1};
  CHECK(*of(18'446'744'073'709'551'610U) == Decimal{9'223'372'036'854'775'805, 0});
  field.offset = {-1, 0};
  CHECK(*of(10'000'000'000'000'000'000U) == Decimal{4'999'999'999'999'999'999, 0});
  field.is_signed = true;
  CHECK(*of(UINT64_MAX) == Decimal{-15, -1});
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

// raw * 0.5 + 10 as a float of 32 bits, and one without scale of 64.
using ocm::protocol::Number;
constexpr Field number(Number kind, std::uint8_t width, Decimal scale = {1, 0}, Decimal offset = {}) {
  Field field{};
  field.position = {0, width};
  field.number = kind;
  field.scale = scale;
  field.offset = offset;
  return field;
}
constexpr Field level = number(Number::float32, 32, {5, -1}, {1, 1});
constexpr Field angle = number(Number::float64, 64);
constexpr Field moved = number(Number::float32, 32, {1, 0}, {3, 0});
constexpr Field doubled = number(Number::float32, 32, {2, 0});

TEST_CASE("a float is read and written with its scale and offset") {
  // IEEE 754: 1 is 3F800000, 1.5 is 3FC00000, -2 is C0000000; 1 in 64 bits is 3FF0...
  STATIC_REQUIRE(level.is_float());
  STATIC_REQUIRE_FALSE(weight.is_float());
  STATIC_REQUIRE(level.value(0x3F80'0000) == 10.5);
  STATIC_REQUIRE(level.value(0xC000'0000) == 9.0);
  STATIC_REQUIRE(moved.value(0x3FC0'0000) == 4.5);
  STATIC_REQUIRE(doubled.value(0x3FC0'0000) == 3.0);
  STATIC_REQUIRE(angle.value(0x3FF0'0000'0000'0000) == 1.0);
  // Without either it is the float as it was sent: -0 stays one.
  CHECK(std::signbit(angle.value(std::numeric_limits<std::int64_t>::min())));
  STATIC_REQUIRE(*level.float_from(10.5) == 0x3F80'0000);
  STATIC_REQUIRE(*level.float_from(9.0) == 0xC000'0000);
  STATIC_REQUIRE(*moved.float_from(4.5) == 0x3FC0'0000);
  STATIC_REQUIRE(*doubled.float_from(3.0) == 0x3FC0'0000);
  STATIC_REQUIRE(*angle.float_from(1.0) == 0x3FF0'0000'0000'0000);
  // And bit for bit the one that was asked for, a NaN that signals, too.
  constexpr std::int64_t signals = 0x7FF0'0000'0000'0001;
  CHECK(*angle.float_from(std::bit_cast<double>(signals)) == signals);
}

TEST_CASE("a float of 32 bits holds up to 3.4e38, and infinity; what is between is refused") {
  constexpr double greatest = std::numeric_limits<float>::max();
  STATIC_REQUIRE(*moved.float_from(-greatest) == 0xFF7F'FFFF);
  STATIC_REQUIRE(*doubled.float_from(2 * greatest) == 0x7F7F'FFFF);
  STATIC_REQUIRE(doubled.float_from(2.1 * greatest).error == Error::out_of_range);
  STATIC_REQUIRE(doubled.float_from(-2.1 * greatest).error == Error::out_of_range);
  CHECK(*doubled.float_from(std::numeric_limits<double>::infinity()) == 0x7F80'0000);
  CHECK(*doubled.float_from(-std::numeric_limits<double>::infinity()) == 0xFF80'0000);
  CHECK((*doubled.float_from(std::numeric_limits<double>::quiet_NaN()) & 0x7FFF'FFFF) > 0x7F80'0000);
  CHECK(*angle.float_from(1e300) == 0x7E37'E43C'8800'759C);
}

TEST_CASE("an integer's value is exact up to 53 bits, unsigned ones above 2^63, too") {
  constexpr Field all = number(Number::integer, 64);
  STATIC_REQUIRE(all.value(-1) == 18'446'744'073'709'551'616.0);
  STATIC_REQUIRE(weight.value(-401) == -0.25);
}

TEST_CASE("a field is in a frame that is long enough for it, and for what selects it") {
  using ocm::protocol::SelectorRange;
  static constexpr std::array<SelectorRange, 2> one_or_five{{{1, 1}, {5, 9}}};
  std::array<Field, 3> fields{number(Number::integer, 8), number(Number::integer, 8),
                              number(Number::integer, 8)};
  fields[0].position.start = 16;  // the selector, behind what it selects
  fields[1].position.start = 0;
  fields[1].selector = 0;
  fields[1].selected = one_or_five;
  fields[2].position.start = 8;
  const ocm::protocol::FrameLayout layout{"", {}, 3, fields};
  const auto has = [&](std::size_t field, std::vector<std::uint8_t> data) {
    const std::size_t size = data.size();
    data.resize(8);
    return layout.has(fields[field], std::span{data}.first(size));
  };
  CHECK(has(1, {0, 0, 1}));
  CHECK(has(1, {0, 0, 9}));
  CHECK_FALSE(has(1, {0, 0, 2}));
  CHECK_FALSE(has(1, {0, 0, 0}));
  // The byte of the selector did not come, whatever lies behind the frame.
  CHECK_FALSE(has(1, {7, 7}));
  CHECK(has(2, {7, 7}));
  CHECK_FALSE(has(2, {7}));
  CHECK_FALSE(has(0, {7, 7}));
}

TEST_CASE("which lengths a frame may have") {
  using ocm::protocol::Address;
  using Sizes = std::vector<std::size_t>;
  ocm::protocol::FrameLayout layout{"", {}, 8, {}};
  const auto accepted = [&](Address::By by, std::uint16_t length) {
    layout.address.by = by;
    layout.length = length;
    Sizes sizes;
    for (const std::size_t size : Sizes{0, 3, 7, 8, 9, 64, 1785})
      if (layout.accepts(size)) sizes.push_back(size);
    return sizes;
  };
  CHECK(accepted(Address::By::topic, 7) == Sizes{7});
  CHECK(accepted(Address::By::identifier, 8) == Sizes{8, 9, 64, 1785});
  CHECK(accepted(Address::By::identifier, 9) == Sizes{9, 64, 1785});
  CHECK(accepted(Address::By::pgn, 8) == Sizes{8, 9, 64, 1785});
  // What of a longer group fits into a frame is sent in one.
  CHECK(accepted(Address::By::pgn, 9) == Sizes{0, 3, 7, 8, 9, 64, 1785});
}

TEST_CASE("a field may be lacking: selected, beyond the message, or in a group of any length") {
  using ocm::protocol::Address;
  std::array<Field, 2> fields{number(Number::integer, 8), number(Number::integer, 8)};
  fields[1].position.start = 64;
  ocm::protocol::FrameLayout layout{"", {}, 9, fields};
  layout.address.by = Address::By::identifier;
  CHECK_FALSE(layout.may_lack(fields[0]));
  CHECK_FALSE(layout.may_lack(fields[1]));
  layout.length = 8;
  CHECK_FALSE(layout.may_lack(fields[0]));
  CHECK(layout.may_lack(fields[1]));
  layout.address.by = Address::By::pgn;
  CHECK_FALSE(layout.may_lack(fields[0]));
  layout.length = 9;
  CHECK(layout.may_lack(fields[0]));
  CHECK(layout.may_lack(fields[1]));
  layout.address.by = Address::By::identifier;
  fields[0].selector = 1;
  CHECK(layout.may_lack(fields[0]));
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

// --- which fields a frame has ---

/// Bytes of a frame, each a field; `selector` of field i says which field it needs.
struct Selected {
  static constexpr std::array<ocm::protocol::SelectorRange, 2> one_or_five{{{1, 1}, {5, 9}}};
  std::array<Field, 4> fields{number(Number::integer, 8), number(Number::integer, 8),
                              number(Number::integer, 8), number(Number::integer, 8)};
  explicit Selected(std::array<std::uint16_t, 4> selectors) {
    for (std::size_t i = 0; i < 4; ++i) {
      fields[i].position.start = static_cast<std::uint16_t>(8 * i);
      fields[i].selector = selectors[i];
      if (selectors[i] != ocm::protocol::no_selector) fields[i].selected = one_or_five;
    }
  }
  [[nodiscard]] ocm::protocol::FrameLayout layout() const { return {"", {}, 4, fields}; }
  [[nodiscard]] bool has(std::size_t field, std::array<std::uint8_t, 4> data) const {
    return layout().has(fields[field], data);
  }
};
constexpr std::uint16_t none = ocm::protocol::no_selector;

TEST_CASE("a field is there for the numbers of its selector, both ends included, and for no others") {
  const Selected one{{none, 0, none, none}};
  for (unsigned value = 0; value < 256; ++value)
    CHECK(one.has(1, {static_cast<std::uint8_t>(value), 0, 0, 0}) ==
          (value == 1 || (value >= 5 && value <= 9)));
  CHECK(one.layout().selects(0));
  CHECK_FALSE(one.layout().selects(1));
  CHECK_FALSE(one.layout().selects(2));
  Selected nothing{{none, 0, none, none}};
  nothing.fields[1].selected = {};
  CHECK_FALSE(nothing.has(1, {1, 0, 0, 0}));
}

TEST_CASE("a selector may be selected itself, to any depth, but not in a circle") {
  const Selected chain{{none, 0, 1, 2}};
  CHECK(chain.has(3, {1, 5, 9, 0}));
  CHECK_FALSE(chain.has(3, {2, 5, 9, 0}));
  CHECK_FALSE(chain.has(3, {1, 2, 9, 0}));
  CHECK_FALSE(chain.has(3, {1, 5, 2, 0}));
  CHECK(chain.has(2, {1, 5, 2, 0}));
  const Selected circle{{1, 0, none, none}};
  CHECK_FALSE(circle.has(0, {1, 1, 1, 1}));
  CHECK_FALSE(circle.has(1, {1, 1, 1, 1}));
  CHECK_FALSE(Selected{{0, none, none, none}}.has(0, {1, 1, 1, 1}));
  CHECK_FALSE(Selected{{none, 4, none, none}}.has(1, {1, 1, 1, 1}));  // there is no such field
}

constexpr Field selected_by(std::uint16_t selector) {
  Field field = number(Number::integer, 8);
  field.selector = selector;
  return field;
}
// One that names the field behind the last: nothing is read there.
constexpr std::array<Field, 1> astray{selected_by(1)};
constexpr std::array<std::uint8_t, 1> one_byte{};
static_assert(!ocm::protocol::FrameLayout{"", TopicId{0x10}, 1, astray}.has(astray[0], one_byte));

TEST_CASE("which fields a frame has together") {
  using Layout = ocm::protocol::FrameLayout;
  static constexpr ocm::protocol::Law law{{1, 0}, {100, 0}, {4, 0}, {1, -2}, {5, -1}};
  static constexpr ocm::protocol::Law other_law{{2, 0}, {100, 0}, {4, 0}, {1, -2}, {5, -1}};
  static constexpr std::array<ocm::protocol::SelectorRange, 2> same{{{1, 1}, {5, 9}}};
  static constexpr std::array<ocm::protocol::SelectorRange, 2> wider{{{1, 1}, {5, 10}}};
  const auto together = [](const Field& a, const Field& b) {
    CHECK(Layout::choose_together(a, b) == Layout::choose_together(b, a));
    return Layout::choose_together(a, b);
  };
  Field plain = number(Number::integer, 8);
  Field selected = plain;
  selected.selector = 0;
  selected.selected = Selected::one_or_five;
  CHECK(together(plain, plain));
  CHECK_FALSE(together(plain, selected));
  Field changed = selected;
  changed.selected = same;  // the same numbers in another place
  CHECK(together(selected, changed));
  changed.selected = wider;
  CHECK_FALSE(together(selected, changed));
  changed.selected = std::span{same}.first(1);
  CHECK_FALSE(together(selected, changed));
  changed = selected;
  changed.selector = 2;
  CHECK_FALSE(together(selected, changed));
  const Field distance = ocm::protocol::derived(plain, 0, "distance", "m", law, false);
  const Field uncertainty = ocm::protocol::derived(plain, 0, "uncertainty", "m", law, true);
  CHECK(together(distance, uncertainty));
  CHECK_FALSE(together(distance, plain));
  CHECK_FALSE(together(distance, ocm::protocol::derived(plain, 1, "distance", "m", law, false)));
  CHECK_FALSE(together(distance, ocm::protocol::derived(plain, 0, "distance", "m", other_law, false)));
}

TEST_CASE(
    "a derived field is its source's place with the law's name, unit and range, and no names of values") {
  static constexpr ocm::protocol::Law law{{1, 0}, {100, 0}, {4, 0}, {1, -2}, {5, -1}};
  const Field& source = ocm::test::state_fields[0];
  const Field distance = ocm::protocol::derived(source, 3, "distance", "m", law, false);
  CHECK(distance.name == "distance");
  CHECK(distance.unit == "m");
  CHECK(distance.position == source.position);
  CHECK(distance.values.empty());
  CHECK_FALSE(distance.flags);
  CHECK(distance.min == Decimal{1, -2});
  CHECK(distance.max == Decimal{5, -1});
  CHECK(distance.derived_from == 3);
  CHECK_FALSE(distance.uncertainty);
  const Field uncertainty = ocm::protocol::derived(source, 3, "u", "m", law, true);
  CHECK(uncertainty.min == Decimal{});
  CHECK(uncertainty.max == Decimal{25, -2});  // 0.5^3 * 4 / 2
}

// --- what else a catalogue says ---

constexpr Topic on_board(std::uint8_t board) {
  Topic topic;
  topic.board = board;
  return topic;
}
static_assert(catalogue.board_name(on_board(0)) == "left" && catalogue.board_name(on_board(1)) == "right");
static_assert(catalogue.board_name(on_board(2)).empty());  // there are two

TEST_CASE("a message is in a catalogue what a topic is not") {
  using ocm::protocol::Address;
  const auto layout_of = [](std::uint16_t length, Address address) {
    ocm::protocol::FrameLayout layout;
    layout.length = length;
    layout.address = address;
    return layout;
  };
  const ocm::protocol::FrameLayout frames[] = {layout_of(8, {Address::By::identifier, false, 0x123}),
                                               layout_of(9, {Address::By::pgn, true, 0x18FE'ECFE})};
  Topic all[3];
  for (std::size_t i = 0; i < 2; ++i) {
    all[i].name = i == 0 ? "speed" : "VI";
    all[i].id = TopicId{0x10};
    all[i].kind = Kind::message;
    all[i].board = i == 0 ? 1 : ocm::protocol::no_board;
    all[i].frames = {&frames[i], 1};
  }
  all[0].cycle = 20ms;
  all[2] = catalogue.topics[0];
  const ocm::protocol::Catalogue mixed{"mixed", 250'000, ocm::test::boards, all};
  CHECK(mixed.find(TopicId{0x10}) == &all[2]);  // a message has no number for requests
  CHECK(mixed.find("VI") == &all[1]);
  CHECK(mixed.board_name(all[0]) == "right");
  CHECK(mixed.board_name(all[1]).empty());
  CHECK(all[0].is_message());
  CHECK_FALSE(all[2].is_message());
  CHECK(all[0].usual_period() == 20ms);
  CHECK(all[1].usual_period() == 0ms);
  CHECK(all[2].usual_period() == 1s);
  CHECK(catalogue.find("lamp_1")->usual_period() == 0ms);

  CHECK_FALSE(mixed.has_buses());
  CHECK(all[1].is_on("can0"));
  all[1].bus = "can1";
  CHECK(mixed.has_buses());
  CHECK_FALSE(all[1].is_on("can0"));
  CHECK(all[1].is_on("can1"));

  using ocm::protocol::identifier_of;
  CHECK(identifier_of({&all[0], 0}, Priority::low) == 0x123);
  CHECK(identifier_of({&all[1], 0}, Priority::urgent) == 0x18FE'ECFE);
  CHECK(identifier_of({&all[2], 1}, Priority::low) == 0x721);
  CHECK(identifier_of({catalogue.find("lamp_2"), 0}, Priority::high) == 0x131);
  CHECK(ocm::protocol::format_of(frames[0]) == ocm::can::Format::base);
  CHECK(ocm::protocol::format_of(frames[1]) == ocm::can::Format::extended);
  CHECK(frames[0].dlc() == 8);
  CHECK(frames[1].dlc() == 8);
  CHECK(layout_of(7, {}).dlc() == 7);
  // 8 bytes in an extended frame: 67 + 64 bits and 29 stuff bits.
  CHECK(ocm::protocol::worst_bits(layout_of(8, {Address::By::identifier, true, 1}), Priority::low) == 160);
  CHECK_FALSE(ocm::protocol::FrameRef{});
  CHECK(ocm::protocol::FrameHead{}.dlc == 0);
  CHECK(ocm::protocol::FrameLayout{}.length == 0);
  CHECK(ocm::protocol::FrameRef{&all[0], 0});
}

TEST_CASE("kinds and roles have the words of a spec") {
  using ocm::protocol::name;
  using ocm::protocol::Role;
  CHECK(name(Kind::sensor) == "sensor");
  CHECK(name(Kind::actuator) == "actuator");
  CHECK(name(Kind::message) == "message");
  const std::pair<Role, const char*> roles[] = {
      {Role::none, "none"},       {Role::drive, "drive"}, {Role::light, "light"}, {Role::status, "status"},
      {Role::refusal, "refusal"}, {Role::pose, "pose"},   {Role::ring, "ring"},   {Role::floor, "floor"}};
  for (const auto& [role, word] : roles) CHECK(name(role) == word);
}

TEST_CASE("the number of a type in a list; as many as there are when it is not there") {
  STATIC_REQUIRE(ocm::protocol::TopicList<Scale, Lamp>::index<Scale> == 0);
  STATIC_REQUIRE(ocm::protocol::TopicList<Scale, Lamp>::index<Lamp> == 1);
  STATIC_REQUIRE(ocm::protocol::TopicList<Scale>::index<Lamp> == 1);
  STATIC_REQUIRE(ocm::protocol::TopicList<>::index<Lamp> == 0);
}

}  // namespace protocol_topic_test
