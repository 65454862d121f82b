// What SocketCan says of frames that the kernel took, refused or could not have, on a kernel that is played:
// a full queue, an interface that goes down and one that is pulled out come at any time.
#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/any_text.hpp"
#include "ocm/transport/socketcan.hpp"

#include "unit/base/explore.hpp"
#include "unit/base/random.hpp"
#include "unit/transport/played_can.hpp"

namespace transport_socketcan_send_test {

using namespace ocm;
using test::netlink::bytes_of;
using transport::BusState;
using transport::SocketCan;

struct Scene {
  test::PlayedCan played;
  std::unique_ptr<SocketCan> bus = played.open();
};

const can::Frame classic = *can::parse_frame("605#00D2");
const can::AnyFrame fd = *can::parse_any_frame("123##1112233445566778899AABBCC");

TEST_CASE("a frame that the kernel has no room for is refused and counted, and the next one goes") {
  const int error = GENERATE(EAGAIN, ENOBUFS, ENOMEM);
  CAPTURE(std::strerror(error));
  Scene scene;
  scene.played.answers = {error, error};
  const auto refused = scene.bus->send(classic);
  REQUIRE(refused);
  CHECK_FALSE(*refused);
  CHECK_FALSE(*scene.bus->send_any(fd));
  CHECK(scene.bus->counters().refused == 2);
  CHECK(scene.bus->counters().sent == 0);
  CHECK(scene.bus->state() == BusState::up);
  CHECK(scene.played.taken.empty());

  CHECK(*scene.bus->send(classic));
  CHECK(*scene.bus->send_any(fd));
  CHECK(scene.bus->counters().sent == 2);
  CHECK(scene.played.taken ==
        std::vector{bytes_of(transport::to_socketcan(classic)), bytes_of(transport::to_socketcan_fd(fd))});
}

TEST_CASE("what is too long is an error where the interface has no CAN FD, and nothing else is") {
  const int error = GENERATE(EINVAL, EMSGSIZE);
  Scene scene;
  scene.played.mtu = CAN_MTU;
  scene.played.answers = {error};
  CHECK(scene.bus->send_any(fd).error == base::Error::bad_length);
  CHECK(scene.bus->state() == BusState::up);
  CHECK(*scene.bus->send(classic));

  scene.played.answers = {error};  // of 16 bytes it says something else
  CHECK(scene.bus->send(classic).error == base::Error::closed);
  CHECK_THAT(scene.bus->failure().what, Catch::Contains("cannot send on interface 'can7'"));
}

TEST_CASE("true is said of what the kernel took and of nothing else, whatever it answers") {
  const std::vector<int> errors = {EAGAIN, ENOBUFS, ENOMEM, ENETDOWN, ENODEV, ENXIO, EIO, EPERM};
  const int runs = test::explored(100);
  for (int run = 0; run < runs; ++run) {
    CAPTURE(run);
    test::Random random{static_cast<unsigned>(run)};
    Scene scene;
    std::vector<test::Bytes> taken;
    std::uint64_t refused = 0;
    BusState state = BusState::up;
    for (int i = 0; i < 50; ++i) {
      scene.played.asked = 0;
      scene.played.answers.assign(random.below(3), EINTR);  // each is tried again
      const int error = random.below(4) == 0
                            ? errors[random.below(i < 40 ? 4 : static_cast<std::uint32_t>(errors.size()))]
                            : 0;
      scene.played.answers.push_back(error);
      const int tries = static_cast<int>(scene.played.answers.size());
      const bool long_one = random.below(2) == 0;
      const auto result = long_one ? scene.bus->send_any(fd) : scene.bus->send(classic);
      if (state == BusState::closed) {
        CHECK(result.error == base::Error::closed);
        CHECK(scene.played.asked == 0);
        continue;
      }
      CHECK(scene.played.asked == tries);
      switch (error) {
        case 0:
          state = BusState::up;
          taken.push_back(long_one ? bytes_of(transport::to_socketcan_fd(fd))
                                   : bytes_of(transport::to_socketcan(classic)));
          break;
        case ENETDOWN:
          state = BusState::down;
          ++refused;
          break;
        case EAGAIN:
        case ENOBUFS:
        case ENOMEM:
          ++refused;
          break;
        default:
          state = BusState::closed;
          break;
      }
      CHECK(scene.bus->state() == state);
      if (state == BusState::closed) {
        CHECK(result.error == base::Error::closed);
        CHECK_THAT(scene.bus->failure().what, Catch::Contains("'can7'"));
      } else {
        REQUIRE(result);
        CHECK(*result == (error == 0));
      }
      CHECK(scene.bus->counters().sent == taken.size());
      CHECK(scene.bus->counters().refused == refused);
    }
    CHECK(scene.played.taken == taken);
  }
}

}  // namespace transport_socketcan_send_test
