// A board with a host on its serial line, all of it on models of the registers: bxCAN, the USART, and between
// them the node, the bridge and the line's driver as the board's image has them.
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/slcan_bridge.hpp"
#include "ocm/can/slcan_codec.hpp"

#include "firmware/drivers/bxcan_node.hpp"
#include "firmware/drivers/usart.hpp"
#include "sim/parts/usart_model.hpp"
#include "tests/firmware/bxcan/bench.hpp"

namespace ocm::bxcan_tests {

namespace {

namespace usart = firmware::drivers::usart;
namespace slcan = can::slcan;

constexpr auto of_board = bxcan::wide_filter_banks_of<amiro::DiWheelDrive>();
constexpr std::uint32_t gyro_command = 0x208;  // gyroscope
constexpr std::uint32_t gyro_sample = 0x608;
constexpr std::uint32_t foreign_command = 0x21E;  // power status
constexpr std::uint32_t foreign_sample = 0x61E;

/// One context: nothing to lock.
struct NoPort {
  struct Guard {
    ~Guard() {}
  };
  Guard lock() noexcept { return {}; }
};

struct Robot {
  Model can_model;
  sim::UsartModel usart_model;
  bxcan::Node<ModelRegisters> node{ModelRegisters{can_model}};
  usart::Line<sim::UsartModelRegisters> line{sim::UsartModelRegisters{usart_model}};
  slcan::Bridge<> bridge{
      {.hardware = 0x11, .software = 0x10, .serial = {'D', 'I', 'W', 'D'}, .bit_rates = 1U << 6}};
  NoPort port;
  std::int64_t now_us = 0;
  std::vector<can::Frame> board;  ///< what the board has received

  /// As firmware/chibios/stm32/host_line.hpp's.
  struct BusOfHost {
    Robot* robot;
    bool board_has_room(const can::Frame& frame) noexcept { return robot->node.board_has_room(frame); }
    base::Result<bool> send(const can::Frame& frame) noexcept { return robot->node.send_of_host(frame); }
    void deliver(const can::Frame& frame) noexcept { robot->node.deliver(frame); }
    slcan::BusCondition condition() noexcept { return robot->node.condition(); }
    void listen(bool all) noexcept { robot->node.listen(all); }
  };

