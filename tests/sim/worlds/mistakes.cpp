// What is reported of each mistake in a world: mistakes.world.txt. bad_worlds.json has those that people
// make.
#include "tests/generator/mistakes.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "sim/worlds/reader.hpp"

namespace sim_worlds_mistakes_test {

TEST_CASE("what is reported of each mistake in a world") {
  mistakes::compare("sim/worlds/mistakes.world.txt",
                    mistakes::mistakes_of("sim/worlds/good.json", [](const std::string& text) {
                      return ocm::sim::worlds::parse(text, "f");
                    }));
}

}  // namespace sim_worlds_mistakes_test
