#include "cli/shared/values.hpp"

#include <utility>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"
#include "ocm/protocol/identifier.hpp"

#include "cli/shared/messages.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

constexpr const char* a_bit_rate = "1 to 1000000 bits a second, such as 500k or 125000";

/// Bits a second, whole; classic CAN ends at a million.
base::Result<std::int64_t> parse_bit_rate(std::string_view digits) {
  std::int64_t unit = 1;
  if (digits.ends_with('k') || digits.ends_with('K')) unit = 1000;
  if (digits.ends_with('M')) unit = 1'000'000;
  if (unit != 1) digits.remove_suffix(1);
  const auto number = base::parse_decimal(digits);
  const auto rate = number ? base::multiply(*number, {unit, 0}) : number;
  const auto whole = rate ? base::divide_rounded(*rate, {1, 0}) : base::Result<std::int64_t>{rate.error};
  if (whole && (*whole < 1 || *whole > 1'000'000 || base::compare(*rate, {*whole, 0}) != 0))
    return base::Error::out_of_range;
  return whole;
}

base::Result<base::Duration> parse_length_of_time(std::string_view text) {
  const auto duration = words::parse_duration(text);
  if (duration && duration->count() < 0) return base::Error::out_of_range;
  return duration;
}

}  // namespace

base::Duration duration_option(std::string_view option, const std::string& text) {
  const auto duration = parse_length_of_time(text);
  if (!duration)
    fail({fmt::format("{} {}: not a time", option, text), "write 500ms, 2s or 1.5s"}, exit_usage);
  return *duration;
}

std::uint32_t bit_rate_option(std::string_view text) {
  const auto rate = parse_bit_rate(text);
  if (!rate) fail({fmt::format("--bitrate {}: no bit rate of CAN", text), a_bit_rate}, exit_usage);
  return static_cast<std::uint32_t>(*rate);
}

Accepted accepted_duration() {
  return {ValueKind::text, false, "a time such as 500ms, 2s or 1.5s", {}, [](const std::string& text) {
            return static_cast<bool>(parse_length_of_time(text));
          }};
}

Accepted accepted_bit_rate() {
  return {ValueKind::text, true, a_bit_rate, {}, [](const std::string& text) {
            return static_cast<bool>(parse_bit_rate(text));
          }};
}

Accepted accepted_priority() {
  using protocol::Priority;
  std::vector<std::string> names;
  for (const auto each : {Priority::urgent, Priority::high, Priority::medium, Priority::low})
    names.emplace_back(name(each));
  return accepted_words(std::move(names));
}

}  // namespace ocm::cli
