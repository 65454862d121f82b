#include "ocm/transport/virtual_bus.hpp"

#include <pthread.h>
#include <signal.h>

#include <catch2/catch.hpp>

#include "unit/transport/virtual_bus_setup.hpp"

namespace transport_virtual_bus_test {

using namespace ocm;
using namespace ocm::test;
using transport::BusState;
using transport::VirtualBus;

static_assert(can::Bus<VirtualBus>);

/// A server that says what it likes to one client.
class RawServer {
 public:
  RawServer() {
    const auto address = host::to_address(path());
    REQUIRE(::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0);
    REQUIRE(::listen(listener_.get(), 1) == 0);
  }
  [[nodiscard]] std::string path() const { return directory_.path() + "/sim.sock"; }

  /// Opens a client, to whose hello the server answers with `answer`, and hangs up if told so.
  template <class T>
  transport::Outcome<std::unique_ptr<VirtualBus>> open(const T& answer, bool hang_up,
                                                       base::Duration after = base::Duration::zero()) {
    transport::Outcome<std::unique_ptr<VirtualBus>> opened;
    std::thread opener{[&] { opened = VirtualBus::open(path()); }};
    client_ = host::Descriptor{::accept(listener_.get(), nullptr, nullptr)};
    vb::Record hello{};
    CHECK(::recv(client_.get(), hello.data(), hello.size(), 0) == static_cast<ssize_t>(hello.size()));
    std::this_thread::sleep_for(after);  // of a server that is slow
    say(answer);
    if (hang_up) client_.reset();
    opener.join();
    return opened;
  }
  template <std::size_t n>
  void say(const std::array<vb::Record, n>& records) {
    send(records.data(), sizeof records);
  }
  template <class T>
  void say(const T& content) {
    const vb::Record record = vb::to_record(content);
    send(record.data(), record.size());
  }
  void send(const void* bytes, std::size_t size) {
    CHECK(::send(client_.get(), bytes, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size));
  }
  void hang_up() { client_.reset(); }

