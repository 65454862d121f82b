// Made by ocm-generate from topics.json. Do not edit: change the spec, and generate again.

/// The topics of AMiRo.
///
/// Members of a frame are raw numbers, as they travel. name_unit() is the physical value, rounded once where
/// raw number times scale stays below 2^53; set_name_unit() takes the nearest raw number within the field's
/// range, and the one nearest to zero for not a number. encode() puts the nearest number that the width
/// holds. `frames` has of each frame the id, the DLC, and the most bits that it takes on the bus at each
/// priority, whatever its content. No heap, no exceptions; everything is constexpr.
///
/// Where a period, deadline, jitter, priority or timeout names no source: [period: Thesis figure 4.2;
/// deadline decided: the default period; jitter decided: a system tick of 1 ms; priority: Thesis 4.2: medium
/// is normal]
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/physical.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/protocol/wire_hash.hpp"

namespace amiro {

/// Bits per second on the bus. [Thesis 4]
inline constexpr std::uint32_t bit_rate = 500'000;

/// Odometry, velocity: present velocity. [Thesis table 4.6; id decided: the thesis gives none]
struct OdometryVelocity {
  static constexpr ocm::protocol::TopicId id{0x02};
  static constexpr std::uint8_t dlc = 8;

  /// forwards; 0.000001 m/s a bit, [-2147.483648, 2147.483647] m/s
  std::int32_t x = 0;
  /// counter-clockwise seen from above; 0.000001 rad/s a bit, [-2147.483648, 2147.483647] rad/s
  std::int32_t z = 0;

  using XBits = ocm::protocol::Bits<std::int32_t, 0>;
  using ZBits = ocm::protocol::Bits<std::int32_t, 32>;

  [[nodiscard]] constexpr double x_m_per_s() const noexcept { return x / 1'000'000.0; }
  constexpr void set_x_m_per_s(double value) noexcept {
    x = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0, XBits::min, XBits::max);
  }
  [[nodiscard]] constexpr double z_rad_per_s() const noexcept { return z / 1'000'000.0; }
  constexpr void set_z_rad_per_s(double value) noexcept {
    z = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0, ZBits::min, ZBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    XBits::put(data, x);
    ZBits::put(data, z);
    return data;
  }
  [[nodiscard]] static constexpr OdometryVelocity decode(const ocm::can::Payload& data) noexcept {
    OdometryVelocity value;
    value.x = XBits::get(data);
    value.z = ZBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const OdometryVelocity&, const OdometryVelocity&) = default;
};

/// Odometry, pose: position and heading since the start. [Thesis table 4.5; fields: 24/24/16 bits, each the
/// um or urad value >> 8, and [0, 2 pi): AMiRo-OS 1.0]
struct OdometryPose {
  static constexpr ocm::protocol::TopicId id{0x03};
  static constexpr std::uint8_t dlc = 8;

  /// 0.000256 m a bit, [-2147.483648, 2147.483392] m
  std::int32_t x = 0;
  /// 0.000256 m a bit, [-2147.483648, 2147.483392] m
  std::int32_t y = 0;
  /// counter-clockwise, 0 at the start; 0.000256 rad a bit, [0, 6.283008] rad
  std::uint16_t orientation = 0;

  using XBits = ocm::protocol::Bits<std::int32_t, 0, 24>;
  using YBits = ocm::protocol::Bits<std::int32_t, 24, 24>;
  using OrientationBits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr double x_m() const noexcept { return x * 256.0 / 1'000'000.0; }
  constexpr void set_x_m(double value) noexcept {
    x = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0 / 256.0, XBits::min, XBits::max);
  }
  [[nodiscard]] constexpr double y_m() const noexcept { return y * 256.0 / 1'000'000.0; }
  constexpr void set_y_m(double value) noexcept {
    y = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0 / 256.0, YBits::min, YBits::max);
  }
  [[nodiscard]] constexpr double orientation_rad() const noexcept {
    return orientation * 256.0 / 1'000'000.0;
  }
  constexpr void set_orientation_rad(double value) noexcept {
    orientation = ocm::protocol::nearest_raw<std::uint16_t>(value * 1'000'000.0 / 256.0, 0, 24'543);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    XBits::put(data, x);
    YBits::put(data, y);
    OrientationBits::put(data, orientation);
    return data;
  }
  [[nodiscard]] static constexpr OdometryPose decode(const ocm::can::Payload& data) noexcept {
    OdometryPose value;
    value.x = XBits::get(data);
    value.y = YBits::get(data);
    value.orientation = OrientationBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const OdometryPose&, const OdometryPose&) = default;
};

/// Odometry: velocity and pose from the wheel encoders. Sensor of DiWheelDrive, requests on 0x03. [Thesis
/// 4.2.1]
struct Odometry {
  static constexpr std::string_view name = "odometry";
  static constexpr ocm::protocol::TopicId id{0x03};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 2> frames{{
      {ocm::protocol::TopicId{0x02}, 8, {131, 131, 131, 131}},
      {ocm::protocol::TopicId{0x03}, 8, {131, 131, 131, 131}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [AMiRo-OS 1.0, Odometry: updated every 50 ms]
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{50};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::pose;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  OdometryVelocity velocity;
  OdometryPose pose;

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return velocity.encode();
    if (frame == 1) return pose.encode();
    return {};
  }
  [[nodiscard]] static constexpr Odometry decode(const std::array<ocm::can::Payload, 2>& all) noexcept {
    Odometry value;
    value.velocity = OdometryVelocity::decode(all[0]);
    value.pose = OdometryPose::decode(all[1]);
    return value;
  }
  friend constexpr bool operator==(const Odometry&, const Odometry&) = default;
};
static_assert(ocm::protocol::TopicType<Odometry>);

/// Floor proximity: light that the floor reflects, offset removed. Sensor of DiWheelDrive, requests on 0x04.
/// [Thesis table 4.4; counts: VCNL4020 data sheet]
struct FloorProximity {
  static constexpr std::string_view name = "floor_proximity";
  static constexpr ocm::protocol::TopicId id{0x04};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x04}, 8, {132, 132, 132, 132}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [VCNL4020 data sheet: at most 250 proximity measurements/s]
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{4};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::floor;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  std::uint16_t sensor_1 = 0;  ///< counts, larger = brighter or nearer; [0, 65535]
  std::uint16_t sensor_2 = 0;  ///< counts; [0, 65535]
  std::uint16_t sensor_3 = 0;  ///< counts; [0, 65535]
  std::uint16_t sensor_4 = 0;  ///< counts; [0, 65535]

  using Sensor1Bits = ocm::protocol::Bits<std::uint16_t, 0>;
  using Sensor2Bits = ocm::protocol::Bits<std::uint16_t, 16>;
  using Sensor3Bits = ocm::protocol::Bits<std::uint16_t, 32>;
  using Sensor4Bits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    Sensor1Bits::put(data, sensor_1);
    Sensor2Bits::put(data, sensor_2);
    Sensor3Bits::put(data, sensor_3);
    Sensor4Bits::put(data, sensor_4);
    return data;
  }
  [[nodiscard]] static constexpr FloorProximity decode(const ocm::can::Payload& data) noexcept {
    FloorProximity value;
    value.sensor_1 = Sensor1Bits::get(data);
    value.sensor_2 = Sensor2Bits::get(data);
    value.sensor_3 = Sensor3Bits::get(data);
    value.sensor_4 = Sensor4Bits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr FloorProximity decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const FloorProximity&, const FloorProximity&) = default;
};
static_assert(ocm::protocol::TopicType<FloorProximity>);

/// Magnetometer, x.
struct MagnetometerX {
  static constexpr ocm::protocol::TopicId id{0x05};
  static constexpr std::uint8_t dlc = 4;

  std::int32_t field = 0;  ///< 0.000001 G a bit, [-5.24288, 5.24032] G

  using FieldBits = ocm::protocol::Bits<std::int32_t, 0>;

  [[nodiscard]] constexpr double field_gauss() const noexcept { return field / 1'000'000.0; }
  constexpr void set_field_gauss(double value) noexcept {
    field = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0, -5'242'880, 5'240'320);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    FieldBits::put(data, field);
    return data;
  }
  [[nodiscard]] static constexpr MagnetometerX decode(const ocm::can::Payload& data) noexcept {
    MagnetometerX value;
    value.field = FieldBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const MagnetometerX&, const MagnetometerX&) = default;
};

/// Magnetometer, y. [id decided: the next after x]
struct MagnetometerY {
  static constexpr ocm::protocol::TopicId id{0x06};
  static constexpr std::uint8_t dlc = 4;

  std::int32_t field = 0;  ///< 0.000001 G a bit, [-5.24288, 5.24032] G

  using FieldBits = ocm::protocol::Bits<std::int32_t, 0>;

  [[nodiscard]] constexpr double field_gauss() const noexcept { return field / 1'000'000.0; }
  constexpr void set_field_gauss(double value) noexcept {
    field = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0, -5'242'880, 5'240'320);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    FieldBits::put(data, field);
    return data;
  }
  [[nodiscard]] static constexpr MagnetometerY decode(const ocm::can::Payload& data) noexcept {
    MagnetometerY value;
    value.field = FieldBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const MagnetometerY&, const MagnetometerY&) = default;
};

/// Magnetometer, z. [id decided: the next after y]
struct MagnetometerZ {
  static constexpr ocm::protocol::TopicId id{0x07};
  static constexpr std::uint8_t dlc = 4;

  std::int32_t field = 0;  ///< 0.000001 G a bit, [-5.24288, 5.24032] G

  using FieldBits = ocm::protocol::Bits<std::int32_t, 0>;

  [[nodiscard]] constexpr double field_gauss() const noexcept { return field / 1'000'000.0; }
  constexpr void set_field_gauss(double value) noexcept {
    field = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0, -5'242'880, 5'240'320);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    FieldBits::put(data, field);
    return data;
  }
  [[nodiscard]] static constexpr MagnetometerZ decode(const ocm::can::Payload& data) noexcept {
    MagnetometerZ value;
    value.field = FieldBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const MagnetometerZ&, const MagnetometerZ&) = default;
};

