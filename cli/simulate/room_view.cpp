#include "cli/simulate/room_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "ocm/base/utf8.hpp"

namespace ocm::cli::simulate {
namespace {

using firmware::boards::Colour;
using sim::Vector;
using top::Line;
using top::Picture;
using top::Style;

constexpr std::size_t panel_columns = 25;
constexpr std::size_t least_columns_beside = 64;  ///< of a terminal whose panel is beside the room
constexpr std::size_t panel_lines = 4;            ///< where it is below
constexpr std::size_t least_room = 6;             ///< lines and columns; less shows nothing

std::string cut(std::string_view text, std::size_t width) {
  std::size_t bytes = 0;
  for (std::size_t columns = 0; bytes < text.size() && columns < width; ++columns)
    bytes += std::max<std::size_t>(base::utf8_length(text.substr(bytes)), 1);
  return std::string{text.substr(0, bytes)};
}

std::size_t columns_of(const Line& line) {
  std::size_t columns = 0;
  for (const top::Piece& piece : line) columns += base::columns(piece.text);
  return columns;
}

/// As much of it as has room.
void put(Line& line, std::string_view text, Style style, std::size_t width) {
  const std::size_t used = columns_of(line);
  if (used < width) line.push_back({cut(text, width - used), style});
}

// --- the room ---

/// What is drawn over what: the last is on top.
enum class Layer : std::uint8_t { nothing, line, trail, beam, wall, end, body };

Style style_of(Layer layer) {
  switch (layer) {
    case Layer::line:
    case Layer::trail:
      return Style::dim;
    case Layer::beam:
      return Style::good;
    case Layer::end:
      return Style::warning;
    case Layer::body:
      return Style::bold;
    default:
      return Style::plain;
  }
}

/// Characters with dots in them; a dot is as wide as it is high where a character is twice as high as it is
/// wide.
class Canvas {
 public:
  Canvas(std::size_t columns, std::size_t rows, bool unicode)
      : columns_(columns), rows_(rows), unicode_(unicode), cells_(columns * rows) {}

  [[nodiscard]] std::size_t columns() const noexcept { return columns_; }
  [[nodiscard]] std::size_t rows() const noexcept { return rows_; }
  [[nodiscard]] static constexpr double dots_across(bool unicode) noexcept { return unicode ? 2 : 1; }
  [[nodiscard]] static constexpr double dots_down(bool unicode) noexcept { return unicode ? 4 : 1; }

  /// A dot; x from the left and y from above, in characters. Outside, nothing.
  void dot(double x, double y, Layer layer) {
    Cell* const cell = at(x, y);
    if (cell == nullptr) return;
    const auto across = static_cast<unsigned>((x - std::floor(x)) * 2);
    const auto down = static_cast<unsigned>((y - std::floor(y)) * 4);
    // The bits of U+2800: three rows of each column first, then the fourth row. [Unicode, Braille patterns]
    static constexpr std::array<std::array<std::uint8_t, 4>, 2> bits{
        {{0x01, 0x02, 0x04, 0x40}, {0x08, 0x10, 0x20, 0x80}}};
    cell->dots |= bits[across][down];
    cell->layer = std::max(cell->layer, layer);
  }
  void line(double x, double y, double to_x, double to_y, Layer layer) {
    const double across = std::abs(to_x - x) * dots_across(unicode_);
    const double down = std::abs(to_y - y) * dots_down(unicode_);
    const double far = std::max({across, down, 1.0});
    // What lies far outside, or is no number, is not walked dot by dot.
    const double most = 16 * static_cast<double>(columns_ + rows_);
    const auto steps = static_cast<int>(std::ceil(far <= most ? far : most));
    for (int i = 0; i <= steps; ++i) {
      const double part = static_cast<double>(i) / steps;
      dot(x + (to_x - x) * part, y + (to_y - y) * part, layer);
    }
  }
  /// A character over the dots.
  void letter(double x, double y, std::string text, Style style) {
    if (Cell* const cell = at(x, y); cell != nullptr) {
      cell->letter = std::move(text);
      cell->style = style;
    }
  }

  [[nodiscard]] Line row(std::size_t number) const {
    Line line;
    for (std::size_t i = 0; i < columns_; ++i) {
      const Cell& cell = cells_[number * columns_ + i];
      const Style style = cell.letter.empty() ? style_of(cell.layer) : cell.style;
      const std::string text = text_of(cell);
      if (!line.empty() && line.back().style == style)
        line.back().text += text;
      else
        line.push_back({text, style});
    }
    return line;
  }

 private:
  struct Cell {
    std::uint8_t dots = 0;
    Layer layer = Layer::nothing;
    Style style = Style::plain;
    std::string letter{};
  };

