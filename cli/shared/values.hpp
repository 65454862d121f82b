/// Values of options that verbs have in common: texts in, quantities out, or the end of the command.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ocm/base/time.hpp"

#include "cli/shared/option_value.hpp"

namespace ocm::cli {

/// A duration option such as --timeout 2s; exit_usage when it is none.
[[nodiscard]] base::Duration duration_option(std::string_view option, const std::string& text);

/// A bit rate in bit/s: "500000", "500k", "83.333k", "1M"; exit_usage when it is none of classic CAN.
[[nodiscard]] std::uint32_t bit_rate_option(std::string_view text);

/// What such options are declared to take.
[[nodiscard]] Accepted accepted_duration();
[[nodiscard]] Accepted accepted_bit_rate();
[[nodiscard]] Accepted accepted_priority();

}  // namespace ocm::cli
