// A bus on which an operator runs: what goes through it, what it says to that, and what comes back.
#include "cli/command/operated_bus.hpp"

#include <deque>
#include <filesystem>
#include <memory>
#include <poll.h>
#include <string>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/shared/local_server.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/typed_frames.hpp"

namespace tool_clock_operated_bus_test {

using namespace ocm;
using namespace ocm::test;
using cli::LocalServer;

/// The operator answers what it is to answer, in order; empty: it says nothing.
class Bench {
 public:
  World world{1};
  PlayedBus* played = nullptr;
  std::deque<std::string> answers;
  std::vector<std::string> asked;
  std::string path;
  std::unique_ptr<LocalServer> server;
  std::unique_ptr<cli::OperatedBus> bus;

  explicit Bench(PlayedBus::Conditions conditions = {}) {
    folder_ = std::filesystem::temp_directory_path() / fmt::format("ocm-operated-{}", ::getpid());
    std::filesystem::create_directories(folder_);
    std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
    path = (folder_ / "operator.sock").string();
    static constexpr host::LocalService service{"an operator", "an operator", host::Cause::other, false};
    auto opened = LocalServer::open(path, service);
    REQUIRE(opened);
    server = std::move(*opened);
    server->begin({{},
                   [](cli::LocalCaller&) { return cli::answers::yes("guard"); },
                   [this](cli::LocalCaller&, std::string_view request) {
                     asked.emplace_back(request);
                     if (answers.empty()) return std::string{"no\nnot expected\n"};
                     std::string answer = answers.front();
                     answers.pop_front();
                     return answer;
                   },
                   {}});
    world.beside = [this] {
      if (server) server->serve();
    };
    for (int descriptor = 3; descriptor < 200; ++descriptor)
      world.inputs[descriptor] = [descriptor] {
        pollfd input{descriptor, POLLIN, 0};
        return ::poll(&input, 1, 0) > 0 ? World::start : Moment::max();
      };
    auto link = cli::LocalLink::connect(path, "the operator on can0", "drive");
    REQUIRE(link);
    REQUIRE(*link);
    (*link)->set_who("operator guard");
    auto made = std::make_unique<PlayedBus>(world, std::move(conditions));
    played = made.get();
    bus = std::make_unique<cli::OperatedBus>(std::move(made), std::move(*link), amiro::catalogue, "drive");
  }
  ~Bench() { std::filesystem::remove_all(folder_); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  bool sends(std::string_view text) {
    const auto taken = bus->send(frame(text));
    REQUIRE(taken);
    return *taken;
  }
  [[nodiscard]] std::vector<std::string> on_bus() const {
    std::vector<std::string> texts;
    for (const auto& each : played->sent()) texts.emplace_back(can::to_text(each.frame).view());
    return texts;
  }

 private:
  std::filesystem::path folder_;
};

using Texts = std::vector<std::string>;

TEST_CASE("operated bus: what commands an actuator goes through the operator, all else to the bus") {
  Bench bench;
  CHECK(bench.bus->name() == "can0");
  bench.answers = {"ok\n201#1027000000000000\n", "wait", "ok\n0", "no\nit is halted\nlater",
                   "ok\n23C#FF0000\n"};
  CHECK(bench.sends("201#1027000000000000"));
  CHECK_FALSE(bench.sends("201#1127000000000000"));
  CHECK(bench.bus->delivery().obstruction.what.empty());
  CHECK_FALSE(bench.sends("201#1227000000000000"));
  const auto delivery = bench.bus->delivery();
  CHECK(delivery.obstruction.what == "it is halted");
  CHECK(delivery.obstruction.remedy == "later");
  CHECK(delivery.refused);
  CHECK(*bench.bus->send_any(can::AnyFrame{frame("23C#FF0000")}));
  CHECK(bench.asked == Texts{"send 201#1027000000000000", "send 201#1127000000000000", "delivery",
                             "send 201#1227000000000000", "send 23C#FF0000"});
  CHECK(bench.on_bus().empty());
  bench.asked.clear();
  for (const char* const text : {"208#01F40100", "605#0000", "7F0#", "00000201#1027000000000000"})
    CHECK(bench.sends(text));
  CHECK(bench.asked.empty());
  CHECK(bench.on_bus() == Texts{"208#01F40100", "605#0000", "7F0#", "00000201#1027000000000000"});
  CHECK(bench.bus->counters().sent == 6);
  CHECK_FALSE(bench.bus->over());
}

TEST_CASE("operated bus: a frame that the operator has sent for it comes to it from no other program") {
  PlayedBus::Conditions conditions;
  const auto comes = [&](Duration at, std::string_view text) {
    conditions.incoming.push_back({World::start + at, frame(text)});
  };
  comes(10ms, "201#204E000000000000");  // as the operator has limited it
  comes(20ms, "201#204E000000000000");  // another one's
  comes(30ms, "201#1027000000000000");  // as it was asked for: another one's
  comes(1500ms, "23C#010203");          // within two seconds
  comes(3600ms, "23C#040506");          // and not
  Bench bench{conditions};
  bench.answers = {"ok\n201#204E000000000000\nmotors.x", "ok\n23C#010203\n", "ok\n23C#040506\n"};
  const Captured err{STDERR_FILENO};
  CHECK(bench.sends("201#1027000000000000"));
  CHECK(bench.sends("23C#010203"));
  const auto next = [&](bool any) {
    if (any) {
      const auto received = bench.bus->receive_any(2s);
      return received ? std::string{can::to_text(*received->frame.classic()).view()} : std::string{"-"};
    }
    const auto received = bench.bus->receive(2s);
    return received ? std::string{can::to_text(received->frame).view()} : std::string{"-"};
  };
  bench.world.pass(15ms);
  CHECK(next(false) == "-");  // its own, and it waits for no other
  CHECK(next(true) == "201#204E000000000000");
  CHECK(next(false) == "201#1027000000000000");
  bench.world.wait_until(World::start + 1510ms);
  CHECK(next(true) == "-");
  CHECK(bench.sends("23C#040506"));
  bench.world.wait_until(World::start + 3610ms);
  CHECK(next(true) == "23C#040506");
}

TEST_CASE("operated bus: what is limited is said once") {
  Bench bench;
  for (const char* const limits :
       {"", "motors.x", "motors.x", "", "motors.x\nmotors.z", "motors.x", "led.a\nled.b"})
    bench.answers.push_back(fmt::format("ok\n201#204E000000000000\n{}", limits));
  Captured err{STDERR_FILENO};
  for (int i = 0; i < 7; ++i) CHECK(bench.sends("201#50C3000000000000"));
  CHECK(err.text() ==
        "drive: operator guard limits motors.x\n"
        "drive: operator guard limits motors.z\n"
        "drive: operator guard limits led.a, led.b\n");
}

TEST_CASE("operated bus: what waits is that of the bus and of the operator together") {
  PlayedBus::Conditions conditions;
  conditions.frame_time = 1h;  // none leaves
  Bench bench{conditions};
  CHECK(bench.bus->delivery().pending == 0);
  CHECK(bench.asked.empty());  // nothing went through it
  CHECK(bench.sends("208#01F40100"));
  bench.answers = {"ok\n201#1027000000000000\n", "ok\n3", "ok\nunknown", "no\ncan0 is down\nbring it up",
                   "ok\n0"};
  CHECK(bench.sends("201#1027000000000000"));
  auto delivery = bench.bus->delivery();
  CHECK(delivery.known);
  CHECK(delivery.pending == 4);
  CHECK(bench.bus->delivery().pending == 1);  // it cannot tell
  delivery = bench.bus->delivery();
  CHECK(delivery.obstruction.what == "can0 is down");
  CHECK_FALSE(delivery.refused);
  CHECK(bench.bus->delivery().pending == 1);
}

TEST_CASE("operated bus: when the operator has ended only the end of a motion goes past it") {
  Bench bench;
  bench.answers = {"ok\n201#1027000000000000\n"};
  CHECK(bench.sends("201#1027000000000000"));
  bench.server.reset();
  CHECK_FALSE(bench.sends("201#1027000000000000"));
  CHECK(bench.bus->over());
  const auto delivery = bench.bus->delivery();
  CHECK(delivery.obstruction.what.find("has ended") != std::string::npos);
  CHECK_FALSE(delivery.refused);
  CHECK_FALSE(bench.sends("23C#000000"));
  CHECK(bench.on_bus().empty());
  CHECK(bench.sends("201#0000000000000000"));
  CHECK_FALSE(bench.sends("20B#A08601000000E803"));
  CHECK(bench.sends("20B#0000000000000000"));
  CHECK(bench.sends("229#0000"));
  CHECK(bench.on_bus() == Texts{"201#0000000000000000", "20B#0000000000000000", "229#0000"});
  CHECK(bench.bus->delivery().obstruction.what.empty());
  CHECK_FALSE(bench.bus->commands_itself(frame("201#1027000000000000")).again_and_again);
}

TEST_CASE(
    "operated bus: of an operator that is stopped the greeting is waited for a second, an answer 300 ms") {
  Bench bench;
  bench.world.beside = {};
  const Moment begin = bench.world.now();
  const auto link = cli::LocalLink::connect(bench.path, "the operator on can0", "drive");
  const Moment middle = bench.world.now();
  REQUIRE_FALSE(link);
  CHECK(link.error.what == fmt::format("the operator on can0 (process {}) does not answer", ::getpid()));
  CHECK((middle - begin) / 1ms == 1000);
  CHECK(bench.bus->commands_itself(frame("201#1027000000000000")).who.empty());
  CHECK((bench.world.now() - middle) / 1ms == 300);
  CHECK(bench.asked.empty());
}

TEST_CASE("operated bus: it is simulated where its bus is") {
  for (const bool simulated : {false, true})
    CHECK(Bench{{.is_simulated = simulated}}.bus->is_simulated() == simulated);
}

TEST_CASE("operated bus: whether the operator commands an actuator itself") {
  Bench bench;
  bench.answers = {"ok\n", "ok\nrepeats\nhalted", "ok\nonce\ndriving", "no\nno actuator\nx", "ok\nrepeats"};
  const auto asks = [&] {
    const auto own = bench.bus->commands_itself(frame("201#1027000000000000"));
    return fmt::format("{}|{}|{}", own.who, own.configuration, own.again_and_again);
  };
  CHECK(asks() == "||false");
  CHECK(asks() == "operator guard|halted|true");
  CHECK(asks() == "operator guard|driving|false");
  CHECK(asks() == "||false");
  CHECK(asks() == "operator guard||true");
  CHECK(bench.asked[0] == "commands 201#1027000000000000");
}

}  // namespace tool_clock_operated_bus_test