 private:
  TemporaryDirectory directory_;
  host::Descriptor listener_{::socket(AF_UNIX, SOCK_SEQPACKET, 0)};
  host::Descriptor client_;
};

TEST_CASE("no server for a bus: the message says how to get one") {
  const TemporaryDirectory directory;
  const std::string path = directory.path() + "/sim.sock";
  CHECK_FALSE(VirtualBus::running(path));
  const auto none = VirtualBus::open(path);
  REQUIRE_FALSE(none);
  CHECK_THAT(none.error.what, Catch::Contains("no simulator is running") && Catch::Contains(path));
  CHECK(none.error.cause == host::Cause::simulator_missing);
  CHECK(none.error.remedy == "start one");
  CHECK_THAT(VirtualBus::open("/tmp/" + std::string(200, 'x')).error.what, Catch::Contains("205 bytes"));
  // A socket that no program listens on any more.
  {
    const host::Descriptor dead{::socket(AF_UNIX, SOCK_SEQPACKET, 0)};
    const auto address = host::to_address(path);
    REQUIRE(::bind(dead.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0);
  }
  CHECK_FALSE(VirtualBus::running(path));
  CHECK_THAT(VirtualBus::open(path).error.what, Catch::Contains("no simulator is running"));
}

TEST_CASE("a client knows its bus") {
  VirtualBusSetup setup{{.name = "amiro-with-a-long-name", .bit_rate = 125'000, .transmit_queue = 5}};
  const auto bus = setup.join();
  CHECK(bus->name() == "sim:" + setup.path());
  CHECK(bus->bus_name() == "amiro-with-");
  CHECK(bus->bit_rate() == 125'000);
  CHECK(bus->is_simulated());
  CHECK(bus->credit() == 5);
  CHECK(bus->state() == BusState::up);
  CHECK(bus->failure() == transport::Failure{});
  CHECK(bus->receive(0ns).error == base::Error::timed_out);
}

TEST_CASE("two clients send within one bit time: the lower identifier wins") {
  VirtualBusSetup setup;
  const auto a = setup.join();
  const auto b = setup.join();
  const auto listener = setup.join();
  CHECK(*a->send(frame("608#00")));
  setup.now += 300ns;
  setup.poll();
  CHECK(*b->send(frame("205#01")));
  setup.now += 1700ns;  // the boundary: still within the bit
  setup.poll();
  setup.run();
  CHECK(received(*listener) == Texts{"205#01", "608#00"});
  CHECK(received(*a) == Texts{"205#01"});  // none gets its own
  CHECK(received(*b) == Texts{"608#00"});
}

TEST_CASE("CAN FD frames get through as they are, among classic ones") {
  VirtualBusSetup setup{{.bit_rate = 500'000, .data_bit_rate = 2'000'000}};
  const auto a = setup.join();
  const auto b = setup.join();
  CHECK(a->bit_rate() == 500'000);
  CHECK(a->data_bit_rate() == 2'000'000);
  CHECK(a->fd_obstacle() == transport::Failure{});
  Texts sent;
  for (unsigned dlc = 0; dlc < 16; ++dlc) {
    can::AnyFrame one = any(dlc % 2 == 0 ? "123##1" : "1F334455##2");
    one.length = can::fd_length(dlc);
    for (std::size_t i = 0; i < one.length; ++i) one.data[i] = static_cast<std::uint8_t>(255 - i);
    CHECK(*a->send_any(one));
    sent.emplace_back(can::to_text(one).view());
    CHECK(*a->send_any(frame("123#00")));
    sent.emplace_back("123#00");
  }
  setup.run();
  CHECK(received_any(*b) == sent);
  CHECK(setup.on_bus == sent);
  CHECK(b->counters().received == sent.size());
  CHECK(a->delivery().pending == 0);
  CHECK(received_any(*a).empty());  // not its own
  auto nine = any("123##1");
  nine.length = 9;
  CHECK(a->send_any(nine).error == base::Error::bad_length);
}

TEST_CASE("who asks for classic frames gets these alone, and the others are counted") {
  VirtualBusSetup setup;
  const auto a = setup.join();
  const auto b = setup.join();
  for (const char* text : {"123##1AA", "124#BB", "125##0CC", "126#DD"}) CHECK(*a->send_any(any(text)));
  setup.run();
  CHECK(received(*b) == Texts{"124#BB", "126#DD"});
  CHECK(b->counters().passed_over == 2);
  CHECK(b->counters().received == 2);
}

TEST_CASE("filters hold for CAN FD frames too, also for those that came before") {
  VirtualBusSetup setup;
  const auto a = setup.join();
  const auto b = setup.join();
  const can::Filter only{0x123, 0x7FF};
  for (const char* text : {"123##1AA", "124##1BB"}) CHECK(*a->send_any(any(text)));
  setup.run();
  REQUIRE(b->subscribe({&only, 1}));
  setup.poll();
  for (const char* text : {"124##1CC", "123##1DD", "00000123##1EE", "123#FF"}) CHECK(*a->send_any(any(text)));
  setup.run();
  CHECK(received_any(*b) == Texts{"123##1AA", "123##1DD", "123#FF"});
}

TEST_CASE("a server of an earlier version carries classic frames, and a CAN FD frame is refused in words") {
  RawServer server;
  const auto bus = server.open(vb::Hello{.bit_rate = 500'000, .credit = 5}, false);
  REQUIRE(bus);
  CHECK((*bus)->data_bit_rate() == 0);
  CHECK((*bus)->send_any(any("123##1AA")).error == base::Error::bad_length);
  CHECK_THAT((*bus)->fd_obstacle().what,
             Catch::Contains("carries no CAN FD frames") && Catch::Contains("sim.sock"));
  CHECK(*(*bus)->send_any(frame("123#AA")));
  CHECK((*bus)->state() == BusState::up);
}

TEST_CASE("credit may come between the parts of a CAN FD frame, another frame may not") {
  RawServer server;
  auto bus = server.open(vb::Hello{.fd = 1, .bit_rate = 500'000, .credit = 5}, false);
  REQUIRE(bus);
  CHECK(*(*bus)->send_any(frame("001#")));
  const std::string longest = "123##1" + std::string(128, 'A');
  const auto records = vb::to_fd_records(any(longest)).records;
  server.say(records[0]);
  CHECK((*bus)->receive_any(0ns).error == base::Error::timed_out);
  server.say(
      std::array{vb::to_record(vb::Count{.type = vb::Type::credit, .count = 1}), records[1], records[2]});
  const auto whole = (*bus)->receive_any(0ns);
  REQUIRE(whole);
  CHECK(can::to_text(whole->frame).view() == longest);
  CHECK((*bus)->credit() == 5);
  server.say(std::array{records[0], vb::to_record(frame("124#"))});
  CHECK((*bus)->receive_any(0ns).error == base::Error::closed);
  CHECK_THAT((*bus)->failure().what, Catch::Contains("does not know"));
}

TEST_CASE("every frame gets through as it is") {
  VirtualBusSetup setup;
  const auto a = setup.join();
  const auto b = setup.join();
  const std::array frames{frame("000#"),   frame("7FF#0102030405060708"), frame("605#R"),
                          frame("605#R8"), frame("1FFFFFFF#00"),          frame("00000000#R")};
  for (const can::Frame& one : frames) {
    CHECK(*a->send(one));
    setup.run();
    const auto heard = b->receive(0ns);
    REQUIRE(heard);
    CHECK(heard->frame == one);
  }
  CHECK(a->counters().sent == frames.size());
  CHECK(b->counters().received == frames.size());
  CHECK(a->send({.id = 0x800}).error == base::Error::bad_identifier);
  CHECK(a->send({.id = 1, .dlc = 9}).error == base::Error::bad_length);
  CHECK(a->send({.id = 1, .format = can::Format::error}).error == base::Error::bad_identifier);
  CHECK(a->state() == BusState::up);
}

TEST_CASE("a full transmit queue answers false, and takes frames again when one has left") {
  VirtualBusSetup setup{{.transmit_queue = 4}};
  const auto bus = setup.join();
  for (int i = 0; i < 4; ++i) CHECK(*bus->send(frame("100#")));
  for (int i = 0; i < 3; ++i) CHECK_FALSE(*bus->send(frame("101#")));
  setup.poll();
  CHECK_FALSE(*bus->send(frame("101#")));
  CHECK(bus->counters().refused == 4);
  CHECK_FALSE(readable(bus->descriptor()));

  setup.now = setup.server->next_event();
  setup.poll();
  CHECK(readable(bus->descriptor()));
  CHECK(*bus->send(frame("102#")));
  CHECK_FALSE(*bus->send(frame("101#")));
  setup.run();
  CHECK(setup.on_bus == Texts{"100#", "100#", "100#", "100#", "102#"});
  CHECK(bus->counters().sent == 5);
  CHECK(bus->receive(0ns).error == base::Error::timed_out);
  CHECK(bus->credit() == 4);
}

TEST_CASE("ten thousand frames, as fast as they are taken, and none is lost") {
  VirtualBusSetup setup;
  const auto a = setup.join();
  const auto b = setup.join();
  std::uint32_t sent = 0;
  std::uint32_t expected = 0;
  while (expected < 10'000) {
    can::Frame one{.id = 0x100, .dlc = 4};
    std::memcpy(one.data.data(), &sent, 4);
    if (sent < 10'000 && *a->send(one)) {
      ++sent;
      continue;
    }
    setup.run();
    while (const auto heard = b->receive(0ns)) {
      std::uint32_t number = 0;
      std::memcpy(&number, heard->frame.data.data(), 4);
      REQUIRE(number == expected++);
    }
  }
  CHECK(b->counters().lost == 0);
  CHECK(a->counters().sent == 10'000);
}

TEST_CASE("frames of a client that leaves in order are sent, even with frames unread") {
  VirtualBusSetup setup;
  const auto listener = setup.join();
  auto bus = setup.join();
  setup.send("605#00");
  setup.run();  // waits in the client's socket: closing it then resets the connection
  CHECK(*bus->send(frame("205#01")));
  CHECK(*bus->send(frame("206#01")));
  bus.reset();
  setup.run();
  CHECK(received(*listener) == Texts{"605#00", "205#01", "206#01"});
  CHECK(setup.server->counters().left == 1);
  CHECK(setup.server->counters().died == 0);
  CHECK(setup.server->counters().withdrawn == 0);
  CHECK(setup.server->clients() == 1);
}

TEST_CASE("filters hold in the server, and for what was on its way") {
  VirtualBusSetup setup;
  const auto bus = setup.join();
  setup.send("605#");
  setup.send("101#");
  setup.run();
  const std::array filters{can::Filter{0x100, 0x700}, can::Filter{0x7FF, 0x7FF}};
  CHECK(bus->subscribe(filters));
  CHECK(received(*bus) == Texts{"101#"});
  setup.poll();
  for (const char* text : {"605#", "102#", "7FF#", "00000100#", "100#R"}) setup.send(text);
  setup.run();
  CHECK(received(*bus) == Texts{"102#", "7FF#"});
  setup.send("200#");
  setup.run();
  CHECK_FALSE(readable(bus->descriptor()));  // the server keeps it back

  CHECK(bus->subscribe({}));
  setup.poll();
  for (const char* text : {"605#", "100#R"}) setup.send(text);
  setup.run();
  CHECK(received(*bus) == Texts{"605#", "100#R"});
}

TEST_CASE("as many filters as the kernel takes for a CAN interface") {
  VirtualBusSetup setup;
  const auto bus = setup.join();
  std::vector<can::Filter> filters;
  for (std::uint32_t i = 0; i < 512; ++i) filters.push_back({i, 0x7FF});
  CHECK(bus->subscribe(filters));
  setup.poll();
  setup.send("1FF#");
  setup.send("200#");
  setup.run();
  CHECK(received(*bus) == Texts{"1FF#"});
  filters.push_back({0x200, 0x7FF});
  const auto refused = bus->subscribe(filters);
  CHECK_THAT(refused.error.what, Catch::Contains("513") && Catch::Contains("512"));
  CHECK_FALSE(refused.error.remedy.empty());
  CHECK(bus->state() == BusState::up);
}

TEST_CASE("the server ends: what waits is received, then the bus is closed and says why") {
  VirtualBusSetup setup;
  const auto bus = setup.join();
  const auto sender = setup.join();
  setup.send("605#");
  setup.run();
  setup.server.reset();
  CHECK(received(*bus) == Texts{"605#"});
  CHECK(bus->receive(1h).error == base::Error::closed);
  CHECK(bus->state() == BusState::closed);
  CHECK_THAT(bus->failure().what, Catch::Contains("was ended") && Catch::Contains(setup.path()) &&
                                      Catch::Contains("process " + std::to_string(::getpid())));
  CHECK(bus->failure().cause == host::Cause::simulator_missing);
  CHECK(bus->failure().remedy == "start it again");
  CHECK(bus->send(frame("100#")).error == base::Error::closed);
  CHECK_THAT(bus->subscribe({}).error.what, Catch::Contains("was ended"));

  // One who only sends learns it too, and can still receive what came before.
  CHECK(sender->send(frame("100#")).error == base::Error::closed);
  CHECK_THAT(sender->failure().what, Catch::Contains("was ended"));
  CHECK(received(*sender) == Texts{"605#"});
  CHECK(sender->receive(1h).error == base::Error::closed);
  CHECK(sender->counters().sent == 0);
}

TEST_CASE("the server dies without a word") {
  RawServer server;
  const auto bus = server.open(vb::Hello{.bit_rate = 1000, .credit = 2}, false);
  INFO(bus.error.what);
  REQUIRE(bus);
  server.say(frame("605#"));
  server.hang_up();
  CHECK(received(**bus) == Texts{"605#"});
  CHECK((*bus)->receive(1h).error == base::Error::closed);
  CHECK_THAT((*bus)->failure().what, Catch::Contains("is gone"));
}

TEST_CASE("the server dies with words of the client unread") {
  RawServer server;
  const auto bus = server.open(vb::Hello{.bit_rate = 1000, .credit = 2}, false);
  REQUIRE(bus);
  CHECK(*(*bus)->send(frame("100#")));
  server.say(vb::Goodbye{.reason = vb::Reason::ended});
  server.hang_up();
  CHECK((*bus)->receive(1h).error == base::Error::closed);
  CHECK_THAT((*bus)->failure().what, Catch::Contains("was ended"));
}

TEST_CASE("what a server may answer to a greeting") {
  const auto answer = [](const auto& record, bool hang_up = false) {
    RawServer server;
    const auto bus = server.open(record, hang_up);
    CHECK_FALSE(bus);
    CHECK_FALSE(bus.error.remedy.empty());
    return bus.error.what;
  };
  CHECK_THAT(answer(vb::Goodbye{.reason = vb::Reason::bad_version, .version = 9, .detail = 1}, true),
             Catch::Contains("speaks version 9") && Catch::Contains("this program version 1"));
  CHECK_THAT(answer(vb::Goodbye{.reason = vb::Reason::full}, true), Catch::Contains("file descriptor"));
  CHECK_THAT(answer(vb::Goodbye{.reason = vb::Reason::other_user}, true), Catch::Contains("another user"));
  CHECK_THAT(answer(vb::Goodbye{.reason = vb::Reason::bad_dlc, .detail = 9}, true), Catch::Contains("DLC 9"));
  CHECK_THAT(answer(vb::Hello{.version = 9, .bit_rate = 1}), Catch::Contains("does not know"));
  CHECK_THAT(answer(vb::Hello{.bit_rate = 0}), Catch::Contains("does not know"));
  CHECK_THAT(answer(vb::FilterRecord{}), Catch::Contains("does not know"));
  CHECK_THAT(answer(vb::FrameRecord{.dlc = 9}), Catch::Contains("does not know"));
  // What comes before a greeting, though it would be right behind one.
  CHECK_THAT(answer(frame("605#")), Catch::Contains("does not know"));
  for (const auto type : {vb::Type::credit, vb::Type::overrun})
    CHECK_THAT(answer(vb::Count{.type = type}), Catch::Contains("does not know"));
}

TEST_CASE("a server that greets late is left, also where the greeting follows in the same message") {
  RawServer server;
  const std::array records{vb::to_record(frame("605#")),
                           vb::to_record(vb::Hello{.bit_rate = 1000, .credit = 2})};
  const auto bus = server.open(records, false);
  CHECK_FALSE(bus);
  CHECK_THAT(bus.error.what, Catch::Contains("does not know"));
}

TEST_CASE("a server that greets twice is left: credit and bit rate stay what they were") {
  RawServer server;
  const auto bus = server.open(vb::Hello{.bit_rate = 1000, .credit = 2}, false);
  REQUIRE(bus);
  CHECK(*(*bus)->send(frame("100#")));
  server.say(frame("605#"));
  server.say(vb::Hello{.bit_rate = 500, .credit = 9});
  server.say(frame("606#"));
  CHECK(received(**bus) == Texts{"605#"});
  CHECK((*bus)->receive(1h).error == base::Error::closed);
  CHECK_THAT((*bus)->failure().what, Catch::Contains("does not know"));
  CHECK((*bus)->bit_rate() == 1000);
  CHECK((*bus)->credit() == 1);
}

TEST_CASE("a server that gives back more credit than it took is left") {
  for (const std::uint64_t count : {std::uint64_t{2}, UINT64_MAX}) {
    RawServer server;
    const auto bus = server.open(vb::Hello{.bit_rate = 1000, .credit = 2}, false);
    REQUIRE(bus);
    CHECK(*(*bus)->send(frame("100#")));
    server.say(vb::Count{.type = vb::Type::credit, .count = count});
    CHECK((*bus)->receive(1h).error == base::Error::closed);
    CHECK_THAT((*bus)->failure().what, Catch::Contains("does not know"));
    CHECK((*bus)->credit() == 1);
  }
}

TEST_CASE("a server that talks nonsense is left") {
  for (const std::size_t size : {std::size_t{31}, vb::max_message + vb::record_size}) {
    RawServer server;
    const auto bus = server.open(vb::Hello{.bit_rate = 1000, .credit = 2}, false);
    REQUIRE(bus);
    const std::vector<std::byte> bytes(size);
    server.send(bytes.data(), bytes.size());
    CHECK((*bus)->receive(1h).error == base::Error::closed);
    CHECK_THAT((*bus)->failure().what, Catch::Contains("does not know"));
  }
}

TEST_CASE("a server that does not answer is not waited for for ever") {
  RawServer server;  // listens, and never accepts: the kernel alone takes the connection
  const auto bus = VirtualBus::open(server.path(), 10ms);
  REQUIRE_FALSE(bus);
  CHECK_THAT(bus.error.what, Catch::Contains("does not answer"));
  CHECK_THAT(bus.error.remedy, Catch::Contains("fg"));
}

TEST_CASE("a server that is slow to answer is waited for") {
  RawServer server;
  CHECK(server.open(vb::Hello{.bit_rate = 1'000'000, .credit = 64}, false, 50ms));
}

TEST_CASE("receive waits as long as told") {
  VirtualBusSetup setup;
  const auto bus = setup.join();
  const auto begin = std::chrono::steady_clock::now();
  CHECK(bus->receive(20ms).error == base::Error::timed_out);
  CHECK(std::chrono::steady_clock::now() - begin >= 20ms);
}

TEST_CASE("a frame ends the wait") {
  VirtualBusSetup setup;
  const auto bus = setup.join();
  base::Result<can::Received> heard = base::Error::none;
  std::atomic<pid_t> number{};
  std::thread waiter{[&] {
    number = ::gettid();
    heard = bus->receive(1h);
  }};
  test::until_asleep(number);
  setup.send("605#");
  setup.run();
  waiter.join();
  REQUIRE(heard);
  CHECK(heard->frame == frame("605#"));
}

TEST_CASE("a signal ends the wait") {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = [](int) {};
  REQUIRE(::sigaction(SIGUSR1, &action, &before) == 0);
  VirtualBusSetup setup;
  const auto bus = setup.join();
  base::Error error = base::Error::none;
  std::atomic<bool> done{false};
  std::thread waiter{[&] {
    error = bus->receive(1h).error;
    done = true;
  }};
  // Signals that come before it waits have no effect, so there are many.
  while (!done) {
    ::pthread_kill(waiter.native_handle(), SIGUSR1);
    std::this_thread::yield();
  }
  waiter.join();
  CHECK(error == base::Error::timed_out);
  CHECK(bus->state() == BusState::up);
  ::sigaction(SIGUSR1, &before, nullptr);
}

TEST_CASE("frames that wait for a client are bounded, and those beyond are counted") {
  VirtualBusSetup setup{{.transmit_queue = 1, .output_queue = 100'000}};
  const auto bus = setup.join();
  CHECK(*bus->send(frame("100#")));
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i < 8000; ++i) setup.send("605#");
    setup.run();
  }
  // Each send without credit reads all that waits, on the look-out for some.
  for (int i = 0; i < 200; ++i) {
    while (*bus->send(frame("100#"))) {
    }
    setup.poll();
  }
  CHECK(setup.server->counters().overruns == 0);
  CHECK(bus->counters().lost == 80'000 - 65'536);
  // What has been received makes room.
  for (int i = 0; i < 200; ++i) setup.send("605#");
  setup.run();
  while (*bus->send(frame("100#"))) {
  }
  CHECK(bus->counters().lost == 80'000 - 65'536 + 200);
  CHECK(bus->receive(0ns));
  setup.send("605#");
  setup.run();
  while (*bus->send(frame("100#"))) {
  }
  CHECK(bus->counters().lost == 80'000 - 65'536 + 200);
  CHECK(received(*bus).size() == 65'536);
}

}  // namespace transport_virtual_bus_test
