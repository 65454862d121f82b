#include "ocm/c/client.h"

#include <cstddef>
#include <random>

#include "unit/transport/virtual_bus_setup.hpp"

namespace c_client_test {

using namespace ocm;
using namespace ocm::test;

// What the C header says of the simulator's protocol, by the structs that say it first.
static_assert(OCM_CLIENT_RECORD == vb::record_size);
static_assert(OCM_CLIENT_MESSAGE == vb::max_message);
static_assert(OCM_CLIENT_VERSION == vb::version);
static_assert(OCM_CLIENT_MAGIC == vb::magic);
static_assert(OCM_CLIENT_HELLO == static_cast<int>(vb::Type::hello));
static_assert(OCM_CLIENT_FRAME == static_cast<int>(vb::Type::frame));
static_assert(OCM_CLIENT_CREDIT == static_cast<int>(vb::Type::credit));
static_assert(OCM_CLIENT_OVERRUN == static_cast<int>(vb::Type::overrun));
static_assert(OCM_CLIENT_GOODBYE == static_cast<int>(vb::Type::goodbye));
static_assert(offsetof(vb::Hello, magic) == 4 && offsetof(vb::Hello, version) == 8);
static_assert(offsetof(vb::Hello, bit_rate) == 12 && offsetof(vb::Hello, credit) == 16);
static_assert(offsetof(vb::FrameRecord, format) == 1 && offsetof(vb::FrameRecord, dlc) == 2);
static_assert(offsetof(vb::FrameRecord, id) == 4 && offsetof(vb::FrameRecord, time_ns) == 8);
static_assert(offsetof(vb::FrameRecord, data) == 16 && offsetof(vb::Count, count) == 8);
static_assert(offsetof(vb::Goodbye, reason) == 1 && offsetof(vb::Goodbye, version) == 4);
static_assert(static_cast<int>(can::Format::extended) == 1 &&
              static_cast<int>(can::Format::base_remote) == 2);
static_assert(static_cast<int>(can::Format::extended_remote) == 3 &&
              static_cast<int>(can::Format::error) == 4);

/// A client of a server whose time the test hands in.
struct Setup : VirtualBusSetup {
  explicit Setup(simulation::VirtualBusOptions options = {}) : VirtualBusSetup(std::move(options)) {}
  ~Setup() { ocm_client_close(&client); }
  Setup(const Setup&) = delete;
  Setup& operator=(const Setup&) = delete;

  using VirtualBusSetup::send;
  int open() {
    std::atomic<bool> done{false};
    int result = 0;
    std::thread opener{[&] {
      result = ocm_client_open(&client, ("sim:" + path()).c_str(), 2000);
      done = true;
    }};
    while (!done) {
      pollfd entry{server->descriptor(), POLLIN, 0};
      ::poll(&entry, 1, 1);
      poll();
    }
    opener.join();
    return result;
  }
  int send(std::uint32_t id, const std::vector<std::uint8_t>& bytes) {
    std::array<std::uint8_t, 8> data{};
    std::copy(bytes.begin(), bytes.end(), data.begin());
    return ocm_client_send(&client, id, static_cast<std::uint8_t>(bytes.size()), data.data(), 0);
  }

