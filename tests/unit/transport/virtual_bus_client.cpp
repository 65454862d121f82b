// What a client of the virtual bus does while its server is slow, stopped, gone or wrong. The server is the
// other end of a pair of sockets; time, and errors of the sockets, are played.
#include <cerrno>
#include <cstring>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/any_text.hpp"
#include "ocm/can/text.hpp"
#include "ocm/transport/virtual_bus.hpp"

#include "unit/can/frame_of.hpp"
#include "unit/host/host_testing.hpp"
#include "unit/transport/played_kernel.hpp"

namespace transport_virtual_bus_client_test {

namespace vb = ocm::transport::virtual_bus;
using namespace ocm;
using namespace std::chrono_literals;
using base::Error;
using host::Cause;
using test::frame;
using transport::BusState;
using transport::Failure;
using transport::VirtualBus;
using Texts = std::vector<std::string>;
using Waits = std::vector<test::PlayedKernel::Wait>;

constexpr vb::Hello greeting{.fd = 4, .bit_rate = 500'000, .credit = 2, .name = {'r', 'o', 'b', 'o', 't'}};

/// A client and the server's end of its socket.
struct Scene {
  Scene() {
    int ends[2] = {-1, -1};
    REQUIRE(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) == 0);
    client = host::Descriptor{ends[0]};
    server = host::Descriptor{ends[1]};
    file = client.get();
    kernel.files = {file};
    kernel.ready = [this](short events) {
      pollfd entry{file, events, 0};
      if (!send_errors.empty()) entry.events = static_cast<short>(entry.events & ~POLLOUT);
      const timespec now{};
      timespec left = now;
      ::syscall(SYS_ppoll, &entry, 1, &left, nullptr, 0);
      return std::exchange(wake, false) ? static_cast<short>(POLLIN) : entry.revents;
    };
    kernel.send = [this](int, const void* bytes, std::size_t size, int flags) -> ssize_t {
      ++sends;
      if (!send_errors.empty()) {
        const int error = send_errors.front();
        send_errors.pop_front();
        return test::failed(error);
      }
      return ::syscall(SYS_sendto, file, bytes, size, flags, nullptr, 0);
    };
    kernel.recvmmsg = [this](int, mmsghdr* messages, unsigned count) {
      if (!read_errors.empty()) {
        const int error = read_errors.front();
        read_errors.pop_front();
        return test::failed(error);
      }
      return static_cast<int>(::syscall(SYS_recvmmsg, file, messages, count, MSG_DONTWAIT, nullptr));
    };
    kernel.getsockopt = [this](int, int, int, void* value, socklen_t*) {
      if (peer.pid < 0) return test::failed(ENOPROTOOPT);
      std::memcpy(value, &peer, sizeof peer);
      return 0;
    };
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  transport::Outcome<std::unique_ptr<VirtualBus>> try_open(base::Duration patience = 2s) {
    return VirtualBus::on(std::move(client), "sim:/run/x", "/run/x", patience);
  }
  /// Opens a client whose server has greeted before, and begins to count.
  void open(const vb::Hello& hello = greeting) {
    say(hello);
    auto opened = try_open();
    INFO(opened.error.what);
    REQUIRE(opened);
    bus = std::move(opened.value);
    heard();
    sends = 0;
    kernel.waits.clear();
    begin = kernel.steady;
  }
  template <std::size_t n>
  void say(const std::array<vb::Record, n>& records) const {
    put(records.data(), sizeof records);
  }
  template <class T>
  void say(const T& content) const {
    const vb::Record record = vb::to_record(content);
    put(record.data(), record.size());
  }
  void put(const void* bytes, std::size_t size) const {
    REQUIRE(::send(server.get(), bytes, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size));
  }
  void hang_up() { server.reset(); }
  /// The messages that the client has sent, each as its records.
  std::vector<std::vector<vb::Record>> heard() const {
    std::vector<std::vector<vb::Record>> all;
    std::vector<vb::Record> message(vb::max_records + 1);
    for (;;) {
      const ssize_t size =
          ::recv(server.get(), message.data(), message.size() * vb::record_size, MSG_DONTWAIT);
      if (size <= 0) return all;
      all.emplace_back(message.begin(), message.begin() + size / static_cast<ssize_t>(vb::record_size));
    }
  }
  Texts received() const {
    Texts texts;
    while (const auto one = bus->receive(0ns)) texts.emplace_back(can::to_text(one->frame).view());
    return texts;
  }
  [[nodiscard]] base::Duration passed() const { return kernel.steady - begin; }

  test::PlayedKernel kernel;
  host::Descriptor client;
  host::Descriptor server;
  int file = -1;
  base::Time begin = kernel.steady;
  std::deque<int> send_errors;
  std::deque<int> read_errors;
  int sends = 0;
  bool wake = false;
  ucred peer{.pid = 77, .uid = ::geteuid(), .gid = 0};
  std::unique_ptr<VirtualBus> bus;
};

vb::Count credit(std::uint64_t count) {
  return {.type = vb::Type::credit, .count = count};
}
const std::string simulator = "the simulator (process 77) on '/run/x'";
const Failure gone{simulator + " is gone", "start it again; if it crashed, please report what it said last",
                   Cause::simulator_gone};
const Failure not_understood{simulator + " said something that this program does not know",
                             "use the simulator and the program of the same version of ocm"};
const std::string stuck =
    "it may be stopped (Ctrl-Z): continue it (fg) or end it; `fuser /run/x` names its process";

// --- greeting ---

TEST_CASE("virtual bus client: it greets, knows CAN FD, and takes what the server says of the bus") {
  Scene scene;
  scene.say(greeting);
  const auto bus = scene.try_open();
  REQUIRE(bus);
  CHECK(scene.heard() == std::vector<std::vector<vb::Record>>{{vb::to_record(vb::Hello{.fd = 1})}});
  CHECK((*bus)->name() == "sim:/run/x");
  CHECK((*bus)->bus_name() == "robot");
  CHECK((*bus)->bit_rate() == 500'000);
  CHECK((*bus)->data_bit_rate() == 2'000'000);
  CHECK((*bus)->credit() == 2);
  CHECK((*bus)->descriptor() == scene.file);
  CHECK((*bus)->fd_obstacle() == Failure{});
}

TEST_CASE("virtual bus client: a name of twelve characters has no zero behind it") {
  Scene scene;
  auto hello = greeting;
  hello.name.fill('x');
  scene.open(hello);
  CHECK(scene.bus->bus_name() == "xxxxxxxxxxxx");
}

TEST_CASE("virtual bus client: a greeting is waited for as long as chosen") {
  Scene scene;
  const auto bus = scene.try_open(70ms);
  REQUIRE_FALSE(bus);
  CHECK(bus.error == Failure{"the simulator (process 77) does not answer on '/run/x'", stuck});
  CHECK(scene.passed() == 70ms);
  CHECK(scene.kernel.waits == Waits{{POLLIN, 70ms}});
}

TEST_CASE("virtual bus client: a greeting may come late") {
  Scene scene;
  scene.kernel.later(30ms, [&] { scene.say(greeting); });
  CHECK(scene.try_open(70ms));
  CHECK(scene.passed() == 30ms);
}

TEST_CASE("virtual bus client: what wakes it without a greeting does not prolong the wait for it") {
  Scene scene;
  scene.kernel.later(30ms, [&] { scene.wake = true; });
  CHECK_FALSE(scene.try_open(70ms));
  CHECK(scene.kernel.waits == Waits{{POLLIN, 70ms}, {POLLIN, 40ms}});
}

TEST_CASE("virtual bus client: a greeting for which the socket has no room is said again") {
  Scene scene;
  scene.send_errors = {EAGAIN, EAGAIN};
  scene.kernel.later(20ms, [&] { scene.say(greeting); });
  scene.kernel.later(5ms, [&] { scene.wake = true; });
  const auto bus = scene.try_open(70ms);
  REQUIRE(bus);
  CHECK(scene.kernel.waits[0] == test::PlayedKernel::Wait{POLLIN | POLLOUT, 70ms});
  CHECK(scene.heard().size() == 1);
}

TEST_CASE("virtual bus client: a server whose process is not known has no number") {
  Scene scene;
  scene.peer.pid = GENERATE(-1, 0);
  CHECK(scene.try_open(1ms).error.what == "the simulator does not answer on '/run/x'");
}

TEST_CASE("virtual bus client: a greeting of something else is not understood") {
  auto hello = greeting;
  SECTION("another magic number") {
    hello.magic ^= 1;
  }
  SECTION("another version") {
    hello.version = 2;
  }
  SECTION("no bit rate") {
    hello.bit_rate = 0;
  }
  Scene scene;
  scene.say(hello);
  CHECK(scene.try_open().error == not_understood);
}

TEST_CASE("virtual bus client: a server that hangs up before it greets is gone") {
  Scene scene;
  scene.hang_up();
  CHECK(scene.try_open().error == gone);
  CHECK(scene.kernel.waits.empty());
}

TEST_CASE("virtual bus client: each reason of a server has its words") {
  const auto words = [](const vb::Goodbye& goodbye) {
    Scene scene;
    scene.say(goodbye);
    return scene.try_open().error;
  };
  using vb::Reason;
  const Failure ended{simulator + " was ended", "start it again", Cause::simulator_missing};
  CHECK(words({.reason = Reason::ended}) == ended);
  CHECK(words({.reason = Reason::leaving}) == ended);
  CHECK(words({.reason = Reason::full}) ==
        Failure{simulator + " has no file descriptor left for this program",
                "close other programs on the bus, or raise the simulator's limit: ulimit -n"});
  CHECK(words({.reason = Reason::other_user}) ==
        Failure{simulator + " belongs to another user", "start one of your own", Cause::simulator_foreign});
  CHECK(words({.reason = Reason::bad_version, .version = 9, .detail = 1}) ==
        Failure{simulator + " speaks version 9 of the virtual bus's protocol, this program version 1",
                "use the simulator and the program of the same version of ocm"});
  CHECK(words({.reason = Reason::bad_dlc, .detail = 9}) ==
        Failure{simulator + " disconnected this program: it sent a frame with DLC 9; at most 8",
                "this is a fault of this program, or of another version of ocm: please report it"});
}

// --- connecting ---

/// What `open` answers where the kernel refuses to connect.
Failure refused(int error) {
  test::PlayedKernel kernel;
  kernel.connect = [error](int, const sockaddr*) { return test::failed(error); };
  const auto bus = VirtualBus::open("/run/x");
  CHECK_FALSE(bus);
  return bus.error;
}

TEST_CASE("virtual bus client: why it cannot connect") {
  const Failure missing{"no simulator is running: no program listens on '/run/x'", "start one",
                        Cause::simulator_missing};
  for (const int error : {ENOENT, ENOTDIR, ECONNREFUSED}) CHECK(refused(error) == missing);
  CHECK(refused(EAGAIN) == Failure{"the simulator on '/run/x' does not answer", stuck});
  const Failure forbidden{"not allowed to connect to '/run/x'",
                          "a simulator serves its own user only: start one of your own",
                          Cause::simulator_private};
  for (const int error : {EACCES, EPERM}) CHECK(refused(error) == forbidden);
  CHECK(refused(EPROTOTYPE) ==
        Failure{"'/run/x' is a socket, but not of a simulator", "name another path", Cause::no_simulator});
  CHECK(refused(ENOMEM) ==
        Failure{std::string("cannot connect to the simulator on '/run/x': ") + std::strerror(ENOMEM),
                "start one", Cause::simulator_missing});
}

/// `open` on a socket of a played kernel, which is one end of a pair.
struct Connecting : Scene {
  Connecting() {
    kernel.socket = [this](int family, int type, int) {
      asked_for = {family, type};
      return socket_error == 0 ? std::exchange(next, -1) : test::failed(socket_error);
    };
    next = ::dup(file);
    client.reset();
    file = next;
    kernel.files = {file};
    kernel.connect = [this](int, const sockaddr*) {
      if (connect_errors.empty()) return 0;
      const int error = connect_errors.front();
      connect_errors.pop_front();
      return test::failed(error);
    };
    kernel.setsockopt = [this](int, int level, int name, const void* value, socklen_t) {
      if (level == SOL_SOCKET && name == SO_SNDTIMEO) std::memcpy(&send_limit, value, sizeof send_limit);
      return 0;
    };
  }
  int next = -1;
  int socket_error = 0;
  std::pair<int, int> asked_for{};
  std::deque<int> connect_errors;
  timeval send_limit{};
};

TEST_CASE("virtual bus client: it connects for as long as chosen, on a socket that keeps messages apart") {
  Connecting scene;
  scene.say(greeting);
  const auto bus = VirtualBus::open("/run/x", 1500ms);
  INFO(bus.error.what);
  REQUIRE(bus);
  CHECK(scene.asked_for == std::pair<int, int>{AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC});
  CHECK(scene.send_limit.tv_sec == 1);
  CHECK(scene.send_limit.tv_usec == 500'000);
  CHECK((*bus)->name() == "sim:/run/x");
}

TEST_CASE("virtual bus client: the bus of the default path is called sim") {
  Connecting scene;
  scene.say(greeting);
  const auto bus = VirtualBus::open();
  REQUIRE(bus);
  CHECK((*bus)->name() == "sim");
}

TEST_CASE("virtual bus client: two seconds are what a server has, unless told") {
  Connecting scene;
  CHECK_FALSE(VirtualBus::open("/run/x"));
  CHECK(scene.passed() == 2s);
}

TEST_CASE("virtual bus client: a signal while it connects changes nothing") {
  Connecting scene;
  scene.say(greeting);
  scene.connect_errors = {EINTR, EINTR};
  CHECK(VirtualBus::open("/run/x"));
}

TEST_CASE("virtual bus client: without a socket the reason is the kernel's") {
  Connecting scene;
  scene.socket_error = EMFILE;
  CHECK(VirtualBus::open("/run/x").error.what ==
        std::string("cannot connect to the simulator on '/run/x': ") + std::strerror(EMFILE));
  CHECK_FALSE(VirtualBus::running("/run/x"));
}

TEST_CASE("virtual bus client: a simulator of another user is left alone") {
  Connecting scene;
  scene.peer.uid = ::geteuid() + 1;
  const std::string uid = std::to_string(scene.peer.uid);
  CHECK(VirtualBus::open("/run/x").error ==
        Failure{"the simulator on '/run/x' belongs to another user (uid " + uid + ")",
                "start one of your own", Cause::simulator_foreign});
  CHECK(scene.heard().empty());
}

TEST_CASE("virtual bus client: a simulator whose user is not known is left alone") {
  Connecting scene;
  scene.peer.pid = -1;
  CHECK(VirtualBus::open("/run/x").error.what == "the simulator on '/run/x' belongs to another user");
}

TEST_CASE("virtual bus client: a server runs where one can connect, or only waits to be let in") {
  test::PlayedKernel kernel;
  int error = 0;
  kernel.connect = [&error](int, const sockaddr*) { return error == 0 ? 0 : test::failed(error); };
  CHECK(VirtualBus::running("/run/x"));
  error = EAGAIN;
  CHECK(VirtualBus::running("/run/x"));
  error = ECONNREFUSED;
  CHECK_FALSE(VirtualBus::running("/run/x"));
  error = 0;
  CHECK_FALSE(VirtualBus::running(""));
}

// --- receiving ---

TEST_CASE("virtual bus client: receive waits as long as it has to, and for input") {
  Scene scene;
  scene.open();
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.passed() == 20ms);
  CHECK(scene.kernel.waits == Waits{{POLLIN, 20ms}});
}

TEST_CASE("virtual bus client: receive does not wait for a time of zero, nor for one that has passed") {
  Scene scene;
  scene.open();
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->receive(-1ms).error == Error::timed_out);
  CHECK(scene.kernel.waits.empty());
}

TEST_CASE("virtual bus client: a frame ends the wait") {
  Scene scene;
  scene.open();
  scene.kernel.later(7ms, [&] {
    scene.say(vb::FrameRecord{.dlc = 1, .id = 0x605, .time_ns = 123'456'789, .data = {0xAB}});
  });
  const auto received = scene.bus->receive(1h);
  REQUIRE(received);
  CHECK(received->frame == frame("605#AB"));
  CHECK(received->time == base::Time{123'456'789ns});
  CHECK(scene.passed() == 7ms);
  CHECK(scene.bus->counters().received == 1);
}

TEST_CASE("virtual bus client: what comes without a frame does not prolong the wait") {
  Scene scene;
  scene.open();
  CHECK(*scene.bus->send(frame("100#")));
  scene.kernel.later(5ms, [&] { scene.say(credit(1)); });
  scene.kernel.later(8ms, [&] { scene.say(vb::Count{.type = vb::Type::overrun, .count = 3}); });
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.kernel.waits == Waits{{POLLIN, 20ms}, {POLLIN, 15ms}, {POLLIN, 12ms}});
  CHECK(scene.bus->counters().lost == 3);
  CHECK(scene.bus->credit() == 2);
}

TEST_CASE("virtual bus client: a signal ends the wait") {
  Scene scene;
  scene.open();
  scene.kernel.later(5ms, [&] { scene.kernel.interrupt(); });
  CHECK(scene.bus->receive(1h).error == Error::timed_out);
  CHECK(scene.passed() == 5ms);
  CHECK(scene.bus->state() == BusState::up);
}

TEST_CASE("virtual bus client: a signal, or a connection that was reset, while it reads changes nothing") {
  Scene scene;
  scene.open();
  scene.say(vb::to_record(frame("605#")));
  scene.read_errors = {EINTR, ECONNRESET};
  CHECK(scene.received() == Texts{"605#"});
}

TEST_CASE("virtual bus client: an error of the socket is the end") {
  Scene scene;
  scene.open();
  scene.read_errors = {EBADF};
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.bus->failure() == gone);
}

