// Two mappers draw a labyrinth in virtual time: their own application, in a world with noise, slip and
// magnetic anomalies, over a radio that loses packets, through the central, to the Cognitive Operator. How
// well the map agrees with the true walls, as numbers; and a robot that drives out of the radio's range is
// called back before its link dies.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/cognitive/agreement.hpp"
#include "ocm/cognitive/mapping.hpp"
#include "ocm/cognitive/server.hpp"

#include "sim/mapper/fleet.hpp"
#include "unit/base/explore.hpp"

namespace sim_mapper_mapping_test {

using namespace std::chrono_literals;
namespace cognitive = ocm::cognitive;
namespace sim = ocm::sim::mapper;
using ocm::base::Time;
using ocm::motion::Point;
using ocm::sim::pi;
using ocm::sim::Vector;

Point point(Vector v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y)};
}
void walls(sim::WorldModel& model, const std::vector<Vector>& corners) {
  for (std::size_t i = 1; i < corners.size(); ++i) model.walls.push_back({corners[i - 1], corners[i]});
}

/// As sim/worlds/labyrinth.json has it.
sim::WorldModel labyrinth() {
  sim::WorldModel model;
  model.name = "labyrinth";
  walls(model, {{0, 0}, {2.19, 0}, {2.19, 2}, {0, 2}, {0, 0}});
  walls(model, {{0.75, 0.7}, {1.4, 0.7}, {1.4, 1.25}, {0.75, 1.25}, {0.75, 0.7}});
  walls(model, {{0, 1.25}, {0.3, 1.25}});
  walls(model, {{1.4, 1.25}, {1.4, 1.5}});
  model.anomalies = {{{1.9, 1.7}, 0.5, {0.08, -0.06}}, {{0.2, 1.6}, 0.35, {-0.09, -0.03}}};
  model.central = {{-0.5, 1}, 8, 0.5};
  model.starts = {{"AVR", sim::RobotKind::avr, {0.4, 0.35, 0}},
                  {"Arduino", sim::RobotKind::arduino, {1.8, 0.35, pi / 2}}};
  return model;
}
/// As sim/worlds/range.json has it, with one robot.
sim::WorldModel corridor() {
  sim::WorldModel model;
  model.name = "range";
  walls(model, {{-0.5, -0.6}, {11.5, -0.6}, {11.5, 0.6}, {-0.5, 0.6}, {-0.5, -0.6}});
  model.central = {{0, 0.5}, 4, 0.6};
  model.starts = {{"AVR", sim::RobotKind::avr, {0.5, 0, 0}}};
  return model;
}

/// A server at the simulated central's line.
struct Expedition {
  sim::World world;
  sim::Fleet robots;
  cognitive::Server server;
  std::optional<cognitive::Mapping> mapping;
  Time now{};
  unsigned lost = 0;           ///< links
  double farthest_m = 0;       ///< a robot was from the central
  std::uint32_t worst = 1000;  ///< quality of a link, per mille

  Expedition(const sim::WorldModel& model, std::uint64_t seed, const cognitive::FleetOptions& options,
             double loss = 0)
      : world(model, {.seed = seed}), robots(world, radio(world, seed, loss)), server(options) {}
  /// `loss`: of packets everywhere, besides what is lost at a distance.
  static sim::FleetOptions radio(const sim::World& world, std::uint64_t seed, double loss) {
    auto options = sim::Fleet::options_for(world, seed);
    options.radio.loss_everywhere = loss;
    return options;
  }

