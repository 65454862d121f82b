#include "ocm/measure/recent_requests.hpp"

#include <chrono>

#include <catch2/catch.hpp>

namespace measure_recent_requests_test {

using namespace std::chrono_literals;
using namespace ocm::measure;
using ocm::base::Time;

/// A stream that is asked for `period` at `time`, and remembered.
void ask(RecentRequests& requests, Stream& stream, Time time, ocm::base::Duration period,
         std::size_t topic = 0) {
  requests.asked(topic, time, 1s, stream);
  stream.asked(time, period);
}

TEST_CASE("recent requests: the newest are undone, the rest stays") {
  RecentRequests requests;
  Stream stream;
  ask(requests, stream, Time{0ms}, 100ms);
  ask(requests, stream, Time{10ms}, 200ms);
  ask(requests, stream, Time{20ms}, 300ms);
  CHECK(requests.refused(1, Time{30ms}, 1, stream) == 0);  // of another topic
  CHECK(stream.timing(Time{30ms}).period_ns == 300'000'000);
  CHECK(requests.refused(0, Time{30ms}, 1, stream) == 1);
  CHECK(stream.timing(Time{30ms}).period_ns == 200'000'000);
  CHECK(requests.refused(0, Time{30ms}, 9, stream) == 2);
  CHECK(stream.timing(Time{30ms}).period_ns == 0);
  CHECK(requests.refused(0, Time{30ms}, 1, stream) == 0);
}

TEST_CASE("recent requests: samples that came meanwhile are in the stream without the request") {
  RecentRequests requests;
  Stream stream;
  stream.asked(Time{0ms}, 100ms);
  stream.sample(Time{100ms});
  ask(requests, stream, Time{150ms}, 1ms);
  for (const Time time : {Time{200ms}, Time{300ms}}) {
    stream.sample(time);
    requests.sample(0, time);
    requests.sample(1, time - 40ms);  // another topic's
  }
  CHECK(stream.timing(Time{300ms}).missing > 100);
  REQUIRE(requests.refused(0, Time{310ms}, 1, stream) == 1);
  const Timing timing = stream.timing(Time{310ms});
  CHECK(timing.count == 3);
  CHECK(timing.distances == 2);
  CHECK(timing.missing == 0);
  CHECK(timing.mean_ns == 100e6);
  CHECK(timing.since == Time{300ms});
}

TEST_CASE("recent requests: none is undone after its time, before it, or without one") {
  RecentRequests requests;
  Stream stream;
  ask(requests, stream, Time{2s}, 100ms);
  CHECK(requests.refused(0, Time{3s}, 1, stream) == 1);
  ask(requests, stream, Time{2s}, 100ms);
  CHECK(requests.refused(0, Time{3s + 1ns}, 1, stream) == 0);
  ask(requests, stream, Time{2s}, 100ms);
  CHECK(requests.refused(0, Time{1s - 1ns}, 1, stream) == 0);  // a clock was set back
  ask(requests, stream, Time{2s}, 100ms);
  CHECK(requests.refused(0, Time{1s}, 1, stream) == 1);  // by no more than that
  requests.asked(0, Time{2s}, 0s, stream);
  CHECK(requests.refused(0, Time{2s}, 1, stream) == 0);
  requests.asked(0, Time{2s}, 1ns, stream);
  CHECK(requests.refused(0, Time{2s}, 1, stream) == 1);
}

TEST_CASE("recent requests: of very many the oldest are forgotten") {
  RecentRequests requests;
  Stream stream;
  for (std::size_t i = 0; i <= RecentRequests::most; ++i) ask(requests, stream, Time{1ms}, 100ms, i);
  CHECK(requests.refused(0, Time{2ms}, 1, stream) == 0);
  CHECK(requests.refused(1, Time{2ms}, 1, stream) == 1);
  CHECK(requests.refused(RecentRequests::most, Time{2ms}, 1, stream) == 1);
}

}  // namespace measure_recent_requests_test
