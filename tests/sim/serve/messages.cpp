// Plain messages beside the user: what each node sent, what a bus did not take, and what is said of what is
// not played.
#include "sim/serve/messages.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/simulation/arbiter.hpp"
#include "ocm/topics/amiro.hpp"
#include "ocm/transport/bus.hpp"

#include "sim/serve/amiro.hpp"

namespace sim_serve_messages_test {

using namespace ocm;
using namespace std::chrono_literals;
using sim::Ending;
using Clock = std::chrono::steady_clock;
using Lines = std::vector<std::string>;

protocol::FrameLayout frame_of(std::uint32_t id, std::uint16_t length = 8, bool fd = false) {
  protocol::FrameLayout layout;
  layout.length = length;
  layout.fd = fd;
  layout.address = {protocol::Address::By::identifier, false, id};
  return layout;
}

/// Of the board with this number; `cycle` 0: it states no period. The layout must outlive it.
protocol::Topic message_of(std::string_view name, const protocol::FrameLayout& layout, base::Duration cycle,
                           std::uint8_t board = protocol::no_board) {
  protocol::Topic topic;
  topic.name = name;
  topic.kind = protocol::Kind::message;
  topic.board = board;
  topic.frames = {&layout, 1};
  topic.cycle = cycle;
  return topic;
}

sim::Shell reporting_to(Lines& said) {
  return {[] { return true; }, [&said](std::string_view text) { said.emplace_back(text); }};
}

TEST_CASE(
    "Each node has room for two of each of its messages; what it sent and what found no room is counted, and "
    "a node without messages is not named") {
  constexpr protocol::Board boards[] = {{"Engine", ""}, {"Idle", ""}, {"Doors", ""}};
  const auto speed = frame_of(0x100), left = frame_of(0x200), right = frame_of(0x201),
             other = frame_of(0x300);
  const std::vector<protocol::Topic> topics{
      message_of("Speed", speed, 100ms, 0), message_of("Left", left, 500ms, 2),
      message_of("Right", right, 500ms, 2), message_of("Other", other, 250ms)};
  const protocol::Catalogue catalogue{"car", 500'000, boards, topics};
  simulation::Arbiter wire{500'000};
  sim::MessageNodes nodes{catalogue, {}, wire};
  CHECK(nodes.player().size() == 4);
  CHECK(nodes.next_event() < base::Time{100ms});
  // 10, 2, 2 and 4 of them are due before a second is over; the wire takes none.
  nodes.advance(base::Time{1s - 1ns});
  Lines said;
  nodes.summarise(reporting_to(said));
  CHECK(said == Lines{"Engine            sent 2, 8 found the bus full", "Doors             sent 4",
                      "unknown sender    sent 2, 2 found the bus full"});
  std::vector<std::uint32_t> sent;
  wire.advance(base::Time{2s},
               [&sent](const simulation::Delivery& delivery) { sent.push_back(delivery.frame.id); });
  for (const auto& [id, count] : {std::pair{0x100U, 2}, {0x200U, 2}, {0x201U, 2}, {0x300U, 2}})
    CHECK(std::count(sent.begin(), sent.end(), id) == count);
}

TEST_CASE("What is not played is said by name, a line for each reason") {
  const auto classic = frame_of(0x100), longer = frame_of(0x101, 9), fd = frame_of(0x102, 12, true);
  const std::vector<protocol::Topic> topics{
      message_of("Plain", classic, 1s),  message_of("Off", classic, 1s, 1), message_of("Rare", classic, 0s),
      message_of("Seldom", classic, 0s), message_of("Wide", fd, 1s),        message_of("Long", longer, 1s),
      message_of("Longer", longer, 1s)};
  const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
  const host::Failure no_fd{"can9 carries no CAN FD frames", "use the simulated bus"};
  Lines said;
  sim::report_left_out(sim::MessagePlayer{catalogue, {.fd = false, .without = {1}}}, reporting_to(said),
                       no_fd);
  CHECK(said ==
        Lines{"not sent, since switched off: Off",
              "not sent, since the spec states no period: Rare, Seldom (--sporadic 1s sends them too)",
              "not sent, since can9 carries no CAN FD frames: Wide; use the simulated bus",
              "not sent, since no frame holds them: Long, Longer"});
  said.clear();
  const protocol::Catalogue all{"car", 500'000, {}, std::span{topics}.first(1)};
  sim::report_left_out(sim::MessagePlayer{all}, reporting_to(said), no_fd);
  CHECK(said.empty());
}

TEST_CASE("Where nothing can be played, the reason that helps most is said") {
  const auto classic = frame_of(0x100), longer = frame_of(0x101, 9), fd = frame_of(0x102, 12, true);
  const auto plain = message_of("Plain", classic, 1s), off = message_of("Off", classic, 1s, 1),
             rare = message_of("Rare", classic, 0s), wide = message_of("Wide", fd, 1s),
             too_long = message_of("Long", longer, 1s);
  const host::Failure no_fd{"can9 carries no CAN FD frames", "use the simulated bus"};
  const auto ending = [&no_fd](const std::vector<protocol::Topic>& topics, std::string_view robot = "car") {
    const protocol::Catalogue catalogue{robot, 500'000, {}, topics};
    return sim::nothing_to_play(sim::MessagePlayer{catalogue, {.fd = false, .without = {1}}}, catalogue,
                                no_fd);
  };
  CHECK(ending({plain, off, rare, wide, too_long}).well());
  struct Row {
    std::vector<protocol::Topic> topics;
    const char* what;
    const char* remedy;
    bool misuse;
  };
  for (const Row& row :
       {Row{{}, "sim: 'car' has no message", "give a spec with messages", true},
        Row{{wide, off, rare},
            "sim: no message of 'car' can be sent: can9 carries no CAN FD frames",
            "use the simulated bus",
            false},
        Row{{off, too_long}, "sim: no message of 'car' is left to send", "switch fewer nodes off", true},
        Row{{too_long},
            "sim: no message of 'car' fits into a frame",
            "give a spec with messages of at most 8 bytes, or 64 in CAN FD",
            true},
        Row{{off, rare, too_long},
            "sim: no message of 'car' has a period that could be played",
            "add --sporadic 1s to send all about once a second, or state periods (DBC: GenMsgCycleTime)",
            true}}) {
    CAPTURE(row.what);
    const Ending end = ending(row.topics);
    REQUIRE(end.failures.size() == 1);
    CHECK(end.failures[0].what == row.what);
    CHECK(end.failures[0].remedy == row.remedy);
    CHECK(end.misuse == row.misuse);
  }
  REQUIRE(ending({rare}, "").failures.size() == 1);
  CHECK(ending({rare}, "").failures[0].what == "sim: no message of 'bus' has a period that could be played");
}

/// A CAN interface that answers what a test says, and on which no other node sends but what `coming` has.
class Interface final : public transport::Bus {
 public:
  std::string_view name() const override { return "can9"; }
  base::Result<bool> send(const can::Frame& frame) override {
    ++asked;
    if (answer.ok() && *answer) sent.push_back(frame);
    return answer;
  }
  base::Result<can::Received> receive(base::Duration) override {
    if (gone) return base::Error::closed;
    if (coming.empty()) return base::Error::timed_out;
    can::Received received;
    received.frame = coming.back();
    coming.pop_back();
    return received;
  }
  transport::Outcome<void> subscribe(std::span<const can::Filter>) override { return {}; }
  int descriptor() const override { return -1; }
  const transport::BusCounters& counters() const override { return counters_; }
  transport::BusState state() const override {
    return gone ? transport::BusState::closed : transport::BusState::up;
  }
  const transport::Failure& failure() const override { return failed; }

  base::Result<bool> answer{true};
  bool gone = false;
  transport::Failure failed{"can9 is gone", "plug it in"};
  std::vector<can::Frame> sent, coming;
  int asked = 0;

 private:
  transport::BusCounters counters_{};
};

TEST_CASE("Messages on a CAN interface say first which of them are not sent") {
  const auto classic = frame_of(0x100), fd = frame_of(0x102, 12, true);
  const std::vector<protocol::Topic> topics{message_of("Plain", classic, 1h), message_of("Rare", classic, 0s),
                                            message_of("Wide", fd, 1h)};
  const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
  Interface bus;
  Lines said;
  CHECK(sim::serve_messages(bus, catalogue, {}, reporting_to(said)).well());
  CHECK(said ==
        Lines{"not sent, since the spec states no period: Rare (--sporadic 1s sends them too)",
              "not sent, since 'can9' carries no CAN FD frames: Wide; use a CAN interface in FD mode, "
              "or the simulated bus",
              "simulated 1 message of car on can9; Ctrl-C ends it",
              "bus               0 frames sent, 0 dropped: the bus was full"});
}

TEST_CASE("What finds a CAN interface full waits, a thousand frames at most, and is tried each millisecond") {
  const auto layout = frame_of(0x100);
  const std::vector<protocol::Topic> topics{message_of("M", layout, 10us)};
  const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
  Interface bus;
  bus.answer = false;
  int turns = 0;
  Clock::time_point begin, end;
  Lines said;
  sim::Shell shell = reporting_to(said);
  shell.stop = [&] {
    ++turns;
    if (turns == 2) begin = Clock::now();  // before the first turn nothing waits
    if (turns == 102) {
      end = Clock::now();
      bus.answer = true;
    }
    return turns == 103;
  };
  CHECK(sim::serve_messages(bus, catalogue, {}, shell).well());
  CHECK(end - begin >= 90ms);
  CHECK(bus.sent.size() == 1000);
  REQUIRE(said.size() >= 2);
  CHECK(said[0] == "simulated 1 message of car on can9; Ctrl-C ends it");
  const std::string beginning = "bus               1000 frames sent, ";
  const auto line = std::find_if(said.begin(), said.end(),
                                 [&](const std::string& text) { return text.starts_with(beginning); });
  REQUIRE(line != said.end());
  CHECK(line->ends_with(" dropped: the bus was full"));
  CHECK_FALSE(line->starts_with(beginning + "0 dropped"));
}

TEST_CASE("Boards of an AMiRo that find a CAN interface full try again each millisecond") {
  Interface bus;
  bus.answer = false;
  // The gyroscope is asked for a sample every 20 ms.
  bus.coming.push_back({0x200U + amiro::Gyroscope::id.value, 4, {0x01, 20}});
  const auto give_up = Clock::now() + 20s;
  int turns = 0;  // since the first frame was refused
  Clock::time_point begin, end;
  Lines said;
  sim::Shell shell = reporting_to(said);
  shell.stop = [&] {
    if (bus.asked == 0) return Clock::now() > give_up;
    ++turns;
    if (turns == 1) begin = Clock::now();
    if (turns == 101) end = Clock::now();
    return turns == 101;
  };
  CHECK(sim::serve_amiro(bus, {}, shell).well());
  REQUIRE(turns == 101);
  CHECK(end - begin >= 90ms);
  CHECK(bus.sent.empty());
}

TEST_CASE("Boards of an AMiRo on a CAN interface hear no error frames, and end when it is gone") {
  Lines said;
  sim::Shell shell = reporting_to(said);
  {
    Interface bus;
    bus.answer = false;
    bus.coming.push_back({0x4, 8, {}, can::Format::error});
    int turns = 0;
    shell.stop = [&turns] { return turns++ == 3; };
    CHECK(sim::serve_amiro(bus, {}, shell).well());
    CHECK(bus.coming.empty());
    CHECK(said == Lines{"di_wheel_drive    nothing came", "power_management  nothing came",
                        "light_ring        nothing came"});
  }
  Interface bus;
  bus.gone = true;
  const auto give_up = Clock::now() + 20s;
  shell.stop = [&give_up] { return Clock::now() > give_up; };
  const Ending ending = sim::serve_amiro(bus, {}, shell);
  REQUIRE(ending.failures.size() == 1);
  CHECK(ending.failures[0] == bus.failed);
  CHECK_FALSE(ending.misuse);
}

TEST_CASE("What still waits for a CAN interface in the end is counted with what was dropped") {
  const auto layout = frame_of(0x100);
  const std::vector<protocol::Topic> topics{message_of("M", layout, 1ms)};
  const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
  Interface bus;
  bus.answer = false;
  const auto give_up = Clock::now() + 20s;
  Lines said;
  sim::Shell shell = reporting_to(said);
  shell.stop = [&] { return bus.asked >= 3 || Clock::now() > give_up; };
  CHECK(sim::serve_messages(bus, catalogue, {}, shell).well());
  const std::string beginning = "bus               0 frames sent, ";
  const auto line = std::find_if(said.begin(), said.end(),
                                 [&](const std::string& text) { return text.starts_with(beginning); });
  REQUIRE(line != said.end());
  const auto dropped = std::stoull(line->substr(beginning.size()));
  CHECK(dropped >= 1U);
  CHECK(dropped <= 30'000U);  // one each millisecond
}

TEST_CASE("What a CAN interface refuses for good is counted, and one that is gone ends the simulation") {
  const auto layout = frame_of(0x100);
  const std::vector<protocol::Topic> topics{message_of("M", layout, 1ms)};
  const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
  const auto give_up = Clock::now() + 20s;
  Lines said;
  sim::Shell shell = reporting_to(said);
  {
    Interface bus;
    bus.answer = base::Error::bad_length;
    shell.stop = [&] { return bus.asked >= 3 || Clock::now() > give_up; };
    CHECK(sim::serve_messages(bus, catalogue, {}, shell).well());
    CHECK(std::count(said.begin(), said.end(),
                     "bus               0 frames sent, " + std::to_string(bus.asked) +
                         " dropped: the bus was full") == 1);
  }
  shell.stop = [&] { return Clock::now() > give_up; };
  for (const bool seen_by_sending : {true, false}) {
    CAPTURE(seen_by_sending);
    Interface bus;
    if (seen_by_sending)
      bus.answer = base::Error::closed;
    else
      bus.gone = true;
    const Ending ending = sim::serve_messages(bus, catalogue, {}, shell);
    REQUIRE(ending.failures.size() == 1);
    CHECK(ending.failures[0] == bus.failed);
    CHECK_FALSE(ending.misuse);
  }
}

}  // namespace sim_serve_messages_test
