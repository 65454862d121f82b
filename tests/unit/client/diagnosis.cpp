#include "ocm/client/diagnosis.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

namespace client_diagnosis_test {

using namespace ocm::client;
using ocm::protocol::Priority;
using Reason = amiro::DiWheelDriveRefusal::Reason;

/// A robot's frames on their way to a diagnosis.
struct Patient {
  Receiver receiver{amiro::catalogue};
  Diagnosis diagnosis{amiro::catalogue};

  template <class T>
  void say(const T& sample) {
    for (std::size_t i = 0; i < T::frames.size(); ++i)
      diagnosis.take(receiver.take({{}, ocm::protocol::sample_frame(sample, Priority::low, i)}));
  }
  template <class Status>
  static Status healthy() {
    Status status;
    status.identity.uptime = 12;
    status.identity.reset = decltype(status.identity.reset){1};
    status.identity.wire_hash = amiro::wire_hash;
    status.health.load = 4;
    return status;
  }
  void all_healthy() {
    say(healthy<amiro::DiWheelDriveStatus>());
    say(healthy<amiro::PowerManagementStatus>());
    say(healthy<amiro::LightRingStatus>());
    amiro::PowerStatus power;
    power.state_of_charge = 90;
    say(power);
  }
  /// "severity board: what"
  [[nodiscard]] std::vector<std::string> findings() const {
    std::vector<std::string> lines;
    for (const Finding& f : diagnosis.findings())
      lines.push_back(std::string{name(f.severity)} + " " + std::string{f.board} + ": " + f.what);
    return lines;
  }
};

using Lines = std::vector<std::string>;

TEST_CASE("diagnosis: a healthy robot has no findings") {
  Patient robot;
  robot.all_healthy();
  CHECK(robot.findings().empty());
  const BoardReport& board = robot.diagnosis.boards()[0];
  CHECK(board.answered);
  CHECK(board.uptime_s == 12);
  CHECK(board.reset == "power");
  CHECK(board.bus == "active");
  CHECK(board.load == 4);
  CHECK(robot.diagnosis.battery().state_of_charge == 90);
}

TEST_CASE("diagnosis: before anything came all numbers are zero") {
  const Patient robot;
  for (const BoardReport& board : robot.diagnosis.boards()) {
    CHECK_FALSE(board.heard);
    CHECK_FALSE(board.answered);
    CHECK_FALSE(board.load);
    for (const std::int64_t number :
         {board.uptime_s, board.wire_hash, board.publishing, board.faults, board.overload, board.bus_errors,
          board.refused, board.refused_topic, board.line_lost})
      CHECK(number == 0);
  }
  CHECK_FALSE(robot.diagnosis.battery().answered);
  CHECK(robot.diagnosis.battery().state_of_charge == 0);
  CHECK_FALSE(robot.diagnosis.battery().plugged);
  const BatteryMeasurement none{};
  CHECK_FALSE(none.present);
  for (const double number : {none.voltage_v, none.current_a, none.remaining_mah, none.temperature_celsius})
    CHECK(number == 0);
}

TEST_CASE("diagnosis: no board answers") {
  const Patient robot;
  CHECK(robot.findings() == Lines{"problem : no board answers"});
  CHECK(robot.diagnosis.findings()[0].remedy.ends_with("is its bit rate 500000 bit/s?"));
}

TEST_CASE("diagnosis: a board that sends without a status answers, too") {
  Patient robot;
  robot.say(amiro::ProximityRing{});
  CHECK(robot.findings() == Lines{"problem di_wheel_drive: does not answer",
                                  "problem light_ring: does not answer",
                                  "warning power_management: sends, and does not say how it is"});
  Patient first;
  first.say(amiro::Gyroscope{});
  CHECK(first.findings() == Lines{"problem power_management: does not answer",
                                  "problem light_ring: does not answer",
                                  "warning di_wheel_drive: sends, and does not say how it is"});
}

TEST_CASE("diagnosis: one board is missing, another has an older firmware") {
  Patient robot;
  robot.say(Patient::healthy<amiro::DiWheelDriveStatus>());
  robot.say(amiro::ProximityRing{});  // power_management sends, but no status
  CHECK(robot.findings() == Lines{"problem light_ring: does not answer",
                                  "warning power_management: sends, and does not say how it is"});
}

TEST_CASE("diagnosis: of boards that were not asked nothing is found") {
  const auto found = [](const Patient& robot, std::vector<std::size_t> asked) {
    Lines lines;
    for (const Finding& f : robot.diagnosis.findings(
             [&](std::size_t board) { return std::find(asked.begin(), asked.end(), board) != asked.end(); }))
      lines.push_back(std::string{f.board} + ": " + f.what);
    return lines;
  };
  Patient robot;
  CHECK(found(robot, {}).empty());
  CHECK(found(robot, {2}) == Lines{"light_ring: does not answer"});
  CHECK(found(robot, {1, 2}) == Lines{"power_management: does not answer", "light_ring: does not answer"});
  CHECK(found(robot, {0, 1, 2}) == Lines{": no board answers"});
  robot.say(amiro::ProximityRing{});  // power_management sends
  CHECK(found(robot, {}).empty());
  CHECK(found(robot, {0}) == Lines{"di_wheel_drive: does not answer"});
  CHECK(found(robot, {1}) == Lines{"power_management: sends, and does not say how it is"});
  auto status = Patient::healthy<amiro::LightRingStatus>();
  status.health.load = 95;
  robot.say(status);  // what a board says of itself counts, asked or not
  CHECK(found(robot, {}) == Lines{"light_ring: its CPU is busy for 95 % of the time"});
}

TEST_CASE("diagnosis: which boards were asked, by any program") {
  using namespace std::chrono_literals;
  constexpr ocm::base::Time begin{1000s};
  const auto& status = *amiro::catalogue.find("light_ring_status");
  Receiver receiver{amiro::catalogue};
  StatusRequests requests{amiro::catalogue};
  const auto hear = [&](const ocm::can::Frame& frame, ocm::base::Time at) {
    const ocm::can::Received received{at, frame};
    requests.take(received, receiver.take(received));
  };
  hear(ocm::protocol::stop(status.id), begin);                 // is answered by nothing
  hear(*ocm::protocol::publish_every(status.id, 10s), begin);  // later, perhaps
  hear(ocm::protocol::once(amiro::catalogue.find("light_ring_refusal")->id), begin);
  hear(ocm::protocol::once(amiro::Gyroscope::id), begin);
  hear(ocm::protocol::command(amiro::Motors{}), begin);
  auto no_such_mode = ocm::protocol::once(status.id);
  no_such_mode.data[0] = 7;
  hear(no_such_mode, begin);
  for (std::size_t board = 0; board < 3; ++board) CHECK_FALSE(requests.any(board));
  hear(ocm::protocol::once(status.id), begin);
  hear(ocm::protocol::once(status.id), begin + 400ms);  // the first one counts
  CHECK(requests.any(2));
  CHECK_FALSE(requests.any(0));
  CHECK_FALSE(requests.is_due(2, begin + 499ms));  // it may answer still
  CHECK(requests.is_due(2, begin + 500ms));
  CHECK_FALSE(requests.is_due(0, begin + 1h));
}

TEST_CASE("diagnosis: a board of another spec") {
  Patient robot;
  robot.all_healthy();
  auto status = Patient::healthy<amiro::LightRingStatus>();
  status.identity.wire_hash ^= 1;
  robot.say(status);
  CHECK(robot.findings() ==
        Lines{"problem light_ring: was built from another spec: its numbers may mean something else"});
}

TEST_CASE("diagnosis: what ails a board, the worst first") {
  Patient robot;
  robot.all_healthy();
  auto status = Patient::healthy<amiro::DiWheelDriveStatus>();
  status.identity.reset = amiro::DiWheelDriveStatusIdentity::Reset::watchdog;
  status.health.bus = amiro::DiWheelDriveStatusHealth::Bus::passive;
  status.health.load = 95;
  status.health.publishing = 0b01000;  // odometry, floor_proximity, magnetometer, gyroscope, accelerometer
  status.health.faults = 0b10100;
  status.health.overload = 7;
  status.health.bus_errors = 40;
  robot.say(status);
  robot.say(amiro::DiWheelDriveRefusal{0x08, Reason::bad_period, 2, 0, 3});
  CHECK(robot.findings() ==
        Lines{
            "warning di_wheel_drive: its CAN controller is in state passive",
            "warning di_wheel_drive: no answer from the part behind magnetometer, accelerometer",
            "warning di_wheel_drive: 7 releases came late or not at all",
            "warning di_wheel_drive: its CPU is busy for 95 % of the time",
            "warning di_wheel_drive: it started again because of a watchdog",
            "warning di_wheel_drive: 3 times so far a frame or a character of a host on its serial line was "
            "lost",
            "note di_wheel_drive: 40 errors on the bus or frames given up so far",
            "note di_wheel_drive: 2 requests refused so far, the last for gyroscope: bad_period",
        });
  CHECK(robot.diagnosis.publishes(*amiro::catalogue.find("gyroscope")));
  CHECK(!robot.diagnosis.publishes(*amiro::catalogue.find("odometry")));
  CHECK(!robot.diagnosis.publishes(*amiro::catalogue.find("motors")));
}

TEST_CASE("diagnosis: an unknown load is not a high one") {
  Patient robot;
  robot.all_healthy();
  auto status = Patient::healthy<amiro::LightRingStatus>();
  status.health.load = amiro::LightRingStatusHealth::load_unknown;
  robot.say(status);
  CHECK(robot.findings().empty());
  CHECK(!robot.diagnosis.boards()[2].load);
}

TEST_CASE("diagnosis: numbers without a name are no names") {
  Patient robot;
  robot.all_healthy();
  auto status = Patient::healthy<amiro::LightRingStatus>();
  status.identity.reset = decltype(status.identity.reset){200};
  status.health.bus = decltype(status.health.bus){9};
  robot.say(status);
  CHECK(robot.diagnosis.boards()[2].reset.empty());
  CHECK(robot.findings() == Lines{"warning light_ring: its CAN controller is in state ?"});
}

TEST_CASE("diagnosis: the battery") {
  struct Case {
    std::uint8_t percent;
    bool plugged;
    Lines expected;
  };
  const auto [percent, plugged, expected] =
      GENERATE(Case{21, false, {}}, Case{20, false, {"warning power_management: the battery has 20 % left"}},
               Case{11, false, {"warning power_management: the battery has 11 % left"}},
               Case{10, false, {"problem power_management: the battery has 10 % left"}}, Case{10, true, {}});
  Patient robot;
  robot.all_healthy();
  amiro::PowerStatus power;
  power.state_of_charge = percent;
  power.set_plugged(plugged);
  robot.say(power);
  CHECK(robot.findings() == expected);
}

TEST_CASE("diagnosis: each battery by itself") {
  Patient robot;
  robot.all_healthy();
  CHECK(robot.diagnosis.batteries().topic == amiro::catalogue.find("batteries"));
  CHECK(robot.diagnosis.batteries().all.empty());
  amiro::Batteries batteries;
  const auto say = [&](double front_celsius, double behind_celsius) {
    for (auto& battery : batteries.battery) battery.set_voltage_V(3.8);
    batteries.battery[0].set_current_A(-0.25);
    batteries.battery[0].set_remaining_mAh(551);
    batteries.battery[0].set_temperature_celsius(front_celsius);
    batteries.battery[1].set_temperature_celsius(behind_celsius);
    robot.say(batteries);
  };
  say(59.9, -19.9);
  CHECK(robot.findings().empty());
  REQUIRE(robot.diagnosis.batteries().all.size() == 2);
  const auto& front = robot.diagnosis.batteries().all[0];
  CHECK(front.name == "battery_1");
  CHECK(front.present);
  CHECK(front.voltage_v == Approx(3.8));
  CHECK(front.current_a == Approx(-0.25));
  CHECK(front.remaining_mah == 551);
  CHECK(front.temperature_celsius == Approx(59.9).margin(0.06));
  say(60.1, -20.1);
  CHECK(robot.findings() == Lines{"warning power_management: battery_1 is too hot",
                                  "warning power_management: battery_2 is too cold"});
  CHECK(robot.diagnosis.findings()[0].ailment == Ailment::battery_temperature);
  batteries.battery[1] = {};
  robot.say(batteries);
  CHECK(robot.findings() == Lines{"warning power_management: battery_1 is too hot",
                                  "note power_management: battery_2 is not inserted"});
  CHECK(robot.diagnosis.findings()[1].ailment == Ailment::no_battery);
  CHECK_FALSE(robot.diagnosis.batteries().all[1].present);
}

TEST_CASE("diagnosis: a frame is of a battery by the names and the units of its fields") {
  const auto& batteries = *amiro::catalogue.find("batteries");
  const auto topic_of = [&](std::string_view name, std::string_view unit) {
    std::vector<ocm::protocol::Field> fields{batteries.frames[0].fields.begin(),
                                             batteries.frames[0].fields.end()};
    for (auto& field : fields)
      if (field.name == "voltage") field.name = name, field.unit = unit;
    auto frame = batteries.frames[0];
    frame.fields = fields;
    const std::vector frames{frame};
    auto topic = batteries;
    topic.frames = frames;
    const std::vector topics{topic};
    const ocm::protocol::Catalogue catalogue{"other", 500'000, amiro::catalogue.boards, topics};
    return Diagnosis{catalogue}.batteries().topic != nullptr;
  };
  CHECK(topic_of("voltage", "V"));
  CHECK_FALSE(topic_of("voltage", "mV"));
  CHECK_FALSE(topic_of("reserve", "V"));
}

TEST_CASE("diagnosis: a battery that says its charge in the first of two frames, and nothing of a charger") {
  using ocm::protocol::Field;
  const auto& power = *amiro::catalogue.find("power_status");
  std::vector<Field> charge, others;
  for (const Field& field : power.frames[0].fields) {
    if (field.flags) continue;
    (field.name == "state_of_charge" ? charge : others).push_back(field);
  }
  auto first = power.frames[0], second = power.frames[0];
  first.name = "charge";
  first.fields = charge;
  second.name = "others";
  second.id.value += 1;
  second.fields = others;
  const std::vector frames{first, second};
  auto topic = power;
  topic.frames = frames;
  const std::vector topics{topic};
  const ocm::protocol::Catalogue catalogue{"other", 500'000, amiro::catalogue.boards, topics};
  Receiver receiver{catalogue};
  Diagnosis diagnosis{catalogue};
  amiro::PowerStatus empty;
  empty.state_of_charge = 7;
  auto frame = ocm::protocol::sample_frame(empty, Priority::low, 0);
  diagnosis.take(receiver.take({{}, frame}));
  CHECK_FALSE(diagnosis.battery().answered);
  frame.id += 1;
  diagnosis.take(receiver.take({{}, frame}));
  REQUIRE(diagnosis.battery().answered);
  CHECK(diagnosis.battery().state_of_charge == 7);
  CHECK_FALSE(diagnosis.battery().plugged);
  REQUIRE(diagnosis.findings().size() == 1);
  CHECK(diagnosis.findings()[0].severity == Severity::problem);
  CHECK(diagnosis.findings()[0].ailment == Ailment::battery_low);
}

TEST_CASE("diagnosis: of a status counts what each frame says itself, and what none says is zero") {
  using ocm::protocol::Field;
  const auto& whole = *amiro::catalogue.find("light_ring_status");
  REQUIRE(whole.frames.size() == 2);
  const auto field_of = [&](std::size_t frame, std::string_view name) {
    const auto fields = whole.frames[frame].fields;
    return *std::find_if(fields.begin(), fields.end(),
                         [name](const Field& field) { return field.name == name; });
  };
  Field other_load = field_of(0, "uptime");
  other_load.name = "load";
  Field reset = field_of(0, "reset");
  reset.flags = true;  // names of bits, of which several may be set, are no cause
  const std::vector<Field> identity{other_load, reset}, health{field_of(1, "load")};
  auto first = whole.frames[0], second = whole.frames[1];
  first.fields = identity;
  second.fields = health;
  const std::vector frames{first, second};
  auto topic = whole;
  topic.frames = frames;
  const std::vector topics{topic};
  const ocm::protocol::Catalogue sparse{"sparse", 500'000, amiro::catalogue.boards, topics};
  Receiver receiver{sparse};
  Diagnosis diagnosis{sparse};
  auto status = Patient::healthy<amiro::LightRingStatus>();
  status.health.load = 4;
  for (std::size_t i = 0; i < status.frames.size(); ++i)
    diagnosis.take(receiver.take({{}, ocm::protocol::sample_frame(status, Priority::low, i)}));
  const BoardReport& board = diagnosis.boards()[2];
  REQUIRE(board.answered);
  CHECK(board.load == 4);
  CHECK(board.reset.empty());
  CHECK(board.bus.empty());
  for (const std::int64_t number :
       {board.uptime_s, board.wire_hash, board.publishing, board.faults, board.overload, board.bus_errors})
    CHECK(number == 0);
}

TEST_CASE("diagnosis: a topic of a board that the catalogue lacks is passed over") {
  const auto boards = amiro::catalogue.boards.first(1);
  const ocm::protocol::Catalogue lacking{"lacking", 500'000, boards, amiro::catalogue.topics};
  Receiver receiver{lacking};
  Diagnosis diagnosis{lacking};
  amiro::PowerStatus power;  // of the second board
  diagnosis.take(receiver.take({{}, ocm::protocol::sample_frame(power, Priority::low, 0)}));
  CHECK(diagnosis.boards().size() == 1);
  CHECK_FALSE(diagnosis.battery().answered);
  const auto& of_no_board = *lacking.find("power_status");
  CHECK((!diagnosis.publishes(of_no_board) && !diagnosis.is_silent(of_no_board)));
  StatusRequests requests{lacking};
  const ocm::can::Received request{{}, ocm::protocol::once(amiro::PowerManagementStatus::id)};
  requests.take(request, receiver.take(request));
  CHECK_FALSE(requests.any(0));
}

TEST_CASE("diagnosis: bits behind those of a board's sensors name nothing") {
  const Diagnosis diagnosis{amiro::catalogue};
  CHECK(diagnosis.sensors_of(2, 0xFF) == "light_ring_status, light_ring_refusal");
  CHECK(diagnosis.sensors_of(2, 0xFC).empty());
}

TEST_CASE("diagnosis: a battery is too hot or too cold at the limit, and not a degree before it") {
  const auto& batteries = *amiro::catalogue.find("batteries");
  std::vector<ocm::protocol::Field> fields{batteries.frames[0].fields.begin(),
                                           batteries.frames[0].fields.end()};
  for (auto& field : fields) {
    if (field.name != "temperature") continue;
    field.is_signed = true;
    field.scale = {1, 0};
    field.offset = {};
  }
  auto layout = batteries.frames[0];
  layout.fields = fields;
  const std::vector layouts{layout};
  auto topic = batteries;
  topic.frames = layouts;
  const std::vector topics{topic};
  const ocm::protocol::Catalogue whole_degrees{"other", 500'000, amiro::catalogue.boards, topics};
  const auto found = [&](int degrees) {
    amiro::Batteries sample;
    sample.battery[0].set_voltage_V(3.8);
    sample.battery[0].temperature = static_cast<std::uint16_t>(degrees);
    Receiver receiver{whole_degrees};
    Diagnosis diagnosis{whole_degrees};
    diagnosis.take(receiver.take({{}, ocm::protocol::sample_frame(sample, Priority::low, 0)}));
    REQUIRE(diagnosis.batteries().all.size() == 1);
    CHECK(diagnosis.batteries().all[0].temperature_celsius == degrees);
    std::string all;
    for (const Finding& finding : diagnosis.findings()) all += finding.what + ": " + finding.remedy;
    return all;
  };
  CHECK(found(59).empty());
  CHECK(found(60) == "battery_1 is too hot: switch the robot off and let it cool");
  CHECK(found(-19).empty());
  CHECK(found(-20) == "battery_1 is too cold: let it get warm before it is used");
}

TEST_CASE("diagnosis: each finding by itself, at its limit and before it") {
  using Status = amiro::DiWheelDriveStatus;
  using Bus = amiro::DiWheelDriveStatusHealth::Bus;
  using Reset = amiro::DiWheelDriveStatusIdentity::Reset;
  struct Case {
    void (*ail)(Status&);
    Lines expected;
    Ailment ailment = Ailment::other;
    std::string_view remedy{};
  };
  const Case cases[] = {
      {[](Status& s) { s.health.load = 89; }, {}},
      {[](Status& s) { s.health.load = 90; },
       {"warning di_wheel_drive: its CPU is busy for 90 % of the time"},
       Ailment::busy,
       "ask for longer periods, or for fewer topics"},
      {[](Status& s) { s.health.overload = 1; },
       {"warning di_wheel_drive: 1 release came late or not at all"},
       Ailment::overload,
       "ask for longer periods"},
      {[](Status& s) {
         s.health.overload = 2;
         s.health.publishing = 0b11;
       },
       {"warning di_wheel_drive: 2 releases came late or not at all"},
       Ailment::overload,
       "ask for longer periods; it publishes odometry, floor_proximity"},
      {[](Status& s) { s.health.bus_errors = 1; },
       {"note di_wheel_drive: 1 error on the bus or frames given up so far"},
       Ailment::bus_errors},
      {[](Status& s) { s.health.faults = 1; },
       {"warning di_wheel_drive: no answer from the part behind odometry"},
       Ailment::part_faults},
      {[](Status& s) { s.health.bus = Bus::warning; },
       {"warning di_wheel_drive: its CAN controller is in state warning"},
       Ailment::bus_state},
      {[](Status& s) { s.health.bus = Bus::off; },
       {"problem di_wheel_drive: its CAN controller is in state off"},
       Ailment::bus_state},
      {[](Status& s) { s.identity.reset = Reset::fault; },
       {"warning di_wheel_drive: it started again because of a fault"},
       Ailment::restarted},
      {[](Status& s) { s.identity.reset = Reset::watchdog; },
       {"warning di_wheel_drive: it started again because of a watchdog"},
       Ailment::restarted},
      {[](Status& s) { s.identity.reset = Reset::memory_fault; },
       {"warning di_wheel_drive: it started again because of a memory fault of its processor"},
       Ailment::restarted},
      {[](Status& s) { s.identity.reset = Reset::bus_fault; },
       {"warning di_wheel_drive: it started again because of a bus fault of its processor"},
       Ailment::restarted},
      {[](Status& s) { s.identity.reset = Reset::usage_fault; },
       {"warning di_wheel_drive: it started again because of a usage fault of its processor"},
       Ailment::restarted},
      {[](Status& s) { s.identity.reset = Reset::kernel_halt; },
       {"warning di_wheel_drive: it started again because of a halt of its kernel"},
       Ailment::restarted},
      {[](Status& s) { s.identity.reset = Reset::clock_failure; },
       {"warning di_wheel_drive: it started again because of a failure of its clock"},
       Ailment::restarted,
       "have the board's crystal checked"},
      {[](Status& s) { s.identity.reset = Reset::pin; }, {}},
      {[](Status& s) { s.identity.reset = Reset::software; }, {}},
      {[](Status& s) { s.identity.reset = Reset::low_power; }, {}},
      {[](Status& s) { s.identity.wire_hash += 1; },
       {"problem di_wheel_drive: was built from another spec: its numbers may mean something else"},
       Ailment::foreign_spec},
  };
  for (const Case& one : cases) {
    Patient robot;
    robot.all_healthy();
    auto status = Patient::healthy<Status>();
    one.ail(status);
    robot.say(status);
    CHECK(robot.findings() == one.expected);
    for (const Finding& finding : robot.diagnosis.findings()) {
      CHECK(finding.ailment == one.ailment);
      if (!one.remedy.empty()) CHECK(finding.remedy == one.remedy);
    }
  }
}

TEST_CASE("diagnosis: refusals, by what the last one was for") {
  struct Case {
    std::uint8_t topic;
    Reason reason;
    std::uint16_t count;
    Lines expected;
    Ailment ailment;
  };
  const Case cases[] = {
      {0x08, Reason::bad_mode, 0, {}, Ailment::other},  // none so far
      {0x08,
       Reason::bad_mode,
       1,
       {"note di_wheel_drive: 1 request refused so far, the last for gyroscope: bad_mode"},
       Ailment::refusals},
      {0x08,
       Reason::not_schedulable,
       3,
       {"note di_wheel_drive: 3 requests refused so far, the last for gyroscope: not_schedulable"},
       Ailment::not_schedulable},
      {0xF0,
       Reason::not_schedulable,
       1,
       {"note di_wheel_drive: 1 request refused so far, the last for ?: not_schedulable"},
       Ailment::refusals},
      {0x08,
       Reason{200},
       1,
       {"note di_wheel_drive: 1 request refused so far, the last for gyroscope: ?"},
       Ailment::refusals},
  };
  for (const Case& one : cases) {
    Patient robot;
    robot.all_healthy();
    robot.say(amiro::DiWheelDriveRefusal{one.topic, one.reason, one.count, 0});
    CHECK(robot.findings() == one.expected);
    for (const Finding& finding : robot.diagnosis.findings()) {
      CHECK(finding.ailment == one.ailment);
      CHECK(finding.topic == (one.topic == 0x08 ? "gyroscope" : ""));
    }
  }
}

TEST_CASE("diagnosis: what a board publishes, what it does not, and what it has not said") {
  Patient robot;
  const auto& gyroscope = *amiro::catalogue.find("gyroscope");
  const auto& odometry = *amiro::catalogue.find("odometry");
  CHECK((!robot.diagnosis.publishes(gyroscope) && !robot.diagnosis.is_silent(gyroscope)));
  auto status = Patient::healthy<amiro::DiWheelDriveStatus>();
  status.health.publishing = 0b01000;
  robot.say(status);
  CHECK((robot.diagnosis.publishes(gyroscope) && !robot.diagnosis.is_silent(gyroscope)));
  CHECK((!robot.diagnosis.publishes(odometry) && robot.diagnosis.is_silent(odometry)));
  CHECK(!robot.diagnosis.is_silent(*amiro::catalogue.find("proximity_ring")));  // of a board that is silent
  CHECK(!robot.diagnosis.is_silent(*amiro::catalogue.find("motors")));          // no sensor
  robot.say(Patient::healthy<amiro::LightRingStatus>());
  const auto& led = *amiro::catalogue.find("led_1");  // none either, of a board with few of them
  CHECK((!robot.diagnosis.publishes(led) && !robot.diagnosis.is_silent(led)));
}

TEST_CASE("diagnosis: a board with more sensors than its status has bits: of those beyond nothing is known") {
  std::vector<ocm::protocol::Topic> topics{amiro::catalogue.topics.begin(), amiro::catalogue.topics.end()};
  std::vector<const ocm::protocol::Topic*> sensors;
  for (auto& topic : topics) {
    if (topic.kind != ocm::protocol::Kind::sensor) continue;
    topic.board = 0;
    if (topic.role == ocm::protocol::Role::status && topic.name != "di_wheel_drive_status")
      topic.role = ocm::protocol::Role::none;
    sensors.push_back(&topic);
  }
  REQUIRE(sensors.size() > 8);
  const ocm::protocol::Catalogue crowded{"crowded", 500'000, amiro::catalogue.boards, topics};
  Receiver receiver{crowded};
  Diagnosis diagnosis{crowded};
  auto status = Patient::healthy<amiro::DiWheelDriveStatus>();
  status.health.publishing = 0x40;
  for (std::size_t i = 0; i < status.frames.size(); ++i)
    diagnosis.take(receiver.take({{}, ocm::protocol::sample_frame(status, Priority::low, i)}));
  REQUIRE(diagnosis.boards()[0].answered);
  CHECK(diagnosis.publishes(*sensors[6]));
  CHECK(diagnosis.is_silent(*sensors[7]));
  CHECK_FALSE(diagnosis.is_silent(*sensors[8]));
  CHECK_FALSE(diagnosis.publishes(*sensors[8]));
  const std::string names = diagnosis.sensors_of(0, 0x1FF);
  CHECK(std::count(names.begin(), names.end(), ',') == 7);
}

TEST_CASE("diagnosis: requests and set points say nothing about a board") {
  Patient robot;
  robot.diagnosis.take(robot.receiver.take({{}, ocm::protocol::once(amiro::Gyroscope::id)}));
  robot.diagnosis.take(robot.receiver.take({{}, ocm::protocol::command(amiro::Motors{})}));
  // And so do frames of no topic, and reports of the controller.
  robot.diagnosis.take(robot.receiver.take({{}, ocm::can::Frame{.id = 0x7FF}}));
  robot.diagnosis.take(
      robot.receiver.take({{}, ocm::can::Frame{.id = 4, .dlc = 8, .format = ocm::can::Format::error}}));
  for (const BoardReport& board : robot.diagnosis.boards()) CHECK(!board.heard);
}

TEST_CASE("diagnosis: a robot without status topics has nothing to find") {
  constexpr ocm::protocol::Catalogue bare{"bare", 500'000, amiro::catalogue.boards, {}};
  CHECK(Diagnosis{bare}.findings().empty());
}

}  // namespace client_diagnosis_test
