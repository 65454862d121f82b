/// Times, numbers and shares in a few columns, for a table that is drawn again and again.
#pragma once

#include <string>

#include "ocm/base/time.hpp"

namespace ocm::cli::top {

/// "1.2ms", "340ms", "12.3s", "4m", "2h": six columns at most.
[[nodiscard]] std::string short_time(base::Duration duration);
/// "0.95", "20.0", "1234": six columns at most.
[[nodiscard]] std::string short_number(double number);
/// Of a share, 0 to 1: "12.5%"; what is too small for that, but not nothing: "<0.1%".
[[nodiscard]] std::string percent(double share);

}  // namespace ocm::cli::top
