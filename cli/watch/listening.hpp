/// Frames of a live bus as entries of a log, until a limit, a signal, or the end of the bus.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/shared/live.hpp"

namespace ocm::cli {

/// Entries in order; the names of their interfaces.
using TakeEntries = std::function<void(std::span<const log::Entry>, const log::Interfaces&)>;
/// Frames that are known to be lost, by interface.
using TakeLost = std::function<void(std::string_view interface, std::uint64_t frames)>;

struct ListenLimits {
  std::optional<base::Duration> duration;
  std::uint64_t count = 0;  ///< 0: any
};

/// Calls `each_second`, where there is one, once a second, whether or not something came; of seconds in which
/// this program did not run, once. `Over::enough`: the count is reached.
[[nodiscard]] Over listen(transport::Bus& bus, const ListenLimits& limits, const TakeEntries& take,
                          const TakeLost& lost, const std::function<void()>& each_second);

}  // namespace ocm::cli
