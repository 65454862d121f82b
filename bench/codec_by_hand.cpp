// What one would write without the library: a switch, shifts and casts, from the tables of the thesis.
#include "bench/codec.hpp"

namespace ocm::bench {

static inline std::int32_t int32_at(const std::uint8_t* d) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(d[0]) | static_cast<std::uint32_t>(d[1]) << 8 |
                                   static_cast<std::uint32_t>(d[2]) << 16 |
                                   static_cast<std::uint32_t>(d[3]) << 24);
}

std::uint64_t decode_by_hand(std::span<const can::Frame> frames) {
  std::uint64_t sum = 0;
  for (const can::Frame& frame : frames) {
    const std::uint8_t* d = frame.data.data();
    switch (frame.id & 0xFF) {
      case 0x01:    // motors: x, z
      case 0x02: {  // odometry, velocity: x, z
        const std::int32_t x = int32_at(d);
        const std::int32_t z = int32_at(d + 4);
        sum += weighted(x, z);
        break;
      }
      case 0x03: {  // odometry, pose: x and y of 24 bits, orientation
        std::int32_t x = d[0] | d[1] << 8 | d[2] << 16;
        std::int32_t y = d[3] | d[4] << 8 | d[5] << 16;
        if (x & 0x800000) x -= 0x1000000;
        if (y & 0x800000) y -= 0x1000000;
        const std::uint16_t orientation = static_cast<std::uint16_t>(d[6] | d[7] << 8);
        sum += weighted(x, y, orientation);
        break;
      }
      case 0x04: {  // floor
        const std::uint16_t s1 = static_cast<std::uint16_t>(d[0] | d[1] << 8);
        const std::uint16_t s2 = static_cast<std::uint16_t>(d[2] | d[3] << 8);
        const std::uint16_t s3 = static_cast<std::uint16_t>(d[4] | d[5] << 8);
        const std::uint16_t s4 = static_cast<std::uint16_t>(d[6] | d[7] << 8);
        sum += weighted(s1, s2, s3, s4);
        break;
      }
      case 0x05:
      case 0x06:
      case 0x07: {  // magnetometer, an axis a frame
        const std::int32_t field = int32_at(d);
        sum += weighted(field);
        break;
      }
      case 0x08:
      case 0x09: {  // gyroscope, accelerometer
        const std::int16_t x = static_cast<std::int16_t>(d[0] | d[1] << 8);
        const std::int16_t y = static_cast<std::int16_t>(d[2] | d[3] << 8);
        const std::int16_t z = static_cast<std::int16_t>(d[4] | d[5] << 8);
        sum += weighted(x, y, z);
        break;
      }
      case 0x1E: {  // power status
        const std::uint16_t minutes = static_cast<std::uint16_t>(d[2] | d[3] << 8);
        const std::int16_t power = static_cast<std::int16_t>(d[4] | d[5] << 8);
        sum += weighted(d[0], d[1], minutes, power);
        break;
      }
      case 0x1F:
      case 0x20:
      case 0x21:
      case 0x22:
      case 0x23:
      case 0x24:
      case 0x25:
      case 0x26:  // ring
        sum += weighted(static_cast<std::uint16_t>(d[0] | d[1] << 8));
        break;
      case 0x3C:
      case 0x3D:
      case 0x3E:
      case 0x3F:
      case 0x40:
      case 0x41:
      case 0x42:
      case 0x43:  // LEDs
        sum += weighted(d[0], d[1], d[2]);
        break;
      default:
        break;
    }
  }
  return sum;
}

std::uint64_t switch_alone(std::span<const can::Frame> frames) {
  std::uint64_t sum = 0;
  // The empty assembly keeps the compiler from replacing the jumps by a table of numbers.
  const auto count = [&sum](std::uint64_t number) {
    sum += number;
    asm volatile("" : "+r"(sum));
  };
  for (const can::Frame& frame : frames) {
    switch (frame.id & 0xFF) {
      case 0x01:
      case 0x02:
        count(1);
        break;
      case 0x03:
        count(2);
        break;
      case 0x04:
        count(3);
        break;
      case 0x05:
      case 0x06:
      case 0x07:
        count(4);
        break;
      case 0x08:
      case 0x09:
        count(5);
        break;
      case 0x1E:
        count(6);
        break;
      case 0x1F:
      case 0x20:
      case 0x21:
      case 0x22:
      case 0x23:
      case 0x24:
      case 0x25:
      case 0x26:
        count(7);
        break;
      case 0x3C:
      case 0x3D:
      case 0x3E:
      case 0x3F:
      case 0x40:
      case 0x41:
      case 0x42:
      case 0x43:
        count(8);
        break;
      default:
        break;
    }
  }
  return sum;
}

