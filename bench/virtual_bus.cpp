/// Frames per second of the virtual bus: through sockets in real time, from one client to another, and of the
/// arbiter alone in virtual time. Links ocm and threads.
///
///     virtual_bus [FRAMES]     default 1'000'000 in virtual time, a quarter of it through sockets
#include "ocm/transport/virtual_bus.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <poll.h>
#include <string>
#include <thread>

#include "ocm/simulation/arbiter.hpp"
#include "ocm/simulation/virtual_bus_server.hpp"

namespace {

using namespace ocm;
using SteadyClock = std::chrono::steady_clock;

double seconds_since(SteadyClock::time_point begin) {
  return std::chrono::duration<double>(SteadyClock::now() - begin).count();
}

/// Identifiers and data vary, so that lengths and winners do.
can::Frame make_frame(std::uint32_t i) {
  can::Frame frame{.id = 0x600 + i * 7 % 0x100, .dlc = 8};
  for (std::size_t k = 0; k < 8; ++k)
    frame.data[k] = static_cast<std::uint8_t>(i * 2654435761U >> (k % 4 * 8));
  return frame;
}

/// Five nodes that always have something to send.
double virtual_time(std::uint32_t frames, std::uint64_t& check) {
  simulation::Arbiter bus{500'000};
  std::array<simulation::NodeId, 5> nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    nodes[i] = bus.attach(
        {i < 2 ? simulation::QueueOrder::fifo : simulation::QueueOrder::by_identifier, std::size_t{8}});
  std::uint32_t sent = 0;
  std::uint32_t received = 0;
  const auto begin = SteadyClock::now();
  const auto refill = [&](simulation::NodeId node) {
    if (sent < frames) check += *bus.send(node, make_frame(sent++)) ? 1 : 0;
  };
  for (int i = 0; i < 4; ++i)
    for (const simulation::NodeId node : nodes) refill(node);
  bus.advance(base::never, [&](const simulation::Delivery& delivery) {
    ++received;
    check += delivery.end;
    refill(delivery.from);
  });
  return received / seconds_since(begin);
}

void fail(const transport::Failure& failure) {
  std::fprintf(stderr, "%s\n  %s\n", failure.what.c_str(), failure.remedy.c_str());
  std::exit(1);
}

/// The server with its own clock, as amiroctl sim drives it.
void serve(simulation::VirtualBusServer& server, const std::atomic<bool>& done) {
  const auto begin = SteadyClock::now();
  const auto now = [&] { return base::Time{SteadyClock::now() - begin}; };
  while (!done) {
    server.poll(now());
    const base::Time next = server.next_event();
    if (next <= now()) continue;
    pollfd entry{server.descriptor(), POLLIN, 0};
    const timespec limit{
        0, next == base::never ? 10'000'000 : std::min<long>((next - now()).count(), 10'000'000)};
    ::ppoll(&entry, 1, &limit, nullptr);
  }
}

double through_sockets(const std::string& path, std::uint32_t frames) {
  auto server = simulation::VirtualBusServer::open({.path = path, .bit_rate = 1'000'000'000});
  if (!server) fail(server.error);
  std::atomic<bool> done{false};
  std::thread serving{[&] { serve(**server, done); }};
  auto receiver = transport::VirtualBus::open(path);
  auto sender = transport::VirtualBus::open(path);
  if (!receiver) fail(receiver.error);
  if (!sender) fail(sender.error);

  const auto begin = SteadyClock::now();
  std::thread sending{[&] {
    for (std::uint32_t i = 0; i < frames;) {
      const auto taken = (*sender)->send(make_frame(i));
      if (!taken) fail((*sender)->failure());
      if (*taken) {
        ++i;
        continue;
      }
      pollfd entry{(*sender)->descriptor(), POLLIN, 0};
      ::poll(&entry, 1, 100);
    }
  }};
  std::uint32_t wrong = 0;
  std::uint32_t received = 0;
  while (received + (*receiver)->counters().lost < frames) {
    const auto one = (*receiver)->receive(std::chrono::seconds{5});
    if (!one) break;
    if (one->frame != make_frame(received++)) ++wrong;
  }
  const double seconds = seconds_since(begin);
  sending.join();
  done = true;
  serving.join();
  const auto lost = (*receiver)->counters().lost;
  if (received != frames || wrong != 0 || lost != 0) {
    std::fprintf(stderr, "of %u frames %u came, %u wrong, %lu lost\n", frames, received, wrong,
                 static_cast<unsigned long>(lost));
    std::exit(1);
  }
  return received / seconds;
}

}  // namespace

int main(int argc, char** argv) {
  const auto frames = static_cast<std::uint32_t>(argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 1'000'000);
  if (frames < 4) {
    std::fprintf(stderr, "'%s' is no number of frames: 4 or more\n", argv[1]);
    return 2;
  }
  std::string directory = (std::filesystem::temp_directory_path() / "ocm-bench-XXXXXX").string();
  if (::mkdtemp(directory.data()) == nullptr) {
    std::perror(directory.c_str());
    return 1;
  }
  std::uint64_t check = 0;
  double fastest_virtual = 0;
  double fastest_live = 0;
  for (int i = 0; i < 3; ++i) {
    fastest_virtual = std::max(fastest_virtual, virtual_time(frames, check));
    fastest_live = std::max(fastest_live, through_sockets(directory + "/sim.sock", frames / 4));
  }
  std::filesystem::remove_all(directory);
  std::printf("virtual bus, best of 3 (%u frames; check %lu)\n", frames, static_cast<unsigned long>(check));
  std::printf("  in virtual time, five senders      %8.0f frames/s   goal 1000000\n", fastest_virtual);
  std::printf("  through sockets, client to client  %8.0f frames/s   goal  150000\n", fastest_live);
  return 0;
}
