// What is asked over rtnetlink, and what is made of answers that come late, in parts or not at all, on a
// kernel that is played.
#include <cerrno>
#include <cstring>
#include <deque>
#include <optional>
#include <sys/eventfd.h>

#include <catch2/catch.hpp>

#include "ocm/transport/controller_state.hpp"
#include "ocm/transport/interfaces.hpp"

#include "unit/transport/netlink_answer.hpp"
#include "unit/transport/played_kernel.hpp"

namespace transport_interfaces_netlink_test {

using namespace ocm;
using namespace test::netlink;
using transport::CanInterface;

/// A netlink socket that answers one question.
struct Netlink {
  struct Answer {
    int error = 0;
    Bytes bytes{};
  };
  Netlink() {
    kernel.socket = [this](int family, int type, int protocol) {
      asked_for = {family, type, protocol};
      if (socket_error != 0) return test::failed(socket_error);
      const int file = ::eventfd(0, EFD_CLOEXEC);
      kernel.files.push_back(file);
      return file;
    };
    kernel.send = [this](int, const void* bytes, std::size_t size, int) -> ssize_t {
      const auto* const begin = static_cast<const std::byte*>(bytes);
      question.assign(begin, begin + size);
      return send_error == 0 ? static_cast<ssize_t>(size) : test::failed(send_error);
    };
    kernel.recv = [this](int, void* bytes, std::size_t size) -> ssize_t {
      room = size;
      if (answers.empty()) return test::failed(EIO);
      const Answer answer = answers.front();
      answers.pop_front();
      if (answer.error != 0) return test::failed(answer.error);
      std::copy(answer.bytes.begin(), answer.bytes.end(), static_cast<std::byte*>(bytes));
      return static_cast<ssize_t>(answer.bytes.size());
    };
  }
  Netlink(const Netlink&) = delete;
  Netlink& operator=(const Netlink&) = delete;

