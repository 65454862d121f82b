/// What each of a mapper's sensors has a part in: the square of thesis 2, table 13.1, by the whole
/// application in virtual time, and what five estimators make of the very same drives. docs/motion.md tells
/// what is seen.
///
///     square [SCRIPT]    a table; SCRIPT gets a script for gnuplot with the errors over time
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/sim/mapper_square.hpp"

using namespace ocm;
using namespace ocm::square;
using namespace std::chrono_literals;

namespace {

constexpr std::uint64_t seeds = 100;
constexpr base::Duration stand = 10s;
using Row = std::vector<double>;  // a number a drive

struct Place {
  const char* name;
  WorldModel world;
};

/// Errors of one estimator in each second since the start, of all drives.
struct Curve {
  std::vector<Row> position_m;
  std::vector<Row> heading_rad;
  void add(std::size_t second, const Pose& error) {
    if (position_m.size() <= second) {
      position_m.resize(second + 1);
      heading_rad.resize(second + 1);
    }
    position_m[second].push_back(length(error.position()));
    heading_rad[second].push_back(error.heading_rad);
  }
};
using Curves = std::array<Curve, variant_count>;

void follow(const Drive& drive, Curves& curves) {
  const auto all = variants(drive.model());
  for (std::size_t i = 0; i < variant_count; ++i) {
    base::Time start = base::never;
    std::size_t second = 0;
    replay(drive.steps(), all[i].model, [&](const Step& step, const motion::Pose& pose) {
      if (start != base::never && step.time >= start + second * 1s)
        curves[i].add(second++, error(pose, relative(step.truth, drive.start())));
      if (step.zeroed_after) start = step.time + 1ns;
    });
  }
}

double of(const std::vector<Outcome>& outcomes, std::size_t which, double Pose::*what, double part) {
  return quantile(outcomes, part, [&](const Outcome& one) { return one.error[which].*what; });
}
double position_of(const std::vector<Outcome>& outcomes, std::size_t which, double part) {
  return quantile(outcomes, part, [&](const Outcome& one) { return length(one.error[which].position()); });
}

void table(const std::vector<Outcome>& outcomes) {
  std::printf("  %-38s %19s %8s %8s %21s\n", "", "position, cm", "x, cm", "y, cm", "heading, degrees");
  std::printf("  %-38s %9s %9s %8s %8s %10s %10s\n", "", "median", "90 %", "median", "median", "median",
              "90 %");
  const auto all = variants(mapper::app::avr_robot);
  for (std::size_t i = 0; i < variant_count; ++i)
    std::printf("  %-38s %9.1f %9.1f %8.1f %8.1f %10.2f %10.2f\n", all[i].name,
                100 * position_of(outcomes, i, 0.5), 100 * position_of(outcomes, i, 0.9),
                100 * of(outcomes, i, &Pose::x_m, 0.5), 100 * of(outcomes, i, &Pose::y_m, 0.5),
                of(outcomes, i, &Pose::heading_rad, 0.5) / degree,
                of(outcomes, i, &Pose::heading_rad, 0.9) / degree);
}

/// A block of data for gnuplot: time, then for each estimator the median of what `rows` has of it.
template <class Rows>
std::string block(const std::string& name, const Curves& curves, double unit, Rows rows) {
  std::string text = "$" + name + " << EOD\n";
  for (std::size_t second = 0; second < curves[0].position_m.size(); ++second) {
    if (curves[0].position_m[second].size() < seeds) break;  // the first drive has ended
    text += std::to_string(second);
    for (const Curve& curve : curves)
      text.append(" ").append(std::to_string(quantile(rows(curve)[second], 0.5) / unit));
    text += "\n";
  }
  return text + "EOD\n";
}

std::string panel(const std::string& data, const char* title, const char* unit, const char* range) {
  constexpr std::array colours{"#999999", "#E69F00", "#D55E00", "#0072B2", "#009E73"};
  std::string text =
      std::string{"set title '"} + title + "'\nset ylabel '" + unit + "'\nset yrange " + range + "\nplot ";
  const auto all = variants(mapper::app::avr_robot);
  for (std::size_t i = 0; i < variant_count; ++i)
    text.append(i == 0 ? "" : ", ")
        .append("$" + data + " using 1:" + std::to_string(i + 2) + " with lines lw 2 lc rgb '")
        .append(colours[i])
        .append("' title '")
        .append(all[i].name)
        .append("'");
  return text + "\nset key off\n";  // the first panel's serves all
}

}  // namespace