  void advance(ocm::base::Duration time) {
    for (const Time end = now + time; now < end;) {
      now += 10ms;
      robots.advance_to(now);
      server.feed(robots.read(), now, [this](std::size_t robot, ocm::mapper::link::Kind kind) {
        if (mapping) mapping->heard(robot, kind);
      });
      server.expire(now);
      robots.write(server.take());
      while (const auto event = server.next_event())
        if (event->kind == ocm::mapper::server::CentralEvent::Kind::lost) ++lost;
      if (mapping && now.time_since_epoch() % 100ms == 0ms) mapping->step(now);
      for (std::size_t i = 0; i < robots.size(); ++i)
        farthest_m = std::max(farthest_m, world.distance_to_central(i));
    }
  }
  /// Finds, connects and confirms all robots, and says where they began.
  void begin() {
    server.client().scan(1s);
    advance(3s);
    for (const auto& peer : std::vector<ocm::mapper::server::Peer>{server.client().peers()}) {
      server.client().connect(peer.index);
      for (const auto& start : world.model().starts)
        if (start.name == peer.name)
          server.fleet().set_origin(peer.index,
                                    {static_cast<float>(start.pose.x_m), static_cast<float>(start.pose.y_m),
                                     static_cast<float>(start.pose.heading_rad)});
    }
    cognitive::MappingOptions options;
    options.explorer.home = server.fleet().options().central;
    mapping.emplace(server.fleet(), options);
  }
  /// Until nothing is left to do, or for so long. Seconds.
  double explore(ocm::base::Duration most) {
    begin();
    for (const Time end = now + most; now < end && !mapping->done();) {
      advance(200ms);
      for (std::size_t i = 0; i < robots.size(); ++i)
        if (server.fleet().robot(i).linked) worst = std::min(worst, server.fleet().quality_per_mille(i));
    }
    return static_cast<double>(now.time_since_epoch().count()) / 1e9;
  }
  cognitive::Agreement result(float tolerance_m = 0.06F) const {
    std::vector<cognitive::Wall> true_walls;
    for (const auto& wall : world.model().walls) true_walls.push_back({point(wall.a), point(wall.b)});
    std::vector<Point> inside;
    for (const auto& start : world.model().starts) inside.push_back(point(start.pose.position()));
    return cognitive::agreement(mapping->map(), true_walls, inside, tolerance_m);
  }
};

cognitive::FleetOptions options_for(const sim::WorldModel& model, bool knows_range) {
  cognitive::FleetOptions options;
  options.central = point(model.central.place);
  if (knows_range) options.range_m = static_cast<float>(model.central.range_m);
  return options;
}

TEST_CASE(
    "mapper mapping: two robots draw the labyrinth of 4.38 m2 together, and the map agrees with its walls") {
  // [T2 §13.3, §14.3: the thesis shows pictures; these are our figures, docs/cognitive.md has them]
  double precision = 0, recall = 0, explored = 0, precision_4_cm = 0, recall_4_cm = 0;
  constexpr std::uint64_t seeds = 12;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    CAPTURE(seed);
    const auto model = labyrinth();
    Expedition expedition{model, seed, options_for(model, true)};
    const double seconds = expedition.explore(15min);
    REQUIRE(expedition.mapping->done());
    const auto result = expedition.result();
    // Of 60 seeds the slowest takes 292 s, the worst has precision 0.72 and recall 0.95 within 6 cm, as a
    // robot went off its way. None of these is so bad.
    CHECK(seconds < 300);
    CHECK(expedition.lost == 0);
    CHECK(result.explored > 0.95);
    CHECK(result.precision > 0.8);
    CHECK(result.recall > 0.9);
    precision += result.precision / seeds;
    recall += result.recall / seeds;
    explored += result.explored / seeds;
    const auto strict = expedition.result(0.04F);
    precision_4_cm += strict.precision / seeds;
    recall_4_cm += strict.recall / seeds;
  }
  // Over 60 seeds 0.950, 0.996 and 0.993, and so within 0.02 over twelve.
  CHECK(precision > 0.93);
  CHECK(recall > 0.97);
  CHECK(explored > 0.97);
  // Within 4 cm the mean of twelve seeds is 0.85 to 0.90 and 0.98 to 0.99, whichever twelve. Were the
  // handshake silent about the sensors' faces, it would be 0.73 to 0.76 and 0.91 to 0.93; with wheels that
  // were not calibrated 0.77 to 0.80 and 0.99. Within 6 cm neither would show.
  CHECK(precision_4_cm > 0.83);
  CHECK(recall_4_cm > 0.955);
}

TEST_CASE("mapper mapping: a robot that leaves the radio's range is called back before its link is gone") {
  // The server does not know the range: the falling share of whole sentences tells it. [T2 §15.3]
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    const auto model = corridor();
    Expedition expedition{model, seed, options_for(model, false)};
    (void)expedition.explore(20min);
    CHECK(expedition.mapping->done());
    CHECK(expedition.lost == 0);
    CHECK(expedition.mapping->explorer().counters().calls >= 1);
    CHECK(expedition.worst < 700);
    // Packets get lost from 2 m on; at 4 m all are.
    CHECK(expedition.farthest_m > 2.0);
    CHECK(expedition.farthest_m < 3.6);
    // Home again, where the link is well.
    CHECK(expedition.server.fleet().call_back(0) == cognitive::Advice::stay);
  }
}