  test::PlayedKernel kernel;
  std::array<int, 3> asked_for{};
  int socket_error = 0;
  int send_error = 0;
  std::size_t room = 0;
  Bytes question;
  std::deque<Answer> answers;
};

/// The question for links.
Bytes question(unsigned flags, int index) {
  nlmsghdr header{};
  header.nlmsg_len = 32;
  header.nlmsg_type = RTM_GETLINK;
  header.nlmsg_flags = static_cast<std::uint16_t>(flags);
  ifinfomsg body{};
  body.ifi_index = index;
  return bytes_of(header) + bytes_of(body);
}
const Bytes done = message(NLMSG_DONE, bytes_of(0));
const CanInterface can0{
    .name = "can0", .index = 4, .up = true, .kind = "can", .bit_rate = 500'000, .bus_off = false, .sent = 41};
const CanInterface can1{
    .name = "can1", .index = 5, .up = false, .kind = "can", .bit_rate = 125'000, .bus_off = true, .sent = 7};
Bytes failure_of_netlink() {
  return message(NLMSG_ERROR, bytes_of(-1));
}
host::Failure unknown(int error) {
  return {std::string("cannot list the network interfaces (") + std::strerror(error) + ")",
          "if a sandbox forbids netlink sockets, run outside of it", host::Cause::interfaces_unknown};
}

TEST_CASE("netlink: all interfaces are asked for at once, and read until the kernel is done") {
  Netlink netlink;
  netlink.answers = {{0, link(can0)}, {EINTR, {}}, {0, link(can1)}, {0, done}};
  const auto found = transport::query_can_interfaces();
  REQUIRE(found);
  CHECK(*found == std::vector{can0, can1});
  CHECK(netlink.question == question(NLM_F_REQUEST | NLM_F_DUMP, 0));
  CHECK(netlink.asked_for == std::array{AF_NETLINK, int{SOCK_RAW} | int{SOCK_CLOEXEC}, NETLINK_ROUTE});
  CHECK(netlink.room == 65'536);
  CHECK(netlink.answers.empty());
}

TEST_CASE("netlink: one interface is asked for by its index, and its first answer is the whole one") {
  Netlink netlink;
  netlink.answers = {{0, link(can1)}};
  CHECK(transport::query_can_interface(5) == can1);
  CHECK(netlink.question == question(NLM_F_REQUEST, 5));
}

TEST_CASE("netlink: two interfaces are no answer to a question for one") {
  Netlink netlink;
  netlink.answers = {{0, link(can0) + link(can1)}};
  CHECK_FALSE(transport::query_can_interface(4));
}

TEST_CASE("netlink: why the interfaces cannot be listed") {
  Netlink netlink;
  SECTION("no socket") {
    netlink.socket_error = EPERM;
    CHECK(transport::query_can_interfaces().error == unknown(EPERM));
    CHECK(netlink.question.empty());
  }
  SECTION("a question that is not taken") {
    netlink.send_error = ENOBUFS;
    CHECK(transport::query_can_interfaces().error == unknown(ENOBUFS));
  }
  SECTION("an answer that is lost") {
    netlink.answers = {{0, link(can0)}, {ENOBUFS, {}}};
    CHECK(transport::query_can_interfaces().error == unknown(ENOBUFS));
  }
  SECTION("an empty answer") {
    netlink.answers = {{0, {}}};
    CHECK(transport::query_can_interfaces().error == unknown(EPROTO));
  }
  SECTION("a refusal") {
    netlink.answers = {{0, failure_of_netlink()}};
    CHECK(transport::query_can_interfaces().error == unknown(EPROTO));
  }
  CHECK(transport::can_interfaces().empty());
  CHECK_FALSE(transport::query_can_interface(4));
}

TEST_CASE("netlink: a controller is asked for by the index of its interface") {
  Netlink netlink;
  netlink.answers = {{0, link(can0, CAN_STATE_ERROR_PASSIVE)}};
  const auto now = transport::query_controller(4);
  REQUIRE(now);
  CHECK(now->state == can::ControllerState::passive);
  CHECK_FALSE(now->counters);
  CHECK(netlink.question == question(NLM_F_REQUEST, 4));
  CHECK(netlink.asked_for == std::array{AF_NETLINK, int{SOCK_RAW} | int{SOCK_CLOEXEC}, NETLINK_ROUTE});
  CHECK(netlink.room == 32'768);
}

TEST_CASE("netlink: a controller of which nothing can be asked is not known") {
  Netlink netlink;
  netlink.answers = {{0, link(can0)}};
  SECTION("no socket") {
    netlink.socket_error = EPERM;
    CHECK_FALSE(transport::query_controller(4));
    CHECK(netlink.question.empty());
  }
  SECTION("a question that is not taken") {
    netlink.send_error = ENOBUFS;
    CHECK_FALSE(transport::query_controller(4));
    CHECK(netlink.answers.size() == 1);
  }
  SECTION("an answer that is lost") {
    netlink.answers = {{ENOBUFS, {}}};
    CHECK_FALSE(transport::query_controller(4));
  }
  SECTION("an empty answer") {
    netlink.answers = {{0, {}}};
    CHECK_FALSE(transport::query_controller(4));
  }
}

TEST_CASE("netlink: whether there is CAN is asked by a socket of it") {
  Netlink netlink;
  CHECK(transport::can_support());
  CHECK(netlink.asked_for == std::array{PF_CAN, int{SOCK_RAW} | int{SOCK_CLOEXEC}, int{CAN_RAW}});
  netlink.socket_error = EPROTONOSUPPORT;
  const auto without = transport::can_support();
  REQUIRE_FALSE(without);
  CHECK(without.error == transport::can_socket_failure(EPROTONOSUPPORT));
  CHECK(without.error.remedy == "sudo modprobe can_raw");
}

}  // namespace transport_interfaces_netlink_test
