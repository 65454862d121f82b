#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>

#include "sim/serve/amiro.hpp"
#include "sim/serve/mappers.hpp"

namespace sim_serve_serve_test {

using namespace ocm;
using sim::Ending;

/// A folder of this test, in which the simulators' sockets and lines are.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "ocm-serve-XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path_ = name;
    ::setenv("XDG_RUNTIME_DIR", name.c_str(), 1);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] std::string operator/(std::string_view name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// Ends a simulation after so many turns of its loop, and keeps what it reports.
struct Watched {
  int turns = 3;
  std::vector<std::string> reports{};
  [[nodiscard]] sim::Shell shell() {
    return {[this] { return turns-- <= 0; }, [this](std::string_view text) { reports.emplace_back(text); }};
  }
};

TEST_CASE("An AMiRo on a virtual bus says where it is, and at its end what each board received") {
  const Folder folder;
  Watched watched;
  const Ending ending = sim::serve_amiro(folder / "bus", {}, watched.shell());
  CHECK(ending.well());
  REQUIRE(watched.reports.size() == 5);
  CHECK(watched.reports[0].starts_with("simulated AMiRo on --bus sim:"));
  CHECK(watched.reports[1] == "di_wheel_drive    nothing came");
  CHECK(watched.reports[4].starts_with("bus               0 frames, 0 clients"));
}

TEST_CASE("A board that does not exist is the options' fault") {
  const Folder folder;
  Watched watched;
  sim::AmiroOptions options;
  options.without = {"di_wheel_drive", "flux_capacitor"};
  const Ending ending = sim::serve_amiro(folder / "bus", options, watched.shell());
  CHECK(ending.misuse);
  REQUIRE(ending.failures.size() == 1);
  CHECK(ending.failures[0].what == "sim: no board 'flux_capacitor'");
  CHECK(watched.reports.empty());
}

TEST_CASE("A second AMiRo on the same bus fails, and the options are not to blame") {
  const Folder folder;
  const std::string bus = (folder / "bus");
  Watched inner;
  Ending second;
  Watched watched;
  sim::Shell shell = watched.shell();
  shell.stop = [&] {
    second = sim::serve_amiro(bus, {}, inner.shell());
    return true;
  };
  CHECK(sim::serve_amiro(bus, {}, shell).well());
  CHECK_FALSE(second.well());
  CHECK_FALSE(second.misuse);
}

TEST_CASE("Mappers behind a central, or each on a line, report what each of them did") {
  const Folder folder;
  for (const bool lines : {false, true}) {
    CAPTURE(lines);
    Watched watched;
    sim::MapperOptions options;
    options.robots = 2;
    options.lines = lines;
    const Ending ending = sim::serve_mappers(options, watched.shell());
    for (const auto& failure : ending.failures) UNSCOPED_INFO(failure.what);
    CHECK(ending.well());
    REQUIRE_FALSE(watched.reports.empty());
    CHECK(watched.reports[0].starts_with("simulated 2 mappers in 'square', "));
    CHECK(watched.reports.size() == (lines ? 3 : 6));
  }
}

TEST_CASE("Whatever is simulated can be watched at each turn") {
  const Folder folder;
  for (const std::string_view what : {"AMiRo", "central", "lines"}) {
    CAPTURE(what);
    Watched watched;
    sim::Shell shell = watched.shell();
    std::size_t looks = 0, robots = 0;
    shell.watch = [&](const std::function<sim::SeenWorld()>& look) {
      ++looks;
      robots = look().robots.size();
    };
    if (what == "AMiRo") {
      CHECK(sim::serve_amiro(folder / "bus", {}, shell).well());
    } else {
      sim::MapperOptions options;
      options.robots = 3;
      options.lines = what == "lines";
      CHECK(sim::serve_mappers(options, shell).well());
    }
    CHECK(looks == 3);
    CHECK(robots == (what == "AMiRo" ? 1 : 3));
  }
}

TEST_CASE("A world that cannot be had is said with all that is wrong with it") {
  const Folder folder;
  Watched watched;
  sim::MapperOptions options;
  SECTION("no such world") {
    options.world = "atlantis";
    const Ending ending = sim::serve_mappers(options, watched.shell());
    REQUIRE(ending.failures.size() == 1);
    CHECK(ending.failures[0].what == "sim: there is no world 'atlantis'");
    CHECK(ending.failures[0].remedy == "give a file, or one of those built in: labyrinth, range, square");
  }
  SECTION("more robots than there is room for") {
    options.robots = 100'000;
    const Ending ending = sim::serve_mappers(options, watched.shell());
    REQUIRE(ending.failures.size() == 1);
    CHECK(ending.failures[0].what == "sim: no room for 100000 robots in 'square'");
    CHECK_FALSE(ending.misuse);
  }
  CHECK(watched.reports.empty());
}

}  // namespace sim_serve_serve_test
