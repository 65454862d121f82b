/// Mappers draw a map of where they are, together; and how well it agrees with walls that are known.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/client/diagnosis.hpp"
#include "ocm/cognitive/agreement.hpp"
#include "ocm/cognitive/mapping.hpp"

#include "cli/fleet/central_line.hpp"
#include "cli/fleet/picture.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verbs.hpp"
#include "sim/worlds/reader.hpp"

namespace ocm::cli {
namespace {

using namespace std::chrono_literals;
using cognitive::Agreement;
using cognitive::Mapping;
using sim::mapper::WorldModel;

struct MapVerbOptions {
  fleet::LineOptions line;
  std::vector<std::string> files;
  std::vector<std::string> robots;
  std::vector<std::string> starts;
  std::string duration;
  std::string world;
  std::string title;
  double resolution_cm = 4;
  double range_m = 0;
  bool watch = false;
  bool json = false;
};

struct Start {
  std::string name;
  motion::Pose pose;
};

/// NAME=X,Y,DEG: metres and degrees.
Start parse_start(const std::string& text) {
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
    fail({fmt::format("map: --start {}: no start", text),
          "write NAME=X,Y,DEG: metres and degrees, as in AVR=0.5,0.5,90"},
         exit_usage);
  return start;
}

std::optional<WorldModel> load_world(const std::string& name) {
  if (name.empty()) return std::nullopt;
  const auto text = sim::worlds::built_in(name);
  auto loaded = text ? sim::worlds::parse(*text, name) : sim::worlds::load(name);
  if (loaded.world) return std::move(*loaded.world);
  for (std::size_t i = 1; i < loaded.problems.size(); ++i)
    remark(fmt::format("{}: {}", loaded.problems[i].place, loaded.problems[i].what));
  fail({fmt::format("map: {}: {}", loaded.problems.front().place, loaded.problems.front().what),
        loaded.problems.front().remedy},
       exit_failure);
}

motion::Point to_point(sim::Vector v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y)};
}

/// What a world says of its walls, its central and where robots begin.
struct Known {
  std::vector<cognitive::Wall> walls;
  std::vector<motion::Point> inside;
  std::vector<Start> starts;
  std::optional<motion::Point> central;
  double range_m = 0;
};
Known known_of(const std::optional<WorldModel>& model, const std::vector<std::string>& starts) {
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
    Start start = parse_start(text);
    std::erase_if(known.starts, [&](const Start& other) { return other.name == start.name; });
    known.inside.push_back(cognitive::place(start.pose));
    known.starts.push_back(std::move(start));
  }
  return known;
}

/// A file of every kind that is asked for, before any robot moves.
void check_files(const std::vector<std::string>& files) {
  for (const std::string& file : files)
    if (!fleet::is_map_file(file))
      fail({fmt::format("map: {}: no kind of map", file), "end it in .svg, .png, .pdf or .pgm"}, exit_usage);
}

/// Where robots began decides how their maps fit together.
void place_robots(fleet::CentralLine& line, const std::vector<unsigned>& robots, const Known& known,
                  const std::vector<std::string>& starts) {
  const auto& peers = line.server().client().peers();
  for (const std::string& text : starts)
    if (const std::string name = parse_start(text).name; std::none_of(
            peers.begin(), peers.end(), [&](const mapper::server::Peer& p) { return p.name == name; }))
      line.unknown(name);
  for (const unsigned index : robots) {
    const std::string name = line.name(index);
    const auto start = std::find_if(known.starts.begin(), known.starts.end(),
                                    [&](const Start& s) { return s.name == name; });
    if (start != known.starts.end())
      line.server().fleet().set_origin(index, start->pose);
    else if (robots.size() > 1)
      fail({fmt::format("map: nobody said where {} began, and {} robots draw one map", name, robots.size()),
            fmt::format("say where each was switched on: --start {}=0.5,0.5,90, or --world FILE", name)},
           exit_usage);
    if (!line.fleet().robot(index).handshake)
      remark(
          fmt::format("map: {} was connected before, and does not say its size again: taken as usual", name));
  }
}

