#include "cli/shared/values.hpp"

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"

#include "cli/shared/messages.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {

base::Duration duration_option(std::string_view option, const std::string& text) {
  const auto duration = words::parse_duration(text);
  if (!duration || duration->count() < 0)
    fail({fmt::format("{} {}: not a time", option, text), "write 500ms, 2s or 1.5s"}, exit_usage);
  return *duration;
}

std::uint32_t bit_rate_option(std::string_view text) {
  std::string_view digits = text;
  std::int64_t unit = 1;
  if (digits.ends_with('k') || digits.ends_with('K')) unit = 1000;
  if (digits.ends_with('M')) unit = 1'000'000;
  if (unit != 1) digits.remove_suffix(1);
  const auto number = base::parse_decimal(digits);
  const auto rate = number ? base::multiply(*number, {unit, 0}) : number;
  const auto whole = rate ? base::divide_rounded(*rate, {1, 0}) : base::Result<std::int64_t>{rate.error};
  // Bits a second, whole; classic CAN ends at a million.
  if (whole && *whole >= 1 && *whole <= 1'000'000 && base::compare(*rate, {*whole, 0}) == 0)
    return static_cast<std::uint32_t>(*whole);
  fail({fmt::format("--bitrate {}: no bit rate of CAN", text),
        "1 to 1000000 bits a second, such as 500k or 125000"},
       exit_usage);
}

}  // namespace ocm::cli
