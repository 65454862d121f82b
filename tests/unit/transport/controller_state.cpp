#include "ocm/transport/controller_state.hpp"

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/transport/netlink_answer.hpp"

namespace transport_controller_state_test {

using namespace ocm;
using can::ControllerState;
using transport::ControllerNow;
using transport::detail::read_controller;

using namespace test::netlink;

/// What the kernel answers of an interface of that hardware, with these of IFLA_INFO_DATA.
Bytes answer(const Bytes& data, unsigned hardware = transport::can_hardware_type,
             unsigned type = RTM_NEWLINK) {
  ifinfomsg body{};
  body.ifi_type = static_cast<unsigned short>(hardware);
  return message(type,
                 bytes_of(body) + attribute(IFLA_LINKINFO | NLA_F_NESTED, attribute(IFLA_INFO_DATA, data)));
}

Bytes state(std::uint32_t number) {
  return attribute(IFLA_CAN_STATE, bytes_of(number));
}

TEST_CASE("a controller's state and its counters, as the kernel has them") {
  for (const auto& [number, expected] : {std::pair{CAN_STATE_ERROR_ACTIVE, ControllerState::active},
                                         {CAN_STATE_ERROR_WARNING, ControllerState::warning},
                                         {CAN_STATE_ERROR_PASSIVE, ControllerState::passive},
                                         {CAN_STATE_BUS_OFF, ControllerState::bus_off}})
    CHECK(read_controller(answer(state(number))) == ControllerNow{expected, {}});
  const can_berr_counter counters{.txerr = 128, .rxerr = 7};
  CHECK(read_controller(
            answer(state(CAN_STATE_ERROR_PASSIVE) + attribute(IFLA_CAN_BERR_COUNTER, bytes_of(counters)))) ==
        ControllerNow{ControllerState::passive, can::ErrorCounters{128, 7}});
  const can_berr_counter beyond{.txerr = 256, .rxerr = 300};  // bus-off: an error frame has no room for more
  CHECK(read_controller(answer(state(CAN_STATE_BUS_OFF) + attribute(IFLA_CAN_BERR_COUNTER, bytes_of(beyond))))
            ->counters == can::ErrorCounters{255, 255});
}

TEST_CASE("no controller, or none that is running") {
  CHECK_FALSE(read_controller(answer({})));  // vcan
  CHECK_FALSE(read_controller(answer(state(CAN_STATE_STOPPED))));
  CHECK_FALSE(read_controller(answer(state(CAN_STATE_SLEEPING))));
  CHECK_FALSE(read_controller(answer(state(CAN_STATE_ERROR_ACTIVE), 1)));  // Ethernet
  CHECK_FALSE(
      read_controller(answer(state(CAN_STATE_ERROR_ACTIVE), transport::can_hardware_type, NLMSG_ERROR)));
  CHECK_FALSE(transport::query_controller(1));  // lo
  CHECK_FALSE(transport::query_controller(1'000'000));
}

TEST_CASE("a broken answer about a controller is refused at every length") {
  const Bytes whole = answer(state(CAN_STATE_BUS_OFF));
  REQUIRE(read_controller(whole));
  for (std::size_t size = 0; size < whole.size(); ++size)
    CHECK_FALSE(read_controller(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))));
}

}  // namespace transport_controller_state_test
