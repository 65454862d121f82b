// A map that another program draws: which files are written of it, and what is said at the end.
#include "cli/fleet/map_view.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/fleet/played_owner.hpp"
#include "unit/host/host_testing.hpp"

namespace fleet_map_view_test {

using namespace std::chrono_literals;
using namespace ocm;
using namespace ocm::test;
using cli::fleet::MapOptions;

class Bench {
 public:
  int code = 0;
  std::string out, err;

  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }
  /// Empty where there is none.
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream{file(name), std::ios::binary}.rdbuf();
    return text.str();
  }
  /// Until the other program has ended, which it does when it has given these texts, or for `duration`.
  void views(const std::vector<std::string>& files, const std::vector<std::string>& texts, bool json = false,
             std::optional<base::Duration> duration = {}) {
    std::vector<std::string> answers{"ok\nmap", "ok\nidle\n"};
    for (const std::string& text : texts) answers.push_back(fmt::format("ok\n{}\n{}", text.size(), text));
    const PlayedOwner owner{answers};
    MapOptions options;
    for (const std::string& name : files) options.files.push_back(file(name));
    options.json = json;
    options.duration = duration;
    Captured said{STDOUT_FILENO}, remarked{STDERR_FILENO};
    auto line = PlayedOwner::joined("map");
    code = cli::fleet::view_map(options, line);
    err = remarked.text();
    out = said.text();
  }

 private:
  TemporaryDirectory folder_;
};

const std::string image = "P5\n1 1\n255\nx";
const std::string about = "image: map.pgm\nresolution: 0.040\n";

TEST_CASE("map view: a PGM has its YAML beside it, which names it; at the other's end what is there stays") {
  Bench bench;
  bench.views({"a.pgm", "b.pgm"}, {image, about});
  CHECK(bench.code == cli::exit_success);
  CHECK(bench.content("a.pgm") == image);
  CHECK(bench.content("a.yaml") == "image: a.pgm\nresolution: 0.040\n");
  CHECK_FALSE(std::filesystem::exists(bench.file("b.pgm")));
  const std::string who = fmt::format("the owner (process {})", ::getpid());
  CHECK(bench.err ==
        fmt::format("map: draws what {} draws, each 2 s; Ctrl-C ends that\nmap: {} has ended\n", who, who));
  CHECK(bench.out.starts_with(fmt::format("what {} drew in ", who)));
  CHECK(bench.out.ends_with(" s, drawn 1 time\n"));
  bench.views({"c.pgm", "d.pgm"}, {image, about}, true);
  CHECK(bench.code == cli::exit_success);
  CHECK(bench.out.starts_with(fmt::format("{{\"watched\":\"{}\",\"seconds\":", who)));
  CHECK(bench.out.ends_with(",\"drawn\":1}\n"));
  bench.views({".pgm", "d.pgm"}, {image, about});  // a name that is only an ending is one, too
  CHECK(bench.code == cli::exit_success);
  CHECK(bench.content(".pgm") == image);
  CHECK(bench.content(".pgm.yaml") == "image: .pgm\nresolution: 0.040\n");
}

TEST_CASE("map view: a map of which nothing was drawn yet is none, and a failure where none comes") {
  Bench bench;
  bench.views({"a.pgm", "b.pgm"}, {""});
  CHECK(bench.code == cli::exit_failure);
  CHECK(bench.out.ends_with(" s, drawn 0 times\n"));
  CHECK_FALSE(std::filesystem::exists(bench.file("a.pgm")));
  bench.views({"a.pgm", "b.pgm", "c.pgm"}, {"", image, about});
  CHECK(bench.code == cli::exit_success);
  CHECK(bench.content("b.pgm") == image);
}

TEST_CASE("map view: it draws again after two seconds, if its time is not over by then") {
  Bench bench;
  bench.views({"a.pgm"}, {image, about, image, about}, false, 1500ms);
  CHECK(bench.code == cli::exit_success);
  CHECK(bench.content("a.pgm") == image);
  CHECK(bench.out.ends_with(" s, drawn 1 time\n"));
  CHECK(bench.err == fmt::format("map: draws what the owner (process {}) draws, each 2 s; Ctrl-C ends that\n",
                                 ::getpid()));
}

TEST_CASE("map view: a file that cannot be written is said, and a failure; the others are written") {
  Bench bench;
  bench.views({"none/a.pgm", "b.pgm", "c.pgm"}, {image, image, about});
  CHECK(bench.code == cli::exit_failure);
  CHECK(bench.content("b.pgm") == image);
  CHECK_THAT(bench.err, Catch::Contains("\nmap: " + bench.file("none/a.pgm") + ": "));
  CHECK(bench.out.ends_with(" s, drawn 1 time\n"));
}

TEST_CASE(
    "map view: a picture is what gnuplot draws of the other's words; where it cannot, that is a failure") {
  Bench bench;
  const TemporaryDirectory programs;
  const Environment path{"PATH", programs.path().c_str()};
  bench.views({"a.svg", "b.svg"}, {"plot x\n"});
  CHECK(bench.code == cli::exit_failure);
  CHECK_FALSE(std::filesystem::exists(bench.file("a.svg")));
  CHECK_THAT(bench.err,
             Catch::Contains("\nmap: " + bench.file("a.svg") +
                             ": gnuplot is missing, which draws the pictures; install it: sudo apt "
                             "install gnuplot-nox\n"));
  CHECK(bench.out.ends_with(" s, drawn 0 times\n"));
  // Played: it draws the first line that it is given.
  const std::string gnuplot = programs.file("gnuplot");
  std::ofstream{gnuplot} << "#!/bin/sh\nread -r line\necho \"<$line>\"\n";
  std::filesystem::permissions(gnuplot, std::filesystem::perms::owner_all);
  bench.views({"none/a.svg", "b.svg", "c.svg"}, {"plot x\n", "plot y\n"});
  CHECK(bench.code == cli::exit_failure);
  CHECK_THAT(bench.err, Catch::Contains("\nmap: " + bench.file("none/a.svg") + ": "));
  CHECK(bench.content("b.svg") == "<plot y>\n");
  CHECK(bench.out.ends_with(" s, drawn 1 time\n"));
}

TEST_CASE("map view: a program that draws no map is left at once") {
  const PlayedOwner owner{{"ok\nrobots", "ok\nidle\n", "no\nrobots draws no map\nend it, and start a map"}};
  MapOptions options;
  options.files = {"a.pgm"};
  const auto left = leaving([&] {
    auto line = PlayedOwner::joined("map");
    static_cast<void>(cli::fleet::view_map(options, line));
  });
  CHECK(left.code == cli::exit_failure);
  CHECK_THAT(left.text,
             Catch::EndsWith("\namiroctl: map: robots draws no map\n          end it, and start a map\n"));
}

}  // namespace fleet_map_view_test
