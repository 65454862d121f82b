// How long robots behind a central are waited for where a program ends that has sent them.
#include <csignal>
#include <string>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/fleet/line_end.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/world.hpp"
#include "tests/tool/fleet/played_line.hpp"

namespace tool_clock_halt_test {

using namespace ocm;
using namespace ocm::test;

/// Robots that never say that they stand: A heard of its stop once, B 40 times.
struct Bench {
  World world{1};
  PlayedLine line;
  int exchanged = 0;

  Bench() {
    put(3, "A", 1);
    put(5, "B", 40);
    line.next = [this] {
      ++exchanged;
      world.pass(50ms);
    };
  }
  void put(unsigned index, const std::string& name, unsigned times_said) {
    auto& robot = line.add(index, name);
    robot.linked = true;
    robot.progress = mapper::server::Progress::stopping;
    robot.times_said = times_said;
  }
  /// What is said; it has not stopped all of them.
  std::string said() {
    Captured err{STDERR_FILENO};
    CHECK_FALSE(cli::fleet::halt(line, "goto", {3, 5}, [](unsigned) { return true; }));
    return err.text();
  }
};

std::string may_drive(const char* name, const char* times) {
  return fmt::format(
      "goto: {} may still drive: nothing shows that it has heard the stop, which was said {}; its leg ends "
      "after 60 cm\n",
      name, times);
}

TEST_CASE("halt: robots have 20 seconds to say that they stand, and those that do not are named") {
  Bench bench;
  CHECK(bench.said() == may_drive("A", "1 time") + may_drive("B", "40 times"));
  CHECK(bench.line.take_told() == "go 3 0 0\ngo 5 0 0\n");
  CHECK(bench.exchanged == 400);
}

TEST_CASE("halt: a signal ends it, and who stands by then is not named") {
  Bench bench;
  bench.world.interrupt(World::start + 1975ms, SIGINT);
  bench.world.beside = [&bench] {
    if (bench.exchanged == 10) bench.line.robots[3].standing = true;
  };
  CHECK(bench.said() == may_drive("B", "40 times"));
  CHECK(bench.exchanged == 40);
}

}  // namespace tool_clock_halt_test
