/// What sentences are described with: who one is for, and each of its integers. sentences.hpp, which is
/// generated, has the descriptions.
///
/// No heap, constexpr.
#pragma once

#include <cstdint>
#include <string_view>

namespace ocm::mapper::link {

/// Who a sentence is for: the same letter means different things each way.
enum class Direction : std::uint8_t { to_robot, from_robot };

/// One integer of a sentence T: where it is kept, its unit, and the range outside which the sentence is
/// refused.
template <class T>
struct Field {
  std::int16_t T::*member;
  std::string_view name;
  std::string_view unit;
  std::int16_t min = INT16_MIN;
  std::int16_t max = INT16_MAX;
};

}  // namespace ocm::mapper::link
