// The wire as static_asserts, from the request to the frame and back: what holds here holds on every compiler
// that reads this file, the boards' among them, with nothing flashed. Typed by hand; [T] is the thesis,
// section or figure.
#include <array>
#include <chrono>
#include <cstdint>

#include "ocm/base/decimal.hpp"
#include "ocm/can/bit_timing.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"
#include "ocm/can/text.hpp"
#include "ocm/controller/watchdog.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/scheduling/publisher.hpp"
#include "ocm/topics/amiro.hpp"

namespace {

using namespace ocm;
using namespace std::chrono_literals;
using can::Frame;
using can::Payload;
using protocol::Priority;
using protocol::TopicId;

// Requests. [T 4.2]
static_assert(*protocol::publish_every(TopicId{0x05}, 900us) == Frame{0x205, 4, {0x01, 0x84, 0x03, 0x02}});
static_assert(*protocol::publish_every(TopicId{0x08}, 500ms, Priority::high) ==
              Frame{0x108, 4, {0x01, 0xF4, 0x01, 0x00}});
static_assert(protocol::encode_default_publish(TopicId{0x05}) == Frame{0x205, 1, {0x01}});
static_assert(protocol::once(TopicId{0x04}) == Frame{0x204, 1, {0x02}});
static_assert(protocol::stop(TopicId{0x05}) == Frame{0x205, 1, {0x00}});
static_assert(protocol::publish_every(TopicId{0x05}, 0s).error == base::Error::bad_period);
static_assert(protocol::publish_every(TopicId{0x05}, 65'536ms).error == base::Error::bad_period);
static_assert(protocol::Period::nearest(65'536ms).duration() == 65'535ms);
static_assert(protocol::decode_request({0x205, 4, {0x01, 0x84, 0x03, 0x02}})->period.duration() == 900us);
static_assert(protocol::decode_request({0x205, 1, {0x03}}).error == base::Error::bad_mode);
static_assert(protocol::decode_request({0x205, 2, {0x01, 0x01}}).error == base::Error::bad_length);

// Samples as the thesis's receiver printed them. [T figures 6.3, 7.2]
static_assert(protocol::sample_frame(amiro::Gyroscope{62, 30, -4}) ==
              Frame{0x608, 6, {0x3E, 0x00, 0x1E, 0x00, 0xFC, 0xFF}});
static_assert(amiro::Accelerometer::decode(Payload{0x1A, 0x00, 0xFE, 0xFF, 0x00, 0x04}).z_g() == 1.0);
static_assert(protocol::sample_frame(amiro::Magnetometer{{53'760}, {-939'520}, {1'523'200}}, Priority::medium,
                                     1) == Frame{0x606, 4, {0x00, 0xAA, 0xF1, 0xFF}});
static_assert(amiro::PowerStatus::decode(Payload{0x00, 52, 137, 0, 0x5E, 0xFC}).power == -930);
static_assert(amiro::OdometryPose::decode(Payload{0xC8, 0x09, 0x00, 0x66, 0x02, 0x00, 0x91, 0x06}) ==
              amiro::OdometryPose{2504, 614, 1681});

// Set points, and the eight LEDs that follow each other.
static_assert(protocol::command(amiro::Motors{50'000, -1}) ==
              Frame{0x201, 8, {0x50, 0xC3, 0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xFF}});
static_assert(protocol::command(amiro::Led{100, 50, 120}, Priority::medium, 5) ==
              Frame{0x240, 3, {100, 50, 120}});

// Fields of odd widths, both byte orders; what is too large becomes the bound.
template <class Bits, class T>
constexpr Payload put(T value) {
  Payload data{};
  Bits::put(data, value);
  return data;
}
using High12 = protocol::Bits<std::uint16_t, 7, 12, protocol::ByteOrder::big>;
using Low12 = protocol::Bits<std::uint16_t, 11, 12, protocol::ByteOrder::big>;
using Signed24 = protocol::Bits<std::int32_t, 24, 24>;
using Whole = protocol::Bits<std::int64_t, 0>;
static_assert(put<High12>(std::uint16_t{0xABC}) == Payload{0xAB, 0xC0});
static_assert(put<Low12>(std::uint16_t{0x123}) == Payload{0x00, 0x01, 0x23});
static_assert(put<Signed24>(std::int32_t{-1}) == Payload{0, 0, 0, 0xFF, 0xFF, 0xFF});
static_assert(put<Signed24>(std::int32_t{9'000'000}) == Payload{0, 0, 0, 0xFF, 0xFF, 0x7F});
static_assert(Whole::get(put<Whole>(INT64_MIN)) == INT64_MIN);

// Bit timing of the two chips. [RM0008 24.7.7, RM0090 32.7.7]
static_assert(can::BitTiming{3, 13, 2, 1}.bit_rate(36'000'000) == 500'000);
static_assert(can::BitTiming{3, 15, 3, 1}.bit_rate(42'000'000) == 500'000);
static_assert(can::find_bit_timing(36'000'000, 500'000).ok() &&
              can::find_bit_timing(42'000'000, 500'000).ok());

// Text, lengths, exact decimals: the same on 32 bits as on 64.
static_assert(can::to_text({0x205, 4, {0x01, 0x84, 0x03, 0x02}}) == "205#01840302");
static_assert(can::parse_frame("1F334455#DEADBEEF")->id == 0x1F33'4455);
static_assert(can::worst_frame_bits(can::Format::base, 8) == 135);  // [Davis, Burns, Bril, Lukkien 2007]
static_assert(*base::multiply({3, 0}, {175, -4}) == base::Decimal{525, -4});
static_assert(amiro::catalogue.find("gyro")->id == TopicId{0x08});

// Releases lie on a grid, however late they are taken; the watchdog fires once.
constexpr bool releases_lie_on_a_grid() {
  scheduling::Publisher<2> publisher;
  scheduling::Release due;
  const auto take = [&](scheduling::Level level, base::Time now) {
    if (!publisher.take_due(now, level, due)) return false;
    publisher.done(due.stream, now);
    return true;
  };
  publisher.start(0, 100ms, scheduling::Level::low, base::Time{5ms});
  publisher.start(1, 100ms, scheduling::Level::urgent, base::Time{5ms});
  if (publisher.due(base::Time{5ms}).levels != 0b1001) return false;
  if (!take(scheduling::Level::urgent, base::Time{5ms}) || due.stream != 1) return false;
  if (!take(scheduling::Level::low, base::Time{5ms}) || due.stream != 0) return false;
  if (take(scheduling::Level::low, base::Time{104ms}) || publisher.next_release() != base::Time{105ms})
    return false;
  publisher.stop(1);
  if (!take(scheduling::Level::low, base::Time{333ms}) || due.scheduled != base::Time{305ms} ||
      due.missed != 2)
    return false;
  return publisher.next_release() == base::Time{405ms};
}
static_assert(releases_lie_on_a_grid());

constexpr bool watchdog_fires_once() {
  controller::Watchdog watchdog{500ms};
  watchdog.feed(base::Time{1s});
  return !watchdog.expire(base::Time{1499ms}) && watchdog.expire(base::Time{1500ms}) &&
         !watchdog.expire(base::Time{2s});
}
static_assert(watchdog_fires_once());

}  // namespace
