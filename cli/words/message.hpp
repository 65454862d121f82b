/// A plain message from its fields as people type them: what is not given is at its start value, and
/// selectors follow the fields that they select.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/decimal.hpp"
#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/j1939/transport.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/words/value.hpp"
#include "cli/words/word_error.hpp"

namespace ocm::cli::words {

/// A field that was given: its raw number, and at which word.
struct Given {
  std::int64_t raw = 0;
  std::size_t word = 0;
};
/// By the index of the field.
using GivenFields = std::vector<std::optional<Given>>;

namespace detail {

[[nodiscard]] constexpr std::uint64_t bits_of(const protocol::Field& field, std::int64_t raw) noexcept {
  const unsigned width = field.position.width;
  return static_cast<std::uint64_t>(raw) & (width < 64 ? (std::uint64_t{1} << width) - 1 : UINT64_MAX);
}

[[nodiscard]] inline bool selects(const protocol::Field& field, std::uint64_t bits) noexcept {
  for (const auto& range : field.selected)
    if (range.first <= bits && bits <= range.last) return true;
  return false;
}

/// A selector's bits as its raw number.
[[nodiscard]] constexpr std::int64_t raw_of(const protocol::Field& selector, std::uint64_t bits) noexcept {
  const unsigned unused = 64U - selector.position.width;
  return selector.is_signed ? static_cast<std::int64_t>(bits << unused) >> unused
                            : static_cast<std::int64_t>(bits);
}

/// "speed is there only with page=2"
[[nodiscard]] inline std::string presence(const protocol::Field& field, const protocol::Field& selector) {
  const auto value = [&selector](std::uint64_t bits) {
    const std::int64_t raw = raw_of(selector, bits);
    for (const auto& named : selector.values)
      if (named.raw == raw) return std::string{named.name};
    return physical_text(selector, raw);
  };
  std::string values;
  for (const auto& [first, last] : field.selected) {
    values += (values.empty() ? "" : ", ") + value(first);
    if (last != first) values += " to " + value(last);
  }
  return std::string{field.name} + " is there only with " + std::string{selector.name} + "=" + values;
}

/// A given field that the frame has not, or not as it was given.
[[nodiscard]] inline std::optional<WordError> not_as_given(const protocol::Topic& message, std::size_t index,
                                                           const GivenFields& given,
                                                           std::span<const std::uint8_t> data) {
  const protocol::FrameLayout& layout = message.frames[0];
  const protocol::Field& field = layout.fields[index];
  if (field.position.bytes() > layout.length)
    return WordError{given[index]->word,
                     std::string{field.name} + " ends in byte " + std::to_string(field.position.bytes() - 1) +
                         " of " + std::string{message.name} + ", which is sent with " +
                         std::to_string(layout.length) + (layout.length == 1 ? " byte" : " bytes"),
                     "leave it out, or state a longer message in the spec"};
  if (bits_of(field, field.raw(data)) == bits_of(field, given[index]->raw)) return std::nullopt;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const protocol::Field& other = layout.fields[i];
    if (i == index || !given[i] || !field.position.overlaps(other.position)) continue;
    std::vector<std::uint8_t> both(layout.length);
    // One that ends beyond the message is named in its turn.
    if (other.position.bytes() > both.size()) continue;
    protocol::put(std::span<std::uint8_t>{both}, other.position, given[i]->raw);
    protocol::put(std::span<std::uint8_t>{both}, field.position, given[index]->raw);
    if (bits_of(other, other.raw(std::span<const std::uint8_t>{both})) == bits_of(other, given[i]->raw))
      continue;
    return WordError{std::max(given[index]->word, given[i]->word),
                     std::string{field.name} + " and " + std::string{other.name} +
                         " have bits in common, and cannot be what both are given",
                     "give one of them, or values that are the same in these bits"};
  }
  return std::nullopt;
}

}  // namespace detail

/// Whether a number lies in the range that the field's source states; all do where none is stated.
[[nodiscard]] inline bool is_in_stated_range(const protocol::Field& field, std::int64_t raw) noexcept {
  if (field.min == field.max) return true;
  for (const auto& named : field.values)
    if (named.raw == raw) return true;  // a name is stated, too: "not available" lies beyond most ranges
  if (!field.is_float())
    if (const auto physical = field.physical(raw))
      return base::compare(field.min, *physical) <= 0 && base::compare(*physical, field.max) <= 0;
  const double value = field.value(raw);
  return field.min.as_double() <= value && value <= field.max.as_double();
}

