/// A map as a file: SVG, PNG or PDF to look at, drawn by gnuplot; PGM with YAML, as ROS's map_server reads
/// and writes them, for other programs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/cognitive/map.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/plot/gnuplot.hpp"

namespace ocm::cli::fleet {

struct DrawnRobot {
  std::string name;
  std::vector<motion::Point> path;       ///< by its own estimate
  std::vector<motion::Point> true_path;  ///< where it is known
};

struct MapPicture {
  std::string title;
  std::string subtitle;
  std::vector<DrawnRobot> robots;
  std::vector<cognitive::Wall> walls;  ///< true ones; none: not known
};

/// Whether a map can be written to a file of that name: its ending says how.
[[nodiscard]] bool is_map_file(std::string_view name);

/// The script for gnuplot.
[[nodiscard]] std::string to_script(const cognitive::Map& map, const MapPicture& picture, plot::Kind kind);

/// A portable grey map, the top first: occupied 0, free 254, unknown 205. [map_server]
[[nodiscard]] std::string to_pgm(const cognitive::Map& map);
/// What belongs to it; `image` is the file's name.
[[nodiscard]] std::string to_yaml(const cognitive::Map& map, std::string_view image);

/// As an object of JSON, the Grid of Foxglove's schemas without its time: rows from the lower left corner on,
/// in its `data` a byte a cell in Base64, the value of cognitive::CellState. With a map of 4 MiB of cells 6
/// MB.
[[nodiscard]] std::string to_grid(const cognitive::Map& map);
/// A map as the text of a file of this form (line_request.hpp); of svg, png and pdf as gnuplot's script.
[[nodiscard]] std::string to_form(const cognitive::Map& map, const MapPicture& picture,
                                  std::string_view form);

/// Writes the file, and beside a PGM its YAML. What went wrong, if anything did.
[[nodiscard]] std::optional<transport::Failure> write_map(const std::string& file, const cognitive::Map& map,
                                                          const MapPicture& picture);

/// Why no map could be drawn to that file, if none could: to ask before robots drive for it. Takes as long as
/// gnuplot needs to start.
[[nodiscard]] std::optional<transport::Failure> cannot_draw(const std::string& file);

}  // namespace ocm::cli::fleet
