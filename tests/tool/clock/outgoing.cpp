// What a verb says of frames that do not leave, and how long it waits for them.
#include "cli/shared/outgoing.hpp"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/any_text.hpp"
#include "ocm/can/text.hpp"

#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/typed_frames.hpp"

namespace tool_clock_outgoing_test {

using namespace ocm;
using namespace ocm::test;
using cli::Outgoing;

constexpr Moment never = Moment::max();
constexpr const char* none_acknowledges =
    "          no node acknowledges the frames: is a board powered and connected, and is the bit rate the "
    "same?\n";

/// What it says as it leaves, and how long that took.
struct Left {
  std::string text;
  Duration after{};
};
template <class Act>
Left left(World& world, Act&& act) {
  const Moment begin = world.now();
  const Leaving left = leaving(act);
  CHECK(left.code == cli::exit_failure);
  return {left.text, world.now() - begin};
}

TEST_CASE("outgoing: a full queue is waited for, a second and no longer") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.room = 1;
  conditions.frame_time = 5ms;
  conditions.stuck = {{World::start, World::start + 900ms}, {World::start + 902ms, never}};
  PlayedBus bus{world, std::move(conditions)};
  Outgoing outgoing{bus, "led"};
  outgoing.send(frame("23C#010203"));
  outgoing.send(frame("23D#010203"));  // when the first has left
  CHECK(world.now() >= World::start + 900ms);
  CHECK(world.now() < World::start + 910ms);
  CHECK(outgoing.stood_still() < 10ms);  // it looked at the clock all the time
  world.pass(100ms);
  const Left end = left(world, [&] { outgoing.send(frame("23E#010203")); });
  CHECK(end.text == std::string{"amiroctl: led: the transmit queue of can0 stays full: 23E#010203 was not "
                                "sent\n"} +
                        none_acknowledges);
  CHECK(end.after >= 1s);
  CHECK(end.after < 1010ms);
  CHECK(bus.sent().size() == 2);
}

TEST_CASE("outgoing: of a simulator that takes no frame no wire is suspected") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.room = 0;
  conditions.is_simulated = true;
  PlayedBus bus{world, std::move(conditions), "sim"};
  Outgoing outgoing{bus, "led"};
  CHECK_FALSE(outgoing.robot_is_gone());
  CHECK(left(world, [&] { outgoing.send(frame("23C#010203")); }).text ==
        "amiroctl: led: the transmit queue of sim stays full: 23C#010203 was not sent\n"
        "          the simulator takes none: was it stopped (Ctrl-Z; `fg` lets it go on), or is the machine "
        "busy?\n");
}

TEST_CASE("outgoing: a bus that is down is said before anything is sent, or when it goes down") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.down = {{World::start + 10ms, never}};
  PlayedBus bus{world, std::move(conditions)};
  Outgoing outgoing{bus, "stop", "it moves"};
  world.pass(20ms);
  CHECK(left(world, [&] {
          const Outgoing late{bus, "stop", "it moves"};
        }).text == "amiroctl: stop: can0 is down; nothing was sent; it moves\n          bring it up\n");
  CHECK(left(world, [&] { outgoing.send(frame("205#00")); }).text ==
        "amiroctl: stop: can0 is down: 205#00 was not sent; it moves\n"
        "          bring it up: sudo ip link set can0 up\n");
}

TEST_CASE("outgoing: what is no frame is none") {
  World world{1};
  PlayedBus bus{world, {}};
  Outgoing outgoing{bus, "send"};
  can::Frame wrong = frame("205#00");
  wrong.id = 0x800;
  const Left end = left(world, [&] { outgoing.send(wrong); });
  CHECK_THAT(end.text,
             Catch::EndsWith(" cannot be sent: identifier out of range for its format\n"
                             "          only data and remote frames with a valid identifier can, of "
                             "up to 8 bytes; CAN FD of up to 64\n"));
  CHECK(end.after < 10ms);
}

TEST_CASE("outgoing: of a frame of CAN FD it is said what keeps it from the bus") {
  World world{1};
  PlayedBus bus{world, {}};
  Outgoing outgoing{bus, "send"};
  const auto frame_of_fd = can::parse_any_frame("123##10011");
  REQUIRE(frame_of_fd.ok());
  const Left end = left(world, [&] { outgoing.send(*frame_of_fd); });
  CHECK_THAT(end.text, Catch::StartsWith("amiroctl: send: 123##1"));
  CHECK_THAT(end.text, Catch::EndsWith(" is a CAN FD frame, and 'can0' carries no CAN FD frames\n"
                                       "          use a CAN interface in FD mode, or the simulated bus\n"));
  CHECK(end.after < 10ms);
  CHECK(bus.sent().empty());
}

