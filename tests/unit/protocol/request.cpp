#include "ocm/protocol/request.hpp"

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"

#include "unit/base/random.hpp"

namespace protocol_request_test {

using namespace std::chrono_literals;
using ocm::base::Duration;
using ocm::base::Error;
using ocm::can::Format;
using ocm::can::Frame;
using ocm::protocol::decode_request;
using ocm::protocol::encode;
using ocm::protocol::Mode;
using ocm::protocol::Period;
using ocm::protocol::PeriodUnit;
using ocm::protocol::Priority;
using ocm::protocol::publish_every;
using ocm::protocol::Request;
using ocm::protocol::TopicId;
using ocm::test::Random;

constexpr Frame frame(const char* text) {
  return *ocm::can::parse_frame(text);
}

constexpr TopicId floor_proximity{0x04};
constexpr TopicId magnetometer{0x05};
constexpr TopicId gyroscope{0x08};

// --- vectors ---
// data[0] = mode 0 stop, 1 publish, 2 once; data[1..2] = period, little endian; data[3] = unit 0 ms, 1 s,
// 2 us. [Thesis 4.2, figure 4.2]

static_assert(*publish_every(magnetometer, 900us) == frame("205#01840302"));
static_assert(*publish_every(gyroscope, 500ms, Priority::high) == frame("108#01F40100"));
static_assert(*publish_every(gyroscope, 5s) == frame("208#01881300"));
static_assert(*publish_every(gyroscope, 100s) == frame("208#01640001"));
static_assert(ocm::protocol::once(floor_proximity) == frame("204#02"));
static_assert(ocm::protocol::stop(magnetometer) == frame("205#00"));
static_assert(ocm::protocol::encode_default_publish(magnetometer) == frame("205#01"));
static_assert(ocm::protocol::encode_default_publish(magnetometer, Priority::urgent) == frame("005#01"));

static_assert(*decode_request(frame("205#01840302")) ==
              Request{magnetometer, Mode::publish, {900, PeriodUnit::microseconds}});
static_assert(decode_request(frame("205#01840302"))->period.duration() == 900us);
static_assert(*decode_request(frame("204#02")) == Request{floor_proximity, Mode::once});
static_assert(*decode_request(frame("205#00")) == Request{magnetometer, Mode::stop});
static_assert(*decode_request(frame("305#00")) == Request{magnetometer, Mode::stop, {}, Priority::low});
// DLC 1: every 50 ms.
static_assert(*decode_request(frame("205#01")) == Request{magnetometer, Mode::publish});
static_assert(decode_request(frame("205#01"))->period.duration() == 50ms);

TEST_CASE("what is no request is refused with its cause") {
  struct Bad {
    const char* text;
    Error error;
  };
  const Bad table[] = {
      // mode
      {"205#03", Error::bad_mode},
      {"205#FF", Error::bad_mode},
      {"205#03840302", Error::bad_mode},
      // length
      {"205#", Error::bad_length},
      {"205#0000", Error::bad_length},
      {"205#00000000", Error::bad_length},
      {"205#0200", Error::bad_length},
      {"205#02840302", Error::bad_length},
      {"205#0184", Error::bad_length},
      {"205#018403", Error::bad_length},
      {"205#0184030200", Error::bad_length},
      {"205#0184030200000000", Error::bad_length},
      // unit
      {"205#01840303", Error::bad_unit},
      {"205#018403FF", Error::bad_unit},
      {"205#01000003", Error::bad_unit},
      // period 0
      {"205#01000000", Error::bad_period},
      {"205#01000001", Error::bad_period},
      {"205#01000002", Error::bad_period},
      // no command, or no base data frame
      {"605#01840302", Error::bad_identifier},
      {"605#00", Error::bad_identifier},
      {"00000205#00", Error::bad_identifier},
      {"205#R", Error::bad_identifier},
      {"205#R1", Error::bad_identifier},
      {"00000205#R4", Error::bad_identifier},
      {"20000004#00", Error::bad_identifier},
  };
  for (const Bad& bad : table) {
    INFO(bad.text);
    CHECK(decode_request(frame(bad.text)).error == bad.error);
  }
  // Frames that no text can say.
  CHECK(decode_request({0x205, 9, {1}}).error == Error::bad_length);
  CHECK(decode_request({0xA05, 1, {0}}).error == Error::bad_identifier);
}

TEST_CASE("every request comes back from its frame") {
  Random random{1};
  for (int i = 0; i < 20'000; ++i) {
    Request request;
    request.topic = TopicId{static_cast<std::uint8_t>(random())};
    request.mode = static_cast<Mode>(random.below(3));
    request.priority = static_cast<Priority>(random.below(4));
    if (request.mode == Mode::publish)
      request.period = {static_cast<std::uint16_t>(1 + random.below(65535)),
                        static_cast<PeriodUnit>(random.below(3))};
    const Frame wire = encode(request);
    REQUIRE(ocm::can::validate(wire).ok());
    REQUIRE(decode_request(wire) == request);
  }
}

TEST_CASE("what is read from random bytes says the same when it is written") {
  Random random{2};
  int taken = 0;
  for (int i = 0; i < 200'000; ++i) {
    Frame wire{random.below(0x800), static_cast<std::uint8_t>(random.below(6)), {}};
    for (unsigned k = 0; k < wire.dlc; ++k) wire.data[k] = static_cast<std::uint8_t>(random.below(4));
    const auto request = decode_request(wire);
    if (!request) continue;
    ++taken;
    const bool names_no_period = wire.dlc == 1 && request->mode == Mode::publish;
    REQUIRE((names_no_period ? encode_default_publish(request->topic, request->priority)
                             : encode(*request)) == wire);
  }
  CHECK(taken > 10'000);
}

// --- periods ---

TEST_CASE("a period that the wire can carry is carried exactly, in milliseconds where it can be") {
  STATIC_REQUIRE(*Period::from(900us) == Period{900, PeriodUnit::microseconds});
  STATIC_REQUIRE(*Period::from(1us) == Period{1, PeriodUnit::microseconds});
  STATIC_REQUIRE(*Period::from(1ms) == Period{1, PeriodUnit::milliseconds});
  STATIC_REQUIRE(*Period::from(1500us) == Period{1500, PeriodUnit::microseconds});
  STATIC_REQUIRE(*Period::from(1500ms) == Period{1500, PeriodUnit::milliseconds});
  STATIC_REQUIRE(*Period::from(2s) == Period{2000, PeriodUnit::milliseconds});
  STATIC_REQUIRE(*Period::from(65535us) == Period{65535, PeriodUnit::microseconds});
  STATIC_REQUIRE(*Period::from(65535ms) == Period{65535, PeriodUnit::milliseconds});
  STATIC_REQUIRE(*Period::from(66s) == Period{66, PeriodUnit::seconds});
  STATIC_REQUIRE(*Period::from(65535s) == Period{65535, PeriodUnit::seconds});
}

TEST_CASE("a period that the wire cannot carry is refused, and the nearest is known") {
  struct Case {
    Duration wanted;
    Period nearest;
  };
  constexpr Period shortest{1, PeriodUnit::microseconds};
  constexpr Period longest{65535, PeriodUnit::seconds};
  const Case table[] = {
      {65536ms, {65535, PeriodUnit::milliseconds}},
      {0s, shortest},
      {1500ns, shortest},  // 1 us and 2 us are as near: the shorter
      {1501ns, {2, PeriodUnit::microseconds}},
      {1ns, shortest},
      {-1ns, shortest},
      {-1h, shortest},
      {Duration::min(), shortest},
      {65536us, {65535, PeriodUnit::microseconds}},
      {65535500us, {65535, PeriodUnit::milliseconds}},
      {65900500us, {66, PeriodUnit::seconds}},
      {1h + 1ms, {3600, PeriodUnit::seconds}},
      {65536s, longest},
      {24h * 365, longest},
      {Duration::max(), longest},
      // As far from 65535 us as from 66 ms, and from 65535 ms as from 66 s: the shorter.
      {65767500ns, {65535, PeriodUnit::microseconds}},
      {65767500us, {65535, PeriodUnit::milliseconds}},
  };
  for (const Case& c : table) {
    INFO(c.wanted.count() << " ns");
    CHECK(Period::from(c.wanted).error == Error::bad_period);
    CHECK(publish_every(gyroscope, c.wanted).error == Error::bad_period);
    CHECK(Period::nearest(c.wanted) == c.nearest);
    // What is offered can be asked for.
    CHECK(Period::from(Period::nearest(c.wanted).duration()).ok());
  }
}

TEST_CASE("every count of every unit is a period, and is its own nearest") {
  // Of two units that carry it, milliseconds.
  CHECK(Period::nearest(5ms) == Period{5, PeriodUnit::milliseconds});
  CHECK(Period::nearest(60s) == Period{60'000, PeriodUnit::milliseconds});
  for (const auto unit : {PeriodUnit::milliseconds, PeriodUnit::seconds, PeriodUnit::microseconds})
    for (unsigned count = 1; count <= UINT16_MAX; ++count) {
      const Period period{static_cast<std::uint16_t>(count), unit};
      const auto from = Period::from(period.duration());
      REQUIRE(from.ok());
      REQUIRE(from->duration() == period.duration());
      REQUIRE(Period::nearest(period.duration()).duration() == period.duration());
    }
}

/// Of all periods with this unit the one nearest to `wanted`, by halving the interval.
Duration nearest_of(PeriodUnit unit, Duration wanted) {
  std::uint16_t low = 1;
  std::uint16_t high = UINT16_MAX;
  while (high - low > 1) {
    const auto middle = static_cast<std::uint16_t>((low + high) / 2);
    (Period{middle, unit}.duration() <= wanted ? low : high) = middle;
  }
  const Duration below = Period{low, unit}.duration();
  const Duration above = Period{high, unit}.duration();
  return above - wanted < wanted - below ? above : below;
}

TEST_CASE("no period of any unit is nearer than the nearest, and none as near is shorter") {
  Random random{3};
  for (int i = 0; i < 50'000; ++i) {
    // 1 ns to 10^5 s
    const Duration wanted{1 + static_cast<std::int64_t>(random.word() >> (18 + random.below(46)))};
    const auto far = [&](Duration d) { return d > wanted ? d - wanted : wanted - d; };
    const Duration nearest = Period::nearest(wanted).duration();
    INFO(wanted.count() << " ns");
    for (const auto unit : {PeriodUnit::milliseconds, PeriodUnit::seconds, PeriodUnit::microseconds}) {
      const Duration other = nearest_of(unit, wanted);
      REQUIRE(far(nearest) <= far(other));
      if (far(nearest) == far(other)) REQUIRE(nearest <= other);
    }
    REQUIRE(Period::from(wanted).ok() == (nearest == wanted));
  }
}

}  // namespace protocol_request_test
