#include "cli/shared/values.hpp"

#include <utility>

#include "ocm/base/decimal.hpp"
#include "ocm/protocol/identifier.hpp"

#include "cli/words/command.hpp"
#include "cli/words/quantity.hpp"
#include "generator/spec/model.hpp"

namespace ocm::cli {
namespace {

constexpr const char* a_data_bit_rate = "1 to 16000000 bits a second, such as 2M or 5000000";
constexpr const char* a_simulated_bit_rate = "1000 to 1000000000 bits a second, such as 500k or 125000";
constexpr const char* a_bit_rate = "1 to 1000000 bits a second, such as 500k or 125000";

base::Result<base::Duration, words::WordError> read_duration(std::string_view text) {
  const auto duration = words::parse_duration(text);
  if (duration && duration->count() >= 0) return *duration;
  return words::WordError{0, words::instead_of_time(text, "not a time"), "write 500ms, 2s or 1.5s"};
}

/// Bits a second, whole; 0: none, or more than `most`.
std::uint32_t bits_a_second(std::string_view digits, std::int64_t most) {
  std::int64_t unit = 1;
  if (digits.ends_with('k') || digits.ends_with('K')) unit = 1000;
  if (digits.ends_with('M')) unit = 1'000'000;
  if (unit != 1) digits.remove_suffix(1);
  const auto number = base::parse_decimal(digits);
  const auto rate = number ? base::multiply(*number, {unit, 0}) : number;
  const auto whole = rate ? base::divide_rounded(*rate, {1, 0}) : base::Result<std::int64_t>{rate.error};
  if (whole && *whole >= 1 && *whole <= most && base::compare(*rate, {*whole, 0}) == 0)
    return static_cast<std::uint32_t>(*whole);
  return 0;
}

/// Classic CAN, and what CAN FD begins with, ends at a million.
base::Result<std::uint32_t, words::WordError> read_bit_rate(std::string_view digits) {
  if (const std::uint32_t rate = bits_a_second(digits, 1'000'000); rate != 0) return rate;
  return words::WordError{0, "no bit rate of CAN", a_bit_rate};
}
base::Result<std::uint32_t, words::WordError> read_data_bit_rate(std::string_view digits) {
  if (const std::uint32_t rate = bits_a_second(digits, spec::max_data_bit_rate); rate != 0) return rate;
  return words::WordError{0, "no bit rate of the data of CAN FD", a_data_bit_rate};
}
base::Result<std::uint32_t, words::WordError> read_simulated_bit_rate(std::string_view digits) {
  if (const std::uint32_t rate = bits_a_second(digits, fastest_simulated_bit_rate); rate >= 1000) return rate;
  return words::WordError{0, "no bit rate of a simulated bus", a_simulated_bit_rate};
}

}  // namespace

Option add_duration(Verb verb, const std::string& names, base::Duration& value, const std::string& help) {
  const auto option = verb.add_value(names, take_into(value, read_duration), help);
  return option.type_name("T").takes(accepted_duration()).default_text(words::to_text(value));
}

Option add_duration(Verb verb, const std::string& names, std::optional<base::Duration>& value,
                    const std::string& help) {
  const auto option = verb.add_value(names, take_into(value, read_duration), help);
  return option.type_name("T").takes(accepted_duration());
}

Option add_lasting(Verb verb, const std::string& names, base::Duration& value, const std::string& help) {
  const auto option = verb.add_value(names, take_into(value, words::read_lasting), help);
  return option.type_name("T").takes(accepted_lasting()).default_text(words::to_text(value));
}

Option add_lasting(Verb verb, const std::string& names, std::optional<base::Duration>& value,
                   const std::string& help) {
  const auto option = verb.add_value(names, take_into(value, words::read_lasting), help);
  return option.type_name("T").takes(accepted_lasting());
}

Option add_priority(Verb verb, const std::string& names, std::optional<protocol::Priority>& value,
                    const std::string& help) {
  const auto option = verb.add_value(names, take_into(value, words::read_priority), help);
  return option.type_name("P").takes(accepted_priority());
}

Option add_bit_rate(Verb verb, const std::string& names, std::optional<std::uint32_t>& value,
                    const std::string& help) {
  const auto option = verb.add_value(names, take_into(value, read_bit_rate), help);
  return option.type_name("RATE").takes(accepted_bit_rate());
}

Option add_data_bit_rate(Verb verb, const std::string& names, std::optional<std::uint32_t>& value,
                         const std::string& help) {
  const auto option = verb.add_value(names, take_into(value, read_data_bit_rate), help);
  return option.type_name("RATE").takes(
      {ValueKind::text, true, a_data_bit_rate, {}, [](const std::string& text) {
         return static_cast<bool>(read_data_bit_rate(text));
       }});
}

Option add_simulated_bit_rate(Verb verb, const std::string& names, std::uint32_t& value,
                              const std::string& help) {
  const auto option = verb.add_value(names, take_into(value, read_simulated_bit_rate), help);
  return option.type_name("RATE").takes(
      {ValueKind::text, true, a_simulated_bit_rate, {}, [](const std::string& text) {
         return static_cast<bool>(read_simulated_bit_rate(text));
       }});
}

namespace {
/// A time that `read` takes.
template <class Read>
Accepted accepted_time(Read read) {
  return {ValueKind::text, false, "a time such as 500ms, 2s or 1.5s", {}, [read](const std::string& text) {
            return static_cast<bool>(read(text));
          }};
}
}  // namespace

Accepted accepted_duration() {
  return accepted_time(read_duration);
}

Accepted accepted_lasting() {
  return accepted_time(words::read_lasting);
}

Accepted accepted_every() {
  return accepted_time(words::read_every);
}

Accepted accepted_bit_rate() {
  return {ValueKind::text, true, a_bit_rate, {}, [](const std::string& text) {
            return static_cast<bool>(read_bit_rate(text));
          }};
}

Accepted accepted_priority() {
  return {ValueKind::text,
          true,
          "urgent, high, medium or low, or 0 to 3",
          {"urgent", "high", "medium", "normal", "low", "0", "1", "2", "3"},
          {}};
}

}  // namespace ocm::cli
