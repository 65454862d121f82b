#include "ocm/can/any_text.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace can_any_text_test {

using namespace ocm;
using base::Error;
using can::AnyFrame;
using can::parse_any_frame;
using can::to_text;

std::string text(const AnyFrame& frame) {
  return std::string(to_text(frame).view());
}

// In the notation of cansend's manual: 123##1112233, and the identifier of eight digits.
TEST_CASE("CAN FD frames as text") {
  const auto frame = parse_any_frame("123##1DEAD");
  REQUIRE(frame);
  CHECK(frame->id == 0x123);
  CHECK(frame->format == can::Format::base);
  CHECK(frame->flags == (can::frame_flag::fd | can::frame_flag::bit_rate_switch));
  CHECK(frame->length == 2);
  CHECK(frame->data[0] == 0xDE);
  CHECK(frame->data[1] == 0xAD);
  CHECK(text(*frame) == "123##1DEAD");
  CHECK(text(*parse_any_frame("1f334455##3de.ad")) == "1F334455##3DEAD");
  CHECK(text(*parse_any_frame("123##0")) == "123##0");
  CHECK(text(*parse_any_frame("123##5")) == "123##1");  // FDF need not be given, and is not written
  CHECK(text(*parse_any_frame("205#01840302")) == "205#01840302");
  CHECK(text(*parse_any_frame("205#R3")) == "205#R3");
}

TEST_CASE("text that is no frame of either kind") {
  const auto refused = [](std::string_view wrong) {
    const auto frame = parse_any_frame(wrong);
    return frame.error;
  };
  for (const char* wrong : {"123##", "123##G", "123##R", "123##1D", "123##1D.", "123##1.DE.", "20000040##1",
                            "123#1##0", "123###", "##0"})
    CHECK(refused(wrong) != Error::none);
  CHECK(refused("12##0") == Error::bad_identifier);
  CHECK(refused("FFF##0") == Error::bad_identifier);
  CHECK(refused("123##0112233445566778899") == Error::bad_length);  // 9 bytes
  CHECK(refused("123##0" + std::string(130, 'A')) == Error::bad_length);
  CHECK(refused("123#112233445566778899") == Error::bad_length);
  CHECK(refused("123##1.DEAD") == Error::bad_syntax);
  CHECK(refused("123##1DE..AD") == Error::bad_syntax);
  // Kept as can-utils keep it, and no frame for a bus.
  CHECK(parse_any_frame("123##8").ok());
  CHECK(can::validate(*parse_any_frame("123##8")).error == Error::bad_syntax);
}

TEST_CASE("random frames of either kind come back from their text") {
  ocm::test::Random random{14};
  for (int i = 0; i < 2000; ++i) {
    AnyFrame frame;
    const bool extended = random.below(2) == 0;
    frame.format = extended ? can::Format::extended : can::Format::base;
    frame.id = static_cast<std::uint32_t>(random.below(extended ? can::max_extended_id + 1 : 0x800U));
    const bool fd = random.below(2) == 0;
    frame.length = fd ? can::fd_length(static_cast<unsigned>(random.below(16)))
                      : static_cast<std::uint8_t>(random.below(9));
    if (fd) frame.flags = static_cast<std::uint8_t>(can::frame_flag::fd | random.below(4));
    for (std::size_t k = 0; k < frame.length; ++k)
      frame.data[k] = static_cast<std::uint8_t>(random.below(256));
    CAPTURE(text(frame));
    REQUIRE(parse_any_frame(text(frame)) == base::Result<AnyFrame>{frame});
    REQUIRE_FALSE(to_text(frame).overflowed());
  }
}

}  // namespace can_any_text_test
