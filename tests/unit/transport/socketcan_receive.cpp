// What SocketCan receives, waits for and counts, on a kernel that is played: its clock passes while the bus
// waits, and its queue holds what a test has put there.
#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/any_text.hpp"
#include "ocm/transport/socketcan.hpp"

#include "unit/transport/played_can.hpp"

namespace transport_socketcan_receive_test {

using namespace ocm;
using namespace std::chrono_literals;
using base::Error;
using transport::BusState;
using transport::Failure;
using transport::SocketCan;
using Waits = std::vector<test::PlayedKernel::Wait>;

constexpr base::Time at(base::Duration after) {
  return base::Time{300'000h} + after;  // before the played clock begins
}

struct Scene {
  test::PlayedCan played;
  std::unique_ptr<SocketCan> bus = played.open();

  /// The frames that wait, as candump writes them, and of both kinds where asked.
  std::vector<std::string> classic() {
    std::vector<std::string> all;
    while (const auto one = bus->receive(0ns)) all.emplace_back(can::to_text(one->frame).view());
    return all;
  }
  std::vector<std::string> any() {
    std::vector<std::string> all;
    while (const auto one = bus->receive_any(0ns)) all.emplace_back(can::to_text(one->frame).view());
    return all;
  }
};
using Texts = std::vector<std::string>;

TEST_CASE("socketcan: a frame carries the kernel's time of it, to the nanosecond") {
  Scene scene;
  scene.played.arrive("605#0102", at(1'234'567'891ns));
  const auto received = scene.bus->receive(0ns);
  REQUIRE(received);
  CHECK(received->frame == *can::parse_frame("605#0102"));
  CHECK(received->time == at(1'234'567'891ns));
  CHECK(scene.bus->counters().received == 1);
  CHECK(scene.bus->counters().error_frames == 0);
}

TEST_CASE("socketcan: each frame of a batch has its own time, and its own data") {
  Scene scene;
  scene.played.arrive("605#01", at(1ms));
  scene.played.arrive("606#0203", at(3ms));
  CHECK(scene.bus->receive(0ns)->time == at(1ms));
  const auto second = scene.bus->receive(0ns);
  REQUIRE(second);
  CHECK(second->time == at(3ms));
  CHECK(second->frame == *can::parse_frame("606#0203"));
}

TEST_CASE("socketcan: a frame of a later batch has its time, too") {
  Scene scene;
  scene.played.arrive("605#01", at(1ms));
  CHECK(scene.bus->receive(0ns)->time == at(1ms));
  scene.played.arrive("605#01", at(9ms));
  CHECK(scene.bus->receive(0ns)->time == at(9ms));
}

TEST_CASE("socketcan: a frame without a time of the kernel's gets the time of reading") {
  Scene scene;
  scene.played.kernel.unix_time = at(77ms);
  scene.played.queue.push_back({test::netlink::bytes_of(transport::to_socketcan(*can::parse_frame("605#"))),
                                std::nullopt, std::nullopt});
  CHECK(scene.bus->receive(0ns)->time == at(77ms));
}

TEST_CASE("socketcan: what another layer says with the same number is no time") {
  Scene scene;
  scene.played.kernel.unix_time = at(77ms);
  scene.played.arrive("605#", at(1ms));
  scene.played.queue.back().stamp_level = SOL_CAN_RAW;
  CHECK(scene.bus->receive(0ns)->time == at(77ms));
}

TEST_CASE("socketcan: 64 frames are read with one call") {
  Scene scene;
  for (int i = 0; i < 65; ++i) scene.played.arrive("605#", at(1ms));
  for (int i = 0; i < 64; ++i) REQUIRE(scene.bus->receive(0ns));
  CHECK(scene.played.reads == 1);
  CHECK(scene.bus->receive(0ns));
  CHECK(scene.played.reads == 2);
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->counters().received == 65);
}

TEST_CASE("socketcan: error frames are received, and counted beside the others") {
  Scene scene;
  scene.played.arrive("20000004#0001000000000000", at(1ms));
  scene.played.arrive("605#", at(2ms));
  CHECK(scene.classic() == Texts{"20000004#0001000000000000", "605#"});
  CHECK(scene.bus->counters().received == 2);
  CHECK(scene.bus->counters().error_frames == 1);
}

TEST_CASE("socketcan: receive passes over CAN FD frames, and counts them") {
  Scene scene;
  scene.played.arrive("123##1AA", at(1ms));
  scene.played.arrive("605#01", at(2ms));
  scene.played.arrive("123##1BB", at(3ms));
  CHECK(scene.classic() == Texts{"605#01"});
  CHECK(scene.bus->counters().passed_over == 2);
  CHECK(scene.bus->counters().received == 1);
}

TEST_CASE("socketcan: receive_any receives frames of either kind") {
  Scene scene;
  scene.played.arrive("123##1AA", at(1ms));
  scene.played.arrive("605#01", at(2ms));
  scene.played.arrive("1F334455##2112233445566778899AABBCC", at(3ms));
  CHECK(scene.any() == Texts{"123##1AA", "605#01", "1F334455##2112233445566778899AABBCC"});
  CHECK(scene.bus->counters().passed_over == 0);
  CHECK(scene.bus->counters().received == 3);
}

// --- what was lost ---

TEST_CASE("socketcan: frames that found the socket's queue full are counted when the next one comes") {
  Scene scene;
  scene.played.arrive("605#01", at(1ms), 3);
  scene.played.arrive("605#02", at(2ms), 3);
  scene.played.arrive("605#03", at(3ms), 5);
  CHECK(scene.bus->receive(0ns));
  CHECK(scene.bus->counters().lost == 3);
  CHECK(scene.bus->receive(0ns));
  CHECK(scene.bus->counters().lost == 3);
  CHECK(scene.bus->receive(0ns));
  CHECK(scene.bus->counters().lost == 5);
}

TEST_CASE("socketcan: frames that were lost are counted though no frame follows them") {
  Scene scene;
  scene.played.drops = 4;
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->counters().lost == 4);
  scene.played.drops = 9;
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->counters().lost == 9);
}

TEST_CASE("socketcan: what was lost is not looked up while frames wait") {
  Scene scene;
  scene.played.drops = 4;
  scene.played.arrive("605#01", at(1ms));
  CHECK(scene.bus->receive(0ns));
  CHECK(scene.bus->counters().lost == 0);
}

TEST_CASE("socketcan: a kernel that has no such count, or an older one without it, says nothing of losses") {
  Scene scene;
  scene.played.drops = 4;
  scene.played.memory_variables = GENERATE(0U, unsigned{SK_MEMINFO_DROPS});
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->counters().lost == 0);
}

TEST_CASE("socketcan: a kernel whose last count is the one of what was lost says it") {
  Scene scene;
  scene.played.drops = 4;
  scene.played.memory_variables = SK_MEMINFO_DROPS + 1;
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->counters().lost == 4);
}

// --- waiting ---

TEST_CASE("socketcan: receive waits as long as it has to, and for input") {
  Scene scene;
  const base::Time begin = scene.played.kernel.steady;
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.played.kernel.steady - begin == 20ms);
  CHECK(scene.played.kernel.waits == Waits{{POLLIN, 20ms}});
}

