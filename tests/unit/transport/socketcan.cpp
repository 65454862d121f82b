// What can be known without CAN in the kernel. The rest is in tests/peers/socketcan, which boots a kernel
// that has it.
#include "ocm/transport/socketcan.hpp"

#include <linux/can/error.h>

#include <catch2/catch.hpp>

#include "ocm/can/any_text.hpp"

namespace transport_socketcan_test {

using namespace ocm;
using transport::CanInterface;
using transport::SocketCan;

static_assert(can::Bus<SocketCan>);

can::Frame frame(const char* text) {
  return *can::parse_frame(text);
}

can_frame raw(std::uint32_t id, std::uint8_t length, std::array<std::uint8_t, 8> data = {}) {
  can_frame result{};
  result.can_id = id;
  result.can_dlc = length;
  std::copy(data.begin(), data.end(), std::begin(result.data));
  return result;
}

const std::vector<CanInterface> some = {{"vcan0", 4, true, "vcan", 0}, {"can0", 5, false, "can", 0}};

TEST_CASE("frames to and from the kernel's form") {
  for (const char* text : {"000#", "7FF#1122334455667788", "205#01840302", "00000205#01", "1FFFFFFF#FF",
                           "205#R", "205#R8", "1F334455#R3", "20000040#0000000000000000", "200003FF#FF"}) {
    CAPTURE(text);
    CHECK(transport::from_socketcan(transport::to_socketcan(frame(text))) == frame(text));
  }
  CHECK(transport::to_socketcan(frame("205#01")).can_id == 0x205);
  CHECK(transport::to_socketcan(frame("00000205#01")).can_id == (0x205 | CAN_EFF_FLAG));
  CHECK(transport::to_socketcan(frame("205#R4")).can_id == (0x205 | CAN_RTR_FLAG));
  CHECK(transport::to_socketcan(frame("205#R4")).can_dlc == 4);
  CHECK(transport::to_socketcan(frame("20000040#00")).can_id == (CAN_ERR_BUSOFF | CAN_ERR_FLAG));
}

TEST_CASE("bytes beyond the length and impossible lengths do not get in") {
  const auto short_one = transport::from_socketcan(raw(0x123, 2, {1, 2, 3, 4, 5, 6, 7, 8}));
  CHECK(short_one == frame("123#0102"));
  const auto remote = transport::from_socketcan(raw(0x123 | CAN_RTR_FLAG, 3, {1, 2, 3, 4, 5, 6, 7, 8}));
  CHECK(remote == frame("123#R3"));
  const auto long_one = transport::from_socketcan(raw(0x123, 15, {1, 2, 3, 4, 5, 6, 7, 8}));
  CHECK(long_one == frame("123#0102030405060708"));
}

TEST_CASE("CAN FD frames to and from the kernel's form") {
  for (const char* text : {"123##1DEAD", "7FF##0", "1F334455##2112233445566778899AABBCC", "000##3"}) {
    CAPTURE(text);
    const auto fd = can::parse_any_frame(text);
    REQUIRE(fd);
    CHECK(transport::from_socketcan(transport::to_socketcan_fd(*fd)) == *fd);
  }
  const canfd_frame kernel = transport::to_socketcan_fd(*can::parse_any_frame("1F334455##3AABBCC"));
  CHECK(kernel.can_id == (0x1F334455 | CAN_EFF_FLAG));
  CHECK(kernel.len == 3);
  CHECK(kernel.flags == (CANFD_BRS | CANFD_ESI));  // the kernel sets FDF itself
  CHECK(kernel.data[2] == 0xCC);
  CHECK(kernel.data[3] == 0);
}

TEST_CASE("impossible lengths of CAN FD and bytes beyond the length do not get in") {
  canfd_frame kernel{};
  std::fill(std::begin(kernel.data), std::end(kernel.data), __u8{0xEE});
  kernel.can_id = 0x123;
  kernel.len = 9;
  const auto nine = transport::from_socketcan(kernel);
  CHECK(nine.length == 12);
  CHECK(nine.data[8] == 0xEE);
  CHECK(nine.data[9] == 0);
  kernel.len = 200;
  CHECK(transport::from_socketcan(kernel).length == 64);
  kernel.flags = 0xFF;
  CHECK(can::validate(transport::from_socketcan(kernel)).ok());
}

TEST_CASE("a filter in the kernel accepts what can::Filter accepts") {
  // The kernel's rule: received & mask == filter & mask [linux/can.h, struct can_filter]
  const auto kernel_accepts = [](can_filter filter, const can::Frame& f) {
    return (transport::to_socketcan(f).can_id & filter.can_mask) == (filter.can_id & filter.can_mask);
  };
  for (const can::Filter filter : {can::Filter{0, 0}, can::Filter{0x205, 0x7FF}, can::Filter{0x005, 0x0FF},
                                   can::Filter{0x400, 0x400}, can::Filter{0x7FF, 0x7FF}})
    for (const char* text : {"205#01", "605#0102", "7FF#", "204#", "205#R", "00000205#01", "00000205#R"}) {
      CAPTURE(filter.id, filter.mask, text);
      CHECK(kernel_accepts(transport::to_socketcan(filter), frame(text)) == filter.accepts(frame(text)));
    }
}

TEST_CASE("the kernel's drop counter wraps and may be read twice") {
  transport::detail::DropCounter drops;
  CHECK(drops.advance(0) == 0);
  CHECK(drops.advance(5) == 5);
  CHECK(drops.advance(5) == 0);
  CHECK(drops.advance(9) == 4);
  CHECK(drops.advance(7) == 0);  // a frame that was queued before the last reading
  CHECK(drops.advance(10) == 1);
  CHECK(drops.advance(0x7000'0000) == 0x7000'0000 - 10);
  CHECK(drops.advance(0xE000'0000) == 0x7000'0000);
  CHECK(drops.advance(3) == 0x2000'0003);
  transport::detail::DropCounter far;
  CHECK(far.advance(0x7FFF'FFFF) == 0x7FFF'FFFF);  // the most that is no older reading
  CHECK(far.advance(0xFFFF'FFFF) == 0);
}

TEST_CASE("names that no interface can have are refused before the kernel is asked") {
  const auto empty = SocketCan::open("");
  CHECK(empty.error.what == "the name of the CAN interface is empty");
  CHECK_THAT(empty.error.remedy, Catch::Contains("ip link show type can"));
  const auto wide = SocketCan::open("averylonginterface");
  CHECK(wide.error.what == "'averylonginterface' has 18 characters; an interface name has at most 15");
  CHECK_FALSE(wide.value);
  CHECK_THAT(SocketCan::open("can0123456789012").error.what, Catch::Contains("has 16 characters"));

  using transport::detail::can_be_interface;
  static_assert(can_be_interface("can0") && can_be_interface("123456789012345"));
  static_assert(!can_be_interface("") && !can_be_interface("1234567890123456"));
  static_assert(!can_be_interface("vcan0:1") && !can_be_interface("../can0") && !can_be_interface("can 0"));
}

TEST_CASE("each failure names the interface and the remedy") {
  using namespace transport::detail;
  CHECK(missing_failure("can7", some).what == "there is no interface 'can7'");
  CHECK(missing_failure("can7", some).remedy ==
        "the CAN interfaces here are: vcan0, can0 (down) (see also `ip link show type can`)");
  CHECK_THAT(missing_failure("can7", {}).remedy, Catch::Contains("type vcan"));
  CHECK(wrong_type_failure("lo", some).what == "'lo' is not a CAN interface");
  CHECK(wrong_type_failure("lo", some).remedy == "the CAN interfaces here are: vcan0, can0 (down)");
  CHECK(down_failure("can0", some).what == "interface 'can0' is down");
  CHECK(down_failure("can0", some).remedy == "sudo ip link set can0 up type can bitrate 500000");
  CHECK(down_failure("vcan0", some).remedy == "sudo ip link set vcan0 up");
  CHECK(down_failure("can9", {}).remedy == "sudo ip link set can9 up type can bitrate 500000");
  CHECK(no_fd_failure("vcan0", some).what ==
        "interface 'vcan0' carries no CAN FD frames: its MTU is 16, and not 72");
  CHECK(no_fd_failure("vcan0", some).remedy ==
        "sudo ip link set vcan0 down; sudo ip link set vcan0 mtu 72; sudo ip link set vcan0 up");
  CHECK_THAT(no_fd_failure("can0", some).remedy,
             Catch::Contains("ip link set can0 up type can bitrate 500000 dbitrate 2000000 fd on"));
  CHECK_THAT(gone_failure("can0").what, Catch::Contains("'can0' is gone"));
  CHECK(system_failure("can0", "send on", EIO).what ==
        std::string("cannot send on interface 'can0': ") + std::strerror(EIO));
}

TEST_CASE(
    "a remedy is that of the interface's kind, also where its driver does not say it or none is there") {
  using namespace transport::detail;
  const std::vector<CanInterface> others = {{"vxcan0", 6, true, "vxcan", 0}, {"slcan0", 7, false, "", 0}};
  CHECK(no_fd_failure("vxcan0", others).remedy ==
        "sudo ip link set vxcan0 down; sudo ip link set vxcan0 mtu 72; sudo ip link set vxcan0 up");
  CHECK(
      no_fd_failure("can9", {}).remedy ==
      "sudo ip link set can9 down; sudo ip link set can9 up type can bitrate 500000 dbitrate 2000000 fd on, "
      "if its controller has CAN FD");
  CHECK(down_failure("slcan0", others).remedy == "sudo ip link set slcan0 up type can bitrate 500000");
  CHECK(down_failure("vxcan0", others).remedy == "sudo ip link set vxcan0 up");
  CHECK(wrong_type_failure("lo", {}).remedy == "this machine has none: `ip link show type can`");
  CHECK(missing_failure("can7", {}).what == "there is no interface 'can7', nor any CAN interface");
}

TEST_CASE("an interface that is not there fails with a reason and a remedy") {
  const auto bus = SocketCan::open("nosuchcan");
  REQUIRE_FALSE(bus);
  if (const auto support = transport::can_support(); !support)
    CHECK(bus.error == support.error);
  else
    CHECK(bus.error.what.find("nosuchcan") != std::string::npos);
  CHECK_FALSE(bus.error.remedy.empty());
}

}  // namespace transport_socketcan_test
