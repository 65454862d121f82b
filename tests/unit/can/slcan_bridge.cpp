#include "ocm/can/slcan_bridge.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/base/text.hpp"

namespace can_slcan_bridge_test {

namespace base = ocm::base;
namespace slcan = ocm::can::slcan;
using ocm::can::Format;
using ocm::can::Frame;
using slcan::BridgeCounters;
using slcan::Turn;

constexpr base::Time at_ms(std::int64_t ms) {
  return base::Time{std::chrono::milliseconds{ms}};
}

/// The lock, and whether it is held where it must be, and where not.
struct Port {
  struct Guard {
    Port* port;
    explicit Guard(Port& owner) noexcept : port(&owner) {
      port->nested |= port->locked;
      port->locked = true;
    }
    ~Guard() { port->locked = false; }
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;
  };
  bool locked = false;
  bool nested = false;
  Guard lock() noexcept { return Guard{*this}; }
};

/// A bus with so many places, and a board with so many.
struct Bus {
  explicit Bus(Port& of) noexcept : port(&of) {}
  Port* port;
  std::size_t room = 1000;
  std::size_t board_room = 1000;
  bool listening = false;
  slcan::BusCondition state;
  std::vector<Frame> sent;
  std::vector<Frame> delivered;
  bool unlocked = false;

  static bool is_mine(const Frame& frame) { return frame.id < 0x400; }
  void must_be_locked() noexcept { unlocked |= !port->locked; }

  bool board_has_room(const Frame& frame) noexcept {
    must_be_locked();
    return !is_mine(frame) || delivered.size() < board_room;
  }
  base::Result<bool> send(const Frame& frame) noexcept {
    must_be_locked();
    if (frame.format != Format::base) return base::Error::bad_identifier;
    if (sent.size() >= room) return false;
    sent.push_back(frame);
    return true;
  }
  void deliver(const Frame& frame) noexcept {
    must_be_locked();
    if (is_mine(frame)) delivered.push_back(frame);
  }
  slcan::BusCondition condition() noexcept {
    must_be_locked();
    return state;
  }
  void listen(bool open) noexcept { listening = open; }
};

/// A line whose wire takes what the test lets it take.
struct Wire {
  std::string in;
  std::size_t at = 0;
  std::string out;
  std::size_t size = 128;
  std::size_t waiting = 0;  ///< of `out`, not on the wire yet
  std::uint32_t characters_lost = 0;
  bool overfull = false;

  bool read(char& character) noexcept {
    if (at == in.size()) return false;
    character = in[at++];
    return true;
  }
  [[nodiscard]] std::size_t room() const noexcept { return size - waiting; }
  void write(std::string_view text) noexcept {
    overfull |= text.size() > room();
    out += text;
    waiting += text.size();
  }
  [[nodiscard]] std::uint32_t lost() const noexcept { return characters_lost; }
};

template <std::size_t Places = 8>
struct Bench {
  Port port;
  Bus bus{port};
  Wire line;
  slcan::Bridge<Places> bridge{
      {.hardware = 0x11, .software = 0x10, .serial = {'D', 'I', 'W', 'D'}, .bit_rates = 1U << 6}};

