/// One number for all that two ends of a bus must agree on, so that a board can say which spec it was built
/// from, and a tool notices that it was another one.
#pragma once

#include <cstdint>

#include "ocm/protocol/topic.hpp"

namespace ocm::protocol {

/// The hash of what a catalogue says of the wire: identifiers, DLCs, where each field lies and what its bits
/// mean, who is asked and who is commanded, and the bit rate. Names, units as words, periods, sources and the
/// order of the topics in the spec do not count. FNV-1a, 32 bits; equal hashes of different specs are
/// possible (1 in 2^32), and no defence against an attack. Meant for compile time: 1 us a
/// field.
[[nodiscard]] constexpr std::uint32_t wire_hash(const Catalogue& catalogue) noexcept {
  // [FNV-1a: draft-eastlake-fnv, section 5: offset basis and prime for 32 bits]
  constexpr std::uint32_t basis = 0x811C9DC5;
  constexpr std::uint32_t prime = 0x01000193;
  const auto mix = [](std::uint32_t hash, std::uint64_t number) {
    for (int i = 0; i < 8; ++i, number >>= 8) hash = (hash ^ static_cast<std::uint8_t>(number)) * prime;
    return hash;
  };

  std::uint32_t sum = mix(basis, catalogue.bit_rate);
  for (const Topic& topic : catalogue.topics) {
    std::uint32_t hash = mix(mix(basis, topic.id.value), static_cast<std::uint64_t>(topic.kind));
    for (const FrameLayout& frame : topic.frames) {
      hash = mix(mix(hash, frame.id.value), frame.length);
      if (topic.is_message()) {
        hash = mix(hash, static_cast<std::uint64_t>(frame.address.by));
        hash = mix(mix(hash, frame.address.extended ? 1 : 0), frame.address.number);
      }
      for (const Field& field : frame.fields) {
        const Position p = field.position;
        hash = mix(mix(mix(hash, p.start), p.width), static_cast<std::uint64_t>(p.order));
        hash = mix(hash, field.is_signed ? 1 : 0);
        if (field.is_float()) hash = mix(hash, static_cast<std::uint64_t>(field.number));
        for (const base::Decimal number : {field.scale, field.offset}) {
          hash = mix(hash, static_cast<std::uint64_t>(number.digits));
          hash = mix(hash, static_cast<std::uint64_t>(std::int64_t{number.exponent}));
        }
      }
    }
    sum += hash;  // whatever the order of the topics
  }
  return sum;
}

}  // namespace ocm::protocol
