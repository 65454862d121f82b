/// How a serial adapter is named, `/dev/ttyACM0@500k,115200`, and what can be chosen about it. Host only.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "ocm/base/text.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/slcan_codec.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/transport/serial_port.hpp"

namespace ocm::transport {

struct SlcanOptions {
  std::uint32_t bit_rate = 500'000;  ///< of the CAN bus: one of can::slcan::bit_rates
  std::uint32_t baud = 115'200;      ///< of the serial line; USB devices mostly ignore it
  /// How long an adapter has for its first answer, on a busy machine, too. One that says nothing at all is
  /// taken for one that never answers: what becomes of its frames is not known.
  base::Duration first_answer = std::chrono::seconds{1};
  /// How long to wait for each answer after that, while opening.
  base::Duration patience = std::chrono::milliseconds{300};
  std::size_t window = 8;  ///< frames that may wait for their answer
  /// After that long an answer is taken for lost.
  base::Duration answer_limit = std::chrono::milliseconds{500};
  base::Duration status_period = std::chrono::seconds{1};  ///< between two questions for the status flags
  /// How long the end of a bus waits for answers to what was sent.
  base::Duration farewell = std::chrono::milliseconds{300};
};

struct SlcanAddress {
  std::string path;
  SlcanOptions options;
};

namespace detail {

/// "500k", "1M", "125000"
[[nodiscard]] constexpr std::optional<std::uint32_t> parse_rate(std::string_view text) noexcept {
  std::uint64_t factor = 1;
  if (!text.empty() && (text.back() == 'k' || text.back() == 'K')) factor = 1000;
  if (!text.empty() && text.back() == 'M') factor = 1'000'000;
  if (factor != 1) text.remove_suffix(1);
  const auto number = base::parse_unsigned(text);
  if (!number || *number == 0 || *number > UINT32_MAX / factor) return std::nullopt;
  return static_cast<std::uint32_t>(*number * factor);
}

[[nodiscard]] inline std::string rate_text(std::uint32_t rate) {
  if (rate % 1'000'000 == 0) return std::to_string(rate / 1'000'000) + "M";
  if (rate % 1000 == 0) return std::to_string(rate / 1000) + "k";
  return std::to_string(rate);
}

}  // namespace detail

/// Reads `PATH[@BIT_RATE[,BAUD]]`, as in /dev/ttyACM0@500k,115200. The bit rate is the robot's 500k unless
/// said.
[[nodiscard]] inline host::Outcome<SlcanAddress> parse_slcan_address(std::string_view text) {
  static constexpr std::string_view form = "write slcan:/dev/ttyACM0@500k, or slcan:/dev/ttyUSB0@500k,57600";
  SlcanAddress address;
  const auto at = text.rfind('@');
  address.path = std::string(text.substr(0, at));
  if (address.path.empty())
    return host::Failure{"'slcan:" + std::string(text) + "' names no device", std::string(form)};
  if (at == std::string_view::npos) return address;
  std::string_view rates = text.substr(at + 1);
  const auto comma = rates.find(',');
  const std::string bit_rate{rates.substr(0, comma)};
  const auto rate = detail::parse_rate(bit_rate);
  if (!rate)
    return host::Failure{"'" + bit_rate + "' in 'slcan:" + std::string(text) + "' is not a bit rate",
                         std::string(form)};
  address.options.bit_rate = *rate;
  if (!can::slcan::bit_rate_code(*rate)) {
    std::string all;
    for (const std::uint32_t other : can::slcan::bit_rates)
      all += (all.empty() ? "" : ", ") + detail::rate_text(other);
    return host::Failure{"an SLCAN adapter has no bit rate " + bit_rate + ": only " + all,
                         "the nearest is " + detail::rate_text(can::slcan::nearest_bit_rate(*rate)) +
                             "; every node of a bus has the same, and the robot's is 500k"};
  }
  if (comma == std::string_view::npos) return address;
  const std::string baud_text{rates.substr(comma + 1)};
  const auto baud = detail::parse_rate(baud_text);
  if (!baud)
    return host::Failure{
        "'" + baud_text + "' in 'slcan:" + std::string(text) + "' is not a speed of a serial line",
        std::string(form)};
  address.options.baud = *baud;
  const std::uint32_t nearest = detail::nearest_serial_speed(*baud);
  if (nearest != *baud)
    return host::Failure{"a serial line has no speed " + baud_text + " here",
                         "the nearest is " + std::to_string(nearest) + "; USB adapters mostly ignore it"};
  return address;
}

}  // namespace ocm::transport