TEST_CASE("virtual bus client: sixteen messages are read at once, and all their records") {
  Scene scene;
  scene.open();
  for (int i = 0; i < 17; ++i)
    scene.say(std::array{vb::to_record(frame("605#")), vb::to_record(frame("606#"))});
  for (int i = 0; i < 32; ++i) REQUIRE(scene.bus->receive(0ns));
  scene.read_errors = {EBADF};
  CHECK(scene.bus->receive(0ns).error == Error::closed);
}

TEST_CASE("virtual bus client: error frames pass every filter, and are counted beside the others") {
  Scene scene;
  scene.open();
  const can::Filter filter{0x605, 0x7FF};
  REQUIRE(scene.bus->subscribe({&filter, 1}));
  scene.say(vb::FrameRecord{.format = 4, .dlc = 8, .id = 4});
  scene.say(vb::to_record(frame("608#")));
  scene.say(vb::to_record(frame("605#")));
  CHECK(scene.received() == Texts{"20000004#0000000000000000", "605#"});
  CHECK(scene.bus->counters().error_frames == 1);
  CHECK(scene.bus->counters().received == 2);
}

TEST_CASE("virtual bus client: frames of several reads come in their order, the kinds among each other") {
  Scene scene;
  scene.open();
  scene.say(vb::to_fd_records(*can::parse_any_frame("123##1AA"), base::Time{5ns}).records[0]);
  scene.say(vb::to_record(frame("605#01")));
  const auto first = scene.bus->receive_any(0ns);
  REQUIRE(first);
  CHECK(can::to_text(first->frame).view() == "123##1AA");
  CHECK(first->time == base::Time{5ns});
  scene.say(vb::to_fd_records(*can::parse_any_frame("124##1BB")).records[0]);
  CHECK(scene.received() == Texts{"605#01"});
  CHECK(scene.bus->counters().passed_over == 1);
  scene.say(vb::to_fd_records(*can::parse_any_frame("125##1CC")).records[0]);
  CHECK(can::to_text(scene.bus->receive_any(0ns)->frame).view() == "125##1CC");
}