TEST_CASE("socketcan: receive does not wait for a time of zero, nor for one that has passed") {
  Scene scene;
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->receive(-1ms).error == Error::timed_out);
  CHECK(scene.played.kernel.waits.empty());
}

TEST_CASE("socketcan: a frame ends the wait") {
  Scene scene;
  scene.played.kernel.later(7ms, [&] { scene.played.arrive("605#01", at(1ms)); });
  const base::Time begin = scene.played.kernel.steady;
  const auto received = scene.bus->receive(1h);
  REQUIRE(received);
  CHECK(received->frame == *can::parse_frame("605#01"));
  CHECK(scene.played.kernel.steady - begin == 7ms);
}

TEST_CASE("socketcan: what wakes it without a frame does not prolong the wait") {
  Scene scene;
  scene.played.kernel.later(5ms, [&] { scene.played.wake = true; });
  const base::Time begin = scene.played.kernel.steady;
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.played.kernel.waits == Waits{{POLLIN, 20ms}, {POLLIN, 15ms}});
  CHECK(scene.played.kernel.steady - begin == 20ms);
}

TEST_CASE("socketcan: frames that were only passed over do not prolong the wait") {
  Scene scene;
  scene.played.kernel.later(5ms, [&] { scene.played.arrive("123##1AA", at(1ms)); });
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.played.kernel.waits == Waits{{POLLIN, 20ms}, {POLLIN, 15ms}});
}