double area_m2(const cognitive::Map& map, cognitive::CellState state) {
  std::size_t cells = 0;
  for (int y = map.box().low.y; y <= map.box().high.y; ++y)
    for (int x = map.box().low.x; x <= map.box().high.x; ++x) cells += map.state({x, y}) == state ? 1 : 0;
  return static_cast<double>(cells) * map.raster().resolution_m() * map.raster().resolution_m();
}

/// Why it ended.
enum class End : std::uint8_t { known, time_over, interrupted, robots_lost, central_gone };

/// "... in 12 s".
std::string_view words(End end) {
  switch (end) {
    case End::known:
      return "all that can be reached";
    case End::time_over:
      return "what was seen until --duration was over";
    case End::interrupted:
      return "what was seen until it was interrupted";
    case End::robots_lost:
      return "what was seen until every robot was lost";
    case End::central_gone:
      return "what was seen until the central was gone";
  }
  return "what was seen";
}
/// In JSON.
std::string_view key(End end) {
  switch (end) {
    case End::known:
      return "known";
    case End::time_over:
      return "duration";
    case End::interrupted:
      return "interrupted";
    case End::robots_lost:
      return "robots_lost";
    case End::central_gone:
      return "central_gone";
  }
  return "known";
}

std::string span(base::Duration time) {
  return fmt::format("{:.0f} s", static_cast<double>(time.count()) / 1e9);
}

class Run {
 public:
  Run(const MapVerbOptions& options, const Known& known)
      : options_(options), known_(known), line_("map", options.line, fleet_options(options, known)) {
    robots_ = line_.connect(options.robots);
    place_robots(line_, robots_, known_, options.starts);
    for (const unsigned index : robots_)
      if (!line_.fleet().robot(index).update)  // paused, by whomever
        line_.server().fleet().unpause(index, fleet::CentralLine::now());
    mapping_.emplace(line_.server().fleet(), mapping_options(options, known, line_, robots_));
    line_.on_heard([this](std::size_t robot, mapper::link::Kind kind) { mapping_->heard(robot, kind); });
  }

  /// Until all is known, for `limit`, until Ctrl-C, or until the central is gone. Whichever it is, what was
  /// drawn is there.
  End explore(std::optional<base::Duration> limit) {
    const base::Time begin = fleet::CentralLine::now();
    try {
      end_ = drive(limit);
      took_ = fleet::CentralLine::now() - begin;
      if (!options_.watch) halt();
    } catch (const Exit&) {  // which has said that the line is gone
      took_ = fleet::CentralLine::now() - begin;
      end_ = End::central_gone;
    }
    return end_;
  }

  [[nodiscard]] fleet::MapPicture picture(const std::optional<Agreement>& result) const {
    fleet::MapPicture picture;
    picture.title = !options_.title.empty() ? options_.title : "map by " + names();
    picture.subtitle = fmt::format("{}, {:.2f} m\u00b2 free", span(took_),
                                   area_m2(mapping_->map(), cognitive::CellState::free));
    if (result)
      picture.subtitle += fmt::format("; precision {:.3f}, recall {:.3f}, explored {:.3f}", result->precision,
                                      result->recall, result->explored);
    for (const unsigned index : robots_)
      picture.robots.push_back({line_.name(index), mapping_->path(index), {}});
    picture.walls = known_.walls;
    return picture;
  }
  [[nodiscard]] std::optional<Agreement> result() const {
    if (known_.walls.empty()) return std::nullopt;
    return cognitive::agreement(mapping_->map(), known_.walls, known_.inside);
  }
  void report(const std::optional<Agreement>& result) const;

  [[nodiscard]] const cognitive::Map& map() const { return mapping_->map(); }
  [[nodiscard]] bool any() const { return mapping_->counters().drawn != 0; }

