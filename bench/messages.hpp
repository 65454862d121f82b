/// The work that messages.cpp measures: decode frames of a small car (examples/small_car.dbc), whose
/// identifiers come in random order, and add up their raw numbers; make frames of raw numbers. Once with the
/// header that is generated of the DBC file, and once in plain shifts. Both are compiled with the same flags
/// and must give the same sums and frames.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/can/frame.hpp"

namespace ocm::bench {

/// All classic messages.
inline constexpr std::array<std::uint16_t, 10> identifiers{0x100, 0x110, 0x120, 0x130, 0x200,
                                                           0x210, 0x220, 0x300, 0x310, 0x400};

/// What goes into one frame. Each number is within what its field holds.
struct CarNumbers {
  std::uint16_t id = 0;
  std::array<std::int32_t, 7> field{};
};

/// Fields in the order of the file, weighted so that exchanged fields show.
template <class... Raw>
constexpr std::uint64_t weighted_sum(Raw... raw) noexcept {
  std::uint64_t weight = 1, sum = 0;
  ((sum += weight * static_cast<std::uint64_t>(static_cast<std::int64_t>(raw)), weight += 2), ...);
  return sum;
}

std::uint64_t decode_car_by_hand(std::span<const can::Frame> frames);
std::uint64_t decode_car_by_library(std::span<const can::Frame> frames);
/// Without a jump that depends on the frame: rows of shifts and masks, found by the identifier, eight a
/// frame.
std::uint64_t decode_car_by_table(std::span<const can::Frame> frames);
/// The same, four rows a step. Where `has_vectors()`: the processor has AVX2.
std::uint64_t decode_car_by_vectors(std::span<const can::Frame> frames);
bool has_vectors();

/// `frames` has as many elements as `numbers`.
void encode_car_by_hand(std::span<const CarNumbers> numbers, can::Payload* frames);
void encode_car_by_library(std::span<const CarNumbers> numbers, can::Payload* frames);

}  // namespace ocm::bench