TEST_CASE("socketcan: a signal ends the wait") {
  Scene scene;
  scene.played.kernel.later(5ms, [&] { scene.played.kernel.interrupt(); });
  const base::Time begin = scene.played.kernel.steady;
  CHECK(scene.bus->receive(1h).error == Error::timed_out);
  CHECK(scene.played.kernel.steady - begin == 5ms);
  CHECK(scene.bus->state() == BusState::up);
}

TEST_CASE("socketcan: a signal that comes while it reads ends receive") {
  Scene scene;
  scene.played.errors = {EINTR};
  CHECK(scene.bus->receive(1h).error == Error::timed_out);
  CHECK(scene.played.kernel.waits.empty());
  CHECK(scene.bus->state() == BusState::up);
}

// --- an interface that goes ---

TEST_CASE("socketcan: an interface that goes down ends the wait at once, and is not the end") {
  Scene scene;
  scene.played.kernel.later(5ms, [&] {
    scene.played.errors = {ENETDOWN};
    scene.played.flags = 0;
  });
  const base::Time begin = scene.played.kernel.steady;
  CHECK(scene.bus->receive(1h).error == Error::timed_out);
  CHECK(scene.played.kernel.steady - begin == 5ms);
  CHECK(scene.bus->state() == BusState::down);
  CHECK(scene.bus->failure() == Failure{});
}

TEST_CASE(
    "socketcan: while the interface is down it is looked at every 50 ms, and its return ends the wait") {
  Scene scene;
  scene.played.errors = {ENETDOWN};
  scene.played.flags = 0;
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  scene.played.kernel.later(120ms, [&] { scene.played.flags = IFF_UP; });
  CHECK(scene.bus->receive(1h).error == Error::timed_out);
  CHECK(scene.bus->state() == BusState::up);
  CHECK(scene.played.kernel.waits == Waits{{POLLIN, 50ms}, {POLLIN, 50ms}, {POLLIN, 50ms}});
  scene.played.arrive("605#01", at(1ms));
  CHECK(scene.bus->receive(0ns));
}

TEST_CASE("socketcan: while the interface is down receive waits no longer than told") {
  Scene scene;
  scene.played.errors = {ENETDOWN};
  scene.played.flags = 0;
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->receive(60ms).error == Error::timed_out);
  CHECK(scene.played.kernel.waits == Waits{{POLLIN, 50ms}, {POLLIN, 10ms}});
  CHECK(scene.bus->state() == BusState::down);
}

TEST_CASE("socketcan: an interface that is deleted while it is down is gone") {
  Scene scene;
  scene.played.errors = {ENETDOWN};
  scene.played.flags = 0;
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  scene.played.gone = true;
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.bus->state() == BusState::closed);
  CHECK(scene.bus->failure().what == "interface 'can7' is gone: unplugged or deleted");
  CHECK(scene.bus->failure().remedy ==
        "plug it in, bring it up (sudo ip link set can7 up type can bitrate 500000) and start again");
}

TEST_CASE("socketcan: of an interface that is pulled out the frames that wait come first") {
  const int error = GENERATE(ENODEV, ENXIO);
  Scene scene;
  scene.played.errors = {error};
  scene.played.arrive("605#01", at(1ms));
  const auto last = scene.bus->receive(1h);
  REQUIRE(last);
  CHECK(last->frame == *can::parse_frame("605#01"));
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.played.kernel.waits.empty());
  CHECK(scene.bus->state() == BusState::closed);
  CHECK(scene.bus->failure().what == "interface 'can7' is gone: unplugged or deleted");
}

TEST_CASE("socketcan: an error of the socket that comes again and again is the end") {
  Scene scene;
  scene.played.errors = {EIO, EIO};
  scene.played.arrive("605#01", at(1ms));
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.played.reads == 2);
  CHECK(scene.bus->failure().what ==
        std::string("cannot receive from interface 'can7': ") + std::strerror(EIO));
  CHECK(scene.bus->failure().remedy ==
        "see `ip -details -statistics link show can7` and the kernel's log (dmesg)");
}

