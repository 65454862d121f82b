#include "cli/fleet/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>

#include <fmt/format.h>

#include "ocm/log/csv.hpp"

#include "cli/plot/gnuplot.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/output_file.hpp"

namespace ocm::cli::fleet {
namespace {

using cognitive::Box;
using cognitive::Cell;
using cognitive::CellState;
using cognitive::Map;

/// What is known, and a cell around it; a single cell when nothing is.
Box known(const Map& map) {
  Box box;
  for (int y = map.box().low.y; y <= map.box().high.y; ++y)
    for (int x = map.box().low.x; x <= map.box().high.x; ++x)
      if (map.state({x, y}) != CellState::unknown) box = box.with({x, y});
  return box.empty() ? Box{{0, 0}, {0, 0}} : box.widened(1);
}

class Script {
 public:
  Script(const Map& map, const MapPicture& picture) : map_(map), picture_(picture), box_(known(map)) {}

  std::string text(plot::Kind kind) {
    frame();
    size();
    terminal(kind);
    cells();
    lines();
    plot(kind);
    return std::move(out_);
  }

 private:
  template <class... Values>
  void add(fmt::format_string<Values...> text, Values&&... values) {
    out_ += fmt::format(text, std::forward<Values>(values)...);
  }

  /// Metres: all that is drawn.
  void frame() {
    const float side = map_.raster().resolution_m();
    low_ = {static_cast<float>(box_.low.x) * side, static_cast<float>(box_.low.y) * side};
    high_ = {static_cast<float>(box_.high.x + 1) * side, static_cast<float>(box_.high.y + 1) * side};
    const auto reach = [this](motion::Point p) {
      low_ = {std::min(low_.x_m, p.x_m), std::min(low_.y_m, p.y_m)};
      high_ = {std::max(high_.x_m, p.x_m), std::max(high_.y_m, p.y_m)};
    };
    for (const cognitive::Wall& wall : picture_.walls) reach(wall.from), reach(wall.to);
    for (const DrawnRobot& robot : picture_.robots) {
      for (const motion::Point p : robot.path) reach(p);
      for (const motion::Point p : robot.true_path) reach(p);
    }
    const float border = 0.05F * std::max(high_.x_m - low_.x_m, high_.y_m - low_.y_m);
    low_ = {low_.x_m - border, low_.y_m - border};
    high_ = {high_.x_m + border, high_.y_m + border};
  }
  /// The longer side has 800 pixels; a metre is as long in both directions.
  void size() {
    constexpr double longest = 800;
    const double across = high_.x_m - low_.x_m, up = high_.y_m - low_.y_m;
    const double scale = longest / std::max(across, up);
    width_ = static_cast<unsigned>(std::max(320.0, std::ceil(across * scale)) + left + right);
    height_ = static_cast<unsigned>(std::max(160.0, std::ceil(up * scale)) + top + bottom);
  }
  void terminal(plot::Kind kind) {
    out_ += plot::terminal(kind, width_, height_);
    add("set border 3 lc rgb '#888888' lw 1\n"
        "set tics nomirror out scale 0.6 textcolor rgb '#444444'\n"
        "set key noenhanced reverse Left samplen 2 horizontal at screen {:.5f},{:.5f} left top textcolor rgb "
        "'#222222'\n"
        "set label 1 {} at screen {:.5f},{:.5f} left noenhanced font ':Bold,15'\n"
        "set label 2 {} at screen {:.5f},{:.5f} left noenhanced textcolor rgb '#666666'\n",
        x(left), y(62), plot::quoted(picture_.title), x(left), y(22), plot::quoted(picture_.subtitle),
        x(left), y(44));
    add("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
        "set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n",
        x(left), x(width_ - right), y(top), y(height_ - bottom));
    add("set size ratio -1\nset xrange [{:.4f}:{:.4f}]\nset yrange [{:.4f}:{:.4f}]\n", low_.x_m, high_.x_m,
        low_.y_m, high_.y_m);
    add("set xlabel 'x [m]'\nset ylabel 'y [m]'\n"
        "set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb '#d9dde3' fillstyle solid "
        "noborder\n"  // beyond the cells nothing is known either
        "set palette defined (0 '#ffffff', 0.5 '#d9dde3', 1 '#1a1a1a')\nset cbrange [0:1]\nunset colorbox\n");
  }
  /// Free, unknown, occupied.
  void cells() {
    add("$map << EOD\n");
    for (int row = box_.low.y; row <= box_.high.y; ++row) {
      for (int column = box_.low.x; column <= box_.high.x; ++column) {
        const CellState state = map_.state({column, row});
        out_ += column == box_.low.x ? "" : " ";
        out_ += state == CellState::free ? "0" : state == CellState::occupied ? "1" : "0.5";
      }
      out_ += '\n';
    }
    add("EOD\n");
  }
  void points(std::string_view name, std::size_t i, const std::vector<motion::Point>& points) {
    add("${}{} << EOD\n", name, i);
    for (const motion::Point p : points) add("{:.4f} {:.4f}\n", p.x_m, p.y_m);
    add("EOD\n");
  }
  void lines() {
    for (std::size_t i = 0; i < picture_.robots.size(); ++i) {
      if (!picture_.robots[i].path.empty()) points("path", i, picture_.robots[i].path);
      if (!picture_.robots[i].true_path.empty()) points("truth", i, picture_.robots[i].true_path);
    }
    if (picture_.walls.empty()) return;
    add("$walls << EOD\n");
    for (const cognitive::Wall& wall : picture_.walls)
      add("{:.4f} {:.4f}\n{:.4f} {:.4f}\n\n", wall.from.x_m, wall.from.y_m, wall.to.x_m, wall.to.y_m);
    add("EOD\n");
  }
  void plot(plot::Kind kind) {
    const double side = map_.raster().resolution_m();
    add("plot $map matrix using (($1+{:.1f})*{:.6g}):(($2+{:.1f})*{:.6g}):3 with image{} notitle",
        box_.low.x + 0.5, side, box_.low.y + 0.5, side,
        kind == plot::Kind::svg ? " pixels" : "");  // rectangles: no picture within the picture
    if (!picture_.walls.empty())
      add(", \\\n  $walls using 1:2 with lines lc rgb '#E3120B' lw 1.2 title 'true walls'");
    for (std::size_t i = 0; i < picture_.robots.size(); ++i) {
      const DrawnRobot& robot = picture_.robots[i];
      const char* const colour = plot::colours[i % plot::colours.size()];
      if (!robot.true_path.empty())
        add(", \\\n  $truth{} using 1:2 with lines lc rgb '{}' lw 1 dt 3 title {}", i, colour,
            plot::quoted(robot.name + ", truth"));
      if (robot.path.empty()) continue;
      add(", \\\n  $path{} using 1:2 with lines lc rgb '{}' lw 1.8 title {}", i, colour,
          plot::quoted(robot.name));
      add(", \\\n  $path{} using 1:2 every ::0::0 with points lc rgb '{}' pt 6 ps 1.2 lw 1.8 notitle", i,
          colour);
      add(", \\\n  $path{} using 1:2 every ::{}::{} with points lc rgb '{}' pt 7 ps 1.2 notitle", i,
          robot.path.size() - 1, robot.path.size() - 1, colour);
    }
    add("\n");
  }

