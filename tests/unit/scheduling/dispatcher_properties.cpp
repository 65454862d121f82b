// What a scheduling promises, over days and over random requests, in virtual time. The judge of the random
// runs is a model that keeps every grid point in a list and counts with its fingers: it divides nothing.
#include <algorithm>
#include <deque>
#include <map>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/scheduling/cooperative.hpp"
#include "ocm/scheduling/dispatcher.hpp"
#include "ocm/simulation/cpu.hpp"

#include "unit/base/explore.hpp"

namespace scheduling_dispatcher_properties_test {

using namespace ocm;
using namespace std::chrono_literals;
using scheduling::Cooperative;
using scheduling::Dispatcher;
using scheduling::Level;
using scheduling::Outcome;
using scheduling::Overload;
using scheduling::Release;
using simulation::compute;
using simulation::Cpu;
using simulation::JobRecord;
using simulation::Program;

constexpr base::Time at(base::Duration offset) {
  return base::Time{offset};
}
constexpr base::Duration day = 24h;
constexpr int effort = test::at_full_speed ? 10 : 1;

/// One stream, a timer that is served punctually, one day.
struct OneDay {
  Cooperative port{};
  Dispatcher<1, Cooperative> dispatcher{port};
  std::int64_t count = 0;
  base::Time last{};
  bool on_time = true;

