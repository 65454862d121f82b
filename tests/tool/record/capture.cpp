// The recorder's socket on a kernel that is played: in the order of the real one, an error of the socket
// comes once and before the frames that wait [net/core/datagram.c, __skb_try_recv_datagram].
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstring>
#include <deque>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <random>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>

#include <catch2/catch.hpp>

#include "cli/record/can_capture.hpp"

namespace tool_record_capture_test {

/// One interface and one socket on it.
struct Kernel {
  int socket = -1;
  std::deque<canfd_frame> queue{};
  std::deque<int> errors{};  ///< that are to be reported
  std::size_t room = 1000;
  std::uint32_t drops = 0;
  bool up = true;
  bool gone = false;
  int lasting = 0;  ///< an error that is reported each time

  void arrive(std::uint32_t number) {
    if (queue.size() >= room) {
      ++drops;
      return;
    }
    canfd_frame frame{};
    frame.can_id = 0x123;
    frame.len = sizeof number;
    std::memcpy(frame.data, &number, sizeof number);
    queue.push_back(frame);
  }
  void set_error(int error) { errors.assign(1, error); }  // a socket has room for one
  void go_down() {
    up = false;
    set_error(ENETDOWN);
  }
  void pull_out() {
    up = false;
    gone = true;
    set_error(ENODEV);
  }
  /// 0, or what recvmsg reports before it looks at the queue.
  int error() {
    if (lasting != 0) return lasting;
    if (errors.empty()) return queue.empty() ? EAGAIN : 0;
    const int first = errors.front();
    errors.pop_front();
    return first;
  }
};

Kernel* kernel = nullptr;

bool is_played(int file) {
  return kernel != nullptr && file == kernel->socket;
}
int fail(int error) {
  errno = error;
  return -1;
}

}  // namespace tool_record_capture_test

using tool_record_capture_test::fail;
using tool_record_capture_test::is_played;
using tool_record_capture_test::kernel;

extern "C" {

int recvmmsg(int file, mmsghdr* messages, unsigned count, int flags, timespec* timeout) {
  if (!is_played(file))
    return static_cast<int>(::syscall(SYS_recvmmsg, file, messages, count, flags, timeout));
  if (const int error = kernel->error(); error != 0) return fail(error);
  unsigned taken = 0;
  for (; taken < count && !kernel->queue.empty(); ++taken) {
    msghdr& header = messages[taken].msg_hdr;
    std::memcpy(header.msg_iov->iov_base, &kernel->queue.front(), CAN_MTU);
    kernel->queue.pop_front();
    messages[taken].msg_len = CAN_MTU;
    header.msg_flags = 0;
    header.msg_controllen = 0;
  }
  return static_cast<int>(taken);
}

ssize_t recv(int file, void* bytes, std::size_t size, int flags) {
  if (!is_played(file)) return ::syscall(SYS_recvfrom, file, bytes, size, flags, nullptr, nullptr);
  REQUIRE((flags & MSG_PEEK) != 0);
  const int error = kernel->error();
  return error != 0 ? fail(error) : 0;
}

int getsockopt(int file, int level, int name, void* value, socklen_t* size) noexcept {
  if (!is_played(file)) return static_cast<int>(::syscall(SYS_getsockopt, file, level, name, value, size));
  if (level != SOL_SOCKET || name != SO_MEMINFO) return fail(ENOPROTOOPT);
  static_cast<std::uint32_t*>(value)[SK_MEMINFO_DROPS] = kernel->drops;
  return 0;
}

int ioctl(int file, unsigned long request, ...) noexcept {
  va_list rest;
  va_start(rest, request);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  if (!is_played(file)) return static_cast<int>(::syscall(SYS_ioctl, file, request, argument));
  if (kernel->gone) return fail(ENODEV);
  if (request == SIOCGIFFLAGS) static_cast<ifreq*>(argument)->ifr_flags = kernel->up ? IFF_UP : 0;
  return 0;
}

}  // extern "C"

