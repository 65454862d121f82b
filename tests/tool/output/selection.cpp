// What a choice of fields names: topics, their frames and fields, groups of them, and what is derived.
#include "cli/output/selection.hpp"

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/protocol/law.hpp"
#include "ocm/protocol/topic.hpp"

namespace tool_output_selection_test {

using namespace ocm;
using protocol::Field;
using protocol::FrameLayout;

Field named(std::string_view name) {
  Field field;
  field.name = name;
  return field;
}

/// Wheels of three frames, a group of lights, a ring with a derived distance, and an engine on two
/// interfaces.
struct Robot {
  static constexpr protocol::Law law{{1, 2}, {0, 0}, {0, 0}, {1, -2}, {1, 0}};
  std::array<Field, 2> speed{named("x"), named("z")};
  std::array<Field, 2> place{named("x"), named("y")};
  std::array<Field, 2> turn{named("turn"), named("y")};
  std::array<Field, 1> level{named("level")};
  std::array<Field, 1> raw{named("raw")};
  std::array<Field, 2> of_ring{raw[0], protocol::derived(raw[0], 0, "distance", "m", law, false)};
  std::array<FrameLayout, 3> wheels;
  std::array<FrameLayout, 2> lights, engines;
  FrameLayout ring;
  std::array<std::string_view, 1> aliases{"w"};
  std::array<protocol::Topic, 6> topics;
  protocol::Catalogue catalogue;

  Robot() {
    wheels[0].name = "speed";
    wheels[0].fields = speed;
    wheels[1].name = "place";
    wheels[1].fields = place;
    wheels[2].name = "y";
    wheels[2].fields = turn;
    ring.fields = raw;
    ring.with_derived = of_ring;
    topics[0].name = "wheels";
    topics[0].aliases = aliases;
    topics[0].frames = wheels;
    topics[1].name = "light_1";
    topics[2].name = "light_2";
    topics[3].name = "ring";
    topics[3].frames = {&ring, 1};
    for (std::size_t i = 0; i < 2; ++i) {
      lights[i].fields = level;
      topics[1 + i].group = "light";
      topics[1 + i].frames = {&lights[i], 1};
      engines[i].fields = level;
      topics[4 + i].name = "engine";
      topics[4 + i].bus = i == 0 ? "can0" : "can1";
      topics[4 + i].frames = {&engines[i], 1};
    }
    catalogue.topics = topics;
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  /// Names of the fields, or what is wrong.
  [[nodiscard]] std::string chosen(const std::vector<std::string>& words) const {
    const auto selection = cli::Selection::of(catalogue, words);
    if (!selection) return selection.error.what;
    std::string names;
    for (const cli::ChosenField& field : (*selection).fields())
      names += (names.empty() ? "" : " ") + field.name;
    return names;
  }
};

TEST_CASE("selection: a topic, one of its frames, and fields by their names alone or with their frame's",
          "[output]") {
  const Robot robot;
  const std::string all =
      "wheels.speed.x wheels.speed.z wheels.place.x wheels.place.y wheels.y.turn wheels.y.y";
  CHECK(robot.chosen({"wheels"}) == all);
  CHECK(robot.chosen({"w"}) == all);
  CHECK(robot.chosen({"wheels.speed"}) == "wheels.speed.x wheels.speed.z");
  CHECK(robot.chosen({"w.place.y"}) == "wheels.place.y");
  CHECK(robot.chosen({"wheels.z"}) == "wheels.speed.z");
  // One that several frames have is meant in each; a frame's name means all of that frame.
  CHECK(robot.chosen({"wheels.x"}) == "wheels.speed.x wheels.place.x");
  CHECK(robot.chosen({"wheels.y"}) == "wheels.place.y wheels.y.turn wheels.y.y");
  CHECK(robot.chosen({"ring.raw"}) == "ring.raw");
}

TEST_CASE("selection: in the order of the words, and each field once", "[output]") {
  const Robot robot;
  CHECK(robot.chosen({"ring", "wheels.place.y", "wheels.place", "ring.raw"}) ==
        "ring.raw wheels.place.y wheels.place.x");
  CHECK(robot.chosen({"light_2", "light"}) == "light_2.level light_1.level");
}

TEST_CASE("selection: a group is all of its topics, and a name on several interfaces each of them",
          "[output]") {
  const Robot robot;
  CHECK(robot.chosen({"light"}) == "light_1.level light_2.level");
  CHECK(robot.chosen({"light.level"}) == "light_1.level light_2.level");
  CHECK(robot.chosen({"engine.level"}) == "engine.level engine.level");
}

TEST_CASE("selection: what is derived is chosen by its own name only", "[output]") {
  const Robot robot;
  CHECK(robot.chosen({"ring"}) == "ring.raw");
  CHECK(robot.chosen({"ring.distance"}) == "ring.distance");
}

TEST_CASE("selection: a word that names nothing, and what may be meant", "[output]") {
  const Robot robot;
  CHECK(robot.chosen({"wheels", "lamp"}) == "no topic 'lamp'");
  CHECK(robot.chosen({"lamp.level"}) == "no topic 'lamp'");
  CHECK(robot.chosen({"wheels.level"}) == "no field 'wheels.level'");
  CHECK(robot.chosen({"wheels."}) == "no field 'wheels.'");
  CHECK(robot.chosen({"ring.raw.x"}) == "no field 'ring.raw.x'");
  const std::vector<std::string> mistyped{"wheels.plase.y"};
  CHECK_THAT(cli::Selection::of(robot.catalogue, mistyped).error.remedy, Catch::Contains("'wheels.place.y'"));
}

TEST_CASE("selection: of two frames with the same fields it has those of the one that was chosen",
          "[output]") {
  const Robot robot;
  const std::vector<std::string> words{"light_1", "wheels.z"};
  const auto found = cli::Selection::of(robot.catalogue, words);
  REQUIRE(found);
  const cli::Selection& some = *found;
  CHECK_FALSE(some.everything());
  CHECK(some.has(robot.lights[0]));
  CHECK(some.has(robot.lights[0], robot.level[0]));
  CHECK_FALSE(some.has(robot.lights[1]));
  CHECK_FALSE(some.has(robot.lights[1], robot.level[0]));
  CHECK(some.has(robot.wheels[0]));
  CHECK(some.has(robot.wheels[0], robot.speed[1]));
  CHECK_FALSE(some.has(robot.wheels[0], robot.speed[0]));
  const cli::Selection all;
  CHECK(all.everything());
  CHECK(all.has(robot.lights[1]));
  CHECK(all.has(robot.lights[1], robot.level[0]));
}

}  // namespace tool_output_selection_test
