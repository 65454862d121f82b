// The clocks of this machine, and a wait for what can be read.
#include "cli/shared/clock.hpp"

#include <array>
#include <chrono>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

namespace tool_shared_clock_test {

using namespace std::chrono_literals;
using namespace ocm;
using cli::Clock;

struct Pipe {
  host::Descriptor out, in;
  Pipe() {
    std::array<int, 2> ends{};
    REQUIRE(::pipe2(ends.data(), O_CLOEXEC) == 0);
    out = host::Descriptor{ends[0]};
    in = host::Descriptor{ends[1]};
  }
  void write() const { REQUIRE(::write(in.get(), "x", 1) == 1); }
};

TEST_CASE("clock: a wait says whether one of the inputs can be read, and which") {
  const Pipe first, second;
  std::array inputs{pollfd{first.out.get(), POLLIN, 0}, pollfd{second.out.get(), POLLIN, 0}};
  CHECK_FALSE(cli::wait_for_input(inputs, 0s));
  CHECK(inputs[0].revents == 0);
  CHECK(inputs[1].revents == 0);
  second.write();
  CHECK(cli::wait_for_input(inputs, 30s));
  CHECK(inputs[0].revents == 0);
  CHECK(inputs[1].revents == POLLIN);
  first.write();
  CHECK(cli::wait_for_input(inputs, 30s));
  CHECK(inputs[0].revents == POLLIN);
  CHECK(inputs[1].revents == POLLIN);
}

TEST_CASE("clock: a wait for a time is no shorter") {
  const Pipe silent;
  std::array inputs{pollfd{silent.out.get(), POLLIN, 0}};
  const auto took = [](auto wait) {
    const auto begin = std::chrono::steady_clock::now();
    wait();
    return std::chrono::steady_clock::now() - begin;
  };
  CHECK(took([&] { CHECK_FALSE(cli::wait_for_input(inputs, 5ms)); }) >= 5ms);
  CHECK(took([] { cli::sleep_for(5ms); }) >= 5ms);
  CHECK(took([] { cli::sleep_until(Clock::now() + 5ms); }) >= 5ms);
  cli::sleep_until(Clock::now() - 1h);  // it is over
  cli::sleep_until({});
}

TEST_CASE("clock: those of the kernel are asked") {
  const auto steady = std::chrono::steady_clock::now().time_since_epoch();
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const auto ours = Clock::now().time_since_epoch();
  CHECK(ours >= steady);
  CHECK(ours <= std::chrono::steady_clock::now().time_since_epoch());
  CHECK(cli::unix_time().time_since_epoch() >= wall - 1h);  // it may be set meanwhile
}

TEST_CASE("clock: what lasts longer than any clock goes on for ever") {
  constexpr Clock::time_point begin{5h};
  CHECK(cli::time_after(begin, 1s) == begin + 1s);
  CHECK(cli::time_after(begin, Clock::duration::max()) == Clock::time_point::max());
  CHECK(cli::time_after(begin, Clock::time_point::max() - begin) == Clock::time_point::max());
  CHECK(cli::time_after(begin, Clock::time_point::max() - begin - 1ns) == Clock::time_point::max() - 1ns);
  CHECK(cli::time_after(Clock::time_point{-1h}, Clock::duration::max()) ==
        Clock::time_point::max() - 1h);  // before the clock began, there is room for it
}

}  // namespace tool_shared_clock_test
