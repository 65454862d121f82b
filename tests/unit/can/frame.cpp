#include "ocm/can/frame.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace can_frame_test {

using ocm::base::Error;
using ocm::can::arbitration_key;
using ocm::can::Format;
using ocm::can::Frame;
using ocm::can::validate;
using ocm::test::Random;

static_assert(sizeof(Frame) == 16);

TEST_CASE("a frame is valid when its identifier and length fit its format") {
  STATIC_REQUIRE(validate(Frame{}).ok());
  STATIC_REQUIRE(validate({0x7FF, 8, {}, Format::base}).ok());
  STATIC_REQUIRE(validate({0x800, 8, {}, Format::base}).error == Error::bad_identifier);
  STATIC_REQUIRE(validate({0x800, 0, {}, Format::base_remote}).error == Error::bad_identifier);
  STATIC_REQUIRE(validate({0x1FFF'FFFF, 0, {}, Format::extended}).ok());
  STATIC_REQUIRE(validate({0x1FFF'FFFF, 0, {}, Format::extended_remote}).ok());
  STATIC_REQUIRE(validate({0x2000'0000, 0, {}, Format::extended}).error == Error::bad_identifier);
  STATIC_REQUIRE(validate({0x1FFF'FFFF, 8, {}, Format::error}).ok());
  STATIC_REQUIRE(validate({0x2000'0000, 8, {}, Format::error}).error == Error::bad_identifier);
  STATIC_REQUIRE(validate({0, 9, {}, Format::base}).error == Error::bad_length);
  STATIC_REQUIRE(validate({0, 255, {}, Format::base_remote}).error == Error::bad_length);
}

TEST_CASE("a frame's bytes are as many as its length says; a remote frame has none") {
  const Frame frame{0x205, 4, {1, 0x84, 3, 2}};
  CHECK(frame.bytes().size() == 4);
  CHECK(frame.bytes()[1] == 0x84);
  CHECK(Frame{}.bytes().empty());
  CHECK(Frame{0x205, 4, {}, Format::base_remote}.bytes().empty());
  CHECK(Frame{0x205, 4, {}, Format::extended_remote}.bytes().empty());
  CHECK(Frame{0x205, 8, {}, Format::error}.bytes().size() == 8);
}

TEST_CASE("frames are equal when everything is") {
  const Frame frame{0x205, 4, {1, 0x84, 3, 2}};
  CHECK(frame == Frame{0x205, 4, {1, 0x84, 3, 2}});
  CHECK_FALSE(frame == Frame{0x206, 4, {1, 0x84, 3, 2}});
  CHECK_FALSE(frame == Frame{0x205, 5, {1, 0x84, 3, 2}});
  CHECK_FALSE(frame == Frame{0x205, 4, {1, 0x84, 3, 3}});
  CHECK_FALSE(frame == Frame{0x205, 4, {1, 0x84, 3, 2}, Format::extended});
}

TEST_CASE("data frames with the identifier of another have its format, but are not remote") {
  using ocm::can::data_format;
  STATIC_REQUIRE(data_format(Format::base) == Format::base);
  STATIC_REQUIRE(data_format(Format::base_remote) == Format::base);
  STATIC_REQUIRE(data_format(Format::extended) == Format::extended);
  STATIC_REQUIRE(data_format(Format::extended_remote) == Format::extended);
  STATIC_REQUIRE(data_format(Format::error) == Format::error);
}

TEST_CASE("a view of a frame has what that has, and is none of CAN FD") {
  using ocm::can::FrameView;
  const Frame frame{0x1F33'4455, 3, {1, 2, 3}, Format::extended};
  const FrameView view{frame};
  CHECK(view.id == 0x1F33'4455);
  CHECK(view.format == Format::extended);
  CHECK_FALSE(view.fd);
  CHECK(view.bytes.size() == 3);
  CHECK(view.bytes.data() == frame.data.data());
  CHECK(FrameView{Frame{0x605, 3, {}, Format::base_remote}}.bytes.empty());
  CHECK(FrameView{}.id == 0);
  CHECK_FALSE(FrameView{}.fd);
}

// --- arbitration against the wire ---

/// The arbitration field as it is sent, '0' dominant. [ISO 11898-1, 6.4.2.3: base: identifier, RTR, then the
/// dominant IDE; extended: base identifier, SRR and IDE recessive, extension, RTR]
std::string arbitration_field(const Frame& frame) {
  const auto bits = [](std::uint32_t value, int width) {
    std::string text;
    while (width-- > 0) text += (value >> width & 1) != 0 ? '1' : '0';
    return text;
  };
  const bool remote = frame.format == Format::base_remote || frame.format == Format::extended_remote;
  const bool extended = frame.format == Format::extended || frame.format == Format::extended_remote;
  const char* rtr = remote ? "1" : "0";
  if (!extended) return bits(frame.id, 11) + rtr + "0";
  return bits(frame.id >> 18, 11) + "1" + "1" + bits(frame.id, 18) + rtr;
}

/// -1: a wins, 1: b wins, 0: neither drops out.
int arbitrate(const std::string& a, const std::string& b) {
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
    if (a[i] != b[i]) return a[i] == '0' ? -1 : 1;
  return 0;
}

TEST_CASE("keys order frames as the wire does") {
  Random random{1};
  const Format formats[] = {Format::base, Format::extended, Format::base_remote, Format::extended_remote};
  const auto any = [&] {
    Frame frame;
    frame.format = formats[random.below(4)];
    // Few base identifiers and extensions, so that frames often differ late.
    const std::uint32_t base_id = (random.below(4)) * 0x155;
    const std::uint32_t extension = random.below(3) == 0 ? 0x3'FFFF : random.below(3);
    frame.id = ocm::can::is_extended(frame.format) ? base_id << 18 | extension : base_id;
    return frame;
  };
  int ties = 0;
  for (int i = 0; i < 50'000; ++i) {
    const Frame a = any();
    const Frame b = any();
    const int wire = arbitrate(arbitration_field(a), arbitration_field(b));
    const auto key_a = arbitration_key(a);
    const auto key_b = arbitration_key(b);
    INFO(arbitration_field(a) << " against " << arbitration_field(b));
    REQUIRE((key_a < key_b ? -1 : key_a > key_b) == wire);
    // No node drops out only where both are the same to the last bit.
    if (wire == 0) {
      REQUIRE(arbitration_field(a) == arbitration_field(b));
      ++ties;
    }
  }
  CHECK(ties > 100);
}

TEST_CASE("data before remote, base before extended, whatever the extension") {
  constexpr auto key = [](std::uint32_t id, Format format) { return arbitration_key({id, 0, {}, format}); };
  STATIC_REQUIRE(key(0x123, Format::base) < key(0x123, Format::base_remote));
  STATIC_REQUIRE(key(0x123, Format::base_remote) < key(0x123 << 18, Format::extended));
  STATIC_REQUIRE(key(0x123 << 18, Format::extended) < key(0x123 << 18, Format::extended_remote));
  STATIC_REQUIRE(key(0x123 << 18 | 0x3'FFFF, Format::extended_remote) < key(0x124, Format::base));
  // Any command wins against any sensor frame, urgent against low. [Thesis 4.1]
  STATIC_REQUIRE(key(0x3FF, Format::base) < key(0x400, Format::base));
}

}  // namespace can_frame_test
