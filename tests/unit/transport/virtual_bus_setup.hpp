/// A virtual bus with a server whose time the test hands in, and clients on real sockets, all in one process.
#pragma once

#include <atomic>
#include <poll.h>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/any_text.hpp"
#include "ocm/can/text.hpp"
#include "ocm/simulation/virtual_bus_server.hpp"
#include "ocm/transport/virtual_bus.hpp"

#include "unit/can/frame_of.hpp"
#include "unit/host/host_testing.hpp"

namespace ocm::test {

namespace vb = transport::virtual_bus;
using namespace std::chrono_literals;

using Texts = std::vector<std::string>;

inline bool readable(int descriptor) {
  pollfd entry{descriptor, POLLIN, 0};
  return ::poll(&entry, 1, 0) == 1;
}

/// The frames that wait for a client, as candump writes them.
inline Texts received(transport::VirtualBus& bus) {
  Texts texts;
  while (const auto one = bus.receive(0ns)) texts.emplace_back(can::to_text(one->frame).view());
  return texts;
}

/// The same, of frames of either kind.
inline Texts received_any(transport::VirtualBus& bus) {
  Texts texts;
  while (const auto one = bus.receive_any(0ns)) texts.emplace_back(can::to_text(one->frame).view());
  return texts;
}

inline can::AnyFrame any(std::string_view text) {
  const auto parsed = can::parse_any_frame(text);
  REQUIRE(parsed.ok());
  return *parsed;
}

/// A client that says what it likes.
class RawClient {
 public:
  explicit RawClient(const std::string& path) {
    const auto address = host::to_address(path);
    REQUIRE(address);
    socket_ = host::Descriptor{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0)};
    REQUIRE(socket_);
    REQUIRE(::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0);
  }
  void send(const void* bytes, std::size_t size) const {
    ::send(socket_.get(), bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  template <class T>
  void say(const T& content) const {
    const vb::Record record = vb::to_record(content);
    send(record.data(), record.size());
  }
  void greet() const { say(vb::Hello{}); }
  /// All that the server said, record by record; `closed` tells whether it hung up.
  std::vector<vb::Record> heard() {
    std::vector<vb::Record> records;
    std::array<vb::Record, vb::max_records> message{};
    for (;;) {
      const ssize_t size = ::recv(socket_.get(), message.data(), sizeof message, MSG_DONTWAIT);
      if (size < 0 && errno == ECONNRESET) continue;
      closed = size == 0;
      if (size <= 0) return records;
      records.insert(records.end(), message.begin(),
                     message.begin() + size / static_cast<ssize_t>(vb::record_size));
    }
  }
  /// The reason with which the server hung up.
  vb::Goodbye dismissal() {
    const auto records = heard();
    REQUIRE(closed);
    REQUIRE_FALSE(records.empty());
    REQUIRE(vb::type_of(records.back()) == vb::Type::goodbye);
    return vb::from_record<vb::Goodbye>(records.back());
  }
  void close() { socket_.reset(); }
  [[nodiscard]] int descriptor() const { return socket_.get(); }

  bool closed = false;

 private:
  host::Descriptor socket_;
};

struct VirtualBusSetup {
  explicit VirtualBusSetup(simulation::VirtualBusOptions options = {}) {
    options.path = directory.path() + "/sim.sock";
    options.report = [this](std::string_view text) { reports.emplace_back(text); };
    auto opened = simulation::VirtualBusServer::open(std::move(options));
    INFO(opened.error.what);
    REQUIRE(opened);
    server = std::move(opened.value);
    port = server->arbiter().attach({simulation::QueueOrder::fifo, 10'000});
  }

  [[nodiscard]] std::string path() const { return directory.path() + "/sim.sock"; }

  /// Opens a client while the server answers, without any time passing on the bus.
  transport::Outcome<std::unique_ptr<transport::VirtualBus>> try_join() {
    transport::Outcome<std::unique_ptr<transport::VirtualBus>> opened;
    std::atomic<bool> done{false};
    std::thread opener{[&] {
      opened = transport::VirtualBus::open(path());
      done = true;
    }};
    while (!done) {
      pollfd entry{server->descriptor(), POLLIN, 0};
      ::poll(&entry, 1, 1);
      poll();
    }
    opener.join();
    return opened;
  }
  std::unique_ptr<transport::VirtualBus> join() {
    auto opened = try_join();
    INFO(opened.error.what);
    REQUIRE(opened);
    return std::move(opened.value);
  }
  /// Until the server has taken all that clients have said; no time passes.
  void poll() {
    do {
      server->poll(now, [this](const simulation::Delivery& delivery) {
        const can::AnyFrame frame = delivery.fd != nullptr ? *delivery.fd : can::AnyFrame{delivery.frame};
        on_bus.emplace_back(can::to_text(frame).view());
      });
    } while (readable(server->descriptor()));
  }
  /// Until the bus is idle, one frame after the other.
  void run() {
    poll();
    while (server->arbiter().next_event() != base::never) {
      now = server->arbiter().next_event();
      poll();
    }
  }
  /// A frame of a board of the simulator itself.
  void send(std::string_view text) { CHECK(*server->arbiter().send(port, frame(text), now)); }

  TemporaryDirectory directory;
  std::unique_ptr<simulation::VirtualBusServer> server;
  simulation::NodeId port;
  base::Time now{1s};
  Texts on_bus;  ///< every frame, as candump writes it
  Texts reports;
};

}  // namespace ocm::test
