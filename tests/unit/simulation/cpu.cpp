#include "ocm/simulation/cpu.hpp"

#include <map>

#include <catch2/catch.hpp>

#include "ocm/scheduling/dispatcher.hpp"

#include "unit/scheduling/conformance.hpp"

namespace simulation_cpu_test {

using namespace ocm;
using namespace std::chrono_literals;
using scheduling::Level;
using scheduling::Release;
using simulation::compute;
using simulation::Cpu;
using simulation::CpuOptions;
using simulation::JobRecord;
using simulation::lock;
using simulation::Program;
using simulation::ResourceProtocol;
using simulation::unlock;

constexpr base::Time at(base::Duration offset) {
  return base::Time{offset};
}

/// Jobs of three levels on one processor: the textbook's case.
struct Setup {
  explicit Setup(CpuOptions options = {}) : cpu(options), resource(cpu.add_resource(Level::urgent)) {
    cpu.drive(
        dispatcher, [this](const Release& release) { return programs.at(release.stream); },
        [this](const JobRecord& record) { jobs[record.release.stream].push_back(record); });
  }
  void once(std::size_t stream, Level level, base::Duration when) {
    cpu.at(at(when), [this, stream, level] { dispatcher.once(stream, level, cpu.now()); });
  }
  [[nodiscard]] base::Duration response(std::size_t stream) const {
    const auto& job = jobs.at(stream).back();
    return job.ended - job.release.scheduled;
  }

