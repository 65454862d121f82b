#include "ocm/analysis/schedulable.hpp"

#include <array>
#include <type_traits>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace analysis_schedulable_test {

using namespace ocm;
using namespace ocm::analysis;

template <std::int64_t cost, std::int64_t deadline, std::uint32_t identifier>
struct Sent {
  static constexpr Message message{.cost = cost, .period = 1'000, .deadline = deadline, .key = identifier};
};

using First = Sent<100, 200, 1>;
using Second = Sent<100, 200, 2>;
using Third = Sent<100, 299, 3>;

static_assert(schedulable<Traffic<1>>);
static_assert(schedulable<Traffic<1, First>>);
// Whatever the order in which they are named: results are in that order, priorities are those of the keys.
static_assert(Traffic<1, Second, First>::results[0].response == 200);
static_assert(Traffic<1, Third, Second, First>::results[0].response == 300);
static_assert(Traffic<1, Third, Second, First>::results[1].response == 300);
static_assert(!schedulable<Traffic<1, First, Second, Third>>);
static_assert(std::is_same_v<first_late<Traffic<1, First, Third>>, all_meet_their_deadlines>);
static_assert(
    std::is_same_v<first_late<Traffic<1, Third, First, Second>>, misses_its_deadline<Third, 300, 299>>);
// Equal identifiers, and numbers that mean nothing.
static_assert(
    std::is_same_v<first_late<Traffic<1, First, First>>, misses_its_deadline<First, unbounded, 200>>);
using Twice = Traffic<1, First, Second, First>;  // both of it; the other one waits for both
static_assert(Twice::results[0].reason == Reason::bad_input && Twice::results[2].reason == Reason::bad_input);
static_assert(Twice::results[0].deadline == 200 && Twice::results[2].deadline == 200);
static_assert(Twice::results[1].response == 300);
// What delays one is a place among `Messages`, too: Third waits for First, and for Second no longer.
static_assert(Traffic<1, Third, Second, First>::results[0].largest == 2);
static_assert(Traffic<1, Sent<300, 900, 3>, Second, First>::results[2].blocked_by == 0);
// Each of two with one identifier has its own deadline.
static_assert(Traffic<1, First, Sent<100, 250, 1>>::results[0].deadline == 200);
static_assert(Traffic<1, First, Sent<100, 250, 1>>::results[1].deadline == 250);
static_assert(!schedulable<Traffic<1, Sent<0, 5, 1>>>);

// A frame of a topic, at the topic's own numbers: 131 bits of 2 us.
using Pose = TopicFrame<amiro::Odometry, amiro::bit_rate, 1>;
static_assert(Pose::message.cost == 131 * 2'000);
static_assert(Pose::message.period == amiro::Odometry::period.duration().count());
static_assert(Pose::message.deadline == amiro::Odometry::deadline.count());
static_assert(Pose::message.jitter == amiro::Odometry::jitter.count());
static_assert(Pose::message.key == can::arbitration_key({.id = 0x603}));
// The third LED, commanded each 20 ms.
using Led = TopicFrame<amiro::Led, amiro::bit_rate, 0, 3, 20'000'000>;
static_assert(Led::message.key == can::arbitration_key({.id = 0x23E}));
static_assert(Led::message.period == 20'000'000 && Led::message.due() == amiro::Led::deadline.count());
static_assert(schedulable<Traffic<2'000, Pose, Led>>);

// What boards send, all instances of their topics, in the order of the lists; sets can be joined.
using Boards = SentBy<amiro::bit_rate, amiro::DiWheelDrive, amiro::LightRing>;
static_assert(Boards::size == 12 + 3);  // two, three and two frames, and a frame of each other topic
static_assert(std::is_same_v<Boards::item<1>, FreshFrame<amiro::Odometry, amiro::bit_rate, 1>>);
static_assert(std::is_same_v<Boards::item<14>, FreshFrame<amiro::LightRingRefusal, amiro::bit_rate>>);
static_assert(SentBy<amiro::bit_rate>::size == 0);
struct EightLights {
  using sensors = protocol::TopicList<amiro::Led>;
};
static_assert(std::is_same_v<SentBy<500'000, EightLights>::item<7>, FreshFrame<amiro::Led, 500'000, 0, 8>>);
static_assert(std::is_same_v<decltype(Boards{} + Traffic<2'000, Led>{})::item<15>, Led>);
// Sent before the next one comes, whatever the deadline.
static_assert(FreshFrame<amiro::Led, 500'000, 0, 1, 20'000'000>::message.due() == 20'000'000);
static_assert(FreshFrame<amiro::Led, 500'000, 0, 1, 90'000'000>::message.due() ==
              amiro::Led::deadline.count());

// The worked example of docs/analysis.md: what DiWheelDrive sends at default periods, and set points each 100
// ms.
template <class Topic, std::size_t frame = 0>
using Sample = TopicFrame<Topic, amiro::bit_rate, frame>;
using SetPoint = TopicFrame<amiro::Motors, amiro::bit_rate, 0, 1, 100'000'000>;
using DiWheelDrive =
    Traffic<2'000, SetPoint, Sample<amiro::Odometry, 0>, Sample<amiro::Odometry, 1>,
            Sample<amiro::FloorProximity>, Sample<amiro::Magnetometer, 0>, Sample<amiro::Magnetometer, 1>,
            Sample<amiro::Magnetometer, 2>, Sample<amiro::Gyroscope>, Sample<amiro::Accelerometer>>;
static_assert(schedulable<DiWheelDrive>);
constexpr std::array<std::int64_t, 9> expected{1'526'000, 1'788'000, 2'050'000, 2'272'000, 2'452'000,
                                               2'634'000, 2'814'000, 3'036'000, 3'036'000};
static_assert([] {
  for (std::size_t i = 0; i < expected.size(); ++i)
    if (DiWheelDrive::results[i].response != expected[i]) return false;
  return true;
}());
static_assert(DiWheelDrive::results[0].blocking == 264'000 && DiWheelDrive::results[0].blocked_by == 3);

TEST_CASE("what is said of a set of types is what the analysis says of its messages") {
  const auto one = can_response_times(std::array{Led::message, Pose::message}, {.bit = 2'000});
  // Led is more urgent: the first of the analysis, and the second of the set.
  const auto in_the_set = [](Explained result) {
    for (std::size_t* place : {&result.blocked_by, &result.largest})
      if (*place != no_index) *place = 1 - *place;
    return result;
  };
  CHECK(Traffic<2'000, Pose, Led>::results[0] == in_the_set(one[1]));
  CHECK(Traffic<2'000, Pose, Led>::results[1] == in_the_set(one[0]));
}

}  // namespace analysis_schedulable_test
