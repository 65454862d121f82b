/// Curves as a picture: a script for gnuplot, and gnuplot to draw it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/transport/bus.hpp"

#include "cli/plot/curves.hpp"

namespace ocm::cli::plot {

enum class Kind : std::uint8_t { svg, png, pdf };

/// By the ending of a file's name, if it is one of a picture.
[[nodiscard]] std::optional<Kind> kind_of_file(std::string_view name);

/// gnuplot's commands for a picture of this many pixels; 100 of them are an inch of paper.
[[nodiscard]] std::string terminal(Kind kind, unsigned width, unsigned height);

/// Colours that colour-blind people can distinguish. [Okabe, Ito 2008]
inline constexpr std::array colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                    "#E69F00", "#56B4E9", "#000000", "#999933"};

/// A text that gnuplot takes as it is.
[[nodiscard]] std::string quoted(std::string_view text);

struct Picture {
  Kind kind = Kind::svg;
  unsigned width = 0;   ///< pixels; 0: as is right for what is drawn
  unsigned height = 0;  ///<
  std::string title;
  std::string subtitle;
};

/// Curves over time stand one below the other, a panel for each unit; paths share one.
[[nodiscard]] std::string to_script(const Curves& curves, const Picture& picture);

/// The picture that the script draws. The failure says what gnuplot says, or that there is none.
[[nodiscard]] transport::Outcome<std::string> draw(std::string_view script);

}  // namespace ocm::cli::plot
