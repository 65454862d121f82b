// What doctor and others say of frames that are no samples.
#include "cli/shared/remedies.hpp"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

namespace remedies_test {

using namespace ocm;

TEST_CASE("findings: each counter is one, alone and among all, with its number") {
  struct Counter {
    std::uint64_t transport::BusCounters::*bus = nullptr;
    std::uint64_t client::ReceiverCounters::*seen = nullptr;
    std::string one, three;
  };
  const std::vector<Counter> counters = {
      {&transport::BusCounters::error_frames, nullptr,
       "1 error frame from the CAN controller of this machine",
       "3 error frames from the CAN controller of this machine"},
      {&transport::BusCounters::lost, nullptr, "1 frame lost on the way to this program",
       "3 frames lost on the way to this program"},
      {nullptr, &client::ReceiverCounters::unknown, "1 frame that the spec does not know",
       "3 frames that the spec does not know"},
      {nullptr, &client::ReceiverCounters::remote, "1 remote frame", "3 remote frames"},
      {nullptr, &client::ReceiverCounters::wrong_dlc, "1 frame of a wrong length",
       "3 frames of a wrong length"},
      {nullptr, &client::ReceiverCounters::incomplete, "1 incomplete sample", "3 incomplete samples"},
  };
  CHECK(cli::findings_of({}, {}).empty());
  transport::BusCounters bus;
  client::ReceiverCounters seen;
  for (const Counter& counter : counters) {
    CAPTURE(counter.one);
    transport::BusCounters bus_alone;
    client::ReceiverCounters seen_alone;
    const auto set = [&counter](auto& on_bus, auto& in_receiver, std::uint64_t number) {
      (counter.bus != nullptr ? on_bus.*counter.bus : in_receiver.*counter.seen) = number;
    };
    set(bus_alone, seen_alone, 1);
    const auto found = cli::findings_of(bus_alone, seen_alone);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == counter.one);
    CHECK(found[0].severity == client::Severity::warning);
    CHECK_FALSE(found[0].remedy.empty());
    set(bus, seen, 3);
  }
  const auto all = cli::findings_of(bus, seen);
  REQUIRE(all.size() == counters.size());
  for (std::size_t i = 0; i < all.size(); ++i) CHECK(all[i].what == counters[i].three);
}

}  // namespace remedies_test
