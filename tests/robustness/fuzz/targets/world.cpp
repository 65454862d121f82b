// Worlds of mappers: any text is a world or has problems in words; in a world every wall has a length,
// every robot has a name of its own and room, and the field is a number everywhere.
#include <cmath>

#include "ocm/mapper/link/prefix.hpp"

#include "sim/worlds/reader.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

namespace {

bool is_finite(sim::Vector vector) {
  return std::isfinite(vector.x) && std::isfinite(vector.y);
}

void check(const sim::worlds::WorldModel& model) {
  fuzz::expect(!model.starts.empty(), "a world has a robot");
  fuzz::expect(model.friction > 0, "a floor has friction");
  fuzz::expect(is_finite(model.central.place) && model.central.range_m > 0, "a central is somewhere");
  for (const auto& wall : model.walls)
    fuzz::expect(is_finite(wall.a) && is_finite(wall.b) && !(wall.a == wall.b), "a wall has a length");
  for (const auto& anomaly : model.anomalies)
    fuzz::expect(anomaly.radius_m > 0 && is_finite(model.field_at(anomaly.place)), "a field is a number");
  for (const auto& start : model.starts) {
    fuzz::expect(room_m(start, model.walls, {}) >= 0, "a robot stands in no wall");
    fuzz::expect(mapper::link::safe_name(start.name) == start.name, "a robot's name is one");
    fuzz::expect(is_finite(model.field_at(start.centre())), "a field is a number");
    for (const auto& other : model.starts)
      if (&other != &start)
        fuzz::expect(other.name != start.name && room_m(start, {}, {other}) >= 0, "each robot is itself");
  }
  const auto more = starts_for(model, model.starts.size() + 2);
  fuzz::expect(!more || more->size() == model.starts.size() + 2, "as many robots as are asked for, or none");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto loaded = sim::worlds::parse(fuzz::text_of(data, size), "fuzzed.json");
  fuzz::expect(loaded.world.has_value() == loaded.problems.empty(), "a text is a world or has problems");
  for (const auto& problem : loaded.problems)
    fuzz::expect(!problem.place.empty() && !problem.what.empty() && !problem.remedy.empty(),
                 "a problem has a place, words and a remedy");
  if (loaded.world) check(*loaded.world);
  return 0;
}