  [[nodiscard]] Cell* at(double x, double y) {
    if (!(x >= 0 && y >= 0 && x < static_cast<double>(columns_) && y < static_cast<double>(rows_)))
      return nullptr;
    return &cells_[static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x)];
  }
  [[nodiscard]] std::string text_of(const Cell& cell) const {
    if (!cell.letter.empty()) return cell.letter;
    if (cell.layer == Layer::nothing) return " ";
    if (!unicode_) {
      static constexpr std::string_view letters = " :.-#*o";
      return std::string{letters[static_cast<std::size_t>(cell.layer)]};
    }
    return std::string{base::utf8_of(static_cast<char32_t>(0x2800 + cell.dots)).view()};
  }

  std::size_t columns_, rows_;
  bool unicode_;
  std::vector<Cell> cells_;
};

/// From metres to characters: all of the world, as large as there is room for.
class Scale {
 public:
  Scale(const sim::SeenWorld& world, std::size_t columns, std::size_t rows) {
    constexpr double endless = std::numeric_limits<double>::infinity();
    Vector low{endless, endless}, high{-endless, -endless};
    const auto consider = [&](Vector at, double around) {
      low = {std::min(low.x, at.x - around), std::min(low.y, at.y - around)};
      high = {std::max(high.x, at.x + around), std::max(high.y, at.y + around)};
    };
    for (const sim::Segment& wall : world.walls) {
      consider(wall.a, 0);
      consider(wall.b, 0);
    }
    // Without walls a robot has a metre around it.
    for (const sim::SeenRobot& robot : world.robots)
      consider(robot.centre, world.walls.empty() ? 1 : robot.radius_m);
    if (!(low.x <= high.x)) low = high = {};
    const double wide = std::max(high.x - low.x, 0.1);
    const double tall = std::max(high.y - low.y, 0.1);
    // Half a character is left at each edge, for a wall's own width.
    across_m_ =
        std::max(wide / (static_cast<double>(columns) - 1), tall / (static_cast<double>(rows) - 1) / 2);
    left_ = low.x;
    top_ = high.y;
  }
  [[nodiscard]] double x(Vector at) const noexcept { return 0.5 + (at.x - left_) / across_m_; }
  [[nodiscard]] double y(Vector at) const noexcept { return 0.5 + (top_ - at.y) / (2 * across_m_); }
  /// Of a character's width.
  [[nodiscard]] double metres() const noexcept { return across_m_; }

 private:
  double across_m_ = 1;
  double left_ = 0;
  double top_ = 0;
};

/// An arrow to the nearest of eight directions, in ASCII of four.
std::string arrow(double heading_rad, bool unicode) {
  static constexpr std::array<std::string_view, 8> arrows{"→", "↗", "↑", "↖", "←", "↙", "↓", "↘"};
  static constexpr std::array<std::string_view, 4> letters{">", "^", "<", "v"};
  const int count = unicode ? 8 : 4;
  const auto turns = static_cast<long>(std::lround(heading_rad / (2 * sim::pi) * count));
  const auto which = static_cast<std::size_t>((turns % count + count) % count);
  return std::string{unicode ? arrows[which] : letters[which]};
}

/// Robots are numbered on the map as in the list beside it: 1 to 9, then + for all others.
std::string number_of(std::size_t robot) {
  return robot < 9 ? std::to_string(robot + 1) : "+";
}

Canvas room_of(const sim::SeenWorld& world, const Trails& trails, const RoomScene& scene, std::size_t chosen,
               std::size_t columns, std::size_t rows, bool unicode) {
  Canvas canvas{columns, rows, unicode};
  const Scale scale{world, columns, rows};
  const auto line = [&](Vector a, Vector b, Layer layer) {
    canvas.line(scale.x(a), scale.y(a), scale.x(b), scale.y(b), layer);
  };
  for (const sim::Segment& piece : world.line) line(piece.a, piece.b, Layer::line);
  for (const sim::SeenRobot& robot : world.robots) {
    const Trails::Trail& trail = trails.of(robot.name);
    for (std::size_t i = 1; i < trail.size(); ++i) line(trail[i - 1], trail[i], Layer::trail);
  }
  for (const sim::Segment& wall : world.walls) line(wall.a, wall.b, Layer::wall);
  for (const sim::SeenRobot& robot : world.robots) {
    if (scene.beams)
      for (const sim::Beam& beam : robot.beams) {
        line(beam.from, beam.to, Layer::beam);
        if (beam.meets) canvas.dot(scale.x(beam.to), scale.y(beam.to), Layer::end);
      }
    constexpr int corners = 24;
    for (int i = 0; i < corners; ++i)
      line(robot.centre + sim::direction(2 * sim::pi * i / corners) * robot.radius_m,
           robot.centre + sim::direction(2 * sim::pi * (i + 1) / corners) * robot.radius_m, Layer::body);
  }
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const sim::SeenRobot& robot = world.robots[i];
    const double x = scale.x(robot.centre), y = scale.y(robot.centre);
    const Style style = robot.touching ? Style::bad : i == chosen ? Style::selected : Style::bold;
    canvas.letter(x, y, arrow(robot.pose.heading_rad, unicode), style);
    if (world.robots.size() > 1) canvas.letter(x + 1, y, number_of(i), style);
  }
  return canvas;
}