TEST_CASE("socketcan: after the end nothing is sent, received or waited for") {
  Scene scene;
  scene.played.errors = {ENODEV};
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.bus->receive_any(1h).error == Error::closed);
  CHECK(scene.bus->send(*can::parse_frame("605#01")).error == Error::closed);
  CHECK(scene.bus->send_any(*can::parse_any_frame("123##1AA")).error == Error::closed);
  CHECK(scene.played.asked == 0);
  CHECK(scene.played.kernel.waits.empty());
}

// --- filters ---

TEST_CASE("socketcan: filters are set in the kernel") {
  Scene scene;
  const std::array filters{can::Filter{0x605, 0x7FF}, can::Filter{0x100, 0x700}};
  REQUIRE(scene.bus->subscribe(filters));
  constexpr std::array<can_filter, 2> raw{
      {{0x605, 0x7FF | CAN_EFF_FLAG | CAN_RTR_FLAG}, {0x100, 0x700 | CAN_EFF_FLAG | CAN_RTR_FLAG}}};
  CHECK(scene.played.options[{SOL_CAN_RAW, CAN_RAW_FILTER}] == test::netlink::bytes_of(raw));
}

TEST_CASE("socketcan: without filters the kernel has one that all frames pass") {
  Scene scene;
  REQUIRE(scene.bus->subscribe({}));
  CHECK(scene.played.options[{SOL_CAN_RAW, CAN_RAW_FILTER}] == test::Bytes(8));
}

TEST_CASE("socketcan: what waited before the filters were set is filtered here, error frames are not") {
  Scene scene;
  scene.played.kernel.unix_time = at(10ms);
  scene.played.arrive("605#01", at(1ms));
  scene.played.arrive("608#02", at(2ms));
  scene.played.arrive("608##1AA", at(3ms));
  scene.played.arrive("605##1BB", at(4ms));
  scene.played.arrive("20000004#0001000000000000", at(5ms));
  scene.played.arrive("608#03", at(10ms));
  scene.played.arrive("608#04", at(10ms + 1ns));  // the kernel has let it pass
  const can::Filter filter{0x605, 0x7FF};
  REQUIRE(scene.bus->subscribe({&filter, 1}));
  CHECK(scene.any() == Texts{"605#01", "605##1BB", "20000004#0001000000000000", "608#04"});
  CHECK(scene.bus->counters().received == 4);
}

TEST_CASE("socketcan: one of several filters is enough for what waited") {
  Scene scene;
  for (const char* text : {"605#01", "608#02", "700#03"}) scene.played.arrive(text, at(1ms));
  const std::array filters{can::Filter{0x605, 0x7FF}, can::Filter{0x700, 0x700}};
  REQUIRE(scene.bus->subscribe(filters));
  CHECK(scene.classic() == Texts{"605#01", "700#03"});
}

TEST_CASE("socketcan: filters that are taken away hold for what waited no more") {
  Scene scene;
  scene.played.arrive("608#02", at(1ms));
  const can::Filter filter{0x605, 0x7FF};
  REQUIRE(scene.bus->subscribe({&filter, 1}));
  REQUIRE(scene.bus->subscribe({}));
  CHECK(scene.classic() == Texts{"608#02"});
}

TEST_CASE("socketcan: the kernel takes 512 filters, and one more is refused in words") {
  Scene scene;
  std::vector<can::Filter> filters(512, can::Filter{0x605, 0x7FF});
  CHECK(scene.bus->subscribe(filters));
  filters.push_back({0x606, 0x7FF});
  CHECK(scene.bus->subscribe(filters).error ==
        Failure{"513 filters for interface 'can7'; the kernel takes 512",
                "use fewer filters with wider masks, or none"});
}

TEST_CASE("socketcan: filters that the kernel refuses hold nowhere") {
  Scene scene;
  scene.played.arrive("608#02", at(1ms));
  scene.played.option_errors[{SOL_CAN_RAW, CAN_RAW_FILTER}] = EINVAL;
  const can::Filter filter{0x605, 0x7FF};
  const auto refused = scene.bus->subscribe({&filter, 1});
  REQUIRE_FALSE(refused);
  CHECK(refused.error.what ==
        std::string("cannot set the filters of interface 'can7': ") + std::strerror(EINVAL));
  CHECK(scene.classic() == Texts{"608#02"});
}

}  // namespace transport_socketcan_receive_test