TEST_CASE("virtual bus client: records that a server does not send are not understood") {
  const auto after = [](const vb::Record& record) {
    Scene scene;
    scene.open();
    scene.say(record);
    CHECK(scene.bus->receive(1h).error == Error::closed);
    return scene.bus->failure();
  };
  CHECK(after(vb::to_record(vb::FilterRecord{})) == not_understood);
  CHECK(after(vb::to_record(vb::Count{.type = vb::Type::filters})) == not_understood);
  CHECK(after(vb::to_record(vb::FrameRecord{.dlc = 9})) == not_understood);
  CHECK(after(vb::to_record(vb::FdDataRecord{})) == not_understood);
  CHECK(after(vb::to_record(vb::FdFrameRecord{.length = 9, .flags = 4})) == not_understood);
  CHECK(after(vb::to_record(greeting)) == not_understood);
  CHECK(after(vb::Record{}) == not_understood);
  vb::Record unknown{};
  unknown[0] = std::byte{10};
  CHECK(after(unknown) == not_understood);
}

TEST_CASE("virtual bus client: of a message that is not understood what comes before is received") {
  Scene scene;
  scene.open();
  scene.say(std::array{vb::to_record(frame("605#")), vb::Record{}, vb::to_record(frame("606#"))});
  CHECK(scene.received() == Texts{"605#"});
  CHECK(scene.bus->failure() == not_understood);
}