// --- the state ---

/// -180 to 180.
double degrees(double radians) {
  return std::remainder(radians, 2 * sim::pi) / sim::degree;
}

/// The primary or mixed colour that is nearest, as a letter; ".": off.
char letter_of(Colour colour) {
  const int most = std::max({colour.red, colour.green, colour.blue});
  if (most == 0) return '.';
  const auto on = [most](std::uint8_t part) { return 2 * part >= most ? 1U : 0U; };
  static constexpr std::string_view letters = ".bgcrmyw";  // by red, green, blue
  return letters[on(colour.red) << 2 | on(colour.green) << 1 | on(colour.blue)];
}

std::string beam_text(const sim::Beam& beam) {
  return beam.meets ? fmt::format("{:5.2f}", sim::length(beam.to - beam.from)) : "    -";
}

/// A line each; 25 columns are enough for all of them.
std::vector<Line> state_of(const sim::SeenRobot& robot) {
  std::vector<Line> lines;
  const auto add = [&lines](std::string_view what, const std::string& value, Style style = Style::plain) {
    lines.push_back({{fmt::format("{:<8}", what), Style::dim}, {value, style}});
  };
  add("x", fmt::format("{:8.3f} m", robot.pose.x_m));
  add("y", fmt::format("{:8.3f} m", robot.pose.y_m));
  add("heading", fmt::format("{:8.1f} deg", degrees(robot.pose.heading_rad)));
  add("left", fmt::format("{:8.3f} m/s", robot.wheels.left));
  add("right", fmt::format("{:8.3f} m/s", robot.wheels.right));
  if (robot.charge) add("battery", fmt::format("{:8.0f} %", *robot.charge * 100));
  if (!robot.lights.empty()) {
    std::string lights;
    for (const Colour& light : robot.lights) {
      if (!lights.empty()) lights += ' ';
      lights += letter_of(light);
    }
    add("lights", lights);
  }
  if (!robot.beams.empty()) {
    constexpr std::size_t a_line = 4;
    lines.push_back({{"beams, m", Style::dim}});
    for (std::size_t i = 0; i < robot.beams.size(); i += a_line) {
      std::string text;
      for (std::size_t k = i; k < std::min(i + a_line, robot.beams.size()); ++k)
        text += ' ' + beam_text(robot.beams[k]);
      lines.push_back({{text, Style::plain}});
    }
  }
  if (robot.touching) lines.push_back({{"touches something", Style::bad}});
  return lines;
}

/// In lines of any width: where it is, what its wheels do, its lights.
std::vector<Line> short_state_of(const sim::SeenRobot& robot) {
  std::string lights;
  for (const Colour& light : robot.lights) lights += letter_of(light);
  const double nearest = [&robot] {
    double least = std::numeric_limits<double>::infinity();
    for (const sim::Beam& beam : robot.beams)
      if (beam.meets) least = std::min(least, sim::length(beam.to - beam.from));
    return least;
  }();
  std::vector<Line> lines;
  lines.push_back({{fmt::format("x {:.3f} m  y {:.3f} m  {:.1f} deg", robot.pose.x_m, robot.pose.y_m,
                                degrees(robot.pose.heading_rad)),
                    Style::plain}});
  lines.push_back({{fmt::format("left {:.3f} m/s  right {:.3f} m/s", robot.wheels.left, robot.wheels.right),
                    Style::plain}});
  lines.push_back({{fmt::format("lights {}{}", lights,
                                std::isfinite(nearest) ? fmt::format("  nearest {:.2f} m", nearest) : ""),
                    robot.touching ? Style::bad : Style::plain}});
  return lines;
}

Line name_line(const sim::SeenWorld& world, std::size_t chosen) {
  const std::string& name = world.robots[chosen].name;
  if (world.robots.size() == 1) return {{name, Style::bold}};
  return {{fmt::format("{} {}", number_of(chosen), name), Style::selected},
          {fmt::format("  of {}", world.robots.size()), Style::dim}};
}

