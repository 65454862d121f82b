// When the kernel is asked how the controller of a bus is; what it answers is played.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <linux/can/netlink.h>
#include <memory>
#include <net/if.h>
#include <optional>
#include <string>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <utility>

#include <catch2/catch.hpp>

#include "ocm/can/error_frame.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/bus_model/feed.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/unit/transport/netlink_answer.hpp"
#include "tests/unit/transport/played_kernel.hpp"

namespace tool_clock_controller_test {

using namespace ocm;
using namespace std::chrono_literals;
using can::ControllerState;
using test::PlayedBus;
using test::World;

/// Any interface has a controller, of this state.
struct PlayedController {
  PlayedController() {
    kernel.socket = [this](int family, int type, int protocol) {
      if (family != AF_NETLINK) return static_cast<int>(::syscall(SYS_socket, family, type, protocol));
      ++asked;
      const int file = ::eventfd(0, EFD_CLOEXEC);
      kernel.files = {file};
      return file;
    };
    kernel.send = [](int, const void*, std::size_t size, int) { return static_cast<ssize_t>(size); };
    kernel.recv = [this](int, void* bytes, std::size_t) {
      const auto answer = test::netlink::link({.name = "can0",
                                               .index = 4,
                                               .up = true,
                                               .kind = "can",
                                               .bit_rate = 500'000,
                                               .bus_off = false,
                                               .sent = 0},
                                              state);
      std::copy(answer.begin(), answer.end(), static_cast<std::byte*>(bytes));
      return static_cast<ssize_t>(answer.size());
    };
  }
  PlayedController(const PlayedController&) = delete;
  PlayedController& operator=(const PlayedController&) = delete;

  test::PlayedKernel kernel;
  std::uint32_t state = CAN_STATE_ERROR_ACTIVE;
  int asked = 0;
};

/// What is known of the controller after each look at the bus.
struct Looked {
  explicit Looked(std::string name)
      : bus(std::move(name)), feed(std::make_unique<PlayedBus>(world, PlayedBus::Conditions{}, bus)) {}
  std::optional<ControllerState> look() {
    CHECK(feed.pump(models) == cli::Over::time);
    return models.of(bus).summary(world.wall_at(world.now())).controller;
  }

  World world{1};
  PlayedController controller;
  std::string bus;
  cli::bus_model::LiveFeed feed;
  cli::bus_model::Models models{amiro::catalogue, 500'000};
};

TEST_CASE("live feed: the kernel is asked for an interface's controller at once, and then twice a second") {
  // Each machine has it; the kernel that is played says that it has a controller.
  if (::if_nametoindex("lo") == 0) {
    WARN("no interface lo");
    return;
  }
  Looked live{"lo"};
  CHECK(live.controller.asked == 0);
  CHECK(live.look() == ControllerState::active);
  CHECK(live.controller.asked == 1);
  live.controller.state = CAN_STATE_ERROR_PASSIVE;
  live.world.pass(490ms);
  CHECK(live.look() == ControllerState::active);
  CHECK(live.controller.asked == 1);
  live.world.pass(20ms);
  CHECK(live.look() == ControllerState::passive);
  CHECK(live.controller.asked == 2);
  CHECK(live.look() == ControllerState::passive);
  CHECK(live.controller.asked == 2);
  live.controller.state = CAN_STATE_STOPPED;  // which says nothing
  live.world.pass(510ms);
  CHECK(live.look() == ControllerState::passive);
  CHECK(live.controller.asked == 3);
}

TEST_CASE("live feed: the kernel is not asked for the controller of a bus that is none of its interfaces") {
  Looked live{"no-such-bus"};
  CHECK_FALSE(live.look());
  live.world.pass(2s);
  CHECK_FALSE(live.look());
  CHECK(live.controller.asked == 0);
}

}  // namespace tool_clock_controller_test
