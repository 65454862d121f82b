/// Names of the spec as names in C++.
#pragma once

#include <string>
#include <string_view>

#include "generator/spec/edit_distance.hpp"

namespace ocm::spec {

/// Lower-case letters, digits and single underscores, a letter first, no underscore last: "sensor_1".
[[nodiscard]] bool is_name(std::string_view text) noexcept;

/// A name as DBC files have them: no blank, and no character that means something there.
[[nodiscard]] bool is_word(std::string_view text) noexcept;

/// A word that C++ keeps for itself, or that a compiler defines as a macro.
[[nodiscard]] bool is_reserved(std::string_view name) noexcept;

/// "di_wheel_drive" -> "DiWheelDrive".
[[nodiscard]] std::string pascal_case(std::string_view name);

/// "deg/s" -> "deg_per_s", "%" -> "percent"; empty where a character has no reading.
[[nodiscard]] std::string unit_name(std::string_view unit);

/// The nearest of `candidates` to what was typed, for "did you mean"; empty when none is near.
template <class Candidates>
[[nodiscard]] std::string nearest_name(std::string_view typed, const Candidates& candidates);

template <class Candidates>
std::string nearest_name(std::string_view typed, const Candidates& candidates) {
  std::string best;
  std::size_t best_distance = 1 + typed.size() / 3;
  for (const auto& candidate : candidates) {
    const std::size_t distance = edit_distance(typed, candidate, best_distance);
    if (distance <= best_distance && (best.empty() || distance < best_distance)) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

}  // namespace ocm::spec
