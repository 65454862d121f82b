// The compiled catalogue and the one that is loaded from the same spec say the same.
#include <algorithm>
#include <array>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "generator/spec/spec.hpp"
#include "golden/ferry.hpp"
#include "golden/probe.hpp"
#include "golden/whole.hpp"
#include "sim/amiro/proximity.hpp"

namespace generator_catalogue_test {

namespace protocol = ocm::protocol;

template <class Range>
std::vector<typename Range::value_type> list(const Range& range) {
  return {range.begin(), range.end()};
}

void compare(const protocol::Field& a, const protocol::Field& b) {
  CAPTURE(a.name);
  CHECK(a.name == b.name);
  CHECK(a.position == b.position);
  CHECK(a.is_signed == b.is_signed);
  CHECK(a.scale == b.scale);
  CHECK(a.offset == b.offset);
  CHECK(a.unit == b.unit);
  CHECK(a.raw_min == b.raw_min);
  CHECK(a.raw_max == b.raw_max);
  CHECK(list(a.values) == list(b.values));
  CHECK(a.flags == b.flags);
  CHECK(a.number == b.number);
  CHECK(a.min == b.min);
  CHECK(a.max == b.max);
  CHECK(a.derived_from == b.derived_from);
  CHECK(a.uncertainty == b.uncertainty);
  REQUIRE(a.is_derived() == b.is_derived());
  if (a.is_derived()) CHECK(*a.law == *b.law);
}

void compare(const protocol::Topic& a, const protocol::Topic& b) {
  CAPTURE(a.name);
  CHECK(a.name == b.name);
  CHECK(list(a.aliases) == list(b.aliases));
  CHECK(a.id == b.id);
  CHECK(a.kind == b.kind);
  CHECK(a.role == b.role);
  CHECK(a.board == b.board);
  CHECK(a.priority == b.priority);
  CHECK(a.period == b.period);
  CHECK(a.shortest_period == b.shortest_period);
  CHECK(a.deadline == b.deadline);
  CHECK(a.jitter == b.jitter);
  CHECK(a.timeout == b.timeout);
  CHECK(a.group == b.group);
  CHECK(a.instance == b.instance);
  CHECK(a.source == b.source);
  REQUIRE(a.frames.size() == b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    CHECK(a.frames[i].name == b.frames[i].name);
    CHECK(a.frames[i].id == b.frames[i].id);
    CHECK(a.frames[i].length == b.frames[i].length);
    CHECK(a.frames[i].worst_bits == b.frames[i].worst_bits);
    CHECK(a.frames[i].worst_bits[0] != 0);
    CHECK(a.frames[i].fields.size() == b.frames[i].fields.size());
    REQUIRE(a.frames[i].values().size() == b.frames[i].values().size());
    for (std::size_t j = 0; j < a.frames[i].values().size(); ++j)
      compare(a.frames[i].values()[j], b.frames[i].values()[j]);
  }
}

void compare(const protocol::Catalogue& a, const protocol::Catalogue& b) {
  CHECK(a.robot == b.robot);
  CHECK(a.bit_rate == b.bit_rate);
  REQUIRE(a.boards.size() == b.boards.size());
  for (std::size_t i = 0; i < a.boards.size(); ++i) {
    CHECK(a.boards[i].name == b.boards[i].name);
    CHECK(a.boards[i].mcu == b.boards[i].mcu);
  }
  REQUIRE(a.topics.size() == b.topics.size());
  for (std::size_t i = 0; i < a.topics.size(); ++i) compare(a.topics[i], b.topics[i]);
}

ocm::spec::Loaded load(const std::string& name) {
  auto loaded = ocm::spec::load(std::string{OCM_SOURCE_DIR} + "/" + name);
  for (const auto& p : loaded.problems) UNSCOPED_INFO(p.place << ": " << p.what << "; " << p.remedy);
  REQUIRE(loaded.spec != nullptr);
  return loaded;
}

TEST_CASE("AMiRo: compiled and loaded are equal") {
  const auto loaded = load("spec/topics.json");
  compare(amiro::catalogue, loaded.spec->catalogue());
}

TEST_CASE("the other robot: compiled and loaded are equal") {
  const auto loaded = load("examples/other-robot/topics.json");
  compare(ferry::catalogue, loaded.spec->catalogue());
}

TEST_CASE("the compiled catalogue of a robot with floating-point numbers is the loaded one") {
  const auto loaded = load("tests/generator/probe.json");
  compare(probe::catalogue, loaded.spec->catalogue());
}

TEST_CASE("the compiled catalogue of all that a spec can say is the loaded one, but for its messages") {
  const auto loaded = load("tests/generator/golden/whole.json");
  protocol::Catalogue topics = loaded.spec->catalogue();
  const auto is_topic = [](const protocol::Topic& topic) { return topic.kind != protocol::Kind::message; };
  const auto count = std::count_if(topics.topics.begin(), topics.topics.end(), is_topic);
  topics.topics = topics.topics.first(static_cast<std::size_t>(count));
  compare(whole::catalogue, topics);
}

TEST_CASE("a moved spec keeps its catalogue where it is") {
  auto loaded = load("spec/topics.json");
  const auto* catalogue = &loaded.spec->catalogue();
  const auto* name = catalogue->robot.data();
  ocm::spec::Spec moved = std::move(*loaded.spec);
  CHECK(&moved.catalogue() == catalogue);
  CHECK(moved.catalogue().robot.data() == name);
  compare(amiro::catalogue, moved.catalogue());
}

TEST_CASE("two signals of one name are distinguished, and a selector stays the one that it was") {
  const auto loaded = ocm::spec::parse(
      "BO_ 1 A: 8 X\n SG_ S M : 0|4@1+ (1,0) [0|0] \"\" X\n SG_ S m3 : 8|8@1+ (1,0) [0|0] \"\" X\n"
      " SG_ S_2 : 16|8@1+ (1,0) [0|0] \"\" X\n SG_ S : 24|8@1+ (1,0) [0|0] \"\" X\n",
      "a.dbc");
  REQUIRE(loaded.spec != nullptr);
  const auto& layout = loaded.spec->catalogue().topics[0].frames[0];
  REQUIRE(layout.fields.size() == 4);
  const char* const names[] = {"S", "S_3", "S_2", "S_4"};
  for (std::size_t i = 0; i < 4; ++i) CHECK(layout.fields[i].name == names[i]);
  CHECK(layout.fields[1].selector == 0);
  CHECK(layout.has(layout.fields[1], std::array<std::uint8_t, 8>{3}));
  CHECK_FALSE(layout.has(layout.fields[1], std::array<std::uint8_t, 8>{2}));
}

TEST_CASE("the ring's places and law in the AMiRo's spec are those of the simulated robot") {
  const auto loaded = load("spec/topics.json");
  const ocm::sim::RingModel ring;
  const auto* topic = loaded.spec->catalogue().find("ring");
  REQUIRE(topic != nullptr);
  for (const auto& each : loaded.spec->model().topics) {
    if (each.role != protocol::Role::ring) continue;
    REQUIRE(each.geometry);
    CHECK(each.geometry->radius.as_double() == ring.radius_m);
    CHECK(each.geometry->first.as_double() == Approx(ring.first_rad).margin(1e-9));
    CHECK(each.geometry->step.as_double() == Approx(ring.step_rad).margin(1e-9));
  }
  REQUIRE(topic->frames.size() == ring.offset_counts.size());
  for (std::size_t i = 0; i < topic->frames.size(); ++i) {
    const auto values = topic->frames[i].values();
    REQUIRE(values.size() == 3);
    REQUIRE(values[1].is_derived());
    CHECK(values[1].unit == "m");
    CHECK(values[2].uncertainty);
    const protocol::Law& law = *values[1].law;
    CHECK(law.offset.as_double() == ring.offset_counts[i]);
    CHECK(law.noise.as_double() == ocm::sim::count_noise);
    for (const double metres : {0.004, 0.01, 0.05, 0.1, 0.2}) {
      const double counts = ring.offset_counts[i] + ocm::sim::reflected_counts(metres, 0);
      CHECK(law.value(counts) == Approx(metres).epsilon(1e-8));
    }
    // The converter at its end is still within the range.
    CHECK(law.holds(ocm::sim::most_counts));
  }
}

TEST_CASE("every fact of the AMiRo has a source") {
  for (const auto& topic : amiro::catalogue.topics) CHECK_FALSE(topic.source.empty());
}

}  // namespace generator_catalogue_test