  Cpu cpu;
  simulation::ResourceNumber resource;
  scheduling::Dispatcher<4, Cpu> dispatcher{cpu};
  std::map<std::size_t, Program> programs;
  std::map<std::size_t, std::vector<JobRecord>> jobs;
};

struct VirtualPort {
  Cpu cpu;
  using Port = Cpu;
  Port& port() { return cpu; }
  void attach(std::function<void()> expire, std::function<void(Level)> run) {
    cpu.attach(std::move(expire), [run = std::move(run)](Level level) -> std::optional<Cpu::Job> {
      run(level);
      return std::nullopt;
    });
  }
  void let_pass(base::Duration time) { cpu.run_until(cpu.now() + time); }
  void stop() {}
  static constexpr base::Duration slack{0};
};

TEST_CASE("the virtual processor is a port") {
  conformance::check<VirtualPort>();
}

TEST_CASE("an urgent job preempts, and the preempted one goes on where it was") {
  Setup setup;
  setup.programs = {{0, {compute(10ms)}}, {1, {compute(2ms)}}};
  setup.once(0, Level::low, 0ms);
  setup.once(1, Level::urgent, 3ms);
  setup.cpu.run_until(at(1s));
  CHECK(setup.response(1) == 2ms);
  CHECK(setup.response(0) == 12ms);
  CHECK(setup.cpu.busy(Level::low) == 10ms);
  CHECK(setup.cpu.busy(Level::urgent) == 2ms);
  CHECK(setup.cpu.idle() == 988ms);
  CHECK(setup.jobs[1][0].blocked == 0ms);
  CHECK(setup.cpu.misuses() == 0);
}

TEST_CASE("an interrupt of its own cost takes that from the running job, and then has its effect") {
  Setup setup{{0us, 1us, ResourceProtocol::inheritance}};
  setup.programs = {{0, {compute(10ms)}}};
  setup.once(0, Level::urgent, 0ms);
  base::Time happened{};
  setup.cpu.at(at(4ms), 250us, [&] { happened = setup.cpu.now(); });
  setup.cpu.run_until(at(1s));
  CHECK(happened == at(4ms + 251us));
  CHECK(setup.jobs[0][0].ended == at(10ms + 1us + 251us));
  CHECK(setup.cpu.interrupted() == 252us);
}

TEST_CASE("a context switch and an interrupt cost what they are said to cost") {
  Setup setup{{10us, 1us, ResourceProtocol::inheritance}};
  setup.programs = {{0, {compute(10ms)}}, {1, {compute(2ms)}}};
  setup.once(0, Level::low, 0ms);
  setup.once(1, Level::urgent, 3ms);
  setup.cpu.run_until(at(1s));
  CHECK(setup.jobs[1][0].ended == at(3ms + 1us + 10us + 2ms));
  CHECK(setup.jobs[0][0].ended == at(12ms + 2 * 1us + 3 * 10us));
  CHECK(setup.cpu.interrupted() == 2us);
  CHECK(setup.cpu.idle() == 988ms - 32us);
}

TEST_CASE("a nanosecond is time: of a context switch and of a job") {
  Setup setup{{1ns, 0ns, ResourceProtocol::inheritance}};
  setup.programs = {{0, {compute(1ns)}}};
  setup.once(0, Level::low, 0ms);
  setup.cpu.run_until(at(1s));
  CHECK(setup.jobs[0][0].ended == at(2ns));
}

TEST_CASE("of two that are released at one moment the more urgent one starts first") {
  Setup setup;
  setup.programs = {{0, {compute(5ms)}}, {1, {compute(2ms)}}};
  setup.once(0, Level::low, 1ms);
  setup.once(1, Level::urgent, 1ms);
  setup.cpu.run_until(at(1s));
  CHECK(setup.jobs[1][0].started == at(1ms));
  CHECK(setup.jobs[0][0].started == at(3ms));
}

TEST_CASE("the timer and an event of one moment have their effect before any job begins") {
  Setup setup;
  setup.programs = {{0, {compute(5ms)}}, {1, {compute(2ms)}}};
  setup.cpu.at(at(0ms), [&] { setup.dispatcher.start(0, 10ms, Level::low, setup.cpu.now()); });
  setup.once(1, Level::urgent, 10ms);
  setup.cpu.run_until(at(19ms));
  REQUIRE(setup.jobs[0].size() == 2);
  REQUIRE(setup.jobs[1].size() == 1);
  CHECK(setup.jobs[1][0].started == at(10ms));
  CHECK(setup.jobs[0][1].started == at(12ms));
}

TEST_CASE("of two of one level that are released at one moment both run") {
  Setup setup;
  setup.programs = {{0, {compute(5ms)}}, {1, {compute(1ms)}}};
  setup.once(0, Level::medium, 1ms);
  setup.once(1, Level::medium, 1ms);
  setup.cpu.run_until(at(1s));
  CHECK(setup.cpu.busy(Level::medium) == 6ms);
}

TEST_CASE("who waits for one resource does not run when another one is free again") {
  Setup setup{{10us, 0us, ResourceProtocol::inheritance}};
  const auto other = setup.cpu.add_resource();
  setup.programs = {{0,
                     {lock(setup.resource), lock(other), compute(2ms), unlock(other), compute(2ms),
                      unlock(setup.resource)}},
                    {1, {lock(setup.resource), compute(1ms), unlock(setup.resource)}}};
  setup.once(0, Level::low, 0ms);
  setup.once(1, Level::urgent, 1ms);
  setup.cpu.run_until(at(1s));
  // To low, to urgent, which waits, back to low for the rest of 4 ms, to urgent: four context switches.
  CHECK(setup.jobs[1][0].ended == at(4ms + 1ms + 4 * 10us));
}

TEST_CASE("what a port may not be asked for is counted: arm and pend without the lock, and a second lock") {
  Cpu cpu;
  cpu.arm(at(1ms));
  CHECK(cpu.misuses() == 1);
  cpu.pend(Level::low);
  CHECK(cpu.misuses() == 2);
  {
    const auto guard = cpu.lock();
    cpu.arm(at(2ms));
    cpu.pend(Level::low);
    CHECK(cpu.misuses() == 2);
    const auto again = cpu.lock();
    CHECK(cpu.misuses() == 3);
  }
  const auto guard = cpu.lock();
  CHECK(cpu.misuses() == 3);
}

TEST_CASE("within a level jobs follow each other and do not preempt") {
  Setup setup;
  setup.programs = {{0, {compute(5ms)}}, {1, {compute(1ms)}}};
  setup.once(0, Level::medium, 0ms);
  setup.once(1, Level::medium, 1ms);
  setup.cpu.run_until(at(1s));
  CHECK(setup.jobs[1][0].started == at(5ms));
  CHECK(setup.response(1) == 5ms);
}

// Low has the resource, urgent wants it, medium does not care and computes for ever: the lander on Mars.
TEST_CASE("inversion is unbounded without a protocol, and one critical section with one") {
  for (const auto protocol :
       {ResourceProtocol::none, ResourceProtocol::inheritance, ResourceProtocol::ceiling}) {
    CAPTURE(static_cast<int>(protocol));
    Setup setup{{0us, 0us, protocol}};
    setup.programs = {
        {0, {compute(1ms), lock(setup.resource), compute(4ms), unlock(setup.resource), compute(1ms)}},
        {1, {compute(100ms)}},
        {2, {compute(1ms), lock(setup.resource), compute(1ms), unlock(setup.resource)}}};
    setup.once(0, Level::low, 0ms);     // has the resource from 1 to 5 ms
    setup.once(2, Level::urgent, 2ms);  // wants it at 3 ms
    setup.once(1, Level::medium, 2ms);
    setup.cpu.run_until(at(1s));
    const JobRecord& urgent = setup.jobs[2][0];
    if (protocol == ResourceProtocol::none) {
      CHECK(setup.response(2) == 1ms + 100ms + 3ms + 1ms);
      CHECK(urgent.blocked == 103ms);
    } else {
      CHECK(setup.response(2) == 2ms + 3ms);
      CHECK(urgent.blocked == 3ms);
      CHECK(setup.response(1) == 105ms);
      CHECK(setup.response(0) == 108ms);
    }
    // With a ceiling the wait comes before the start, with inheritance in the middle.
    CHECK((urgent.started == at(5ms)) == (protocol == ResourceProtocol::ceiling));
  }
}

// urgent waits for what medium has, which waits for what low has.
TEST_CASE("inheritance goes through a chain") {
  Setup setup;
  const auto other = setup.cpu.add_resource();
  setup.programs = {
      {0, {lock(other), compute(4ms), unlock(other)}},
      {1, {lock(setup.resource), lock(other), compute(1ms), unlock(other), unlock(setup.resource)}},
      {2, {lock(setup.resource), compute(1ms), unlock(setup.resource)}},
      {3, {compute(50ms)}}};
  setup.once(0, Level::low, 0ms);
  setup.once(1, Level::medium, 1ms);
  setup.once(2, Level::urgent, 2ms);
  setup.once(3, Level::high, 2ms);
  setup.cpu.run_until(at(1s));
  CHECK(setup.response(2) == 2ms + 1ms + 1ms);
  CHECK(setup.response(3) == 54ms);
}

TEST_CASE("equal runs are equal") {
  const auto run = [] {
    Setup setup{{3us, 1us, ResourceProtocol::inheritance}};
    for (std::size_t i = 0; i < 4; ++i)
      setup.programs[i] = {compute(70us * (i + 1)), lock(setup.resource), compute(100us),
                           unlock(setup.resource)};
    for (std::size_t i = 0; i < 4; ++i)
      setup.cpu.at(at(1ms * i), [&setup, i] {
        setup.dispatcher.start(i, 900us * (i + 1), static_cast<Level>(3 - i), setup.cpu.now());
      });
    setup.cpu.run_until(at(10s));
    std::vector<std::int64_t> ends;
    for (const auto& [stream, records] : setup.jobs)
      for (const auto& record : records) ends.push_back(record.ended.time_since_epoch().count());
    return ends;
  };
  const auto first = run();
  CHECK(first.size() > 20'000);
  CHECK(first == run());
}

}  // namespace simulation_cpu_test
