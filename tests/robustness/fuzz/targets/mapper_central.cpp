// What a server types and a radio reports, in any order: there are never more links than the radio has, it
// never scans and connects at once, what waits for a dead link is gone, and it always answers again.
#include "ocm/mapper/link/central.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

namespace {

struct Port {
  int answers = 0;
  bool scans = false;
  void say(std::string_view text) { answers += text.empty() ? 0 : 1; }
  void start_scan() {
    fuzz::expect(!scans, "a scan is started once");
    scans = true;
  }
  void stop_scan() {
    fuzz::expect(scans, "a scan that is stopped runs");
    scans = false;
  }
  void connect(const mapper::link::Address&) { fuzz::expect(!scans, "the radio scans or connects"); }
  void disconnect(const mapper::link::Address&) {}
  void restart() { scans = false; }
};

constexpr std::string_view commands[] = {"start\n",    "list\n",   "stop\n",   "reset\n",
                                         "conn 0\n",   "conn 1\n", "conn 2\n", "switch 0\n",
                                         "switch 1\n", "drop 0\n", "drop 1\n", "*"};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t links = 2;
  mapper::link::Central<3, links, 2> central;
  Port port;
  fuzz::Input input{data, size};
  while (!input.empty()) {
    const std::uint8_t what = input.byte();
    const mapper::link::Address address{0, 0, 0, 0, 0, static_cast<std::uint8_t>(what >> 5)};
    const std::size_t waiting = central.waiting();
    switch (what % 8) {
      case 0:
        central.feed(static_cast<char>(input.byte()), port);
        break;
      case 1:
        for (const char c : commands[input.byte() % std::size(commands)]) central.feed(c, port);
        break;
      case 2:
        for (const char c : std::string_view{"{U,90,130}\n"}) central.feed(c, port);
        fuzz::expect(central.waiting() <= waiting + 2,
                     "a short line is a packet, two with what was typed before");
        break;
      case 3:
        central.found(address, fuzz::text_of(data, size % 30), port);
        break;
      case 4:
        central.connected(address, port);
        break;
      case 5:
        central.closed(address, port);
        fuzz::expect(!central.take(address).ok(), "nothing waits for a dead link");
        break;
      case 6:
        central.heard(address, input.bytes(input.byte() % 32), port);
        break;
      default:
        fuzz::expect(
            central.take(address).ok() ? central.waiting() + 1 == waiting : central.waiting() == waiting,
            "a packet is taken once");
    }
    fuzz::expect(central.links() <= links, "there are no more links than the radio has");
    fuzz::expect(central.waiting() <= 2 * links, "packets wait for links only");
    fuzz::expect(central.scanning() == port.scans, "the central knows whether the radio scans");
  }
  for (const char c : std::string_view{"*\nreset\n"}) central.feed(c, port);
  fuzz::expect(central.links() == 0 && central.waiting() == 0, "after a reset there is nothing");
  port.answers = 0;
  for (const char c : std::string_view{"start\n"}) central.feed(c, port);
  fuzz::expect(port.answers == 1 && central.scanning(), "it always answers again");
  return 0;
}
