// A map as each of its forms, word for word.
#include "cli/fleet/picture.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/tool/golden.hpp"

namespace fleet_picture_test {

using namespace ocm;
using namespace ocm::test;
using namespace ocm::cli::fleet;
using cli::plot::Kind;

/// Cells of 10 cm: a robot at 0.25, 0.15 sees a wall ahead and one at its left.
cognitive::Map seen() {
  cognitive::MapOptions options;
  options.resolution_m = 0.1F;
  cognitive::Map map{options};
  for (int i = 0; i < 5; ++i) map.take({{0.25F, 0.15F, 0}, {}}, {0, 0, 0, 0, 42, 32, 0, 0});
  return map;
}

MapPicture drawn() {
  MapPicture picture;
  picture.title = "map by A's robot";
  picture.subtitle = "3 s, 0.42 m² free";
  picture.robots = {{"A", {{0.25F, 0.15F}, {0.5F, 0.25F}, {0.75F, 0.5F}}, {{0.25F, 0.15F}, {0.5F, 0.5F}}},
                    {"not_moved", {}, {}},
                    {"B", {{1.25F, -0.75F}}, {}}};
  picture.walls = {{{-0.5F, -0.5F}, {2.5F, -0.5F}}, {{2.5F, -0.5F}, {2.5F, 1.5F}}};
  return picture;
}

TEST_CASE("picture: each form of a map is as it was") {
  const auto map = seen();
  const auto picture = drawn();
  std::string text;
  for (const char* const form : {"svg", "png", "pdf", "yaml", "grid", "pgm"}) {
    std::string whole = to_form(map, picture, form);
    if (std::string_view{form} == "pgm") {  // what is behind its head are bytes
      const auto pixels = whole.find("255\n") + 4;
      std::string shown;
      for (const char c : whole.substr(pixels)) shown += fmt::format(" {}", static_cast<unsigned char>(c));
      whole = whole.substr(0, pixels) + shown;
    }
    text += fmt::format("--- {}\n{}\n", form, whole);
  }
  // Nothing is known, and nothing was driven.
  text += "--- nothing\n" + to_script(cognitive::Map{}, {}, Kind::svg) + to_yaml(cognitive::Map{}, "a.pgm") +
          to_grid(cognitive::Map{}) + "\n";
  // Higher than wide.
  cognitive::MapOptions options;
  options.resolution_m = 0.1F;
  cognitive::Map high{options};
  high.take({{0.25F, 0.15F, motion::pi / 2}, {}}, {0, 0, 0, 0, 60, 0, 0, 0});
  text +=
      "--- high\n" + to_script(high, {.title = "high", .subtitle = {}, .robots = {}, .walls = {}}, Kind::png);
  is_as_in("tests/tool/fleet/golden/map.txt", text);
}

TEST_CASE("picture: the name of a file says its form") {
  for (const char* const name : {"a.svg", "a.png", "a.pdf", "a.pgm", "b/c.d.pgm"}) CHECK(is_map_file(name));
  for (const char* const name : {"", "a", "pgm", "a.yaml", "a.svg.gz", "a.PGM", "a.pgm "})
    CHECK_FALSE(is_map_file(name));
}

TEST_CASE("picture: a PGM has its YAML beside it, which names it; what cannot be written is said") {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("ocm-picture-{}", ::getpid());
  std::filesystem::create_directories(folder);
  const auto content = [](const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream{file, std::ios::binary}.rdbuf();
    return text.str();
  };
  const auto map = seen();
  CHECK_FALSE(write_map((folder / "a.pgm").string(), map, drawn()));
  CHECK(content(folder / "a.pgm") == to_pgm(map));
  CHECK(content(folder / "a.yaml") == to_yaml(map, "a.pgm"));
  const auto failure = write_map((folder / "none" / "a.pgm").string(), map, drawn());
  REQUIRE(failure);
  CHECK(failure->what.starts_with((folder / "none" / "a.pgm").string() + ": "));
  CHECK_FALSE(cannot_draw("a.pgm"));
  std::filesystem::remove_all(folder);
}

}  // namespace fleet_picture_test
