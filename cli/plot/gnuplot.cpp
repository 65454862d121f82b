#include "cli/plot/gnuplot.hpp"

#include <fmt/format.h>

#include "cli/shared/drawing_program.hpp"

namespace ocm::cli::plot {
std::optional<Kind> kind_of_file(std::string_view name) {
  if (name.ends_with(".svg")) return Kind::svg;
  if (name.ends_with(".png")) return Kind::png;
  if (name.ends_with(".pdf")) return Kind::pdf;
  return std::nullopt;
}

std::string terminal(Kind kind, unsigned width, unsigned height) {
  const auto set = [](std::string_view what, std::string_view size, int font) {
    return fmt::format(
        "set terminal {} size {} font 'DejaVu Sans,{}' background '#ffffff'\nset encoding utf8\n", what, size,
        font);
  };
  const std::string pixels = fmt::format("{},{}", width, height);
  if (kind == Kind::svg) return set("svg", pixels, 12);
  if (kind == Kind::png) return set("pngcairo", pixels, 10);
  return set("pdfcairo", fmt::format("{:.2f}in,{:.2f}in", width / 100.0, height / 100.0), 9);
}

std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'')
      out += "''";
    else
      out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  }
  return out + "'";
}

transport::Outcome<std::string> draw(std::string_view script) {
  // -d: as it comes, whatever ~/.gnuplot says.
  return drawn_by({"gnuplot", "-d"}, script, "sudo apt install gnuplot-nox");
}

}  // namespace ocm::cli::plot
