/// The work that codec.cpp measures, once with the library and once in plain shifts: decode frames whose
/// identifiers come in random order and add up their fields; encode random fields into frames. Both are
/// compiled with the same flags and must give the same sums and frames.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/can/frame.hpp"

namespace ocm::bench {

/// What goes into one frame: the identifier's topic and at most four fields.
struct Numbers {
  std::uint8_t topic = 0;
  std::array<std::int32_t, 4> field{};
};

/// Topics of the AMiRo whose frames take part: all of them.
inline constexpr std::array<std::uint8_t, 26> topics{0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x08, 0x09,
                                                     0x1E, 0x1F, 0x20, 0x21, 0x22, 0x23, 0x24, 0x25, 0x26,
                                                     0x3C, 0x3D, 0x3E, 0x3F, 0x40, 0x41, 0x42, 0x43};

/// Fields in the order of the spec, weighted so that exchanged fields show.
constexpr std::uint64_t weighted(std::int64_t a, std::int64_t b = 0, std::int64_t c = 0,
                                 std::int64_t d = 0) noexcept {
  return static_cast<std::uint64_t>(a) + 3 * static_cast<std::uint64_t>(b) +
         5 * static_cast<std::uint64_t>(c) + 9 * static_cast<std::uint64_t>(d);
}
std::uint64_t decode_by_library(std::span<const can::Frame> frames);
std::uint64_t decode_by_hand(std::span<const can::Frame> frames);
/// The same switch over the identifiers with next to nothing in it: what finding out the topic costs by
/// itself.
std::uint64_t switch_alone(std::span<const can::Frame> frames);
/// With the catalogue, as a tool decodes that loaded its spec when it started.
std::uint64_t decode_by_catalogue(std::span<const can::Frame> frames);

/// `frames` has as many elements as `numbers`.
void encode_by_library(std::span<const Numbers> numbers, can::Payload* frames);
void encode_by_hand(std::span<const Numbers> numbers, can::Payload* frames);

}  // namespace ocm::bench
