/// Frames: as values, as text, and how long they take on the wire.
#include <cstdio>

#include "ocm/can/bit_timing.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"
#include "ocm/can/text.hpp"

using namespace ocm;

// Everything is constexpr: what holds here holds on the board, with nothing flashed.
constexpr can::Frame frame{0x205, 4, {0x01, 0x84, 0x03, 0x02}};
static_assert(can::to_text(frame) == "205#01840302");
static_assert(can::parse_frame("205#01840302").value == frame);

// The bit timing of an STM32F103 with 36 MHz on APB1, proved when it is compiled.
constexpr auto timing = can::find_bit_timing(36'000'000, 500'000, 833);
static_assert(timing.ok() && timing.value.bit_rate(36'000'000) == 500'000);

int main() {
  const unsigned bits = can::frame_bits(frame);
  std::printf("%.*s: %u bits with stuffing, %u us at 500 kbit/s; at most %u bits\n",
              static_cast<int>(can::to_text(frame).view().size()), can::to_text(frame).view().data(), bits,
              2 * bits, can::worst_frame_bits(frame.format, frame.dlc));
}
