#include "sim/worlds/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "ocm/mapper/link/prefix.hpp"

#include "generator/spec/file.hpp"
#include "generator/spec/json.hpp"
#include "generator/spec/node_reader.hpp"
#include "generator/spec/schema.hpp"
#include "sim/worlds/texts.hpp"

namespace ocm::sim::worlds {

namespace {

namespace plant = sim::mapper;
using sim::degree;
using sim::Vector;
using spec::At;
using spec::Kind;

using spec::shown;

constexpr spec::Document document{
    .what = "a world", .members = "name, walls and robots", .schema = "world.schema.json", .levels = 5};

constexpr double farthest_m = 1000;
constexpr std::size_t most_walls = 1000;
constexpr std::size_t most_robots = 200;
constexpr std::size_t most_anomalies = 100;

/// Bounds of a number, and what it counts.
struct Range {
  double least;
  double most;
  std::string_view unit;
};
constexpr Range coordinate{-farthest_m, farthest_m, "m"};
constexpr Range angle{-360, 360, "degrees"};

std::string print(double number) {
  std::array<char, 32> text{};
  const int length = std::snprintf(text.data(), text.size(), "%.4g", number);
  return {text.data(), static_cast<std::size_t>(length)};
}

class Reader : private spec::NodeReader {
 public:
  using NodeReader::NodeReader;

  WorldModel read(const spec::Node& node) {
    const At root{&node, ""};
    WorldModel world;
    if (!is_object(root, "a world is an object with name, walls and robots")) return world;
    check_keys(root, {"$schema", "name", "description", "friction", "field", "walls", "anomalies", "central",
                      "robots"});
    if (const auto at = require(root, "name", "what the world is called")) world.name = line(*at, false);
    if (const auto at = root.member("description")) (void)line(*at);
    if (const auto at = root.member("friction"))
      set(world.friction, *at, {0.05, 2, "(0.5: the floor that the robots' figures are for)"});
    if (const auto at = root.member("field")) read_field(*at, world);
    if (const auto at = require(root, "walls", "a list of walls, [] for none")) read_walls(*at, world);
    if (const auto at = root.member("anomalies")) read_anomalies(*at, world);
    if (const auto at = root.member("central")) read_central(*at, world.central);
    if (const auto at = require(root, "robots", "a list of robots, and where they start"))
      read_robots(*at, world);
    return world;
  }

 private:
  [[nodiscard]] std::optional<double> number(const At& at, const Range& range) {
    const std::string remedy =
        "a number from " + print(range.least) + " to " + print(range.most) + " " + std::string{range.unit};
    const auto decimal = this->decimal(at, remedy);
    if (!decimal) return std::nullopt;
    const double value = decimal->as_double();
    if (value >= range.least && value <= range.most) return value;
    tell(at, shown(*at.node).substr(0, 40) + " is out of range", remedy);
    return std::nullopt;
  }
  void set(double& value, const At& at, const Range& range) { value = number(at, range).value_or(value); }

  /// Whether a list has between `least` and `most` items.
  [[nodiscard]] bool is_list(const At& at, std::size_t least, std::size_t most, std::string_view remedy) {
    if (!is_kind(at, Kind::array, remedy)) return false;
    const std::size_t size = at.node->items.size();
    if (size >= least && size <= most) return true;
    tell(at, "a list of " + std::to_string(size), std::string{remedy});
    return false;
  }

  /// [x, y]
  [[nodiscard]] std::optional<Vector> pair(const At& at, const Range& range) {
    if (!is_list(at, 2, 2, "two numbers, [x, y]")) return std::nullopt;
    const auto x = number(at.item(0), range);
    const auto y = number(at.item(1), range);
    if (!x || !y) return std::nullopt;
    return Vector{*x, *y};
  }
  [[nodiscard]] std::optional<Vector> require_place(const At& at) {
    const auto place = require(at, "at", "where it is, [x, y] in metres");
    return place ? pair(*place, coordinate) : std::nullopt;
  }

