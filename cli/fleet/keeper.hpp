/// Has a central's line, with links to all its robots, and does nothing but serve it to the programs that
/// join: links stay up, and no command needs to look for robots again. What it watches, others watch, too.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "cli/fleet/central_line.hpp"
#include "cli/fleet/link_watch.hpp"

namespace ocm::cli::fleet {

/// Links to all robots that the central finds; words about one that cannot be reached go to `say`.
void link_all(CentralLine& line, const std::function<void(const std::string&)>& say);

/// Says which robots of a line get lost, and whose link gets bad.
class Keeper {
 public:
  using Say = std::function<void(const std::string& words)>;

  /// `call_back`: a robot that drives with a bad link is called back, as far as this program may.
  Keeper(bool call_back, Say say) : call_back_(call_back), say_(std::move(say)) {}

  /// Looks at each robot; ten times a second.
  void look(LineEnd& line);

 private:
  struct Kept {
    LinkWatch watch{};
    bool linked = false;
    bool lost = false;
  };
  bool call_back_;
  Say say_;
  std::map<unsigned, Kept> kept_;
};

/// Until a signal comes. Reports robots that get lost or whose link gets bad; `call_back`: one that drives
/// then is called back. Returns the exit code.
[[nodiscard]] int keep_line(const LineOptions& options, bool call_back);

}  // namespace ocm::cli::fleet