int main(int argc, char** argv) {
  const std::array<Place, 3> places{{{"no steel in the floor", open_room()},
                                     {"steel on the way", steel_on_the_way()},
                                     {"steel on the way and at the start", steel_at_the_start()}}};
  std::string data;
  std::string panels;
  std::printf(
      "%d drives each, %d s of standing after each command; the thesis's robot: x 14.8, y 6.2 cm, 6.9 "
      "degrees\n",
      static_cast<int>(seeds), static_cast<int>(stand / 1s));
  for (std::size_t n = 0; n < places.size(); ++n) {
    std::vector<Outcome> outcomes;
    Curves curves;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      Drive drive{places[n].world, seed, mapper::app::avr_robot};
      drive.square(stand);
      outcomes.push_back(outcome_of(drive));
      follow(drive, curves);
    }
    std::printf("%s\n", places[n].name);
    table(outcomes);
    if (n == 2) continue;  // no picture of it
    const std::string number = std::to_string(n);
    data += block("heading" + number, curves, degree, [](const Curve& curve) { return curve.heading_rad; });
    data += block("position" + number, curves, 0.01, [](const Curve& curve) { return curve.position_m; });
    panels +=
        panel("heading" + number, n == 0 ? "heading, no steel in the floor" : "heading, steel on the way",
              "degrees", "[0.02:60]");
    panels +=
        panel("position" + number, n == 0 ? "position, no steel in the floor" : "position, steel on the way",
              "cm", "[0.1:60]");
  }

  std::printf("the application's own estimate\n");
  const auto own = [](const char* name, base::Duration after_each, std::uint64_t first, auto drive_of) {
    std::vector<Outcome> outcomes;
    Row took;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
      const auto drive = drive_of(seed);
      const base::Time start = drive->now();
      drive->square(after_each);
      took.push_back(std::chrono::duration<double>(drive->now() - start - legs.size() * after_each).count());
      Outcome outcome;
      outcome.own =
          error(drive->steps().back().estimate, relative(drive->steps().back().truth, drive->start()));
      outcomes.push_back(outcome);
    }
    const auto at = [&](double Pose::*what, double part) {
      return quantile(outcomes, part, [&](const Outcome& one) { return one.own.*what; });
    };
    std::printf(
        "  %-38s x %4.1f cm, y %4.1f cm, %5.2f degrees; 90 %%: %4.1f, %4.1f, %5.2f; %.0f s of driving\n",
        name, 100 * at(&Pose::x_m, 0.5), 100 * at(&Pose::y_m, 0.5), at(&Pose::heading_rad, 0.5) / degree,
        100 * at(&Pose::x_m, 0.9), 100 * at(&Pose::y_m, 0.9), at(&Pose::heading_rad, 0.9) / degree,
        quantile(took, 0.5));
  };
  const auto avr = [](std::uint64_t seed) {
    return std::make_unique<Drive>(open_room(), seed, mapper::app::avr_robot);
  };
  for (const auto& [name, rest] : {std::pair{"no rest", 0s},
                                   {"rests of 2 s", 2s},
                                   {"rests of 5 s", 5s},
                                   {"rests of 10 s", 10s},
                                   {"rests of 20 s", 20s},
                                   {"rests of 60 s", 60s}})
    own(name, rest, 1, avr);
  own("seeds 1001 to 1100", stand, 1001, avr);
  own("seeds 2001 to 2100", stand, 2001, avr);
  own("its compass calibrated by itself", stand, 1, [](std::uint64_t seed) {
    const auto offset = offset_by_turning(open_room(), seed, mapper::app::avr_robot);
    return std::make_unique<Drive>(open_room(), seed,
                                   mapper::app::calibrated(mapper::app::avr_robot, *offset),
                                   Drive::Compass::as_in_model);
  });
  own("Arduino robot", stand, 1, [](std::uint64_t seed) {
    WorldModel room = open_room();
    room.starts = {{"Arduino", RobotKind::arduino, {}}};
    return std::make_unique<Drive>(room, seed, mapper::app::arduino_robot);
  });

  std::printf("where the robot really is, from the ideal square, when it says idle\n");
  std::vector<Row> off_m(legs.size()), off_rad(legs.size());
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Drive drive{open_room(), seed, mapper::app::avr_robot};
    drive.square(stand);
    for (std::size_t leg = 0; leg < legs.size(); ++leg) {
      const Pose off = relative(drive.idle()[leg], ideal_after(leg + 1));
      off_m[leg].push_back(length(off.position()));
      off_rad[leg].push_back(off.heading_rad);
    }
  }
  for (std::size_t leg = 0; leg < legs.size(); ++leg)
    std::printf("  command %zu: %4.1f cm, %4.1f degrees; 90 %%: %4.1f cm, %4.1f degrees\n", leg + 1,
                100 * quantile(off_m[leg], 0.5), quantile(off_rad[leg], 0.5) / degree,
                100 * quantile(off_m[leg], 0.9), quantile(off_rad[leg], 0.9) / degree);

  if (argc < 2) return EXIT_SUCCESS;
  std::ofstream script{argv[1]};
  script << "set terminal svg size 1200,850 font 'DejaVu Sans,12' background '#ffffff'\n"
            "set encoding utf8\nset border 3 lc rgb '#888888'\nset tics nomirror out\n"
            "set grid lc rgb '#dddddd'\nset logscale y\nset xlabel 'seconds since the start'\n"
            "set key noenhanced at screen 0.5,0.005 center bottom vertical maxrows 2 samplen 2 font ',10'\n"
         << data
         << "set multiplot layout 2,2 title 'Median error of 100 drives of the square' "
            "margins 0.07,0.98,0.13,0.90 spacing 0.09,0.14\n"
         << panels << "unset multiplot\n";
  script.close();
  if (script) return EXIT_SUCCESS;
  std::fprintf(stderr, "square: cannot write %s\n", argv[1]);
  return EXIT_FAILURE;
}
