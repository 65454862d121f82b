#include "cli/fleet/map_run.hpp"

#include <algorithm>
#include <chrono>
#include <unistd.h>

#include <fmt/format.h>

#include "cli/shared/fitted.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::fleet {
namespace {

using namespace std::chrono_literals;
using cognitive::Agreement;

/// Where robots began decides how their maps fit together.
void place_robots(CentralLine& line, const std::vector<unsigned>& robots, const Known& known,
                  const std::vector<std::string>& starts) {
  const auto& peers = line.end().peers();
  for (const std::string& text : starts)
    if (const std::string name = parse_start("map", text).name; std::none_of(
            peers.begin(), peers.end(), [&](const mapper::server::Peer& p) { return p.name == name; }))
      line.unknown(name);
  for (const unsigned index : robots) {
    const std::string name = line.name(index);
    const auto start = std::find_if(known.starts.begin(), known.starts.end(),
                                    [&](const Start& s) { return s.name == name; });
    if (start != known.starts.end())
      line.own()->server().fleet().set_origin(index, start->pose);
    else if (robots.size() > 1)
      fail({fmt::format("map: no start pose for {}, and {} robots draw one map", name, robots.size()),
            fmt::format("say where each was switched on: --start {}=0.5,0.5,90, or --world FILE", name)},
           exit_usage);
    if (!line.robot(index).handshake)
      remark(fmt::format(
          "map: {} was connected before, and does not say its size when asked: the usual one is taken; "
          "switch the robot off and on before `map`",
          name));
  }
}

double area_m2(const cognitive::Map& map, cognitive::CellState state) {
  std::size_t cells = 0;
  for (int y = map.box().low.y; y <= map.box().high.y; ++y)
    for (int x = map.box().low.x; x <= map.box().high.x; ++x) cells += map.state({x, y}) == state ? 1 : 0;
  return static_cast<double>(cells) * map.raster().resolution_m() * map.raster().resolution_m();
}

/// "... in 12 s".
std::string_view words(End end) {
  switch (end) {
    case End::known:
      return "all that can be reached";
    case End::bad_link:
      return "not all: the link is too bad beyond,";
    case End::out_of_range:
      return "not all: the rest is out of the radio's range,";
    case End::unseen:
      return "not all: the rest could not be seen,";
    case End::time_over:
      return "what was seen before --duration was over,";
    case End::interrupted:
      return "what was seen before it was interrupted,";
    case End::robots_lost:
      return "what was seen before every robot was lost,";
    case End::central_gone:
      return "what was seen before the central was gone,";
  }
  return "what was seen";
}
/// In JSON.
std::string_view key(End end) {
  switch (end) {
    case End::known:
      return "known";
    case End::bad_link:
      return "bad_link";
    case End::out_of_range:
      return "out_of_range";
    case End::unseen:
      return "unseen";
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

cognitive::FleetOptions fleet_options(const MapOptions& options, const Known& known) {
  cognitive::FleetOptions fleet;
  if (known.central) fleet.central = *known.central;
  const double range = options.range_m > 0 ? options.range_m : known.range_m;
  if (range > 0) fleet.range_m = static_cast<float>(range);
  return fleet;
}
cognitive::MappingOptions mapping_options(const MapOptions& options, const Known& known,
                                          const CentralLine& line, const std::vector<unsigned>& robots) {
  cognitive::MappingOptions mapping;
  const cognitive::FleetOptions& fleet = line.own()->server().fleet().options();
  mapping.explorer.range_m = fleet.near_range * fleet.range_m;  // from there on it would be called back
  mapping.robots.assign(robots.begin(), robots.end());
  mapping.map.resolution_m = static_cast<float>(options.resolution_cm / 100);
  mapping.explorer.home =
      known.central ? *known.central : cognitive::place(line.robot(robots.front()).origin);
  return mapping;
}

}  // namespace

MapRun::MapRun(const MapOptions& options, const Known& known)
    : options_(options), known_(known), line_("map", options.line, Need::own, fleet_options(options, known)) {
  robots_ = line_.connect(options.robots);
  line_.introduce(robots_);
  place_robots(line_, robots_, known_, options.starts);
  for (const unsigned index : robots_)
    if (!line_.robot(index).update)  // paused, by any program
      line_.end().unpause(index);
  mapping_.emplace(line_.own()->server().fleet(), mapping_options(options, known, line_, robots_));
  if (!options_.watch) line_.own()->owner().explores();
  line_.own()->owner().on_draw([this](std::string_view form) { return draw(form); });
  line_.own()->on_heard([this](std::size_t robot, mapper::link::Kind kind) { mapping_->heard(robot, kind); });
}

End MapRun::explore(std::optional<base::Duration> limit) {
  begin_ = CentralLine::now();
  try {
    end_ = drive(limit);
    took_ = CentralLine::now() - begin_;
    if (!options_.watch) (void)line_.halt(robots_);  // now, for a picture takes its time
    while (over_ && !over_()) line_.end().exchange();
    line_.own()->finish();
  } catch (const Exit&) {  // which has said that the line is gone
    took_ = CentralLine::now() - begin_;
    end_ = End::central_gone;
  }
  return end_;
}

std::string MapRun::draw(std::string_view form) const {
  if (!any()) return {};
  return to_form(map(), picture(result()), form);
}

MapPicture MapRun::picture(const std::optional<Agreement>& result) const {
  MapPicture picture;
  const base::Duration took = took_ != base::Duration::zero() ? took_ : CentralLine::now() - begin_;
  picture.title = !options_.title.empty() ? options_.title : "map by " + names();
  picture.subtitle = fmt::format("{}, {:.2f} m\u00b2 free", span(took),
                                 area_m2(mapping_->map(), cognitive::CellState::free));
  if (result)
    picture.subtitle += fmt::format("; precision {:.3f}, recall {:.3f}, explored {:.3f}", result->precision,
                                    result->recall, result->explored);
  for (const unsigned index : robots_)
    picture.robots.push_back({line_.name(index), mapping_->path(index), {}});
  picture.walls = known_.walls;
  return picture;
}

std::optional<Agreement> MapRun::result() const {
  if (known_.walls.empty()) return std::nullopt;
  return cognitive::agreement(mapping_->map(), known_.walls, known_.inside);
}

void MapRun::report(const std::optional<Agreement>& result) const {
  const auto& drawn = mapping_->counters();
  const auto& map = mapping_->map().counters();
  const auto& explorer = mapping_->explorer().counters();
  const double free = area_m2(mapping_->map(), cognitive::CellState::free);
  const cognitive::Left left = mapping_->explorer().left(mapping_->map());
  if (options_.json) {
    Json out{{"seconds", static_cast<double>(took_.count()) / 1e9},
             {"done", end_ == End::known},
             {"ended", key(end_)},
             {"robots", robots_.size()},
             {"border_known", left.known()},
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
  print_fitted(
      fmt::format("{} in {}: {:.2f} m2 free, {:.0f} % of their border known; {} drawn, {} not, because a "
                  "robot turned; "
                  "{}\n",
                  words(end_), span(took_), free, 100 * left.known(), counted(drawn.drawn, "update"),
                  drawn.turning, counted(explorer.goals, "goal")),
      4);
  if (result)
    print_fitted(
        fmt::format(
            "agreement with the true walls within 6 cm: precision {:.3f}, recall {:.3f}; explored {:.3f}\n",
            result->precision, result->recall, result->explored),
        4);
}

End MapRun::drive(std::optional<base::Duration> limit) {
  const base::Time begin = CentralLine::now();
  base::Time next = begin, told = begin;
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const bool done = line_.run(limit, [&] {
    const base::Time now = CentralLine::now();
    if (now < next) return false;
    next = now + 100ms;
    tell_held();
    if (!options_.watch) mapping_->step(now);
    if (terminal && now - told >= 10s) {
      told = now;
      remark(fmt::format("map: {}: {:.2f} m2 free, {}", span(now - begin),
                         area_m2(mapping_->map(), cognitive::CellState::free),
                         counted(mapping_->counters().drawn, "update")));
    }
    if (!lost_.empty() || std::any_of(robots_.begin(), robots_.end(), [&](unsigned i) { return lost(i); }))
      tell_lost();
    return !options_.watch && (mapping_->done() || all_robots_lost());
  });
  if (interrupted() != 0) return End::interrupted;
  if (all_robots_lost()) return End::robots_lost;
  return done ? end_of_exploring() : End::time_over;
}

End MapRun::end_of_exploring() const {
  const cognitive::Left left = mapping_->explorer().left(mapping_->map());
  if (left.is_known()) return End::known;
  if (!left.not_visited()) return End::unseen;
  return left.bad_link >= left.out_of_range ? End::bad_link : End::out_of_range;
}

void MapRun::tell_held() {
  for (const unsigned index : robots_) {
    const bool held = line_.own()->owner().held(index);
    const auto at = std::find(held_.begin(), held_.end(), index);
    if (held == (at != held_.end())) continue;
    mapping_->hold(index, held);
    if (held) {
      held_.push_back(index);
      if (options_.watch) continue;  // it sends none
      remark(fmt::format("map: {} is held by {}; the others go on. To let it go on: amiroctl unpause {}",
                         line_.name(index), line_.own()->owner().holder(index), line_.name(index)));
    } else {
      held_.erase(at);
      if (!options_.watch) remark(fmt::format("map: {} goes on", line_.name(index)));
    }
  }
}

void MapRun::tell_lost() {
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

bool MapRun::all_robots_lost() const {
  return std::all_of(robots_.begin(), robots_.end(), [this](unsigned index) { return lost(index); });
}

std::string MapRun::names() const {
  std::string text;
  for (const unsigned index : robots_) text += (text.empty() ? "" : ", ") + line_.name(index);
  return text;
}

}  // namespace ocm::cli::fleet
