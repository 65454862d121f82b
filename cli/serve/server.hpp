/// The loop of `serve`: frames in, samples and states out to all viewers, their orders to the bus.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/serve/web.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli::serve {

struct ServeOptions {
  std::string log;     ///< empty: the bus
  std::string format;  ///< of the log; empty: find out
  std::optional<std::uint32_t> bit_rate, data_bit_rate;
  WebOptions web;
  bool commands = false;
};

/// Until a signal comes or the bus is gone. The exit code; leaves through `fail` where there is no page, no
/// bus, no log or no port.
[[nodiscard]] int run(Session& session, ServeOptions options);

}  // namespace ocm::cli::serve
