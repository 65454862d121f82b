/// The content that makes a CAN FD frame longest, made bit by bit. Tests only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/can/any_frame.hpp"

namespace ocm::test {

/// Each data bit goes on as the wire is, stuff bits included, so that five equal ones come as soon as can be.
inline can::AnyFrame with_longest_data(can::AnyFrame frame) {
  bool last = false;  // res; FDF before it is recessive
  unsigned run = 1;
  const auto put = [&](bool bit) {
    run = bit == last ? run + 1 : 1;
    last = bit;
  };
  const auto stuff = [&] {
    if (run != 5) return;
    last = !last;
    run = 1;
  };
  put((frame.flags & can::frame_flag::bit_rate_switch) != 0);
  put((frame.flags & can::frame_flag::error_state) != 0);
  for (unsigned i = 4; i-- > 0;) {
    stuff();
    put((can::fd_dlc(frame.length) >> i & 1) != 0);
  }
  for (std::size_t i = 0; i < frame.length; ++i) {
    frame.data[i] = 0;
    for (unsigned bit = 0x80; bit != 0; bit >>= 1) {
      stuff();
      if (last) frame.data[i] = static_cast<std::uint8_t>(frame.data[i] | bit);
      put(last);
    }
  }
  return frame;
}

}  // namespace ocm::test
