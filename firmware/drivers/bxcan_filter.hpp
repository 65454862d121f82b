/// Which frames interrupt a board: the commands to its own topics, at every priority, and nothing else. Taken
/// from the board's type in the generated header when the image is compiled, and packed into bxCAN's filter
/// banks, two masks of 16 bits in each; or, for a board that also overhears the others, one mask of 32 bits.
///
/// Topics that differ in one bit share a mask, so a filter never lets a foreign identifier through: `exact`
/// in tests/firmware/bxcan asks all 2048. Remote and extended frames pass none: RTR and IDE are in every
/// mask.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/can/frame.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

#include "firmware/drivers/bxcan_registers.hpp"

namespace ocm::firmware::drivers::bxcan {

/// A bank in mask mode. Of 16 bits: FxR1 is the first filter, FxR2 the second; identifier in the lower half,
/// mask in the upper. Of 32 bits: FxR1 is the identifier, FxR2 the mask. [RM0008 24.7.4, figure 231]
struct FilterBank {
  std::uint32_t fr1 = 0;
  std::uint32_t fr2 = 0;
  friend constexpr bool operator==(const FilterBank&, const FilterBank&) = default;
};

/// All that a controller is to hear. No bank: nothing.
struct FilterBanks {
  std::array<FilterBank, filter_banks> banks{};
  std::size_t size = 0;
  /// Of 32 bits: these come before those of 16, whatever FIFO they lead to. Among filters of one scale the
  /// lower number comes first, and each FIFO has its own numbers. [RM0008 24.7.4, filter priority rules]
  bool wide = false;
  friend constexpr bool operator==(const FilterBanks&, const FilterBanks&) = default;

  /// What the controller decides, for a frame that does not come from the bus. O(banks). [RM0008 figure 231]
  [[nodiscard]] constexpr bool accepts(const can::Frame& frame) const noexcept {
    const bool extended = can::is_extended(frame.format);
    const bool remote = can::is_remote(frame.format);
    const std::uint32_t have32 =
        (extended ? frame.id << 3 | 1U << 2 : frame.id << 21) | (remote ? 1U << 1 : 0U);
    const std::uint32_t have16 = (extended ? frame.id >> 18 : frame.id) << 5 | (remote ? 1U << 4 : 0U) |
                                 (extended ? 1U << 3 | (frame.id >> 15 & 7) : 0U);
    const auto passes = [have16](std::uint32_t filter) { return ((have16 ^ filter) & filter >> 16) == 0; };
    for (std::size_t i = 0; i < size; ++i) {
      const FilterBank& bank = banks[i];
      if (wide ? ((have32 ^ bank.fr1) & bank.fr2) == 0 : passes(bank.fr1) || passes(bank.fr2)) return true;
    }
    return false;
  }
};

/// Identifiers whose bits under `mask` are those of `id`.
struct BaseFilter {
  std::uint16_t id = 0;
  std::uint16_t mask = 0;
  [[nodiscard]] constexpr bool accepts(std::uint32_t identifier) const noexcept {
    return ((identifier ^ id) & mask) == 0;
  }
  friend constexpr bool operator==(const BaseFilter&, const BaseFilter&) = default;
};

namespace detail {

inline constexpr std::size_t most_filters = 2 * filter_banks;
inline constexpr std::uint16_t every_priority =
    can::max_base_id & ~(3U << 8);  ///< the direction and the topic must match

struct FilterSet {
  std::array<BaseFilter, 256> filters{};
  std::size_t size = 0;

  constexpr void add(BaseFilter filter) noexcept { filters[size++] = filter; }
  /// Joins pairs that differ in one bit until there are none: both accept together what their union does.
  constexpr void merge() noexcept {
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = i + 1; j < size; ++j) {
        const unsigned difference = filters[i].id ^ filters[j].id;
        if (filters[i].mask != filters[j].mask || (difference & (difference - 1)) != 0) continue;
        filters[i].mask = static_cast<std::uint16_t>(filters[i].mask & ~difference);
        filters[i].id = static_cast<std::uint16_t>(filters[i].id & ~difference);
        filters[j] = filters[--size];
        i = static_cast<std::size_t>(-1);  // what was joined may fit to what came before
        break;
      }
    }
  }
};

template <class Topic>
constexpr void add_commands(FilterSet& set) noexcept {
  for (std::size_t instance = 0; instance < Topic::instances; ++instance) {
    const protocol::TopicId topic{static_cast<std::uint8_t>(Topic::id.value + instance)};
    const protocol::Identifier command{protocol::Direction::command, protocol::Priority::urgent, topic};
    set.add({command.encode(), every_priority});
  }
}

template <class... Topics>
constexpr void add_commands(FilterSet& set, protocol::TopicList<Topics...>) noexcept {
  (add_commands<Topics>(set), ...);
}

/// STID in bits 15..5, RTR in 4, IDE in 3, then EXID 17..15. [RM0008 figure 231]
[[nodiscard]] constexpr std::uint32_t packed(BaseFilter filter) noexcept {
  const std::uint32_t id = std::uint32_t{filter.id} << 5;
  const std::uint32_t mask = std::uint32_t{filter.mask} << 5 | 1U << 4 | 1U << 3;
  return mask << 16 | id;
}

/// STID in bits 31..21, then EXID, IDE in 2, RTR in 1. [RM0008 figure 231]
[[nodiscard]] constexpr FilterBank wide_bank(BaseFilter filter) noexcept {
  return {std::uint32_t{filter.id} << 21, std::uint32_t{filter.mask} << 21 | 1U << 2 | 1U << 1};
}

}  // namespace detail

/// What a board must hear, before it is packed.
template <class Board>
[[nodiscard]] constexpr detail::FilterSet command_filters() noexcept {
  detail::FilterSet set;
  detail::add_commands(set, typename Board::sensors{});
  detail::add_commands(set, typename Board::actuators{});
  set.merge();
  return set;
}

/// The banks of a board. Does not compile when there are not enough of them.
template <class Board>
[[nodiscard]] consteval FilterBanks filter_banks_of() noexcept {
  constexpr detail::FilterSet set = command_filters<Board>();
  static_assert(set.size <= detail::most_filters, "more filters than the controller has");
  FilterBanks result;
  for (std::size_t i = 0; i < set.size; i += 2) {
    const BaseFilter second = set.filters[i + 1 < set.size ? i + 1 : i];  // a half that is free says it again
    result.banks[result.size++] = {detail::packed(set.filters[i]), detail::packed(second)};
  }
  return result;
}

/// The same for a board that also overhears the others (Bxcan::overhear): its own frames come first.
template <class Board>
[[nodiscard]] consteval FilterBanks wide_filter_banks_of() noexcept {
  constexpr detail::FilterSet set = command_filters<Board>();
  static_assert(set.size < filter_banks, "more filters than the controller has, with one for all else");
  FilterBanks result{.banks = {}, .size = set.size, .wide = true};
  for (std::size_t i = 0; i < set.size; ++i) result.banks[i] = detail::wide_bank(set.filters[i]);
  return result;
}

}  // namespace ocm::firmware::drivers::bxcan