TEST_CASE("outgoing: how many frames did not leave, after half a second in which none did") {
  const auto waits = [](std::size_t frames, Duration stuck_after) {
    World world{1};
    PlayedBus::Conditions conditions;
    conditions.frame_time = 1ms;
    conditions.stuck = {{World::start + stuck_after, never}};
    PlayedBus bus{world, std::move(conditions)};
    Outgoing outgoing{bus, "led"};
    for (std::size_t i = 0; i < frames; ++i) outgoing.send(frame("23C#010203"));
    return left(world, [&] { outgoing.expect_all_left(); });
  };
  const Left one = waits(1, 0s);
  CHECK(one.text == std::string{"amiroctl: led: the frame did not leave can0, and may leave later\n"} +
                        none_acknowledges);
  CHECK(one.after >= 500ms);
  CHECK(one.after < 501ms);  // it looks each millisecond
  CHECK(waits(3, 0s).text ==
        std::string{"amiroctl: led: 3 of 3 frames did not leave can0, and may leave later\n"} +
            none_acknowledges);
  const Left some = waits(3, 1500us);  // one leaves before
  CHECK(some.text == std::string{"amiroctl: led: 2 of 3 frames did not leave can0, and may leave later\n"} +
                         none_acknowledges);
  CHECK(some.after >= 500ms);
  CHECK(waits(3, 2500us).text ==
        std::string{"amiroctl: led: 1 of 3 frames did not leave can0, and may leave later\n"} +
            none_acknowledges);
}

TEST_CASE("outgoing: a slow bus is waited for as long as frames leave, and one that cannot tell is not") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.frame_time = 400ms;
  PlayedBus slow{world, conditions};
  Outgoing outgoing{slow, "led"};
  for (int i = 0; i < 5; ++i) outgoing.send(frame("23C#010203"));
  const Moment begin = world.now();
  outgoing.expect_all_left();
  CHECK(world.now() - begin > 1900ms);
  CHECK(slow.sent().back().left <= world.now());
  conditions.knows_delivery = false;
  PlayedBus silent{world, conditions};
  Outgoing other{silent, "led"};
  other.send(frame("23C#010203"));
  const Moment sent = world.now();
  CHECK(other.all_left(1s));
  CHECK(world.now() - sent < 10ms);
}

TEST_CASE("outgoing: what it means that frames do not leave is said once something has left") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.frame_time = 1ms;
  PlayedBus bus{world, conditions};
  Outgoing outgoing{bus, "drive"};
  CHECK_FALSE(outgoing.matters());
  outgoing.send(frame("23C#010203"));
  world.pass(10ms);
  CHECK_FALSE(outgoing.matters());
  outgoing.otherwise_after_the_next("it moves");
  CHECK_FALSE(outgoing.matters());
  outgoing.send(frame("201#0100000000000000"));
  CHECK_FALSE(outgoing.matters());  // in the queue
  world.pass(10ms);
  CHECK(outgoing.matters());
  outgoing.otherwise_after_the_next("something else");  // it has a meaning
  CHECK(outgoing.matters());

  // Where that cannot be known, what was taken counts.
  conditions.knows_delivery = false;
  conditions.gone = world.now() + 1s;
  PlayedBus silent{world, conditions};
  Outgoing other{silent, "drive"};
  other.otherwise_after_the_next("it moves");
  CHECK_FALSE(other.matters());
  other.send(frame("201#0100000000000000"));
  CHECK(other.matters());
  other.otherwise("it goes on");
  world.pass(1s);
  CHECK(left(world, [&] { other.send(frame("201#0000000000000000")); }).text ==
        "amiroctl: can0 is gone; it goes on\n          plug it in\n");
  CHECK_FALSE(other.all_left(1s));

  PlayedBus new_one{world, {}};
  Outgoing stop{new_one, "stop"};
  stop.otherwise("it moves");  // whether or not something has left
  CHECK(stop.matters());
}

