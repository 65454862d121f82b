#include "ocm/can/any_frame.hpp"

#include <catch2/catch.hpp>

namespace can_any_frame_test {

using namespace ocm;
using base::Error;
using can::AnyFrame;
using can::Format;
using can::Frame;

constexpr AnyFrame fd(std::uint32_t id, std::uint8_t length, Format format = Format::base,
                      std::uint8_t flags = can::frame_flag::fd) {
  AnyFrame frame;
  frame.id = id;
  frame.format = format;
  frame.length = length;
  frame.flags = flags;
  return frame;
}

constexpr Frame classic{0x205, 4, {0x01, 0x84, 0x03, 0x02}};
static_assert(AnyFrame{classic}.classic() == classic && !AnyFrame{classic}.is_fd());
static_assert(AnyFrame{Frame{0x1F334455, 5, {}, Format::extended_remote}}.bytes().empty());
static_assert(AnyFrame{Frame{0x1F334455, 5, {}, Format::extended_remote}}.classic() ==
              Frame{0x1F334455, 5, {}, Format::extended_remote});
static_assert(!fd(1, 12).classic() && fd(1, 12).is_fd() && fd(1, 12).bytes().size() == 12);
static_assert(fd(1, 12).view().fd && fd(1, 12).view().bytes.size() == 12 && fd(1, 12).view().id == 1);

// DLC 9 to 15 [ISO 11898-1:2015, table of the DLC]
static_assert(can::fd_length(9) == 12 && can::fd_length(10) == 16 && can::fd_length(11) == 20 &&
              can::fd_length(12) == 24 && can::fd_length(13) == 32 && can::fd_length(14) == 48 &&
              can::fd_length(15) == 64);
static_assert(can::fd_length(0) == 0 && can::fd_length(8) == 8 && can::fd_length(16) == 64 &&
              can::fd_length(255) == 64);
static_assert(can::fd_dlc(0) == 0 && can::fd_dlc(8) == 8 && can::fd_dlc(9) == 9 && can::fd_dlc(12) == 9 &&
              can::fd_dlc(13) == 10 && can::fd_dlc(48) == 14 && can::fd_dlc(49) == 15 &&
              can::fd_dlc(64) == 15 && can::fd_dlc(65) == 15);

TEST_CASE("what a CAN FD frame is marked with, at one bit rate and at two") {
  STATIC_REQUIRE(ocm::can::fd_flags(false) == 4);  // [linux/can.h, CANFD_FDF]
  STATIC_REQUIRE(ocm::can::fd_flags(true) == 5);   // and CANFD_BRS
}

TEST_CASE("what a frame of either kind can be") {
  CHECK(can::validate(fd(0x7FF, 64)).ok());
  CHECK(can::validate(fd(0x1FFF'FFFF, 48, Format::extended)).ok());
  CHECK(can::validate(fd(0x123, 8, Format::base, can::frame_flag::all)).ok());
  CHECK(can::validate(AnyFrame{classic}).ok());
  CHECK(can::validate(AnyFrame{Frame{.id = 1, .dlc = 3, .format = Format::base_remote}}).ok());
  for (unsigned length = 0; length < 256; ++length)
    CHECK(can::validate(fd(1, static_cast<std::uint8_t>(length))).ok() ==
          (length <= 8 || length == 12 || length == 16 || length == 20 || length == 24 || length == 32 ||
           length == 48 || length == 64));
  CHECK(can::validate(fd(0x800, 0)).error == Error::bad_identifier);
  CHECK(can::validate(fd(0x2000'0000, 0, Format::extended)).error == Error::bad_identifier);
  for (const Format format : {Format::base_remote, Format::extended_remote, Format::error})
    CHECK(can::validate(fd(1, 0, format)).error == Error::bad_identifier);
  CHECK(can::validate(fd(1, 0, Format::base, 0x0C)).error == Error::bad_syntax);
  CHECK(can::validate(fd(1, 0, Format::base, can::frame_flag::bit_rate_switch)).error == Error::bad_syntax);
  CHECK(can::validate(fd(1, 12, Format::base, 0)).error == Error::bad_length);
}

TEST_CASE("a CAN FD frame arbitrates as a classic data frame does") {
  for (const std::uint32_t id : {0U, 0x123U, 0x7FFU}) {
    CHECK(can::arbitration_key(fd(id, 12)) == can::arbitration_key(Frame{.id = id}));
    CHECK(can::arbitration_key(fd(id, 12, Format::extended)) ==
          can::arbitration_key(Frame{.id = id, .format = Format::extended}));
  }
}

}  // namespace can_any_frame_test
