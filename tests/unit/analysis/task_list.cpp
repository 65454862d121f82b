#include "ocm/analysis/task_list.hpp"

#include <cstdint>
#include <string_view>
#include <type_traits>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace analysis_task_list_test {

using namespace ocm::analysis;

struct Quick {
  static constexpr std::string_view name = "quick";
  static constexpr bool own = true;
  static constexpr Task task{.cost = 1'001, .period = 10'000, .level = 0};
};
struct Gyroscope {
  static constexpr std::string_view name = "gyroscope";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 8'999, .period = 10'000, .blocking = 0, .level = 1};
};
struct TooMuch {
  static constexpr Task task{.cost = 9'000, .period = 10'000, .level = 1};
};

static_assert(schedulable<TaskList<Quick, Gyroscope>>);
static_assert(!schedulable<TaskList<Quick, TooMuch>>);
static_assert(
    std::is_same_v<first_late<TaskList<Quick, TooMuch>>, misses_its_deadline<TooMuch, unbounded, 10'000>>);
static_assert(schedulable<TaskList<>>);

struct Facts {
  using Tasks = TaskList<Quick, Gyroscope>;
  static constexpr std::int64_t blocking = 1'500;
  static constexpr std::uint32_t bus_percent = 40;
};
using Costs = CostsOf<Facts>;
// Rounded up to whole microseconds.
static_assert(Costs::own.size() == 1 && Costs::own[0].cost_us == 2 && Costs::own[0].period_us == 10);
static_assert(Costs::own[0].level == ocm::scheduling::Level::urgent);
static_assert(Costs::sample_us<amiro::Gyroscope> == 9);
static_assert(Costs::waits_us<amiro::Gyroscope> == 0 && Costs::own[0].waits_us == 0);
static_assert(Costs::blocking_us == 2 && Costs::bus_percent == 40);

// What they wait for less urgent ones is rounded down.
struct Patient {
  static constexpr std::string_view name = "gyroscope";
  static constexpr bool own = true;
  static constexpr Task task{.cost = 9'100, .period = 100'000, .level = 2, .waits = 4'900};
};
struct PatientFacts {
  using Tasks = TaskList<Patient>;
  static constexpr std::int64_t blocking = 0;
  static constexpr std::uint32_t bus_percent = 100;
};
static_assert(CostsOf<PatientFacts>::sample_us<amiro::Gyroscope> == 10);
static_assert(CostsOf<PatientFacts>::waits_us<amiro::Gyroscope> == 4);
static_assert(CostsOf<PatientFacts>::own[0].cost_us == 10 && CostsOf<PatientFacts>::own[0].waits_us == 4);

static_assert(CostsOf<PatientFacts>::blocking_us == 0);

/// A board of one task, in nanoseconds.
template <std::int64_t cost, std::int64_t waits, std::int64_t held>
struct OnlyFacts {
  struct Only {
    static constexpr std::string_view name = "gyroscope";
    static constexpr bool own = true;
    static constexpr Task task{.cost = cost, .period = 999'999, .level = 2, .waits = waits};
  };
  using Tasks = TaskList<Only>;
  static constexpr std::int64_t blocking = held;
  static constexpr std::uint32_t bus_percent = 100;
};
// Whole microseconds are those; a nanosecond more is one more, of what it waits for, and of a period, none.
using Whole = CostsOf<OnlyFacts<9'000, 4'000, 1'000>>;
static_assert(Whole::sample_us<amiro::Gyroscope> == 9 && Whole::own[0].cost_us == 9);
static_assert(Whole::waits_us<amiro::Gyroscope> == 4 && Whole::own[0].waits_us == 4);
static_assert(Whole::blocking_us == 1);
using More = CostsOf<OnlyFacts<9'001, 4'999, 1'001>>;
static_assert(More::sample_us<amiro::Gyroscope> == 10 && More::own[0].cost_us == 10);
static_assert(More::waits_us<amiro::Gyroscope> == 4 && More::own[0].waits_us == 4);
static_assert(More::blocking_us == 2 && More::own[0].period_us == 999);

TEST_CASE("A list finds its tasks by name") {
  CHECK(Facts::Tasks::cost_us("quick") == 2);
  CHECK(Facts::Tasks::cost_us("slow") == 0);
}

}  // namespace analysis_task_list_test