TEST_CASE("virtual bus client: a message that is cut off or no whole records is not understood") {
  const std::size_t size = GENERATE(std::size_t{33}, vb::max_message + vb::record_size);
  Scene scene;
  scene.open();
  const std::vector<std::byte> bytes(size);
  scene.put(bytes.data(), bytes.size());
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.bus->failure() == not_understood);
}

TEST_CASE("virtual bus client: the longest message is understood") {
  Scene scene;
  scene.open();
  std::array<vb::Record, 128> records{};
  records.fill(vb::to_record(frame("605#")));
  scene.say(records);
  CHECK(scene.received().size() == 128);
}

TEST_CASE("virtual bus client: the first reason of an end stays") {
  Scene scene;
  scene.open();
  scene.say(vb::Goodbye{.reason = vb::Reason::ended});
  scene.hang_up();
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.bus->failure().what == simulator + " was ended");
}

TEST_CASE("virtual bus client: a bus is up until its last frame was received") {
  Scene scene;
  scene.open();
  scene.say(vb::to_record(frame("605#")));
  scene.hang_up();
  CHECK(scene.bus->receive(0ns));
  CHECK(scene.bus->state() == BusState::up);
  CHECK(scene.bus->receive(0ns).error == Error::closed);
  CHECK(scene.bus->state() == BusState::closed);
  CHECK(scene.bus->failure() == gone);
  CHECK(scene.bus->fd_obstacle() == Failure{});
}