  /// Pixels.
  static constexpr double top = 92, bottom = 60, left = 72, right = 24;
  [[nodiscard]] double x(double pixels) const { return pixels / width_; }
  [[nodiscard]] double y(double pixels) const { return 1 - pixels / height_; }

  const Map& map_;
  const MapPicture& picture_;
  Box box_;
  motion::Point low_{};
  motion::Point high_{};
  unsigned width_ = 0;
  unsigned height_ = 0;
  std::string out_;
};

transport::Failure not_drawn(const std::string& file, const transport::Failure& why) {
  return {fmt::format("{}: {}", file, why.what),
          why.remedy + (why.remedy.empty() ? "" : "; or ") + "write a .pgm"};
}

}  // namespace

bool is_map_file(std::string_view name) {
  return name.ends_with(".pgm") || plot::kind_of_file(name);
}

std::string to_script(const Map& map, const MapPicture& picture, plot::Kind kind) {
  return Script{map, picture}.text(kind);
}

std::string to_pgm(const Map& map) {
  const Box box = known(map);
  std::string out = fmt::format("P5\n# {:.3f} m a pixel\n{} {}\n255\n", map.raster().resolution_m(),
                                box.width(), box.height());
  constexpr char occupied = 0, free = static_cast<char>(254), unknown = static_cast<char>(205);
  for (int y = box.high.y; y >= box.low.y; --y)
    for (int x = box.low.x; x <= box.high.x; ++x) {
      const CellState state = map.state({x, y});
      out += state == CellState::occupied ? occupied : state == CellState::free ? free : unknown;
    }
  return out;
}

std::string to_yaml(const Map& map, std::string_view image) {
  const Box box = known(map);
  const double side = map.raster().resolution_m();
  return fmt::format(
      "image: {}\nresolution: {:.3f}\norigin: [{:.3f}, {:.3f}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.196\n",
      image, side, box.low.x * side, box.low.y * side);
}

std::string to_grid(const Map& map) {
  const Box box = known(map);
  const double side = map.raster().resolution_m();
  std::vector<std::uint8_t> cells;
  cells.reserve(static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height()));
  for (int y = box.low.y; y <= box.high.y; ++y)
    for (int x = box.low.x; x <= box.high.x; ++x)
      cells.push_back(static_cast<std::uint8_t>(map.state({x, y})));
  std::string text((cells.size() + 2) / 3 * 4, '\0');
  log::csv::to_base64(text.data(), cells);
  constexpr int uint8 = 1;  // of Foxglove's numeric types
  return Json{{"frame_id", "map"},
              {"pose",
               {{"position", {{"x", box.low.x * side}, {"y", box.low.y * side}, {"z", 0}}},
                {"orientation", {{"x", 0}, {"y", 0}, {"z", 0}, {"w", 1}}}}},
              {"column_count", box.width()},
              {"cell_size", {{"x", side}, {"y", side}}},
              {"row_stride", box.width()},
              {"cell_stride", 1},
              {"fields", std::array{Json{{"name", "state"}, {"offset", 0}, {"type", uint8}}}},
              {"data", text}}
      .line();
}

