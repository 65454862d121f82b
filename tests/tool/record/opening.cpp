// How the recorder opens a CAN interface, on a kernel that is played.
#include <array>
#include <cerrno>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "cli/record/can_capture.hpp"
#include "unit/transport/played_can.hpp"

namespace tool_record_opening_test {

using namespace ocm;
using cli::record::CanCapture;
using test::netlink::bytes_of;
using transport::BusState;

/// can7, which SocketCan opens first and closes again. What is kept of a socket is of the recorder's own.
struct Opening {
  Opening() {
    const auto make = played.kernel.socket;
    played.kernel.socket = [this, make](int family, int type, int protocol) {
      if (family == PF_CAN && ++sockets == 2) {
        played.options.clear();
        played.address = {};
        if (changed) changed();
      }
      return make(family, type, protocol);
    };
  }
  [[nodiscard]] auto open(const cli::Filters& filters = {}) const {
    return CanCapture::open("can7", filters);
  }

  test::PlayedCan played;
  int sockets = 0;                ///< of CAN, so far
  std::function<void()> changed;  ///< what is otherwise from the recorder's own socket on
};

std::string why(int error) {
  return std::string{"cannot record interface 'can7': "} + std::strerror(error);
}

TEST_CASE("the recorder's socket is a raw one of CAN, bound to the interface by its index") {
  Opening opening;
  const test::PlayedCan& played = opening.played;
  const auto opened = opening.open();
  REQUIRE(opened);
  CHECK(opening.sockets == 2);
  CHECK(played.socket_type == (SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK));
  CHECK(played.socket_protocol == CAN_RAW);
  CHECK(played.address.can_family == AF_CAN);
  CHECK(played.address.can_ifindex == 7);
  CHECK(opened.value->name() == "can7");
  CHECK(opened.value->descriptor() == played.socket);
  CHECK(opened.value->state() == BusState::up);
  CHECK(opened.value->bit_rate() == 500'000);
}

TEST_CASE("the recorder's socket has error frames, CAN FD, times, a count of losses and 32 MiB of room") {
  Opening opening;
  test::PlayedCan& played = opening.played;
  REQUIRE(opening.open());
  CHECK(played.options[{SOL_CAN_RAW, CAN_RAW_ERR_FILTER}] == bytes_of(can_err_mask_t{0x1FFF'FFFF}));
  CHECK(played.options[{SOL_CAN_RAW, CAN_RAW_FD_FRAMES}] == bytes_of(int{1}));
  CHECK(played.options[{SOL_SOCKET, SO_TIMESTAMPNS}] == bytes_of(int{1}));
  CHECK(played.options[{SOL_SOCKET, SO_RXQ_OVFL}] == bytes_of(int{1}));
  CHECK(played.options[{SOL_SOCKET, SO_RCVBUFFORCE}] == bytes_of(int{33'554'432}));
  CHECK(played.options.count({SOL_SOCKET, SO_RCVBUF}) == 0);
  CHECK(played.options.count({SOL_CAN_RAW, CAN_RAW_FILTER}) == 0);  // all pass
}

TEST_CASE("a user who may not force the size of the recorder's queue asks for it") {
  Opening opening;
  test::PlayedCan& played = opening.played;
  played.option_errors[{SOL_SOCKET, SO_RCVBUFFORCE}] = EPERM;
  REQUIRE(opening.open());
  CHECK(played.options[{SOL_SOCKET, SO_RCVBUF}] == bytes_of(int{33'554'432}));
}

TEST_CASE("the recorder's filters work in the kernel") {
  const std::array<can_filter, 2> filters{
      {{0x123, 0x7FF}, {0x18FF'1234 | CAN_EFF_FLAG, CAN_EFF_MASK | CAN_EFF_FLAG}}};
  Opening opening;
  REQUIRE(opening.open(cli::Filters{filters.begin(), filters.end()}));
  CHECK(opening.played.options[{SOL_CAN_RAW, CAN_RAW_FILTER}] == bytes_of(filters));
}

TEST_CASE("an option that the recorder's socket cannot have is an error of recording") {
  const auto option =
      GENERATE(std::pair<int, int>{SOL_CAN_RAW, CAN_RAW_ERR_FILTER},
               std::pair<int, int>{SOL_CAN_RAW, CAN_RAW_FD_FRAMES},
               std::pair<int, int>{SOL_SOCKET, SO_TIMESTAMPNS}, std::pair<int, int>{SOL_SOCKET, SO_RXQ_OVFL},
               std::pair<int, int>{SOL_SOCKET, SO_RCVBUF}, std::pair<int, int>{SOL_CAN_RAW, CAN_RAW_FILTER});
  Opening opening;
  opening.changed = [&] {
    opening.played.option_errors[{SOL_SOCKET, SO_RCVBUFFORCE}] = EPERM;
    opening.played.option_errors[option] = ENOPROTOOPT;
  };
  const auto opened = opening.open({can_filter{0x123, 0x7FF}});
  CHECK_FALSE(opened);
  CHECK(opened.error.what == why(ENOPROTOOPT));
}

TEST_CASE("a socket of the recorder that cannot be made or bound says why") {
  Opening opening;
  SECTION("made") {
    opening.changed = [&] { opening.played.socket_error = EAFNOSUPPORT; };
    CHECK(opening.open().error == transport::can_socket_failure(EAFNOSUPPORT));
  }
  SECTION("bound") {
    opening.changed = [&] { opening.played.bind_error = ENODEV; };
    CHECK(opening.open().error.what == why(ENODEV));
  }
}

TEST_CASE("an interface that is gone before the recorder knows its index is not opened") {
  Opening opening;
  opening.played.link.reset();  // 0 would be all interfaces
  CHECK(opening.open().error == transport::detail::gone_failure("can7"));
}

TEST_CASE("what SocketCan says of a name is what the recorder says") {
  const test::PlayedCan played;
  CHECK(CanCapture::open("can8", {}).error == transport::SocketCan::open("can8").error);
  CHECK(CanCapture::open("can8", {}).error.what == "there is no interface 'can8'");
}

}  // namespace tool_record_opening_test