 private:
  End drive(std::optional<base::Duration> limit) {
    const base::Time begin = fleet::CentralLine::now();
    base::Time next = begin, told = begin;
    const bool terminal = isatty(STDERR_FILENO) != 0;
    const bool done = line_.run(limit, [&] {
      const base::Time now = fleet::CentralLine::now();
      if (now < next) return false;
      next = now + 100ms;
      if (!options_.watch) mapping_->step(now);
      if (terminal && now - told >= 10s) {
        told = now;
        remark(fmt::format("map: {}: {:.2f} m2 free, {}", span(now - begin),
                           area_m2(mapping_->map(), cognitive::CellState::free),
                           client::count(mapping_->counters().drawn, "update*")));
      }
      if (!lost_.empty() || std::any_of(robots_.begin(), robots_.end(), [&](unsigned i) { return lost(i); }))
        tell_lost();
      return !options_.watch && (mapping_->done() || nobody_left());
    });
    if (interrupted() != 0) return End::interrupted;
    if (nobody_left()) return End::robots_lost;
    return done ? End::known : End::time_over;
  }
  /// Now, for a picture takes its time.
  void halt() {
    for (const unsigned index : robots_)
      if (!lost(index) && !line_.fleet().robot(index).idle)
        (void)line_.server().fleet().go(index, {0, 0}, fleet::CentralLine::now());
    line_.flush(1s);
  }
  [[nodiscard]] bool nobody_left() const {
    return std::all_of(robots_.begin(), robots_.end(), [this](unsigned index) { return lost(index); });
  }
  static cognitive::FleetOptions fleet_options(const MapVerbOptions& options, const Known& known) {
    cognitive::FleetOptions fleet;
    if (known.central) fleet.central = *known.central;
    const double range = options.range_m > 0 ? options.range_m : known.range_m;
    if (range > 0) fleet.range_m = static_cast<float>(range);
    return fleet;
  }
  static cognitive::MappingOptions mapping_options(const MapVerbOptions& options, const Known& known,
                                                   const fleet::CentralLine& line,
                                                   const std::vector<unsigned>& robots) {
    cognitive::MappingOptions mapping;
    mapping.map.resolution_m = static_cast<float>(options.resolution_cm / 100);
    mapping.explorer.home =
        known.central ? *known.central : cognitive::place(line.fleet().robot(robots.front()).origin);
    return mapping;
  }
  [[nodiscard]] bool lost(unsigned index) const { return line_.fleet().robot(index).lost; }
  [[nodiscard]] std::string names() const {
    std::string text;
    for (const unsigned index : robots_) text += (text.empty() ? "" : ", ") + line_.name(index);
    return text;
  }
  void tell_lost() {
    for (const unsigned index : robots_) {
      const auto at = std::find(lost_.begin(), lost_.end(), index);
      if (lost(index) && at == lost_.end()) {
        remark(fmt::format("map: {} is lost", line_.name(index)));
        lost_.push_back(index);
      } else if (!lost(index) && at != lost_.end()) {
        remark(fmt::format("map: {} is back", line_.name(index)));
        lost_.erase(at);
      }
    }
  }

  const MapVerbOptions& options_;
  const Known& known_;
  fleet::CentralLine line_;
  std::vector<unsigned> robots_;
  std::optional<Mapping> mapping_;
  std::vector<unsigned> lost_;
  base::Duration took_{};
  End end_ = End::known;
};

void Run::report(const std::optional<Agreement>& result) const {
  const auto& drawn = mapping_->counters();
  const auto& map = mapping_->map().counters();
  const auto& explorer = mapping_->explorer().counters();
  const double free = area_m2(mapping_->map(), cognitive::CellState::free);
  if (options_.json) {
    Json out{{"seconds", static_cast<double>(took_.count()) / 1e9},
             {"done", end_ == End::known},
             {"ended", key(end_)},
             {"robots", robots_.size()},
             {"free_m2", free},
             {"updates", drawn.drawn},
             {"turning", drawn.turning},
             {"beams", map.hits + map.nothing + map.near + map.on_robots},
             {"goals", explorer.goals},
             {"calls_back", explorer.calls}};
    if (result)
      out["agreement"] = {{"precision", result->precision},
                          {"recall", result->recall},
                          {"explored", result->explored},
                          {"tolerance_m", 0.06}};
    fmt::print("{}\n", out.line());
    return;
  }
  fmt::print("{} in {}: {:.2f} m2 free; {} drawn, {} not, because a robot turned; {}\n", words(end_),
             span(took_), free, client::count(drawn.drawn, "update*"), drawn.turning,
             client::count(explorer.goals, "goal*"));
  if (result)
    fmt::print(
        "agreement with the true walls within 6 cm: precision {:.3f}, recall {:.3f}; explored {:.3f}\n",
        result->precision, result->recall, result->explored);
}