/// Magnetometer: magnetic field, one frame an axis. Sensor of DiWheelDrive, requests on 0x05. [Thesis table
/// 4.3; 1 uG a bit in steps of 2560: HMC5883L data sheet, 390 counts/G at +-4.7 G]
struct Magnetometer {
  static constexpr std::string_view name = "magnetometer";
  static constexpr ocm::protocol::TopicId id{0x05};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 3> frames{{
      {ocm::protocol::TopicId{0x05}, 4, {91, 90, 90, 90}},
      {ocm::protocol::TopicId{0x06}, 4, {91, 92, 91, 91}},
      {ocm::protocol::TopicId{0x07}, 4, {90, 90, 90, 90}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [HMC5883L data sheet: 75 Hz in continuous mode]
  static constexpr ocm::base::Duration shortest_period = std::chrono::microseconds{13'334};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  MagnetometerX x;
  MagnetometerY y;
  MagnetometerZ z;

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return x.encode();
    if (frame == 1) return y.encode();
    if (frame == 2) return z.encode();
    return {};
  }
  [[nodiscard]] static constexpr Magnetometer decode(const std::array<ocm::can::Payload, 3>& all) noexcept {
    Magnetometer value;
    value.x = MagnetometerX::decode(all[0]);
    value.y = MagnetometerY::decode(all[1]);
    value.z = MagnetometerZ::decode(all[2]);
    return value;
  }
  friend constexpr bool operator==(const Magnetometer&, const Magnetometer&) = default;
};
static_assert(ocm::protocol::TopicType<Magnetometer>);

/// Gyroscope: angular velocity. Sensor of DiWheelDrive, requests on 0x08. [Thesis table 4.1; scale: L3G4200D
/// data sheet, table 4, at 500 dps]
struct Gyroscope {
  static constexpr std::string_view name = "gyroscope";
  static constexpr ocm::protocol::TopicId id{0x08};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x08}, 6, {111, 110, 111, 110}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [L3G4200D data sheet: 800 Hz]
  static constexpr ocm::base::Duration shortest_period = std::chrono::microseconds{1'250};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  std::int16_t x = 0;  ///< 0.0175 deg/s a bit, [-499.9925, 499.9925] deg/s
  std::int16_t y = 0;  ///< 0.0175 deg/s a bit, [-499.9925, 499.9925] deg/s
  std::int16_t z = 0;  ///< 0.0175 deg/s a bit, [-499.9925, 499.9925] deg/s

  using XBits = ocm::protocol::Bits<std::int16_t, 0>;
  using YBits = ocm::protocol::Bits<std::int16_t, 16>;
  using ZBits = ocm::protocol::Bits<std::int16_t, 32>;

  [[nodiscard]] constexpr double x_deg_per_s() const noexcept { return x * 175.0 / 10'000.0; }
  constexpr void set_x_deg_per_s(double value) noexcept {
    x = ocm::protocol::nearest_raw<std::int16_t>(value * 10'000.0 / 175.0, -28'571, 28'571);
  }
  [[nodiscard]] constexpr double y_deg_per_s() const noexcept { return y * 175.0 / 10'000.0; }
  constexpr void set_y_deg_per_s(double value) noexcept {
    y = ocm::protocol::nearest_raw<std::int16_t>(value * 10'000.0 / 175.0, -28'571, 28'571);
  }
  [[nodiscard]] constexpr double z_deg_per_s() const noexcept { return z * 175.0 / 10'000.0; }
  constexpr void set_z_deg_per_s(double value) noexcept {
    z = ocm::protocol::nearest_raw<std::int16_t>(value * 10'000.0 / 175.0, -28'571, 28'571);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    XBits::put(data, x);
    YBits::put(data, y);
    ZBits::put(data, z);
    return data;
  }
  [[nodiscard]] static constexpr Gyroscope decode(const ocm::can::Payload& data) noexcept {
    Gyroscope value;
    value.x = XBits::get(data);
    value.y = YBits::get(data);
    value.z = ZBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Gyroscope decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Gyroscope&, const Gyroscope&) = default;
};
static_assert(ocm::protocol::TopicType<Gyroscope>);

/// Accelerometer: acceleration, gravity included. Sensor of DiWheelDrive, requests on 0x09. [Thesis table
/// 4.2; scale: z reads near 1024 at rest, thesis figure 6.3]
struct Accelerometer {
  static constexpr std::string_view name = "accelerometer";
  static constexpr ocm::protocol::TopicId id{0x09};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x09}, 6, {110, 109, 111, 109}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [LIS331DLH data sheet: 1000 Hz]
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{1};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  std::int16_t x = 0;  ///< 0.0009765625 g a bit, [-8, 8] g
  std::int16_t y = 0;  ///< 0.0009765625 g a bit, [-8, 8] g
  std::int16_t z = 0;  ///< 0.0009765625 g a bit, [-8, 8] g

  using XBits = ocm::protocol::Bits<std::int16_t, 0>;
  using YBits = ocm::protocol::Bits<std::int16_t, 16>;
  using ZBits = ocm::protocol::Bits<std::int16_t, 32>;

  [[nodiscard]] constexpr double x_g() const noexcept { return x / 1'024.0; }
  constexpr void set_x_g(double value) noexcept {
    x = ocm::protocol::nearest_raw<std::int16_t>(value * 1'024.0, -8'192, 8'192);
  }
  [[nodiscard]] constexpr double y_g() const noexcept { return y / 1'024.0; }
  constexpr void set_y_g(double value) noexcept {
    y = ocm::protocol::nearest_raw<std::int16_t>(value * 1'024.0, -8'192, 8'192);
  }
  [[nodiscard]] constexpr double z_g() const noexcept { return z / 1'024.0; }
  constexpr void set_z_g(double value) noexcept {
    z = ocm::protocol::nearest_raw<std::int16_t>(value * 1'024.0, -8'192, 8'192);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    XBits::put(data, x);
    YBits::put(data, y);
    ZBits::put(data, z);
    return data;
  }
  [[nodiscard]] static constexpr Accelerometer decode(const ocm::can::Payload& data) noexcept {
    Accelerometer value;
    value.x = XBits::get(data);
    value.y = YBits::get(data);
    value.z = ZBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Accelerometer decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Accelerometer&, const Accelerometer&) = default;
};
static_assert(ocm::protocol::TopicType<Accelerometer>);

/// Power status: batteries and charger. Sensor of PowerManagement, requests on 0x1E. [Thesis table 4.7]
struct PowerStatus {
  static constexpr std::string_view name = "power_status";
  static constexpr ocm::protocol::TopicId id{0x1E};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x1E}, 6, {112, 110, 110, 110}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [BQ27500 data sheet: gauge updated every second]
  static constexpr ocm::base::Duration shortest_period = std::chrono::seconds{1};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  static constexpr std::uint8_t plugged_flag = 0x01;
  static constexpr std::uint8_t charging_flag = 0x02;
  static constexpr std::uint16_t minutes_unknown = 65'535;

  std::uint8_t flags = 0;            ///< [AMiRo-OS 1.0]
  std::uint8_t state_of_charge = 0;  ///< [0, 100] %
  std::uint16_t minutes = 0;         ///< to full when charging, else to empty; [0, 65535] min
  std::int16_t power = 0;            ///< negative: out of the batteries; [-32768, 32767] mW [decided: signed]

  using FlagsBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using StateOfChargeBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using MinutesBits = ocm::protocol::Bits<std::uint16_t, 16>;
  using PowerBits = ocm::protocol::Bits<std::int16_t, 32>;

  [[nodiscard]] constexpr bool plugged() const noexcept { return (flags & plugged_flag) != 0; }
  constexpr void set_plugged(bool on) noexcept {
    flags = static_cast<std::uint8_t>(on ? flags | plugged_flag : flags & ~plugged_flag);
  }
  [[nodiscard]] constexpr bool charging() const noexcept { return (flags & charging_flag) != 0; }
  constexpr void set_charging(bool on) noexcept {
    flags = static_cast<std::uint8_t>(on ? flags | charging_flag : flags & ~charging_flag);
  }
  [[nodiscard]] constexpr double state_of_charge_percent() const noexcept { return state_of_charge; }
  constexpr void set_state_of_charge_percent(double value) noexcept {
    state_of_charge = ocm::protocol::nearest_raw<std::uint8_t>(value, 0, 100);
  }
  [[nodiscard]] constexpr double minutes_min() const noexcept { return minutes; }
  constexpr void set_minutes_min(double value) noexcept {
    minutes = ocm::protocol::nearest_raw<std::uint16_t>(value, MinutesBits::min, MinutesBits::max);
  }
  [[nodiscard]] constexpr double power_mW() const noexcept { return power; }
  constexpr void set_power_mW(double value) noexcept {
    power = ocm::protocol::nearest_raw<std::int16_t>(value, PowerBits::min, PowerBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    FlagsBits::put(data, flags);
    StateOfChargeBits::put(data, state_of_charge);
    MinutesBits::put(data, minutes);
    PowerBits::put(data, power);
    return data;
  }
  [[nodiscard]] static constexpr PowerStatus decode(const ocm::can::Payload& data) noexcept {
    PowerStatus value;
    value.flags = FlagsBits::get(data);
    value.state_of_charge = StateOfChargeBits::get(data);
    value.minutes = MinutesBits::get(data);
    value.power = PowerBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr PowerStatus decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const PowerStatus&, const PowerStatus&) = default;
};
static_assert(ocm::protocol::TopicType<PowerStatus>);

/// Proximity ring, one sensor. [Thesis table 4.8; counts, not mm: VCNL4020 data sheet; id: 0x1F: Thesis
/// 4.2.1; 0x20..0x26 decided; dlc decided: the thesis gives 16 bytes for all eight]
struct ProximityRingSensor {
  static constexpr ocm::protocol::TopicId id{0x1F};  ///< of the first of 8
  static constexpr std::uint8_t dlc = 2;

  std::uint16_t proximity = 0;  ///< counts, larger = nearer; [0, 65535]

  using ProximityBits = ocm::protocol::Bits<std::uint16_t, 0>;

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    ProximityBits::put(data, proximity);
    return data;
  }
  [[nodiscard]] static constexpr ProximityRingSensor decode(const ocm::can::Payload& data) noexcept {
    ProximityRingSensor value;
    value.proximity = ProximityBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const ProximityRingSensor&, const ProximityRingSensor&) = default;
};

/// Proximity ring: obstacles around the robot, one frame a sensor. Sensor of PowerManagement, requests on
/// 0x1F. [Thesis table 4.8; counts: VCNL4020 data sheet]
struct ProximityRing {
  static constexpr std::string_view name = "proximity_ring";
  static constexpr ocm::protocol::TopicId id{0x1F};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 8> frames{{
      {ocm::protocol::TopicId{0x1F}, 2, {72, 71, 70, 71}},
      {ocm::protocol::TopicId{0x20}, 2, {70, 71, 70, 71}},
      {ocm::protocol::TopicId{0x21}, 2, {70, 71, 69, 69}},
      {ocm::protocol::TopicId{0x22}, 2, {70, 70, 69, 69}},
      {ocm::protocol::TopicId{0x23}, 2, {70, 70, 70, 70}},
      {ocm::protocol::TopicId{0x24}, 2, {70, 69, 69, 69}},
      {ocm::protocol::TopicId{0x25}, 2, {70, 70, 69, 70}},
      {ocm::protocol::TopicId{0x26}, 2, {70, 69, 70, 69}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [VCNL4020 data sheet: at most 250 proximity measurements/s]
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{4};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::ring;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  std::array<ProximityRingSensor, 8> sensor{};

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame < sensor.size()) return sensor[frame].encode();
    return {};
  }
  [[nodiscard]] static constexpr ProximityRing decode(const std::array<ocm::can::Payload, 8>& all) noexcept {
    ProximityRing value;
    for (std::size_t i = 0; i < value.sensor.size(); ++i)
      value.sensor[i] = ProximityRingSensor::decode(all[i]);
    return value;
  }
  friend constexpr bool operator==(const ProximityRing&, const ProximityRing&) = default;
};
static_assert(ocm::protocol::TopicType<ProximityRing>);

/// Motors: velocity set point of both wheels together. Actuator of DiWheelDrive, set points on 0x01. [Thesis
/// table 4.9, its bytes read as little-endian; id decided: the thesis names a header that is not public]
struct Motors {
  static constexpr std::string_view name = "motors";
  static constexpr ocm::protocol::TopicId id{0x01};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x01}, 8, {132, 131, 131, 131}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  /// [decided: five set points at 100 ms lost in a row]
  static constexpr ocm::base::Duration timeout = std::chrono::milliseconds{500};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::drive;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  /// forwards; 0.000001 m/s a bit, [-1, 1] m/s [Thesis table 4.9; range decided: the log in Thesis 6.3 shows
  /// 0.906 m/s]
  std::int32_t x = 0;
  /// counter-clockwise seen from above; 0.000001 rad/s a bit, [-28.985507, 28.985507] rad/s [Thesis table
  /// 4.9; range decided: on the spot, each wheel at 1 m/s; they are 69 mm apart (AMiRo-OS 1.0)]
  std::int32_t z = 0;

  using XBits = ocm::protocol::Bits<std::int32_t, 0>;
  using ZBits = ocm::protocol::Bits<std::int32_t, 32>;

  [[nodiscard]] constexpr double x_m_per_s() const noexcept { return x / 1'000'000.0; }
  constexpr void set_x_m_per_s(double value) noexcept {
    x = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0, -1'000'000, 1'000'000);
  }
  [[nodiscard]] constexpr double z_rad_per_s() const noexcept { return z / 1'000'000.0; }
  constexpr void set_z_rad_per_s(double value) noexcept {
    z = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0, -28'985'507, 28'985'507);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    XBits::put(data, x);
    ZBits::put(data, z);
    return data;
  }
  [[nodiscard]] static constexpr Motors decode(const ocm::can::Payload& data) noexcept {
    Motors value;
    value.x = XBits::get(data);
    value.z = ZBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Motors decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Motors&, const Motors&) = default;
};
static_assert(ocm::protocol::TopicType<Motors>);

/// Led: colour of one of the eight lights of the ring. Actuator of LightRing, set points on 0x3C to 0x43.
/// [Thesis 4.2.2, LEDs; id decided: the thesis names a header that is not public]
struct Led {
  static constexpr std::string_view name = "led";
  static constexpr ocm::protocol::TopicId id{0x3C};
  static constexpr std::uint8_t instances = 8;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x3C}, 3, {83, 82, 82, 82}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout{};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::light;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  std::uint8_t red = 0;    ///< [0, 255]
  std::uint8_t green = 0;  ///< [0, 255]
  std::uint8_t blue = 0;   ///< [0, 255]

  using RedBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using GreenBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using BlueBits = ocm::protocol::Bits<std::uint8_t, 16>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    RedBits::put(data, red);
    GreenBits::put(data, green);
    BlueBits::put(data, blue);
    return data;
  }
  [[nodiscard]] static constexpr Led decode(const ocm::can::Payload& data) noexcept {
    Led value;
    value.red = RedBits::get(data);
    value.green = GreenBits::get(data);
    value.blue = BlueBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Led decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Led&, const Led&) = default;
};
static_assert(ocm::protocol::TopicType<Led>);

/// Floor calibration: offsets of the floor sensors: measured now, with the robot held up, or forgotten.
/// Actuator of DiWheelDrive, set points on 0x0A. [decided: a command of the shell of AMiRo-OS 1.0 has none on
/// the bus; id decided: free in the board's block]
struct FloorCalibration {
  static constexpr std::string_view name = "floor_calibration";
  static constexpr ocm::protocol::TopicId id{0x0A};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x0A}, 1, {61, 59, 60, 59}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout{};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  enum class Action : std::uint8_t {
    none = 0,
    measure = 1,
    forget = 2,
  };

  Action action{};

  using ActionBits = ocm::protocol::Bits<std::uint8_t, 0>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    ActionBits::put(data, static_cast<std::uint8_t>(action));
    return data;
  }
  [[nodiscard]] static constexpr FloorCalibration decode(const ocm::can::Payload& data) noexcept {
    FloorCalibration value;
    value.action = static_cast<Action>(ActionBits::get(data));
    return value;
  }
  [[nodiscard]] static constexpr FloorCalibration decode(
      const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const FloorCalibration&, const FloorCalibration&) = default;
};
static_assert(ocm::protocol::TopicType<FloorCalibration>);

/// Ring calibration: offsets of the proximity ring: measured now, with nothing around the robot, or
/// forgotten. Actuator of PowerManagement, set points on 0x27. [decided, as floor_calibration]
struct RingCalibration {
  static constexpr std::string_view name = "ring_calibration";
  static constexpr ocm::protocol::TopicId id{0x27};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x27}, 1, {60, 59, 59, 60}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout{};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  enum class Action : std::uint8_t {
    none = 0,
    measure = 1,
    forget = 2,
  };

  Action action{};

  using ActionBits = ocm::protocol::Bits<std::uint8_t, 0>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    ActionBits::put(data, static_cast<std::uint8_t>(action));
    return data;
  }
  [[nodiscard]] static constexpr RingCalibration decode(const ocm::can::Payload& data) noexcept {
    RingCalibration value;
    value.action = static_cast<Action>(ActionBits::get(data));
    return value;
  }
  [[nodiscard]] static constexpr RingCalibration decode(
      const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const RingCalibration&, const RingCalibration&) = default;
};
static_assert(ocm::protocol::TopicType<RingCalibration>);

/// Di wheel drive status, identity.
struct DiWheelDriveStatusIdentity {
  static constexpr ocm::protocol::TopicId id{0x1B};
  static constexpr std::uint8_t dlc = 8;

  enum class Reset : std::uint8_t {
    unknown = 0,
    power = 1,
    pin = 2,
    software = 3,
    watchdog = 4,
    low_power = 5,
    fault = 6,
    memory_fault = 7,
    bus_fault = 8,
    usage_fault = 9,
    kernel_halt = 10,
    clock_failure = 11,
  };

  std::uint32_t uptime = 0;     ///< since the start; stays at its end; [0, 16777215] s
  Reset reset{};                ///< why the board started
  std::uint32_t wire_hash = 0;  ///< of the spec that the board was built from; [0, 4294967295]

  using UptimeBits = ocm::protocol::Bits<std::uint32_t, 0, 24>;
  using ResetBits = ocm::protocol::Bits<std::uint8_t, 24>;
  using WireHashBits = ocm::protocol::Bits<std::uint32_t, 32>;

  [[nodiscard]] constexpr double uptime_s() const noexcept { return uptime; }
  constexpr void set_uptime_s(double value) noexcept {
    uptime = ocm::protocol::nearest_raw<std::uint32_t>(value, UptimeBits::min, UptimeBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    UptimeBits::put(data, uptime);
    ResetBits::put(data, static_cast<std::uint8_t>(reset));
    WireHashBits::put(data, wire_hash);
    return data;
  }
  [[nodiscard]] static constexpr DiWheelDriveStatusIdentity decode(const ocm::can::Payload& data) noexcept {
    DiWheelDriveStatusIdentity value;
    value.uptime = UptimeBits::get(data);
    value.reset = static_cast<Reset>(ResetBits::get(data));
    value.wire_hash = WireHashBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const DiWheelDriveStatusIdentity&,
                                   const DiWheelDriveStatusIdentity&) = default;
};

/// Di wheel drive status, health.
struct DiWheelDriveStatusHealth {
  static constexpr ocm::protocol::TopicId id{0x1C};
  static constexpr std::uint8_t dlc = 8;

  enum class Bus : std::uint8_t {
    active = 0,
    warning = 1,
    passive = 2,
    off = 3,
  };
  static constexpr std::uint8_t load_unknown = 255;

  /// of the CPU, over the last second; [0, 100] %
  std::uint8_t load = 0;
  /// state of the CAN controller's error counters
  Bus bus{};
  /// bit n: the board's n-th sensor, in the order of the spec, is published; [0, 255]
  std::uint8_t publishing = 0;
  /// bit n: the n-th sensor's part did not answer last time; [0, 255]
  std::uint8_t faults = 0;
  /// releases that came late or not at all; stays at its end; [0, 65535]
  std::uint16_t overload = 0;
  /// errors on the bus and frames given up; stays at its end; [0, 65535]
  std::uint16_t bus_errors = 0;

  using LoadBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using BusBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using PublishingBits = ocm::protocol::Bits<std::uint8_t, 16>;
  using FaultsBits = ocm::protocol::Bits<std::uint8_t, 24>;
  using OverloadBits = ocm::protocol::Bits<std::uint16_t, 32>;
  using BusErrorsBits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr double load_percent() const noexcept { return load; }
  constexpr void set_load_percent(double value) noexcept {
    load = ocm::protocol::nearest_raw<std::uint8_t>(value, 0, 100);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    LoadBits::put(data, load);
    BusBits::put(data, static_cast<std::uint8_t>(bus));
    PublishingBits::put(data, publishing);
    FaultsBits::put(data, faults);
    OverloadBits::put(data, overload);
    BusErrorsBits::put(data, bus_errors);
    return data;
  }
  [[nodiscard]] static constexpr DiWheelDriveStatusHealth decode(const ocm::can::Payload& data) noexcept {
    DiWheelDriveStatusHealth value;
    value.load = LoadBits::get(data);
    value.bus = static_cast<Bus>(BusBits::get(data));
    value.publishing = PublishingBits::get(data);
    value.faults = FaultsBits::get(data);
    value.overload = OverloadBits::get(data);
    value.bus_errors = BusErrorsBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const DiWheelDriveStatusHealth&,
                                   const DiWheelDriveStatusHealth&) = default;
};

/// Di wheel drive status: how the board is. Sensor of DiWheelDrive, requests on 0x1B. [decided: status ids at
/// the end of each board's block of 30]
struct DiWheelDriveStatus {
  static constexpr std::string_view name = "di_wheel_drive_status";
  static constexpr ocm::protocol::TopicId id{0x1B};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 2> frames{{
      {ocm::protocol::TopicId{0x1B}, 8, {131, 130, 130, 130}},
      {ocm::protocol::TopicId{0x1C}, 8, {132, 131, 131, 131}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{100};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::status;
  static constexpr ocm::base::Duration deadline = std::chrono::seconds{1};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  DiWheelDriveStatusIdentity identity;
  DiWheelDriveStatusHealth health;

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return identity.encode();
    if (frame == 1) return health.encode();
    return {};
  }
  [[nodiscard]] static constexpr DiWheelDriveStatus decode(
      const std::array<ocm::can::Payload, 2>& all) noexcept {
    DiWheelDriveStatus value;
    value.identity = DiWheelDriveStatusIdentity::decode(all[0]);
    value.health = DiWheelDriveStatusHealth::decode(all[1]);
    return value;
  }
  friend constexpr bool operator==(const DiWheelDriveStatus&, const DiWheelDriveStatus&) = default;
};
static_assert(ocm::protocol::TopicType<DiWheelDriveStatus>);

/// Di wheel drive refusal: the last request or set point that the board refused; sent unasked. Sensor of
/// DiWheelDrive, requests on 0x1D. [decided: status ids at the end of each board's block of 30; reasons as
/// ocm::base::Error numbers them]
struct DiWheelDriveRefusal {
  static constexpr std::string_view name = "di_wheel_drive_refusal";
  static constexpr ocm::protocol::TopicId id{0x1D};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x1D}, 8, {131, 130, 130, 130}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{100};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::refusal;
  static constexpr ocm::base::Duration deadline = std::chrono::seconds{1};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  enum class Reason : std::uint8_t {
    nothing = 0,
    bad_length = 3,
    bad_mode = 4,
    bad_unit = 5,
    bad_period = 6,
    out_of_range = 7,
    not_served = 8,
    no_sample = 9,
    no_room = 10,
    no_answer = 13,
    bus_fault = 14,
    not_schedulable = 15,
  };

  /// the number that it was for; [0, 255]
  std::uint8_t topic = 0;
  Reason reason{};
  /// so many since the start; stays at its end; [0, 65535]
  std::uint16_t refused = 0;
  /// releases at which a part had nothing to say; stays at its end; [0, 65535]
  std::uint16_t not_sampled = 0;
  /// frames and characters of a host on the board's serial line that found no place; stays at its end; [0,
  /// 65535]
  std::uint16_t line_lost = 0;

  using TopicBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using ReasonBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using RefusedBits = ocm::protocol::Bits<std::uint16_t, 16>;
  using NotSampledBits = ocm::protocol::Bits<std::uint16_t, 32>;
  using LineLostBits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    TopicBits::put(data, topic);
    ReasonBits::put(data, static_cast<std::uint8_t>(reason));
    RefusedBits::put(data, refused);
    NotSampledBits::put(data, not_sampled);
    LineLostBits::put(data, line_lost);
    return data;
  }
  [[nodiscard]] static constexpr DiWheelDriveRefusal decode(const ocm::can::Payload& data) noexcept {
    DiWheelDriveRefusal value;
    value.topic = TopicBits::get(data);
    value.reason = static_cast<Reason>(ReasonBits::get(data));
    value.refused = RefusedBits::get(data);
    value.not_sampled = NotSampledBits::get(data);
    value.line_lost = LineLostBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr DiWheelDriveRefusal decode(
      const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const DiWheelDriveRefusal&, const DiWheelDriveRefusal&) = default;
};
static_assert(ocm::protocol::TopicType<DiWheelDriveRefusal>);

/// Power management status, identity.
struct PowerManagementStatusIdentity {
  static constexpr ocm::protocol::TopicId id{0x39};
  static constexpr std::uint8_t dlc = 8;

  enum class Reset : std::uint8_t {
    unknown = 0,
    power = 1,
    pin = 2,
    software = 3,
    watchdog = 4,
    low_power = 5,
    fault = 6,
    memory_fault = 7,
    bus_fault = 8,
    usage_fault = 9,
    kernel_halt = 10,
    clock_failure = 11,
  };

  std::uint32_t uptime = 0;     ///< since the start; stays at its end; [0, 16777215] s
  Reset reset{};                ///< why the board started
  std::uint32_t wire_hash = 0;  ///< of the spec that the board was built from; [0, 4294967295]

  using UptimeBits = ocm::protocol::Bits<std::uint32_t, 0, 24>;
  using ResetBits = ocm::protocol::Bits<std::uint8_t, 24>;
  using WireHashBits = ocm::protocol::Bits<std::uint32_t, 32>;

  [[nodiscard]] constexpr double uptime_s() const noexcept { return uptime; }
  constexpr void set_uptime_s(double value) noexcept {
    uptime = ocm::protocol::nearest_raw<std::uint32_t>(value, UptimeBits::min, UptimeBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    UptimeBits::put(data, uptime);
    ResetBits::put(data, static_cast<std::uint8_t>(reset));
    WireHashBits::put(data, wire_hash);
    return data;
  }
  [[nodiscard]] static constexpr PowerManagementStatusIdentity decode(
      const ocm::can::Payload& data) noexcept {
    PowerManagementStatusIdentity value;
    value.uptime = UptimeBits::get(data);
    value.reset = static_cast<Reset>(ResetBits::get(data));
    value.wire_hash = WireHashBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const PowerManagementStatusIdentity&,
                                   const PowerManagementStatusIdentity&) = default;
};

/// Power management status, health.
struct PowerManagementStatusHealth {
  static constexpr ocm::protocol::TopicId id{0x3A};
  static constexpr std::uint8_t dlc = 8;

  enum class Bus : std::uint8_t {
    active = 0,
    warning = 1,
    passive = 2,
    off = 3,
  };
  static constexpr std::uint8_t load_unknown = 255;

  /// of the CPU, over the last second; [0, 100] %
  std::uint8_t load = 0;
  /// state of the CAN controller's error counters
  Bus bus{};
  /// bit n: the board's n-th sensor, in the order of the spec, is published; [0, 255]
  std::uint8_t publishing = 0;
  /// bit n: the n-th sensor's part did not answer last time; [0, 255]
  std::uint8_t faults = 0;
  /// releases that came late or not at all; stays at its end; [0, 65535]
  std::uint16_t overload = 0;
  /// errors on the bus and frames given up; stays at its end; [0, 65535]
  std::uint16_t bus_errors = 0;

  using LoadBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using BusBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using PublishingBits = ocm::protocol::Bits<std::uint8_t, 16>;
  using FaultsBits = ocm::protocol::Bits<std::uint8_t, 24>;
  using OverloadBits = ocm::protocol::Bits<std::uint16_t, 32>;
  using BusErrorsBits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr double load_percent() const noexcept { return load; }
  constexpr void set_load_percent(double value) noexcept {
    load = ocm::protocol::nearest_raw<std::uint8_t>(value, 0, 100);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    LoadBits::put(data, load);
    BusBits::put(data, static_cast<std::uint8_t>(bus));
    PublishingBits::put(data, publishing);
    FaultsBits::put(data, faults);
    OverloadBits::put(data, overload);
    BusErrorsBits::put(data, bus_errors);
    return data;
  }
  [[nodiscard]] static constexpr PowerManagementStatusHealth decode(const ocm::can::Payload& data) noexcept {
    PowerManagementStatusHealth value;
    value.load = LoadBits::get(data);
    value.bus = static_cast<Bus>(BusBits::get(data));
    value.publishing = PublishingBits::get(data);
    value.faults = FaultsBits::get(data);
    value.overload = OverloadBits::get(data);
    value.bus_errors = BusErrorsBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const PowerManagementStatusHealth&,
                                   const PowerManagementStatusHealth&) = default;
};

/// Power management status: how the board is. Sensor of PowerManagement, requests on 0x39. [decided, as
/// di_wheel_drive_status]
struct PowerManagementStatus {
  static constexpr std::string_view name = "power_management_status";
  static constexpr ocm::protocol::TopicId id{0x39};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 2> frames{{
      {ocm::protocol::TopicId{0x39}, 8, {129, 130, 130, 130}},
      {ocm::protocol::TopicId{0x3A}, 8, {130, 130, 130, 130}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{100};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::status;
  static constexpr ocm::base::Duration deadline = std::chrono::seconds{1};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  PowerManagementStatusIdentity identity;
  PowerManagementStatusHealth health;

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return identity.encode();
    if (frame == 1) return health.encode();
    return {};
  }
  [[nodiscard]] static constexpr PowerManagementStatus decode(
      const std::array<ocm::can::Payload, 2>& all) noexcept {
    PowerManagementStatus value;
    value.identity = PowerManagementStatusIdentity::decode(all[0]);
    value.health = PowerManagementStatusHealth::decode(all[1]);
    return value;
  }
  friend constexpr bool operator==(const PowerManagementStatus&, const PowerManagementStatus&) = default;
};
static_assert(ocm::protocol::TopicType<PowerManagementStatus>);

/// Power management refusal: the last request or set point that the board refused; sent unasked. Sensor of
/// PowerManagement, requests on 0x3B. [decided, as di_wheel_drive_refusal]
struct PowerManagementRefusal {
  static constexpr std::string_view name = "power_management_refusal";
  static constexpr ocm::protocol::TopicId id{0x3B};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x3B}, 8, {130, 130, 130, 130}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{100};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::refusal;
  static constexpr ocm::base::Duration deadline = std::chrono::seconds{1};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  enum class Reason : std::uint8_t {
    nothing = 0,
    bad_length = 3,
    bad_mode = 4,
    bad_unit = 5,
    bad_period = 6,
    out_of_range = 7,
    not_served = 8,
    no_sample = 9,
    no_room = 10,
    no_answer = 13,
    bus_fault = 14,
    not_schedulable = 15,
  };

  /// the number that it was for; [0, 255]
  std::uint8_t topic = 0;
  Reason reason{};
  /// so many since the start; stays at its end; [0, 65535]
  std::uint16_t refused = 0;
  /// releases at which a part had nothing to say; stays at its end; [0, 65535]
  std::uint16_t not_sampled = 0;
  /// frames and characters of a host on the board's serial line that found no place; stays at its end; [0,
  /// 65535]
  std::uint16_t line_lost = 0;

  using TopicBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using ReasonBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using RefusedBits = ocm::protocol::Bits<std::uint16_t, 16>;
  using NotSampledBits = ocm::protocol::Bits<std::uint16_t, 32>;
  using LineLostBits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    TopicBits::put(data, topic);
    ReasonBits::put(data, static_cast<std::uint8_t>(reason));
    RefusedBits::put(data, refused);
    NotSampledBits::put(data, not_sampled);
    LineLostBits::put(data, line_lost);
    return data;
  }
  [[nodiscard]] static constexpr PowerManagementRefusal decode(const ocm::can::Payload& data) noexcept {
    PowerManagementRefusal value;
    value.topic = TopicBits::get(data);
    value.reason = static_cast<Reason>(ReasonBits::get(data));
    value.refused = RefusedBits::get(data);
    value.not_sampled = NotSampledBits::get(data);
    value.line_lost = LineLostBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr PowerManagementRefusal decode(
      const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const PowerManagementRefusal&, const PowerManagementRefusal&) = default;
};
static_assert(ocm::protocol::TopicType<PowerManagementRefusal>);

/// Light ring status, identity.
struct LightRingStatusIdentity {
  static constexpr ocm::protocol::TopicId id{0x57};
  static constexpr std::uint8_t dlc = 8;

  enum class Reset : std::uint8_t {
    unknown = 0,
    power = 1,
    pin = 2,
    software = 3,
    watchdog = 4,
    low_power = 5,
    fault = 6,
    memory_fault = 7,
    bus_fault = 8,
    usage_fault = 9,
    kernel_halt = 10,
    clock_failure = 11,
  };

  std::uint32_t uptime = 0;     ///< since the start; stays at its end; [0, 16777215] s
  Reset reset{};                ///< why the board started
  std::uint32_t wire_hash = 0;  ///< of the spec that the board was built from; [0, 4294967295]

  using UptimeBits = ocm::protocol::Bits<std::uint32_t, 0, 24>;
  using ResetBits = ocm::protocol::Bits<std::uint8_t, 24>;
  using WireHashBits = ocm::protocol::Bits<std::uint32_t, 32>;

  [[nodiscard]] constexpr double uptime_s() const noexcept { return uptime; }
  constexpr void set_uptime_s(double value) noexcept {
    uptime = ocm::protocol::nearest_raw<std::uint32_t>(value, UptimeBits::min, UptimeBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    UptimeBits::put(data, uptime);
    ResetBits::put(data, static_cast<std::uint8_t>(reset));
    WireHashBits::put(data, wire_hash);
    return data;
  }
  [[nodiscard]] static constexpr LightRingStatusIdentity decode(const ocm::can::Payload& data) noexcept {
    LightRingStatusIdentity value;
    value.uptime = UptimeBits::get(data);
    value.reset = static_cast<Reset>(ResetBits::get(data));
    value.wire_hash = WireHashBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const LightRingStatusIdentity&, const LightRingStatusIdentity&) = default;
};

/// Light ring status, health.
struct LightRingStatusHealth {
  static constexpr ocm::protocol::TopicId id{0x58};
  static constexpr std::uint8_t dlc = 8;

  enum class Bus : std::uint8_t {
    active = 0,
    warning = 1,
    passive = 2,
    off = 3,
  };
  static constexpr std::uint8_t load_unknown = 255;

  /// of the CPU, over the last second; [0, 100] %
  std::uint8_t load = 0;
  /// state of the CAN controller's error counters
  Bus bus{};
  /// bit n: the board's n-th sensor, in the order of the spec, is published; [0, 255]
  std::uint8_t publishing = 0;
  /// bit n: the n-th sensor's part did not answer last time; [0, 255]
  std::uint8_t faults = 0;
  /// releases that came late or not at all; stays at its end; [0, 65535]
  std::uint16_t overload = 0;
  /// errors on the bus and frames given up; stays at its end; [0, 65535]
  std::uint16_t bus_errors = 0;

  using LoadBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using BusBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using PublishingBits = ocm::protocol::Bits<std::uint8_t, 16>;
  using FaultsBits = ocm::protocol::Bits<std::uint8_t, 24>;
  using OverloadBits = ocm::protocol::Bits<std::uint16_t, 32>;
  using BusErrorsBits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr double load_percent() const noexcept { return load; }
  constexpr void set_load_percent(double value) noexcept {
    load = ocm::protocol::nearest_raw<std::uint8_t>(value, 0, 100);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    LoadBits::put(data, load);
    BusBits::put(data, static_cast<std::uint8_t>(bus));
    PublishingBits::put(data, publishing);
    FaultsBits::put(data, faults);
    OverloadBits::put(data, overload);
    BusErrorsBits::put(data, bus_errors);
    return data;
  }
  [[nodiscard]] static constexpr LightRingStatusHealth decode(const ocm::can::Payload& data) noexcept {
    LightRingStatusHealth value;
    value.load = LoadBits::get(data);
    value.bus = static_cast<Bus>(BusBits::get(data));
    value.publishing = PublishingBits::get(data);
    value.faults = FaultsBits::get(data);
    value.overload = OverloadBits::get(data);
    value.bus_errors = BusErrorsBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const LightRingStatusHealth&, const LightRingStatusHealth&) = default;
};

/// Light ring status: how the board is. Sensor of LightRing, requests on 0x57. [decided, as
/// di_wheel_drive_status]
struct LightRingStatus {
  static constexpr std::string_view name = "light_ring_status";
  static constexpr ocm::protocol::TopicId id{0x57};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 2> frames{{
      {ocm::protocol::TopicId{0x57}, 8, {130, 130, 129, 130}},
      {ocm::protocol::TopicId{0x58}, 8, {131, 131, 131, 131}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{100};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::status;
  static constexpr ocm::base::Duration deadline = std::chrono::seconds{1};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  LightRingStatusIdentity identity;
  LightRingStatusHealth health;

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return identity.encode();
    if (frame == 1) return health.encode();
    return {};
  }
  [[nodiscard]] static constexpr LightRingStatus decode(
      const std::array<ocm::can::Payload, 2>& all) noexcept {
    LightRingStatus value;
    value.identity = LightRingStatusIdentity::decode(all[0]);
    value.health = LightRingStatusHealth::decode(all[1]);
    return value;
  }
  friend constexpr bool operator==(const LightRingStatus&, const LightRingStatus&) = default;
};
static_assert(ocm::protocol::TopicType<LightRingStatus>);

/// Light ring refusal: the last request or set point that the board refused; sent unasked. Sensor of
/// LightRing, requests on 0x59. [decided, as di_wheel_drive_refusal]
struct LightRingRefusal {
  static constexpr std::string_view name = "light_ring_refusal";
  static constexpr ocm::protocol::TopicId id{0x59};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x59}, 8, {130, 130, 129, 130}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{100};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::refusal;
  static constexpr ocm::base::Duration deadline = std::chrono::seconds{1};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  enum class Reason : std::uint8_t {
    nothing = 0,
    bad_length = 3,
    bad_mode = 4,
    bad_unit = 5,
    bad_period = 6,
    out_of_range = 7,
    not_served = 8,
    no_sample = 9,
    no_room = 10,
    no_answer = 13,
    bus_fault = 14,
    not_schedulable = 15,
  };

  /// the number that it was for; [0, 255]
  std::uint8_t topic = 0;
  Reason reason{};
  /// so many since the start; stays at its end; [0, 65535]
  std::uint16_t refused = 0;
  /// releases at which a part had nothing to say; stays at its end; [0, 65535]
  std::uint16_t not_sampled = 0;
  /// frames and characters of a host on the board's serial line that found no place; stays at its end; [0,
  /// 65535]
  std::uint16_t line_lost = 0;

  using TopicBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using ReasonBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using RefusedBits = ocm::protocol::Bits<std::uint16_t, 16>;
  using NotSampledBits = ocm::protocol::Bits<std::uint16_t, 32>;
  using LineLostBits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    TopicBits::put(data, topic);
    ReasonBits::put(data, static_cast<std::uint8_t>(reason));
    RefusedBits::put(data, refused);
    NotSampledBits::put(data, not_sampled);
    LineLostBits::put(data, line_lost);
    return data;
  }
  [[nodiscard]] static constexpr LightRingRefusal decode(const ocm::can::Payload& data) noexcept {
    LightRingRefusal value;
    value.topic = TopicBits::get(data);
    value.reason = static_cast<Reason>(ReasonBits::get(data));
    value.refused = RefusedBits::get(data);
    value.not_sampled = NotSampledBits::get(data);
    value.line_lost = LineLostBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr LightRingRefusal decode(
      const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const LightRingRefusal&, const LightRingRefusal&) = default;
};
static_assert(ocm::protocol::TopicType<LightRingRefusal>);

/// Travel: drives a distance, then turns an angle on the spot, by the wheel encoders, and stops; zeros end
/// it. Actuator of DiWheelDrive, set points on 0x0B. [decided: the thesis has no behaviours;
/// docs/behaviours.md has the reasons. The id is free in the board's block]
struct Travel {
  static constexpr std::string_view name = "travel";
  static constexpr ocm::protocol::TopicId id{0x0B};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x0B}, 8, {131, 129, 131, 130}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  /// [decided: it ends by itself; longer ones are refused]
  static constexpr ocm::base::Duration timeout = std::chrono::seconds{600};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  /// forwards; 0.00001 m a bit, [-10, 10] m
  std::int32_t distance = 0;
  /// counter-clockwise seen from above; 0.00001 rad a bit, [-62.83185, 62.83185] rad
  std::int32_t angle = 0;
  /// of the wheels, at most; needed; 0.0001 m/s a bit, [0, 0.3] m/s
  std::uint16_t speed = 0;

  using DistanceBits = ocm::protocol::Bits<std::int32_t, 0, 24>;
  using AngleBits = ocm::protocol::Bits<std::int32_t, 24, 24>;
  using SpeedBits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr double distance_m() const noexcept { return distance / 100'000.0; }
  constexpr void set_distance_m(double value) noexcept {
    distance = ocm::protocol::nearest_raw<std::int32_t>(value * 100'000.0, -1'000'000, 1'000'000);
  }
  [[nodiscard]] constexpr double angle_rad() const noexcept { return angle / 100'000.0; }
  constexpr void set_angle_rad(double value) noexcept {
    angle = ocm::protocol::nearest_raw<std::int32_t>(value * 100'000.0, -6'283'185, 6'283'185);
  }
  [[nodiscard]] constexpr double speed_m_per_s() const noexcept { return speed / 10'000.0; }
  constexpr void set_speed_m_per_s(double value) noexcept {
    speed = ocm::protocol::nearest_raw<std::uint16_t>(value * 10'000.0, 0, 3'000);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    DistanceBits::put(data, distance);
    AngleBits::put(data, angle);
    SpeedBits::put(data, speed);
    return data;
  }
  [[nodiscard]] static constexpr Travel decode(const ocm::can::Payload& data) noexcept {
    Travel value;
    value.distance = DistanceBits::get(data);
    value.angle = AngleBits::get(data);
    value.speed = SpeedBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Travel decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Travel&, const Travel&) = default;
};
static_assert(ocm::protocol::TopicType<Travel>);

/// Follow: follows a dark line with the floor sensors, until zero or silence. Actuator of DiWheelDrive, set
/// points on 0x0C. [decided, as travel]
struct Follow {
  static constexpr std::string_view name = "follow";
  static constexpr ocm::protocol::TopicId id{0x0C};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x0C}, 2, {71, 69, 71, 69}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout = std::chrono::milliseconds{500};  ///< [decided, as motors]
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  std::uint16_t speed = 0;  ///< along the line, at most; 0.0001 m/s a bit, [0, 0.2] m/s

  using SpeedBits = ocm::protocol::Bits<std::uint16_t, 0>;

  [[nodiscard]] constexpr double speed_m_per_s() const noexcept { return speed / 10'000.0; }
  constexpr void set_speed_m_per_s(double value) noexcept {
    speed = ocm::protocol::nearest_raw<std::uint16_t>(value * 10'000.0, 0, 2'000);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    SpeedBits::put(data, speed);
    return data;
  }
  [[nodiscard]] static constexpr Follow decode(const ocm::can::Payload& data) noexcept {
    Follow value;
    value.speed = SpeedBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Follow decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Follow&, const Follow&) = default;
};
static_assert(ocm::protocol::TopicType<Follow>);

/// Behaviour: what the wheels' board does by itself, and how that ended. Sensor of DiWheelDrive, requests on
/// 0x0D. [decided, as travel]
struct Behaviour {
  static constexpr std::string_view name = "behaviour";
  static constexpr ocm::protocol::TopicId id{0x0D};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x0D}, 8, {131, 130, 131, 130}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{100, ocm::protocol::PeriodUnit::milliseconds};
  /// [decided: a step of the behaviours]
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{20};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  enum class Active : std::uint8_t {
    none = 0,
    travel = 1,
    follow = 2,
  };
  enum class Ended : std::uint8_t {
    nothing = 0,
    arrived = 1,
    stopped = 2,
    replaced = 3,
    no_sample = 4,
    line_lost = 5,
    too_long = 6,
    late = 7,
  };

  Active active{};
  /// how the last one ended; nothing before the first end, and while one is active
  Ended ended{};
  /// left of the way ahead; 0.00001 m a bit, [-83.88608, 83.88607] m
  std::int32_t distance = 0;
  /// left of the turn; 0.00001 rad a bit, [-83.88608, 83.88607] rad
  std::int32_t angle = 0;

  using ActiveBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using EndedBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using DistanceBits = ocm::protocol::Bits<std::int32_t, 16, 24>;
  using AngleBits = ocm::protocol::Bits<std::int32_t, 40, 24>;

  [[nodiscard]] constexpr double distance_m() const noexcept { return distance / 100'000.0; }
  constexpr void set_distance_m(double value) noexcept {
    distance = ocm::protocol::nearest_raw<std::int32_t>(value * 100'000.0, -8'388'608, 8'388'607);
  }
  [[nodiscard]] constexpr double angle_rad() const noexcept { return angle / 100'000.0; }
  constexpr void set_angle_rad(double value) noexcept {
    angle = ocm::protocol::nearest_raw<std::int32_t>(value * 100'000.0, -8'388'608, 8'388'607);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    ActiveBits::put(data, static_cast<std::uint8_t>(active));
    EndedBits::put(data, static_cast<std::uint8_t>(ended));
    DistanceBits::put(data, distance);
    AngleBits::put(data, angle);
    return data;
  }
  [[nodiscard]] static constexpr Behaviour decode(const ocm::can::Payload& data) noexcept {
    Behaviour value;
    value.active = static_cast<Active>(ActiveBits::get(data));
    value.ended = static_cast<Ended>(EndedBits::get(data));
    value.distance = DistanceBits::get(data);
    value.angle = AngleBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Behaviour decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Behaviour&, const Behaviour&) = default;
};
static_assert(ocm::protocol::TopicType<Behaviour>);

/// Avoid: wanders and keeps clear of obstacles: the ring's board commands the motors, until zero or silence.
/// Actuator of PowerManagement, set points on 0x29. [decided, as travel]
struct Avoid {
  static constexpr std::string_view name = "avoid";
  static constexpr ocm::protocol::TopicId id{0x29};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x29}, 2, {71, 70, 69, 69}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout = std::chrono::milliseconds{500};  ///< [decided, as motors]
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  std::uint16_t speed = 0;  ///< where nothing is near, at most; 0.0001 m/s a bit, [0, 0.2] m/s

  using SpeedBits = ocm::protocol::Bits<std::uint16_t, 0>;

  [[nodiscard]] constexpr double speed_m_per_s() const noexcept { return speed / 10'000.0; }
  constexpr void set_speed_m_per_s(double value) noexcept {
    speed = ocm::protocol::nearest_raw<std::uint16_t>(value * 10'000.0, 0, 2'000);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    SpeedBits::put(data, speed);
    return data;
  }
  [[nodiscard]] static constexpr Avoid decode(const ocm::can::Payload& data) noexcept {
    Avoid value;
    value.speed = SpeedBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Avoid decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Avoid&, const Avoid&) = default;
};
static_assert(ocm::protocol::TopicType<Avoid>);

/// Home: drives to the nearest wall and stands before it, head on: the ring's board commands the motors,
/// until zero or silence. Actuator of PowerManagement, set points on 0x2A. [decided, as travel]
struct Home {
  static constexpr std::string_view name = "home";
  static constexpr ocm::protocol::TopicId id{0x2A};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x2A}, 4, {91, 90, 90, 90}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout = std::chrono::milliseconds{500};  ///< [decided, as motors]
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  /// from the wall to the robot's edge, from 0.03 m; 0 with speed 0, its end; 0.0001 m a bit, [0, 0.12] m
  std::uint16_t distance = 0;
  /// at most; needed; 0.0001 m/s a bit, [0, 0.2] m/s
  std::uint16_t speed = 0;

  using DistanceBits = ocm::protocol::Bits<std::uint16_t, 0>;
  using SpeedBits = ocm::protocol::Bits<std::uint16_t, 16>;

  [[nodiscard]] constexpr double distance_m() const noexcept { return distance / 10'000.0; }
  constexpr void set_distance_m(double value) noexcept {
    distance = ocm::protocol::nearest_raw<std::uint16_t>(value * 10'000.0, 0, 1'200);
  }
  [[nodiscard]] constexpr double speed_m_per_s() const noexcept { return speed / 10'000.0; }
  constexpr void set_speed_m_per_s(double value) noexcept {
    speed = ocm::protocol::nearest_raw<std::uint16_t>(value * 10'000.0, 0, 2'000);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    DistanceBits::put(data, distance);
    SpeedBits::put(data, speed);
    return data;
  }
  [[nodiscard]] static constexpr Home decode(const ocm::can::Payload& data) noexcept {
    Home value;
    value.distance = DistanceBits::get(data);
    value.speed = SpeedBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Home decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Home&, const Home&) = default;
};
static_assert(ocm::protocol::TopicType<Home>);

/// Batteries, one battery.
struct BatteriesBattery {
  static constexpr ocm::protocol::TopicId id{0x2B};  ///< of the first of 2
  static constexpr std::uint8_t dlc = 8;

  static constexpr std::uint16_t voltage_no_battery = 0;

  /// without a battery everything is 0; 0.001 V a bit, [0, 6] V
  std::uint16_t voltage = 0;
  /// mean of a second; negative: out of the battery; 0.001 A a bit, [-32.768, 32.767] A
  std::int16_t current = 0;
  /// charge that is left at the present load; [0, 65535] mAh
  std::uint16_t remaining = 0;
  /// by the gauge's sensor; 0.1 degC a bit, from -273.15 degC on, [-273.15, 6280.35] degC
  std::uint16_t temperature = 0;

  using VoltageBits = ocm::protocol::Bits<std::uint16_t, 0>;
  using CurrentBits = ocm::protocol::Bits<std::int16_t, 16>;
  using RemainingBits = ocm::protocol::Bits<std::uint16_t, 32>;
  using TemperatureBits = ocm::protocol::Bits<std::uint16_t, 48>;

  [[nodiscard]] constexpr double voltage_V() const noexcept { return voltage / 1'000.0; }
  constexpr void set_voltage_V(double value) noexcept {
    voltage = ocm::protocol::nearest_raw<std::uint16_t>(value * 1'000.0, 0, 6'000);
  }
  [[nodiscard]] constexpr double current_A() const noexcept { return current / 1'000.0; }
  constexpr void set_current_A(double value) noexcept {
    current = ocm::protocol::nearest_raw<std::int16_t>(value * 1'000.0, CurrentBits::min, CurrentBits::max);
  }
  [[nodiscard]] constexpr double remaining_mAh() const noexcept { return remaining; }
  constexpr void set_remaining_mAh(double value) noexcept {
    remaining = ocm::protocol::nearest_raw<std::uint16_t>(value, RemainingBits::min, RemainingBits::max);
  }
  [[nodiscard]] constexpr double temperature_celsius() const noexcept {
    return (temperature * 10.0 - 27'315.0) / 100.0;
  }
  constexpr void set_temperature_celsius(double value) noexcept {
    temperature = ocm::protocol::nearest_raw<std::uint16_t>((value * 100.0 + 27'315.0) / 10.0,
                                                            TemperatureBits::min, TemperatureBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    VoltageBits::put(data, voltage);
    CurrentBits::put(data, current);
    RemainingBits::put(data, remaining);
    TemperatureBits::put(data, temperature);
    return data;
  }
  [[nodiscard]] static constexpr BatteriesBattery decode(const ocm::can::Payload& data) noexcept {
    BatteriesBattery value;
    value.voltage = VoltageBits::get(data);
    value.current = CurrentBits::get(data);
    value.remaining = RemainingBits::get(data);
    value.temperature = TemperatureBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const BatteriesBattery&, const BatteriesBattery&) = default;
};

/// Batteries: each battery by itself, one frame a battery: the front one, then the one behind. Sensor of
/// PowerManagement, requests on 0x2B. [BQ27500 data sheet, table 4-1: mV, mA, mAh, 0.1 K; id decided: free in
/// the board's block]
struct Batteries {
  static constexpr std::string_view name = "batteries";
  static constexpr ocm::protocol::TopicId id{0x2B};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 2> frames{{
      {ocm::protocol::TopicId{0x2B}, 8, {130, 130, 130, 130}},
      {ocm::protocol::TopicId{0x2C}, 8, {131, 131, 131, 131}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  /// [decided: the gauge's own]
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  /// [BQ27500 data sheet: gauge updated every second]
  static constexpr ocm::base::Duration shortest_period = std::chrono::seconds{1};
  /// [decided: the period]
  static constexpr ocm::base::Duration deadline = std::chrono::seconds{1};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  /// [decided: a sample takes long and is not urgent; at medium it would delay the ring]
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  std::array<BatteriesBattery, 2> battery{};

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame < battery.size()) return battery[frame].encode();
    return {};
  }
  [[nodiscard]] static constexpr Batteries decode(const std::array<ocm::can::Payload, 2>& all) noexcept {
    Batteries value;
    for (std::size_t i = 0; i < value.battery.size(); ++i)
      value.battery[i] = BatteriesBattery::decode(all[i]);
    return value;
  }
  friend constexpr bool operator==(const Batteries&, const Batteries&) = default;
};
static_assert(ocm::protocol::TopicType<Batteries>);

/// Ring light, one sensor.
struct RingLightSensor {
  static constexpr ocm::protocol::TopicId id{0x2D};  ///< of the first of 8
  static constexpr std::uint8_t dlc = 2;

  /// one conversion, not averaged: lamps flicker; 0.25 lx a bit, [0, 16383.75] lx
  std::uint16_t illuminance = 0;

  using IlluminanceBits = ocm::protocol::Bits<std::uint16_t, 0>;

  [[nodiscard]] constexpr double illuminance_lx() const noexcept { return illuminance / 4.0; }
  constexpr void set_illuminance_lx(double value) noexcept {
    illuminance =
        ocm::protocol::nearest_raw<std::uint16_t>(value * 4.0, IlluminanceBits::min, IlluminanceBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    IlluminanceBits::put(data, illuminance);
    return data;
  }
  [[nodiscard]] static constexpr RingLightSensor decode(const ocm::can::Payload& data) noexcept {
    RingLightSensor value;
    value.illuminance = IlluminanceBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const RingLightSensor&, const RingLightSensor&) = default;
};

/// Ring light: ambient light around the robot, one frame a sensor of the ring. Sensor of PowerManagement,
/// requests on 0x2D. [VCNL4020 data sheet: 0.25 lx a count; id decided: free in the board's block]
struct RingLight {
  static constexpr std::string_view name = "ring_light";
  static constexpr ocm::protocol::TopicId id{0x2D};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 8> frames{{
      {ocm::protocol::TopicId{0x2D}, 2, {69, 70, 69, 70}},
      {ocm::protocol::TopicId{0x2E}, 2, {69, 70, 70, 70}},
      {ocm::protocol::TopicId{0x2F}, 2, {70, 70, 70, 70}},
      {ocm::protocol::TopicId{0x30}, 2, {70, 70, 69, 69}},
      {ocm::protocol::TopicId{0x31}, 2, {69, 69, 70, 69}},
      {ocm::protocol::TopicId{0x32}, 2, {69, 69, 70, 70}},
      {ocm::protocol::TopicId{0x33}, 2, {70, 69, 70, 70}},
      {ocm::protocol::TopicId{0x34}, 2, {69, 69, 70, 70}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  /// [decided: light changes slowly]
  static constexpr ocm::protocol::Period period{500, ocm::protocol::PeriodUnit::milliseconds};
  /// [VCNL4020 data sheet: at most 10 measurements of ambient light a second]
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{100};
  /// [decided: the period]
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{500};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  /// [decided: as of batteries]
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  std::array<RingLightSensor, 8> sensor{};

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame < sensor.size()) return sensor[frame].encode();
    return {};
  }
  [[nodiscard]] static constexpr RingLight decode(const std::array<ocm::can::Payload, 8>& all) noexcept {
    RingLight value;
    for (std::size_t i = 0; i < value.sensor.size(); ++i) value.sensor[i] = RingLightSensor::decode(all[i]);
    return value;
  }
  friend constexpr bool operator==(const RingLight&, const RingLight&) = default;
};
static_assert(ocm::protocol::TopicType<RingLight>);

// clang-format off
namespace detail {
namespace protocol = ocm::protocol;

// Fields: name, {start, width, order}, signed, scale, offset, unit, lowest and highest raw number,
// names of values or flags, whether flags. Scale and offset: {digits, power of ten}.
// Frames: name, id, DLC, fields, most bits by priority, fields with what is derived of them.
// Laws of what is derived: at one, offset, noise, least and greatest value at which they hold.
// Topics: index of the board, aliases, frames, source, and of several of a kind: number and name.

namespace odometry_velocity {
inline constexpr std::array<protocol::Field, 2> fields{{
  {"x", {0, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "m/s", INT32_MIN, 2'147'483'647, {}, false},
  {"z", {32, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "rad/s", INT32_MIN, 2'147'483'647, {}, false},
}};
}  // namespace odometry_velocity
namespace odometry_pose {
inline constexpr std::array<protocol::Field, 3> fields{{
  {"x", {0, 24, protocol::ByteOrder::little}, true, {256, -6}, {}, "m", -8'388'608, 8'388'607, {}, false},
  {"y", {24, 24, protocol::ByteOrder::little}, true, {256, -6}, {}, "m", -8'388'608, 8'388'607, {}, false},
  {"orientation", {48, 16, protocol::ByteOrder::little}, false, {256, -6}, {}, "rad", 0, 24'543, {}, false},
}};
}  // namespace odometry_pose
namespace odometry {
inline constexpr std::array<std::string_view, 1> aliases{"odom"};
inline constexpr std::array<protocol::FrameLayout, 2> frames{{
  {"velocity", protocol::TopicId{0x02}, 8, odometry_velocity::fields, {131, 131, 131, 131}},
  {"pose", protocol::TopicId{0x03}, 8, odometry_pose::fields, {131, 131, 131, 131}},
}};
inline constexpr std::string_view source =
  "Thesis 4.2.1; shortest_period: AMiRo-OS 1.0, Odometry: updated every 50 ms";
}  // namespace odometry

namespace floor_proximity {
inline constexpr std::array<std::string_view, 1> aliases{"floor"};
inline constexpr std::array<protocol::Field, 4> fields{{
  {"sensor_1", {0, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"sensor_2", {16, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"sensor_3", {32, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"sensor_4", {48, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x04}, 8, fields, {132, 132, 132, 132}},
}};
inline constexpr std::string_view source =
  "Thesis table 4.4; counts: VCNL4020 data sheet; shortest_period: VCNL4020 data sheet: at most 250 proximity measurements/s";
}  // namespace floor_proximity

namespace magnetometer_x {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"field", {0, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "G", -5'242'880, 5'240'320, {}, false},
}};
}  // namespace magnetometer_x
namespace magnetometer_y {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"field", {0, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "G", -5'242'880, 5'240'320, {}, false},
}};
}  // namespace magnetometer_y
namespace magnetometer_z {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"field", {0, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "G", -5'242'880, 5'240'320, {}, false},
}};
}  // namespace magnetometer_z
namespace magnetometer {
inline constexpr std::array<std::string_view, 1> aliases{"mag"};
inline constexpr std::array<protocol::FrameLayout, 3> frames{{
  {"x", protocol::TopicId{0x05}, 4, magnetometer_x::fields, {91, 90, 90, 90}},
  {"y", protocol::TopicId{0x06}, 4, magnetometer_y::fields, {91, 92, 91, 91}},
  {"z", protocol::TopicId{0x07}, 4, magnetometer_z::fields, {90, 90, 90, 90}},
}};
inline constexpr std::string_view source =
  "Thesis table 4.3; 1 uG a bit in steps of 2560: HMC5883L data sheet, 390 counts/G at +-4.7 G; shortest_period: HMC5883L data sheet: 75 Hz in continuous mode";
}  // namespace magnetometer

namespace gyroscope {
inline constexpr std::array<std::string_view, 1> aliases{"gyro"};
inline constexpr std::array<protocol::Field, 3> fields{{
  {"x", {0, 16, protocol::ByteOrder::little}, true, {175, -4}, {}, "deg/s", -28'571, 28'571, {}, false},
  {"y", {16, 16, protocol::ByteOrder::little}, true, {175, -4}, {}, "deg/s", -28'571, 28'571, {}, false},
  {"z", {32, 16, protocol::ByteOrder::little}, true, {175, -4}, {}, "deg/s", -28'571, 28'571, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x08}, 6, fields, {111, 110, 111, 110}},
}};
inline constexpr std::string_view source =
  "Thesis table 4.1; scale: L3G4200D data sheet, table 4, at 500 dps; shortest_period: L3G4200D data sheet: 800 Hz";
}  // namespace gyroscope

namespace accelerometer {
inline constexpr std::array<std::string_view, 1> aliases{"accel"};
inline constexpr std::array<protocol::Field, 3> fields{{
  {"x", {0, 16, protocol::ByteOrder::little}, true, {9765625, -10}, {}, "g", -8'192, 8'192, {}, false},
  {"y", {16, 16, protocol::ByteOrder::little}, true, {9765625, -10}, {}, "g", -8'192, 8'192, {}, false},
  {"z", {32, 16, protocol::ByteOrder::little}, true, {9765625, -10}, {}, "g", -8'192, 8'192, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x09}, 6, fields, {110, 109, 111, 109}},
}};
inline constexpr std::string_view source =
  "Thesis table 4.2; scale: z reads near 1024 at rest, thesis figure 6.3; shortest_period: LIS331DLH data sheet: 1000 Hz";
}  // namespace accelerometer

namespace power_status {
inline constexpr std::array<std::string_view, 1> aliases{"power"};
inline constexpr std::array<protocol::NamedValue, 2> flags_names{{{0, "plugged"}, {1, "charging"}}};
inline constexpr std::array<protocol::NamedValue, 1> minutes_names{{{65'535, "unknown"}}};
inline constexpr std::array<protocol::Field, 4> fields{{
  {"flags", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, flags_names, true},
  {"state_of_charge", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "%", 0, 100, {}, false},
  {"minutes", {16, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "min", 0, 65'535, minutes_names, false},
  {"power", {32, 16, protocol::ByteOrder::little}, true, {1, 0}, {}, "mW", -32'768, 32'767, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x1E}, 6, fields, {112, 110, 110, 110}},
}};
inline constexpr std::string_view source =
  "Thesis table 4.7; shortest_period: BQ27500 data sheet: gauge updated every second";
}  // namespace power_status

namespace proximity_ring_sensor {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"proximity", {0, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
inline constexpr std::array<protocol::Law, 8> distance_laws{{
  {{942693757, -9}, {2289, 0}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {2302, 0}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {242, 1}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {235, 1}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {2318, 0}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {2272, 0}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {2382, 0}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {2269, 0}, {457, -2}, {38, -4}, {2, -1}},
}};
inline constexpr std::array<protocol::Field, 3> with_derived_1{{
  fields[0],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[0], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[0], true),
}};
inline constexpr std::array<protocol::Field, 3> with_derived_2{{
  fields[0],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[1], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[1], true),
}};
inline constexpr std::array<protocol::Field, 3> with_derived_3{{
  fields[0],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[2], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[2], true),
}};
inline constexpr std::array<protocol::Field, 3> with_derived_4{{
  fields[0],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[3], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[3], true),
}};
inline constexpr std::array<protocol::Field, 3> with_derived_5{{
  fields[0],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[4], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[4], true),
}};
inline constexpr std::array<protocol::Field, 3> with_derived_6{{
  fields[0],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[5], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[5], true),
}};
inline constexpr std::array<protocol::Field, 3> with_derived_7{{
  fields[0],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[6], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[6], true),
}};
inline constexpr std::array<protocol::Field, 3> with_derived_8{{
  fields[0],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[7], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[7], true),
}};
}  // namespace proximity_ring_sensor
namespace proximity_ring {
inline constexpr std::array<std::string_view, 1> aliases{"ring"};
inline constexpr std::array<protocol::FrameLayout, 8> frames{{
  {"sensor_1", protocol::TopicId{0x1F}, 2, proximity_ring_sensor::fields, {72, 71, 70, 71}, proximity_ring_sensor::with_derived_1},
  {"sensor_2", protocol::TopicId{0x20}, 2, proximity_ring_sensor::fields, {70, 71, 70, 71}, proximity_ring_sensor::with_derived_2},
  {"sensor_3", protocol::TopicId{0x21}, 2, proximity_ring_sensor::fields, {70, 71, 69, 69}, proximity_ring_sensor::with_derived_3},
  {"sensor_4", protocol::TopicId{0x22}, 2, proximity_ring_sensor::fields, {70, 70, 69, 69}, proximity_ring_sensor::with_derived_4},
  {"sensor_5", protocol::TopicId{0x23}, 2, proximity_ring_sensor::fields, {70, 70, 70, 70}, proximity_ring_sensor::with_derived_5},
  {"sensor_6", protocol::TopicId{0x24}, 2, proximity_ring_sensor::fields, {70, 69, 69, 69}, proximity_ring_sensor::with_derived_6},
  {"sensor_7", protocol::TopicId{0x25}, 2, proximity_ring_sensor::fields, {70, 70, 69, 70}, proximity_ring_sensor::with_derived_7},
  {"sensor_8", protocol::TopicId{0x26}, 2, proximity_ring_sensor::fields, {70, 69, 70, 69}, proximity_ring_sensor::with_derived_8},
}};
inline constexpr std::string_view source =
  "Thesis table 4.8; counts: VCNL4020 data sheet; shortest_period: VCNL4020 data sheet: at most 250 proximity measurements/s; geometry: radius: amiro.xacro of amiro_robot; angles: AMiRo-OS 1.0, Constants.h";
}  // namespace proximity_ring

namespace motors {
inline constexpr std::array<protocol::Field, 2> fields{{
  {"x", {0, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "m/s", -1'000'000, 1'000'000, {}, false},
  {"z", {32, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "rad/s", -28'985'507, 28'985'507, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x01}, 8, fields, {132, 131, 131, 131}},
}};
inline constexpr std::string_view source =
  "Thesis table 4.9, its bytes read as little-endian; id decided: the thesis names a header that is not public; timeout decided: five set points at 100 ms lost in a row";
}  // namespace motors

namespace led {
inline constexpr std::array<protocol::Field, 3> fields{{
  {"red", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"green", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"blue", {16, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 8> frames{{
  {"", protocol::TopicId{0x3C}, 3, fields, {81, 80, 80, 80}},
  {"", protocol::TopicId{0x3D}, 3, fields, {82, 80, 80, 80}},
  {"", protocol::TopicId{0x3E}, 3, fields, {82, 81, 81, 81}},
  {"", protocol::TopicId{0x3F}, 3, fields, {83, 81, 81, 82}},
  {"", protocol::TopicId{0x40}, 3, fields, {82, 81, 81, 81}},
  {"", protocol::TopicId{0x41}, 3, fields, {82, 82, 82, 82}},
  {"", protocol::TopicId{0x42}, 3, fields, {81, 81, 80, 80}},
  {"", protocol::TopicId{0x43}, 3, fields, {81, 80, 81, 80}},
}};
inline constexpr std::string_view source =
  "Thesis 4.2.2, LEDs; id decided: the thesis names a header that is not public";
}  // namespace led

namespace floor_calibration {
inline constexpr std::array<protocol::NamedValue, 3> action_names{{{0, "none"}, {1, "measure"},
                                                                   {2, "forget"}}};
inline constexpr std::array<protocol::Field, 1> fields{{
  {"action", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, action_names, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x0A}, 1, fields, {61, 59, 60, 59}},
}};
inline constexpr std::string_view source =
  "decided: a command of the shell of AMiRo-OS 1.0 has none on the bus; id decided: free in the board's block";
}  // namespace floor_calibration

namespace ring_calibration {
inline constexpr std::array<protocol::NamedValue, 3> action_names{{{0, "none"}, {1, "measure"},
                                                                   {2, "forget"}}};
inline constexpr std::array<protocol::Field, 1> fields{{
  {"action", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, action_names, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x27}, 1, fields, {60, 59, 59, 60}},
}};
inline constexpr std::string_view source =
  "decided, as floor_calibration";
}  // namespace ring_calibration

namespace di_wheel_drive_status_identity {
inline constexpr std::array<protocol::NamedValue, 12> reset_names{{{0, "unknown"}, {1, "power"}, {2, "pin"},
                                                                   {3, "software"}, {4, "watchdog"},
                                                                   {5, "low_power"}, {6, "fault"},
                                                                   {7, "memory_fault"}, {8, "bus_fault"},
                                                                   {9, "usage_fault"}, {10, "kernel_halt"},
                                                                   {11, "clock_failure"}}};
inline constexpr std::array<protocol::Field, 3> fields{{
  {"uptime", {0, 24, protocol::ByteOrder::little}, false, {1, 0}, {}, "s", 0, 16'777'215, {}, false},
  {"reset", {24, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, reset_names, false},
  {"wire_hash", {32, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 4'294'967'295, {}, false},
}};
}  // namespace di_wheel_drive_status_identity
namespace di_wheel_drive_status_health {
inline constexpr std::array<protocol::NamedValue, 1> load_names{{{255, "unknown"}}};
inline constexpr std::array<protocol::NamedValue, 4> bus_names{{{0, "active"}, {1, "warning"}, {2, "passive"},
                                                                {3, "off"}}};
inline constexpr std::array<protocol::Field, 6> fields{{
  {"load", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "%", 0, 100, load_names, false},
  {"bus", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, bus_names, false},
  {"publishing", {16, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"faults", {24, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"overload", {32, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"bus_errors", {48, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
}  // namespace di_wheel_drive_status_health
namespace di_wheel_drive_status {
inline constexpr std::array<protocol::FrameLayout, 2> frames{{
  {"identity", protocol::TopicId{0x1B}, 8, di_wheel_drive_status_identity::fields, {131, 130, 130, 130}},
  {"health", protocol::TopicId{0x1C}, 8, di_wheel_drive_status_health::fields, {132, 131, 131, 131}},
}};
inline constexpr std::string_view source =
  "decided: status ids at the end of each board's block of 30";
}  // namespace di_wheel_drive_status

namespace di_wheel_drive_refusal {
inline constexpr std::array<protocol::NamedValue, 12> reason_names{{{0, "nothing"}, {3, "bad_length"},
                                                                    {4, "bad_mode"}, {5, "bad_unit"},
                                                                    {6, "bad_period"}, {7, "out_of_range"},
                                                                    {8, "not_served"}, {9, "no_sample"},
                                                                    {10, "no_room"}, {13, "no_answer"},
                                                                    {14, "bus_fault"},
                                                                    {15, "not_schedulable"}}};
inline constexpr std::array<protocol::Field, 5> fields{{
  {"topic", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"reason", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, reason_names, false},
  {"refused", {16, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"not_sampled", {32, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"line_lost", {48, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x1D}, 8, fields, {131, 130, 130, 130}},
}};
inline constexpr std::string_view source =
  "decided: status ids at the end of each board's block of 30; reasons as ocm::base::Error numbers them";
}  // namespace di_wheel_drive_refusal

namespace power_management_status_identity {
inline constexpr std::array<protocol::NamedValue, 12> reset_names{{{0, "unknown"}, {1, "power"}, {2, "pin"},
                                                                   {3, "software"}, {4, "watchdog"},
                                                                   {5, "low_power"}, {6, "fault"},
                                                                   {7, "memory_fault"}, {8, "bus_fault"},
                                                                   {9, "usage_fault"}, {10, "kernel_halt"},
                                                                   {11, "clock_failure"}}};
inline constexpr std::array<protocol::Field, 3> fields{{
  {"uptime", {0, 24, protocol::ByteOrder::little}, false, {1, 0}, {}, "s", 0, 16'777'215, {}, false},
  {"reset", {24, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, reset_names, false},
  {"wire_hash", {32, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 4'294'967'295, {}, false},
}};
}  // namespace power_management_status_identity
namespace power_management_status_health {
inline constexpr std::array<protocol::NamedValue, 1> load_names{{{255, "unknown"}}};
inline constexpr std::array<protocol::NamedValue, 4> bus_names{{{0, "active"}, {1, "warning"}, {2, "passive"},
                                                                {3, "off"}}};
inline constexpr std::array<protocol::Field, 6> fields{{
  {"load", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "%", 0, 100, load_names, false},
  {"bus", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, bus_names, false},
  {"publishing", {16, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"faults", {24, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"overload", {32, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"bus_errors", {48, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
}  // namespace power_management_status_health
namespace power_management_status {
inline constexpr std::array<protocol::FrameLayout, 2> frames{{
  {"identity", protocol::TopicId{0x39}, 8, power_management_status_identity::fields, {129, 130, 130, 130}},
  {"health", protocol::TopicId{0x3A}, 8, power_management_status_health::fields, {130, 130, 130, 130}},
}};
inline constexpr std::string_view source =
  "decided, as di_wheel_drive_status";
}  // namespace power_management_status

namespace power_management_refusal {
inline constexpr std::array<protocol::NamedValue, 12> reason_names{{{0, "nothing"}, {3, "bad_length"},
                                                                    {4, "bad_mode"}, {5, "bad_unit"},
                                                                    {6, "bad_period"}, {7, "out_of_range"},
                                                                    {8, "not_served"}, {9, "no_sample"},
                                                                    {10, "no_room"}, {13, "no_answer"},
                                                                    {14, "bus_fault"},
                                                                    {15, "not_schedulable"}}};
inline constexpr std::array<protocol::Field, 5> fields{{
  {"topic", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"reason", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, reason_names, false},
  {"refused", {16, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"not_sampled", {32, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"line_lost", {48, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x3B}, 8, fields, {130, 130, 130, 130}},
}};
inline constexpr std::string_view source =
  "decided, as di_wheel_drive_refusal";
}  // namespace power_management_refusal

namespace light_ring_status_identity {
inline constexpr std::array<protocol::NamedValue, 12> reset_names{{{0, "unknown"}, {1, "power"}, {2, "pin"},
                                                                   {3, "software"}, {4, "watchdog"},
                                                                   {5, "low_power"}, {6, "fault"},
                                                                   {7, "memory_fault"}, {8, "bus_fault"},
                                                                   {9, "usage_fault"}, {10, "kernel_halt"},
                                                                   {11, "clock_failure"}}};
inline constexpr std::array<protocol::Field, 3> fields{{
  {"uptime", {0, 24, protocol::ByteOrder::little}, false, {1, 0}, {}, "s", 0, 16'777'215, {}, false},
  {"reset", {24, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, reset_names, false},
  {"wire_hash", {32, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 4'294'967'295, {}, false},
}};
}  // namespace light_ring_status_identity
namespace light_ring_status_health {
inline constexpr std::array<protocol::NamedValue, 1> load_names{{{255, "unknown"}}};
inline constexpr std::array<protocol::NamedValue, 4> bus_names{{{0, "active"}, {1, "warning"}, {2, "passive"},
                                                                {3, "off"}}};
inline constexpr std::array<protocol::Field, 6> fields{{
  {"load", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "%", 0, 100, load_names, false},
  {"bus", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, bus_names, false},
  {"publishing", {16, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"faults", {24, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"overload", {32, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"bus_errors", {48, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
}  // namespace light_ring_status_health
namespace light_ring_status {
inline constexpr std::array<protocol::FrameLayout, 2> frames{{
  {"identity", protocol::TopicId{0x57}, 8, light_ring_status_identity::fields, {130, 130, 129, 130}},
  {"health", protocol::TopicId{0x58}, 8, light_ring_status_health::fields, {131, 131, 131, 131}},
}};
inline constexpr std::string_view source =
  "decided, as di_wheel_drive_status";
}  // namespace light_ring_status

namespace light_ring_refusal {
inline constexpr std::array<protocol::NamedValue, 12> reason_names{{{0, "nothing"}, {3, "bad_length"},
                                                                    {4, "bad_mode"}, {5, "bad_unit"},
                                                                    {6, "bad_period"}, {7, "out_of_range"},
                                                                    {8, "not_served"}, {9, "no_sample"},
                                                                    {10, "no_room"}, {13, "no_answer"},
                                                                    {14, "bus_fault"},
                                                                    {15, "not_schedulable"}}};
inline constexpr std::array<protocol::Field, 5> fields{{
  {"topic", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"reason", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, reason_names, false},
  {"refused", {16, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"not_sampled", {32, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"line_lost", {48, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x59}, 8, fields, {130, 130, 129, 130}},
}};
inline constexpr std::string_view source =
  "decided, as di_wheel_drive_refusal";
}  // namespace light_ring_refusal

namespace travel {
inline constexpr std::array<protocol::Field, 3> fields{{
  {"distance", {0, 24, protocol::ByteOrder::little}, true, {1, -5}, {}, "m", -1'000'000, 1'000'000, {}, false},
  {"angle", {24, 24, protocol::ByteOrder::little}, true, {1, -5}, {}, "rad", -6'283'185, 6'283'185, {}, false},
  {"speed", {48, 16, protocol::ByteOrder::little}, false, {1, -4}, {}, "m/s", 0, 3'000, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x0B}, 8, fields, {131, 129, 131, 130}},
}};
inline constexpr std::string_view source =
  "decided: the thesis has no behaviours; docs/behaviours.md has the reasons. The id is free in the board's block; timeout decided: it ends by itself; longer ones are refused";
}  // namespace travel

namespace follow {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"speed", {0, 16, protocol::ByteOrder::little}, false, {1, -4}, {}, "m/s", 0, 2'000, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x0C}, 2, fields, {71, 69, 71, 69}},
}};
inline constexpr std::string_view source =
  "decided, as travel; timeout decided, as motors";
}  // namespace follow

namespace behaviour {
inline constexpr std::array<protocol::NamedValue, 3> active_names{{{0, "none"}, {1, "travel"},
                                                                   {2, "follow"}}};
inline constexpr std::array<protocol::NamedValue, 8> ended_names{{{0, "nothing"}, {1, "arrived"},
                                                                  {2, "stopped"}, {3, "replaced"},
                                                                  {4, "no_sample"}, {5, "line_lost"},
                                                                  {6, "too_long"}, {7, "late"}}};
inline constexpr std::array<protocol::Field, 4> fields{{
  {"active", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, active_names, false},
  {"ended", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, ended_names, false},
  {"distance", {16, 24, protocol::ByteOrder::little}, true, {1, -5}, {}, "m", -8'388'608, 8'388'607, {}, false},
  {"angle", {40, 24, protocol::ByteOrder::little}, true, {1, -5}, {}, "rad", -8'388'608, 8'388'607, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x0D}, 8, fields, {131, 130, 131, 130}},
}};
inline constexpr std::string_view source =
  "decided, as travel; shortest_period decided: a step of the behaviours";
}  // namespace behaviour

namespace avoid {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"speed", {0, 16, protocol::ByteOrder::little}, false, {1, -4}, {}, "m/s", 0, 2'000, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x29}, 2, fields, {71, 70, 69, 69}},
}};
inline constexpr std::string_view source =
  "decided, as travel; timeout decided, as motors";
}  // namespace avoid

namespace home {
inline constexpr std::array<protocol::Field, 2> fields{{
  {"distance", {0, 16, protocol::ByteOrder::little}, false, {1, -4}, {}, "m", 0, 1'200, {}, false},
  {"speed", {16, 16, protocol::ByteOrder::little}, false, {1, -4}, {}, "m/s", 0, 2'000, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x2A}, 4, fields, {91, 90, 90, 90}},
}};
inline constexpr std::string_view source =
  "decided, as travel; timeout decided, as motors";
}  // namespace home

namespace batteries_battery {
inline constexpr std::array<protocol::NamedValue, 1> voltage_names{{{0, "no_battery"}}};
inline constexpr std::array<protocol::Field, 4> fields{{
  {"voltage", {0, 16, protocol::ByteOrder::little}, false, {1, -3}, {}, "V", 0, 6'000, voltage_names, false},
  {"current", {16, 16, protocol::ByteOrder::little}, true, {1, -3}, {}, "A", -32'768, 32'767, {}, false},
  {"remaining", {32, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "mAh", 0, 65'535, {}, false},
  {"temperature", {48, 16, protocol::ByteOrder::little}, false, {1, -1}, {-27315, -2}, "degC", 0, 65'535, {}, false},
}};
}  // namespace batteries_battery
namespace batteries {
inline constexpr std::array<std::string_view, 1> aliases{"battery"};
inline constexpr std::array<protocol::FrameLayout, 2> frames{{
  {"battery_1", protocol::TopicId{0x2B}, 8, batteries_battery::fields, {130, 130, 130, 130}},
  {"battery_2", protocol::TopicId{0x2C}, 8, batteries_battery::fields, {131, 131, 131, 131}},
}};
inline constexpr std::string_view source =
  "BQ27500 data sheet, table 4-1: mV, mA, mAh, 0.1 K; id decided: free in the board's block; period decided: the gauge's own; deadline decided: the period; priority decided: a sample takes long and is not urgent; at medium it would delay the ring; shortest_period: BQ27500 data sheet: gauge updated every second";
}  // namespace batteries

namespace ring_light_sensor {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"illuminance", {0, 16, protocol::ByteOrder::little}, false, {25, -2}, {}, "lx", 0, 65'535, {}, false},
}};
}  // namespace ring_light_sensor
namespace ring_light {
inline constexpr std::array<std::string_view, 1> aliases{"ambient"};
inline constexpr std::array<protocol::FrameLayout, 8> frames{{
  {"sensor_1", protocol::TopicId{0x2D}, 2, ring_light_sensor::fields, {69, 70, 69, 70}},
  {"sensor_2", protocol::TopicId{0x2E}, 2, ring_light_sensor::fields, {69, 70, 70, 70}},
  {"sensor_3", protocol::TopicId{0x2F}, 2, ring_light_sensor::fields, {70, 70, 70, 70}},
  {"sensor_4", protocol::TopicId{0x30}, 2, ring_light_sensor::fields, {70, 70, 69, 69}},
  {"sensor_5", protocol::TopicId{0x31}, 2, ring_light_sensor::fields, {69, 69, 70, 69}},
  {"sensor_6", protocol::TopicId{0x32}, 2, ring_light_sensor::fields, {69, 69, 70, 70}},
  {"sensor_7", protocol::TopicId{0x33}, 2, ring_light_sensor::fields, {70, 69, 70, 70}},
  {"sensor_8", protocol::TopicId{0x34}, 2, ring_light_sensor::fields, {69, 69, 70, 70}},
}};
inline constexpr std::string_view source =
  "VCNL4020 data sheet: 0.25 lx a count; id decided: free in the board's block; period decided: light changes slowly; deadline decided: the period; priority decided: as of batteries; shortest_period: VCNL4020 data sheet: at most 10 measurements of ambient light a second";
}  // namespace ring_light

inline constexpr std::array<protocol::Board, 3> boards{{
  {"di_wheel_drive", "STM32F103"},
  {"power_management", "STM32F405"},
  {"light_ring", "STM32F103"},
}};

inline constexpr std::array<protocol::Topic, 31> topics{{
  protocol::catalogue_entry<Odometry>(0, odometry::aliases, odometry::frames, odometry::source),
  protocol::catalogue_entry<FloorProximity>(0, floor_proximity::aliases, floor_proximity::frames, floor_proximity::source),
  protocol::catalogue_entry<Magnetometer>(0, magnetometer::aliases, magnetometer::frames, magnetometer::source),
  protocol::catalogue_entry<Gyroscope>(0, gyroscope::aliases, gyroscope::frames, gyroscope::source),
  protocol::catalogue_entry<Accelerometer>(0, accelerometer::aliases, accelerometer::frames, accelerometer::source),
  protocol::catalogue_entry<PowerStatus>(1, power_status::aliases, power_status::frames, power_status::source),
  protocol::catalogue_entry<ProximityRing>(1, proximity_ring::aliases, proximity_ring::frames, proximity_ring::source),
  protocol::catalogue_entry<Motors>(0, {}, motors::frames, motors::source),
  protocol::catalogue_entry<Led>(2, {}, {&led::frames[0], 1}, led::source, 1, "led_1"),
  protocol::catalogue_entry<Led>(2, {}, {&led::frames[1], 1}, led::source, 2, "led_2"),
  protocol::catalogue_entry<Led>(2, {}, {&led::frames[2], 1}, led::source, 3, "led_3"),
  protocol::catalogue_entry<Led>(2, {}, {&led::frames[3], 1}, led::source, 4, "led_4"),
  protocol::catalogue_entry<Led>(2, {}, {&led::frames[4], 1}, led::source, 5, "led_5"),
  protocol::catalogue_entry<Led>(2, {}, {&led::frames[5], 1}, led::source, 6, "led_6"),
  protocol::catalogue_entry<Led>(2, {}, {&led::frames[6], 1}, led::source, 7, "led_7"),
  protocol::catalogue_entry<Led>(2, {}, {&led::frames[7], 1}, led::source, 8, "led_8"),
  protocol::catalogue_entry<FloorCalibration>(0, {}, floor_calibration::frames, floor_calibration::source),
  protocol::catalogue_entry<RingCalibration>(1, {}, ring_calibration::frames, ring_calibration::source),
  protocol::catalogue_entry<DiWheelDriveStatus>(0, {}, di_wheel_drive_status::frames, di_wheel_drive_status::source),
  protocol::catalogue_entry<DiWheelDriveRefusal>(0, {}, di_wheel_drive_refusal::frames, di_wheel_drive_refusal::source),
  protocol::catalogue_entry<PowerManagementStatus>(1, {}, power_management_status::frames, power_management_status::source),
  protocol::catalogue_entry<PowerManagementRefusal>(1, {}, power_management_refusal::frames, power_management_refusal::source),
  protocol::catalogue_entry<LightRingStatus>(2, {}, light_ring_status::frames, light_ring_status::source),
  protocol::catalogue_entry<LightRingRefusal>(2, {}, light_ring_refusal::frames, light_ring_refusal::source),
  protocol::catalogue_entry<Travel>(0, {}, travel::frames, travel::source),
  protocol::catalogue_entry<Follow>(0, {}, follow::frames, follow::source),
  protocol::catalogue_entry<Behaviour>(0, {}, behaviour::frames, behaviour::source),
  protocol::catalogue_entry<Avoid>(1, {}, avoid::frames, avoid::source),
  protocol::catalogue_entry<Home>(1, {}, home::frames, home::source),
  protocol::catalogue_entry<Batteries>(1, batteries::aliases, batteries::frames, batteries::source),
  protocol::catalogue_entry<RingLight>(1, ring_light::aliases, ring_light::frames, ring_light::source),
}};
}  // namespace detail
// clang-format on

/// Everything that is said on the bus, as a tool sees it that loads the spec when it runs.
inline constexpr ocm::protocol::Catalogue catalogue{"AMiRo", bit_rate, detail::boards, detail::topics};

/// What tells a board that was built from another spec: boards report it in their status.
inline constexpr std::uint32_t wire_hash = ocm::protocol::wire_hash(catalogue);

/// The board di_wheel_drive: bottom board: wheels, inertial sensors, floor sensors. [Thesis 2.1.1; clock_hz:
/// AMiRo-OS 1.0; can_clock_hz: AMiRo-OS 1.0; RM0008 7.2]
struct DiWheelDrive {
  static constexpr std::string_view name = "di_wheel_drive";
  static constexpr std::string_view mcu = "STM32F103";
  static constexpr std::uint32_t clock_hz = 72'000'000;
  static constexpr std::uint32_t can_clock_hz = 36'000'000;
  using sensors = ocm::protocol::TopicList<Odometry, FloorProximity, Magnetometer, Gyroscope, Accelerometer,
                                           DiWheelDriveStatus, DiWheelDriveRefusal, Behaviour>;
  using actuators = ocm::protocol::TopicList<Motors, FloorCalibration, Travel, Follow>;
  using status = DiWheelDriveStatus;
  using refusal = DiWheelDriveRefusal;
  static constexpr std::uint32_t wire_hash = amiro::wire_hash;
};

/// The board power_management: middle board: batteries, proximity ring. [Thesis 2.1.2; clock_hz: AMiRo-OS
/// 1.0; can_clock_hz: AMiRo-OS 1.0; RM0090 6.2]
struct PowerManagement {
  static constexpr std::string_view name = "power_management";
  static constexpr std::string_view mcu = "STM32F405";
  static constexpr std::uint32_t clock_hz = 168'000'000;
  static constexpr std::uint32_t can_clock_hz = 42'000'000;
  using sensors = ocm::protocol::TopicList<PowerStatus, ProximityRing, PowerManagementStatus,
                                           PowerManagementRefusal, Batteries, RingLight>;
  using actuators = ocm::protocol::TopicList<RingCalibration, Avoid, Home>;
  using status = PowerManagementStatus;
  using refusal = PowerManagementRefusal;
  static constexpr std::uint32_t wire_hash = amiro::wire_hash;
};

/// The board light_ring: top board: eight coloured lights. [Thesis 2.1.3; clock_hz: AMiRo-OS 1.0;
/// can_clock_hz: AMiRo-OS 1.0; RM0008 7.2]
struct LightRing {
  static constexpr std::string_view name = "light_ring";
  static constexpr std::string_view mcu = "STM32F103";
  static constexpr std::uint32_t clock_hz = 72'000'000;
  static constexpr std::uint32_t can_clock_hz = 36'000'000;
  using sensors = ocm::protocol::TopicList<LightRingStatus, LightRingRefusal>;
  using actuators = ocm::protocol::TopicList<Led>;
  using status = LightRingStatus;
  using refusal = LightRingRefusal;
  static constexpr std::uint32_t wire_hash = amiro::wire_hash;
};

}  // namespace amiro
