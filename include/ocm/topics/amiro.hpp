// Made by ocm-generate from topics.json. Do not edit: change the spec, and generate again.

/// The topics of AMiRo.
///
/// Members of a frame are raw numbers, as they travel. name_unit() is the physical value, rounded once where
/// raw number times scale stays below 2^53; set_name_unit() takes the nearest raw number within the field's
/// range, and the one nearest to zero for not a number. encode() puts the nearest number that the width
/// holds. No heap, no exceptions; everything is constexpr.
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
      {ocm::protocol::TopicId{0x02}, 8},
      {ocm::protocol::TopicId{0x03}, 8},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [AMiRo-OS 1.0, Odometry: updated every 50 ms]
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{50};
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
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{{{ocm::protocol::TopicId{0x04}, 8}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [VCNL4020 data sheet: at most 250 proximity measurements/s]
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{4};
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
      {ocm::protocol::TopicId{0x05}, 4},
      {ocm::protocol::TopicId{0x06}, 4},
      {ocm::protocol::TopicId{0x07}, 4},
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
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{{{ocm::protocol::TopicId{0x08}, 6}}};
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
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{{{ocm::protocol::TopicId{0x09}, 6}}};
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
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{{{ocm::protocol::TopicId{0x1E}, 6}}};
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
      {ocm::protocol::TopicId{0x1F}, 2},
      {ocm::protocol::TopicId{0x20}, 2},
      {ocm::protocol::TopicId{0x21}, 2},
      {ocm::protocol::TopicId{0x22}, 2},
      {ocm::protocol::TopicId{0x23}, 2},
      {ocm::protocol::TopicId{0x24}, 2},
      {ocm::protocol::TopicId{0x25}, 2},
      {ocm::protocol::TopicId{0x26}, 2},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{50, ocm::protocol::PeriodUnit::milliseconds};
  /// [VCNL4020 data sheet: at most 250 proximity measurements/s]
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{4};
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
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{{{ocm::protocol::TopicId{0x01}, 8}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::drive;
  /// [decided: five set points at 100 ms lost in a row]
  static constexpr ocm::base::Duration timeout = std::chrono::milliseconds{500};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{50};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

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
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{{{ocm::protocol::TopicId{0x3C}, 3}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::light;
  static constexpr ocm::base::Duration timeout{};
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

/// The board di_wheel_drive: bottom board: wheels, inertial sensors, floor sensors. [Thesis 2.1.1; clock_hz:
/// AMiRo-OS 1.0; can_clock_hz: AMiRo-OS 1.0; RM0008 7.2]
struct DiWheelDrive {
  static constexpr std::string_view name = "di_wheel_drive";
  static constexpr std::string_view mcu = "STM32F103";
  static constexpr std::uint32_t clock_hz = 72'000'000;
  static constexpr std::uint32_t can_clock_hz = 36'000'000;
  using sensors = ocm::protocol::TopicList<Odometry, FloorProximity, Magnetometer, Gyroscope, Accelerometer>;
  using actuators = ocm::protocol::TopicList<Motors>;
};

/// The board power_management: middle board: batteries, proximity ring. [Thesis 2.1.2; clock_hz: AMiRo-OS
/// 1.0; can_clock_hz: AMiRo-OS 1.0; RM0090 6.2]
struct PowerManagement {
  static constexpr std::string_view name = "power_management";
  static constexpr std::string_view mcu = "STM32F405";
  static constexpr std::uint32_t clock_hz = 168'000'000;
  static constexpr std::uint32_t can_clock_hz = 42'000'000;
  using sensors = ocm::protocol::TopicList<PowerStatus, ProximityRing>;
  using actuators = ocm::protocol::TopicList<>;
};

/// The board light_ring: top board: eight coloured lights. [Thesis 2.1.3; clock_hz: AMiRo-OS 1.0;
/// can_clock_hz: AMiRo-OS 1.0; RM0008 7.2]
struct LightRing {
  static constexpr std::string_view name = "light_ring";
  static constexpr std::string_view mcu = "STM32F103";
  static constexpr std::uint32_t clock_hz = 72'000'000;
  static constexpr std::uint32_t can_clock_hz = 36'000'000;
  using sensors = ocm::protocol::TopicList<>;
  using actuators = ocm::protocol::TopicList<Led>;
};

// clang-format off
namespace detail {
namespace protocol = ocm::protocol;

// Fields: name, {start, width, order}, signed, scale, offset, unit, lowest and highest raw number,
// names of values or flags, whether flags. Scale and offset: {digits, power of ten}.
// Frames: name, id, DLC, fields.
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
  {"velocity", protocol::TopicId{0x02}, 8, odometry_velocity::fields},
  {"pose", protocol::TopicId{0x03}, 8, odometry_pose::fields},
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
  {"", protocol::TopicId{0x04}, 8, fields},
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
  {"x", protocol::TopicId{0x05}, 4, magnetometer_x::fields},
  {"y", protocol::TopicId{0x06}, 4, magnetometer_y::fields},
  {"z", protocol::TopicId{0x07}, 4, magnetometer_z::fields},
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
  {"", protocol::TopicId{0x08}, 6, fields},
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
  {"", protocol::TopicId{0x09}, 6, fields},
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
  {"", protocol::TopicId{0x1E}, 6, fields},
}};
inline constexpr std::string_view source =
  "Thesis table 4.7; shortest_period: BQ27500 data sheet: gauge updated every second";
}  // namespace power_status

namespace proximity_ring_sensor {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"proximity", {0, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
}  // namespace proximity_ring_sensor
namespace proximity_ring {
inline constexpr std::array<std::string_view, 1> aliases{"ring"};
inline constexpr std::array<protocol::FrameLayout, 8> frames{{
  {"sensor_1", protocol::TopicId{0x1F}, 2, proximity_ring_sensor::fields},
  {"sensor_2", protocol::TopicId{0x20}, 2, proximity_ring_sensor::fields},
  {"sensor_3", protocol::TopicId{0x21}, 2, proximity_ring_sensor::fields},
  {"sensor_4", protocol::TopicId{0x22}, 2, proximity_ring_sensor::fields},
  {"sensor_5", protocol::TopicId{0x23}, 2, proximity_ring_sensor::fields},
  {"sensor_6", protocol::TopicId{0x24}, 2, proximity_ring_sensor::fields},
  {"sensor_7", protocol::TopicId{0x25}, 2, proximity_ring_sensor::fields},
  {"sensor_8", protocol::TopicId{0x26}, 2, proximity_ring_sensor::fields},
}};
inline constexpr std::string_view source =
  "Thesis table 4.8; counts: VCNL4020 data sheet; shortest_period: VCNL4020 data sheet: at most 250 proximity measurements/s";
}  // namespace proximity_ring

namespace motors {
inline constexpr std::array<protocol::Field, 2> fields{{
  {"x", {0, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "m/s", INT32_MIN, 2'147'483'647, {}, false},
  {"z", {32, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "rad/s", INT32_MIN, 2'147'483'647, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x01}, 8, fields},
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
  {"", protocol::TopicId{0x3C}, 3, fields},
  {"", protocol::TopicId{0x3D}, 3, fields},
  {"", protocol::TopicId{0x3E}, 3, fields},
  {"", protocol::TopicId{0x3F}, 3, fields},
  {"", protocol::TopicId{0x40}, 3, fields},
  {"", protocol::TopicId{0x41}, 3, fields},
  {"", protocol::TopicId{0x42}, 3, fields},
  {"", protocol::TopicId{0x43}, 3, fields},
}};
inline constexpr std::string_view source =
  "Thesis 4.2.2, LEDs; id decided: the thesis names a header that is not public";
}  // namespace led

inline constexpr std::array<protocol::Board, 3> boards{{
  {"di_wheel_drive", "STM32F103"},
  {"power_management", "STM32F405"},
  {"light_ring", "STM32F103"},
}};

inline constexpr std::array<protocol::Topic, 16> topics{{
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
}};
}  // namespace detail
// clang-format on

/// Everything that is said on the bus, as a tool sees it that loads the spec when it runs.
inline constexpr ocm::protocol::Catalogue catalogue{"AMiRo", bit_rate, detail::boards, detail::topics};

}  // namespace amiro
