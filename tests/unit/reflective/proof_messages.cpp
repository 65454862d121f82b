/// What a proof counts: all messages of a configuration, of the start and of a change, by hand.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/reflective/check.hpp"
#include "ocm/reflective/proof.hpp"

namespace reflective_proof_messages_test {

using namespace ocm;
using namespace ocm::reflective;
using namespace std::chrono_literals;
using protocol::Priority;

// At 1 Mbit/s, with the closed bounds for lengths and intermission: 1 byte 65 us, 2 75, 8 135; of an extended
// identifier 4 bytes 120; a stop 65, a request of 4 bytes 95.
constexpr std::uint32_t bit_rate = 1'000'000;

constexpr protocol::FrameLayout frame(std::uint8_t id, std::uint16_t length) {
  protocol::FrameLayout result;
  result.id = protocol::TopicId{id};
  result.length = length;
  return result;
}
constexpr protocol::FrameLayout extended() {
  protocol::FrameLayout result = frame(0, 4);
  result.address = {protocol::Address::By::identifier, true, 0x18FF'0001};
  return result;
}
constexpr protocol::FrameLayout two_frames[] = {frame(0x11, 1), frame(0x12, 8)};
constexpr protocol::FrameLayout one_frame[] = {frame(0x21, 2)};
constexpr protocol::FrameLayout news_frames[] = {extended()};
constexpr protocol::FrameLayout motor_frames[] = {frame(0x31, 1)};
constexpr protocol::FrameLayout refusal_frames[] = {frame(0x41, 1)};
constexpr protocol::FrameLayout other_frames[] = {frame(0x42, 1)};
enum : std::uint16_t { two, one, news, motor, refusal, other_refusal };

constexpr protocol::Topic topic(protocol::Kind kind, std::span<const protocol::FrameLayout> frames,
                                protocol::Role role = protocol::Role::none, std::uint8_t board = 0) {
  protocol::Topic result;
  result.id = frames[0].id;
  result.kind = kind;
  result.frames = frames;
  result.role = role;
  result.board = board;
  result.priority = Priority::high;
  return result;
}

struct Robot {
  std::vector<protocol::Topic> topics{
      topic(protocol::Kind::sensor, two_frames),
      topic(protocol::Kind::sensor, one_frame),
      topic(protocol::Kind::message, news_frames),
      topic(protocol::Kind::actuator, motor_frames),
      topic(protocol::Kind::sensor, refusal_frames, protocol::Role::refusal),
      topic(protocol::Kind::sensor, other_frames, protocol::Role::refusal, 1),
  };
  protocol::Catalogue catalogue{"robot", bit_rate, {}, {}};
  std::vector<Stream> streams{{two, 20ms, Priority::high}, {one, 50ms, Priority::low}, {news, 100ms}};
  std::vector<Adaptation> adaptations{
      {.stream = 1, .topic = two, .to = 1, .at_from = 60ms, .at_to = 40ms, .every = 300ms}};
  std::vector<SetPoint> repeated{{motor, {}, Priority::urgent, 100ms}};
  std::vector<SetPoint> once{{motor, {}, Priority::medium}};
  std::vector<Stream> others_streams{{two, 30ms, Priority::high}, {one, 50ms, Priority::low}};
  std::vector<Stream> another_priority{{two, 30ms, Priority::low}};
  std::vector<Configuration> configurations{{"all", streams, {}, repeated, adaptations},
                                            {"slow", others_streams, {}, once, {}},
                                            {"low", another_priority, {}, {}, {}},
                                            {"none", {}, {}, {}, {}}};
  Operator op;

  Robot() {
    topics[two].jitter = 2ms;
    topics[two].deadline = 15ms;
    topics[refusal].priority = Priority::urgent;
    catalogue.topics = topics;
    op.catalogue = &catalogue;
    op.configurations = configurations;
    op.settle = 30ms;
    op.reaction = 1ms;
    op.handling = 3ms;
    op.retry = 500ms;
  }
};

/// In the order of arbitration: identifier, us on the bus, ms between two, ms until the deadline, ms late.
std::vector<std::string> lines(std::span<const analysis::Message> messages) {
  std::vector<std::string> all;
  for (const analysis::Message& m : messages) {
    char line[96];
    char deadline[24] = "-";
    if (m.due() != analysis::unbounded)
      std::snprintf(deadline, sizeof deadline, "%g", static_cast<double>(m.due()) / 1e6);
    std::snprintf(line, sizeof line, "%03X %lld us, every %g, due %s, jitter %g",
                  static_cast<unsigned>(m.key >> 21U), static_cast<long long>(m.cost / 1000),
                  static_cast<double>(m.period) / 1e6, deadline, static_cast<double>(m.jitter) / 1e6);
    all.emplace_back(line);
  }
  return all;
}
using Lines = std::vector<std::string>;

TEST_CASE("proof messages: of configurations, of the start and of changes") {
  Robot robot;
  Proof<64> proof{robot.op, bit_rate};
  // A configuration: what it may ask for again, refusals of that, and each stream with grids that begin
  // again.
  static_cast<void>(proof.load(0));
  CHECK(lines(proof.messages()) ==
        Lines{"031 65 us, every 100, due -, jitter 1", "111 95 us, every 500, due -, jitter 1",
              "321 95 us, every 500, due -, jitter 1", "321 95 us, every 300, due -, jitter 1",
              "441 65 us, every 500, due -, jitter 30", "441 65 us, every 500, due -, jitter 30",
              "441 65 us, every 300, due -, jitter 30", "441 65 us, every 100, due -, jitter 30",
              "511 65 us, every 500, due -, jitter 30", "511 65 us, every 20, due 15, jitter 2",
              "512 135 us, every 500, due -, jitter 30", "512 135 us, every 20, due 15, jitter 2",
              "63F 120 us, every 100, due 100, jitter 0", "721 75 us, every 300, due -, jitter 30",
              "721 75 us, every 40, due 40, jitter 0"});
  // The start: its set points and requests as well.
  static_cast<void>(proof.load(none, 0));
  CHECK(lines(proof.messages()) ==
        Lines{"031 65 us, every 100, due -, jitter 1",    "031 65 us, every 30, due -, jitter 1",
              "111 95 us, every 500, due -, jitter 1",    "111 95 us, every 30, due -, jitter 1",
              "321 95 us, every 500, due -, jitter 1",    "321 95 us, every 300, due -, jitter 1",
              "321 95 us, every 30, due -, jitter 1",     "441 65 us, every 500, due -, jitter 30",
              "441 65 us, every 500, due -, jitter 30",   "441 65 us, every 300, due -, jitter 30",
              "441 65 us, every 100, due -, jitter 30",   "441 65 us, every 30, due -, jitter 30",
              "441 65 us, every 30, due -, jitter 30",    "441 65 us, every 30, due -, jitter 30",
              "511 65 us, every 500, due -, jitter 30",   "511 65 us, every 20, due 15, jitter 2",
              "512 135 us, every 500, due -, jitter 30",  "512 135 us, every 20, due 15, jitter 2",
              "63F 120 us, every 100, due 100, jitter 0", "721 75 us, every 300, due -, jitter 30",
              "721 75 us, every 40, due 40, jitter 0"});
  // A change of periods: each stream at the shorter one, and requests of both.
  static_cast<void>(proof.load(0, 1));
  CHECK(lines(proof.messages()) ==
        Lines{"031 65 us, every 100, due -, jitter 1",    "111 95 us, every 500, due -, jitter 1",
              "111 95 us, every 500, due -, jitter 1",    "111 95 us, every 30, due -, jitter 1",
              "231 65 us, every 30, due -, jitter 1",     "321 95 us, every 500, due -, jitter 1",
              "321 95 us, every 500, due -, jitter 1",    "321 95 us, every 300, due -, jitter 1",
              "321 95 us, every 30, due -, jitter 1",     "441 65 us, every 500, due -, jitter 30",
              "441 65 us, every 500, due -, jitter 30",   "441 65 us, every 500, due -, jitter 30",
              "441 65 us, every 500, due -, jitter 30",   "441 65 us, every 300, due -, jitter 30",
              "441 65 us, every 100, due -, jitter 30",   "441 65 us, every 30, due -, jitter 30",
              "441 65 us, every 30, due -, jitter 30",    "441 65 us, every 30, due -, jitter 30",
              "511 65 us, every 30, due -, jitter 30",    "511 65 us, every 20, due 15, jitter 2",
              "512 135 us, every 30, due -, jitter 30",   "512 135 us, every 20, due 15, jitter 2",
              "63F 120 us, every 100, due 100, jitter 0", "721 75 us, every 30, due -, jitter 30",
              "721 75 us, every 40, due 40, jitter 0"});
  // The way back: one goes on at the period that it has.
  static_cast<void>(proof.load(1, 0));
  CHECK(lines(proof.messages()) ==
        Lines{"031 65 us, every 100, due -, jitter 1",    "031 65 us, every 30, due -, jitter 1",
              "111 95 us, every 500, due -, jitter 1",    "111 95 us, every 500, due -, jitter 1",
              "111 95 us, every 30, due -, jitter 1",     "321 95 us, every 500, due -, jitter 1",
              "321 95 us, every 300, due -, jitter 1",    "321 95 us, every 500, due -, jitter 1",
              "441 65 us, every 500, due -, jitter 30",   "441 65 us, every 500, due -, jitter 30",
              "441 65 us, every 300, due -, jitter 30",   "441 65 us, every 100, due -, jitter 30",
              "441 65 us, every 500, due -, jitter 30",   "441 65 us, every 500, due -, jitter 30",
              "441 65 us, every 30, due -, jitter 30",    "441 65 us, every 30, due -, jitter 30",
              "511 65 us, every 30, due -, jitter 30",    "511 65 us, every 20, due 15, jitter 2",
              "512 135 us, every 30, due -, jitter 30",   "512 135 us, every 20, due 15, jitter 2",
              "63F 120 us, every 100, due 100, jitter 0", "721 75 us, every 300, due -, jitter 30",
              "721 75 us, every 40, due 40, jitter 0"});
  // A change of priority: both, and no stop.
  static_cast<void>(proof.load(1, 2));
  CHECK(lines(proof.messages()) ==
        Lines{"111 95 us, every 500, due -, jitter 1",   "311 95 us, every 500, due -, jitter 1",
              "311 95 us, every 30, due -, jitter 1",    "321 95 us, every 500, due -, jitter 1",
              "321 65 us, every 30, due -, jitter 1",    "441 65 us, every 500, due -, jitter 30",
              "441 65 us, every 500, due -, jitter 30",  "441 65 us, every 500, due -, jitter 30",
              "441 65 us, every 30, due -, jitter 30",   "441 65 us, every 30, due -, jitter 30",
              "511 65 us, every 500, due -, jitter 30",  "511 65 us, every 30, due 15, jitter 2",
              "512 135 us, every 500, due -, jitter 30", "512 135 us, every 30, due 15, jitter 2",
              "711 65 us, every 500, due -, jitter 30",  "711 65 us, every 30, due 15, jitter 2",
              "712 135 us, every 500, due -, jitter 30", "712 135 us, every 30, due 15, jitter 2",
              "721 75 us, every 500, due -, jitter 30",  "721 75 us, every 50, due 50, jitter 0"});
  robot.op.retry = 0ms;
  // Never asked for again.
  static_cast<void>(proof.load(0));
  CHECK(lines(proof.messages()) ==
        Lines{"031 65 us, every 100, due -, jitter 1", "321 95 us, every 300, due -, jitter 1",
              "441 65 us, every 300, due -, jitter 30", "441 65 us, every 100, due -, jitter 30",
              "511 65 us, every 20, due 15, jitter 2", "512 135 us, every 20, due 15, jitter 2",
              "63F 120 us, every 100, due 100, jitter 0", "721 75 us, every 300, due -, jitter 30",
              "721 75 us, every 40, due 40, jitter 0"});
  // A change to nothing: stops.
  CHECK(proof.load(0, 3) == 24);  // 23.825 per mille
  CHECK(lines(proof.messages()) ==
        Lines{"031 65 us, every 100, due -, jitter 1", "111 65 us, every 30, due -, jitter 1",
              "321 95 us, every 300, due -, jitter 1", "321 65 us, every 30, due -, jitter 1",
              "441 65 us, every 300, due -, jitter 30", "441 65 us, every 100, due -, jitter 30",
              "441 65 us, every 30, due -, jitter 30", "441 65 us, every 30, due -, jitter 30",
              "511 65 us, every 20, due 15, jitter 2", "512 135 us, every 20, due 15, jitter 2",
              "63F 120 us, every 100, due 100, jitter 0", "721 75 us, every 300, due -, jitter 30",
              "721 75 us, every 40, due 40, jitter 0"});
  // A stop of what the other configurations have, and this one has not, at the start.
  robot.op.initial = 3;
  CHECK(proof.load(none, 3) == 9);
  CHECK(lines(proof.messages()) ==
        Lines{"111 65 us, every 30, due -, jitter 1", "321 65 us, every 30, due -, jitter 1",
              "441 65 us, every 30, due -, jitter 30", "441 65 us, every 30, due -, jitter 30"});
}

TEST_CASE("proof messages: what may be sent each nanosecond counts") {
  Robot robot;
  robot.repeated[0].repeat = 1ns;
  robot.op.retry = 1ns;
  Proof<64> proof{robot.op, bit_rate};
  static_cast<void>(proof.load(0));
  const auto all = lines(proof.messages());
  CHECK(std::count(all.begin(), all.end(), "031 65 us, every 1e-06, due -, jitter 1") == 1);
  CHECK(std::count(all.begin(), all.end(), "111 95 us, every 1e-06, due -, jitter 1") == 1);
}

TEST_CASE(
    "proof messages: if it does not say how often, a stream that follows a value is asked for once a "
    "second") {
  Robot robot;
  robot.adaptations[0].every = Adaptation{}.every;
  robot.op.retry = 0ms;
  Proof<64> proof{robot.op, bit_rate};
  static_cast<void>(proof.load(0));
  const auto all = lines(proof.messages());
  CHECK(std::count(all.begin(), all.end(), "321 95 us, every 1000, due -, jitter 1") == 1);
  CHECK(std::count(all.begin(), all.end(), "721 75 us, every 1000, due -, jitter 30") == 1);
}

}  // namespace reflective_proof_messages_test