// --- sending ---

TEST_CASE("virtual bus client: a frame is one record, and takes a credit") {
  Scene scene;
  scene.open();
  CHECK(*scene.bus->send(frame("605#AB")));
  CHECK(scene.heard() == std::vector<std::vector<vb::Record>>{{vb::to_record(frame("605#AB"))}});
  CHECK(scene.bus->credit() == 1);
  CHECK(scene.bus->counters().sent == 1);
  CHECK(scene.bus->delivery().known);
  CHECK(scene.bus->delivery().pending == 1);
}

TEST_CASE("virtual bus client: a CAN FD frame is one message, and takes one credit") {
  Scene scene;
  scene.open();
  const auto longest = *can::parse_any_frame("123##1" + std::string(128, 'A'));
  CHECK(*scene.bus->send_any(longest));
  const auto whole = vb::to_fd_records(longest);
  const auto records = whole.all();
  CHECK(scene.heard() == std::vector<std::vector<vb::Record>>{{records.begin(), records.end()}});
  CHECK(scene.bus->credit() == 1);
}

TEST_CASE("virtual bus client: without credit it looks for some, and refuses where there is none") {
  Scene scene;
  scene.open();
  CHECK(*scene.bus->send(frame("101#")));
  CHECK(*scene.bus->send(frame("102#")));
  CHECK_FALSE(*scene.bus->send(frame("103#")));
  CHECK(scene.bus->counters().refused == 1);
  for (int i = 0; i < 20; ++i) scene.say(vb::to_record(frame("605#")));
  scene.say(credit(1));
  CHECK(*scene.bus->send(frame("104#")));
  CHECK(scene.bus->credit() == 0);
  CHECK(scene.received().size() == 20);
}

