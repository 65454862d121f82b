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

/// A frame in the queue of a socket, and what the kernel says of it.
struct Waiting {
  canfd_frame frame{};
  unsigned size = CAN_MTU;
  int flags = 0;
  timespec time{};
  std::uint32_t drops = 0;  ///< before it
  int level = SOL_SOCKET;   ///< of what is said of it

  void hand_out(mmsghdr& message) const {
    msghdr& header = message.msg_hdr;
    std::memcpy(header.msg_iov->iov_base, &frame, size);
    message.msg_len = size;
    header.msg_flags = flags;
    REQUIRE(header.msg_controllen >= CMSG_SPACE(sizeof time) + CMSG_SPACE(sizeof drops));
    std::memset(header.msg_control, 0, header.msg_controllen);
    cmsghdr* item = CMSG_FIRSTHDR(&header);
    const auto put = [&](int type, const auto& value) {
      item->cmsg_level = level;
      item->cmsg_type = type;
      item->cmsg_len = CMSG_LEN(sizeof value);
      std::memcpy(CMSG_DATA(item), &value, sizeof value);
    };
    put(SO_TIMESTAMPNS, time);
    std::size_t length = CMSG_SPACE(sizeof time);
    if (drops != 0) {  // as sock_recv_drops does
      item = CMSG_NXTHDR(&header, item);
      put(SO_RXQ_OVFL, drops);
      length += CMSG_SPACE(sizeof drops);
    }
    header.msg_controllen = length;
  }
};

/// One interface and one socket on it.
struct Kernel {
  int socket = -1;
  std::deque<Waiting> queue{};
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
    Waiting waiting;
    waiting.frame.can_id = 0x123;
    waiting.frame.len = sizeof number;
    std::memcpy(waiting.frame.data, &number, sizeof number);
    waiting.drops = drops;
    queue.push_back(waiting);
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
    kernel->queue.front().hand_out(messages[taken]);
    kernel->queue.pop_front();
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

TEST_CASE("what the kernel says of a frame is kept: when it came, who sent it, and how it was sent") {
  Scene scene;
  Waiting plain, sent, fd, longer;
  plain.frame.can_id = 0x123;
  plain.frame.len = 8;
  plain.time = {1'700'000'000, 123'456'789};
  sent.frame.can_id = 0x12345678 | CAN_EFF_FLAG;
  sent.flags = MSG_DONTROUTE;
  sent.time = {1'700'000'001, 999'999'999};
  fd.frame.len = 64;
  fd.frame.flags = CANFD_BRS;
  fd.frame.data[63] = 0xA5;
  fd.size = CANFD_MTU;
  longer.frame.len = 8;
  longer.frame.__res1 = 12;  // len8_dlc
  scene.played.queue = {plain, sent, fd, longer};
  std::array<log::Entry, Capture::batch> entries;
  REQUIRE(scene.capture->read(entries, 3) == 4);
  CHECK(entries[0].time.time_since_epoch() == std::chrono::nanoseconds{1'700'000'000'123'456'789});
  CHECK(entries[0].direction == log::Direction::received);
  CHECK(entries[0].interface == 3);
  CHECK(entries[0].raw_dlc == 0);
  CHECK(entries[1].time.time_since_epoch() == std::chrono::nanoseconds{1'700'000'001'999'999'999});
  CHECK(entries[1].direction == log::Direction::sent);
  CHECK(entries[1].format == can::Format::extended);
  CHECK(entries[2].length == 64);
  CHECK(entries[2].flags == (log::flag::fd | CANFD_BRS));
  CHECK(entries[2].data[63] == 0xA5);
  CHECK(entries[3].raw_dlc == 12);
}

TEST_CASE("the code of a length above eight is kept of a classic frame of eight bytes, and of no other") {
  struct Row {
    std::uint32_t id;
    std::uint8_t length, code;
    can::Format format;
    std::uint8_t kept;
  };
  for (const Row& row : {Row{0x7FF, 8, 9, can::Format::base, 9}, Row{0x7FF, 8, 15, can::Format::base, 15},
                         Row{0x7FF, 8, 8, can::Format::base, 0}, Row{0x7FF, 8, 16, can::Format::base, 0},
                         Row{0x7FF, 7, 9, can::Format::base, 0},
                         Row{0x1FFFFFFF | CAN_EFF_FLAG, 8, 9, can::Format::extended, 9},
                         Row{0x123 | CAN_RTR_FLAG, 8, 9, can::Format::base_remote, 9},
                         Row{0x123 | CAN_EFF_FLAG | CAN_RTR_FLAG, 8, 9, can::Format::extended_remote, 9},
                         Row{0x40 | CAN_ERR_FLAG, 8, 9, can::Format::error, 0}}) {
    CAPTURE(row.id, row.length, row.code);
    Scene scene;
    Waiting waiting;
    waiting.frame.can_id = row.id;
    waiting.frame.len = row.length;
    waiting.frame.__res1 = row.code;  // len8_dlc
    scene.played.queue = {waiting};
    std::array<log::Entry, Capture::batch> entries;
    REQUIRE(scene.capture->read(entries, 0) == 1);
    CHECK(entries[0].id == (row.id & CAN_EFF_MASK));
    CHECK(entries[0].format == row.format);
    CHECK(entries[0].length == row.length);
    CHECK(entries[0].raw_dlc == row.kept);
  }
}

TEST_CASE("what is said of a frame at another level than the socket's is neither a time nor a loss") {
  for (const int level : {SOL_SOCKET, SOL_CAN_RAW}) {
    CAPTURE(level);
    Scene scene;
    Waiting waiting;
    waiting.time = {1'700'000'000, 5};
    waiting.drops = 7;
    waiting.level = level;
    scene.played.queue = {waiting};
    std::array<log::Entry, Capture::batch> entries;
    REQUIRE(scene.capture->read(entries, 0) == 1);
    const bool ours = level == SOL_SOCKET;
    CHECK(entries[0].time.time_since_epoch() ==
          std::chrono::nanoseconds{ours ? 1'700'000'000'000'000'005 : 0});
    CHECK(scene.capture->lost() == (ours ? 7U : 0U));
  }
}

TEST_CASE("what was dropped is known with the next frame, without a look") {
  Scene scene;
  scene.played.room = 10;
  scene.arrive(25);
  CHECK(scene.read() == 10);
  CHECK(scene.capture->lost() == 0);
  scene.arrive(1);
  CHECK(scene.read() == 1);
  CHECK(scene.capture->lost() == 15);
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

TEST_CASE("a read that a signal cuts short has no frame, and nothing is lost by it") {
  Scene scene;
  scene.arrive(3);
  scene.played.set_error(EINTR);
  CHECK(scene.read() == 0);
  CHECK(scene.capture->state() == BusState::up);
  CHECK(scene.read() == 3);
  CHECK(scene.read() == 0);
  CHECK(scene.capture->state() == BusState::up);
}

TEST_CASE("of a CAN interface the kernel keeps the times, and an adapter may be plugged in again") {
  const Scene scene;
  CHECK(scene.capture->name() == "can7");
  CHECK(scene.capture->descriptor() == scene.played.socket);
  CHECK(scene.capture->keeps_times());
  CHECK(scene.capture->may_return());
  CHECK(scene.capture->bit_rate() == 0);  // of a socket alone it is not known
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