TEST_CASE("outgoing: of a bus that is gone it is said what that means, if anything moves") {
  const auto said = [](bool is_simulated, std::string meaning) {
    World world{1};
    PlayedBus::Conditions conditions;
    conditions.gone = World::start + 10ms;
    conditions.is_simulated = is_simulated;
    PlayedBus bus{world, std::move(conditions)};
    Outgoing outgoing{bus, "stop", std::move(meaning)};
    world.pass(20ms);
    const std::string text = left(world, [&] { outgoing.send(frame("205#00")); }).text;
    CHECK(outgoing.robot_is_gone() == is_simulated);
    CHECK(left(world, [&] { outgoing.expect_all_left(); }).text == text);
    return text;
  };
  CHECK(said(false, "it moves") == "amiroctl: can0 is gone; it moves\n          plug it in\n");
  const std::string alone = "amiroctl: can0 is gone\n          plug it in\n";
  CHECK(said(false, "") == alone);
  CHECK(said(true, "it moves") == alone);  // the robot is gone with it
}

TEST_CASE("outgoing: on a bus that went down behind the last frame, one may not have left") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.frame_time = 1ms;
  conditions.down = {{World::start + 20ms, never}};
  PlayedBus bus{world, std::move(conditions)};
  Outgoing outgoing{bus, "led"};
  for (int i = 0; i < 2; ++i) outgoing.send(frame("23C#010203"));
  world.pass(50ms);
  CHECK(left(world, [&] { outgoing.expect_all_left(); }).text ==
        "amiroctl: led: 1 of 2 frames did not leave can0, and may leave later: can0 is down\n          bring "
        "it up\n");
}

TEST_CASE("outgoing: of what two frames mean that which no watchdog ends is said") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.gone = World::start + 1s;
  PlayedBus bus{world, std::move(conditions)};
  Outgoing outgoing{bus, "run"};
  outgoing.otherwise_after_the_next("it moves");
  outgoing.send(frame("201#0100000000000000"));
  world.pass(10ms);
  outgoing.otherwise_after_the_next("something else");
  const auto meant = [&] { return left(world, [&] { outgoing.send(frame("201#0000000000000000")); }).text; };
  outgoing.otherwise_after_the_next(cli::still_travelling);
  outgoing.otherwise_after_the_next("it moves");
  world.pass(1s);
  CHECK(meant() == fmt::format("amiroctl: can0 is gone; {}\n          plug it in\n", cli::still_travelling));
}

TEST_CASE("outgoing: behind a failure, whether a frame is taken in time is an answer, and is not said") {
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.room = 1;
  conditions.frame_time = 5ms;
  conditions.stuck = {{World::start, World::start + 100ms}, {World::start + 110ms, never}};
  PlayedBus bus{world, conditions};
  Outgoing outgoing{bus, "drive"};
  const auto is_taken = [&world](Outgoing& out, const can::Frame& each, Duration patience) {
    std::pair<bool, Duration> answer;
    const Moment begin = world.now();
    const Leaving said = leaving([&] { answer.first = out.is_taken(each, patience); });
    CHECK(said.text.empty());
    CHECK_FALSE(said.code);
    answer.second = world.now() - begin;
    return answer;
  };
  CHECK(is_taken(outgoing, frame("201#0000000000000000"), 0ms).first);
  const auto later = is_taken(outgoing, frame("201#0000000000000000"), 1s);  // when the first has left
  CHECK(later.first);
  CHECK(later.second >= 99ms);
  CHECK(later.second < 105ms);
  world.pass(20ms);
  CHECK(is_taken(outgoing, frame("201#0000000000000000"), 50ms).first);
  const auto never_taken = is_taken(outgoing, frame("201#0000000000000000"), 50ms);
  CHECK_FALSE(never_taken.first);
  CHECK(never_taken.second >= 50ms);
  CHECK(never_taken.second < 55ms);
  CHECK(bus.sent().size() == 3);
  // What can never be sent is not waited for.
  can::Frame wrong = frame("205#00");
  wrong.id = 0x800;
  const auto invalid = is_taken(outgoing, wrong, 1s);
  CHECK_FALSE(invalid.first);
  CHECK(invalid.second < 5ms);
  conditions.gone = world.now() + 10ms;
  PlayedBus going{world, conditions};
  Outgoing other{going, "drive"};
  world.pass(20ms);
  const auto gone = is_taken(other, frame("201#0000000000000000"), 1s);
  CHECK_FALSE(gone.first);
  CHECK(gone.second < 5ms);
}

}  // namespace tool_clock_outgoing_test