TEST_CASE("virtual bus client: credit that comes back is what is no longer pending") {
  Scene scene;
  scene.open();
  CHECK(*scene.bus->send(frame("101#")));
  CHECK(*scene.bus->send(frame("102#")));
  CHECK(scene.bus->delivery().pending == 2);
  scene.say(credit(1));
  CHECK(scene.bus->delivery().pending == 1);
  scene.say(credit(1));
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(scene.bus->delivery().obstruction == Failure{});
}

TEST_CASE("virtual bus client: while nothing is pending delivery reads nothing") {
  Scene scene;
  scene.open();
  scene.read_errors = {EBADF};
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(scene.read_errors.size() == 1);
}

TEST_CASE("virtual bus client: a socket without room refuses, and takes no credit") {
  const int error = GENERATE(EAGAIN, ENOBUFS, ENOMEM);
  Scene scene;
  scene.open();
  scene.send_errors = {error};
  CHECK_FALSE(*scene.bus->send(frame("101#")));
  CHECK(scene.bus->credit() == 2);
  CHECK(scene.bus->counters().refused == 1);
  CHECK(scene.bus->counters().sent == 0);
  CHECK(*scene.bus->send(frame("101#")));
}

TEST_CASE("virtual bus client: a signal, or a connection that was reset, while it sends is tried again") {
  Scene scene;
  scene.open();
  scene.send_errors = {EINTR, ECONNRESET};
  CHECK(*scene.bus->send(frame("101#")));
  CHECK(scene.sends == 3);
}

