#include "ocm/simulation/virtual_bus_server.hpp"

#include <fstream>
#include <random>

#include <catch2/catch.hpp>

#include "ocm/can/error_frame.hpp"

#include "unit/transport/virtual_bus_setup.hpp"

namespace simulation_virtual_bus_server_test {

using namespace ocm;
using namespace ocm::test;
using simulation::VirtualBusServer;

/// While it lives, the process can open so many more files.
class DescriptorsLeft {
 public:
  explicit DescriptorsLeft(std::size_t count) {
    REQUIRE(::getrlimit(RLIMIT_NOFILE, &before_) == 0);
    std::vector<host::Descriptor> free;  // the lowest numbers
    for (std::size_t i = 0; i <= count; ++i) free.emplace_back(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    REQUIRE(free.back());
    rlimit tight = before_;
    tight.rlim_cur = static_cast<rlim_t>(free.back().get());
    REQUIRE(::setrlimit(RLIMIT_NOFILE, &tight) == 0);
  }
  DescriptorsLeft(const DescriptorsLeft&) = delete;
  DescriptorsLeft& operator=(const DescriptorsLeft&) = delete;
  ~DescriptorsLeft() { ::setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
};

/// How many of them are of this type.
std::size_t count_of(const std::vector<vb::Record>& records, vb::Type type) {
  return static_cast<std::size_t>(std::count_if(records.begin(), records.end(),
                                                [&](const auto& one) { return vb::type_of(one) == type; }));
}

TEST_CASE("a virtual bus of which nothing is said is the robot's, and patient for as long as its page says") {
  const simulation::VirtualBusOptions options;
  CHECK(options.name == "sim");
  CHECK(options.bit_rate == 500'000);
  CHECK(options.data_bit_rate == 0);
  CHECK(options.transmit_queue == 64);
  CHECK(options.output_queue == 4096);
  CHECK(options.raise_descriptor_limit);
  CHECK(options.patience == 1s);
  CHECK(options.last_flush == 500ms);
}

TEST_CASE("a server needs three file descriptors, and says so where there are fewer") {
  const TemporaryDirectory directory;
  const auto failure = [&](std::size_t left) {
    const DescriptorsLeft few{left};
    const auto opened =
        VirtualBusServer::open({.path = directory.path() + "/s", .raise_descriptor_limit = false});
    return opened ? std::string{} : opened.error.what;
  };
  for (const std::size_t left : {0U, 1U, 2U})
    CHECK_THAT(failure(left), Catch::Contains("Too many open files"));
  CHECK(failure(3).empty());
}

TEST_CASE("a second server is refused, with the path and the process of the first") {
  VirtualBusSetup setup;
  const auto second = VirtualBusServer::open({.path = setup.path()});
  REQUIRE_FALSE(second);
  CHECK_THAT(second.error.what, Catch::Contains("already runs on '" + setup.path() + "'") &&
                                    Catch::Contains("process " + std::to_string(::getpid())));
  CHECK_THAT(second.error.remedy,
             Catch::Contains("use it") && Catch::Contains("kill " + std::to_string(::getpid())));
  CHECK(second.error.cause == host::Cause::simulator_running);
  CHECK(second.error.process == ::getpid());
  // And the first one did not mind.
  const auto client = setup.join();
  CHECK(setup.server->counters().welcomed == 1);
  CHECK(setup.server->counters().died == 0);
}

TEST_CASE("options and places that cannot be served") {
  CHECK_THAT(VirtualBusServer::open({.path = "/nowhere/at/all"}).error.what,
             Catch::Contains("'/nowhere/at'"));
  CHECK_THAT(VirtualBusServer::open({.path = "/tmp/" + std::string(200, 'x')}).error.what,
             Catch::Contains("205 bytes"));
  const TemporaryDirectory directory;
  for (const std::uint32_t bit_rate : {0U, 1'000'000'001U})
    CHECK_THAT(VirtualBusServer::open({.path = directory.path() + "/s", .bit_rate = bit_rate}).error.what,
               Catch::Contains(std::to_string(bit_rate) + " bit/s"));
  CHECK(std::filesystem::is_empty(directory.path()));

  // Another program starts a server there, and does not come to an end.
  const host::Descriptor lock{::open(directory.path().c_str(), O_RDONLY | O_DIRECTORY)};
  REQUIRE(::flock(lock.get(), LOCK_EX) == 0);
  CHECK_THAT(VirtualBusServer::open({.path = directory.path() + "/s", .patience = 20ms}).error.what,
             Catch::Contains("lock"));
  REQUIRE(::flock(lock.get(), LOCK_UN) == 0);
  CHECK(VirtualBusServer::open({.path = directory.path() + "/s", .patience = 0ns}));
}

TEST_CASE("programs of another user are turned away, on both sides") {
  if (::geteuid() != 0) return;  // it takes root to become another user
  VirtualBusSetup setup;
  REQUIRE(::chmod(setup.directory.path().c_str(), 0755) == 0);
  constexpr uid_t nobody_user = 65534;
  // The mode of the socket keeps them out.
  CHECK(in_child([&] {
          if (::setuid(nobody_user) != 0) return 10;
          const auto bus = transport::VirtualBus::open(setup.path());
          return !bus && bus.error.what.find("not allowed") == 0 ? 0 : 1;
        }) == 0);
  REQUIRE(::chmod(setup.path().c_str(), 0666) == 0);
  // Without it a client sees whose server it is,
  CHECK(in_child([&] {
          if (::setuid(nobody_user) != 0) return 10;
          const auto bus = transport::VirtualBus::open(setup.path());
          return !bus && bus.error.what.find("another user (uid 0)") != std::string::npos ? 0 : 1;
        }) == 0);
  setup.poll();
  // and a server whose client.
  CHECK(setup.server->counters().turned_away == 1);
  REQUIRE(setup.reports.size() == 1);
  CHECK_THAT(setup.reports[0], Catch::Contains("another user (uid 65534)"));
  CHECK(setup.server->clients() == 0);
}

TEST_CASE("a client of another version learns which one is spoken here") {
  VirtualBusSetup setup;
  RawClient client{setup.path()};
  client.say(vb::Hello{.version = 7});
  setup.poll();
  const vb::Goodbye goodbye = client.dismissal();
  CHECK(goodbye.reason == vb::Reason::bad_version);
  CHECK(goodbye.detail == 7);
  CHECK(goodbye.version == vb::version);
  CHECK(setup.server->counters().turned_away == 1);
  CHECK(setup.server->counters().welcomed == 0);
}

TEST_CASE("garbage disconnects its sender, and no other client") {
  VirtualBusSetup setup;
  const auto good = setup.join();
  const auto dismiss = [&](auto&& talk) {
    RawClient client{setup.path()};
    client.greet();
    setup.poll();
    talk(client);
    setup.poll();
    return client.dismissal();
  };
  const auto garbage = [&](auto content) { return dismiss([&](RawClient& client) { client.say(content); }); };
  using vb::Reason;
  CHECK(garbage(vb::FrameRecord{.dlc = 200}).reason == Reason::bad_dlc);
  CHECK(garbage(vb::FrameRecord{.id = 0x800}).reason == Reason::bad_identifier);
  CHECK(garbage(vb::FrameRecord{.format = 9}).reason == Reason::bad_format);
  CHECK(garbage(vb::FrameRecord{.format = 4, .dlc = 8}).reason == Reason::bad_format);  // an error frame
  CHECK(garbage(vb::Hello{}).reason == Reason::unknown_record);
  CHECK(garbage(vb::Count{.type = vb::Type::credit, .count = 1}).reason == Reason::unknown_record);
  CHECK(garbage(vb::Count{.type = static_cast<vb::Type>(77)}).detail == 77);
  CHECK(garbage(vb::FilterRecord{}).detail == 1);
  CHECK(garbage(vb::FilterRecord{}).reason == Reason::bad_filters);
  CHECK(garbage(vb::Count{.type = vb::Type::filters, .count = 513}).detail == 513);
  for (const std::size_t size : {std::size_t{1}, std::size_t{31}, std::size_t{33}, vb::max_message + 32}) {
    const auto goodbye = dismiss([&](RawClient& client) {
      const std::vector<std::byte> bytes(size);
      client.send(bytes.data(), bytes.size());
    });
    CHECK(goodbye.reason == Reason::bad_size);
  }
  CHECK(setup.server->counters().misbehaved == 14);
  CHECK(setup.server->counters().welcomed == 15);

  // Before the greeting too.
  RawClient stranger{setup.path()};
  stranger.say(frame("205#01"));
  setup.poll();
  CHECK(stranger.dismissal().reason == Reason::no_hello);
  CHECK(setup.server->counters().turned_away == 1);
  CHECK(setup.reports.size() == 15);
  CHECK_THAT(setup.reports[0], Catch::Equals("a client (process " + std::to_string(::getpid()) +
                                             ") was disconnected: it sent a frame with DLC 200; at most 8"));

  CHECK(setup.server->clients() == 1);
  setup.send("605#00");
  setup.run();
  CHECK(received(*good) == Texts{"605#00"});
  CHECK(*good->send(frame("205#01")));
  setup.run();
  CHECK(setup.on_bus == Texts{"605#00", "205#01"});
}

TEST_CASE("a greeting is of the right type and has the magic number") {
  VirtualBusSetup setup;
  RawClient other{setup.path()};
  other.say(vb::Hello{.magic = vb::magic + 1});
  RawClient typed{setup.path()};
  typed.say(vb::Hello{.type = vb::Type::frame});
  setup.poll();
  for (RawClient* const client : {&other, &typed}) CHECK(client->dismissal().reason == vb::Reason::no_hello);
  CHECK(setup.server->counters().turned_away == 2);
}

TEST_CASE("the server's greeting says what the bus is") {
  VirtualBusSetup setup{
      {.name = "a name of many bytes", .bit_rate = 250'000, .data_bit_rate = 1'000'000, .transmit_queue = 7}};
  RawClient client{setup.path()};
  client.greet();
  setup.poll();
  const auto records = client.heard();
  REQUIRE(records.size() == 1);
  const auto hello = vb::from_record<vb::Hello>(records[0]);
  CHECK(hello.type == vb::Type::hello);
  CHECK(hello.fd == 4);
  CHECK(hello.bit_rate == 250'000);
  CHECK(hello.credit == 7);
  CHECK(std::string(hello.name.data(), hello.name.size()) == std::string("a name of m\0", 12));
}

TEST_CASE("a client has room for at least one frame, each way") {
  VirtualBusSetup setup{{.transmit_queue = 0, .output_queue = 0}};
  RawClient client{setup.path()};
  client.greet();
  setup.poll();
  const auto greeting = client.heard();
  REQUIRE(greeting.size() == 1);
  CHECK(vb::from_record<vb::Hello>(greeting[0]).credit == 1);
  client.say(frame("100#"));
  setup.poll();
  setup.send("605#");
  setup.run();
  CHECK(setup.on_bus == Texts{"100#", "605#"});
  CHECK(count_of(client.heard(), vb::Type::frame) == 1);
  CHECK(setup.server->counters().overruns == 0);
}

TEST_CASE("who has not greeted hears nothing") {
  VirtualBusSetup setup;
  RawClient silent{setup.path()};
  const auto sender = setup.join();
  CHECK(*sender->send_any(any("123##1AABB")));
  CHECK(*sender->send_any(any("124#CC")));
  CHECK(setup.server->report_error({.id = 0x40, .dlc = 8, .format = can::Format::error}, setup.now));
  setup.run();
  CHECK(setup.on_bus == Texts{"123##1AABB", "124#CC"});
  CHECK(silent.heard().empty());
  CHECK_FALSE(silent.closed);
  CHECK(setup.server->counters().fd_withheld == 0);
}

TEST_CASE("filters: the latest ones count, each of them, and none lets everything through") {
  VirtualBusSetup setup;
  RawClient client{setup.path()};
  client.greet();
  setup.poll();
  client.heard();
  const auto announce = [&](std::size_t count) {
    client.say(vb::Count{.type = vb::Type::filters, .count = count});
  };
  const auto hears = [&] {
    setup.poll();
    for (const char* text : {"100#", "200#", "300#", "400#"}) setup.send(text);
    setup.run();
    std::vector<std::uint32_t> ids;
    for (const vb::Record& record : client.heard())
      ids.push_back(vb::from_record<vb::FrameRecord>(record).id);
    return ids;
  };
  using Ids = std::vector<std::uint32_t>;
  const auto filter = [&](std::uint32_t id) { client.say(vb::FilterRecord{.id = id, .mask = 0x7FF}); };
  announce(1), filter(0x100);
  CHECK(hears() == Ids{0x100});
  announce(1), filter(0x200);
  CHECK(hears() == Ids{0x200});
  announce(2), filter(0x300);
  CHECK(hears() == Ids{0x200});  // until all are there
  filter(0x400);
  CHECK(hears() == Ids{0x300, 0x400});
  announce(0);
  CHECK(hears() == Ids{0x100, 0x200, 0x300, 0x400});
}

TEST_CASE("512 filters are taken, and no new ones before all that were announced are there") {
  VirtualBusSetup setup;
  RawClient client{setup.path()};
  client.greet();
  client.say(vb::Count{.type = vb::Type::filters, .count = 512});
  for (int i = 0; i < 511; ++i) client.say(vb::FilterRecord{.id = 0x100, .mask = 0x7FF});
  setup.poll();
  CHECK(setup.server->counters().misbehaved == 0);
  client.say(vb::Count{.type = vb::Type::filters, .count = 1});
  setup.poll();
  CHECK(client.dismissal().reason == vb::Reason::bad_filters);
}

TEST_CASE("of each client 64 messages are taken at a poll: then it is the others' turn") {
  for (const int messages : {64, 65}) {
    VirtualBusSetup setup{{.transmit_queue = 1000}};
    RawClient client{setup.path()};
    client.greet();
    setup.poll();
    for (int i = 0; i < messages; ++i) client.say(frame("100#"));
    setup.server->poll(setup.now);
    CHECK(readable(setup.server->descriptor()) == (messages > 64));
  }
}

TEST_CASE("a client of before CAN FD goes on among those that know it, and hears classic frames alone") {
  VirtualBusSetup setup;
  RawClient old{setup.path()};
  old.greet();
  const auto sender = setup.join();
  const auto listener = setup.join();
  setup.poll();
  const auto greeting = old.heard();
  REQUIRE(greeting.size() == 1);
  CHECK(vb::from_record<vb::Hello>(greeting[0]).version == 1);
  old.say(vb::FrameRecord{.dlc = 1, .id = 0x111, .data = {7}});
  for (const char* text : {"123##1AABB", "124#CC", "125##0DD"}) CHECK(*sender->send_any(any(text)));
  setup.run();
  CHECK(received_any(*listener) == Texts{"111#07", "123##1AABB", "124#CC", "125##0DD"});
  std::vector<vb::Type> types;
  for (const vb::Record& record : old.heard()) types.push_back(vb::type_of(record));
  CHECK(types == std::vector{vb::Type::credit, vb::Type::frame});
  CHECK(setup.server->counters().fd_withheld == 2);
  CHECK_FALSE(old.closed);
  // What it never learned is garbage from it, as it was.
  old.say(vb::FdFrameRecord{.length = 1, .flags = 5, .id = 1});
  setup.poll();
  CHECK(old.dismissal().reason == vb::Reason::unknown_record);
}

TEST_CASE("parts of CAN FD frames in any disorder disconnect their sender") {
  const auto records = vb::to_fd_records(any("123##1" + std::string(128, 'A'))).records;
  const auto reason_of = [&](const std::vector<vb::Record>& said) {
    VirtualBusSetup setup;
    RawClient client{setup.path()};
    client.say(vb::Hello{.fd = 1});
    client.send(said.data(), said.size() * vb::record_size);
    setup.poll();
    CHECK(setup.server->counters().misbehaved == 1);
    return client.dismissal().reason;
  };
  const vb::Record classic = vb::to_record(frame("124#"));
  CHECK(reason_of({records[1]}) == vb::Reason::torn_fd_frame);
  CHECK(reason_of({records[0], records[0]}) == vb::Reason::torn_fd_frame);
  CHECK(reason_of({records[0], records[1], classic}) == vb::Reason::torn_fd_frame);
  CHECK(reason_of({records[0], records[1], records[2], records[2]}) == vb::Reason::torn_fd_frame);
  CHECK(reason_of({vb::to_record(vb::FdFrameRecord{.length = 9, .flags = 4})}) == vb::Reason::bad_fd_length);
  CHECK(reason_of({vb::to_record(vb::FdFrameRecord{.flags = 0x14})}) == vb::Reason::bad_fd_flags);
}

TEST_CASE("a slow client misses CAN FD frames whole, and learns how many") {
  VirtualBusSetup setup{{.output_queue = 64}};
  RawClient slow{setup.path()};
  slow.say(vb::Hello{.fd = 1});
  const auto sender = setup.join();
  std::uint64_t sent = 0;
  while (setup.server->counters().overruns < 10) {
    if (*sender->send_any(any("123##1" + std::string(sent % 3 == 0 ? 128 : 2, 'A')))) ++sent;
    setup.run();
    REQUIRE(sent < 100'000);
  }
  setup.server->end();  // what waits there is lost to it, too
  std::uint64_t whole = 0;
  std::uint64_t lost = 0;
  vb::FdAssembly assembly;
  for (const vb::Record& record : slow.heard()) {
    if (vb::type_of(record) == vb::Type::overrun) lost += vb::from_record<vb::Count>(record).count;
    if (vb::type_of(record) != vb::Type::fd_frame && vb::type_of(record) != vb::Type::fd_data) continue;
    const auto part = assembly.take(record);
    REQUIRE(part);
    whole += *part ? 1 : 0;
  }
  CHECK(whole + lost == sent);
  CHECK(lost == setup.server->counters().overruns);
}

TEST_CASE("a CAN FD frame that leaves the queue is credited once, and one beyond the credit disconnects") {
  VirtualBusSetup setup{{.transmit_queue = 2}};
  RawClient client{setup.path()};
  client.say(vb::Hello{.fd = 1});
  const vb::Record fd = vb::to_fd_records(any("123##1AA")).records[0];
  client.send(fd.data(), fd.size());
  setup.poll();
  // Its last bit is disturbed: receivers have it, and get it again.
  auto& arbiter = setup.server->arbiter();
  arbiter.disturb({.boundary = arbiter.clock().boundary_from(setup.server->next_event()) - 1});
  setup.run();
  CHECK(setup.on_bus == Texts{"123##1AA", "123##1AA"});
  std::uint64_t credit = 0;
  for (const vb::Record& record : client.heard())
    if (vb::type_of(record) == vb::Type::credit) credit += vb::from_record<vb::Count>(record).count;
  CHECK(credit == 1);
  for (int i = 0; i < 3; ++i) client.send(fd.data(), fd.size());
  setup.poll();
  CHECK(client.dismissal().reason == vb::Reason::no_credit);
  CHECK(setup.server->counters().withdrawn == 2);
}

TEST_CASE("a bus runs at 1 bit/s to 1 Gbit/s, and the data of CAN FD at no more") {
  const auto failure = [](std::uint32_t bit_rate, std::uint32_t data_bit_rate = 0) {
    const TemporaryDirectory directory;
    const auto opened = VirtualBusServer::open(
        {.path = directory.path() + "/s", .bit_rate = bit_rate, .data_bit_rate = data_bit_rate});
    return opened ? std::string{} : opened.error.what + "; " + opened.error.remedy;
  };
  CHECK(failure(1).empty());
  CHECK(failure(1'000'000'000).empty());
  CHECK(failure(250'000'000, 1'000'000'000).empty());
  CHECK_THAT(failure(600'000'000, 1'200'000'000),
             Catch::Contains("1200000000 bit/s") && Catch::Contains("such as 600000000;"));
}

TEST_CASE("the data of CAN FD run at a whole multiple of the bus's bit rate") {
  const auto failure = [](std::uint32_t bit_rate, std::uint32_t data_bit_rate) {
    const TemporaryDirectory directory;
    const auto opened = simulation::VirtualBusServer::open(
        {.path = directory.path() + "/s", .bit_rate = bit_rate, .data_bit_rate = data_bit_rate});
    return opened ? std::string{} : opened.error.what + "; " + opened.error.remedy;
  };
  CHECK(failure(500'000, 0).empty());
  CHECK(failure(500'000, 500'000).empty());
  CHECK(failure(500'000, 8'000'000).empty());
  CHECK(failure(1'000, 255'000).empty());
  CHECK_THAT(failure(500'000, 750'000),
             Catch::Contains("750000 bit/s") && Catch::Contains("such as 2000000"));
  CHECK_THAT(failure(500'000, 250'000), Catch::Contains("250000 bit/s"));
  CHECK_THAT(failure(1'000, 256'000), Catch::Contains("at most 255 times"));
}

TEST_CASE("frames before the garbage in the same message are withdrawn with their sender") {
  VirtualBusSetup setup;
  RawClient client{setup.path()};
  client.greet();
  const std::array<vb::Record, 3> message{vb::to_record(frame("100#")), vb::to_record(frame("101#")),
                                          vb::to_record(vb::FrameRecord{.dlc = 9})};
  client.send(message.data(), sizeof message);
  setup.run();
  CHECK(setup.on_bus.empty());
  CHECK(setup.server->counters().withdrawn == 2);
  CHECK(setup.server->counters().misbehaved == 1);
}

TEST_CASE("who sends more than it has credit for is disconnected") {
  VirtualBusSetup setup{{.transmit_queue = 4}};
  RawClient client{setup.path()};
  client.greet();
  for (int i = 0; i < 5; ++i) client.say(frame("100#"));
  setup.poll();
  CHECK(client.dismissal().reason == vb::Reason::no_credit);
  CHECK(setup.server->counters().withdrawn == 4);
}

TEST_CASE("a client that dies loses what waits, not what is on the bus, and harms no other") {
  VirtualBusSetup setup;
  const auto listener = setup.join();
  RawClient client{setup.path()};
  client.greet();
  for (const char* text : {"100#01", "100#02", "100#03"}) client.say(frame(text));
  setup.poll();
  setup.now += 10us;  // 100#01 is on the bus
  setup.poll();
  client.say(frame("100#04"));
  client.close();
  setup.send("605#");
  setup.run();
  CHECK(setup.on_bus == Texts{"100#01", "605#"});
  CHECK(received(*listener) == Texts{"100#01", "605#"});
  CHECK(setup.server->counters().died == 1);
  CHECK(setup.server->counters().withdrawn == 3);
  CHECK(setup.server->clients() == 1);
}

TEST_CASE("a client that dies with more to be read than is read at once") {
  VirtualBusSetup setup{{.transmit_queue = 1000}};
  RawClient client{setup.path()};
  client.greet();
  client.say(frame("100#"));
  setup.poll();
  for (int i = 0; i < 200; ++i) client.say(frame("200#"));
  client.close();
  // Credit is due to it and cannot be given any more, and its end is not read yet.
  setup.now = setup.server->next_event();
  setup.run();
  CHECK(setup.on_bus == Texts{"100#"});
  CHECK(setup.server->counters().withdrawn == 200);
  CHECK(setup.server->counters().died == 1);
}

TEST_CASE("what waits for a client that is gone is no overrun") {
  VirtualBusSetup setup{{.transmit_queue = 1000}};
  RawClient client{setup.path()};
  client.greet();
  setup.poll();
  setup.send("605#");
  for (int i = 0; i < 100; ++i) client.say(frame("200#"));  // more than are read at once
  client.close();
  setup.now += 1ms;
  setup.server->poll(setup.now);  // 605# cannot be given to it, and its end is not read yet
  CHECK(setup.server->clients() == 1);
  setup.server->end();
  CHECK(setup.server->counters().overruns == 0);
}

TEST_CASE("a client that leaves makes room for another node") {
  VirtualBusSetup setup;
  auto client = setup.join();
  client.reset();
  setup.poll();
  CHECK(setup.server->counters().left == 1);
  CHECK(setup.server->arbiter().attach().index == 1);  // 0 is that of the setup
}

TEST_CASE("a client that sends alone gets its credit back") {
  VirtualBusSetup setup{{.transmit_queue = 1}};
  const auto client = setup.join();
  for (const char* text : {"100#", "101#", "102#"}) {
    CHECK(*client->send(frame(text)));
    setup.run();
  }
  CHECK(setup.on_bus == Texts{"100#", "101#", "102#"});
}

TEST_CASE("an owner that listens to no frame polls all the same") {
  VirtualBusSetup setup;
  const auto client = setup.join();
  setup.send("605#");
  setup.now += 1ms;
  setup.server->poll(setup.now);
  CHECK(received(*client) == Texts{"605#"});
}

TEST_CASE("a client may ask for nothing but whether a server runs") {
  VirtualBusSetup setup;
  CHECK(transport::VirtualBus::running(setup.path()));
  setup.poll();
  CHECK(setup.server->clients() == 0);
  CHECK(setup.server->counters().died == 0);
  CHECK(setup.reports.empty());
}

TEST_CASE("a slow client learns how much it missed, and stalls no other") {
  VirtualBusSetup setup{{.output_queue = 8}};
  const auto slow = setup.join();
  const auto fast = setup.join();
  constexpr std::size_t frames = 2000;
  std::size_t fast_received = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    setup.send("605#0001020304050607");
    setup.run();
    fast_received += received(*fast).size();
  }
  CHECK(fast_received == frames);
  CHECK(fast->counters().lost == 0);
  const std::uint64_t dropped = setup.server->counters().overruns;
  REQUIRE(dropped > 0);

  // It wakes up and reads all there is; the notice comes as soon as there is room for it.
  std::size_t slow_received = received(*slow).size();
  setup.poll();
  slow_received += received(*slow).size();
  CHECK(slow->counters().lost == dropped);
  CHECK(slow_received + dropped == frames);
  CHECK(slow->counters().received == slow_received);

  setup.send("606#");
  setup.run();
  CHECK(received(*slow) == Texts{"606#"});
  CHECK(setup.server->counters().overruns == dropped);
}

TEST_CASE("more than a message holds goes out in several: credit and losses first, frames in order") {
  VirtualBusSetup setup{{.output_queue = 200}};
  RawClient client{setup.path()};
  client.greet();
  setup.poll();
  CHECK(client.heard().size() == 1);  // hello
  // While the owner only advances, all waits.
  const auto wait_for = [&](unsigned frames) {
    client.say(frame("100#"));
    setup.poll();
    for (unsigned i = 0; i < frames; ++i)
      CHECK(*setup.server->arbiter().send(setup.port, {.id = 0x200 + i}, setup.now));
    setup.now += 1s;
    setup.server->advance(setup.now, [](const simulation::Delivery&) {});
    CHECK(client.heard().empty());
    setup.poll();
  };
  const auto messages = [&] {
    std::vector<std::vector<vb::Record>> all;
    std::array<vb::Record, vb::max_records + 1> message{};
    for (ssize_t size = 0;
         (size = ::recv(client.descriptor(), message.data(), sizeof message, MSG_DONTWAIT)) > 0;)
      all.emplace_back(message.begin(), message.begin() + size / static_cast<ssize_t>(vb::record_size));
    return all;
  };
  const auto check_frames = [](const std::vector<vb::Record>& message, std::size_t from, unsigned first) {
    for (std::size_t i = from; i < message.size(); ++i, ++first) {
      REQUIRE(vb::type_of(message[i]) == vb::Type::frame);
      REQUIRE(vb::from_record<vb::FrameRecord>(message[i]).id == 0x200 + first);
    }
  };

  wait_for(130);  // one credit and 130 frames; a message has 128
  auto all = messages();
  REQUIRE(all.size() == 2);
  REQUIRE(all[0].size() == 128);
  REQUIRE(all[1].size() == 3);
  CHECK(vb::type_of(all[0][0]) == vb::Type::credit);
  CHECK(vb::from_record<vb::Count>(all[0][0]).count == 1);
  check_frames(all[0], 1, 0);
  check_frames(all[1], 0, 127);

  wait_for(300);  // the queue has 200: a hundred are lost
  all = messages();
  REQUIRE(all.size() == 2);
  REQUIRE(all[0].size() == 128);
  REQUIRE(all[1].size() == 74);
  CHECK(vb::type_of(all[0][0]) == vb::Type::credit);
  CHECK(vb::from_record<vb::Count>(all[0][0]).count == 1);
  REQUIRE(vb::type_of(all[0][1]) == vb::Type::overrun);
  CHECK(vb::from_record<vb::Count>(all[0][1]).count == 100);
  check_frames(all[0], 2, 0);
  check_frames(all[1], 0, 126);

  wait_for(127);  // one message, full
  all = messages();
  REQUIRE(all.size() == 1);
  CHECK(all[0].size() == 128);
}

TEST_CASE("the server ends while a client is behind: what it reads in time it gets, the rest is counted") {
  constexpr std::size_t frames = 10'000;
  VirtualBusSetup setup{{.last_flush = 10ms}};
  const auto asleep = setup.join();
  for (std::size_t i = 0; i < frames; ++i) setup.send("605#0001020304050607");
  setup.run();
  setup.server->end();
  const std::uint64_t dropped = setup.server->counters().overruns;
  setup.server.reset();
  const std::size_t heard = received(*asleep).size();
  CHECK(heard > 0);
  CHECK(asleep->counters().lost > 0);
  CHECK(asleep->counters().lost == dropped);
  CHECK(heard + dropped == frames);
  CHECK_THAT(asleep->failure().what, Catch::Contains("was ended"));
}

TEST_CASE("the server waits at its end for a client that reads, and not for one that is gone") {
  constexpr std::size_t frames = 5000;  // more than the kernel holds
  VirtualBusSetup setup{{.output_queue = frames, .last_flush = 30s}};
  const auto late = setup.join();
  RawClient dead{setup.path()};
  dead.greet();
  for (std::size_t i = 0; i < frames; ++i) setup.send("605#0001020304050607");
  setup.run();
  std::thread end{[&] { setup.server.reset(); }};
  std::size_t heard = 0;
  while (heard < frames && late->receive(10s)) ++heard;
  dead.close();
  end.join();
  CHECK(heard == frames);
  CHECK(late->counters().lost == 0);
  CHECK(late->receive(1h).error == base::Error::closed);
  CHECK_THAT(late->failure().what, Catch::Contains("was ended"));
}

TEST_CASE("a client that misbehaves while it is behind learns why it is disconnected, and what it missed") {
  constexpr std::size_t frames = 10'000;
  VirtualBusSetup setup;
  RawClient client{setup.path()};
  client.greet();
  for (std::size_t i = 0; i < frames; ++i) setup.send("605#");
  setup.run();
  client.say(vb::FrameRecord{.dlc = 200});
  setup.poll();
  const auto records = client.heard();
  REQUIRE(records.size() >= 2);
  CHECK(vb::type_of(records.back()) == vb::Type::goodbye);
  CHECK(vb::from_record<vb::Goodbye>(records.back()).reason == vb::Reason::bad_dlc);
  const vb::Record& overrun = records[records.size() - 2];
  REQUIRE(vb::type_of(overrun) == vb::Type::overrun);
  // All but a hello, the overrun and the goodbye are frames.
  CHECK(records.size() - 3 + vb::from_record<vb::Count>(overrun).count == frames);
  CHECK(setup.server->counters().overruns == vb::from_record<vb::Count>(overrun).count);
}

TEST_CASE("a client that misbehaves gets what is on its way to it before it is disconnected") {
  VirtualBusSetup setup;
  RawClient client{setup.path()};
  client.greet();
  setup.poll();
  setup.send("605#");
  client.say(vb::FrameRecord{.dlc = 200});
  setup.now += 1ms;
  setup.server->poll(setup.now);
  const auto records = client.heard();
  REQUIRE(records.size() == 3);
  CHECK(vb::type_of(records[1]) == vb::Type::frame);
  CHECK(vb::type_of(records[2]) == vb::Type::goodbye);
  CHECK(setup.server->counters().overruns == 0);
}

TEST_CASE("a client that is behind and disconnected learns its credit, what it missed, and why") {
  constexpr std::size_t frames = 10'000;
  VirtualBusSetup setup{{.output_queue = 4}};
  RawClient client{setup.path()};
  client.greet();
  for (std::size_t i = 0; i < frames; ++i) setup.send("605#");
  setup.run();
  REQUIRE(setup.server->counters().overruns > 0);
  client.say(frame("100#"));
  setup.run();
  client.say(vb::FrameRecord{.dlc = 200});
  setup.poll();
  const auto records = client.heard();
  REQUIRE(records.size() > 4);
  const auto last = std::span{records}.last(3);
  CHECK(vb::type_of(last[0]) == vb::Type::credit);
  CHECK(vb::from_record<vb::Count>(last[0]).count == 1);
  CHECK(vb::type_of(last[1]) == vb::Type::overrun);
  CHECK(vb::from_record<vb::Count>(last[1]).count == frames - count_of(records, vb::Type::frame));
  CHECK(vb::type_of(last[2]) == vb::Type::goodbye);
  CHECK(client.closed);
}

TEST_CASE("an ended server has no clients") {
  VirtualBusSetup setup;
  RawClient client{setup.path()};
  client.greet();
  setup.poll();
  setup.server->end();
  CHECK(setup.server->clients() == 0);
  CHECK(client.dismissal().reason == vb::Reason::ended);
}

TEST_CASE("a server at whose end nothing waits for its clients ends at once") {
  VirtualBusSetup setup{{.last_flush = 10s}};
  RawClient client{setup.path()};
  client.greet();
  setup.poll();
  const auto begin = std::chrono::steady_clock::now();
  setup.server->end();
  CHECK(std::chrono::steady_clock::now() - begin < 5s);
  CHECK(client.dismissal().reason == vb::Reason::ended);
}

TEST_CASE("a client that never reads can go on sending while it has credit, and gets it back later") {
  VirtualBusSetup setup{{.transmit_queue = 2, .output_queue = 4}};
  const auto deaf = setup.join();
  for (int i = 0; i < 2000; ++i) setup.send("605#00");
  setup.run();
  REQUIRE(setup.server->counters().overruns > 0);  // its socket and its queue are full
  CHECK(*deaf->send(frame("100#01")));
  CHECK(*deaf->send(frame("100#02")));
  setup.run();
  // Looking for credit empties its socket, and the server then has room to give it.
  CHECK_FALSE(*deaf->send(frame("100#03")));
  setup.poll();
  CHECK(*deaf->send(frame("100#03")));
  setup.run();
  CHECK(setup.on_bus.back() == "100#03");
  CHECK(received(*deaf).size() + deaf->counters().lost == 2000);
}

TEST_CASE("no file descriptor left: the client gets the reason, is counted, and the next one gets in") {
  VirtualBusSetup setup{{.raise_descriptor_limit = false}};
  const auto good = setup.join();
  RawClient unlucky{setup.path()};
  unlucky.greet();
  rlimit limit{};
  REQUIRE(::getrlimit(RLIMIT_NOFILE, &limit) == 0);
  rlimit tight = limit;
  {
    const host::Descriptor next{::open("/dev/null", O_RDONLY)};  // the lowest free number
    tight.rlim_cur = static_cast<rlim_t>(next.get());
  }
  REQUIRE(::setrlimit(RLIMIT_NOFILE, &tight) == 0);
  setup.poll();
  REQUIRE(::setrlimit(RLIMIT_NOFILE, &limit) == 0);
  CHECK(unlucky.dismissal().reason == vb::Reason::full);
  CHECK(setup.server->counters().accept_failures == 1);
  CHECK(setup.server->clients() == 1);
  CHECK(setup.reports == Texts{"a client (process " + std::to_string(::getpid()) +
                               ") was disconnected: the simulator has no file descriptor left for it"});

  const auto next = setup.join();
  CHECK(*next->send(frame("205#01")));
  setup.run();
  CHECK(received(*good) == Texts{"205#01"});
}

TEST_CASE("no file descriptor left, twice: the second client gets the reason, too") {
  VirtualBusSetup setup{{.raise_descriptor_limit = false}};
  for (std::uint64_t i = 1; i <= 2; ++i) {
    RawClient unlucky{setup.path()};
    const DescriptorsLeft none{0};
    setup.poll();
    CHECK(unlucky.dismissal().reason == vb::Reason::full);
    CHECK(setup.server->counters().accept_failures == i);
  }
}

TEST_CASE(
    "not even a descriptor to turn clients away: the server looks again later, and keeps quiet till then") {
  VirtualBusSetup setup{{.raise_descriptor_limit = false}};
  const auto good = setup.join();
  RawClient waiting{setup.path()};
  waiting.greet();
  rlimit limit{};
  REQUIRE(::getrlimit(RLIMIT_NOFILE, &limit) == 0);
  rlimit tight = limit;
  tight.rlim_cur = 3;
  REQUIRE(::setrlimit(RLIMIT_NOFILE, &tight) == 0);
  setup.poll();
  REQUIRE(::setrlimit(RLIMIT_NOFILE, &limit) == 0);
  CHECK(setup.server->counters().accept_failures == 1);
  CHECK_FALSE(readable(setup.server->descriptor()));
  CHECK(setup.server->next_event() == setup.now + 100ms);

  setup.send("605#");
  setup.run();
  CHECK(received(*good) == Texts{"605#"});
  CHECK(setup.server->clients() == 1);
  setup.now = setup.server->next_event();
  setup.server->advance(setup.now, [](const simulation::Delivery&) {});
  CHECK(setup.server->next_event() == base::never);  // an owner that goes from event to event gets on
  CHECK(setup.server->clients() == 1);
  setup.poll();
  CHECK(setup.server->clients() == 2);
  CHECK(waiting.heard().size() == 1);
  CHECK(setup.server->next_event() == base::never);

  // From now on all is as before: it wakes up for a client, and has a descriptor to turn one away with.
  RawClient unlucky{setup.path()};
  CHECK(readable(setup.server->descriptor()));
  const DescriptorsLeft none{0};
  setup.poll();
  CHECK(unlucky.dismissal().reason == vb::Reason::full);
}

TEST_CASE("the descriptor limit is raised as far as the process may") {
  rlimit limit{};
  REQUIRE(::getrlimit(RLIMIT_NOFILE, &limit) == 0);
  rlimit low = limit;
  low.rlim_cur = 256;
  REQUIRE(::setrlimit(RLIMIT_NOFILE, &low) == 0);
  VirtualBusSetup setup;
  rlimit now{};
  REQUIRE(::getrlimit(RLIMIT_NOFILE, &now) == 0);
  CHECK(now.rlim_cur == limit.rlim_max);
  REQUIRE(::setrlimit(RLIMIT_NOFILE, &limit) == 0);
}

TEST_CASE("a hundred clients, each a node of its own") {
  VirtualBusSetup setup;
  std::vector<std::unique_ptr<transport::VirtualBus>> clients;
  for (int i = 0; i < 100; ++i) clients.push_back(setup.join());
  // All within one bit time, the least urgent first: the bus puts them into order.
  Texts expected;
  for (unsigned i = 0; i < 100; ++i) {
    CHECK(*clients[i]->send({.id = 0x100 + 99 - i}));
    expected.emplace_back(can::to_text({.id = 0x100 + i}).view());
  }
  setup.run();
  CHECK(setup.on_bus == expected);
  for (unsigned i = 0; i < 100; ++i) {
    Texts heard = expected;
    heard.erase(heard.begin() + (99 - i));
    CHECK(received(*clients[i]) == heard);
    CHECK(clients[i]->counters().lost == 0);
  }
  clients.clear();
  setup.poll();
  CHECK(setup.server->clients() == 0);
  CHECK(setup.server->counters().left == 100);
}

TEST_CASE("time stamps are those of the bus, in the owner's Unix time") {
  VirtualBusSetup setup{{.epoch = base::Time{1s}, .to_unix_time = 1'700'000'000s - 1s}};
  const auto client = setup.join();
  setup.now += 1us;
  setup.send("605#00D20000");
  setup.run();
  const auto one = client->receive(0ns);
  REQUIRE(one);
  // Handed over in the first bit, sent from the next boundary on, 2 us a bit.
  CHECK(one->time.time_since_epoch() == 1'700'000'000s + (1 + can::frame_bits(frame("605#00D20000"))) * 2us);
}

TEST_CASE("so are those of CAN FD frames, of errors, and of the owner's own error frames") {
  VirtualBusSetup setup{{.epoch = base::Time{1s}, .to_unix_time = 1000s}};
  const auto client = setup.join();
  const auto stamp = [&] {
    const auto one = client->receive_any(0ns);
    REQUIRE(one);
    return one->time.time_since_epoch();
  };
  CHECK(*setup.server->arbiter().send_any(setup.port, any("123##1AA"), setup.now));
  setup.poll();
  const base::Duration end = setup.server->next_event().time_since_epoch();
  setup.run();
  CHECK(stamp() == end + 1000s);

  setup.now = base::Time{2s};
  setup.poll();
  setup.server->arbiter().disturb({.boundary = 600'000});  // on an idle bus, at 1 s + 600'000 * 2 us
  setup.run();
  CHECK(stamp() == 1000s + 2'200'002us);

  CHECK(setup.server->report_error({.id = 0x40, .dlc = 8, .format = can::Format::error}, base::Time{7s}));
  setup.poll();
  CHECK(stamp() == 1007s);
}

TEST_CASE("an error on the bus: each client gets a report, and the frame comes nevertheless") {
  VirtualBusSetup setup;
  const auto sender = setup.join();
  const auto listener = setup.join();
  RawClient silent{setup.path()};  // connected, and has not said who it is
  CHECK(sender->send(frame("205#01840302")));
  setup.poll();
  auto& arbiter = setup.server->arbiter();
  const std::uint64_t present = arbiter.clock().boundary_from(setup.now);
  arbiter.disturb({.boundary = present + 20});
  // In the last bit of the repetition: the listener gets it twice.
  arbiter.disturb({.boundary = present + 20 + 1 + 6 + 8 + 3 + can::frame_bits(frame("205#01840302")) - 1});
  setup.run();
  const auto to_sender = sender->receive(0ns);
  REQUIRE(to_sender);
  CHECK(to_sender->frame.format == can::Format::error);
  CHECK(can::describe(to_sender->frame).view() ==
        "bit error while sending, error counters: sending 8, receiving 0");
  CHECK(to_sender->time.time_since_epoch() == (present + 21) * 2us);
  const auto to_listener = listener->receive(0ns);
  REQUIRE(to_listener);
  CHECK(can::describe(to_listener->frame).view() == "stuff error, error counters: sending 0, receiving 1");
  CHECK(received(*sender).size() == 1);
  const Texts rest = received(*listener);
  REQUIRE(rest.size() == 3);
  CHECK(rest[0] == "205#01840302");  // it had it before the error was seen
  CHECK(rest[2] == "205#01840302");
  CHECK(silent.heard().empty());
  CHECK_FALSE(silent.closed);
  CHECK(setup.server->counters().misbehaved == 0);

  // A frame that was delivered twice has come out of the queue once: 64 more are taken, and no 65th.
  for (int i = 0; i < 64; ++i) CHECK(*sender->send(frame("100#")));
  CHECK_FALSE(*sender->send(frame("100#")));
  setup.poll();
  CHECK(setup.server->counters().misbehaved == 0);
}

TEST_CASE("an error on the bus: a client hears that it is error passive, and off the bus") {
  VirtualBusSetup setup;
  const auto client = setup.join();
  CHECK(*client->send(frame("100#")));
  setup.poll();
  auto& arbiter = setup.server->arbiter();
  std::vector<std::string> texts;
  for (int i = 0; i < 32; ++i) {
    arbiter.disturb({.boundary = arbiter.clock().boundary_from(setup.now) + 40});
    setup.now += 41 * 2us;
    setup.poll();
    while (const auto one = client->receive(0ns)) texts.emplace_back(can::describe(one->frame).view());
  }
  REQUIRE(texts.size() == 32);
  CHECK(texts[14] == "bit error while sending, error counters: sending 120, receiving 0");
  CHECK(texts[15] ==
        "error passive (sending), bit error while sending, error counters: sending 128, receiving 0");
  CHECK(texts[31] ==
        "bus-off: the controller has left the bus, bit error while sending, error counters: sending 255, "
        "receiving 0");
  setup.now += (128 * 11 + 100) * 2us;
  setup.run();
  CHECK(arbiter.totals().frames == 1);
}

TEST_CASE("an error frame of the owner reaches every client, whatever its filters") {
  VirtualBusSetup setup;
  const auto client = setup.join();
  const std::array filters{can::Filter{0x100, 0x7FF}};
  CHECK(client->subscribe(filters));
  setup.poll();
  const can::Frame bus_off{.id = 0x40, .dlc = 8, .format = can::Format::error};
  CHECK(setup.server->report_error(bus_off, setup.now));
  CHECK(setup.server->report_error(frame("605#"), setup.now).error == base::Error::bad_identifier);
  setup.poll();
  const auto one = client->receive(0ns);
  REQUIRE(one);
  CHECK(one->frame == bus_off);
  CHECK(client->counters().error_frames == 1);
  CHECK(setup.on_bus.empty());
}

TEST_CASE("next_event is what the bus does next") {
  VirtualBusSetup setup;
  CHECK(setup.server->next_event() == base::never);
  setup.send("605#");
  CHECK(setup.server->next_event() == setup.server->arbiter().next_event());
  setup.server->advance(setup.server->next_event(), [](const simulation::Delivery&) {});
  CHECK(setup.server->next_event() == base::never);
  CHECK(setup.server->arbiter().totals().frames == 1);
}

TEST_CASE("whatever clients send, the others go on") {
  VirtualBusSetup setup;
  const auto sender = setup.join();
  const auto listener = setup.join();
  std::mt19937 random{20260101};
  const auto below = [&](std::uint32_t bound) { return static_cast<std::uint32_t>(random() % bound); };
  std::vector<std::unique_ptr<RawClient>> wild;
  for (unsigned i = 0; i < 5000; ++i) {
    if (wild.size() < 5) {
      wild.push_back(std::make_unique<RawClient>(setup.path()));
      if (below(8) != 0) wild.back()->greet();
    }
    const std::size_t one = below(static_cast<std::uint32_t>(wild.size()));
    RawClient& client = *wild[one];
    // Mostly records that are nearly right, at times anything at all.
    std::vector<vb::Record> records(1 + below(4));
    for (vb::Record& record : records) {
      vb::FrameRecord content{.format = static_cast<std::uint8_t>(below(4)),
                              .dlc = static_cast<std::uint8_t>(below(9)),
                              .id = below(0x700) + 0x100};
      record = vb::to_record(content);
      record[0] = static_cast<std::byte>(below(4) == 0 ? below(10) : 2);
      if (below(4) == 0) record[below(vb::record_size)] = static_cast<std::byte>(below(256));
    }
    const std::size_t whole = records.size() * vb::record_size;
    client.send(records.data(), below(10) == 0 ? below(static_cast<std::uint32_t>(whole)) : whole);
    if (below(20) == 0) client.heard();
    if (below(10) == 0) wild.erase(wild.begin() + static_cast<std::ptrdiff_t>(one));

    if (i % 10 == 0) {
      CHECK(*sender->send({.id = 0, .dlc = 2, .data = {static_cast<std::uint8_t>(i / 10), 0}}));
      setup.run();
      bool heard = false;
      while (const auto frame = listener->receive(0ns))
        heard |= frame->frame.id == 0 && frame->frame.dlc == 2 &&
                 frame->frame.data[0] == static_cast<std::uint8_t>(i / 10);
      REQUIRE(heard);
      received(*sender);
    }
    // A client that was hung up on is replaced.
    std::erase_if(wild, [](const auto& other) {
      std::byte peek{};
      return ::recv(other->descriptor(), &peek, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
    });
  }
  wild.clear();
  setup.run();
  const auto& counters = setup.server->counters();
  CHECK(setup.server->clients() == 2);
  CHECK(counters.misbehaved > 100);
  CHECK(counters.died > 50);
  CHECK(counters.left > 10);
  CHECK(counters.welcomed == counters.misbehaved + counters.died + counters.left + 2);
  CHECK(sender->counters().sent == 500);
  CHECK(listener->counters().lost == 0);
}

TEST_CASE("the default directory is made for the user alone, and the socket too") {
  const TemporaryDirectory runtime;
  const Environment set{"XDG_RUNTIME_DIR", runtime.path().c_str()};
  const mode_t mask = ::umask(0);  // even when the user's umask is open elsewhere
  const auto server = simulation::VirtualBusServer::open();
  ::umask(mask);
  INFO(server.error.what);
  REQUIRE(server);
  struct stat status {};
  REQUIRE(::stat((runtime.path() + "/ocm").c_str(), &status) == 0);
  CHECK((status.st_mode & 07777) == 0700);
  REQUIRE(::stat((*server)->path().c_str(), &status) == 0);
  CHECK((status.st_mode & 07777) == 0600);
  CHECK(transport::VirtualBus::running());

  const TemporaryDirectory other;
  const Environment elsewhere{"XDG_RUNTIME_DIR", other.path().c_str()};
  CHECK_FALSE(transport::VirtualBus::running());
  REQUIRE(::mkdir((other.path() + "/ocm").c_str(), 0700) == 0);
  REQUIRE(::chmod((other.path() + "/ocm").c_str(), 0755) == 0);
  CHECK_THAT(simulation::VirtualBusServer::open().error.what, Catch::Contains("open to other users"));
}

}  // namespace simulation_virtual_bus_server_test
