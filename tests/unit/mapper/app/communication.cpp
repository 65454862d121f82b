#include "ocm/mapper/app/communication.hpp"

#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/packed.hpp"

#include "unit/mapper/app/app_testing.hpp"
#include "unit/motion/near.hpp"

namespace mapper_app_communication_test {

using namespace app_testing;
using ocm::test::near;

TEST_CASE("mapper: says who it is each second until it is confirmed, with a yellow flash", "[mapper]") {
  Bench bench;
  bench.run_for(3s);
  bench.link(true);
  CHECK(bench.is(State::connected));
  int flashes = 0;
  bool lit = false;
  bench.each_step = [&] {
    flashes += bench.parts.lights.yellow && !lit ? 1 : 0;
    lit = bench.parts.lights.yellow;
    CHECK(bench.parts.efforts == motion::Efforts{});
  };
  bench.run_for(100ms);
  CHECK(bench.heard() == handshake);
  CHECK(bench.parts.lights == both);
  bench.run_for(4s);
  CHECK(bench.parts.lights.green);
  CHECK(bench.heard(handshake) == 4);
  CHECK(bench.heard() == handshake + handshake + handshake + handshake);
  CHECK(flashes == 5);
  CHECK(bench.parts.servo_deg == 0);
  bench.say("{S,CON}\n");
  bench.run_for(2s);
  CHECK(bench.is(State::confirmed));
  CHECK(bench.heard("{H") == 0);
  CHECK(bench.parts.lights == green);
  CHECK(bench.robot.counters().handshakes == 5);
}

TEST_CASE("mapper: an operator who comes early waits until gyro and compass are measured", "[mapper]") {
  Bench bench;
  bench.link(true);
  bench.run_for(1800ms);
  bench.say("{S,CON}\n{U,0,100}\n");
  bench.run_for(50ms);
  CHECK(bench.is(State::advertising));
  CHECK(bench.parts.sent.empty());
  CHECK(bench.robot.counters().input_unlinked == 18);
  bench.run_for(300ms);
  CHECK(bench.is(State::connected));
  CHECK(bench.heard() == handshake);
}

TEST_CASE("mapper: a ping is answered, with a link, in any state", "[mapper]") {
  Bench bench;
  bench.run_for(3s);
  bench.link(true);
  bench.run_for(200ms);
  bench.heard();
  bench.say("{}\n");
  bench.run_for(25ms);
  CHECK(bench.heard() == "\t!\n");
  bench.say("{S,CON}\n{S,PAU}\n{ }\n");
  bench.run_for(25ms);
  CHECK(bench.heard("\t!\n") == 1);
  CHECK(bench.robot.counters().pongs == 2);
  CHECK(bench.robot.counters().idles == 1);
}

TEST_CASE("mapper: asked who it is it says its handshake again, and goes on as before", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say("{U,0,100}\n");
  bench.run_for(2s);
  const motion::Pose pose = bench.robot.pose();
  bench.heard();
  bench.say("{S,WHO}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("{H,20,20,1,3,0,90,180,270,5000,20225,3}\n") == 1);
  CHECK(bench.is(State::confirmed));
  CHECK(bench.robot.busy());
  CHECK(bench.robot.pose().x_m >= pose.x_m);
  bench.say("{S,PAU}\n{S,WHO}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("{H,") == 2);
  CHECK(bench.is(State::paused));
}

TEST_CASE("mapper: packed updates, where the operator asks for them", "[mapper]") {
  Bench bench;
  bench.run_for(3s);
  bench.link(true);
  bench.run_for(200ms);
  bench.say("{S,BIN}\n{S,CON}\n");
  bench.run_for(25ms);
  bench.heard();
  bench.run_for(990ms);
  mapper::link::PackedReader reader;
  int packed = 0;
  for (const char c : bench.heard())
    if (mapper::link::is_packed(static_cast<std::uint8_t>(c)) && reader.feed(static_cast<std::uint8_t>(c)))
      ++packed;
  CHECK(packed >= 4);
  CHECK(bench.robot.counters().updates >= 4);
  bench.say("{S,TXT}\n");
  bench.run_for(25ms);
  bench.heard();
  bench.run_for(1s);
  CHECK(updates(bench.heard()).size() == 5);
}

TEST_CASE("mapper: what the state does not allow is refused and counted", "[mapper]") {
  Bench bench;
  bench.run_for(3s);
  bench.link(true);
  bench.run_for(150ms);
  bench.heard();
  bench.say("{U,0,100}\n{S,PAU}\n{S,UNP}\n{U,0,0}\n");
  bench.run_for(500ms);
  CHECK(bench.is(State::connected));
  CHECK(bench.robot.counters().refused == 4);
  CHECK(bench.robot.counters().heard == 4);
  CHECK(bench.parts.efforts == motion::Efforts{});
  bench.say("{C,1}\n");
  bench.run_for(25ms);
  CHECK(bench.is(State::connected));
  CHECK(bench.robot.counters().refused == 5);
}

TEST_CASE("mapper: a second confirmation changes nothing", "[mapper]") {
  Bench bench;
  bench.confirm();
  REQUIRE(bench.drive("{U,90,20}\n"));
  bench.run_for(500ms);
  const motion::Pose before = bench.robot.pose();
  bench.say("{S,CON}\n");
  bench.run_for(100ms);
  CHECK(near(bench.robot.pose(), before, 0.01F, 0.01F));
}

TEST_CASE("mapper: garbage is counted, and the next sentence is heard", "[mapper]") {
  Bench bench;
  bench.confirm();
  std::mt19937 random{5};
  std::string_view letters = "{},SUHCON0123456789-\n\r\t! :[]";
  for (int i = 0; i < 20'000; ++i) {
    const auto any = static_cast<std::uint8_t>(random());
    bench.robot.receive(i % 3 == 0 ? any : static_cast<std::uint8_t>(letters[random() % letters.size()]));
    if (i % 10 == 0) bench.step();
  }
  bench.run_for(100ms);
  const auto garbage = bench.robot.counters();
  CHECK(garbage.damaged.total() > 100);
  CHECK(garbage.stray_bytes > 100);
  bench.say("\n{U,0,0}\n{S,UNP}\n");
  bench.run_for(50ms);
  bench.heard();
  bench.say("{}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("\t!\n") == 1);
}

TEST_CASE("mapper: a full ring loses bytes, counts them, and recovers", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say(std::string(500, 'x'));
  CHECK(bench.robot.counters().input_full == 500 - 128);
  bench.run_for(50ms);
  bench.heard();
  bench.say("{}\n");
  bench.run_for(25ms);
  CHECK(bench.heard("\t!\n") == 1);
  CHECK(bench.robot.counters().input_full == 500 - 128);
}

TEST_CASE("mapper: a ring that fills without a sentence is emptied before it is full", "[mapper]") {
  Bench bench;
  bench.confirm();
  for (int i = 0; i < 50; ++i) {
    bench.say(std::string(60, 'x'));
    bench.run_for(21ms);
  }
  CHECK(bench.robot.counters().input_full == 0);
  CHECK(bench.robot.counters().stray_bytes > 2800);
}

TEST_CASE("mapper: an operator who floods the line gets communication every 20 ms, and no more", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.say("{}");
  bench.step();
  bench.heard();
  int answers = 0;
  for (int ms = 0; ms < 1000; ++ms) {
    bench.say("{}");
    bench.step();
    answers += bench.heard("\t!") > 0 ? 1 : 0;
    bench.heard();
  }
  CHECK(answers <= 51);
  CHECK(answers >= 45);
}

TEST_CASE("mapper: without room in the UART bytes are lost and counted, and it goes on", "[mapper]") {
  Bench bench;
  bench.confirm();
  bench.parts.room = 5;
  bench.run_for(1s);
  CHECK(bench.robot.counters().output_full > 50);
  const auto before = bench.robot.counters().updates;
  bench.parts.room = 1000;
  bench.run_for(1s);
  CHECK(bench.robot.counters().updates == before + 5);
}

TEST_CASE("mapper: supervision that comes late by a whole period looks once, and goes on at its times",
          "[mapper]") {
  Bench bench;
  bench.run_for(3s);
  bench.link(true);
  bench.now += 200ms;  // at once: it was due in the middle
  bench.port.advance(bench.now);
  bench.work();
  CHECK(bench.heard() == handshake);
  CHECK(bench.parts.lights == both);
  bench.run_for(99ms);
  CHECK(bench.parts.lights == both);
  bench.run_for(1ms);
  CHECK(bench.parts.lights == green);
}

}  // namespace mapper_app_communication_test