/// All that can be written; what cannot is told, each.
bool write_files(const std::vector<std::string>& files, const Run& run,
                 const std::optional<Agreement>& result) {
  bool all = true;
  for (const std::string& file : files) {
    const auto failure = fleet::write_map(file, run.map(), run.picture(result));
    remark(fmt::format("map: {}", failure ? failure->what + "; " + failure->remedy : file));
    all = all && !failure;
  }
  return all;
}

void run(const MapVerbOptions& options, int& exit_code) {
  check_files(options.files);
  if (!(options.resolution_cm >= 0.5 && options.resolution_cm <= 50))
    fail({fmt::format("map: --resolution {}: no size of a cell", options.resolution_cm),
          "write centimetres, 0.5 to 50"},
         exit_usage);
  std::optional<base::Duration> limit;
  if (!options.duration.empty()) limit = duration_option("--duration", options.duration);
  const Known known = known_of(load_world(options.world), options.starts);
  Run run{options, known};
  const End end = run.explore(limit);
  if (!run.any()) {
    if (interrupted() == 0) remark("map: no update came that could be drawn");
    exit_code = exit_code_after_interrupt(exit_failure);
    return;
  }
  const auto result = run.result();
  const bool written = write_files(options.files, run, result);
  run.report(result);
  const bool whole = end != End::robots_lost && end != End::central_gone;
  exit_code = written ? exit_code_after_interrupt(whole ? exit_success : exit_failure) : exit_failure;
}

}  // namespace

void add_map(Verb app, Session&, int& exit_code) {
  auto verb =
      app.add_verb("map", "let mappers explore, and draw a map of what they see", mapper_group,
                   "  amiroctl map room.svg\n"
                   "  amiroctl map room.png room.pgm --robots AVR --duration 5min\n"
                   "  amiroctl map room.svg --start AVR=0.4,0.4,0 --start Arduino=2,1.4,180\n"
                   "  amiroctl map room.svg --world labyrinth    drawn over the true walls, and compared");
  const auto options = std::make_shared<MapVerbOptions>();
  verb.add_option("file", options->files, ".svg, .png, .pdf; .pgm with a .yaml beside it for ROS")
      .required()
      .type_name("FILE ...");
  verb.add_option("--robots", options->robots, "names, addresses or indexes; default: all")
      .type_name("ROBOT ...");
  verb.add_option("--duration", options->duration, "at most so long; default: until all is known")
      .type_name("T");
  verb.add_option("--start", options->starts, "where a robot was switched on: metres, degrees")
      .type_name("NAME=X,Y,DEG");
  verb.add_option("--world", options->world,
                  "a simulated world, or its name: starts, central, true walls to compare with")
      .type_name("FILE");
  verb.add_option("--resolution", options->resolution_cm, "side of a cell in cm")
      .type_name("CM")
      .show_default();
  verb.add_option("--range", options->range_m, "of the central's radio in m: nobody is sent farther")
      .type_name("M");
  verb.add_option("--title", options->title, "default: the robots").type_name("TEXT");
  verb.add_flag("--watch", options->watch, "draw only; somebody else drives");
  verb.add_flag("--json", options->json, "figures as an object");
  fleet::add_line_options(verb, options->line);
  verb.callback([options, &exit_code] { run(*options, exit_code); });
}

}  // namespace ocm::cli