  void read_field(const At& at, WorldModel& world) {
    if (!is_object(at, R"({"gauss": 0.14, "north": 90})")) return;
    check_keys(at, {"gauss", "north"});
    if (const auto gauss = at.member("gauss")) set(world.field_gauss, *gauss, {0.01, 2, "gauss"});
    double north_deg = world.north_rad / degree;
    if (const auto north = at.member("north")) set(north_deg, *north, angle);
    world.north_rad = north_deg * degree;
  }

  void read_walls(const At& at, WorldModel& world) {
    if (!is_list(at, 0, most_walls, "a list of at most 1000 walls, [] for none")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const std::size_t before = world.walls.size();
      read_wall(at.item(i), world);
      if (before <= most_walls && world.walls.size() > most_walls)
        tell(at.item(i), "more than " + std::to_string(most_walls) + " pieces of wall", "fewer of them");
    }
  }
  /// From corner to corner.
  void read_wall(const At& at, WorldModel& world) {
    static constexpr std::string_view form = "two or more corners, [[x, y], [x, y]]";
    if (!is_list(at, 2, most_walls, form)) return;
    std::optional<Vector> before;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const auto corner = pair(at.item(i), coordinate);
      if (before && corner && *before == *corner)
        tell(at.item(i), "a wall of no length: this corner is where the one before is", "leave it out");
      else if (before && corner)
        world.walls.push_back({*before, *corner});
      before = corner;
    }
  }

  void read_anomalies(const At& at, WorldModel& world) {
    if (!is_list(at, 0, most_anomalies, "a list of at most 100 anomalies")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, R"({"at": [0, 0], "radius": 0.4, "gauss": [0.1, 0]})")) continue;
      check_keys(item, {"at", "radius", "gauss"});
      plant::Anomaly anomaly;
      if (const auto place = require_place(item)) anomaly.place = *place;
      if (const auto radius = require(item, "radius", "how far it reaches, metres"))
        set(anomaly.radius_m, *radius, {0.01, farthest_m, "m"});
      if (const auto field = require(item, "gauss", "what it adds in its middle, [x, y] in gauss"))
        anomaly.field_gauss = pair(*field, {-8, 8, "gauss"}).value_or(Vector{});
      world.anomalies.push_back(anomaly);
    }
  }

  void read_central(const At& at, plant::Central& central) {
    if (!is_object(at, R"({"at": [0, 0], "range": 8})")) return;
    check_keys(at, {"at", "range", "loss_at_range"});
    if (const auto place = require_place(at)) central.place = *place;
    if (const auto range = at.member("range")) set(central.range_m, *range, {0.1, farthest_m, "m"});
    if (const auto loss = at.member("loss_at_range"))
      set(central.loss_at_range, *loss, {0, 1, "(a share of the packets)"});
  }

  void read_robots(const At& at, WorldModel& world) {
    if (!is_list(at, 1, most_robots, "a list of 1 to 200 robots")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, R"({"name": "AVR", "model": "avr", "at": [0, 0], "heading": 0})")) continue;
      const std::size_t before = told();
      plant::Start start = read_robot(item, world.starts);
      if (told() == before) check_room(item, start, world);
      if (told() == before) world.starts.push_back(std::move(start));
    }
  }
  [[nodiscard]] plant::Start read_robot(const At& at, const std::vector<plant::Start>& others) {
    static constexpr std::pair<std::string_view, plant::RobotKind> kinds[] = {
        {"avr", plant::RobotKind::avr}, {"arduino", plant::RobotKind::arduino}};
    check_keys(at, {"name", "model", "at", "heading"});
    plant::Start start;
    if (const auto name = require(at, "name", "what its dongle is called")) {
      start.name = robot_name(*name);
      const auto has_it = [&](const plant::Start& other) { return other.name == start.name; };
      if (std::any_of(others.begin(), others.end(), has_it))
        tell(*name, "a second robot " + spec::quoted(start.name), "names that differ");
    }
    if (const auto model = require(at, "model", "avr or arduino"))
      start.kind = one_of(*model, kinds).value_or(start.kind);
    if (const auto place = require_place(at)) start.pose = {place->x, place->y, 0};
    if (const auto heading = at.member("heading"))
      start.pose.heading_rad = number(*heading, angle).value_or(0) * degree;
    return start;
  }
  /// As the robots' line can carry it.
  [[nodiscard]] std::string robot_name(const At& at) {
    const std::string name = line(at, false);
    if (name.size() > ocm::mapper::link::max_name ||
        !std::all_of(name.begin(), name.end(), ocm::mapper::link::fits_name))
      tell(at, spec::quoted(name) + " is not a valid name of a robot",
           "1 to 20 printed ASCII characters other than : [ ] { }");
    return name;
  }

  void check_room(const At& at, const plant::Start& start, const WorldModel& world) {
    const At place = *at.member("at");
    if (const double room = plant::room_m(start, world.walls, {}); room < 0)
      tell(place,
           "robot " + spec::quoted(start.name) + " is inside a wall: it has a radius of " +
               print(start.radius_m()) + " m, and the wall is " +
               print(std::max(0.0, start.radius_m() + room)) + " m from its middle",
           "a place with more room");
    for (const plant::Start& other : world.starts)
      if (plant::room_m(start, {}, {other}) < 0)
        tell(place, "robot " + spec::quoted(start.name) + " overlaps robot " + spec::quoted(other.name),
             "at least " + print(start.radius_m() + other.radius_m()) + " m from middle to middle");
  }
};

}  // namespace