/// The chosen robot's state, and where the others are, in so many lines.
std::vector<Line> panel(const sim::SeenWorld& world, std::size_t chosen, std::size_t rows) {
  std::vector<Line> lines;
  if (world.robots.empty()) return lines;
  lines.push_back(name_line(world, chosen));
  for (Line& line : state_of(world.robots[chosen])) lines.push_back(std::move(line));
  const std::size_t others = world.robots.size() - 1;
  if (others > 0) lines.emplace_back();
  std::size_t shown = 0;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (i == chosen) continue;
    const bool last = shown + 1 == others;
    if (lines.size() + (last ? 0 : 1) >= rows) break;
    const sim::SeenRobot& robot = world.robots[i];
    lines.push_back({{fmt::format("{} {:<8} {:5.2f} {:5.2f}", number_of(i), cut(robot.name, 8),
                                  robot.pose.x_m, robot.pose.y_m),
                      robot.touching ? Style::bad : Style::plain}});
    ++shown;
  }
  if (shown < others) lines.push_back({{fmt::format("and {} more", others - shown), Style::dim}});
  return lines;
}

Line head(const sim::SeenWorld& world, const RoomScene& scene, std::size_t width) {
  Line line;
  put(line, world.name, Style::bold, width);
  const double seconds = static_cast<double>(world.time.time_since_epoch().count()) / 1e9;
  put(line, fmt::format("  {:.1f} s", seconds), Style::plain, width);
  if (scene.speed != 1) put(line, fmt::format("  x{:g}", scene.speed), Style::plain, width);
  if (!scene.bus.empty()) put(line, fmt::format("  on {}", scene.bus), Style::dim, width);
  return line;
}

Line foot(const sim::SeenWorld& world, const RoomScene& scene, std::size_t width) {
  Line line;
  if (!scene.message.empty()) {
    put(line, scene.message, Style::warning, width);
    return line;
  }
  std::vector<std::string_view> keys{"q quit", "  b beams", "  t new trail"};
  if (world.robots.size() > 1) keys.push_back("  Tab next robot");
  for (const std::string_view key : keys)
    if (columns_of(line) + key.size() <= width) put(line, key, Style::dim, width);
  return line;
}

}  // namespace

void Trails::take(const sim::SeenWorld& world) {
  for (const sim::SeenRobot& robot : world.robots) {
    Trail& trail = trails_[robot.name];
    if (!trail.empty() && sim::length(robot.centre - trail.back()) < apart_m) continue;
    if (trail.size() == most) trail.pop_front();
    trail.push_back(robot.centre);
  }
}

const Trails::Trail& Trails::of(const std::string& robot) const {
  static const Trail none;
  const auto found = trails_.find(robot);
  return found == trails_.end() ? none : found->second;
}

Picture draw_room(const sim::SeenWorld& world, const Trails& trails, const RoomScene& scene,
                  TerminalSize size, bool unicode) {
  const std::size_t robots = world.robots.size();
  const std::size_t chosen = robots == 0 ? 0 : std::min(scene.chosen, robots - 1);
  const bool beside = size.columns >= least_columns_beside;
  const std::size_t inner = size.rows > 2 ? size.rows - 2 : 0;  // between head and foot
  const std::size_t columns = beside ? size.columns - panel_columns - 1 : size.columns;
  const std::size_t below = beside ? 0 : std::min(inner, panel_lines);
  const std::size_t rows = inner - below;
  const bool has_room = rows >= least_room && columns >= least_room;

  Picture picture;
  picture.push_back(head(world, scene, size.columns));
  const auto add_panel = [&](const std::vector<Line>& lines) {
    for (const Line& from : lines) {
      if (picture.size() + 1 >= size.rows) break;
      Line line;
      for (const top::Piece& piece : from) put(line, piece.text, piece.style, size.columns);
      picture.push_back(std::move(line));
    }
  };
  if (has_room) {
    const Canvas canvas = room_of(world, trails, scene, chosen, columns, rows, unicode);
    const std::vector<Line> state = beside ? panel(world, chosen, rows) : std::vector<Line>{};
    for (std::size_t row = 0; row < rows; ++row) {
      Line line = canvas.row(row);
      if (row < state.size()) {
        line.push_back({" ", Style::plain});
        for (const top::Piece& piece : state[row]) put(line, piece.text, piece.style, size.columns);
      }
      picture.push_back(std::move(line));
    }
  }
  if ((!has_room || !beside) && robots > 0) {
    std::vector<Line> lines{name_line(world, chosen)};
    for (Line& line : short_state_of(world.robots[chosen])) lines.push_back(std::move(line));
    add_panel(lines);
  }
  picture.resize(std::max<std::size_t>(size.rows, 1) - 1);
  picture.push_back(foot(world, scene, size.columns));
  picture.resize(size.rows);
  return picture;
}

}  // namespace ocm::cli::simulate
