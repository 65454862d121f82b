#include "sim/amiro/robot.hpp"

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/analysis/board_admission.hpp"
#include "ocm/can/text.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/di_wheel_drive/costs.hpp"

namespace sim_robot_test {

using namespace ocm;
using namespace ocm::firmware;
using namespace std::chrono_literals;

// Where the firmware's admission and that of these boards differ: docs/verbs/sim.md has these examples.
template <class Topic, class... Costs>
constexpr base::Error idle_board(base::Duration period) {
  using Board = amiro::DiWheelDrive;
  analysis::BoardAdmission<Board, amiro::bit_rate, Costs...> admission;
  return admission.admit(Board::sensors::index<Topic>, period, scheduling::Level::medium);
}
using FirmwareCosts = boards::di_wheel_drive::Costs;
static_assert(idle_board<amiro::Accelerometer>(1ms) == base::Error::none);
static_assert(idle_board<amiro::Accelerometer, FirmwareCosts>(1ms) == base::Error::not_schedulable);
static_assert(idle_board<amiro::Accelerometer, FirmwareCosts>(1114us) == base::Error::not_schedulable);
static_assert(idle_board<amiro::Accelerometer, FirmwareCosts>(1115us) == base::Error::none);
static_assert(idle_board<amiro::Magnetometer>(900us) == base::Error::none);
static_assert(idle_board<amiro::Magnetometer, FirmwareCosts>(900us) == base::Error::none);

/// One board's place on the bus: takes `room` frames and keeps them.
struct Port {
  base::Result<bool> send(const can::Frame& frame) {
    if (frames.size() >= room) return false;
    frames.push_back(frame);
    return true;
  }
  std::size_t room = 1'000'000;
  std::vector<can::Frame> frames;
};

/// The frames of this identifier, as candump writes them.
std::vector<std::string> texts(const Port& port, std::uint32_t id) {
  std::vector<std::string> result;
  for (const auto& frame : port.frames)
    if (frame.id == id) result.emplace_back(can::to_text(frame).view());
  return result;
}

/// A robot with a clock, driven from one event to the next as a server would do it.
struct Setup {
  explicit Setup(sim::WorldOptions options = {}) : robot(std::move(options), bottom, middle, top) {}

  void say(std::string_view text) {
    const auto frame = can::parse_frame(text);
    REQUIRE(frame.ok());
    robot.receive(*frame, now);
    robot.advance(now);
  }
  void pass(base::Duration time) {
    const base::Time end = now + time;
    while (robot.next_event() <= end) {
      now = std::max(now, robot.next_event());
      robot.advance(now);
    }
    now = end;
    robot.advance(now);
  }

