#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "cli/plot/gnuplot.hpp"

namespace ocm::cli::plot {
namespace {

/// So few points are marked, each.
constexpr std::size_t marked = 200;

/// Pixels.
constexpr double top = 68, bottom = 58, left = 96, right = 24, between = 20;
constexpr double key_letter = 7.3, key_line = 44;
constexpr unsigned usual_width = 1200, panel_height = 220, one_panel_height = 420, path_height = 800;

struct Panel {
  std::string unit;
  std::vector<std::size_t> curves;
};

/// Curves that have a point.
std::vector<Panel> panels_of(const Curves& curves, bool path) {
  std::vector<Panel> panels;
  for (std::size_t i = 0; i < curves.all().size(); ++i) {
    if (curves.all()[i].envelope.count() == 0) continue;
    const auto& unit = curves.all()[i].wanted.y.field->unit;
    auto panel =
        std::find_if(panels.begin(), panels.end(), [&](const Panel& p) { return path || p.unit == unit; });
    if (panel == panels.end()) panel = panels.insert(panel, {std::string{unit}, {}});
    panel->curves.push_back(i);
  }
  return panels;
}

std::string with_unit(const ChosenField& field) {
  return field.field->unit.empty() ? field.name : fmt::format("{} [{}]", field.name, field.field->unit);
}

std::string key_of(const Wanted& wanted) {
  return wanted.x ? fmt::format("{} : {}", wanted.x->name, wanted.y.name) : wanted.y.name;
}

class Script {
 public:
  Script(const Curves& curves, const Picture& picture)
      : curves_(curves),
        picture_(picture),
        path_(
            std::any_of(curves.all().begin(), curves.all().end(), [](const Curve& c) { return c.wanted.x; })),
        panels_(panels_of(curves, path_)) {
    const auto count = static_cast<unsigned>(panels_.size());
    width_ = picture.width != 0 ? picture.width : path_ ? 1000 : usual_width;
    height_ = picture.height != 0 ? picture.height
              : path_             ? path_height
              : count == 1        ? one_panel_height
                                  : count * panel_height + static_cast<unsigned>(top + bottom);
    for (const Panel& panel : panels_)
      if (panel.curves.size() > 1)
        for (const std::size_t i : panel.curves)
          key_ = std::max(key_,
                          key_line + key_letter * static_cast<double>(key_of(curves.all()[i].wanted).size()));
  }

  std::string text() {
    terminal();
    for (std::size_t i = 0; i < curves_.all().size(); ++i) data(i);
    if (panels_.size() > 1) add("set multiplot\n");
    for (std::size_t n = 0; n < panels_.size(); ++n) panel(n);
    if (panels_.size() > 1) add("unset multiplot\n");
    return std::move(out_);
  }

 private:
  template <class... Values>
  void add(fmt::format_string<Values...> text, Values&&... values) {
    out_ += fmt::format(text, std::forward<Values>(values)...);
  }

  void terminal() {
    out_ += plot::terminal(picture_.kind, width_, height_);
    add("set border 3 lc rgb '#888888' lw 1\n"
        "set tics nomirror out scale 0.6 textcolor rgb '#444444'\n"
        "set grid lc rgb '#dddddd' lw 0.8 lt 1\n"
        "set key noenhanced reverse Left samplen 2 spacing 1.25 width 0 textcolor rgb '#222222'\n"
        "set label 1 {} at screen {:.5f},{:.5f} left noenhanced font ':Bold,15'\n"
        "set label 2 {} at screen {:.5f},{:.5f} left noenhanced textcolor rgb '#666666'\n",
        quoted(picture_.title), x(left - 72), y(22), quoted(picture_.subtitle), x(left - 72), y(44));
  }

  /// Pieces of a curve are parted by an empty line.
  void data(std::size_t number) {
    const Curve& curve = curves_.all()[number];
    const base::Time begin = curves_.begin().value_or(base::Time{});
    add("$d{} << EOD\n", number);
    for (const auto& point : curve.envelope.points()) {
      if (point.begins && point.number != 0) add("\n");
      if (curve.wanted.x)
        add("{:.12g} {:.12g}\n", point.x, point.y);
      else
        add("{:.6f} {:.12g}\n", static_cast<double>((point.time - begin).count()) / 1e9, point.y);
    }
    add("EOD\n");
  }

