// How SocketCan opens an interface, and what it says of its controller, on a kernel that is played.
#include <cerrno>
#include <cstring>
#include <memory>

#include <catch2/catch.hpp>

#include "ocm/can/any_text.hpp"
#include "ocm/transport/socketcan.hpp"

#include "unit/transport/played_can.hpp"

namespace transport_socketcan_open_test {

using namespace ocm;
using test::PlayedCan;
using test::netlink::bytes_of;
using transport::BusState;
using transport::CanInterface;
using transport::Failure;
using transport::SocketCan;

Failure failure(std::string_view name = "can7") {
  const auto bus = SocketCan::open(name);
  CHECK_FALSE(bus);
  return bus.error;
}
std::string why(const char* action, int error) {
  return std::string("cannot ") + action + " interface 'can7': " + std::strerror(error);
}

TEST_CASE("socketcan: the socket is a raw one of CAN, bound to the interface by its index") {
  PlayedCan played;
  const auto bus = played.open();
  CHECK(played.socket_type == (SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK));
  CHECK(played.socket_protocol == CAN_RAW);
  CHECK(played.address.can_family == AF_CAN);
  CHECK(played.address.can_ifindex == 7);
  CHECK(bus->name() == "can7");
  CHECK(bus->descriptor() == played.socket);
  CHECK(bus->state() == BusState::up);
  CHECK(bus->failure() == Failure{});
}

TEST_CASE("socketcan: the socket has error frames, CAN FD, times, a count of losses and 32 MiB of room") {
  PlayedCan played;
  const auto bus = played.open();
  CHECK(played.options[{SOL_CAN_RAW, CAN_RAW_ERR_FILTER}] == bytes_of(can_err_mask_t{0x1FFF'FFFF}));
  CHECK(played.options[{SOL_CAN_RAW, CAN_RAW_FD_FRAMES}] == bytes_of(int{1}));
  CHECK(played.options[{SOL_SOCKET, SO_TIMESTAMPNS}] == bytes_of(int{1}));
  CHECK(played.options[{SOL_SOCKET, SO_RXQ_OVFL}] == bytes_of(int{1}));
  CHECK(played.options[{SOL_SOCKET, SO_RCVBUFFORCE}] == bytes_of(int{33'554'432}));
  CHECK(played.options.count({SOL_SOCKET, SO_RCVBUF}) == 0);
}

TEST_CASE("socketcan: a user who may not force the size of the queue asks for it") {
  PlayedCan played;
  played.option_errors[{SOL_SOCKET, SO_RCVBUFFORCE}] = EPERM;
  auto opened = SocketCan::open("can7", {.receive_buffer_bytes = 4096});
  REQUIRE(opened);
  CHECK(played.options[{SOL_SOCKET, SO_RCVBUF}] == bytes_of(int{4096}));
}

TEST_CASE("socketcan: an option that the kernel does not have is named as an error of setting up") {
  const auto option =
      GENERATE(std::pair<int, int>{SOL_CAN_RAW, CAN_RAW_ERR_FILTER},
               std::pair<int, int>{SOL_CAN_RAW, CAN_RAW_FD_FRAMES},
               std::pair<int, int>{SOL_SOCKET, SO_TIMESTAMPNS}, std::pair<int, int>{SOL_SOCKET, SO_RXQ_OVFL});
  PlayedCan played;
  played.option_errors[option] = ENOPROTOOPT;
  CHECK(failure().what == why("configure", ENOPROTOOPT));
}

TEST_CASE("socketcan: a queue whose size can neither be forced nor asked for is an error of setting up") {
  PlayedCan played;
  played.option_errors[{SOL_SOCKET, SO_RCVBUFFORCE}] = EPERM;
  played.option_errors[{SOL_SOCKET, SO_RCVBUF}] = EDOM;
  CHECK(failure().what == why("configure", EDOM));
}

TEST_CASE("socketcan: without a CAN socket the reason is the kernel's") {
  PlayedCan played;
  played.socket_error = EAFNOSUPPORT;
  CHECK(failure() == transport::can_socket_failure(EAFNOSUPPORT));
}

TEST_CASE("socketcan: a name that no interface has is missing, with those that there are") {
  PlayedCan played;
  CHECK(failure("can8").what == "there is no interface 'can8'");
  CHECK(failure("can8").remedy == "the CAN interfaces here are: can7 (see also `ip link show type can`)");
  CHECK(failure("can7:1").what == "there is no interface 'can7:1'");
}

TEST_CASE("socketcan: a name of fifteen characters is asked for, and found to be missing") {
  PlayedCan played;
  CHECK(failure("can456789012345").what == "there is no interface 'can456789012345'");
}

TEST_CASE("socketcan: an interface that cannot be looked at is not called missing") {
  PlayedCan played;
  played.control_errors[GENERATE(static_cast<unsigned long>(SIOCGIFINDEX),
                                 static_cast<unsigned long>(SIOCGIFHWADDR))] = EPERM;
  CHECK(failure().what == why("find", EPERM));
}

TEST_CASE("socketcan: an interface of another kind is none of CAN") {
  PlayedCan played;
  played.hardware = 1;  // Ethernet
  CHECK(failure().what == "'can7' is not a CAN interface");
  CHECK(failure().remedy == "the CAN interfaces here are: can7");
}

TEST_CASE("socketcan: an interface that is down is not opened") {
  PlayedCan played;
  played.flags = IFF_RUNNING;
  CHECK(failure().what == "interface 'can7' is down");
  CHECK(failure().remedy == "sudo ip link set can7 up type can bitrate 500000");
}

TEST_CASE("socketcan: an interface that goes while it is opened is not opened") {
  PlayedCan played;
  played.control_errors[GENERATE(static_cast<unsigned long>(SIOCGIFNAME),
                                 static_cast<unsigned long>(SIOCGIFFLAGS))] = ENODEV;
  CHECK(failure().what == "interface 'can7' is down");
}

TEST_CASE("socketcan: a socket that cannot be bound is named as that") {
  PlayedCan played;
  played.bind_error = ENODEV;
  CHECK(failure().what == why("open", ENODEV));
}

// --- CAN FD ---

TEST_CASE("socketcan: an interface with room for 72 bytes carries CAN FD") {
  PlayedCan played;
  CHECK(played.open()->fd_obstacle() == Failure{});
}

TEST_CASE("socketcan: an interface with room for 16 bytes says why it carries no CAN FD") {
  PlayedCan played;
  played.mtu = CAN_MTU;
  CHECK(played.open()->fd_obstacle().what ==
        "interface 'can7' carries no CAN FD frames: its MTU is 16, and not 72");
}

TEST_CASE("socketcan: whether an interface carries CAN FD is asked again each time, by its index") {
  PlayedCan played;
  const auto bus = played.open();
  played.mtu = CAN_MTU;
  CHECK_FALSE(bus->fd_obstacle() == Failure{});
  played.mtu = CANFD_MTU;
  CHECK(bus->fd_obstacle() == Failure{});
  played.control_errors[SIOCGIFMTU] = ENODEV;
  CHECK_FALSE(bus->fd_obstacle() == Failure{});
}

TEST_CASE(
    "socketcan: what the kernel refuses of CAN FD though the interface has room is an error of sending") {
  const int error = GENERATE(EINVAL, EMSGSIZE);
  PlayedCan played;
  const auto bus = played.open();
  played.answers = {error};
  CHECK(bus->send_any(*can::parse_any_frame("123##1AA")).error == base::Error::closed);
  CHECK(bus->failure().what == why("send on", error));
}

TEST_CASE("socketcan: of an interface that is gone CAN FD is no question") {
  PlayedCan played;
  const auto bus = played.open();
  played.mtu = CAN_MTU;
  played.errors = {ENODEV};
  CHECK(bus->receive(base::Duration::zero()).error == base::Error::closed);
  CHECK(bus->fd_obstacle() == Failure{});
}

TEST_CASE("socketcan: frames that cannot exist are refused before the kernel sees them") {
  PlayedCan played;
  const auto bus = played.open();
  CHECK(bus->send({.id = 4, .dlc = 8, .format = can::Format::error}).error == base::Error::bad_identifier);
  CHECK(bus->send({.id = 0x800}).error == base::Error::bad_identifier);
  CHECK(bus->send({.id = 1, .dlc = 9}).error == base::Error::bad_length);
  auto nine = *can::parse_any_frame("123##1");
  nine.length = 9;
  CHECK(bus->send_any(nine).error == base::Error::bad_length);
  CHECK(played.asked == 0);
  CHECK(bus->counters().refused == 0);
}

TEST_CASE("socketcan: a classic frame of either kind goes as a classic one") {
  PlayedCan played;
  const auto bus = played.open();
  CHECK(*bus->send_any(*can::parse_any_frame("605#00D2")));
  CHECK(played.taken ==
        std::vector<test::Bytes>{bytes_of(transport::to_socketcan(*can::parse_frame("605#00D2")))});
}

// --- delivery ---

TEST_CASE("socketcan: what has not left by the driver's count is pending") {
  PlayedCan played;
  played.link->sent = 1000;  // of other programs, before
  const auto bus = played.open();
  for (int i = 0; i < 5; ++i) CHECK(*bus->send(*can::parse_frame("605#00D2")));
  played.link->sent = 1003;
  const auto delivery = bus->delivery();
  CHECK(delivery.known);
  CHECK(delivery.pending == 2);
  CHECK(delivery.obstruction == Failure{});
  CHECK_FALSE(delivery.refused);
}

TEST_CASE("socketcan: where other programs have sent more, nothing is pending") {
  PlayedCan played;
  const auto bus = played.open();
  CHECK(*bus->send(*can::parse_frame("605#00D2")));
  played.link->sent = GENERATE(1U, 2U);
  CHECK(bus->delivery().known);
  CHECK(bus->delivery().pending == 0);
}

TEST_CASE("socketcan: where the kernel says nothing of the interface, nothing is known") {
  PlayedCan played;
  const auto bus = played.open();
  CHECK(*bus->send(*can::parse_frame("605#00D2")));
  played.link.reset();
  CHECK_FALSE(bus->delivery().known);
  CHECK(bus->delivery().pending == 0);
}

TEST_CASE("socketcan: an interface of which the kernel says nothing is opened all the same") {
  PlayedCan played;
  played.link.reset();
  CHECK(played.open()->state() == BusState::up);
}

TEST_CASE("socketcan: a controller that is bus-off obstructs, with its remedy") {
  PlayedCan played;
  const auto bus = played.open();
  CHECK(*bus->send(*can::parse_frame("605#00D2")));
  played.link->bus_off = true;
  CHECK(bus->delivery().obstruction ==
        Failure{"'can7' is bus-off: its controller has left the bus after too many errors",
                "mend the cable, the termination or the bit rate; then: sudo ip link set can7 type can "
                "restart"});
  CHECK(bus->delivery().pending == 1);
}

TEST_CASE("socketcan: an interface that is down obstructs, by what it is") {
  PlayedCan played;
  const auto bus = played.open();
  played.link->up = false;
  played.link->kind = "vcan";
  CHECK(bus->delivery().obstruction == Failure{"interface 'can7' is down", "sudo ip link set can7 up"});
}

TEST_CASE("socketcan: an interface that takes a frame again is up again") {
  PlayedCan played;
  const auto bus = played.open();
  played.answers = {ENETDOWN};
  CHECK_FALSE(*bus->send(*can::parse_frame("605#00D2")));
  CHECK(bus->state() == BusState::down);
  CHECK(*bus->send(*can::parse_frame("605#00D2")));
  CHECK(bus->state() == BusState::up);
}

}  // namespace transport_socketcan_open_test
