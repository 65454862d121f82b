// The transport protocol of J1939 with any frames at any times: every message that is announced has one end,
// and what comes out are the packets that came.
#include <map>
#include <tuple>

#include "ocm/j1939/transport.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

namespace {

using Key = std::tuple<unsigned, unsigned, unsigned>;  // bus, source, destination
struct Latest {
  std::size_t size = 0;
  std::map<unsigned, std::array<std::uint8_t, 7>> packets;  // that came since the announcement, by number
};

/// Mostly frames of the protocol among three addresses; two bytes of the identifier, the length, eight bytes.
struct Step {
  std::uint32_t id;
  std::size_t length;
  std::array<std::uint8_t, 8> data;
  base::Duration later;
  std::uint16_t bus;
};

Step next(fuzz::Input& input) {
  constexpr std::uint8_t addresses[] = {1, 2, 255, 0};
  const std::uint8_t head = input.byte();
  Step step{};
  if (head == 0xFF) {
    step.id = input.number<std::uint32_t>() & 0x1FFF'FFFF;
  } else {
    const std::uint32_t group = (head & 1) != 0 ? j1939::transfer_group : j1939::connection_group;
    step.id = j1939::Identifier{7, group, addresses[head >> 1 & 3], addresses[head >> 3 & 1]}.encode();
  }
  step.bus = head >> 4 & 1;
  const std::uint8_t time = input.byte();
  step.length = time % 64 == 63 ? time >> 6 : 8;
  step.later = std::chrono::milliseconds{(time & 0x40) != 0 ? time * 20 : time};
  const auto data = input.bytes(8);
  std::copy(data.begin(), data.end(), step.data.begin());
  return step;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input{data, size};
  j1939::Transport<2> transport;
  std::map<Key, Latest> latest;
  base::Time now{};
  std::uint32_t messages = 0;
  while (!input.empty()) {
    const Step step = next(input);
    now += step.later;
    const auto from = j1939::Identifier::decode(step.id);
    const Key key{step.bus, from.source, from.destination};
    const bool starts = step.data[0] == (from.destination == j1939::global_address ? 32 : 16);
    if (step.length == 8 && from.pgn == j1939::connection_group && starts && step.data[7] <= 3)
      latest[key] = {static_cast<std::size_t>(step.data[1] | step.data[2] << 8), {}};
    if (step.length == 8 && from.pgn == j1939::transfer_group)
      std::copy_n(step.data.begin() + 1, 7, latest[key].packets[step.data[0]].begin());

    const auto heard = transport.take(step.id, std::span{step.data}.first(step.length), now, step.bus);
    const j1939::TransportCounters& c = transport.counters();
    fuzz::expect(c.announced == c.complete + c.lost_packet + c.wrong_sequence + c.aborted + c.timed_out +
                                    c.replaced + transport.open(),
                 "what is announced has one end");
    fuzz::expect(transport.open() <= 2, "no more sessions than there are");
    fuzz::expect(j1939::is_transport(step.id) || heard == j1939::Heard::nothing,
                 "another group's frame means nothing");
    if (heard != j1939::Heard::message) continue;
    ++messages;
    const auto& message = transport.message();
    const Latest& came = latest[{step.bus, message.id.source, message.id.destination}];
    fuzz::expect(message.data.size() == came.size && came.size >= j1939::least_transported &&
                     came.size <= j1939::most_transported,
                 "a message has the size that was announced");
    for (std::size_t i = 0; i < message.data.size(); ++i) {
      const auto packet = came.packets.find(static_cast<unsigned>(i / 7 + 1));
      fuzz::expect(packet != came.packets.end() && packet->second[i % 7] == message.data[i],
                   "a message is what came last under each number");
    }
  }
  fuzz::expect(messages == transport.counters().complete, "complete messages are counted");
  transport.expire(now + std::chrono::seconds{10});
  fuzz::expect(transport.open() == 0, "all sessions end");
  return 0;
}
