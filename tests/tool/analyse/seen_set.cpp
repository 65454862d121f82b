// What a log says of a robot's topics: which are sent, and for which periods they were asked.
#include "cli/analyse/seen_set.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace tool_analyse_seen_set_test {

using namespace ocm;
using namespace ocm::cli::analyse;

struct Sent {
  int ms = 0;
  std::uint32_t id = 0;
  std::vector<std::uint8_t> bytes;
};

constexpr std::int64_t ms = 1'000'000;
const std::vector<std::uint8_t> six(6);

/// Requests of the gyroscope and of the behaviour. [spec/topics.json: 0x08 and 0x0D]
constexpr std::uint32_t of_gyroscope = 0x208, of_accelerometer = 0x209, of_behaviour = 0x20D;
/// What its board refuses. [spec/topics.json: 0x1D]
constexpr std::uint32_t of_refusals = 0x71D;

BusSet seen(const std::vector<Sent>& frames, std::vector<Rate> given = {}) {
  Arrivals log;
  for (const Sent& sent : frames) {
    can::Frame frame;
    frame.id = sent.id;
    frame.dlc = static_cast<std::uint8_t>(sent.bytes.size());
    std::copy(sent.bytes.begin(), sent.bytes.end(), frame.data.begin());
    log.all.push_back({sent.ms * ms, {}, frame.dlc, frame});
  }
  Paces paces;
  return seen_set(log, amiro::catalogue, nullptr, std::move(given), paces);
}

std::set<std::int64_t> periods(const BusSet& set) {
  std::set<std::int64_t> all;
  for (const BusEntry& entry : set.entries) all.insert(entry.period);
  return all;
}

using Periods = std::set<std::int64_t>;
using Remarks = std::vector<std::string>;

TEST_CASE("seen set: what ends a topic or asks for one sample of it asks for no period", "[shared]") {
  const auto set = seen({{0, of_gyroscope, {1, 20, 0, 0}},
                         {10, 0x608, six},
                         {30, 0x608, six},
                         {40, of_gyroscope, {0}},
                         {60, of_gyroscope, {2}},
                         {61, 0x608, six}});
  REQUIRE(set.entries.size() == 1);
  CHECK(set.entries[0].name == "gyroscope");
  CHECK(periods(set) == Periods{20 * ms});
  CHECK(set.remarks.empty());
  // Nor does one that cannot be read.
  CHECK(periods(seen({{0, of_gyroscope, {1, 20, 0, 0}}, {5, of_gyroscope, {3}}, {10, 0x608, six}})) ==
        Periods{20 * ms});
}

TEST_CASE("seen set: of several periods the shortest counts, whenever it was asked for", "[shared]") {
  const auto set = seen({{0, of_gyroscope, {1, 100, 0, 0}},
                         {10, of_gyroscope, {1, 20, 0, 0}},
                         {20, of_gyroscope, {1, 30, 0, 0}},
                         {25, of_gyroscope, {1, 20, 0, 0}},
                         {30, 0x608, six}});
  CHECK(periods(set) == Periods{20 * ms});
  CHECK(set.remarks == Remarks{"gyroscope was asked for every 100ms and every 20ms: the shorter one counts.",
                               "gyroscope was asked for every 20ms and every 30ms: the shorter one counts."});
}

TEST_CASE("seen set: the newest requests that a refusal can be of were never asked", "[shared]") {
  const std::vector<std::uint8_t> first{8, 15, 1, 0, 0, 0, 0, 0}, third{8, 15, 3, 0, 0, 0, 0, 0};
  const auto period = [](std::vector<Sent> frames) {
    frames.push_back({2000, 0x608, six});
    const auto set = seen(frames);
    const auto at = std::find_if(set.entries.begin(), set.entries.end(),
                                 [](const BusEntry& entry) { return entry.name == "gyroscope"; });
    REQUIRE(at != set.entries.end());
    return at->period;
  };
  const Sent slow{0, of_gyroscope, {1, 100, 0, 0}}, faster{10, of_gyroscope, {1, 30, 0, 0}},
      fastest{20, of_gyroscope, {1, 20, 0, 0}};
  CHECK(period({slow, faster, fastest}) == 20 * ms);
  CHECK(period({slow, faster, fastest, {30, of_refusals, first}}) == 30 * ms);
  // Where refusals are published one comes 1.1 s behind its request, at most.
  CHECK(period({slow, faster, fastest, {1120, of_refusals, first}}) == 30 * ms);
  CHECK(period({slow, faster, fastest, {1121, of_refusals, first}}) == 20 * ms);
  // Its count says how many there were since the one before.
  CHECK(period({{-5, of_refusals, first}, slow, faster, fastest, {30, of_refusals, third}}) == 100 * ms);
  CHECK(period({{-5, of_refusals, first}, faster, {30, of_refusals, third}}) == period({}));
}

TEST_CASE("seen set: who asks for no certain period has the topic's usual one", "[shared]") {
  const std::vector<std::uint8_t> eight(8);
  const auto set = seen({{0, of_behaviour, {1, 200, 0, 0}}, {10, of_behaviour, {1}}, {110, 0x60D, eight}});
  CHECK_FALSE(set.entries.empty());
  CHECK(periods(set) == Periods{100 * ms});
  CHECK(set.remarks ==
        Remarks{"behaviour was asked for every 200ms and every 100ms: the shorter one counts."});
}

TEST_CASE(
    "seen set: what was asked for and did not come is not in it, and has no place among what is left out",
    "[shared]") {
  const auto set = seen({{0, of_accelerometer, {1, 20, 0, 0}}, {10, 0x608, six}});
  REQUIRE(set.entries.size() == 1);
  CHECK(set.entries[0].name == "gyroscope");
  CHECK(set.left_out.empty());
}

TEST_CASE("seen set: a topic has the priority with which it came last", "[shared]") {
  const auto set = seen({{0, 0x608, six}, {50, 0x508, six}});
  REQUIRE(set.entries.size() == 1);
  CHECK(set.entries[0].head.id == 0x508);
}

TEST_CASE("seen set: a rate without a priority means that of the log, whatever one before it said",
          "[shared]") {
  Rate low, plain;
  low.name = "gyro";
  low.period = std::chrono::milliseconds{30};
  low.has_priority = true;
  low.priority = protocol::Priority::low;
  plain.name = "gyroscope";
  plain.period = std::chrono::milliseconds{20};
  const auto check = [](const std::vector<Rate>& given, std::uint32_t id, std::int64_t period) {
    const auto set = seen({{0, 0x508, six}, {50, 0x508, six}}, given);
    REQUIRE(set.entries.size() == 1);
    CHECK(set.entries[0].head.id == id);
    CHECK(set.entries[0].period == period);
  };
  check({low}, 0x708, 30 * ms);
  check({plain}, 0x508, 20 * ms);
  check({low, plain}, 0x508, 20 * ms);
  check({plain, low}, 0x708, 30 * ms);
}

}  // namespace tool_analyse_seen_set_test