namespace tool_record_capture_test {

using namespace ocm;
using cli::record::CanCapture;
using cli::record::Capture;
using transport::BusState;

class Scene {
 public:
  Scene() {
    host::Descriptor socket{::eventfd(0, EFD_CLOEXEC)};
    REQUIRE(socket);
    played.socket = socket.get();
    kernel = &played;
    capture = CanCapture::of(std::move(socket), "can7", 7);
  }
  ~Scene() { kernel = nullptr; }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  void arrive(int count) {
    for (; count > 0; --count) played.arrive(offered++);
  }
  std::size_t read() {
    std::array<log::Entry, Capture::batch> entries;
    const std::size_t count = capture->read(entries, 0);
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t number = 0;
      std::memcpy(&number, entries[i].data.data(), sizeof number);
      CHECK(number >= next);  // in order, none twice
      next = number + 1;
    }
    taken += count;
    return count;
  }
  /// What it says to be received and lost is all that came.
  void judge() const {
    CHECK(capture->state() == BusState::closed);
    CHECK(played.queue.empty());
    CHECK(taken + capture->lost() == offered);
    CHECK_FALSE(capture->failure().what.empty());
  }

  Kernel played;
  std::unique_ptr<CanCapture> capture;
  std::uint32_t offered = 0, next = 0;
  std::uint64_t taken = 0;
};

TEST_CASE("an interface is pulled out while frames wait: they are read before it is closed") {
  Scene scene;
  scene.arrive(150);
  scene.played.pull_out();
  CHECK(scene.read() == 64);
  CHECK(scene.capture->state() != BusState::closed);
  CHECK(scene.read() == 64);
  CHECK(scene.read() == 22);
  CHECK(scene.read() == 0);
  CHECK_THAT(scene.capture->failure().what, Catch::Contains("can7") && Catch::Contains("is gone"));
  scene.judge();
}

TEST_CASE("it is the look that finds the interface gone: what waits is read all the same") {
  Scene scene;
  scene.arrive(3);
  scene.played.pull_out();
  scene.capture->look();
  CHECK(scene.capture->state() != BusState::closed);
  CHECK(scene.read() == 3);
  scene.capture->look();
  scene.judge();
}

TEST_CASE("an interface goes down while frames wait: they come with the same call") {
  Scene scene;
  scene.arrive(3);
  scene.played.go_down();
  CHECK(scene.read() == 3);
  scene.capture->look();
  CHECK(scene.capture->state() == BusState::down);
  scene.played.up = true;
  scene.capture->look();
  CHECK(scene.capture->state() == BusState::up);
}

TEST_CASE("what was dropped before the interface went is counted") {
  Scene scene;
  scene.played.room = 10;
  scene.arrive(25);
  scene.played.pull_out();
  while (scene.read() != 0) {
  }
  CHECK(scene.capture->lost() == 15);
  scene.judge();
}

TEST_CASE("an error that does not go away ends it") {
  Scene scene;
  scene.played.lasting = EIO;
  CHECK(scene.read() == 0);
  CHECK(scene.capture->state() == BusState::closed);
  CHECK_THAT(scene.capture->failure().what, Catch::Contains("can7") && !Catch::Contains("is gone"));
}

TEST_CASE("in any order of frames, losses, errors, looks and reads every frame is received or counted") {
  for (unsigned seed = 1; seed <= 3000; ++seed) {
    INFO("seed " << seed);
    std::mt19937 random{seed};
    const auto below = [&](unsigned n) { return static_cast<int>(random() % n); };
    Scene scene;
    scene.played.room = 1 + random() % 200;
    for (int step = below(40); step > 0; --step) {
      switch (below(5)) {
        case 0:
        case 1:
          scene.arrive(below(100));
          break;
        case 2:
          scene.read();
          break;
        case 3:
          scene.capture->look();
          break;
        default:
          if (scene.played.up)
            scene.played.go_down();
          else
            scene.played.up = true;
      }
    }
    scene.played.pull_out();
    for (int more = 0; more < 1000 && scene.capture->state() != BusState::closed; ++more) {
      if (below(3) == 0)
        scene.capture->look();
      else
        scene.read();
    }
    scene.judge();
  }
}

}  // namespace tool_record_capture_test
