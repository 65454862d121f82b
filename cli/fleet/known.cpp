#include "cli/fleet/known.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>

#include "cli/shared/memory.hpp"
#include "cli/shared/messages.hpp"
#include "sim/worlds/reader.hpp"

namespace ocm::cli::fleet {
namespace {

using sim::mapper::WorldModel;

std::optional<WorldModel> load_world(std::string_view verb, const std::string& name) {
  if (name.empty()) return std::nullopt;
  const EndsWithoutMemory ends;
  auto loaded = sim::worlds::find(name);
  if (loaded.world) return std::move(*loaded.world);
  for (std::size_t i = 1; i < loaded.problems.size(); ++i) remark(sim::worlds::in_words(loaded.problems[i]));
  fail({fmt::format("{}: {}", verb, sim::worlds::in_words(loaded.problems.front())),
        loaded.problems.front().remedy},
       exit_failure);
}

motion::Point to_point(sim::Vector v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y)};
}

}  // namespace

Start parse_start(std::string_view verb, const std::string& text) {
  const std::size_t equals = text.find('=');
  Start start;
  float degrees = 0;
  int size = 0;
  if (equals != std::string::npos) start.name = text.substr(0, equals);
  const bool parsed = equals != std::string::npos &&
                      std::sscanf(text.c_str() + equals + 1, "%f,%f,%f%n", &start.pose.x_m, &start.pose.y_m,
                                  &degrees, &size) == 3 &&
                      text.c_str()[equals + 1 + static_cast<std::size_t>(size)] == '\0';
  start.pose.heading_rad = motion::wrap(motion::radians(degrees));
  if (!parsed || start.name.empty() || !motion::is_finite(start.pose) ||
      !cognitive::Raster::has(cognitive::place(start.pose)))
    fail({fmt::format("{}: --start {}: no start", verb, text),
          "write NAME=X,Y,DEG: metres and degrees, as in AVR=0.5,0.5,90"},
         exit_usage);
  return start;
}

Known known_of(std::string_view verb, const std::string& world, const std::vector<std::string>& starts) {
  const auto model = load_world(verb, world);
  Known known;
  if (model) {
    for (const auto& wall : model->walls) known.walls.push_back({to_point(wall.a), to_point(wall.b)});
    for (const auto& start : model->starts) {
      const motion::Point p = to_point(start.pose.position());
      known.inside.push_back(p);
      known.starts.push_back({start.name, {p.x_m, p.y_m, static_cast<float>(start.pose.heading_rad)}});
    }
    known.central = to_point(model->central.place);
    known.range_m = model->central.range_m;
  }
  for (const auto& text : starts) {
    Start start = parse_start(verb, text);
    std::erase_if(known.starts, [&](const Start& other) { return other.name == start.name; });
    known.inside.push_back(cognitive::place(start.pose));
    known.starts.push_back(std::move(start));
  }
  return known;
}

}  // namespace ocm::cli::fleet
