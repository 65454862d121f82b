// How full a bus is that is recorded.
#include "cli/record/bus_load.hpp"

#include <chrono>

#include <catch2/catch.hpp>

namespace tool_bus_load_test {

using namespace std::chrono_literals;
using namespace ocm;

TEST_CASE("bus load of a recording: classic frames, since it was asked last") {
  cli::record::BusLoad load;
  const base::Time time{};
  const can::Frame frame{0x123, 8, {1, 2, 3, 4, 5, 6, 7, 8}};
  const auto bits = static_cast<double>(measure::bits_on_bus(frame));
  CHECK(load.take(10ms, 100'000) == 0);
  for (int i = 0; i < 2; ++i) load.add(log::Entry{time, frame});
  load.add(log::Entry{time, can::Frame{4, 8, {}, can::Format::error}});
  can::AnyFrame fd;
  fd.id = 0x123;
  fd.length = 12;
  fd.flags = can::frame_flag::fd;
  load.add(log::Entry{time, fd});
  CHECK(load.take(10ms, 100'000) == Approx(2 * bits / 1000));
  CHECK(load.take(10ms, 100'000) == 0);
  load.add(log::Entry{time, frame});
  CHECK(load.take(10ms, 0) == 0);  // its bit rate is not known
  load.add(log::Entry{time, frame});
  CHECK(load.take(0ms, 100'000) == 0);
}

}  // namespace tool_bus_load_test
