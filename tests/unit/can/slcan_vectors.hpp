/// Lines of SLCAN and the frames that they are, typed by hand: for the codec, the host and the adapter.
#pragma once

#include <string_view>

#include "ocm/can/frame.hpp"

namespace ocm::test::slcan {

using can::Format;
using can::Frame;

struct Vector {
  std::string_view line;
  Frame frame;
};

inline constexpr Vector vectors[] = {
    // [CAN232 manual, commands t, r, T, R: their examples]
    {"t10021133\r", {0x100, 2, {0x11, 0x33}}},
    {"r1002\r", {0x100, 2, {}, Format::base_remote}},
    {"T0000010021133\r", {0x100, 2, {0x11, 0x33}, Format::extended}},
    {"R000001002\r", {0x100, 2, {}, Format::extended_remote}},
    // Magnetometer every 900 us, medium priority [Thesis 4.2]
    {"t205401840302\r", {0x205, 4, {0x01, 0x84, 0x03, 0x02}}},
    {"t0000\r", {0x000, 0, {}}},
    {"t7FF8FFFFFFFFFFFFFFFF\r", {0x7FF, 8, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}}},
    {"T1FFFFFFF80123456789ABCDEF\r",
     {0x1FFF'FFFF, 8, {0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF}, Format::extended}},
    {"r7FF8\r", {0x7FF, 8, {}, Format::base_remote}},
    {"R1FFFFFFF0\r", {0x1FFF'FFFF, 0, {}, Format::extended_remote}},
};

constexpr std::string_view body(std::string_view line) {
  return line.substr(0, line.size() - 1);
}

}  // namespace ocm::test::slcan