  /// Until there is nothing to do; the wire carries all.
  void run() {
    for (unsigned turns = 0; step() == Turn::more || line.waiting > 0; ++turns) {
      line.waiting = 0;
      REQUIRE(turns < 10'000);
    }
  }
  Turn step() { return bridge.turn(line, bus, port); }
  /// All that comes back for a text.
  std::string say(std::string_view text) {
    line.in += text;
    const std::size_t before = line.out.size();
    run();
    return line.out.substr(before);
  }
  void hear(const Frame& frame, std::int64_t ms = 0) {
    const auto guard = port.lock();
    bridge.hear(frame, at_ms(ms));
  }
  void open() { REQUIRE(say("S6\rO\r") == "\r\r"); }
  void check() {
    CHECK_FALSE(port.nested);
    CHECK_FALSE(bus.unlocked);
    CHECK_FALSE(line.overfull);
  }
};

const Frame gyroscope{0x608, 2, {0xAB, 0xCD}};

TEST_CASE("slcan bridge: nothing is said, heard or sent before the host has opened the channel") {
  Bench bench;
  bench.hear(gyroscope);
  CHECK(bench.step() == Turn::done);
  CHECK(bench.say("t10021133\r") == "\a");
  CHECK(bench.say("V\rN\rS5\rS6\r") == "V1110\rNDIWD\r\a\r");
  bench.hear(gyroscope);
  CHECK(bench.say("").empty());
  CHECK_FALSE(bench.bus.listening);
  CHECK(bench.bus.sent.empty());
  CHECK(bench.bridge.counters() == BridgeCounters{});
  bench.check();
}

TEST_CASE("slcan bridge: an open channel has the frames of the bus, in order, with the time when asked for") {
  Bench bench;
  CHECK(bench.say("S6\rZ1\rO\r") == "\r\r\r");
  CHECK(bench.bus.listening);
  bench.hear(gyroscope, 5);
  bench.hear({0x12345, 1, {7}, Format::extended}, 60'001);
  bench.hear({0x7FF, 3, {}, Format::base_remote}, 59'999);
  CHECK(bench.say("") == "t6082ABCD0005\rT000123451070001\rr7FF3EA5F\r");
  CHECK(bench.bridge.counters() == BridgeCounters{.heard = 3, .written = 3});
  CHECK(bench.say("C\r") == "\r");
  CHECK_FALSE(bench.bus.listening);
  bench.hear(gyroscope);
  CHECK(bench.say("").empty());
  bench.check();
}

TEST_CASE("slcan bridge: frames of the host reach the bus and the board, or neither") {
  Bench bench;
  bench.open();
  CHECK(bench.say("t2081AB\r") == "z\r");  // for the board
  CHECK(bench.say("t5001AB\r") == "z\r");  // for another
  CHECK(bench.bus.sent == std::vector<Frame>{{0x208, 1, {0xAB}}, {0x500, 1, {0xAB}}});
  CHECK(bench.bus.delivered == std::vector<Frame>{{0x208, 1, {0xAB}}});
  CHECK(bench.line.out.find('t') == std::string::npos);  // the host does not hear itself

  bench.bus.board_room = 1;
  CHECK(bench.say("t2081AC\r") == "\a");
  CHECK(bench.say("t5001AC\r") == "z\r");
  CHECK(bench.bus.sent.size() == 3);
  CHECK(bench.say("F\rF\r") == "F02\rF00\r");

  bench.bus.board_room = 1000;
  bench.bus.room = 3;
  CHECK(bench.say("t2081AD\r") == "\a");
  CHECK(bench.bus.delivered.size() == 1);
  bench.bus.room = 4;
  CHECK(bench.say("t2081AD\r") == "z\r");
  CHECK(bench.bus.delivered.back() == Frame{0x208, 1, {0xAD}});

  CHECK(bench.say("T000000011AA\r") == "\a");  // the board's controller sends base frames only
  CHECK(bench.bridge.counters() == BridgeCounters{.from_host = 4, .no_room = 2, .impossible = 1});
  bench.check();
}

TEST_CASE("slcan bridge: a host that listens only sends nothing") {
  Bench bench;
  CHECK(bench.say("S6\rL\r") == "\r\r");
  CHECK(bench.bus.listening);
  CHECK(bench.say("t2081AB\r") == "\a");
  CHECK(bench.bus.sent.empty());
  bench.hear(gyroscope);
  CHECK(bench.say("") == "t6082ABCD\r");
  bench.check();
}

TEST_CASE("slcan bridge: a storm loses what is newest, counted, and the host learns of it once") {
  Bench<8> bench;
  bench.open();
  for (std::uint8_t i = 0; i < 20; ++i) bench.hear({0x600, 1, {i}});
  std::string expected;
  for (int i = 0; i < 8; ++i) expected += "t6001" + std::string{"0"} + std::to_string(i) + "\r";
  CHECK(bench.say("") == expected);
  CHECK(bench.bridge.counters() == BridgeCounters{.heard = 20, .written = 8, .lost = 12});
  CHECK(bench.say("F\rF\r") == "F01\rF00\r");
  bench.hear({0x600, 1, {0x77}});
  CHECK(bench.say("") == "t600177\r");
  CHECK(bench.say("F\r") == "F00\r");
  bench.check();
}

TEST_CASE("slcan bridge: a full line delays frames and loses none, and answers come before them") {
  Bench<32> bench;
  REQUIRE(bench.say("S6\rZ1\rO\r") == "\r\r\r");
  for (std::uint8_t i = 0; i < 20; ++i) bench.hear({0x600, 8, {i}, Format::extended});  // the longest lines
  // Nothing leaves the wire: as many lines as it takes, and room for an answer.
  while (bench.step() == Turn::more) {
  }
  const std::size_t stuck = bench.line.out.size();
  CHECK(bench.step() == Turn::done);
  CHECK(bench.line.out.size() == stuck);
  CHECK(bench.line.room() >= slcan::Bridge<>::room_for_answer);
  bench.line.in += "V\r";
  bench.step();
  CHECK(bench.line.out.substr(stuck) == "V1110\r");
  bench.line.in += "V\rV\rV\rV\rV\rV\r";
  while (bench.step() == Turn::more) {
  }
  CHECK(bench.line.at < bench.line.in.size());  // the host's words wait, too
  bench.run();
  CHECK(std::count(bench.line.out.begin(), bench.line.out.end(), 'T') == 20);
  CHECK(std::count(bench.line.out.begin(), bench.line.out.end(), 'V') == 7);
  CHECK(bench.bridge.counters().lost == 0);
  bench.check();
}

TEST_CASE("slcan bridge: a turn is bounded in both directions") {
  Bench<32> bench;
  bench.open();
  bench.line.size = 100'000;
  bench.line.in += std::string(1000, '\r');
  for (int i = 0; i < 32; ++i) bench.hear(gyroscope);
  const std::size_t at = bench.line.at;
  const std::size_t before = bench.line.out.size();
  CHECK(bench.step() == Turn::more);
  CHECK(bench.line.at - at == slcan::Bridge<>::characters_a_turn);
  const std::string out = bench.line.out.substr(before);
  CHECK(std::count(out.begin(), out.end(), 't') == slcan::Bridge<>::frames_a_turn);
  bench.check();
}

TEST_CASE("slcan bridge: there is more while the host talks on, and while frames wait") {
  Bench<32> frames;
  frames.open();
  frames.line.size = 100'000;
  for (int i = 0; i < 8; ++i) frames.hear(gyroscope);
  CHECK(frames.step() == Turn::more);
  CHECK(frames.bridge.counters().written == 4);
  Bench<32> words;
  words.open();
  words.line.size = 100'000;
  words.line.in += std::string(40, '\r');
  const std::size_t at = words.line.at;
  CHECK(words.step() == Turn::more);
  CHECK(words.line.at - at == 31);  // the longest line, and its CR
  CHECK(words.step() == Turn::done);
  CHECK(words.line.at == words.line.in.size());
}

TEST_CASE("slcan bridge: an answer takes 8 characters of room, a frame those and 31") {
  Bench bench;
  bench.open();
  bench.hear(gyroscope);
  bench.line.waiting = bench.line.size - 38;
  CHECK(bench.step() == Turn::done);
  CHECK(bench.bridge.counters().written == 0);
  bench.line.waiting = bench.line.size - 39;
  CHECK(bench.step() == Turn::done);
  CHECK(bench.bridge.counters().written == 1);
  const std::size_t before = bench.line.out.size();
  bench.line.in += "V\r";
  bench.line.waiting = bench.line.size - 7;
  CHECK(bench.step() == Turn::done);
  CHECK(bench.line.at + 2 == bench.line.in.size());
  bench.line.waiting = bench.line.size - 8;
  CHECK(bench.step() == Turn::done);
  CHECK(bench.line.out.substr(before) == "V1110\r");
  bench.check();
}

TEST_CASE("slcan bridge: 64 frames wait unless told") {
  Port port;
  Bus bus{port};
  Wire line;
  slcan::Bridge<> bridge;
  line.in = "S6\rO\r";
  CHECK(bridge.turn(line, bus, port) == Turn::done);
  for (int i = 0; i < 65; ++i) {
    const auto guard = port.lock();
    bridge.hear(gyroscope, at_ms(0));
  }
  CHECK(bridge.counters() == BridgeCounters{.heard = 65, .lost = 1});
}

TEST_CASE("slcan bridge: the bus's states stay in F, what happened is said once") {
  Bench bench;
  bench.bus.state = {.states = 0, .faults = 3, .lost = 2};  // before the host came
  bench.line.characters_lost = 5;
  bench.open();
  CHECK(bench.say("F\r") == "F00\r");
  bench.bus.state.states = slcan::status::warning;
  CHECK(bench.say("F\rF\r") == "F04\rF04\r");
  bench.bus.state = {
      .states = slcan::status::warning | slcan::status::passive, .faults = 4, .lost = 2};  // bus-off
  CHECK(bench.say("F\rF\r") == "FA4\rF24\r");
  CHECK(bench.say("t2081AB\r") == "z\r");  // the board is in reach all the same
  CHECK(bench.bus.delivered.size() == 1);
  bench.hear(gyroscope);
  CHECK(bench.say("") == "t6082ABCD\r");
  bench.bus.state = {.states = 0, .faults = 4, .lost = 3};
  CHECK(bench.say("F\rF\r") == "F08\rF00\r");
  bench.line.characters_lost = 6;
  CHECK(bench.say("F\rF\r") == "F08\rF00\r");
  CHECK(bench.say("C\rO\rF\r") == "\r\rF00\r");
  bench.check();
}

TEST_CASE("slcan bridge: what waits when the host closes is for no other host") {
  Bench bench;
  bench.open();
  for (int i = 0; i < 3; ++i) bench.hear(gyroscope);
  CHECK(bench.say("C\r") == "\r");  // read first, so nothing of it is written
  CHECK(bench.bridge.counters() == BridgeCounters{.heard = 3, .left = 3});
  CHECK(bench.say("O\r") == "\r");
  bench.hear({0x600, 0, {}});
  CHECK(bench.say("") == "t6000\r");
  bench.check();
}

TEST_CASE("slcan bridge: a host that begins in the state that another one left is served") {
  for (const std::string_view before : {"", "S6\rO\r", "S6\rL\r", "S6\rO\rt10", "S6\rZ1\rO\r\x02\xFF"}) {
    Bench bench;
    bench.say(before);
    const std::string answers = bench.say("\rC\rV\rS6\rZ0\rO\r");
    CAPTURE(before, answers);
    CHECK(answers.substr(answers.size() - 9) == "V1110\r\r\r\r");
    bench.hear(gyroscope);
    CHECK(bench.say("") == "t6082ABCD\r");
  }
}

TEST_CASE("slcan bridge: garbage is refused, and never a frame") {
  Bench bench;
  bench.open();
  for (const std::string_view garbage : {"t2081A\r", "t2089\r", "\x02\xFF",
                                         "t208\x01"
                                         "1AB\r",
                                         "t2081ABt2081AB\r", "T208\r", "%\r"})
    bench.say(garbage);
  CHECK(bench.bus.sent.empty());
  CHECK(bench.bus.delivered.empty());
  CHECK(bench.bridge.adapter().faults().total() >= 5);
  CHECK(bench.say("t2081AB\r") == "z\r");
  bench.check();
}

TEST_CASE("slcan bridge: the host's filter is applied, and what it refuses is no loss") {
  Bench bench;
  CHECK(bench.say("S6\rMC100C100\rm001F001F\rO\r") == "\r\r\r\r");  // 608 alone
  bench.hear({0x609, 0, {}});
  bench.hear(gyroscope);
  CHECK(bench.say("F\r") == "F00\rt6082ABCD\r");
  CHECK(bench.bridge.counters() == BridgeCounters{.heard = 2, .written = 1, .filtered = 1});
  bench.check();
}

TEST_CASE(
    "slcan bridge: any schedule: every frame is written, counted or left, in order; every command answered") {
  std::uint32_t state = 1;
  const auto below = [&state](std::uint32_t n) {
    state = state * 1'664'525 + 1'013'904'223;
    return (state >> 16) % n;
  };
  for (unsigned seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    state = seed;
    Bench<8> bench;
    bench.say("S6\r");
    bench.line.out.clear();
    std::uint16_t heard = 0;
    std::uint16_t said = 0;
    unsigned commands = 0;
    for (unsigned step = 0; step < 1500; ++step) {
      switch (below(8)) {
        case 0:
        case 1: {  // a burst on the bus
          for (std::uint32_t n = below(6); n > 0; --n, ++heard)
            bench.hear({0x600, 2, {static_cast<std::uint8_t>(heard >> 8), static_cast<std::uint8_t>(heard)}});
          break;
        }
        case 2: {
          Frame frame{below(2) == 0 ? 0x208U : 0x500U, 2, {}};
          frame.data = {static_cast<std::uint8_t>(said >> 8), static_cast<std::uint8_t>(said)};
          ++said;
          bench.line.in += slcan::encode(frame)->view();
          ++commands;
          break;
        }
        case 3: {
          constexpr std::string_view words[]{"F\r", "V\r", "O\r", "C\r", "?\r", "t2\r"};
          bench.line.in += words[below(6)];
          ++commands;
          break;
        }
        case 4:
          bench.bus.room = bench.bus.sent.size() + below(3);
          bench.bus.board_room = bench.bus.delivered.size() + below(3);
          break;
        case 5:
          bench.line.waiting -= std::min<std::size_t>(bench.line.waiting, below(60));
          break;
        default:
          bench.step();
      }
    }
    bench.run();
    // What came over the line, read as a host does.
    unsigned answers = 0;
    unsigned frames = 0;
    int last = -1;
    bool in_order = true;
    std::string text;
    for (const char character : bench.line.out) {
      if (character == '\a') {
        CHECK(text.empty());
        ++answers;
      } else if (character != '\r') {
        text += character;
      } else {
        if (text.starts_with("t6002")) {
          const int number = static_cast<int>(*base::parse_unsigned(std::string_view{text}.substr(5), 16));
          in_order = in_order && number > last;
          last = number;
          ++frames;
        } else {
          CHECK(text.size() <= 5);
          ++answers;
        }
        text.clear();
      }
    }
    CHECK(in_order);
    CHECK(answers == commands);
    const BridgeCounters counters = bench.bridge.counters();
    CHECK(counters.written == frames);
    CHECK(counters.heard == counters.written + counters.lost + counters.left);
    CHECK(counters.heard <= heard);
    CHECK(counters.from_host == bench.bus.sent.size());
    CHECK(counters.from_host + counters.no_room <= said);
    std::vector<Frame> mine;
    std::copy_if(bench.bus.sent.begin(), bench.bus.sent.end(), std::back_inserter(mine), Bus::is_mine);
    CHECK(mine == bench.bus.delivered);
    bench.check();
  }
}

}  // namespace can_slcan_bridge_test