  ocm_client client{};
};

TEST_CASE("C client: frames of all kinds go out and come in as they are") {
  Setup setup;
  REQUIRE(setup.open() == 1);
  CHECK(setup.client.bit_rate == 500'000);
  CHECK(setup.send(0x201, {0x50, 0xC3, 0, 0, 0, 0, 0, 0}) == 1);
  CHECK(setup.send(0x18FEF100 | OCM_CLIENT_EXTENDED, {1, 2}) == 1);
  CHECK(setup.send(0x123 | OCM_CLIENT_REMOTE, {0, 0, 0}) == 1);
  CHECK(setup.send(0x5 | OCM_CLIENT_REMOTE | OCM_CLIENT_EXTENDED, {}) == 1);
  setup.run();
  CHECK(setup.on_bus == Texts{"201#50C3000000000000", "18FEF100#0102", "123#R3", "00000005#R"});

  setup.send("605#00D20000");
  setup.send("12345678#AA");
  setup.send("7FF#R8");
  setup.run();
  ocm_client_frame frame{};
  REQUIRE(ocm_client_receive(&setup.client, &frame, 0) == 1);
  CHECK(frame.id == 0x605);
  CHECK(frame.dlc == 4);
  CHECK(frame.data[1] == 0xD2);
  CHECK(frame.time_ns > 0);
  REQUIRE(ocm_client_receive(&setup.client, &frame, 0) == 1);
  CHECK(frame.id == (0x12345678 | OCM_CLIENT_EXTENDED));
  REQUIRE(ocm_client_receive(&setup.client, &frame, 0) == 1);
  CHECK(frame.id == (0x7FF | OCM_CLIENT_REMOTE));
  CHECK(frame.dlc == 8);
  CHECK(ocm_client_receive(&setup.client, &frame, 0) == 0);
  CHECK(setup.client.received == 3);

  setup.send("12345678#AA");
  setup.send("605#01");
  setup.run();
  std::uint16_t id = 0;
  std::uint8_t dlc = 0;
  std::array<std::uint8_t, 8> data{};
  CHECK(ocm_client_receive_base(&setup.client, &id, &dlc, data.data(), 0) == 1);
  CHECK((id == 0x605 && dlc == 1 && data[0] == 1));
  CHECK(ocm_client_receive_base(&setup.client, &id, &dlc, data.data(), 0) == 0);
  CHECK(setup.client.left_out == 1);
}

TEST_CASE("C client: what no frame can be is refused") {
  Setup setup;
  REQUIRE(setup.open() == 1);
  std::array<std::uint8_t, 8> data{};
  CHECK(ocm_client_send(&setup.client, 0x800, 0, data.data(), 0) == OCM_CLIENT_BAD_FRAME);
  CHECK(std::string{setup.client.why} == "no frame has identifier 800 and 0 bytes");
  CHECK(ocm_client_send(&setup.client, 0x20000000 | OCM_CLIENT_EXTENDED, 0, data.data(), 0) ==
        OCM_CLIENT_BAD_FRAME);
  CHECK(ocm_client_send(&setup.client, 1, 9, data.data(), 0) == OCM_CLIENT_BAD_FRAME);
  setup.run();
  CHECK(setup.on_bus.empty());
}

TEST_CASE("C client: a full transmit queue is no room, and room again once a frame has left") {
  simulation::VirtualBusOptions options;
  options.transmit_queue = 4;
  Setup setup{std::move(options)};
  REQUIRE(setup.open() == 1);
  for (int i = 0; i < 4; ++i) CHECK(setup.send(0x100, {1}) == 1);
  CHECK(setup.send(0x100, {1}) == 0);
  setup.run();
  CHECK(setup.on_bus.size() == 4);
  CHECK(setup.send(0x100, {2}) == 1);
  CHECK(setup.client.sent == 5);
}

TEST_CASE("C client: what it does not read in time is counted") {
  Setup setup;
  REQUIRE(setup.open() == 1);
  constexpr std::uint64_t frames = 9000;  // more than server, kernel and inbox keep
  for (std::uint64_t i = 0; i < frames; ++i) {
    setup.send("100#00");
    if (i % 100 == 99) setup.run();
  }
  setup.run();
  ocm_client_frame frame{};
  std::uint64_t read = 0;
  for (int none = 0; none < 3;) {
    setup.run();
    if (ocm_client_receive(&setup.client, &frame, 0) == 1)
      ++read, none = 0;
    else
      ++none;
  }
  CHECK(setup.client.lost > 0);
  CHECK(read + setup.client.lost == frames);
}

TEST_CASE("C client: while it only sends, the frames that come are kept up to its inbox") {
  simulation::VirtualBusOptions options;
  options.transmit_queue = 1;
  Setup setup{std::move(options)};
  REQUIRE(setup.open() == 1);
  constexpr int frames = OCM_CLIENT_INBOX + 50;
  for (int i = 0; i < frames; ++i) {
    setup.send("100#00");
    REQUIRE(setup.send(0x200, {}) == 1);  // reads its credit, and what came before
    setup.run();
  }
  ocm_client_frame frame{};
  int read = 0;
  while (ocm_client_receive(&setup.client, &frame, 0) == 1) ++read;
  CHECK(setup.client.lost > 0);
  CHECK(static_cast<std::uint64_t>(read) + setup.client.lost == frames);
}

TEST_CASE("C client: the end of the server comes behind what waits") {
  Setup setup;
  REQUIRE(setup.open() == 1);
  setup.send("605#01");
  setup.run();
  setup.server.reset();
  ocm_client_frame frame{};
  CHECK(ocm_client_receive(&setup.client, &frame, 0) == 1);
  CHECK(ocm_client_receive(&setup.client, &frame, 0) == OCM_CLIENT_GONE);
  CHECK(std::string{setup.client.why}.starts_with("the simulator has ended"));
  CHECK(setup.client.socket == -1);
  CHECK(ocm_client_receive(&setup.client, &frame, 0) == OCM_CLIENT_GONE);
  CHECK(setup.send(1, {}) == OCM_CLIENT_GONE);
}

TEST_CASE("C client: what it said leaves after it has gone") {
  Setup setup;
  REQUIRE(setup.open() == 1);
  CHECK(setup.send(0x201, {1}) == 1);
  CHECK(setup.send(0x202, {2}) == 1);
  ocm_client_close(&setup.client);
  setup.run();
  CHECK(setup.on_bus == Texts{"201#01", "202#02"});
  CHECK(setup.server->counters().left == 1);
}

TEST_CASE("C client: no bus of that name") {
  ocm_client client;
  CHECK(ocm_client_open(&client, "sim:/nowhere/sim.sock", 100) == OCM_CLIENT_GONE);
  CHECK_THAT(client.why, Catch::Contains("no simulator is running"));
  CHECK(ocm_client_open(&client, ("sim:/" + std::string(200, 'x')).c_str(), 100) == OCM_CLIENT_GONE);
  CHECK_THAT(client.why, Catch::Contains("no socket can have this path"));
  CHECK(ocm_client_open(&client, "can987", 100) == OCM_CLIENT_GONE);
  CHECK_THAT(client.why, Catch::Contains("no such interface: can987"));
  ocm_client_close(&client);
}

TEST_CASE("C client: a server that says anything ends it in words at worst") {
  std::mt19937 random{11};
  for (int run = 0; run < 300; ++run) {
    int ends[2];
    REQUIRE(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends) == 0);
    const host::Descriptor server{ends[0]};
    ocm_client client{};
    client.socket = ends[1];
    client.simulated = 1;
    for (int message = 0; message < 20; ++message) {
      std::vector<std::uint8_t> bytes(random() % 4 == 0 ? random() % 4096 : 32 * (random() % 4 + 1));
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      for (std::size_t at = 0; at < bytes.size(); at += 32)
        bytes[at] = static_cast<std::uint8_t>(random() % 11);
      if (message == 0) {
        const auto hello = vb::to_record(vb::Hello{.bit_rate = 500'000, .credit = 64});
        ::send(server.get(), hello.data(), hello.size(), MSG_NOSIGNAL);
      }
      ::send(server.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    }
    ocm_client_frame frame{};
    int result = 1;
    for (int i = 0; i < 3000 && result == 1; ++i) {
      result = ocm_client_receive(&client, &frame, 0);
      if (result == 1) CHECK(frame.dlc <= 8);
    }
    CHECK((result == 0 || client.why[0] != '\0'));
    ocm_client_close(&client);
  }
}

}  // namespace c_client_test
