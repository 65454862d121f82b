/// Options whose values verbs have in common: their text is read once, while the command line is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "ocm/base/time.hpp"
#include "ocm/protocol/identifier.hpp"

#include "cli/shared/arguments.hpp"
#include "cli/shared/option_value.hpp"

namespace ocm::cli {

/// Of a function that reads a text and returns a value, or an error with `what` and `remedy`.
template <class Value, class Read>
[[nodiscard]] TakeValue take_into(Value& value, Read read) {
  return [&value, read](const std::string& text) -> std::optional<Misuse> {
    const auto result = read(text);
    if (!result) return Misuse{result.error.what, result.error.remedy};
    value = *result;
    return {};
  };
}

/// A time of zero or more, such as 500ms; `value` is the default, and the help shows it.
Option add_duration(Verb verb, const std::string& names, base::Duration& value, const std::string& help);
/// The same without a default.
Option add_duration(Verb verb, const std::string& names, std::optional<base::Duration>& value,
                    const std::string& help);
/// Both with a time above zero: how long something lasts.
Option add_lasting(Verb verb, const std::string& names, base::Duration& value, const std::string& help);
Option add_lasting(Verb verb, const std::string& names, std::optional<base::Duration>& value,
                   const std::string& help);

/// A priority by its name or number; without one it stays as it is.
Option add_priority(Verb verb, const std::string& names, std::optional<protocol::Priority>& value,
                    const std::string& help);

/// A bit rate in bit/s: "500000", "500k", "83.333k", "1M", if classic CAN has it.
Option add_bit_rate(Verb verb, const std::string& names, std::optional<std::uint32_t>& value,
                    const std::string& help);
/// The same of the data of CAN FD, to 16 Mbit/s.
Option add_data_bit_rate(Verb verb, const std::string& names, std::optional<std::uint32_t>& value,
                         const std::string& help);
/// Of the virtual bus, which may be faster than CAN; bit/s. [decided]
inline constexpr std::uint32_t fastest_simulated_bit_rate = 1'000'000'000;
Option add_simulated_bit_rate(Verb verb, const std::string& names, std::uint32_t& value,
                              const std::string& help);

/// What such options are declared to take.
[[nodiscard]] Accepted accepted_duration();
[[nodiscard]] Accepted accepted_lasting();
[[nodiscard]] Accepted accepted_every();
[[nodiscard]] Accepted accepted_bit_rate();
[[nodiscard]] Accepted accepted_priority();

}  // namespace ocm::cli
