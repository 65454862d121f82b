#include "ocm/scheduling/cooperative.hpp"

#include <catch2/catch.hpp>

#include "unit/scheduling/conformance.hpp"

namespace scheduling_cooperative_test {

using namespace ocm;
using namespace std::chrono_literals;
using scheduling::Cooperative;
using scheduling::Level;

/// The loop that the header shows, in virtual time.
struct Loop {
  using Port = Cooperative;
  Port& port() { return cooperative; }
  void attach(std::function<void()> on_timer, std::function<void(Level)> on_level) {
    expire = std::move(on_timer);
    run = std::move(on_level);
  }
  void let_pass(base::Duration time) {
    const base::Time end = cooperative.now() + time;
    for (;;) {
      for (Level level; cooperative.take_pended(level);) run(level);
      if (cooperative.armed() > end) break;
      cooperative.advance(cooperative.armed());
      cooperative.arm(base::never);
      expire();
    }
    cooperative.advance(end);
  }
  void stop() {}
  static constexpr base::Duration slack{0};

  Cooperative cooperative;
  std::function<void()> expire;
  std::function<void(Level)> run;
};

constexpr bool the_most_urgent_level_is_taken_first() {
  Cooperative port;
  for (const Level level : {Level::low, Level::urgent, Level::medium}) port.pend(level);
  port.pend(Level::low);  // once is enough
  Level level{};
  for (const Level expected : {Level::urgent, Level::medium, Level::low})
    if (!port.pended() || !port.take_pended(level) || level != expected) return false;
  return !port.pended() && !port.take_pended(level);
}
static_assert(the_most_urgent_level_is_taken_first());

constexpr bool time_goes_forwards() {
  Cooperative port{base::Time{5s}};
  port.advance(base::Time{7s});
  port.advance(base::Time{6s});
  return port.now() == base::Time{7s};
}
static_assert(time_goes_forwards());

static_assert(sizeof(Cooperative) == 24);

TEST_CASE("the cooperative port is a port") {
  conformance::check<Loop>();
}

}  // namespace scheduling_cooperative_test