TEST_CASE("mapper mapping: without a call back the same robot drives on until its link is gone") {
  const auto model = corridor();
  auto options = options_for(model, false);
  options.bad_below = 0;
  Expedition expedition{model, 1, options};
  (void)expedition.explore(20min);
  CHECK(expedition.lost >= 1);
  CHECK(expedition.farthest_m > 3.5);
}

TEST_CASE("mapper mapping: at any loss it ends, and a place that is not known is not called known") {
  unsigned known = 0, runs = 0, grown = 0;
  for (const double loss : {0.0, 0.2, 0.3, 0.4})
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(ocm::test::explored(2)); ++seed) {
      CAPTURE(loss, seed);
      const auto model = labyrinth();
      Expedition expedition{model, seed, options_for(model, true), loss};
      (void)expedition.explore(30min);
      CHECK(expedition.mapping->done());
      const auto left = expedition.mapping->explorer().left(expedition.mapping->map());
      CAPTURE(left.known(), left.bad_link, left.unseen);
      CHECK((!left.is_known() || expedition.result().explored > 0.9));
      if (loss == 0) CHECK(left.is_known());
      if (!left.is_known()) CHECK(left.bad_link > 0);
      known += left.is_known() ? 1 : 0;
      grown += expedition.mapping->explorer().counters().grown;
      ++runs;
    }
  CHECK(known < runs);  // some were stopped by their links
  CHECK(grown > 0);
}

// The figures of docs/cognitive.md: sim_tests "[.measure-mapping]"
TEST_CASE("mapper mapping: measured", "[.measure-mapping]") {
  constexpr int seeds = 60;  // with 20 the means are off by 0.02
  constexpr std::uint64_t first_seed = 201;
  const auto print = [](const char* what, std::vector<double> figures) {
    std::sort(figures.begin(), figures.end());
    double sum = 0;
    for (const double figure : figures) sum += figure;
    std::printf("%-28s mean %7.3f, least %7.3f, most %7.3f\n", what,
                sum / static_cast<double>(figures.size()), figures.front(), figures.back());
  };
  struct Case {
    std::size_t robots;
    bool steel;
  };
  for (const auto [robots, steel] : {Case{1, true}, Case{2, true}, Case{1, false}, Case{2, false}}) {
    std::vector<double> seconds, precision, recall, explored, precision_4, recall_4;
    for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
      auto model = labyrinth();
      model.starts.resize(robots);
      if (!steel) model.anomalies.clear();
      Expedition expedition{model, seed, options_for(model, true)};
      seconds.push_back(expedition.explore(30min));
      const auto result = expedition.result();
      precision.push_back(result.precision);
      recall.push_back(result.recall);
      explored.push_back(result.explored);
      const auto strict = expedition.result(0.04F);
      precision_4.push_back(strict.precision);
      recall_4.push_back(strict.recall);
    }
    std::printf("labyrinth, %zu robots, %s, %d seeds\n", robots, steel ? "magnetic anomalies" : "no anomaly",
                seeds);
    print("seconds", seconds);
    print("precision", precision);
    print("recall", recall);
    print("precision within 4 cm", precision_4);
    print("recall within 4 cm", recall_4);
    print("explored", explored);
  }
  for (const bool calls : {true, false}) {
    std::vector<double> farthest, worst, lost;
    for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
      const auto model = corridor();
      auto options = options_for(model, false);
      if (!calls) options.bad_below = 0;
      Expedition expedition{model, seed, options};
      (void)expedition.explore(20min);
      farthest.push_back(expedition.farthest_m);
      worst.push_back(expedition.worst / 10.0);
      lost.push_back(expedition.lost);
    }
    std::printf("corridor, %s call back, %d seeds\n", calls ? "with" : "without", seeds);
    print("farthest from central [m]", farthest);
    print("quality at its worst [%]", worst);
    print("links lost", lost);
  }
}

}  // namespace sim_mapper_mapping_test
