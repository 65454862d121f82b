// What one would write without the library: a switch, shifts and casts, from the DBC file.
#include "bench/messages.hpp"

namespace ocm::bench {
namespace {

std::uint16_t little16(const std::uint8_t* d) {
  return static_cast<std::uint16_t>(d[0] | d[1] << 8);
}
std::uint16_t big16(const std::uint8_t* d) {
  return static_cast<std::uint16_t>(d[0] << 8 | d[1]);
}
std::uint32_t little32(const std::uint8_t* d) {
  return static_cast<std::uint32_t>(d[0]) | static_cast<std::uint32_t>(d[1]) << 8 |
         static_cast<std::uint32_t>(d[2]) << 16 | static_cast<std::uint32_t>(d[3]) << 24;
}
/// Of 12 bits.
int signed12(int bits) {
  return (bits & 0x800) != 0 ? bits - 0x1000 : bits;
}

std::uint64_t service(const std::uint8_t* d) {
  switch (d[0]) {
    case 0:
      return weighted_sum(d[0], d[1], d[2], d[3] | d[4] << 8 | d[5] << 16);
    case 1:
      return weighted_sum(d[0], big16(d + 1), d[3], d[4] & 1);
    case 2:
      return weighted_sum(d[0], little32(d + 1));
    case 3:
      return weighted_sum(d[0], little32(d + 1), static_cast<std::int16_t>(little16(d + 5)));
    default:
      return weighted_sum(d[0]);
  }
}

}  // namespace

std::uint64_t decode_car_by_hand(std::span<const can::Frame> frames) {
  std::uint64_t sum = 0;
  for (const can::Frame& frame : frames) {
    const std::uint8_t* d = frame.data.data();
    switch (frame.id) {
      case 0x100:  // Engine
        sum += weighted_sum(little16(d), signed12(d[2] | (d[3] & 0xF) << 8), d[3] >> 4 | (d[4] & 0xF) << 4,
                            d[5], d[6] & 1, d[6] >> 1 & 1, d[7] >> 4);
        break;
      case 0x110: {  // Transmission
        const int gear = (d[0] >> 4) >= 8 ? (d[0] >> 4) - 16 : d[0] >> 4;
        sum += weighted_sum(d[0] & 7, gear, d[1], big16(d + 2));
        break;
      }
      case 0x120:  // Wheels
        sum += weighted_sum(big16(d), big16(d + 2), big16(d + 4), big16(d + 6));
        break;
      case 0x130:  // Driving
        sum += weighted_sum(big16(d), signed12(d[2] << 4 | d[3] >> 4), (d[3] & 0xF) << 8 | d[4], d[5] & 1,
                            d[5] >> 1 & 3, static_cast<std::int16_t>(big16(d + 6)));
        break;
      case 0x200:  // Doors
        sum += weighted_sum(d[0] & 1, d[0] >> 1 & 1, d[0] >> 2 & 1, d[0] >> 3 & 1, d[0] >> 4 & 1,
                            d[0] >> 5 & 1, d[1] & 0x7F);
        break;
      case 0x210:  // Lights
        sum += weighted_sum(d[0] & 3, d[0] >> 2 & 3, d[0] >> 4 & 1, d[0] >> 5 & 1, d[1]);
        break;
      case 0x220:  // LockCommand
        sum += weighted_sum(d[0] & 3, d[0] >> 4 & 3);
        break;
      case 0x300:  // Battery
        sum += weighted_sum(little16(d), static_cast<std::int16_t>(little16(d + 2)), d[4],
                            static_cast<std::int8_t>(d[5]), d[6] & 7);
        break;
      case 0x310:  // Trip, the bits of two floats
        sum += weighted_sum(little32(d), little32(d + 4));
        break;
      case 0x400:
        sum += service(d);
        break;
      default:
        break;
    }
  }
  return sum;
}

void encode_car_by_hand(std::span<const CarNumbers> numbers, can::Payload* frames) {
  const auto byte = [](std::int32_t number, int shift = 0) {
    return static_cast<std::uint8_t>(static_cast<std::uint32_t>(number) >> shift);
  };
  for (const CarNumbers& n : numbers) {
    const auto& f = n.field;
    std::uint8_t* d = frames++->data();
    for (int i = 0; i < 8; ++i) d[i] = 0;
    switch (n.id) {
      case 0x100:
        d[0] = byte(f[0]), d[1] = byte(f[0], 8);
        d[2] = byte(f[1]), d[3] = byte((f[1] >> 8 & 0xF) | f[2] << 4);
        d[4] = byte(f[2] >> 4 & 0xF), d[5] = byte(f[3]);
        d[6] = byte(f[4] | f[5] << 1), d[7] = byte(f[6] << 4);
        break;
      case 0x110:
        d[0] = byte(f[0] | f[1] << 4), d[1] = byte(f[2]), d[2] = byte(f[3], 8), d[3] = byte(f[3]);
        break;
      case 0x120:
        for (unsigned i = 0; i < 4; ++i) d[2 * i] = byte(f[i], 8), d[2 * i + 1] = byte(f[i]);
        break;
      case 0x130:
        d[0] = byte(f[0], 8), d[1] = byte(f[0]);
        d[2] = byte(f[1], 4), d[3] = byte((f[1] & 0xF) << 4 | f[2] >> 8), d[4] = byte(f[2]);
        d[5] = byte(f[3] | f[4] << 1), d[6] = byte(f[5], 8), d[7] = byte(f[5]);
        break;
      case 0x200:
        d[0] = byte(f[0] | f[1] << 1 | f[2] << 2 | f[3] << 3 | f[4] << 4 | f[5] << 5), d[1] = byte(f[6]);
        break;
      case 0x210:
        d[0] = byte(f[0] | f[1] << 2 | f[2] << 4 | f[3] << 5), d[1] = byte(f[4]);
        break;
      case 0x220:
        d[0] = byte(f[0] | f[1] << 4);
        break;
      case 0x300:
        d[0] = byte(f[0]), d[1] = byte(f[0], 8), d[2] = byte(f[1]), d[3] = byte(f[1], 8);
        d[4] = byte(f[2]), d[5] = byte(f[3]), d[6] = byte(f[4]);
        break;
      case 0x310:
        for (unsigned i = 0; i < 4; ++i)
          d[i] = byte(f[0], static_cast<int>(8 * i)), d[4 + i] = byte(f[1], static_cast<int>(8 * i));
        break;
      case 0x400:  // page 1
        d[0] = 1, d[1] = byte(f[0], 8), d[2] = byte(f[0]), d[3] = byte(f[1]), d[4] = byte(f[2]);
        break;
      default:
        break;
    }
  }
}

}  // namespace ocm::bench