  Robot() {
    REQUIRE(node.start(timing, of_board).ok());
    for (int i = 0; i < 4; ++i) static_cast<void>(can_model.read(Register::msr));
    node.attach({[](void* self, const can::Frame& frame, base::Time now) noexcept {
                   static_cast<Robot*>(self)->bridge.hear(frame, now);
                 },
                 this});
    line.start(72'000'000, 115'200);
  }
  [[nodiscard]] base::Time now() const { return base::Time{std::chrono::microseconds{now_us}}; }

  // each context
  void can_interrupts() {
    while (can_model.transmit_interrupt()) node.controller().on_transmit();
    if (can_model.receive_interrupt()) node.on_receive(now());
  }
  void overhear_interrupt() {
    if (!can_model.receive_interrupt_of_fifo_1()) return;
    for (std::size_t n = 0; n < bxcan::receive_depth && node.overhear(now()); ++n) {
    }
  }
  void usart_interrupt() {
    if (usart_model.interrupt()) line.on_interrupt([](std::uint8_t) {});
  }
  void receiver() {
    while (const auto frame = node.next()) board.push_back(*frame);
  }
  slcan::Turn turn() {
    BusOfHost bus{this};
    return bridge.turn(line, bus, port);
  }
  /// All contexts, until nothing is left to do; nothing moves on CAN's wire.
  void settle() {
    for (int i = 0; i < 5000; ++i) {
      can_interrupts();
      overhear_interrupt();
      usart_interrupt();
      turn();
      receiver();
      usart_model.shift();
    }
  }
  std::string say(std::string_view text) {
    const std::size_t before = usart_model.sent.size();
    for (const char character : text) {
      usart_model.arrive(static_cast<std::uint8_t>(character));
      usart_interrupt();
      turn();
    }
    settle();
    return usart_model.sent.substr(before);
  }
  void transfer() {
    if (can_model.begin()) can_model.end(End::acknowledged);
    can_interrupts();
  }
  void check() {
    CHECK(can_model.violations.empty());
    CHECK(usart_model.violations.empty());
    CHECK(line.counters().unsent == 0);
  }
};

}  // namespace

TEST_CASE("node: without a host the board hears its own commands, and the line is silent") {
  Robot robot;
  CHECK(robot.can_model.deliver({gyro_command, 1, {1}}));
  CHECK_FALSE(robot.can_model.deliver({foreign_sample, 1, {2}}));
  REQUIRE(*robot.node.send({gyro_sample, 1, {3}}, robot.now()));
  robot.settle();
  robot.transfer();
  CHECK(robot.board == std::vector<can::Frame>{{gyro_command, 1, {1}}});
  CHECK(robot.can_model.transmitted.size() == 1);
  CHECK(robot.usart_model.sent.empty());
  CHECK(robot.bridge.counters() == slcan::BridgeCounters{});
  robot.check();
}

TEST_CASE(
    "node: an open host hears the board, what is for it, and the others; the board hears only its own") {
  Robot robot;
  CHECK(robot.say("S6\rO\r") == "\r\r");
  REQUIRE(*robot.node.send({gyro_sample, 1, {1}}, robot.now()));
  CHECK(robot.say("") == "t608101\r");
  REQUIRE(robot.can_model.deliver({gyro_command, 1, {2}}));
  CHECK(robot.say("") == "t208102\r");
  REQUIRE(robot.can_model.deliver({foreign_sample, 1, {3}}));
  CHECK(robot.say("") == "t61E103\r");
  REQUIRE(robot.can_model.deliver({0x1234'5678, 1, {4}, can::Format::extended}));
  CHECK(robot.say("") == "T12345678104\r");
  CHECK(robot.board == std::vector<can::Frame>{{gyro_command, 1, {2}}});
  CHECK(robot.say("C\r") == "\r");
  CHECK_FALSE(robot.can_model.deliver({foreign_sample, 1, {3}}));
  robot.check();
}

TEST_CASE("node: a frame of the host is on the bus once, and for the board where it is the board's") {
  Robot robot;
  robot.say("S6\rO\r");
  CHECK(robot.say("t208102\r") == "z\r");
  robot.transfer();
  CHECK(robot.say("t21E103\r") == "z\r");
  robot.transfer();
  CHECK(robot.can_model.transmitted ==
        std::vector<can::Frame>{{gyro_command, 1, {2}}, {foreign_command, 1, {3}}});
  CHECK(robot.board == std::vector<can::Frame>{{gyro_command, 1, {2}}});
  CHECK(robot.say("r2081\r") == "\a");
  CHECK(robot.say("T000000011AA\r") == "\a");
  robot.check();
}

TEST_CASE("node: the host's frames never take the board's places") {
  Robot robot;
  robot.say("S6\rO\r");
  for (std::size_t i = 0; i < bxcan::places_of_host; ++i) CHECK(robot.say("t7FF0\r") == "z\r");
  CHECK(robot.say("t7FF0\r") == "\a");  // nothing leaves
  std::size_t taken = 0;
  while (*robot.node.send({0x400, 0, {}}, robot.now())) ++taken;
  CHECK(taken == 24 - bxcan::places_of_host);
  CHECK(robot.bridge.counters().heard == taken);     // and what was refused is not heard
  const std::string answers = robot.say("t0000\r");  // between frames of the board
  CHECK(std::count(answers.begin(), answers.end(), '\a') == 1);
  CHECK(answers.find('z') == std::string::npos);
  CHECK(robot.node.controller().counters().refused == 1);  // the board's own last one
  while (robot.node.controller().waiting() >= bxcan::places_of_host) robot.transfer();
  CHECK(robot.say("t0000\r").find("z\r") != std::string::npos);
  robot.check();
}

TEST_CASE("node: a board that does not keep up refuses the host, and the bus does not get the frame either") {
  Robot robot;
  robot.say("S6\rO\r");
  for (std::size_t i = 0; i < bxcan::received_places; ++i) {
    REQUIRE(robot.can_model.deliver({gyro_command, 1, {static_cast<std::uint8_t>(i)}}));
    robot.can_interrupts();  // and no receiver
  }
  for (const char character : std::string_view{"t208102\r"}) {
    robot.usart_model.arrive(static_cast<std::uint8_t>(character));
    robot.usart_interrupt();
    robot.turn();
  }
  CHECK(robot.bridge.counters().no_room == 1);
  CHECK(robot.node.controller().waiting() == 0);
  robot.settle();
  CHECK(robot.board.size() == bxcan::received_places);
  CHECK(robot.say("F\r") == "F02\r");
  CHECK(robot.node.missed() == 0);
  robot.check();
}

TEST_CASE("node: a board that is alone on its bus is in reach, and says in F what is wrong with the bus") {
  Robot robot;
  robot.say("S6\rO\r");
  std::int64_t ms = 0;
  const auto watch = [&] {
    ms += 10;
    return robot.node.controller().watch(base::Time{std::chrono::milliseconds{ms}});
  };
  REQUIRE(*robot.node.send({gyro_sample, 1, {1}}, robot.now()));
  for (int i = 0; i < 20; ++i) {
    if (robot.can_model.begin()) robot.can_model.end(End::no_acknowledge);
    robot.can_interrupts();
  }
  bool fell = false;
  for (int i = 0; i < 12; ++i) fell |= watch();
  CHECK(fell);
  robot.can_interrupts();
  CHECK(robot.say("") == "t608101\r");
  CHECK(robot.say("F\rF\r") == "FA4\rF24\r");
  CHECK(robot.say("t208102\r") == "z\r");
  CHECK(robot.board == std::vector<can::Frame>{{gyro_command, 1, {2}}});
  REQUIRE(*robot.node.send({gyro_sample, 1, {3}}, robot.now()));
  CHECK(robot.say("") == "t608103\r");
  robot.check();
}

TEST_CASE("node: bus-off is in F, and ends") {
  Robot robot;
  robot.say("S6\rO\r");
  REQUIRE(*robot.node.send({gyro_sample, 1, {1}}, robot.now()));
  for (int i = 0; i < 40; ++i)
    if (robot.can_model.begin()) robot.can_model.end(End::bit_error);
  CHECK(robot.node.controller().watch(base::Time{}));
  robot.can_interrupts();
  CHECK(robot.say("F\rF\r") == "t608101\rFA4\rF24\r");
  robot.can_model.recessive(128);
  robot.node.controller().watch(base::Time{std::chrono::milliseconds{10}});
  CHECK(robot.say("F\r") == "F00\r");
  robot.check();
}

TEST_CASE(
    "node: a storm of other boards takes nothing from the board; what the line cannot carry is counted") {
  Robot robot;
  robot.say("S6\rO\r");
  const std::size_t before = robot.usart_model.sent.size();
  // 10 600 frames/s, the shortest there are, for 0.2 s; a character of the line takes 87 us, so does such a
  // frame.
  unsigned delivered = 0;
  for (int i = 0; i < 2000; ++i) {
    robot.now_us += 94;
    delivered += robot.can_model.deliver({foreign_sample, 0, {}});
    if (i % 20 == 0) REQUIRE(robot.can_model.deliver({gyro_command, 1, {static_cast<std::uint8_t>(i / 20)}}));
    robot.can_interrupts();
    robot.overhear_interrupt();
    if (i % 10 == 0) {
      while (robot.turn() == slcan::Turn::more) {
      }
      robot.receiver();
    }
    robot.usart_model.shift();
    robot.usart_interrupt();
  }
  CHECK(delivered == 2000);
  CHECK(robot.board.size() == 100);
  for (std::size_t i = 0; i < robot.board.size(); ++i) CHECK(robot.board[i].data[0] == i);
  CHECK(robot.node.missed() == 0);
  const auto counters = robot.bridge.counters();
  CHECK(counters.heard == 2100);
  CHECK(counters.lost > 1000);
  const auto sent = robot.usart_model.sent.size() - before;
  CHECK(sent > 1950);  // the line was never idle
  robot.settle();
  const std::string all = robot.usart_model.sent.substr(before);
  const auto lines = static_cast<std::uint32_t>(std::count(all.begin(), all.end(), '\r'));
  CHECK(lines == robot.bridge.counters().written);
  CHECK(robot.bridge.counters().written + counters.lost == counters.heard);
  CHECK(robot.say("F\r") == "F01\r");
  robot.check();
}

TEST_CASE(
    "node: any schedule: each frame of the host is once on the bus or refused, each of the bus heard or "
    "counted") {
  for (unsigned seed = 0; seed < 100; ++seed) {
    CAPTURE(seed);
    std::mt19937 random{seed};
    const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
    Robot robot;
    robot.say("S6\rO\r");
    const std::size_t begin = robot.usart_model.sent.size();
    std::string to_say;
    std::size_t said = 0;
    std::uint16_t serial = 0;
    unsigned own_deliveries = 0;
    unsigned host_frames = 0;
    const auto numbered = [&serial](std::uint32_t id) {
      ++serial;
      return can::Frame{id, 2, {static_cast<std::uint8_t>(serial >> 8), static_cast<std::uint8_t>(serial)}};
    };
    const auto step = [&] {
      switch (below(12)) {
        case 0:
          robot.can_model.deliver(numbered(foreign_sample));
          break;
        case 1:
          if (robot.can_model.deliver(numbered(gyro_command))) ++own_deliveries;
          break;
        case 2:
          static_cast<void>(robot.node.send(numbered(gyro_sample), robot.now()));
          break;
        case 3:
          if (to_say.size() - said > 200) break;
          to_say += slcan::encode(numbered(below(2) == 0 ? gyro_command : foreign_command))->view();
          ++host_frames;
          break;
        case 4:
        case 5:
          if (said == to_say.size()) break;
          robot.usart_model.arrive(static_cast<std::uint8_t>(to_say[said++]));
          robot.usart_interrupt();
          break;
        case 6:
          robot.usart_model.shift();
          break;
        case 7:
          robot.usart_interrupt();
          break;
        case 8:
          robot.turn();
          break;
        case 9:
          if (robot.can_model.begin())
            robot.can_model.end(below(8) == 0 ? End::lost_arbitration : End::acknowledged);
          break;
        case 10:
          robot.can_interrupts();
          break;
        default:
          below(2) == 0 ? robot.overhear_interrupt() : robot.receiver();
      }
    };
    for (int i = 0; i < 20'000; ++i) step();
    // all of it comes to an end
    for (int i = 0; i < 20'000; ++i) {
      if (said < to_say.size() && i % 4 == 0)
        robot.usart_model.arrive(static_cast<std::uint8_t>(to_say[said++]));
      robot.usart_interrupt();
      robot.turn();
      robot.usart_model.shift();
      if (i % 8 == 0) robot.transfer();
      robot.can_interrupts();
      robot.overhear_interrupt();
      robot.receiver();
    }
    const auto bridge = robot.bridge.counters();
    const auto& can = robot.node.controller().counters();
    const std::string text = robot.usart_model.sent.substr(begin);
    const auto lines = [&text](std::string_view head) {
      std::uint32_t count = 0;
      std::size_t at = 0;
      for (std::size_t end; (end = text.find('\r', at)) != std::string::npos; at = end + 1)
        count += std::string_view{text}.substr(at, end - at).find(head) != std::string_view::npos;
      return count;
    };
    // the host
    CHECK(robot.line.lost() == 0);
    CHECK(bridge.from_host + bridge.no_room == host_frames);
    CHECK(lines("z") == bridge.from_host);
    CHECK(static_cast<std::uint32_t>(std::count(text.begin(), text.end(), '\a')) == bridge.no_room);
    CHECK(lines("t") == bridge.written);
    CHECK(bridge.heard == bridge.written + bridge.lost);
    // the bus
    CHECK(can.sent == robot.can_model.transmitted.size());
    CHECK(robot.node.controller().waiting() == 0);
    const auto foreign = static_cast<std::uint32_t>(
        std::count_if(robot.can_model.transmitted.begin(), robot.can_model.transmitted.end(),
                      [](const can::Frame& frame) { return frame.id == foreign_command; }));
    const auto own = static_cast<std::uint32_t>(
        std::count_if(robot.can_model.transmitted.begin(), robot.can_model.transmitted.end(),
                      [](const can::Frame& frame) { return frame.id == gyro_command; }));
    CHECK(foreign + own == bridge.from_host);
    // the board: what the host said to it, and what came over the bus
    CHECK(robot.board.size() == own + can.received - robot.node.missed());
    CHECK(std::none_of(robot.board.begin(), robot.board.end(),
                       [](const can::Frame& frame) { return frame.id != gyro_command; }));
    CHECK(can.received <= own_deliveries);
    robot.check();
  }
}

}  // namespace ocm::bxcan_tests
