// What SocketCan says of frames that the kernel took, refused or could not have, on a kernel that is played:
// a full queue, an interface that goes down and one that is pulled out come at any time.
#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <deque>
#include <memory>
#include <net/if.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/any_text.hpp"
#include "ocm/transport/socketcan.hpp"

#include "unit/base/explore.hpp"
#include "unit/base/random.hpp"

namespace transport_socketcan_send_test {

/// One interface, can7, and the socket on it.
struct Kernel {
  int socket = -1;
  int mtu = CANFD_MTU;
  std::deque<int> answers{};  ///< of the next sends: 0 or errno
  std::vector<std::vector<std::byte>> taken{};
  int asked = 0;
};

Kernel* kernel = nullptr;

bool is_played(int file) {
  return kernel != nullptr && kernel->socket >= 0 && file == kernel->socket;
}
int fail(int error) {
  errno = error;
  return -1;
}

}  // namespace transport_socketcan_send_test

using transport_socketcan_send_test::fail;
using transport_socketcan_send_test::is_played;
using transport_socketcan_send_test::kernel;

extern "C" {

int socket(int family, int type, int protocol) noexcept {
  if (kernel == nullptr || family != PF_CAN)
    return static_cast<int>(::syscall(SYS_socket, family, type, protocol));
  return kernel->socket = ::eventfd(0, EFD_CLOEXEC);
}

int bind(int file, const sockaddr* address, socklen_t size) noexcept {
  return is_played(file) ? 0 : static_cast<int>(::syscall(SYS_bind, file, address, size));
}

int setsockopt(int file, int level, int name, const void* value, socklen_t size) noexcept {
  return is_played(file) ? 0 : static_cast<int>(::syscall(SYS_setsockopt, file, level, name, value, size));
}

int ioctl(int file, unsigned long request, ...) noexcept {
  va_list rest;
  va_start(rest, request);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  if (!is_played(file)) return static_cast<int>(::syscall(SYS_ioctl, file, request, argument));
  auto* const asked = static_cast<ifreq*>(argument);
  switch (request) {
    case SIOCGIFINDEX:
      asked->ifr_ifindex = 7;
      return 0;
    case SIOCGIFHWADDR:
      asked->ifr_hwaddr.sa_family = ocm::transport::can_hardware_type;
      return 0;
    case SIOCGIFFLAGS:
      asked->ifr_flags = IFF_UP;
      return 0;
    case SIOCGIFMTU:
      asked->ifr_mtu = kernel->mtu;
      return 0;
    default:
      return 0;
  }
}

ssize_t send(int file, const void* bytes, std::size_t size, int flags) {
  if (!is_played(file)) return ::syscall(SYS_sendto, file, bytes, size, flags, nullptr, 0);
  ++kernel->asked;
  const int error = kernel->answers.empty() ? 0 : kernel->answers.front();
  if (!kernel->answers.empty()) kernel->answers.pop_front();
  if (error != 0) return fail(error);
  const auto* const begin = static_cast<const std::byte*>(bytes);
  kernel->taken.emplace_back(begin, begin + size);
  return static_cast<ssize_t>(size);
}

}  // extern "C"

namespace transport_socketcan_send_test {

using namespace ocm;
using transport::BusState;
using transport::SocketCan;

class Scene {
 public:
  Scene() {
    kernel = &played;
    auto opened = SocketCan::open("can7");
    CAPTURE(opened.error.what);
    REQUIRE(opened);
    bus = std::move(opened.value);
  }
  ~Scene() { kernel = nullptr; }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  Kernel played;
  std::unique_ptr<SocketCan> bus;
};

template <class Raw>
std::vector<std::byte> bytes_of(const Raw& raw) {
  const auto* const begin = reinterpret_cast<const std::byte*>(&raw);
  return {begin, begin + sizeof raw};
}

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
    std::vector<std::vector<std::byte>> taken;
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