void encode_by_hand(std::span<const Numbers> numbers, can::Payload* frames) {
  for (const Numbers& n : numbers) {
    std::uint8_t* d = frames++->data();
    for (int i = 0; i < 8; ++i) d[i] = 0;
    switch (n.topic) {
      case 0x01:
      case 0x02: {
        const std::uint32_t x = static_cast<std::uint32_t>(n.field[0]);
        const std::uint32_t z = static_cast<std::uint32_t>(n.field[1]);
        d[0] = static_cast<std::uint8_t>(x);
        d[1] = static_cast<std::uint8_t>(x >> 8);
        d[2] = static_cast<std::uint8_t>(x >> 16);
        d[3] = static_cast<std::uint8_t>(x >> 24);
        d[4] = static_cast<std::uint8_t>(z);
        d[5] = static_cast<std::uint8_t>(z >> 8);
        d[6] = static_cast<std::uint8_t>(z >> 16);
        d[7] = static_cast<std::uint8_t>(z >> 24);
        break;
      }
      case 0x03: {
        std::int32_t x = n.field[0];  // what 24 bits do not hold must not come out with the other sign
        std::int32_t y = n.field[1];
        if (x < -0x800000) x = -0x800000;
        if (x > 0x7FFFFF) x = 0x7FFFFF;
        if (y < -0x800000) y = -0x800000;
        if (y > 0x7FFFFF) y = 0x7FFFFF;
        const std::uint16_t orientation = static_cast<std::uint16_t>(n.field[2]);
        d[0] = static_cast<std::uint8_t>(x);
        d[1] = static_cast<std::uint8_t>(x >> 8);
        d[2] = static_cast<std::uint8_t>(x >> 16);
        d[3] = static_cast<std::uint8_t>(y);
        d[4] = static_cast<std::uint8_t>(y >> 8);
        d[5] = static_cast<std::uint8_t>(y >> 16);
        d[6] = static_cast<std::uint8_t>(orientation);
        d[7] = static_cast<std::uint8_t>(orientation >> 8);
        break;
      }
      case 0x04:
        d[0] = static_cast<std::uint8_t>(n.field[0]);
        d[1] = static_cast<std::uint8_t>(n.field[0] >> 8);
        d[2] = static_cast<std::uint8_t>(n.field[1]);
        d[3] = static_cast<std::uint8_t>(n.field[1] >> 8);
        d[4] = static_cast<std::uint8_t>(n.field[2]);
        d[5] = static_cast<std::uint8_t>(n.field[2] >> 8);
        d[6] = static_cast<std::uint8_t>(n.field[3]);
        d[7] = static_cast<std::uint8_t>(n.field[3] >> 8);
        break;
      case 0x05:
      case 0x06:
      case 0x07:
        d[0] = static_cast<std::uint8_t>(n.field[0]);
        d[1] = static_cast<std::uint8_t>(n.field[0] >> 8);
        d[2] = static_cast<std::uint8_t>(n.field[0] >> 16);
        d[3] = static_cast<std::uint8_t>(n.field[0] >> 24);
        break;
      case 0x08:
      case 0x09:
        d[0] = static_cast<std::uint8_t>(n.field[0]);
        d[1] = static_cast<std::uint8_t>(n.field[0] >> 8);
        d[2] = static_cast<std::uint8_t>(n.field[1]);
        d[3] = static_cast<std::uint8_t>(n.field[1] >> 8);
        d[4] = static_cast<std::uint8_t>(n.field[2]);
        d[5] = static_cast<std::uint8_t>(n.field[2] >> 8);
        break;
      case 0x1E:
        d[0] = static_cast<std::uint8_t>(n.field[0]);
        d[1] = static_cast<std::uint8_t>(n.field[1]);
        d[2] = static_cast<std::uint8_t>(n.field[2]);
        d[3] = static_cast<std::uint8_t>(n.field[2] >> 8);
        d[4] = static_cast<std::uint8_t>(n.field[3]);
        d[5] = static_cast<std::uint8_t>(n.field[3] >> 8);
        break;
      case 0x1F:
      case 0x20:
      case 0x21:
      case 0x22:
      case 0x23:
      case 0x24:
      case 0x25:
      case 0x26:
        d[0] = static_cast<std::uint8_t>(n.field[0]);
        d[1] = static_cast<std::uint8_t>(n.field[0] >> 8);
        break;
      case 0x3C:
      case 0x3D:
      case 0x3E:
      case 0x3F:
      case 0x40:
      case 0x41:
      case 0x42:
      case 0x43:
        d[0] = static_cast<std::uint8_t>(n.field[0]);
        d[1] = static_cast<std::uint8_t>(n.field[1]);
        d[2] = static_cast<std::uint8_t>(n.field[2]);
        break;
      default:
        break;
    }
  }
}

}  // namespace ocm::bench