TEST_CASE("virtual bus client: a server that has gone has said before why") {
  Scene scene;
  scene.open();
  scene.say(vb::to_record(frame("605#")));
  scene.say(vb::Goodbye{.reason = vb::Reason::ended});
  scene.send_errors = {EPIPE};
  CHECK(scene.bus->send(frame("101#")).error == Error::closed);
  CHECK(scene.bus->failure().what == simulator + " was ended");
  CHECK(scene.bus->counters().refused == 0);
  CHECK(scene.received() == Texts{"605#"});
}

TEST_CASE("virtual bus client: a server that has gone without a word is gone") {
  Scene scene;
  scene.open();
  scene.hang_up();
  CHECK(scene.bus->send_any(*can::parse_any_frame("123##1AA")).error == Error::closed);
  CHECK(scene.bus->failure() == gone);
  CHECK(scene.bus->send_any(*can::parse_any_frame("123##1AA")).error == Error::closed);
  CHECK(scene.bus->send(frame("101#")).error == Error::closed);
  CHECK(scene.sends == 1);
}

// --- filters ---

TEST_CASE("virtual bus client: filters are announced, and go 128 records at once") {
  Scene scene;
  scene.open();
  const std::vector<can::Filter> filters(130, can::Filter{0x605, 0x7FF});
  REQUIRE(scene.bus->subscribe(filters));
  const auto heard = scene.heard();
  REQUIRE(heard.size() == 2);
  CHECK(heard[0].size() == 128);
  CHECK(heard[1].size() == 3);
  CHECK(heard[0][0] == vb::to_record(vb::Count{.type = vb::Type::filters, .count = 130}));
  CHECK(heard[1][2] == vb::to_record(vb::FilterRecord{.id = 0x605, .mask = 0x7FF}));
}

