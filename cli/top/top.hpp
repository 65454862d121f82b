/// The loop of `top`: frames in, keys in, a picture out.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/shared/session.hpp"

namespace ocm::cli::top {

/// No more than twenty pictures a second, after a key, too.
inline constexpr base::Duration shortest_interval = std::chrono::milliseconds{50};

struct TopOptions {
  std::string log;                             ///< empty: the bus
  std::string format;                          ///< of the log; empty: find out
  std::vector<const protocol::Topic*> topics;  ///< empty: all
  std::optional<std::uint32_t> bit_rate, data_bit_rate;
  base::Duration interval = std::chrono::milliseconds{100};
  bool mouse = false;
};

/// Until the user quits, a signal comes, or the bus is gone. The exit code; leaves through `fail`, with the
/// terminal as it was, where there is no terminal, no bus or no log.
[[nodiscard]] int run(Session& session, const TopOptions& options);

}  // namespace ocm::cli::top
