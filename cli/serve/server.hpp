/// What `serve` does with its options: which of bus, log and robots the page is of. Other verbs show with it,
/// too.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/serve/fleet_watch.hpp"
#include "cli/serve/web.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli::serve {

struct ServeOptions {
  std::string log;     ///< empty: the bus
  std::string format;  ///< of the log; empty: find out
  std::optional<std::uint32_t> bit_rate, data_bit_rate;
  WebOptions web;
  bool commands = false;
  bool bus = true;  ///< or the log; false: only robots behind a central
  /// Of the line, or of its log; none: there are no such robots.
  std::optional<FleetOptions> fleet;
  std::string shows;           ///< what the page shows first, as its address has it: "plot=/gyroscope.z"
  bool opens = false;          ///< in this user's browser, too
  std::function<bool()> over;  ///< is asked several times a second; true ends it
};

/// Leaves through `fail` where this program was built without the page.
void check_has_page(std::string_view verb);

/// Until a signal comes, it is over, or the bus is gone. The exit code; leaves through `fail` where there is
/// no page, no bus, no log or no port.
[[nodiscard]] int run(Session& session, ServeOptions options);

}  // namespace ocm::cli::serve