Loaded parse(std::string_view text, std::string_view file_name) {
  Loaded loaded;
  if (text.size() > max_world_bytes) {
    loaded.problems.push_back({std::string{file_name},
                               "the file has " + std::to_string(text.size()) + " bytes",
                               "a world has at most " + std::to_string(max_world_bytes)});
    return loaded;
  }
  const spec::Node root = spec::parse_json(text, file_name, loaded.problems, document);
  if (!spec::has_document(loaded.problems)) return loaded;
  WorldModel world = Reader{file_name, loaded.problems}.read(root);
  static const spec::Schema schema{schema_text(), document};
  schema.validate(root, file_name, loaded.problems);
  spec::sort_by_line(loaded.problems, file_name);
  if (loaded.problems.empty()) loaded.world = std::move(world);
  return loaded;
}

Loaded load(const std::filesystem::path& file) {
  Loaded loaded;
  const auto text =
      spec::read_document(file, "a world", "sim/worlds/square.json", loaded.problems, max_world_bytes);
  return text ? parse(*text, file.string()) : std::move(loaded);
}

Loaded find(const std::string& name) {
  std::error_code error;
  if (std::filesystem::exists(name, error) && !std::filesystem::is_directory(name, error)) return load(name);
  if (const auto text = built_in(name)) return parse(*text, name);
  std::string names;
  for (const auto each : built_in_names()) names += (names.empty() ? "" : ", ") + std::string{each};
  Loaded loaded;
  loaded.problems.push_back(
      {"", "there is no world '" + name + "'", "give a file, or one of those built in: " + names});
  return loaded;
}

std::string in_words(const Problem& problem) {
  return problem.place.empty() ? problem.what : problem.place + ": " + problem.what;
}

std::optional<std::string_view> built_in(std::string_view name) noexcept {
  for (const Text& world : world_texts())
    if (world.name == name) return world.text;
  return std::nullopt;
}

std::vector<std::string_view> built_in_names() {
  std::vector<std::string_view> names;
  for (const Text& world : world_texts()) names.push_back(world.name);
  return names;
}

}  // namespace ocm::sim::worlds
