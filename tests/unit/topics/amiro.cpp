// Frames of the robot, typed by hand from the thesis; the codec must agree byte by byte.
#include "ocm/topics/amiro.hpp"

#include <limits>

#include <catch2/catch.hpp>

#include "ocm/can/bit_timing.hpp"
#include "ocm/protocol/message.hpp"

namespace topics_amiro_test {

using namespace amiro;
using ocm::can::Frame;
using ocm::can::Payload;
using ocm::protocol::Priority;

constexpr double exactly(std::int64_t digits, double divisor) {
  return static_cast<double>(digits) / divisor;
}

TEST_CASE("gyroscope: 65532 on the wire is -0.07 deg/s") {  // [Thesis figure 6.3, which prints it raw]
  constexpr Gyroscope g = Gyroscope::decode(Payload{0x3E, 0x00, 0x1E, 0x00, 0xFC, 0xFF});
  STATIC_REQUIRE(g == Gyroscope{62, 30, -4});
  STATIC_REQUIRE(g.x_deg_per_s() == 1.085);
  STATIC_REQUIRE(g.y_deg_per_s() == 0.525);
  STATIC_REQUIRE(g.z_deg_per_s() == -0.07);
  STATIC_REQUIRE(g.encode() == Payload{0x3E, 0x00, 0x1E, 0x00, 0xFC, 0xFF});
  STATIC_REQUIRE(ocm::protocol::sample_frame(g) == Frame{0x608, 6, {0x3E, 0x00, 0x1E, 0x00, 0xFC, 0xFF}});
  // 3 * 0.0175 in binary is 0.052500000000000005
  STATIC_REQUIRE(Gyroscope{3, 0, 0}.x_deg_per_s() == 0.0525);
}

TEST_CASE("gyroscope: setters round to nearest and stay within +-500 deg/s") {
  constexpr auto set = [](double value) {
    Gyroscope g;
    g.set_x_deg_per_s(value);
    return g.x;
  };
  STATIC_REQUIRE(set(-0.07) == -4);
  STATIC_REQUIRE(set(0.0262) == 1);
  STATIC_REQUIRE(set(0.0263) == 2);
  STATIC_REQUIRE(set(500) == 28571);
  STATIC_REQUIRE(set(1e9) == 28571);
  STATIC_REQUIRE(set(-1e9) == -28571);
}

TEST_CASE("accelerometer: 1024 is 1 g, 65534 is -1/512 g") {  // [Thesis figure 6.3]
  constexpr auto a = Accelerometer::decode(Payload{0x1A, 0x00, 0xFE, 0xFF, 0x00, 0x04});
  STATIC_REQUIRE(a == Accelerometer{26, -2, 1024});
  STATIC_REQUIRE(a.x_g() == 0.025390625);
  STATIC_REQUIRE(a.y_g() == -0.001953125);
  STATIC_REQUIRE(a.z_g() == 1.0);
  STATIC_REQUIRE(ocm::protocol::sample_frame(a) == Frame{0x609, 6, {0x1A, 0x00, 0xFE, 0xFF, 0x00, 0x04}});
}

TEST_CASE("magnetometer: three frames, 1 uG a bit") {  // [Thesis figure 7.2: 53760, -939520, 1523200]
  constexpr std::array<Payload, 3> wire{Payload{0x00, 0xD2, 0x00, 0x00}, Payload{0x00, 0xAA, 0xF1, 0xFF},
                                        Payload{0x00, 0x3E, 0x17, 0x00}};
  constexpr auto m = Magnetometer::decode(wire);
  STATIC_REQUIRE(m == Magnetometer{{53760}, {-939520}, {1523200}});
  STATIC_REQUIRE(m.x.field_gauss() == 0.05376);
  STATIC_REQUIRE(m.y.field_gauss() == -0.93952);
  STATIC_REQUIRE(m.z.field_gauss() == 1.5232);
  for (std::size_t i = 0; i < wire.size(); ++i) CHECK(m.encode(i) == wire[i]);
  STATIC_REQUIRE(ocm::protocol::sample_frame(m, Priority::medium, 1) == Frame{0x606, 4, wire[1]});
  STATIC_REQUIRE(m.encode(3) == Payload{});
}

TEST_CASE("batteries: millivolts, milliamperes, milliampere-hours and tenths of a kelvin") {
  // [BQ27500 data sheet, table 4-1]
  Batteries batteries;
  batteries.battery[0] = {3'812, -122, 551, 2982};
  CHECK(batteries.battery[0].voltage_V() == 3.812);
  CHECK(batteries.battery[0].current_A() == -0.122);
  CHECK(batteries.battery[0].remaining_mAh() == 551.0);
  CHECK(batteries.battery[0].temperature_celsius() == 25.05);
  CHECK(batteries.battery[1].voltage == BatteriesBattery::voltage_no_battery);
  const Payload front{0xE4, 0x0E, 0x86, 0xFF, 0x27, 0x02, 0xA6, 0x0B};
  CHECK(ocm::protocol::sample_frame(batteries, Priority::medium, 0) == Frame{0x62B, 8, front});
  CHECK(ocm::protocol::sample_frame(batteries, Priority::medium, 1) == Frame{0x62C, 8, {}});
  CHECK(Batteries::decode({front, Payload{}}) == batteries);
}

TEST_CASE("ring light: a quarter of a lux a count") {  // [VCNL4020 data sheet]
  RingLight light;
  light.sensor[7].illuminance = 0x04B1;
  CHECK(light.sensor[7].illuminance_lx() == 300.25);
  CHECK(ocm::protocol::sample_frame(light, Priority::medium, 7) == Frame{0x634, 2, {0xB1, 0x04}});
}

TEST_CASE("floor proximity: four counts") {  // [Thesis figure 7.2: 5184, 0, 188, 0]
  constexpr auto f = FloorProximity::decode(Payload{0x40, 0x14, 0x00, 0x00, 0xBC, 0x00, 0x00, 0x00});
  STATIC_REQUIRE(f == FloorProximity{5184, 0, 188, 0});
  STATIC_REQUIRE(ocm::protocol::sample_frame(f) == Frame{0x604, 8, {0x40, 0x14, 0, 0, 0xBC, 0, 0, 0}});
}

TEST_CASE("power status: 64606 is -930 mW") {  // [Thesis figure 7.2: off, 52 %, 137 min, 64606]
  constexpr auto p = PowerStatus::decode(Payload{0x00, 52, 137, 0, 0x5E, 0xFC});
  STATIC_REQUIRE(p == PowerStatus{0, 52, 137, -930});
  STATIC_REQUIRE(p.power_mW() == -930.0);
  STATIC_REQUIRE(p.minutes_min() == 137.0);
  STATIC_REQUIRE(p.state_of_charge_percent() == 52.0);
  STATIC_REQUIRE(!p.plugged());
  STATIC_REQUIRE(!p.charging());
  STATIC_REQUIRE(ocm::protocol::sample_frame(p) == Frame{0x61E, 6, {0x00, 52, 137, 0, 0x5E, 0xFC}});
}

TEST_CASE("power status: flags and the unknown time") {
  constexpr auto p = PowerStatus::decode(Payload{0x03, 100, 0xFF, 0xFF, 0x10, 0x27});
  STATIC_REQUIRE(p.plugged());
  STATIC_REQUIRE(p.charging());
  STATIC_REQUIRE(p.minutes == PowerStatus::minutes_unknown);
  STATIC_REQUIRE(p.power == 10'000);
  constexpr auto unplugged = [](PowerStatus s) {
    s.set_plugged(false);
    s.set_charging(true);
    return s.flags;
  };
  STATIC_REQUIRE(unplugged(p) == PowerStatus::charging_flag);
}

TEST_CASE("odometry: 256 um and 256 urad a bit, velocity first") {
  // [Thesis standalone run, figure: words 2504, 614, 1681 at 0.9 m/s and 0.38 rad/s]
  constexpr Odometry o{{900'000, 380'000}, {2504, 614, 1681}};
  STATIC_REQUIRE(o.velocity.x_m_per_s() == 0.9);
  STATIC_REQUIRE(o.velocity.z_rad_per_s() == 0.38);
  STATIC_REQUIRE(o.pose.x_m() == exactly(641'024, 1e6));
  STATIC_REQUIRE(o.pose.orientation_rad() == 0.430336);
  STATIC_REQUIRE(ocm::protocol::sample_frame(o, Priority::medium, 0) ==
                 Frame{0x602, 8, {0xA0, 0xBB, 0x0D, 0x00, 0x60, 0xCC, 0x05, 0x00}});
  STATIC_REQUIRE(ocm::protocol::sample_frame(o, Priority::medium, 1) ==
                 Frame{0x603, 8, {0xC8, 0x09, 0x00, 0x66, 0x02, 0x00, 0x91, 0x06}});
  STATIC_REQUIRE(Odometry::decode({o.encode(0), o.encode(1)}) == o);
}

TEST_CASE("odometry: a 24-bit field is signed and saturates") {
  constexpr auto wire = OdometryPose{-1, 9'000'000, 0}.encode();
  STATIC_REQUIRE(wire == Payload{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F, 0x00, 0x00});
  STATIC_REQUIRE(OdometryPose::decode(wire) == OdometryPose{-1, 8'388'607, 0});
  STATIC_REQUIRE(OdometryPose{0, -9'000'000, 0}.encode() == Payload{0, 0, 0, 0x00, 0x00, 0x80});
  constexpr auto far = [] {
    OdometryPose p;
    p.set_x_m(-1e6);
    p.set_orientation_rad(7);
    return p;
  }();
  STATIC_REQUIRE(far == OdometryPose{-8'388'608, 0, 24'543});
}

TEST_CASE("proximity ring: eight frames of one sensor") {  // [Thesis figure 7.1: 2272, 2382, 2269 of 6 to 8]
  ProximityRing ring;
  for (std::size_t i = 0; i < 8; ++i) ring.sensor[i].proximity = static_cast<std::uint16_t>(2272 + 110 * i);
  CHECK(ring.encode(0) == Payload{0xE0, 0x08});
  CHECK(ocm::protocol::sample_frame(ring, Priority::low, 7) == Frame{0x726, 2, {0xE2, 0x0B}});
  std::array<Payload, 8> wire{};
  for (std::size_t i = 0; i < 8; ++i) wire[i] = ring.encode(i);
  CHECK(ProximityRing::decode(wire) == ring);
  CHECK(ring.encode(8) == Payload{});
}

TEST_CASE("motors and lights") {
  STATIC_REQUIRE(ocm::protocol::command(Motors{50, -200'000}) ==
                 Frame{0x201, 8, {0x32, 0x00, 0x00, 0x00, 0xC0, 0xF2, 0xFC, 0xFF}});
  STATIC_REQUIRE(ocm::protocol::command(Led{100, 50, 120}, Priority::medium, 1) ==
                 Frame{0x23C, 3, {0x64, 0x32, 0x78}});
  STATIC_REQUIRE(ocm::protocol::command(Led{255, 0, 0}, Priority::urgent, 8) == Frame{0x043, 3, {255, 0, 0}});
  STATIC_REQUIRE(Motors::timeout == std::chrono::milliseconds{500});
  Motors motors{1, 1};
  motors.set_x_m_per_s(std::numeric_limits<double>::quiet_NaN());
  motors.set_z_rad_per_s(1e12);
  CHECK(motors == Motors{0, 28'985'507});
}

TEST_CASE("status: two frames, the same of every board") {
  LightRingStatus s;
  s.identity = {0x010203, LightRingStatusIdentity::Reset::watchdog, 0xA1B2C3D4};
  s.health = {37, LightRingStatusHealth::Bus::passive, 0b101, 0b1, 0x1234, 0xFFFF};
  CHECK(ocm::protocol::sample_frame(s, Priority::low, 0) ==
        Frame{0x757, 8, {0x03, 0x02, 0x01, 4, 0xD4, 0xC3, 0xB2, 0xA1}});
  CHECK(ocm::protocol::sample_frame(s, Priority::low, 1) ==
        Frame{0x758, 8, {37, 2, 0b101, 0b1, 0x34, 0x12, 0xFF, 0xFF}});
  CHECK(LightRingStatus::decode({s.encode(0), s.encode(1)}) == s);
  STATIC_REQUIRE(LightRingStatus::priority == Priority::low);
  STATIC_REQUIRE(std::is_same_v<LightRing::status, LightRingStatus>);
  STATIC_REQUIRE(std::is_same_v<PowerManagement::refusal, PowerManagementRefusal>);
}

TEST_CASE("refusal: which topic, why, and how often") {
  using Reason = DiWheelDriveRefusal::Reason;
  CHECK(ocm::protocol::sample_frame(DiWheelDriveRefusal{0x08, Reason::bad_mode, 3, 0, 5}, Priority::low) ==
        Frame{0x71D, 8, {0x08, 4, 3, 0, 0, 0, 5, 0}});
  // The reasons are the numbers of the library's errors.
  const auto same = [](Reason reason, ocm::base::Error error) {
    return static_cast<std::uint8_t>(reason) == static_cast<std::uint8_t>(error);
  };
  CHECK(same(Reason::nothing, ocm::base::Error::none));
  CHECK(same(Reason::bad_length, ocm::base::Error::bad_length));
  CHECK(same(Reason::bad_mode, ocm::base::Error::bad_mode));
  CHECK(same(Reason::bad_unit, ocm::base::Error::bad_unit));
  CHECK(same(Reason::bad_period, ocm::base::Error::bad_period));
  CHECK(same(Reason::out_of_range, ocm::base::Error::out_of_range));
  CHECK(same(Reason::not_served, ocm::base::Error::unknown_topic));
  CHECK(same(Reason::no_sample, ocm::base::Error::not_sampled));
  CHECK(same(Reason::no_room, ocm::base::Error::full));
  CHECK(same(Reason::no_answer, ocm::base::Error::no_answer));
  CHECK(same(Reason::bus_fault, ocm::base::Error::bus_fault));
  CHECK(same(Reason::not_schedulable, ocm::base::Error::not_schedulable));
}

TEST_CASE("travel: 10 um, 10 urad and 0.1 mm/s a bit") {
  constexpr auto t = Travel::decode(Payload{0x30, 0x75, 0x00, 0xA7, 0x9A, 0xFD, 0xE8, 0x03});
  STATIC_REQUIRE(t.distance_m() == 0.3);
  STATIC_REQUIRE(t.angle_rad() == -1.57017);
  STATIC_REQUIRE(t.speed_m_per_s() == 0.1);
  STATIC_REQUIRE(ocm::protocol::command(t) ==
                 Frame{0x20B, 8, {0x30, 0x75, 0x00, 0xA7, 0x9A, 0xFD, 0xE8, 0x03}});
}

TEST_CASE("follow and avoid: one speed") {
  Follow follow;
  follow.set_speed_m_per_s(0.1);
  CHECK(ocm::protocol::command(follow) == Frame{0x20C, 2, {0xE8, 0x03}});
  follow.set_speed_m_per_s(9);
  CHECK(follow.speed_m_per_s() == 0.2);
  Avoid avoid;
  avoid.set_speed_m_per_s(0.1);
  CHECK(ocm::protocol::command(avoid) == Frame{0x229, 2, {0xE8, 0x03}});
  Home home;
  home.set_speed_m_per_s(0.1);
  home.set_distance_m(0.05);
  CHECK(ocm::protocol::command(home) == Frame{0x22A, 4, {0xF4, 0x01, 0xE8, 0x03}});
}

TEST_CASE("behaviour: what is active, how the last one ended, and what is left") {
  constexpr auto b = Behaviour::decode(Payload{0x01, 0x00, 0x30, 0x75, 0x00, 0x59, 0x65, 0x02});
  STATIC_REQUIRE(b.active == Behaviour::Active::travel);
  STATIC_REQUIRE(b.ended == Behaviour::Ended::nothing);
  STATIC_REQUIRE(b.distance_m() == 0.3);
  STATIC_REQUIRE(b.angle_rad() == 1.57017);
}

TEST_CASE("the catalogue knows every name, and whose topic it is") {
  struct Expected {
    std::string_view name;
    std::string_view alias;
    std::uint8_t id;
    std::string_view board;
    std::size_t frames;
  };
  constexpr Expected expected[] = {
      {"odometry", "odom", 0x03, "di_wheel_drive", 2},
      {"floor_proximity", "floor", 0x04, "di_wheel_drive", 1},
      {"magnetometer", "mag", 0x05, "di_wheel_drive", 3},
      {"gyroscope", "gyro", 0x08, "di_wheel_drive", 1},
      {"accelerometer", "accel", 0x09, "di_wheel_drive", 1},
      {"power_status", "power", 0x1E, "power_management", 1},
      {"proximity_ring", "ring", 0x1F, "power_management", 8},
      {"motors", "motors", 0x01, "di_wheel_drive", 1},
      {"led_1", "led_1", 0x3C, "light_ring", 1},
      {"led_8", "led_8", 0x43, "light_ring", 1},
      {"floor_calibration", "floor_calibration", 0x0A, "di_wheel_drive", 1},
      {"ring_calibration", "ring_calibration", 0x27, "power_management", 1},
      {"di_wheel_drive_status", "di_wheel_drive_status", 0x1B, "di_wheel_drive", 2},
      {"di_wheel_drive_refusal", "di_wheel_drive_refusal", 0x1D, "di_wheel_drive", 1},
      {"power_management_status", "power_management_status", 0x39, "power_management", 2},
      {"power_management_refusal", "power_management_refusal", 0x3B, "power_management", 1},
      {"light_ring_status", "light_ring_status", 0x57, "light_ring", 2},
      {"light_ring_refusal", "light_ring_refusal", 0x59, "light_ring", 1},
      {"travel", "travel", 0x0B, "di_wheel_drive", 1},
      {"follow", "follow", 0x0C, "di_wheel_drive", 1},
      {"behaviour", "behaviour", 0x0D, "di_wheel_drive", 1},
      {"avoid", "avoid", 0x29, "power_management", 1},
      {"home", "home", 0x2A, "power_management", 1},
      {"batteries", "battery", 0x2B, "power_management", 2},
      {"ring_light", "ambient", 0x2D, "power_management", 8},
  };
  for (const Expected& e : expected) {
    CAPTURE(e.name);
    const auto* topic = catalogue.find(e.name);
    REQUIRE(topic != nullptr);
    CHECK(catalogue.find(e.alias) == topic);
    CHECK(topic->id.value == e.id);
    CHECK(catalogue.boards[topic->board].name == e.board);
    CHECK(topic->frames.size() == e.frames);
  }
  STATIC_REQUIRE(catalogue.topics.size() == 31);
  STATIC_REQUIRE(catalogue.find("led_3")->group == "led");
  STATIC_REQUIRE(catalogue.find("led_3")->instance == 3);
  STATIC_REQUIRE(catalogue.bit_rate == 500'000);
}

TEST_CASE("the catalogue decodes as the structs do, and exactly") {
  const auto* field = &catalogue.find("gyro")->frames[0].fields[2];
  const auto raw = field->raw(Gyroscope{0, 0, -4}.encode());
  CHECK(raw == -4);
  const auto physical = field->physical(raw);
  REQUIRE(physical);
  CHECK(ocm::base::to_text(*physical) == "-0.07");
}

TEST_CASE("each board's clock gives the bus's bit rate exactly") {  // [RM0008 24.7.7, RM0090 32.7.7]
  STATIC_REQUIRE(
      ocm::can::find_bit_timing(DiWheelDrive::can_clock_hz, bit_rate)->exact(DiWheelDrive::can_clock_hz));
  STATIC_REQUIRE(ocm::can::find_bit_timing(PowerManagement::can_clock_hz, bit_rate)
                     ->exact(PowerManagement::can_clock_hz));
  STATIC_REQUIRE(
      ocm::can::find_bit_timing(LightRing::can_clock_hz, bit_rate)->exact(LightRing::can_clock_hz));
  STATIC_REQUIRE(DiWheelDrive::sensors::contains<Gyroscope>);
  STATIC_REQUIRE(!PowerManagement::sensors::contains<Gyroscope>);
}

}  // namespace topics_amiro_test