  void panel(std::size_t n) {
    const auto count = static_cast<double>(panels_.size());
    const double each = (height_ - top - bottom - between * (count - 1)) / count;
    const double upper = top + static_cast<double>(n) * (each + between);
    const double end = width_ - right - key_;
    add("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
        "set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}\n",
        x(left), x(end), y(upper), y(upper + each));
    if (key_ > 0) add("set key at screen {:.5f},{:.5f} left top vertical\n", x(end + 12), y(upper));
    const Panel& panel = panels_[n];
    if (path_)
      path_axes(panel);
    else
      time_axes(panel, n + 1 == panels_.size());
    plot(panel);
    if (n == 0) add("unset label\n");
  }

  void time_axes(const Panel& panel, bool last) {
    const double span =
        static_cast<double>((curves_.end() - curves_.begin().value_or(curves_.end())).count()) / 1e9;
    add("set xrange [0:{:.6f}]\nset offsets graph 0, graph 0, graph 0.06, graph 0.06\n",
        span > 0 ? span : 1.0);
    add("set xlabel {} noenhanced\nset format x {}\n", quoted(last ? "time [s]" : ""),
        quoted(last ? "% h" : ""));
    const auto& first = curves_.all()[panel.curves[0]].wanted.y;
    const std::string unit = panel.unit.empty() ? "" : "[" + panel.unit + "]";
    add("set ylabel {} noenhanced offset 0,0\nset format y '% h'\n",
        quoted(panel.curves.size() == 1 ? with_unit(first) : unit));
  }

  void path_axes(const Panel& panel) {
    const auto& first = curves_.all()[panel.curves[0]].wanted;
    if (first.x->field->unit == first.y.field->unit)
      same_scale(panel);
    else
      add("set offsets graph 0.05, graph 0.05, graph 0.05, graph 0.05\n");
    const bool alone = panel.curves.size() == 1;
    const auto label = [alone](const ChosenField& field) {
      if (alone) return with_unit(field);
      return field.field->unit.empty() ? std::string{} : fmt::format("[{}]", field.field->unit);
    };
    add("set xlabel {} noenhanced\nset ylabel {} noenhanced\nset format '% h'\n", quoted(label(*first.x)),
        quoted(label(first.y)));
  }

  /// A length is as long in both directions, and the path in the middle.
  void same_scale(const Panel& panel) {
    double low_x = HUGE_VAL, high_x = -HUGE_VAL, low_y = HUGE_VAL, high_y = -HUGE_VAL;
    for (const std::size_t i : panel.curves)
      for (const auto& point : curves_.all()[i].envelope.points()) {
        low_x = std::min(low_x, point.x);
        high_x = std::max(high_x, point.x);
        low_y = std::min(low_y, point.y);
        high_y = std::max(high_y, point.y);
      }
    const double across = width_ - right - key_ - left, down = height_ - top - bottom;
    double a_pixel = 1.1 * std::max((high_x - low_x) / across, (high_y - low_y) / down);
    if (!(a_pixel > 0)) a_pixel = 1 / across;  // a single place
    const auto range = [&](double low, double high, double pixels) {
      const double middle = low + (high - low) / 2, half = a_pixel * pixels / 2;
      return fmt::format("[{:.12g}:{:.12g}]", middle - half, middle + half);
    };
    add("set xrange {}\nset yrange {}\n", range(low_x, high_x, across), range(low_y, high_y, down));
  }

  void plot(const Panel& panel) {
    std::size_t points = 0;
    for (const std::size_t i : panel.curves) points += curves_.all()[i].envelope.points().size();
    add("plot ");
    for (std::size_t k = 0; k < panel.curves.size(); ++k) {
      const std::size_t i = panel.curves[k];
      const char* colour = colours[k % colours.size()];
      const std::string key =
          panel.curves.size() > 1 ? "title " + quoted(key_of(curves_.all()[i].wanted)) : "notitle";
      add("{}$d{} using 1:2 with {} lc rgb '{}' lw 1.5 {}{}", k == 0 ? "" : ", \\\n  ", i,
          points <= marked ? "linespoints" : "lines", colour, points <= marked ? "pt 7 ps 0.5 " : "", key);
      if (path_)  // where it begins
        add(", \\\n  $d{} using 1:2 every ::0::0:0 with points lc rgb '{}' pt 6 ps 1.4 lw 1.5 notitle", i,
            colour);
    }
    add("\n");
  }

  [[nodiscard]] double x(double pixels) const { return pixels / width_; }
  [[nodiscard]] double y(double pixels) const { return 1 - pixels / height_; }

  const Curves& curves_;
  const Picture& picture_;
  bool path_;
  std::vector<Panel> panels_;
  unsigned width_ = 0;
  unsigned height_ = 0;
  double key_ = 0;
  std::string out_;
};

}  // namespace

std::string to_script(const Curves& curves, const Picture& picture) {
  return Script{curves, picture}.text();
}

}  // namespace ocm::cli::plot
