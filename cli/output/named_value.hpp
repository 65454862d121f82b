/// The names that a spec gives to values.
#pragma once

#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "ocm/protocol/topic.hpp"

namespace ocm::cli {

/// Whether a raw number is this value; of flags whether this one is set in it.
[[nodiscard]] inline bool has_name(const protocol::Field& field, const protocol::NamedValue& value,
                                   std::int64_t raw) noexcept {
  return field.flags ? (raw >> value.raw & 1) != 0 : raw == value.raw;
}

/// Of a value that has one, or of the flags that are set in it; empty otherwise.
[[nodiscard]] inline std::string names_of(const protocol::Field& field, std::int64_t raw) {
  std::string text;
  for (const auto& value : field.values) {
    if (!has_name(field, value, raw)) continue;
    if (!text.empty()) text += '|';
    text += value.name;
  }
  if (!text.empty() || !field.flags) return text;
  return raw == 0 ? "-" : fmt::format("0x{:X}", raw);
}

}  // namespace ocm::cli