TEST_CASE("virtual bus client: filters wait a second for a server that is busy, and no longer") {
  Scene scene;
  scene.open();
  scene.send_errors.assign(1000, EAGAIN);
  const can::Filter filter{0x605, 0x7FF};
  const auto refused = scene.bus->subscribe({&filter, 1});
  REQUIRE_FALSE(refused);
  CHECK(refused.error == Failure{"the simulator (process 77) does not answer", stuck});
  CHECK(scene.kernel.waits == Waits{{POLLOUT, 1s}});
  CHECK(scene.bus->send(frame("101#")).error == Error::closed);
}

TEST_CASE("virtual bus client: filters go when there is room, each record once") {
  Scene scene;
  scene.open();
  scene.send_errors = {EAGAIN};
  const std::vector<can::Filter> filters(130, can::Filter{0x605, 0x7FF});
  REQUIRE(scene.bus->subscribe(filters));
  const auto heard = scene.heard();
  REQUIRE(heard.size() == 2);
  CHECK(heard[0].size() + heard[1].size() == 131);
  CHECK(scene.bus->state() == BusState::up);
}

TEST_CASE("virtual bus client: filters for a server that has gone are refused with its reason") {
  Scene scene;
  scene.open();
  scene.hang_up();
  CHECK(scene.bus->subscribe({}).error == gone);
  CHECK(scene.bus->subscribe({}).error == gone);
  CHECK(scene.sends == 1);
}

TEST_CASE("virtual bus client: 512 filters are taken, and one more is refused in words") {
  Scene scene;
  scene.open();
  std::vector<can::Filter> filters(512, can::Filter{0x605, 0x7FF});
  CHECK(scene.bus->subscribe(filters));
  filters.push_back({0x606, 0x7FF});
  CHECK(scene.bus->subscribe(filters).error == Failure{"513 filters for the virtual bus; it takes 512",
                                                       "use fewer filters with wider masks, or none"});
}

// --- the end ---

TEST_CASE("virtual bus client: it says goodbye") {
  Scene scene;
  scene.open();
  scene.bus.reset();
  CHECK(scene.heard() == std::vector<std::vector<vb::Record>>{{vb::to_record(vb::Goodbye{})}});
  CHECK(scene.kernel.waits.empty());
}

TEST_CASE("virtual bus client: a goodbye for which the socket has no room waits 100 ms for it") {
  Scene scene;
  scene.open();
  scene.send_errors = {EAGAIN};
  scene.bus.reset();
  CHECK(scene.kernel.waits == Waits{{POLLOUT, 100ms}});
  CHECK(scene.heard() == std::vector<std::vector<vb::Record>>{{vb::to_record(vb::Goodbye{})}});
}

TEST_CASE("virtual bus client: to a server that has gone it says nothing") {
  Scene scene;
  scene.open();
  scene.say(vb::Goodbye{.reason = vb::Reason::ended});
  CHECK(scene.bus->receive(0ns).error == Error::closed);
  scene.bus.reset();
  CHECK(scene.sends == 0);
}

}  // namespace transport_virtual_bus_client_test