  explicit OneDay(base::Duration period, base::Duration begin) {
    port.advance(at(begin));
    dispatcher.start(0, period, Level::medium, at(begin));
    for (;;) {
      for (Level level; port.take_pended(level);)
        dispatcher.run(level, [this](const Release& release) {
          ++count;
          on_time = on_time && release.scheduled == port.now() && !release.late;
          last = release.scheduled;
          return Outcome::done;
        });
      if (port.armed() > at(begin + day)) break;
      port.advance(port.armed());
      port.arm(base::never);
      dispatcher.expire();
    }
  }
};

TEST_CASE("a day without drift: the number of releases and the last one are exact") {
  std::vector<base::Duration> periods = {500ms, 800ms, 999'999us, 7s, 3'601s, 65'535s};
  if (effort > 1)  // 100 million releases
    periods.insert(periods.end(), {900us, 11ms, 50ms, 65'535us, 333'333us});
  for (const base::Duration period : periods) {
    for (const base::Duration begin : {base::Duration{0}, base::Duration{1'234'567'891ns}}) {
      if (period < 20ms && begin == 0ns) continue;
      CAPTURE(period.count(), begin.count());
      const OneDay run{period, begin};
      CHECK(run.count == day / period + 1);
      CHECK(run.last == at(begin + day / period * period));
      CHECK(run.on_time);
      CHECK(run.dispatcher.overload(0) == Overload{});
    }
  }
}

TEST_CASE("a day of a taker that sleeps: what is not served is counted, and the last one is exact") {
  std::mt19937 random{900};
  for (const base::Duration period :
       {base::Duration{1us}, base::Duration{900us}, base::Duration{50ms}, base::Duration{7s}}) {
    CAPTURE(period.count());
    std::uniform_int_distribution<std::int64_t> sleep{1, base::Duration{4s}.count()};
    Cooperative port;
    Dispatcher<1, Cooperative> dispatcher{port};
    dispatcher.start(0, period, Level::low, at(0ns));
    std::uint64_t served = 0;
    std::uint64_t missed = 0;
    base::Time last{};
    std::int64_t last_cell = -1;
    bool bunched = false;
    for (base::Time now{}; now < at(day);) {
      now = std::min(now + base::Duration{sleep(random)}, at(day));
      port.advance(now);
      Release release;
      if (!dispatcher.take(Level::low, release)) continue;
      ++served;
      missed += release.missed;
      last = release.scheduled;
      const std::int64_t cell = now.time_since_epoch() / period;
      bunched = bunched || cell == last_cell || release.scheduled != at(cell * period);
      last_cell = cell;
      dispatcher.done(0);
    }
    CHECK_FALSE(bunched);
    CHECK(last == at(day / period * period));
    CHECK(served + missed == static_cast<std::uint64_t>(day / period) + 1);
  }
}

/// The judge: all that a stream was asked for, grid point by grid point.
class Naive {
 public:
  void start(std::size_t s, base::Duration period, Level level, base::Time now) {
    Stream& stream = streams_[s];
    stream.period = period;
    stream.level = level;
    stream.points = {now};
  }
  void once(std::size_t s, Level level, base::Time now) {
    streams_[s].period = base::Duration{0};
    streams_[s].level = level;
    streams_[s].points = {now};
  }
  void stop(std::size_t s) { streams_[s].points.clear(); }

  /// What is to be taken at this level now, if anything.
  bool take(base::Time now, Level level, Release& release) {
    std::size_t best = streams_.size();
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      Stream& stream = streams_[s];
      if (stream.busy || stream.level != level || stream.points.empty() || stream.points[0] > now) continue;
      if (best == streams_.size() || stream.points[0] < streams_[best].points[0]) best = s;
    }
    if (best == streams_.size()) return false;
    Stream& stream = streams_[best];
    unroll(stream, now);
    release = {};
    release.stream = best;
    release.level = level;
    while (stream.points.size() > 1 && stream.points[1] <= now) {
      stream.points.pop_front();
      ++release.missed;
    }
    release.scheduled = stream.points[0];
    stream.points.pop_front();
    release.late = stream.period > 0ns && (release.missed > 0 || now > release.scheduled + jitter);
    stream.overload.missed += release.missed;
    stream.overload.late += release.late ? 1U : 0U;
    stream.busy = true;
    return true;
  }
  void hold(std::size_t s) { streams_[s].held = true; }
  void done(std::size_t s, base::Time now) {
    Stream& stream = streams_[s];
    if (stream.held && stream.period > 0ns && !stream.points.empty()) {
      unroll(stream, now);
      while (stream.points[0] <= now) {
        stream.points.pop_front();
        ++stream.overload.overrun;
      }
    }
    stream.busy = stream.held = false;
  }
  [[nodiscard]] Overload overload(std::size_t s, base::Time now) {
    Stream& stream = streams_[s];
    Overload result = stream.overload;
    if (stream.period == 0ns || stream.points.empty()) return result;
    unroll(stream, now);
    std::uint32_t passed = 0;
    for (const base::Time point : stream.points) passed += point <= now ? 1U : 0U;
    if (stream.held)
      result.overrun += passed;
    else
      result.missed += passed > 1 ? passed - 1 : 0;
    return result;
  }

  static constexpr base::Duration jitter = 2ms;

 private:
  struct Stream {
    std::deque<base::Time> points;  // to come, or passed and not taken
    base::Duration period{};        // zero: a single release
    Level level{};
    bool busy = false;
    bool held = false;
    Overload overload;
  };
  /// Grid points up to now, and one more.
  static void unroll(Stream& stream, base::Time now) {
    if (stream.period == 0ns) return;
    while (stream.points.back() <= now) stream.points.push_back(stream.points.back() + stream.period);
  }
  std::array<Stream, 5> streams_;
};

TEST_CASE("random requests, late takers, long jobs: every release is the one that the naive model has") {
  std::mt19937 random{20261121};
  const auto below = [&random](std::int64_t n) {
    return std::uniform_int_distribution<std::int64_t>{0, n - 1}(random);
  };
  std::uint64_t taken = 0;
  Overload seen;
  for (int run = 0; run < 20 * effort; ++run) {
    Cooperative port;
    Dispatcher<5, Cooperative> dispatcher{port};
    Naive naive;
    struct Running {
      std::size_t stream;
      base::Time request;  // the newest one when it was taken
    };
    std::map<Level, Running> running;  // a job a level
    std::vector<std::size_t> held;
    for (int step = 0; step < 2'000; ++step) {
      CAPTURE(run, step);
      // Most steps are short, some sleep over many periods.
      port.advance(port.now() + base::Duration{below(4) == 0 ? below(80'000'000) : below(4) * 500'000});
      const base::Time now = port.now();
      const auto stream = static_cast<std::size_t>(below(5));
      const auto level = static_cast<Level>(below(4));
      switch (below(12)) {
        case 0: {
          const base::Duration period{1'000'000 * (1 + below(40))};
          dispatcher.start(stream, period, level, now, Naive::jitter);
          naive.start(stream, period, level, now);
          break;
        }
        case 1:
          dispatcher.once(stream, level, now);
          naive.once(stream, level, now);
          break;
        case 2:
          dispatcher.stop(stream);
          naive.stop(stream);
          break;
        case 3:
        case 4:
        case 5:
          if (const auto job = running.find(level); job != running.end()) {
            const std::size_t which = job->second.stream;
            running.erase(job);
            if (below(3) == 0) {
              dispatcher.hold(which);
              naive.hold(which);
              held.push_back(which);
            } else {
              dispatcher.done(which);
              naive.done(which, now);
            }
          }
          break;
        case 6:
          if (!held.empty()) {
            dispatcher.done(held.back());
            naive.done(held.back(), now);
            held.pop_back();
          }
          break;
        default: {
          if (running.count(level) != 0) break;
          Release expected, release;
          const bool any = naive.take(now, level, expected);
          REQUIRE(dispatcher.take(level, release) == any);
          if (!any) break;
          REQUIRE(release == expected);
          running[level] = {release.stream, now};
          ++taken;
          break;
        }
      }
      REQUIRE(dispatcher.overload(stream) == naive.overload(stream, now));
    }
    for (std::size_t stream = 0; stream < 5; ++stream) {
      const Overload one = naive.overload(stream, port.now());
      seen = {seen.missed + one.missed, seen.late + one.late, seen.overrun + one.overrun};
    }
  }
  // The runs did meet what they are about.
  CHECK(taken > 3'000U * effort);
  CHECK(std::min({seen.missed, seen.late, seen.overrun}) > 100U * effort);
}

/// Random requests to jobs that take time, at all levels, on a processor that preempts them.
struct Requests {
  struct Request {
    base::Time time{};
    base::Duration period{};  // zero: stop
    Level level{};
  };
  Cpu cpu;
  Dispatcher<6, Cpu> dispatcher{cpu};
  std::mt19937 random;
  std::map<std::size_t, std::vector<Request>> requests;
  std::map<std::size_t, std::vector<JobRecord>> jobs;

  explicit Requests(unsigned seed)
      : cpu({5us, 2us, simulation::ResourceProtocol::inheritance}), random(seed) {
    const auto bus = cpu.add_resource();
    cpu.drive(
        dispatcher,
        [this, bus](const Release&) {
          return Program{compute(some(2'000)), simulation::lock(bus), compute(some(500)),
                         simulation::unlock(bus)};
        },
        [this](const JobRecord& job) { jobs[job.release.stream].push_back(job); });
    for (int i = 0; i < 300; ++i) ask(at(some(30'000'000)));
    cpu.run_until(at(31s));
  }
  base::Duration some(std::int64_t us) {
    return std::chrono::microseconds{std::uniform_int_distribution<std::int64_t>{1, us}(random)};
  }
  void ask(base::Time when) {
    const auto stream = static_cast<std::size_t>(some(6).count() / 1000 - 1);
    const auto level = static_cast<Level>(some(4).count() / 1000 - 1);
    const bool stop = some(5) == 1us;
    const base::Duration period = stop ? 0us : some(20'000);
    cpu.at(when, [this, stream, level, period] {
      const base::Time now = cpu.now();
      if (period == 0us)
        dispatcher.stop(stream);
      else
        dispatcher.start(stream, period, level, now);
      requests[stream].push_back({now, period, level});
    });
  }
};

TEST_CASE("never two starts in one period, none after a stop, and each on the grid of the newest request") {
  std::size_t starts = 0;
  for (unsigned seed = 1; seed <= 1U * effort; ++seed) {
    const Requests run{seed};
    CHECK(run.cpu.misuses() == 0);
    for (const auto& [stream, jobs] : run.jobs) {
      const auto& requests = run.requests.at(stream);
      base::Time last_end{};
      const Requests::Request* last_request = nullptr;
      std::int64_t last_cell = -1;
      for (const JobRecord& job : jobs) {
        CAPTURE(seed, stream, job.started.time_since_epoch().count());
        ++starts;
        REQUIRE(job.started >= last_end);  // never in two contexts
        last_end = job.ended;
        // The newest request when it was taken: its level, its phase, its period.
        const Requests::Request* newest = nullptr;
        for (const auto& request : requests)
          if (request.time <= job.started) newest = &request;
        REQUIRE(newest != nullptr);
        REQUIRE(newest->period > 0us);  // not stopped
        REQUIRE(job.release.level == newest->level);
        REQUIRE((job.release.scheduled - newest->time) % newest->period == 0ns);
        REQUIRE(job.release.scheduled <= job.started);
        REQUIRE(job.started - job.release.scheduled < newest->period);
        const std::int64_t cell = (job.started - newest->time) / newest->period;
        if (newest == last_request) REQUIRE(cell > last_cell);
        last_request = newest;
        last_cell = cell;
      }
    }
  }
  CHECK(starts > 2'000U * effort);
}

constexpr base::Duration section = 700us;  // the longest that any job has the resource

/// Streams 0..3 at levels urgent..low, all punctual when `load` is zero; `load` more for the job of `which`.
struct Loaded {
  Cpu cpu;
  Dispatcher<4, Cpu> dispatcher{cpu};
  std::array<std::vector<base::Duration>, 4> responses;
  std::array<base::Duration, 4> longest_block{};

  Loaded(std::size_t which, base::Duration load, bool shared,
         simulation::ResourceProtocol protocol = simulation::ResourceProtocol::inheritance)
      : cpu({3us, 1us, protocol}) {
    const auto bus = cpu.add_resource();
    cpu.drive(
        dispatcher,
        [which, load, shared, bus](const Release& release) {
          Program program{compute(300us * (release.stream + 1))};
          if (shared && (release.stream == 0 || release.stream == 3)) {
            program.push_back(simulation::lock(bus));
            program.push_back(compute(release.stream == 3 ? section : base::Duration{100us}));
            program.push_back(simulation::unlock(bus));
          }
          if (release.stream == which && load > 0ns) program.push_back(compute(load));
          return program;
        },
        [this](const JobRecord& job) {
          responses[job.release.stream].push_back(job.ended - job.release.scheduled);
          base::Duration& longest = longest_block[job.release.stream];
          longest = std::max(longest, job.blocked);
        });
    constexpr base::Duration periods[] = {5ms, 7ms, 11ms, 13ms};
    for (std::size_t stream = 0; stream < 4; ++stream)
      cpu.at(at(0s), [this, stream, &periods] {
        dispatcher.start(stream, periods[stream], static_cast<Level>(stream), at(0s), 3ms);
      });
    cpu.run_until(at(20s));
  }
};

TEST_CASE("overload is counted for the overloaded topic, and harms it and lower levels only") {
  const Loaded punctual{4, 0ms, false};
  for (std::size_t stream = 0; stream < 4; ++stream) CHECK(punctual.dispatcher.overload(stream).missed == 0);
  for (std::size_t which = 1; which < 4; ++which) {
    CAPTURE(which);
    const Loaded loaded{which, 30ms, false};
    CHECK(loaded.dispatcher.overload(which).missed > 100);
    for (std::size_t stream = 0; stream < which; ++stream) {
      CAPTURE(stream);
      CHECK(loaded.dispatcher.overload(stream) == punctual.dispatcher.overload(stream));
      REQUIRE(loaded.responses[stream].size() == punctual.responses[stream].size());
      // To the switch: a job finds another context running where there was none.
      for (std::size_t i = 0; i < loaded.responses[stream].size(); ++i)
        REQUIRE(loaded.responses[stream][i] - punctual.responses[stream][i] <= 2 * 3us + 1us);
      CHECK(loaded.longest_block[stream] == 0ms);
    }
    for (std::size_t stream = which + 1; stream < 4; ++stream) {
      // Starved, and said to be so: every grid point of the 20 s was taken or counted, but the newest.
      const auto harmed = loaded.dispatcher.overload(stream);
      const std::size_t points = punctual.responses[stream].size();
      const std::size_t accounted = harmed.missed + loaded.responses[stream].size();
      CHECK((accounted == points || accounted + 1 == points));
      CHECK(loaded.responses[stream].size() < punctual.responses[stream].size());
    }
  }
}

TEST_CASE("a resource shared with an overloaded level holds an upper one up for one critical section") {
  for (const auto protocol :
       {simulation::ResourceProtocol::inheritance, simulation::ResourceProtocol::ceiling}) {
    const Loaded loaded{3, 30ms, true, protocol};
    CHECK(loaded.dispatcher.overload(3).missed > 100);
    CHECK(loaded.dispatcher.overload(0) == Overload{});
    CHECK(loaded.longest_block[0] > 0ms);  // it did happen
    CHECK(loaded.longest_block[0] <= section + 4 * 3us + 4 * 1us);
    for (const auto response : loaded.responses[0]) REQUIRE(response < 300us + 100us + section + 50us);
  }
  // Without a protocol the bound does not hold: that is what the test above can see.
  const Loaded none{2, 8ms, true, simulation::ResourceProtocol::none};
  CHECK(none.longest_block[0] > section + 50us);
}

}  // namespace scheduling_dispatcher_properties_test
