// Whom a verb asks whether it is there, how long it waits for that, and what it says.
#include "cli/command/presence_watch.hpp"

#include <csignal>
#include <string>
#include <vector>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "tests/tool/captured.hpp"
#include "tests/tool/clock/typed_frames.hpp"

namespace tool_clock_presence_watch_test {

using namespace ocm;
using namespace ocm::test;
using cli::Confirm;
using cli::Over;
using cli::PresenceWatch;

constexpr const char* light = "23C#010203";
constexpr const char* motors = "201#0100000000000000";
// The first frame of a board's status, and another sample of the wheels' board. [spec/topics.json]
constexpr const char* light_status = "757#0500000175B906B2";
constexpr const char* wheels_refusal = "71D#0108010000000000";

/// A watch and a bus on which frames come at their times.
struct Bench {
  explicit Bench(const Frames& frames, Confirm confirm = Confirm::yes) : Bench(bus_with(frames), confirm) {}
  explicit Bench(PlayedBus::Conditions conditions, Confirm confirm = Confirm::yes)
      : bus(world, std::move(conditions)), watch(amiro::catalogue, "led", confirm) {}

  /// Asks after these have left, and listens; when it ends, in ms from the start.
  std::int64_t listens(const std::vector<const char*>& sent, bool ends_hold = false) {
    client::Command command;
    command.ends_hold = ends_hold;
    for (const char* const text : sent) command.frames.push_back(frame(text));
    watch.sent(command);
    cli::Outgoing outgoing{bus, "led"};
    watch.ask(bus, outgoing);
    cli::Live live{bus};
    over = watch.listen(
        live, [this](const can::Received& received) { ++(watch.take(received) ? answers : others); });
    return (world.now() - World::start) / 1ms;
  }
  std::vector<std::string> asked() {
    std::vector<std::string> all;
    for (const auto& sent : bus.sent()) all.emplace_back(can::to_text(sent.frame).view());
    return all;
  }
  std::string tells(std::string_view otherwise = {}) {
    Captured said{STDERR_FILENO};
    const bool any = watch.tell(otherwise);
    return (any ? "true: " : "false: ") + said.text();
  }

  World world{1};
  PlayedBus bus;
  PresenceWatch watch;
  Over over = Over::enough;
  int answers = 0;
  int others = 0;
};

TEST_CASE("presence: a board that answers is there, however late within two seconds") {
  Bench bench{{{10ms, wheels_refusal}, {1900ms, light_status}, {1950ms, light_status}}};
  CHECK(bench.listens({light}) == 1900);
  CHECK(bench.asked() == std::vector<std::string>{"357#02"});
  CHECK(bench.answers == 1);
  CHECK(bench.others == 1);
  CHECK(bench.tells() == "false: ");
}

TEST_CASE("presence: a board that does not is named, with what that means for the robot") {
  Bench bench{{{10ms, wheels_refusal}}};
  CHECK(bench.listens({light}) == 2000);
  CHECK(
      bench.tells() ==
      "true: amiroctl: led: light_ring does not answer, so nothing shows that it has done it\n"
      "          is it powered and on can0? `amiroctl doctor` says which boards are there; --no-confirm does "
      "not ask\n");
  Bench both{Frames{}};
  CHECK(both.listens({light, motors, light}) == 2000);
  CHECK(both.asked() == std::vector<std::string>{"31B#02", "357#02"});
  CHECK(both.tells("IT MAY MOVE") ==
        "true: amiroctl: led: di_wheel_drive and light_ring do not answer, so nothing shows that they have "
        "done it; IT MAY MOVE\n"
        "          are they powered and on can0? `amiroctl doctor` says which boards are there; --no-confirm "
        "does not ask\n");
}

TEST_CASE("presence: of a stop the wheels' board is asked alone") {
  Bench bench{Frames{}};
  CHECK(bench.listens({"201#0000000000000000", "23C#000000"}, true) == 2000);
  CHECK(bench.asked() == std::vector<std::string>{"31B#02"});
}

TEST_CASE("presence: a board that was heard is not asked") {
  Bench bench{Frames{}};
  bench.watch.take({{}, frame(light_status)});
  CHECK(bench.listens({light}) == 0);
  CHECK(bench.asked().empty());
  CHECK(bench.tells() == "false: ");
}

TEST_CASE("presence: with --no-confirm, or a caller that says it, none is asked") {
  Bench unconfirmed{Frames{}, Confirm::no};
  Bench waived{Frames{}};
  waived.watch.waive();
  for (Bench* const bench : {&unconfirmed, &waived}) {
    CHECK(bench->listens({light}) == 0);
    CHECK(bench->watch.signs().empty());
    CHECK(bench->asked().empty());
    CHECK(bench->tells() == "false: ");
  }
}

TEST_CASE("presence: a signal ends the wait, and the board that had not answered is named") {
  Bench bench{Frames{{20ms, light_status}}};
  bench.world.interrupt(World::start + 500ms, SIGINT);
  CHECK(bench.listens({light, motors}) / 100 == 5);
  CHECK(bench.over == Over::signal);
  CHECK(bench.tells("IT MAY MOVE") ==
        "true: amiroctl: led: interrupted before di_wheel_drive answered, so nothing shows that it has done "
        "it; IT MAY MOVE\n          --no-confirm does not wait for an answer\n");
}

TEST_CASE("presence: a bus that goes meanwhile is named, and not the board") {
  PlayedBus::Conditions goes;
  goes.gone = World::start + 300ms;
  Bench gone{goes};
  CHECK(gone.listens({light}) == 300);
  CHECK(gone.over == Over::gone);
  CHECK(gone.tells() ==
        "true: amiroctl: led: light_ring had not answered when the bus went: can0 is gone; so nothing shows "
        "that "
        "it has done it\n          plug it in\n");
}

TEST_CASE("presence: a bus that takes no request for a second is waited for no longer") {
  PlayedBus::Conditions full;
  full.room = 0;
  Bench deaf{full};
  CHECK(deaf.listens({light, motors}) / 100 == 10);
  CHECK(deaf.asked().empty());
  CHECK_THAT(deaf.tells(),
             Catch::StartsWith("true: amiroctl: led: di_wheel_drive and light_ring could not be asked, so "
                               "nothing shows that they have done it\n"));
}

}  // namespace tool_clock_presence_watch_test
