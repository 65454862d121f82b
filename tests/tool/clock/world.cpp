#include "tests/tool/clock/world.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <unistd.h>

namespace ocm::test {
namespace {

World* running = nullptr;

/// What a look at the clock takes: a loop that waits for a time ends.
constexpr Duration a_look{200};

}  // namespace

World::World(std::uint64_t seed) : random(seed), before_(running) {
  running = this;
}

World::~World() {
  running = before_;
}

World& World::now_running() {
  return *running;
}

base::Time World::wall_at(Moment time) const {
  // 2026, by a clock that is set now and then.
  base::Time wall{std::chrono::hours{24 * 365 * 57} + time.time_since_epoch()};
  for (const auto& step : steps_)
    if (time >= step.at) wall += step.by;
  return wall;
}

bool World::was_stopped(Moment begin, Moment end, Duration least) const {
  return std::any_of(past_.begin(), past_.end(), [&](const Stop& stop) {
    return stop.lasting >= least && stop.at < end && stop.at + stop.lasting > begin;
  });
}

void World::go_to(Moment time) {
  now_ = std::max(now_, time);
  if (!beside || beside_runs_) return;
  beside_runs_ = true;
  beside();
  beside_runs_ = false;
}

void World::wait_until(Moment time) {
  if (now_ < signal_at_) time = std::min(time, std::max(signal_at_, now_));
  for (;;) {
    const auto next = std::min_element(stops_.begin(), stops_.end(),
                                       [](const Stop& a, const Stop& b) { return a.at < b.at; });
    if (beside_runs_ || next == stops_.end() || next->at > time) break;
    go_to(next->at);
    const Moment end = std::max(now_, next->at) + next->lasting;
    past_.push_back({now_, next->lasting});
    stops_.erase(next);
    now_ = end;  // nothing of the program runs meanwhile
  }
  go_to(time);
}

Silence::Silence() : stderr_(::dup(STDERR_FILENO)) {
  std::fflush(stderr);
  const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ::dup2(nothing, STDERR_FILENO);
  ::close(nothing);
}

Silence::~Silence() {
  std::fflush(stderr);
  ::dup2(stderr_, STDERR_FILENO);
  ::close(stderr_);
}

}  // namespace ocm::test

namespace ocm::cli {

using test::World;

Clock::time_point Clock::now() noexcept {
  World& world = World::now_running();
  world.pass(test::a_look);
  return world.now();
}

base::Time unix_time() noexcept {
  const World& world = World::now_running();
  return world.wall_at(world.now());
}

void sleep_for(base::Duration duration) noexcept {
  World::now_running().pass(duration);
}

void sleep_until(Clock::time_point time) noexcept {
  World::now_running().wait_until(time);
}

bool wait_for_input(std::span<pollfd> inputs, base::Duration longest) noexcept {
  World& world = World::now_running();
  auto until = world.now() + longest;
  for (const auto& input : inputs) until = std::min(until, world.inputs.at(input.fd)());
  world.wait_until(until);
  bool any = false;
  for (auto& input : inputs) {
    input.revents = world.inputs.at(input.fd)() <= world.now() ? POLLIN : 0;
    any = any || input.revents != 0;
  }
  return any;
}

void catch_interrupts() {}
void catch_hangups() {}
void catch_broken_pipe() {}

int interrupted() noexcept {
  return World::now_running().signal();
}

int interruptions() noexcept {
  return interrupted() != 0 ? 1 : 0;
}

int exit_code_after_interrupt(int code) noexcept {
  const int signal = interrupted();
  return signal != 0 ? 128 + signal : code;
}

WithoutBrokenPipe::WithoutBrokenPipe() {
  static_cast<void>(blocked_);  // there is no pipe
}
WithoutBrokenPipe::~WithoutBrokenPipe() = default;

Written write_all(int descriptor, std::string_view text, Signals) {
  const World& world = World::now_running();
  Written written;
  if (world.disk) written = world.disk(descriptor, text);
  if (!world.disk) written.bytes = text.size();
  const ssize_t count = ::write(descriptor, text.data(), written.bytes);
  if (count != static_cast<ssize_t>(written.bytes)) return {0, errno};
  return written;
}

}  // namespace ocm::cli