  Port bottom, middle, top;
  sim::SimulatedRobot<Port> robot;
  base::Time now{};
};

/// The last sample of a topic on a port.
template <class Topic>
Topic last(const Port& port) {
  std::array<can::Payload, Topic::frames.size()> payloads{};
  for (const auto& frame : port.frames)
    for (std::size_t i = 0; i < payloads.size(); ++i)
      if (frame.id % 256 == Topic::frames[i].id.value) payloads[i] = frame.data;
  return Topic::decode(payloads);
}

TEST_CASE("a world is all the hardware that the boards need") {
  STATIC_REQUIRE(boards::di_wheel_drive::Hardware<sim::World>);
  STATIC_REQUIRE(boards::power_management::Hardware<sim::World>);
  STATIC_REQUIRE(boards::light_ring::Hardware<sim::World>);
  STATIC_REQUIRE_FALSE(boards::light_ring::Hardware<Port>);
}

TEST_CASE("the parts sample as fast as the spec says that they do") {
  CHECK(sim::GyroscopeModel{}.period == amiro::Gyroscope::shortest_period);
  CHECK(sim::AccelerometerModel{}.period == amiro::Accelerometer::shortest_period);
  CHECK(sim::MagnetometerModel{}.period == amiro::Magnetometer::shortest_period);
  CHECK(sim::proximity_period == amiro::FloorProximity::shortest_period);
  CHECK(sim::proximity_period == amiro::ProximityRing::shortest_period);
}

TEST_CASE("the thesis's requests get their answers, each from its own board") {
  Setup setup;
  setup.say("204#02");        // floor once
  setup.say("205#01840302");  // magnetometer every 900 us
  setup.pass(9ms);
  setup.say("205#00");
  setup.say("21F#02");
  setup.say("21E#02");
  setup.pass(100ms);
  CHECK(texts(setup.bottom, 0x604).size() == 1);
  for (const std::uint32_t id : {0x605U, 0x606U, 0x607U}) CHECK(texts(setup.bottom, id).size() == 11);
  CHECK(setup.bottom.frames.size() == 1 + 3 * 11);
  for (std::uint32_t i = 0; i < 8; ++i) CHECK(setup.middle.frames.at(i).id == 0x61F + i);
  CHECK(setup.middle.frames.size() == 8 + 1);
  CHECK(setup.middle.frames.back().id == 0x61E);
  CHECK(setup.top.frames.empty());
  CHECK(setup.robot.next_event() == base::Time{120ms});  // the behaviours': nothing is asked any more
  CHECK_FALSE(setup.robot.waiting());

  CHECK(setup.robot.di_wheel_drive().counters().foreign == 2);
  CHECK(setup.robot.power_management().counters().foreign == 3);
  CHECK(setup.robot.light_ring().counters().foreign == 5);
}

TEST_CASE("a frozen robot says exactly this") {
  sim::WorldOptions options;
  options.frozen = true;
  options.state_of_charge = 0.52;
  options.gyroscope.bias_deg_per_s = 0;
  options.accelerometer.offset_g = 0;
  Setup setup{options};
  for (const auto* request : {"203#02", "204#02", "205#02", "208#02", "209#02", "21E#02"}) setup.say(request);
  setup.pass(10s);
  const auto said = [](const Port& port) {
    std::vector<std::string> result;
    for (const auto& frame : port.frames) result.emplace_back(can::to_text(frame).view());
    return result;
  };
  CHECK(said(setup.bottom) == std::vector<std::string>{"602#0000000000000000", "603#0000000000000000",
                                                       "604#D701761D761DD701",          // 471 7542 7542 471
                                                       "605#00D20000",                  // thesis 7.1: 53760,
                                                       "606#00AAF1FF", "607#003E1700",  // -939520, 1523200
                                                       "608#000000000000", "609#000000000004"});
  CHECK(said(setup.middle) == std::vector<std::string>{"61E#003489005EFC"});  // 52 %, 137 min, -930 mW
}

TEST_CASE("drive: the robot goes where it is sent, and odometry reports it") {
  Setup setup;
  setup.say("203#01640000");      // odometry every 100 ms
  for (int i = 0; i < 10; ++i) {  // a second of 0.1 m/s
    setup.say("201#A086010000000000");
    setup.pass(100ms);
  }
  CHECK(setup.robot.world().pose().x_m == Approx(0.095).margin(0.001));  // the lag costs 5 mm
  const auto odometry = last<amiro::Odometry>(setup.bottom);
  CHECK(odometry.velocity.x_m_per_s() == Approx(0.1).margin(0.0025));
  CHECK(odometry.velocity.z_rad_per_s() == Approx(0).margin(0.04));
  CHECK(odometry.pose.x_m() == Approx(0.095).margin(0.001));
  CHECK(texts(setup.bottom, 0x602).size() == 11);
  CHECK(texts(setup.bottom, 0x603).size() == 11);
}

TEST_CASE("the motors stop half a second after the last command") {
  Setup setup;
  setup.say("201#A086010000000000");
  setup.pass(499ms);
  CHECK(setup.robot.world().wheels().left == Approx(0.1).epsilon(0.001));
  setup.pass(1ms);
  CHECK(setup.robot.di_wheel_drive().counters().timeouts == 1);
  setup.pass(1s);
  CHECK(setup.robot.world().wheels() == boards::WheelSpeeds{});
  CHECK(setup.robot.world().pose().x_m == Approx(0.05).margin(0.0002));
}

TEST_CASE("turning: gyroscope, odometry and truth agree") {
  sim::WorldOptions options;
  options.gyroscope.bias_deg_per_s = 0;
  Setup setup{options};
  setup.say("208#010A0000");  // every 10 ms
  setup.say("203#01");
  double turned_deg = 0;
  for (int i = 0; i < 20; ++i) {
    setup.say("201#0000000040420F00");  // 1 rad/s
    for (int k = 0; k < 10; ++k) {
      setup.pass(10ms);
      turned_deg += last<amiro::Gyroscope>(setup.bottom).z_deg_per_s() * 0.01;
    }
  }
  const double truth = setup.robot.world().pose().heading_rad;
  CHECK(truth == Approx(2 - 0.05).margin(0.001));
  CHECK(turned_deg * sim::degree == Approx(truth).margin(0.01));
  CHECK(last<amiro::Odometry>(setup.bottom).pose.orientation_rad() == Approx(truth).margin(0.005));
}

TEST_CASE("lights: each its own, dark only when told") {
  Setup setup;
  setup.say("23C#FF0000");
  setup.say("243#643278");
  setup.pass(1h);
  CHECK(setup.robot.world().light(0) == boards::Colour{255, 0, 0});
  CHECK(setup.robot.world().light(7) == boards::Colour{100, 50, 120});
  CHECK(setup.robot.world().light(3) == boards::Colour{});
  setup.say("23C#000000");
  CHECK(setup.robot.world().light(0) == boards::Colour{});
  CHECK(setup.robot.light_ring().counters().set_points == 3);
}

TEST_CASE("a part that is taken out: no frames, and counted") {
  Setup setup;
  setup.robot.world().set_absent(sim::Part::gyroscope, true);
  setup.robot.world().set_absent(sim::Part::encoders, true);
  setup.say("208#01640000");
  setup.say("203#01640000");
  setup.pass(1s);
  CHECK(setup.bottom.frames.empty());
  CHECK(setup.robot.di_wheel_drive().counters().not_sampled == 22);
  setup.robot.world().set_absent(sim::Part::gyroscope, false);
  setup.robot.world().set_absent(sim::Part::encoders, false);
  setup.pass(1s);
  CHECK(texts(setup.bottom, 0x608).size() == 10);
  CHECK(texts(setup.bottom, 0x603).size() == 10);
}

TEST_CASE("encoders that fall out stop the odometry's word until they are back") {
  Setup setup;
  setup.say("203#01640000");
  setup.pass(950ms);
  CHECK(texts(setup.bottom, 0x603).size() == 10);
  setup.robot.world().set_absent(sim::Part::encoders, true);
  setup.pass(1s);
  CHECK(texts(setup.bottom, 0x603).size() == 10);
  CHECK(setup.robot.di_wheel_drive().counters().not_sampled == 10);
  setup.robot.world().set_absent(sim::Part::encoders, false);
  setup.pass(1s);
  CHECK(texts(setup.bottom, 0x603).size() == 20);
}

TEST_CASE("a command works from when it came, however long ago the last call was") {
  Setup setup;
  setup.now += 10s;
  setup.say("201#A086010000000000");
  CHECK(setup.robot.world().pose() == sim::default_start);
  setup.pass(100ms);
  CHECK(setup.robot.world().pose().x_m == Approx(0.1 * (0.1 - 0.05 * (1 - std::exp(-2)))).margin(0.0001));
}

TEST_CASE("power status: charging and plugged are two things") {
  sim::WorldOptions options;
  options.plugged = true;
  options.state_of_charge = 0.99;
  Setup setup{options};
  setup.say("21E#02");
  CHECK(last<amiro::PowerStatus>(setup.middle).flags == 3);
  CHECK(last<amiro::PowerStatus>(setup.middle).power == 4070);
  setup.pass(10min);
  setup.say("21E#02");
  CHECK(last<amiro::PowerStatus>(setup.middle).flags == 1);
  CHECK(last<amiro::PowerStatus>(setup.middle).state_of_charge == 100);
}

TEST_CASE("batteries and ambient light: asked once") {
  sim::WorldOptions options;
  options.state_of_charge = 0.52;
  Setup setup{options};
  setup.say("22B#02");
  const auto batteries = last<amiro::Batteries>(setup.middle);
  CHECK(batteries.battery[1] == amiro::BatteriesBattery{3716, -125, 302, 2982});
  setup.say("22D#02");
  CHECK(last<amiro::RingLight>(setup.middle).sensor[7].illuminance_lx() == 300.0);
}

TEST_CASE("each board says that it was switched on") {
  Setup setup;
  for (const auto* request : {"DiWheelDriveStatus", "PowerManagementStatus", "LightRingStatus"}) {
    const std::string name = request;
    const auto id = name[0] == 'D'   ? amiro::DiWheelDriveStatus::id
                    : name[0] == 'P' ? amiro::PowerManagementStatus::id
                                     : amiro::LightRingStatus::id;
    setup.robot.receive({0x200U + id.value, 1, {2}}, setup.now);
    setup.robot.advance(setup.now);
  }
  CHECK(static_cast<unsigned>(last<amiro::DiWheelDriveStatus>(setup.bottom).identity.reset) == 1);
  CHECK(static_cast<unsigned>(last<amiro::PowerManagementStatus>(setup.middle).identity.reset) == 1);
  CHECK(static_cast<unsigned>(last<amiro::LightRingStatus>(setup.top).identity.reset) == 1);
}

TEST_CASE("a robot waits where any of its boards does") {
  for (int board = 0; board < 3; ++board) {
    CAPTURE(board);
    Setup setup;
    Port* const ports[] = {&setup.bottom, &setup.middle, &setup.top};
    for (Port* port : ports) port->room = 0;
    const unsigned ids[] = {amiro::DiWheelDriveStatus::id.value, amiro::PowerManagementStatus::id.value,
                            amiro::LightRingStatus::id.value};
    setup.robot.receive({0x200U + ids[board], 1, {2}}, setup.now);
    setup.robot.advance(setup.now);
    CHECK(setup.robot.waiting());
    ports[board]->room = 100;
    setup.robot.advance(setup.now);
    CHECK_FALSE(setup.robot.waiting());
  }
}

TEST_CASE("a command that comes when the last one's time is over is in time") {
  Setup setup;
  setup.say("201#A086010000000000");
  setup.now += 500ms;
  setup.say("201#A086010000000000");
  CHECK(setup.robot.di_wheel_drive().counters().timeouts == 0);
  CHECK(setup.robot.world().wheels().left == Approx(0.1).epsilon(0.001));
}

TEST_CASE("a full bus is waited for") {
  Setup setup;
  setup.middle.room = 3;
  setup.say("21F#02");
  CHECK(setup.robot.waiting());
  setup.middle.room = 8;
  setup.robot.advance(setup.now);
  CHECK_FALSE(setup.robot.waiting());
  CHECK(setup.middle.frames.size() == 8);
}

TEST_CASE("a day passes: the batteries are empty, and that is all") {
  Setup setup;
  setup.pass(24h);
  setup.say("21E#02");
  const auto power = last<amiro::PowerStatus>(setup.middle);
  CHECK(power.state_of_charge == 0);
  CHECK(power.minutes == amiro::PowerStatus::minutes_unknown);  // nothing flows: no telling
  CHECK(setup.robot.world().pose() == sim::default_start);
}

TEST_CASE("two robots with one seed say the same, frame for frame, however they are called") {
  Setup a, b;
  for (Setup* setup : {&a, &b}) {
    for (const auto* request : {"208#010A0000", "209#01070000", "21F#01140000", "203#01", "21E#01"})
      setup->say(request);
    for (int i = 0; i < 30; ++i) {
      setup->say(i % 3 == 0 ? "201#404B4C0080841E00" : "201#30750000C0BDF0FF");
      if (setup == &a)
        setup->pass(100ms);
      else
        for (int k = 0; k < 1000; ++k) setup->pass(100us);
    }
  }
  CHECK(a.bottom.frames.size() > 700);
  CHECK(a.bottom.frames == b.bottom.frames);
  CHECK(a.middle.frames == b.middle.frames);
}

}  // namespace sim_robot_test
