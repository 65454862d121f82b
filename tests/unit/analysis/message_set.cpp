#include "ocm/analysis/message_set.hpp"

#include <array>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace analysis_message_set_test {

using namespace ocm;
using namespace ocm::analysis;

static_assert(Message{.period = 7}.due() == 7);
static_assert(Message{.period = 7, .deadline = 9}.due() == 9);

// 500 kbit/s: 2 us a bit. A rate that divides no second is rounded up, so that a bound stays one.
static_assert(bits_ns(135, 500'000) == 270'000);
static_assert(bits_ns(1, 666'667) == 1'500);
static_assert(bits_ns(2, 666'667) == 3'000);
static_assert(bits_ns(1, 3) == 333'333'334);
static_assert(bits_ns(unbounded, 1) == unbounded);

// CAN FD: 29 bits of 2 us and 160 of 200 ns; where both rates are one, all bits of it.
static_assert(bits_ns({29, 160}, 500'000, 5'000'000) == 58'000 + 32'000);
static_assert(bits_ns({29, 160}, 500'000, 500'000) == bits_ns(189, 500'000));
static_assert(bits_ns({1, 1}, 3, 7) == 333'333'334 + 142'857'143);

// E(t), with frames of 100 bits: a burst of 2, and one more after each 1000.
constexpr CanBus noisy{.bit = 1, .errors = {.burst = 2, .every = 1'000}};
static_assert(error_delay(noisy, 100, 1).value() == 2 * 131);
static_assert(error_delay(noisy, 100, 1'000).value() == 2 * 131);
static_assert(error_delay(noisy, 100, 1'001).value() == 3 * 131);
static_assert(error_delay({.bit = 8, .errors = {.burst = 1}}, 100, 1'000'000).value() == 31 * 8 + 100);
static_assert(error_delay({}, 100, 1'000'000).value() == 0);
static_assert(!error_delay({.bit = unbounded, .errors = {.burst = 1}}, 1, 1).ok());

static_assert(valid(CanBus{}) && valid(noisy));
static_assert(!valid(CanBus{.bit = -1}) && !valid(CanBus{.errors = {.burst = -1}}));
static_assert(!valid(CanBus{.errors = {.burst = 1, .every = -1}}));
static_assert(!valid(CanBus{.errors = {.burst = 0, .every = 5}}));  // faults, but no first one

constexpr std::array good{Message{.cost = 1, .period = 1}, Message{.cost = 2, .period = 9, .deadline = 1}};
static_assert(first_bad(good) == no_index);
static_assert(first_bad(std::array{good[0], Message{.cost = 1}}) == 1);
static_assert(first_bad(std::array{Message{.cost = 1, .period = 1, .offset = -1}, good[0]}) == 0);

// Each number by itself, the last one that means nothing.
constexpr bool means(std::int64_t cost, std::int64_t period, std::int64_t deadline, std::int64_t jitter,
                     std::int64_t offset) {
  const std::array set{
      Message{.cost = cost, .period = period, .deadline = deadline, .jitter = jitter, .offset = offset}};
  return first_bad(set) == no_index;
}
static_assert(means(1, 1, 1, 0, 0));
static_assert(!means(0, 1, 1, 0, 0) && !means(1, 0, 1, 0, 0) && !means(1, 1, 0, 0, 0));
static_assert(!means(1, 1, 1, -1, 0) && !means(1, 1, 1, 0, -1));
static_assert(valid(CanBus{.bit = 0}) && valid(CanBus{.errors = {.burst = 1, .every = 1}}));

// What a topic says of its frame, at another priority: 131 bits of 2 us.
constexpr Message pose =
    message_of(amiro::Odometry::frames[1], protocol::Direction::sensor, protocol::Priority::urgent,
               std::chrono::milliseconds{20}, {}, std::chrono::microseconds{5}, amiro::bit_rate);
static_assert(pose.cost == amiro::Odometry::frames[1].worst_bits[0] * 2'000);
static_assert(pose.period == 20'000'000 && pose.due() == 20'000'000 && pose.jitter == 5'000);
static_assert(pose.key == can::arbitration_key({.id = 0x403}));

static_assert(first_clash(std::array{Message{.key = 3}, Message{.key = 3}, Message{.key = 4}}) == 1);

TEST_CASE("a set is ordered as the bus arbitrates, and equal identifiers are noticed") {
  std::array<Message, 4> set{
      {{.cost = 1, .key = 5}, {.cost = 2, .key = 3}, {.cost = 3, .key = 5}, {.cost = 4, .key = 1}}};
  sort_by_key(set);
  CHECK(set[0].cost == 4);
  CHECK(set[1].cost == 2);
  CHECK(set[2].cost == 1);  // as they were
  CHECK(set[3].cost == 3);
  CHECK(first_clash(set) == 3);
  set[3].key = 6;
  CHECK(first_clash(set) == no_index);
  CHECK(first_clash({}) == no_index);
}

}  // namespace analysis_message_set_test
