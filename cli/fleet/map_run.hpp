/// Mappers explore and draw one map: places them, watches them until all is known or something ends it, and
/// reports.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/cognitive/agreement.hpp"
#include "ocm/cognitive/mapping.hpp"

#include "cli/fleet/central_line.hpp"
#include "cli/fleet/known.hpp"
#include "cli/fleet/picture.hpp"

namespace ocm::cli::fleet {

struct MapOptions {
  LineOptions line;
  std::vector<std::string> files;
  std::vector<std::string> robots;
  std::vector<std::string> starts;
  std::optional<base::Duration> duration;
  std::string world;
  std::string title;
  double resolution_cm = 4;
  double range_m = 0;  ///< 0: that of the world, or none
  bool watch = false;
  bool json = false;
};

/// Why it ended.
enum class End : std::uint8_t {
  known,
  bad_link,      ///< the rest lies where a robot was called back
  out_of_range,  ///< the rest lies beyond the radio's range
  unseen,        ///< the rest could not be seen, or no way leads there
  time_over,
  interrupted,
  robots_lost,
  central_gone
};
/// Those of which the command has done what was asked for.
[[nodiscard]] constexpr bool is_success(End end) noexcept {
  return end == End::known || end == End::time_over || end == End::interrupted;
}

class MapRun {
 public:
  /// Waits for the robots and places them. Both must outlive it. Leaves through cli::fail when it cannot
  /// begin.
  MapRun(const MapOptions& options, const Known& known);

  /// At the end it is asked again and again until it is true, while the line is still served to others.
  void on_end(std::function<bool()> over) { over_ = std::move(over); }

  /// Until all is known, for `limit`, until Ctrl-C, or until the central is gone. Whichever it is, what was
  /// drawn is there.
  End explore(std::optional<base::Duration> limit);

  [[nodiscard]] MapPicture picture(const std::optional<cognitive::Agreement>& result) const;
  /// Against the true walls, where they are known.
  [[nodiscard]] std::optional<cognitive::Agreement> result() const;
  /// On stdout.
  void report(const std::optional<cognitive::Agreement>& result) const;

  [[nodiscard]] const cognitive::Map& map() const { return mapping_->map(); }
  [[nodiscard]] bool any() const { return mapping_->counters().drawn != 0; }
  /// --record, if it was given, has all that came.
  [[nodiscard]] bool is_recorded() const { return line_.own()->is_recorded(); }

 private:
  [[nodiscard]] End drive(std::optional<base::Duration> limit);
  void tell_lost();
  /// Robots that other programs have ordered about are left alone.
  void tell_held();
  /// For a program that looks on (owner.hpp).
  [[nodiscard]] std::string draw(std::string_view form) const;
  /// Nothing is left to do: is the place known, and if not, why?
  [[nodiscard]] End end_of_exploring() const;
  [[nodiscard]] bool lost(unsigned index) const { return line_.robot(index).lost; }
  [[nodiscard]] bool all_robots_lost() const;
  [[nodiscard]] std::string names() const;

  const MapOptions& options_;
  const Known& known_;
  CentralLine line_;
  std::vector<unsigned> robots_;
  std::optional<cognitive::Mapping> mapping_;
  std::vector<unsigned> lost_;
  std::vector<unsigned> held_;
  std::function<bool()> over_;
  base::Time begin_{};
  base::Duration took_{};
  End end_ = End::known;
};

}  // namespace ocm::cli::fleet
