/// What a fleet of mappers costs in virtual time: world, applications, dongles, radio and central, with
/// every robot linked, confirmed, driving and sending. Processor time, so that other load does not count.
#include "sim/mapper/fleet.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <utility>

using namespace ocm;
using namespace std::chrono_literals;
namespace plant = ocm::sim::mapper;

namespace {

double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// A room that all have room in.
plant::WorldModel room(std::size_t robots) {
  const double half = 1 + std::sqrt(static_cast<double>(robots));
  plant::WorldModel model;
  const sim::Vector corners[] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  for (std::size_t i = 0; i < 4; ++i) model.walls.push_back({corners[i], corners[(i + 1) % 4]});
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(robots))));
  for (std::size_t i = 0; i < robots; ++i)
    model.starts.push_back({"R" + std::to_string(i),
                            i % 2 == 0 ? plant::RobotKind::avr : plant::RobotKind::arduino,
                            {1.5 * (static_cast<double>(i % side) - static_cast<double>(side - 1) / 2),
                             1.5 * (static_cast<double>(i / side) - static_cast<double>(side - 1) / 2), 0}});
  model.central.range_m = 100;
  return model;
}

struct Run {
  double processor_s_a_second;
  double updates_a_second;
};
Run run(std::size_t robots, int seconds) {
  plant::World world{room(robots), {.seed = 1}};
  plant::Fleet fleet{world, plant::Fleet::options_for(world, 1)};
  const auto later = [&](base::Duration time) {
    fleet.advance_to(fleet.now() + time);
    return fleet.read();
  };
  const auto each = [&](const char* line) {
    for (std::size_t i = 0; i < robots; ++i) fleet.write("*switch " + std::to_string(i) + "\n" + line);
  };
  fleet.write("start\n");
  (void)later(1s);
  fleet.write("stop\n");
  for (std::size_t i = 0; i < robots; ++i) {
    fleet.write("*conn " + std::to_string(i) + "\n");
    (void)later(200ms);
  }
  (void)later(5s);
  each("{S,CON}\n");
  (void)later(1s);
  const double begin = processor_s();
  std::size_t updates = 0;
  for (int second = 0; second < seconds; ++second) {
    if (second % 10 == 0) each("{U,90,40}\n");
    const std::string said = later(1s);
    for (std::size_t at = 0; (at = said.find("{U,", at)) != std::string::npos; ++at) ++updates;
  }
  return {(processor_s() - begin) / seconds, static_cast<double>(updates) / seconds};
}

}  // namespace

int main() {
  std::printf("%7s %26s %14s %18s\n", "robots", "processor time a second", "updates/s", "times real time");
  for (const std::size_t robots : {1U, 2U, 10U, 100U}) {
    const Run done = run(robots, robots == 100 ? 60 : 300);
    std::printf("%7zu %23.2f ms %14.0f %18.0f\n", robots, 1e3 * done.processor_s_a_second,
                done.updates_a_second, 1 / done.processor_s_a_second);
    if (done.updates_a_second < 4 * static_cast<double>(robots)) return EXIT_FAILURE;  // a robot is silent
  }
}
