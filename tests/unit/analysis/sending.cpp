#include "ocm/analysis/sending.hpp"

#include <algorithm>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace analysis_sending_test {

using namespace ocm::analysis;

// A grid alone, with its offset. A delay that is longer than the cycle is doubtful: the shorter one is safe.
static_assert(distance_of({.cycle = 10}) == Distance{10, true, true});
static_assert(distance_of({.cycle = 10, .delay = 30}) == Distance{10, true, true});
// A faster grid while it is active: the faster one, and no offset.
static_assert(distance_of({.cycle = 100, .fast_cycle = 20}) == Distance{20, true, false});
static_assert(distance_of({.fast_cycle = 20}) == Distance{20, true, false});
// On events, no two closer than the delay.
static_assert(distance_of({.delay = 5, .events = true}) == Distance{5, true, false});
static_assert(distance_of({.cycle = 100, .delay = 5, .events = true}) == Distance{5, true, false});
// Without a delay events come as they like: the grid is known, and does not cover them.
static_assert(distance_of({.cycle = 100, .events = true}) == Distance{100, false, false});
static_assert(distance_of({.events = true}) == Distance{0, false, false});
// No word of events: a delay alone is of a sporadic message. Nothing at all: nothing is known.
static_assert(distance_of({.delay = 5}) == Distance{5, true, false});
static_assert(distance_of({}) == Distance{});

/// When a sender that knows no formula sends: on its grid, after events, again while it repeats; each as soon
/// as the delay since the last one is over.
std::vector<std::int64_t> sent_by(const Sending& sending, std::int64_t until, ocm::test::Random& random) {
  std::vector<std::int64_t> times;
  std::int64_t due = sending.cycle > 0 ? random.below(static_cast<std::uint32_t>(sending.cycle)) : 0;
  std::int64_t fast_due = 0;
  std::uint32_t repetitions = 0;
  bool waits = false;
  for (std::int64_t now = 0; now < until; ++now) {
    if (sending.cycle > 0 && now == due) {
      waits = true;
      due += sending.cycle;
    }
    const bool calm = times.empty() || now - times.back() >= sending.fast_cycle;
    const bool happens = random.below(40) == 0;
    if (sending.events && happens) waits = true;
    // An active phase: a few frames on a faster grid, which the slow one goes on from.
    if (sending.fast_cycle > 0 && !sending.events && happens && repetitions == 0 && calm) {
      repetitions = 1 + random.below(4);
      fast_due = now;
    }
    if (repetitions > 0 && now == fast_due) {
      waits = true;
      --repetitions;
      fast_due += sending.fast_cycle;
      if (sending.cycle > 0) due = now + sending.cycle;
    }
    if (!waits || (!times.empty() && now - times.back() < sending.delay && sending.events)) continue;
    times.push_back(now);
    waits = false;
  }
  return times;
}

std::int64_t closest(const std::vector<std::int64_t>& times) {
  std::int64_t least = INT64_MAX;
  for (std::size_t i = 1; i < times.size(); ++i) least = std::min(least, times[i] - times[i - 1]);
  return least;
}

TEST_CASE("no two frames of a sender are closer than said, and some are as close; wrong rules are found") {
  ocm::test::Random random{1999};
  int checked = 0;
  int reached = 0;
  int grid_alone_is_wrong = 0;
  int uncovered_are_closer = 0;
  for (int round = 0; round < 600; ++round) {
    Sending sending;
    if (random.below(3) != 0) sending.cycle = 20 + random.below(60);
    sending.events = random.below(2) == 0;
    if (sending.events && random.below(3) != 0) sending.delay = 2 + random.below(15);
    if (!sending.events && sending.cycle > 0 && random.below(2) == 0)
      sending.fast_cycle = 3 + random.below(10);
    const Distance said = distance_of(sending);
    const std::int64_t seen = closest(sent_by(sending, 4'000, random));
    if (!said.covers_all) {
      uncovered_are_closer += sending.events && seen < std::max<std::int64_t>(sending.cycle, 2) ? 1 : 0;
      continue;
    }
    CAPTURE(round, sending.cycle, sending.fast_cycle, sending.delay, sending.events);
    ++checked;
    REQUIRE(seen >= said.shortest);
    reached += seen == said.shortest ? 1 : 0;
    grid_alone_is_wrong += sending.cycle > 0 && seen < sending.cycle ? 1 : 0;
    if (said.on_grid) REQUIRE(seen == sending.cycle);
  }
  CHECK(checked > 300);
  CHECK(reached > checked * 9 / 10);
  CHECK(grid_alone_is_wrong > 100);
  CHECK(uncovered_are_closer > 50);
}

}  // namespace analysis_sending_test