std::string to_form(const Map& map, const MapPicture& picture, std::string_view form) {
  if (form == "grid") return to_grid(map);
  if (form == "pgm") return to_pgm(map);
  if (form == "yaml") return to_yaml(map, "map.pgm");
  return to_script(map, picture, plot::kind_of_file(fmt::format("map.{}", form)).value_or(plot::Kind::svg));
}

std::optional<transport::Failure> write_map(const std::string& file, const Map& map,
                                            const MapPicture& picture) {
  if (file.ends_with(".pgm")) {
    if (auto failure = try_to_write(file, to_pgm(map))) return failure;
    auto yaml = std::filesystem::path{file};
    const std::string image = yaml.filename().string();
    return try_to_write(yaml.replace_extension(".yaml").string(), to_yaml(map, image));
  }
  const auto drawn = plot::draw(to_script(map, picture, plot::kind_of_file(file).value_or(plot::Kind::svg)));
  if (!drawn) return not_drawn(file, drawn.error);
  return try_to_write(file, *drawn);
}

std::optional<transport::Failure> cannot_draw(const std::string& file) {
  if (!plot::kind_of_file(file)) return std::nullopt;
  const auto tried = plot::draw(plot::terminal(plot::Kind::svg, 200, 200) + "plot x\n");
  if (!tried) return not_drawn(file, tried.error);
  return std::nullopt;
}

}  // namespace ocm::cli::fleet