/// What is wrong with a value that is not, and what helps.
[[nodiscard]] inline std::string beyond_stated_range(const protocol::Field& field, std::string_view text) {
  return detail::quoted(text) + " is beyond the stated range: " + detail::takes(field);
}
inline constexpr const char* force_beyond_range =
    "many stated ranges are wrong: --force takes what the bits can hold";

/// The message's bytes, as many as it has. A selector that is not given takes a value with which the given
/// fields are there, its start value if that is one. O(fields^2).
[[nodiscard]] inline base::Result<std::vector<std::uint8_t>, WordError> compose(
    const protocol::Topic& message, GivenFields given) {
  const protocol::FrameLayout& layout = message.frames[0];
  const auto too_long = [&](std::string_view kind, std::string_view remedy) {
    return WordError{1,
                     std::string{message.name} + " is a message of " + std::to_string(layout.length) +
                         " bytes" + std::string{kind},
                     std::string{remedy}};
  };
  if (layout.any_length()) {
    if (layout.length > j1939::most_transported)
      return too_long(" of J1939", "its transport protocol takes 1785 bytes at most");
  } else if (layout.fd && layout.length > can::max_fd_length) {
    return too_long(" in CAN FD", "a frame of CAN FD has 64 bytes at most");
  } else if (!layout.fd && layout.length > can::max_dlc) {
    return too_long("", "a classic frame has 8 bytes at most; state CAN FD in the spec");
  }
  const auto fields = layout.fields;
  std::vector<std::int64_t> raw(fields.size());
  const GivenFields typed = given;  // `given` gets the selectors that follow from them
  for (std::size_t i = 0; i < fields.size(); ++i) raw[i] = given[i] ? given[i]->raw : fields[i].start;

  for (std::size_t i = 0; i < fields.size(); ++i) {
    std::size_t at = i;
    if (!given[i]) continue;
    // A circle of selectors would be as long as there are fields.
    for (std::size_t depth = 0; depth < fields.size() && fields[at].selector < fields.size(); ++depth) {
      const std::size_t selector = fields[at].selector;
      const bool fits = detail::selects(fields[at], detail::bits_of(fields[selector], raw[selector]));
      if (!fits && (given[selector] || fields[at].selected.empty()))
        return WordError{
            given[i]->word, detail::presence(fields[at], fields[selector]),
            "give fields that are in one frame" +
                (typed[selector] ? ", or leave " + std::string{fields[selector].name} + " out" : "")};
      if (!fits) raw[selector] = detail::raw_of(fields[selector], fields[at].selected[0].first);
      given[selector] = Given{raw[selector], given[i]->word};  // decided now, for the fields that follow
      at = selector;
    }
  }

  const auto is_there = [&](std::size_t at) {
    for (std::size_t depth = 0; depth <= fields.size(); ++depth) {
      const std::size_t selector = fields[at].selector;
      if (selector >= fields.size()) return true;
      if (!detail::selects(fields[at], detail::bits_of(fields[selector], raw[selector]))) return false;
      at = selector;
    }
    return false;
  };
  std::vector<std::uint8_t> bytes(layout.length);
  // What is given comes last: many files have a field over others that are parts of it.
  const std::span<std::uint8_t> data{bytes};
  for (const bool of_given : {false, true})
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (given[i].has_value() == of_given && fields[i].position.bytes() <= layout.length && is_there(i))
        protocol::put(data, fields[i].position, raw[i]);
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (given[i])
      if (auto wrong = detail::not_as_given(message, i, given, data)) return *std::move(wrong);
  return bytes;
}

/// The frame of a message that fits into one, with the identifier with which it is sent.
[[nodiscard]] inline can::AnyFrame frame_of(const protocol::FrameLayout& layout,
                                            std::span<const std::uint8_t> bytes) {
  can::AnyFrame frame;
  frame.id = layout.address.number;
  frame.format = protocol::format_of(layout);
  frame.length = static_cast<std::uint8_t>(layout.length);
  if (layout.fd) {  // what a message does not fill of the frames that there are is zero
    frame.length = can::fd_length(can::fd_dlc(layout.length));
    frame.flags = can::fd_flags(layout.bit_rate_switch);
  }
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  return frame;
}

}  // namespace ocm::cli::words
