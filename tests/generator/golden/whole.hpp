// Made by ocm-generate from whole.json. Do not edit: change the spec, and generate again.

/// The topics and messages of Whole: a robot and a bus that have everything a spec can say, for tests alone.
///
/// Members of a frame are raw numbers, as they travel. name_unit() is the physical value, rounded once where
/// raw number times scale stays below 2^53; set_name_unit() takes the nearest raw number within the field's
/// range, and the one nearest to zero for not a number. encode() puts the nearest number that the width
/// holds. `frames` has of each frame the id, the DLC, and the most bits that it takes on the bus at each
/// priority, whatever its content. No heap, no exceptions; everything is constexpr.
///
/// A message is its bytes, which begin with the start values; what they mean is read and put in place. Name()
/// is the physical value, the named one or the number, Name_raw() the bits; set_Name() takes the nearest that
/// the width holds. Of a multiplexed field Name() is empty where the selector says that it is not there, and
/// set_Name() is false. ocm/protocol/message.hpp makes frames of them, and reads them.
///
/// Where a period, deadline, jitter, priority or timeout names no source: [decided: as usual]
#pragma once

#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "ocm/base/binary64.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/message_field.hpp"
#include "ocm/protocol/physical.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/protocol/wire_hash.hpp"

namespace whole {

/// Bits per second on the bus. [decided: for tests; bit_rate: table 1]
inline constexpr std::uint32_t bit_rate = 500'000;

/// Status, identity.
struct StatusIdentity {
  static constexpr ocm::protocol::TopicId id{0x70};
  static constexpr std::uint8_t dlc = 8;

  std::uint32_t uptime = 0;     ///< [0, 16777215] s
  std::uint8_t reset = 0;       ///< [0, 255]
  std::uint32_t wire_hash = 0;  ///< [0, 4294967295]

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
    ResetBits::put(data, reset);
    WireHashBits::put(data, wire_hash);
    return data;
  }
  [[nodiscard]] static constexpr StatusIdentity decode(const ocm::can::Payload& data) noexcept {
    StatusIdentity value;
    value.uptime = UptimeBits::get(data);
    value.reset = ResetBits::get(data);
    value.wire_hash = WireHashBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const StatusIdentity&, const StatusIdentity&) = default;
};

/// Status, health.
struct StatusHealth {
  static constexpr ocm::protocol::TopicId id{0x71};
  static constexpr std::uint8_t dlc = 8;

  std::uint8_t load = 0;         ///< [0, 100] %
  std::uint8_t bus = 0;          ///< [0, 255]
  std::uint8_t publishing = 0;   ///< [0, 255]
  std::uint8_t faults = 0;       ///< [0, 255]
  std::uint16_t overload = 0;    ///< [0, 65535]
  std::uint16_t bus_errors = 0;  ///< [0, 65535]

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
    BusBits::put(data, bus);
    PublishingBits::put(data, publishing);
    FaultsBits::put(data, faults);
    OverloadBits::put(data, overload);
    BusErrorsBits::put(data, bus_errors);
    return data;
  }
  [[nodiscard]] static constexpr StatusHealth decode(const ocm::can::Payload& data) noexcept {
    StatusHealth value;
    value.load = LoadBits::get(data);
    value.bus = BusBits::get(data);
    value.publishing = PublishingBits::get(data);
    value.faults = FaultsBits::get(data);
    value.overload = OverloadBits::get(data);
    value.bus_errors = BusErrorsBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const StatusHealth&, const StatusHealth&) = default;
};

/// Status. Sensor of MainBoard, requests on 0x70. [decided: for tests]
struct Status {
  static constexpr std::string_view name = "status";
  static constexpr ocm::protocol::TopicId id{0x70};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 2> frames{{
      {ocm::protocol::TopicId{0x70}, 8, {131, 131, 131, 131}},
      {ocm::protocol::TopicId{0x71}, 8, {130, 130, 130, 130}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period{};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::status;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{5};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  StatusIdentity identity;
  StatusHealth health;

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return identity.encode();
    if (frame == 1) return health.encode();
    return {};
  }
  [[nodiscard]] static constexpr Status decode(const std::array<ocm::can::Payload, 2>& all) noexcept {
    Status value;
    value.identity = StatusIdentity::decode(all[0]);
    value.health = StatusHealth::decode(all[1]);
    return value;
  }
  friend constexpr bool operator==(const Status&, const Status&) = default;
};
static_assert(ocm::protocol::TopicType<Status>);

/// Refusal. Sensor of MainBoard, requests on 0x72. [decided: for tests]
struct Refusal {
  static constexpr std::string_view name = "refusal";
  static constexpr ocm::protocol::TopicId id{0x72};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x72}, 4, {90, 90, 90, 90}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{20, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period{};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::refusal;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{5};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  std::uint8_t topic = 0;     ///< [0, 255]
  std::uint8_t reason = 0;    ///< [0, 255]
  std::uint16_t refused = 0;  ///< [0, 65535]

  using TopicBits = ocm::protocol::Bits<std::uint8_t, 0>;
  using ReasonBits = ocm::protocol::Bits<std::uint8_t, 8>;
  using RefusedBits = ocm::protocol::Bits<std::uint16_t, 16>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    TopicBits::put(data, topic);
    ReasonBits::put(data, reason);
    RefusedBits::put(data, refused);
    return data;
  }
  [[nodiscard]] static constexpr Refusal decode(const ocm::can::Payload& data) noexcept {
    Refusal value;
    value.topic = TopicBits::get(data);
    value.reason = ReasonBits::get(data);
    value.refused = RefusedBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Refusal decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Refusal&, const Refusal&) = default;
};
static_assert(ocm::protocol::TopicType<Refusal>);

/// Gyroscope: how fast it turns | and <where>. Sensor of MainBoard, requests on 0x08. [data sheet "A"; id
/// decided: free]
struct Gyroscope {
  static constexpr std::string_view name = "gyroscope";
  static constexpr ocm::protocol::TopicId id{0x08};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x08}, 8, {132, 131, 132, 131}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  /// [table 2]
  static constexpr ocm::protocol::Period period{900, ocm::protocol::PeriodUnit::microseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::nanoseconds{1'250};
  /// [table 3]
  static constexpr ocm::base::Duration deadline = std::chrono::microseconds{1'500};
  /// [table 4]
  static constexpr ocm::base::Duration jitter = std::chrono::microseconds{30};
  /// [decided: first]
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::urgent;

  enum class Value : std::uint8_t {
    off = 0,
    on = 1,
  };
  enum class Spare : std::int8_t {
    least = -128,
    none = 0,
  };
  static constexpr std::uint8_t temperature_unknown = 255;
  static constexpr std::uint16_t ready_flag = 0x01;
  static constexpr std::uint16_t data_flag = 0x80;
  static constexpr std::uint16_t late_flag = 0x0100;
  static constexpr std::uint16_t broken_flag = 0x8000;

  /// around the long axis; 0.0175 deg/s a bit, [-499.9925, 499.9925] deg/s [table 6]
  std::int16_t x = 0;
  /// -0.25 deg/s a bit, from 3 deg/s on, [-508.75, 515] deg/s
  std::int16_t y = 0;
  Value value{};
  /// 0.5 °C a bit, from -40 °C on, [-40, 87.5] °C
  std::uint8_t temperature = 0;
  /// of the part
  std::uint16_t state = 0;
  Spare spare{};

  using XBits = ocm::protocol::Bits<std::int16_t, 0>;
  using YBits = ocm::protocol::Bits<std::int16_t, 16, 12>;
  using ValueBits = ocm::protocol::Bits<std::uint8_t, 28, 4>;
  using TemperatureBits = ocm::protocol::Bits<std::uint8_t, 32>;
  using StateBits = ocm::protocol::Bits<std::uint16_t, 40>;
  using SpareBits = ocm::protocol::Bits<std::int8_t, 56>;

  [[nodiscard]] constexpr double x_deg_per_s() const noexcept { return x * 175.0 / 10'000.0; }
  constexpr void set_x_deg_per_s(double value_) noexcept {
    x = ocm::protocol::nearest_raw<std::int16_t>(value_ * 10'000.0 / 175.0, -28'571, 28'571);
  }
  [[nodiscard]] constexpr double y_deg_per_s() const noexcept { return (y * -25.0 + 300.0) / 100.0; }
  constexpr void set_y_deg_per_s(double value_) noexcept {
    y = ocm::protocol::nearest_raw<std::int16_t>((value_ * 100.0 - 300.0) / -25.0, YBits::min, YBits::max);
  }
  [[nodiscard]] constexpr double temperature_celsius() const noexcept {
    return (temperature * 5.0 - 400.0) / 10.0;
  }
  constexpr void set_temperature_celsius(double value_) noexcept {
    temperature = ocm::protocol::nearest_raw<std::uint8_t>((value_ * 10.0 + 400.0) / 5.0,
                                                           TemperatureBits::min, TemperatureBits::max);
  }
  [[nodiscard]] constexpr bool ready() const noexcept { return (state & ready_flag) != 0; }
  constexpr void set_ready(bool on) noexcept {
    state = static_cast<std::uint16_t>(on ? state | ready_flag : state & ~ready_flag);
  }
  [[nodiscard]] constexpr bool data() const noexcept { return (state & data_flag) != 0; }
  constexpr void set_data(bool on) noexcept {
    state = static_cast<std::uint16_t>(on ? state | data_flag : state & ~data_flag);
  }
  [[nodiscard]] constexpr bool late() const noexcept { return (state & late_flag) != 0; }
  constexpr void set_late(bool on) noexcept {
    state = static_cast<std::uint16_t>(on ? state | late_flag : state & ~late_flag);
  }
  [[nodiscard]] constexpr bool broken() const noexcept { return (state & broken_flag) != 0; }
  constexpr void set_broken(bool on) noexcept {
    state = static_cast<std::uint16_t>(on ? state | broken_flag : state & ~broken_flag);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data_{};
    XBits::put(data_, x);
    YBits::put(data_, y);
    ValueBits::put(data_, static_cast<std::uint8_t>(value));
    TemperatureBits::put(data_, temperature);
    StateBits::put(data_, state);
    SpareBits::put(data_, static_cast<std::int8_t>(spare));
    return data_;
  }
  [[nodiscard]] static constexpr Gyroscope decode(const ocm::can::Payload& data_) noexcept {
    Gyroscope value_;
    value_.x = XBits::get(data_);
    value_.y = YBits::get(data_);
    value_.value = static_cast<Value>(ValueBits::get(data_));
    value_.temperature = TemperatureBits::get(data_);
    value_.state = StateBits::get(data_);
    value_.spare = static_cast<Spare>(SpareBits::get(data_));
    return value_;
  }
  [[nodiscard]] static constexpr Gyroscope decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Gyroscope&, const Gyroscope&) = default;
};
static_assert(ocm::protocol::TopicType<Gyroscope>);

/// Position, pose.
struct PositionPose {
  static constexpr ocm::protocol::TopicId id{0x10};
  static constexpr std::uint8_t dlc = 8;

  std::int32_t x = 0;             ///< 0.001 m a bit, [-8388.608, 8388.607] m
  std::int32_t y = 0;             ///< 0.001 m a bit, [-8388.608, 8388.607] m
  std::uint16_t orientation = 0;  ///< 0.0001 rad a bit, [0, 6.5535] rad

  using XBits = ocm::protocol::Bits<std::int32_t, 7, 24, ocm::protocol::ByteOrder::big>;
  using YBits = ocm::protocol::Bits<std::int32_t, 31, 24, ocm::protocol::ByteOrder::big>;
  using OrientationBits = ocm::protocol::Bits<std::uint16_t, 55, 16, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr double x_m() const noexcept { return x / 1'000.0; }
  constexpr void set_x_m(double value) noexcept {
    x = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000.0, XBits::min, XBits::max);
  }
  [[nodiscard]] constexpr double y_m() const noexcept { return y / 1'000.0; }
  constexpr void set_y_m(double value) noexcept {
    y = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000.0, YBits::min, YBits::max);
  }
  [[nodiscard]] constexpr double orientation_rad() const noexcept { return orientation / 10'000.0; }
  constexpr void set_orientation_rad(double value) noexcept {
    orientation = ocm::protocol::nearest_raw<std::uint16_t>(value * 10'000.0, OrientationBits::min,
                                                            OrientationBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    XBits::put(data, x);
    YBits::put(data, y);
    OrientationBits::put(data, orientation);
    return data;
  }
  [[nodiscard]] static constexpr PositionPose decode(const ocm::can::Payload& data) noexcept {
    PositionPose value;
    value.x = XBits::get(data);
    value.y = YBits::get(data);
    value.orientation = OrientationBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const PositionPose&, const PositionPose&) = default;
};

/// Position, one cell: each cell's own. [table 7]
struct PositionCell {
  static constexpr ocm::protocol::TopicId id{0x11};  ///< of the first of 3
  static constexpr std::uint8_t dlc = 8;

  static constexpr std::uint32_t low_flag = 0x01;
  static constexpr std::uint32_t high_flag = 0x040000;

  float data = 0;        ///< 0.5 V a unit, [-2.5, 40] V
  std::uint16_t on = 0;  ///< [0, 4000] mA
  std::uint32_t restrict = 0;

  using DataBits = ocm::protocol::Bits<std::uint32_t, 0>;
  using OnBits = ocm::protocol::Bits<std::uint16_t, 33, 12>;
  using RestrictBits = ocm::protocol::Bits<std::uint32_t, 45, 19>;

  [[nodiscard]] constexpr double data_V() const noexcept { return data / 2.0; }
  constexpr void set_data_V(double value) noexcept {
    data = static_cast<float>(ocm::protocol::within(value, -2.5, 40.0) * 2.0);
  }
  [[nodiscard]] constexpr double on_mA() const noexcept { return on; }
  constexpr void set_on_mA(double value) noexcept {
    on = ocm::protocol::nearest_raw<std::uint16_t>(value, 0, 4'000);
  }
  [[nodiscard]] constexpr bool low() const noexcept { return (restrict & low_flag) != 0; }
  constexpr void set_low(bool on_) noexcept {
    restrict = static_cast<std::uint32_t>(on_ ? restrict | low_flag : restrict & ~low_flag);
  }
  [[nodiscard]] constexpr bool high() const noexcept { return (restrict & high_flag) != 0; }
  constexpr void set_high(bool on_) noexcept {
    restrict = static_cast<std::uint32_t>(on_ ? restrict | high_flag : restrict & ~high_flag);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data_{};
    DataBits::put(data_, std::bit_cast<std::uint32_t>(data));
    OnBits::put(data_, on);
    RestrictBits::put(data_, restrict);
    return data_;
  }
  [[nodiscard]] static constexpr PositionCell decode(const ocm::can::Payload& data_) noexcept {
    PositionCell value;
    value.data = std::bit_cast<float>(DataBits::get(data_));
    value.on = OnBits::get(data_);
    value.restrict = RestrictBits::get(data_);
    return value;
  }
  friend constexpr bool operator==(const PositionCell&, const PositionCell&) = default;
};

/// Position, value.
struct PositionValue {
  static constexpr ocm::protocol::TopicId id{0x14};
  static constexpr std::uint8_t dlc = 8;

  double all = 0;  ///< 0.001 km a unit, from -2 km on

  using AllBits = ocm::protocol::Bits<std::uint64_t, 0>;

  [[nodiscard]] constexpr double all_km() const noexcept {
    return (static_cast<double>(all) - 2'000.0) / 1'000.0;
  }
  constexpr void set_all_km(double value) noexcept { all = value * 1'000.0 + 2'000.0; }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    AllBits::put(data, ocm::base::to_binary64(all));
    return data;
  }
  [[nodiscard]] static constexpr PositionValue decode(const ocm::can::Payload& data) noexcept {
    PositionValue value;
    value.all = ocm::base::from_binary64(AllBits::get(data));
    return value;
  }
  friend constexpr bool operator==(const PositionValue&, const PositionValue&) = default;
};

/// Position, i.
struct PositionI {
  static constexpr ocm::protocol::TopicId id{0x15};
  static constexpr std::uint8_t dlc = 8;

  std::int64_t wide = 0;  ///< [-9223372036854775808, 9223372036854775807]

  using WideBits = ocm::protocol::Bits<std::int64_t, 7, 64, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    WideBits::put(data, wide);
    return data;
  }
  [[nodiscard]] static constexpr PositionI decode(const ocm::can::Payload& data) noexcept {
    PositionI value;
    value.wide = WideBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const PositionI&, const PositionI&) = default;
};

/// Position, tail.
struct PositionTail {
  static constexpr ocm::protocol::TopicId id{0x16};
  static constexpr std::uint8_t dlc = 8;

  std::uint64_t far = 0;  ///< [0, 9223372036854775807]

  using FarBits = ocm::protocol::Bits<std::uint64_t, 1, 63>;

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    FarBits::put(data, far);
    return data;
  }
  [[nodiscard]] static constexpr PositionTail decode(const ocm::can::Payload& data) noexcept {
    PositionTail value;
    value.far = FarBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const PositionTail&, const PositionTail&) = default;
};

/// Position, last.
struct PositionLast {
  static constexpr ocm::protocol::TopicId id{0x17};
  static constexpr std::uint8_t dlc = 0;

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept { return {}; }
  [[nodiscard]] static constexpr PositionLast decode(const ocm::can::Payload&) noexcept { return {}; }
  friend constexpr bool operator==(const PositionLast&, const PositionLast&) = default;
};

/// Position. Sensor of MainBoard, requests on 0x10. [decided: for tests]
struct Position {
  static constexpr std::string_view name = "position";
  static constexpr ocm::protocol::TopicId id{0x10};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 8> frames{{
      {ocm::protocol::TopicId{0x10}, 8, {131, 131, 131, 131}},
      {ocm::protocol::TopicId{0x11}, 8, {131, 130, 130, 130}},
      {ocm::protocol::TopicId{0x12}, 8, {131, 130, 130, 130}},
      {ocm::protocol::TopicId{0x13}, 8, {131, 130, 130, 130}},
      {ocm::protocol::TopicId{0x14}, 8, {131, 131, 131, 131}},
      {ocm::protocol::TopicId{0x15}, 8, {131, 130, 130, 130}},
      {ocm::protocol::TopicId{0x16}, 8, {131, 130, 130, 130}},
      {ocm::protocol::TopicId{0x17}, 0, {49, 49, 49, 49}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{30000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::seconds{1};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::pose;
  static constexpr ocm::base::Duration deadline = std::chrono::seconds{2};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  PositionPose pose;
  std::array<PositionCell, 3> cell{};
  PositionValue value;
  PositionI i;
  PositionTail tail;
  PositionLast last;

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return pose.encode();
    if (frame >= 1 && frame < 4) return cell[frame - 1].encode();
    if (frame == 4) return value.encode();
    if (frame == 5) return i.encode();
    if (frame == 6) return tail.encode();
    if (frame == 7) return last.encode();
    return {};
  }
  [[nodiscard]] static constexpr Position decode(const std::array<ocm::can::Payload, 8>& all) noexcept {
    Position value_;
    value_.pose = PositionPose::decode(all[0]);
    for (std::size_t i_ = 0; i_ < value_.cell.size(); ++i_)
      value_.cell[i_] = PositionCell::decode(all[1 + i_]);
    value_.value = PositionValue::decode(all[4]);
    value_.i = PositionI::decode(all[5]);
    value_.tail = PositionTail::decode(all[6]);
    value_.last = PositionLast::decode(all[7]);
    return value_;
  }
  friend constexpr bool operator==(const Position&, const Position&) = default;
};
static_assert(ocm::protocol::TopicType<Position>);

/// Second position, pose.
struct SecondPositionPose {
  static constexpr ocm::protocol::TopicId id{0x18};
  static constexpr std::uint8_t dlc = 8;

  std::int32_t x = 0;             ///< 0.001 m a bit, [-8388.608, 8388.607] m
  std::int32_t y = 0;             ///< 0.001 m a bit, [-8388.608, 8388.607] m
  std::uint16_t orientation = 0;  ///< 0.0001 rad a bit, [0, 6.5535] rad

  using XBits = ocm::protocol::Bits<std::int32_t, 7, 24, ocm::protocol::ByteOrder::big>;
  using YBits = ocm::protocol::Bits<std::int32_t, 31, 24, ocm::protocol::ByteOrder::big>;
  using OrientationBits = ocm::protocol::Bits<std::uint16_t, 55, 16, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr double x_m() const noexcept { return x / 1'000.0; }
  constexpr void set_x_m(double value) noexcept {
    x = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000.0, XBits::min, XBits::max);
  }
  [[nodiscard]] constexpr double y_m() const noexcept { return y / 1'000.0; }
  constexpr void set_y_m(double value) noexcept {
    y = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000.0, YBits::min, YBits::max);
  }
  [[nodiscard]] constexpr double orientation_rad() const noexcept { return orientation / 10'000.0; }
  constexpr void set_orientation_rad(double value) noexcept {
    orientation = ocm::protocol::nearest_raw<std::uint16_t>(value * 10'000.0, OrientationBits::min,
                                                            OrientationBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    XBits::put(data, x);
    YBits::put(data, y);
    OrientationBits::put(data, orientation);
    return data;
  }
  [[nodiscard]] static constexpr SecondPositionPose decode(const ocm::can::Payload& data) noexcept {
    SecondPositionPose value;
    value.x = XBits::get(data);
    value.y = YBits::get(data);
    value.orientation = OrientationBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const SecondPositionPose&, const SecondPositionPose&) = default;
};

/// Second position, one cell: each cell's own. [table 7]
struct SecondPositionCell {
  static constexpr ocm::protocol::TopicId id{0x19};  ///< of the first of 3
  static constexpr std::uint8_t dlc = 8;

  static constexpr std::uint32_t low_flag = 0x01;
  static constexpr std::uint32_t high_flag = 0x040000;

  float data = 0;        ///< 0.5 V a unit, [-2.5, 40] V
  std::uint16_t on = 0;  ///< [0, 4000] mA
  std::uint32_t restrict = 0;

  using DataBits = ocm::protocol::Bits<std::uint32_t, 0>;
  using OnBits = ocm::protocol::Bits<std::uint16_t, 33, 12>;
  using RestrictBits = ocm::protocol::Bits<std::uint32_t, 45, 19>;

  [[nodiscard]] constexpr double data_V() const noexcept { return data / 2.0; }
  constexpr void set_data_V(double value) noexcept {
    data = static_cast<float>(ocm::protocol::within(value, -2.5, 40.0) * 2.0);
  }
  [[nodiscard]] constexpr double on_mA() const noexcept { return on; }
  constexpr void set_on_mA(double value) noexcept {
    on = ocm::protocol::nearest_raw<std::uint16_t>(value, 0, 4'000);
  }
  [[nodiscard]] constexpr bool low() const noexcept { return (restrict & low_flag) != 0; }
  constexpr void set_low(bool on_) noexcept {
    restrict = static_cast<std::uint32_t>(on_ ? restrict | low_flag : restrict & ~low_flag);
  }
  [[nodiscard]] constexpr bool high() const noexcept { return (restrict & high_flag) != 0; }
  constexpr void set_high(bool on_) noexcept {
    restrict = static_cast<std::uint32_t>(on_ ? restrict | high_flag : restrict & ~high_flag);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data_{};
    DataBits::put(data_, std::bit_cast<std::uint32_t>(data));
    OnBits::put(data_, on);
    RestrictBits::put(data_, restrict);
    return data_;
  }
  [[nodiscard]] static constexpr SecondPositionCell decode(const ocm::can::Payload& data_) noexcept {
    SecondPositionCell value;
    value.data = std::bit_cast<float>(DataBits::get(data_));
    value.on = OnBits::get(data_);
    value.restrict = RestrictBits::get(data_);
    return value;
  }
  friend constexpr bool operator==(const SecondPositionCell&, const SecondPositionCell&) = default;
};

/// Second position, value.
struct SecondPositionValue {
  static constexpr ocm::protocol::TopicId id{0x1C};
  static constexpr std::uint8_t dlc = 8;

  double all = 0;  ///< 0.001 km a unit, from -2 km on

  using AllBits = ocm::protocol::Bits<std::uint64_t, 0>;

  [[nodiscard]] constexpr double all_km() const noexcept {
    return (static_cast<double>(all) - 2'000.0) / 1'000.0;
  }
  constexpr void set_all_km(double value) noexcept { all = value * 1'000.0 + 2'000.0; }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    AllBits::put(data, ocm::base::to_binary64(all));
    return data;
  }
  [[nodiscard]] static constexpr SecondPositionValue decode(const ocm::can::Payload& data) noexcept {
    SecondPositionValue value;
    value.all = ocm::base::from_binary64(AllBits::get(data));
    return value;
  }
  friend constexpr bool operator==(const SecondPositionValue&, const SecondPositionValue&) = default;
};

/// Second position, i.
struct SecondPositionI {
  static constexpr ocm::protocol::TopicId id{0x1D};
  static constexpr std::uint8_t dlc = 8;

  std::int64_t wide = 0;  ///< [-9223372036854775808, 9223372036854775807]

  using WideBits = ocm::protocol::Bits<std::int64_t, 7, 64, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    WideBits::put(data, wide);
    return data;
  }
  [[nodiscard]] static constexpr SecondPositionI decode(const ocm::can::Payload& data) noexcept {
    SecondPositionI value;
    value.wide = WideBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const SecondPositionI&, const SecondPositionI&) = default;
};

/// Second position, tail.
struct SecondPositionTail {
  static constexpr ocm::protocol::TopicId id{0x1E};
  static constexpr std::uint8_t dlc = 8;

  std::uint64_t far = 0;  ///< [0, 9223372036854775807]

  using FarBits = ocm::protocol::Bits<std::uint64_t, 1, 63>;

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    FarBits::put(data, far);
    return data;
  }
  [[nodiscard]] static constexpr SecondPositionTail decode(const ocm::can::Payload& data) noexcept {
    SecondPositionTail value;
    value.far = FarBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const SecondPositionTail&, const SecondPositionTail&) = default;
};

/// Second position, last.
struct SecondPositionLast {
  static constexpr ocm::protocol::TopicId id{0x1F};
  static constexpr std::uint8_t dlc = 0;

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept { return {}; }
  [[nodiscard]] static constexpr SecondPositionLast decode(const ocm::can::Payload&) noexcept { return {}; }
  friend constexpr bool operator==(const SecondPositionLast&, const SecondPositionLast&) = default;
};

/// Second position: of the other end. Sensor of ABoardWithANameOf35Characters, requests on 0x18. [decided:
/// the same]
struct SecondPosition {
  static constexpr std::string_view name = "second_position";
  static constexpr ocm::protocol::TopicId id{0x18};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 8> frames{{
      {ocm::protocol::TopicId{0x18}, 8, {131, 131, 131, 131}},
      {ocm::protocol::TopicId{0x19}, 8, {131, 130, 129, 130}},
      {ocm::protocol::TopicId{0x1A}, 8, {131, 130, 130, 129}},
      {ocm::protocol::TopicId{0x1B}, 8, {131, 130, 130, 130}},
      {ocm::protocol::TopicId{0x1C}, 8, {132, 131, 131, 131}},
      {ocm::protocol::TopicId{0x1D}, 8, {131, 130, 130, 130}},
      {ocm::protocol::TopicId{0x1E}, 8, {133, 130, 130, 130}},
      {ocm::protocol::TopicId{0x1F}, 0, {50, 50, 49, 50}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{30000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::seconds{1};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::pose;
  static constexpr ocm::base::Duration deadline = std::chrono::seconds{2};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  SecondPositionPose pose;
  std::array<SecondPositionCell, 3> cell{};
  SecondPositionValue value;
  SecondPositionI i;
  SecondPositionTail tail;
  SecondPositionLast last;

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return pose.encode();
    if (frame >= 1 && frame < 4) return cell[frame - 1].encode();
    if (frame == 4) return value.encode();
    if (frame == 5) return i.encode();
    if (frame == 6) return tail.encode();
    if (frame == 7) return last.encode();
    return {};
  }
  [[nodiscard]] static constexpr SecondPosition decode(const std::array<ocm::can::Payload, 8>& all) noexcept {
    SecondPosition value_;
    value_.pose = SecondPositionPose::decode(all[0]);
    for (std::size_t i_ = 0; i_ < value_.cell.size(); ++i_)
      value_.cell[i_] = SecondPositionCell::decode(all[1 + i_]);
    value_.value = SecondPositionValue::decode(all[4]);
    value_.i = SecondPositionI::decode(all[5]);
    value_.tail = SecondPositionTail::decode(all[6]);
    value_.last = SecondPositionLast::decode(all[7]);
    return value_;
  }
  friend constexpr bool operator==(const SecondPosition&, const SecondPosition&) = default;
};
static_assert(ocm::protocol::TopicType<SecondPosition>);

/// Ring, one sensor.
struct RingSensor {
  static constexpr ocm::protocol::TopicId id{0x30};  ///< of the first of 4
  static constexpr std::uint8_t dlc = 4;

  std::uint16_t proximity = 0;  ///< [0, 65535]
  std::uint16_t ambient = 0;    ///< [0, 65535]

  using ProximityBits = ocm::protocol::Bits<std::uint16_t, 0>;
  using AmbientBits = ocm::protocol::Bits<std::uint16_t, 16>;

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    ProximityBits::put(data, proximity);
    AmbientBits::put(data, ambient);
    return data;
  }
  [[nodiscard]] static constexpr RingSensor decode(const ocm::can::Payload& data) noexcept {
    RingSensor value;
    value.proximity = ProximityBits::get(data);
    value.ambient = AmbientBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const RingSensor&, const RingSensor&) = default;
};

/// Ring, mean.
struct RingMean {
  static constexpr ocm::protocol::TopicId id{0x34};
  static constexpr std::uint8_t dlc = 2;

  std::uint16_t proximity = 0;  ///< [0, 65535]

  using ProximityBits = ocm::protocol::Bits<std::uint16_t, 0>;

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    ProximityBits::put(data, proximity);
    return data;
  }
  [[nodiscard]] static constexpr RingMean decode(const ocm::can::Payload& data) noexcept {
    RingMean value;
    value.proximity = ProximityBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const RingMean&, const RingMean&) = default;
};

/// Ring. Sensor of ABoardWithANameOf35Characters, requests on 0x30. [decided: for tests]
struct Ring {
  static constexpr std::string_view name = "ring";
  static constexpr ocm::protocol::TopicId id{0x30};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 5> frames{{
      {ocm::protocol::TopicId{0x30}, 4, {90, 90, 90, 90}},
      {ocm::protocol::TopicId{0x31}, 4, {89, 89, 89, 89}},
      {ocm::protocol::TopicId{0x32}, 4, {90, 90, 90, 90}},
      {ocm::protocol::TopicId{0x33}, 4, {89, 89, 89, 89}},
      {ocm::protocol::TopicId{0x34}, 2, {69, 69, 70, 70}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{125, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period{};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::ring;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{5};
  static constexpr ocm::base::Duration jitter{};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  std::array<RingSensor, 4> sensor{};
  RingMean mean;

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame < sensor.size()) return sensor[frame].encode();
    if (frame == 4) return mean.encode();
    return {};
  }
  [[nodiscard]] static constexpr Ring decode(const std::array<ocm::can::Payload, 5>& all) noexcept {
    Ring value;
    for (std::size_t i = 0; i < value.sensor.size(); ++i) value.sensor[i] = RingSensor::decode(all[i]);
    value.mean = RingMean::decode(all[4]);
    return value;
  }
  friend constexpr bool operator==(const Ring&, const Ring&) = default;
};
static_assert(ocm::protocol::TopicType<Ring>);

/// Floor. Sensor of Idle, requests on 0x40. [decided: for tests]
struct Floor {
  static constexpr std::string_view name = "floor";
  static constexpr ocm::protocol::TopicId id{0x40};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x40}, 8, {131, 131, 131, 131}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{20, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period{};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::floor;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{5};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  enum class Sum : std::int8_t {
    none = 0,
  };

  std::uint16_t left = 0;   ///< [0, 4095]
  std::uint16_t right = 0;  ///< [0, 4095]
  float a_field_with_a_name_of_some_37_letters = 0;
  Sum sum{};

  using LeftBits = ocm::protocol::Bits<std::uint16_t, 7, 12, ocm::protocol::ByteOrder::big>;
  using RightBits = ocm::protocol::Bits<std::uint16_t, 11, 12, ocm::protocol::ByteOrder::big>;
  using AFieldWithANameOfSome37LettersBits = ocm::protocol::Bits<std::uint32_t, 24>;
  using SumBits = ocm::protocol::Bits<std::int8_t, 56>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    LeftBits::put(data, left);
    RightBits::put(data, right);
    AFieldWithANameOfSome37LettersBits::put(data, std::bit_cast<std::uint32_t>(a_field_with_a_name_of_some_37_letters));
    SumBits::put(data, static_cast<std::int8_t>(sum));
    return data;
  }
  [[nodiscard]] static constexpr Floor decode(const ocm::can::Payload& data) noexcept {
    Floor value;
    value.left = LeftBits::get(data);
    value.right = RightBits::get(data);
    value.a_field_with_a_name_of_some_37_letters = std::bit_cast<float>(AFieldWithANameOfSome37LettersBits::get(data));
    value.sum = static_cast<Sum>(SumBits::get(data));
    return value;
  }
  [[nodiscard]] static constexpr Floor decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Floor&, const Floor&) = default;
};
static_assert(ocm::protocol::TopicType<Floor>);

/// A topic with a name longer than dbc has. Sensor of Idle, requests on 0x41. [decided: for tests]
struct ATopicWithANameLongerThanDbcHas {
  static constexpr std::string_view name = "a_topic_with_a_name_longer_than_dbc_has";
  static constexpr ocm::protocol::TopicId id{0x41};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x41}, 4, {90, 90, 90, 90}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{20, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period{};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{5};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  static constexpr std::uint32_t first_flag = 0x01;
  static constexpr std::uint32_t all_flag = 0x80000000;

  std::uint32_t count_of_wheels = 0;

  using CountOfWheelsBits = ocm::protocol::Bits<std::uint32_t, 0>;

  [[nodiscard]] constexpr bool first() const noexcept { return (count_of_wheels & first_flag) != 0; }
  constexpr void set_first(bool on) noexcept {
    count_of_wheels = static_cast<std::uint32_t>(on ? count_of_wheels | first_flag : count_of_wheels & ~first_flag);
  }
  [[nodiscard]] constexpr bool all() const noexcept { return (count_of_wheels & all_flag) != 0; }
  constexpr void set_all(bool on) noexcept {
    count_of_wheels = static_cast<std::uint32_t>(on ? count_of_wheels | all_flag : count_of_wheels & ~all_flag);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    CountOfWheelsBits::put(data, count_of_wheels);
    return data;
  }
  [[nodiscard]] static constexpr ATopicWithANameLongerThanDbcHas decode(
      const ocm::can::Payload& data) noexcept {
    ATopicWithANameLongerThanDbcHas value;
    value.count_of_wheels = CountOfWheelsBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr ATopicWithANameLongerThanDbcHas decode(
      const std::array<ocm::can::Payload, 1>& all_) noexcept {
    return decode(all_[0]);
  }
  friend constexpr bool operator==(const ATopicWithANameLongerThanDbcHas&,
                                   const ATopicWithANameLongerThanDbcHas&) = default;
};
static_assert(ocm::protocol::TopicType<ATopicWithANameLongerThanDbcHas>);

/// Motors: how fast it drives. Actuator of MainBoard, set points on 0x01. [decided: for tests]
struct Motors {
  static constexpr std::string_view name = "motors";
  static constexpr ocm::protocol::TopicId id{0x01};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x01}, 8, {132, 131, 131, 131}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout = std::chrono::milliseconds{250};  ///< [table 8]
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::drive;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{5};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  std::int32_t x = 0;  ///< 0.000001 m/s a bit, [-0.5, 0.5] m/s
  std::int32_t z = 0;  ///< 0.000001 rad/s a bit, [-2147.483648, 2147.483647] rad/s

  using XBits = ocm::protocol::Bits<std::int32_t, 0>;
  using ZBits = ocm::protocol::Bits<std::int32_t, 32>;

  [[nodiscard]] constexpr double x_m_per_s() const noexcept { return x / 1'000'000.0; }
  constexpr void set_x_m_per_s(double value) noexcept {
    x = ocm::protocol::nearest_raw<std::int32_t>(value * 1'000'000.0, -500'000, 500'000);
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

/// Lamp. Actuator of Idle, set points on 0x20 to 0x22. [decided: for tests]
struct Lamp {
  static constexpr std::string_view name = "lamp";
  static constexpr ocm::protocol::TopicId id{0x20};
  static constexpr std::uint8_t instances = 3;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x20}, 3, {82, 81, 81, 81}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout{};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::light;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{5};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

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
  [[nodiscard]] static constexpr Lamp decode(const ocm::can::Payload& data) noexcept {
    Lamp value;
    value.red = RedBits::get(data);
    value.green = GreenBits::get(data);
    value.blue = BlueBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Lamp decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Lamp&, const Lamp&) = default;
};
static_assert(ocm::protocol::TopicType<Lamp>);

/// Brake. Actuator of Idle, set points on 0x28. [decided: for tests]
struct Brake {
  static constexpr std::string_view name = "brake";
  static constexpr ocm::protocol::TopicId id{0x28};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x28}, 0, {50, 50, 50, 50}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout = std::chrono::nanoseconds{1'500};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{5};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept { return {}; }
  [[nodiscard]] static constexpr Brake decode(const ocm::can::Payload&) noexcept { return {}; }
  [[nodiscard]] static constexpr Brake decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Brake&, const Brake&) = default;
};
static_assert(ocm::protocol::TopicType<Brake>);

/// Arm. Actuator of Idle, set points on 0x29. [decided: for tests]
struct Arm {
  static constexpr std::string_view name = "arm";
  static constexpr ocm::protocol::TopicId id{0x29};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x29}, 6, {110, 109, 109, 109}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout = std::chrono::seconds{2};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{5};
  static constexpr ocm::base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  static constexpr std::int16_t angle_rest = 0;

  std::int16_t angle = 0;  ///< [-32768, 32767] deg
  float bend = 0;          ///< [-90, 90] deg

  using AngleBits = ocm::protocol::Bits<std::int16_t, 0>;
  using BendBits = ocm::protocol::Bits<std::uint32_t, 16>;

  [[nodiscard]] constexpr double angle_deg() const noexcept { return angle; }
  constexpr void set_angle_deg(double value) noexcept {
    angle = ocm::protocol::nearest_raw<std::int16_t>(value, AngleBits::min, AngleBits::max);
  }
  [[nodiscard]] constexpr double bend_deg() const noexcept { return bend; }
  constexpr void set_bend_deg(double value) noexcept {
    bend = static_cast<float>(ocm::protocol::within(value, -90.0, 90.0));
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    AngleBits::put(data, angle);
    BendBits::put(data, std::bit_cast<std::uint32_t>(bend));
    return data;
  }
  [[nodiscard]] static constexpr Arm decode(const ocm::can::Payload& data) noexcept {
    Arm value;
    value.angle = AngleBits::get(data);
    value.bend = std::bit_cast<float>(BendBits::get(data));
    return value;
  }
  [[nodiscard]] static constexpr Arm decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Arm&, const Arm&) = default;
};
static_assert(ocm::protocol::TopicType<Arm>);

/// EEC1. engine's speed 8 bytes, parameter group 0x0F004, every 20 ms. [by hand; period: measured]
struct EEC1 {
  static constexpr std::string_view name = "EEC1";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::pgn, true, 0x18F004FE};
  static constexpr std::size_t length = 8;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{20'000'000};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "engine";

  enum class StateValue : std::uint8_t {
    off = 0,
    on = 1,
    off_ = 14,
  };
  enum class TorqueValue : std::uint8_t {
    lost = 255,
  };
  ocm::protocol::MessageBytes<8> bytes{0x01, 0x00, 0x00, 0x20, 0x03};

  /// Speed: of the crank. In rpm. Stated range: 0 to 8031.875.
  static constexpr ocm::protocol::Position Speed_at{24, 16};
  [[nodiscard]] constexpr std::uint16_t Speed_raw() const noexcept {
    return ocm::protocol::read_field<std::uint16_t>(bytes, Speed_at);
  }
  constexpr void set_Speed_raw(std::uint16_t value_) noexcept {
    ocm::protocol::write_field(bytes, Speed_at, value_);
  }
  [[nodiscard]] constexpr double Speed() const noexcept { return static_cast<double>(Speed_raw()) / 8.0; }
  constexpr void set_Speed(double value_) noexcept {
    ocm::protocol::write_nearest<std::uint16_t>(bytes, Speed_at, value_ * 8.0);
  }

  /// State.
  static constexpr ocm::protocol::Position State_at{0, 4};
  [[nodiscard]] constexpr std::uint8_t State_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, State_at);
  }
  constexpr void set_State_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, State_at, value_);
  }
  [[nodiscard]] constexpr StateValue State() const noexcept { return static_cast<StateValue>(State_raw()); }
  constexpr void set_State(StateValue value_) noexcept {
    ocm::protocol::write_field(bytes, State_at, static_cast<std::uint8_t>(value_));
  }

  /// Torque. In %. [table 9]
  static constexpr ocm::protocol::Position Torque_at{8, 8};
  [[nodiscard]] constexpr std::uint8_t Torque_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Torque_at);
  }
  constexpr void set_Torque_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Torque_at, value_);
  }
  [[nodiscard]] constexpr double Torque() const noexcept { return static_cast<double>(Torque_raw()) - 125.0; }
  constexpr void set_Torque(double value_) noexcept {
    ocm::protocol::write_nearest<std::uint8_t>(bytes, Torque_at, value_ + 125.0);
  }
  [[nodiscard]] constexpr bool Torque_is(TorqueValue value_) const noexcept {
    return Torque_raw() == static_cast<std::uint8_t>(value_);
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<EEC1>(data_);
  }
  friend constexpr bool operator==(const EEC1&, const EEC1&) = default;
};

/// Call. 3 bytes, parameter group 0x0EA00.
struct Call {
  static constexpr std::string_view name = "Call";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::pgn, true, 0x0CEA0103};
  static constexpr std::size_t length = 3;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "dash";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Group.
  static constexpr ocm::protocol::Position Group_at{0, 24};
  [[nodiscard]] constexpr std::uint32_t Group() const noexcept {
    return ocm::protocol::read_field<std::uint32_t>(bytes, Group_at);
  }
  constexpr void set_Group(std::uint32_t value_) noexcept {
    ocm::protocol::write_field(bytes, Group_at, value_);
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Call>(data_);
  }
  friend constexpr bool operator==(const Call&, const Call&) = default;
};

/// Long. 39 bytes, parameter group 0x0FEE3, every 5000 ms.
struct Long {
  static constexpr std::string_view name = "Long";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::pgn, true, 0x18FEE3FE};
  static constexpr std::size_t length = 39;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{5'000'000'000};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "engine";

  ocm::protocol::MessageBytes<39> bytes{};

  /// Curve. In Nm.
  static constexpr ocm::protocol::Position Curve_at{247, 40, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::int64_t Curve_raw() const noexcept {
    return ocm::protocol::read_field<std::int64_t>(bytes, Curve_at);
  }
  constexpr void set_Curve_raw(std::int64_t value_) noexcept {
    ocm::protocol::write_field(bytes, Curve_at, value_);
  }
  [[nodiscard]] constexpr double Curve() const noexcept {
    return static_cast<double>(Curve_raw()) * -1.0 / 100.0;
  }
  constexpr void set_Curve(double value_) noexcept {
    ocm::protocol::write_nearest<std::int64_t>(bytes, Curve_at, value_ * 100.0 / -1.0);
  }

  /// Step.
  static constexpr ocm::protocol::Position Step_at{304, 1};
  [[nodiscard]] constexpr std::int8_t Step() const noexcept {
    return ocm::protocol::read_field<std::int8_t>(bytes, Step_at);
  }
  constexpr void set_Step(std::int8_t value_) noexcept { ocm::protocol::write_field(bytes, Step_at, value_); }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Long>(data_);
  }
  friend constexpr bool operator==(const Long&, const Long&) = default;
};

/// Nine_bytes. 9 bytes, parameter group 0x0FEE4, every 1000 ms.
struct Nine_bytes {
  static constexpr std::string_view name = "Nine_bytes";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::pgn, true, 0x18FEE4FE};
  static constexpr std::size_t length = 9;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{1'000'000'000};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "engine";

  ocm::protocol::MessageBytes<9> bytes{};

  /// Ninth. In V.
  static constexpr ocm::protocol::Position Ninth_at{64, 8};
  [[nodiscard]] constexpr std::uint8_t Ninth() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Ninth_at);
  }
  constexpr void set_Ninth(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Ninth_at, value_);
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Nine_bytes>(data_);
  }
  friend constexpr bool operator==(const Nine_bytes&, const Nine_bytes&) = default;
};

/// Service. 64 bytes of CAN FD, identifier 0x7DF, every 1.5 ms.
struct Service {
  static constexpr std::string_view name = "Service";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x7DF};
  static constexpr std::size_t length = 64;
  static constexpr bool fd = true;
  static constexpr ocm::base::Duration period{1'500'000};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "dash";

  enum class SubValue : std::uint8_t {
    Mode = 0,
    x = 1,
  };
  struct LampsValue {
    static constexpr std::uint16_t left = 0x01;
    static constexpr std::uint16_t right = 0x8000;
  };
  enum class AngleValue : std::int64_t {
    lost = -1,
    lost_3 = 3,
    least = INT64_MIN,
  };
  enum class SerialValue : std::uint64_t {
    all = 18'446'744'073'709'551'615U,
    one = 1,
  };
  ocm::protocol::MessageBytes<64> bytes{0x04, 0x00, 0x00, 0xC0, 0x3F, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x9A, 0x99, 0x99, 0x99, 0x99, 0x99, 0xB9, 0xBF};

  /// Mode.
  static constexpr ocm::protocol::Position Mode_at{0, 8};
  [[nodiscard]] constexpr std::int8_t Mode() const noexcept {
    return ocm::protocol::read_field<std::int8_t>(bytes, Mode_at);
  }
  constexpr void set_Mode(std::int8_t value_) noexcept { ocm::protocol::write_field(bytes, Mode_at, value_); }

  /// Load. In kW. Stated range: 0 to 10.
  static constexpr ocm::protocol::Position Load_at{8, 32};
  [[nodiscard]] constexpr bool has_Load() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, Mode_at);
    return selector_ == 1 || (selector_ >= 4 && selector_ <= 9);
  }
  [[nodiscard]] constexpr std::uint32_t Load_raw() const noexcept {
    return ocm::protocol::read_field<std::uint32_t>(bytes, Load_at);
  }
  constexpr void set_Load_raw(std::uint32_t value_) noexcept {
    ocm::protocol::write_field(bytes, Load_at, value_);
  }
  [[nodiscard]] constexpr std::optional<double> Load() const noexcept {
    if (!has_Load()) return std::nullopt;
    return static_cast<double>(std::bit_cast<float>(Load_raw())) * 2.0 + 1.0;
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_Load(double value_) noexcept {
    if (!has_Load()) return false;
    ocm::protocol::write_field(bytes, Load_at, std::bit_cast<std::uint32_t>(static_cast<float>((value_ - 1.0) / 2.0)));
    return true;
  }

  /// Sub.
  static constexpr ocm::protocol::Position Sub_at{40, 2};
  [[nodiscard]] constexpr bool has_Sub() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, Mode_at);
    return selector_ == 0 || selector_ >= 250;
  }
  [[nodiscard]] constexpr std::uint8_t Sub_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Sub_at);
  }
  constexpr void set_Sub_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Sub_at, value_);
  }
  [[nodiscard]] constexpr std::optional<SubValue> Sub() const noexcept {
    if (!has_Sub()) return std::nullopt;
    return static_cast<SubValue>(Sub_raw());
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_Sub(SubValue value_) noexcept {
    if (!has_Sub()) return false;
    ocm::protocol::write_field(bytes, Sub_at, static_cast<std::uint8_t>(value_));
    return true;
  }

  /// Deep.
  static constexpr ocm::protocol::Position Deep_at{50, 13};
  [[nodiscard]] constexpr bool has_Deep() const noexcept {
    if (!has_Sub()) return false;
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, Sub_at);
    return selector_ >= 2;
  }
  [[nodiscard]] constexpr std::uint16_t Deep_raw() const noexcept {
    return ocm::protocol::read_field<std::uint16_t>(bytes, Deep_at);
  }
  constexpr void set_Deep_raw(std::uint16_t value_) noexcept {
    ocm::protocol::write_field(bytes, Deep_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint16_t> Deep() const noexcept {
    if (!has_Deep()) return std::nullopt;
    return Deep_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_Deep(std::uint16_t value_) noexcept {
    if (!has_Deep()) return false;
    ocm::protocol::write_field(bytes, Deep_at, value_);
    return true;
  }

  /// Always.
  static constexpr ocm::protocol::Position Always_at{64, 8};
  [[nodiscard]] constexpr bool has_Always() const noexcept {
    if (!has_Sub()) return false;
    return true;
  }
  [[nodiscard]] constexpr std::uint8_t Always_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Always_at);
  }
  constexpr void set_Always_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Always_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint8_t> Always() const noexcept {
    if (!has_Always()) return std::nullopt;
    return Always_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_Always(std::uint8_t value_) noexcept {
    if (!has_Always()) return false;
    ocm::protocol::write_field(bytes, Always_at, value_);
    return true;
  }

  /// Rare. In h.
  static constexpr ocm::protocol::Position Rare_at{72, 8};
  [[nodiscard]] constexpr bool has_Rare() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, Mode_at);
    return selector_ == 3;
  }
  [[nodiscard]] constexpr std::uint8_t Rare_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Rare_at);
  }
  constexpr void set_Rare_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Rare_at, value_);
  }
  [[nodiscard]] constexpr std::optional<double> Rare() const noexcept {
    if (!has_Rare()) return std::nullopt;
    return static_cast<double>(Rare_raw()) / 2.0;
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_Rare(double value_) noexcept {
    if (!has_Rare()) return false;
    ocm::protocol::write_nearest<std::uint8_t>(bytes, Rare_at, value_ * 2.0);
    return true;
  }

  /// Lamps: what shines.
  static constexpr ocm::protocol::Position Lamps_at{80, 16};
  [[nodiscard]] constexpr bool has_Lamps() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, Mode_at);
    return selector_ == 2;
  }
  [[nodiscard]] constexpr std::uint16_t Lamps_raw() const noexcept {
    return ocm::protocol::read_field<std::uint16_t>(bytes, Lamps_at);
  }
  constexpr void set_Lamps_raw(std::uint16_t value_) noexcept {
    ocm::protocol::write_field(bytes, Lamps_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint16_t> Lamps() const noexcept {
    if (!has_Lamps()) return std::nullopt;
    return Lamps_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_Lamps(std::uint16_t value_) noexcept {
    if (!has_Lamps()) return false;
    ocm::protocol::write_field(bytes, Lamps_at, value_);
    return true;
  }

  /// Angle.
  static constexpr ocm::protocol::Position Angle_at{135, 64, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::int64_t Angle_raw() const noexcept {
    return ocm::protocol::read_field<std::int64_t>(bytes, Angle_at);
  }
  constexpr void set_Angle_raw(std::int64_t value_) noexcept {
    ocm::protocol::write_field(bytes, Angle_at, value_);
  }
  [[nodiscard]] constexpr AngleValue Angle() const noexcept { return static_cast<AngleValue>(Angle_raw()); }
  constexpr void set_Angle(AngleValue value_) noexcept {
    ocm::protocol::write_field(bytes, Angle_at, static_cast<std::int64_t>(value_));
  }

  /// Serial.
  static constexpr ocm::protocol::Position Serial_at{192, 64};
  [[nodiscard]] constexpr std::uint64_t Serial_raw() const noexcept {
    return ocm::protocol::read_field<std::uint64_t>(bytes, Serial_at);
  }
  constexpr void set_Serial_raw(std::uint64_t value_) noexcept {
    ocm::protocol::write_field(bytes, Serial_at, value_);
  }
  [[nodiscard]] constexpr SerialValue Serial() const noexcept {
    return static_cast<SerialValue>(Serial_raw());
  }
  constexpr void set_Serial(SerialValue value_) noexcept {
    ocm::protocol::write_field(bytes, Serial_at, static_cast<std::uint64_t>(value_));
  }

  /// Exact.
  static constexpr ocm::protocol::Position Exact_at{256, 64};
  [[nodiscard]] constexpr std::uint64_t Exact_raw() const noexcept {
    return ocm::protocol::read_field<std::uint64_t>(bytes, Exact_at);
  }
  constexpr void set_Exact_raw(std::uint64_t value_) noexcept {
    ocm::protocol::write_field(bytes, Exact_at, value_);
  }
  [[nodiscard]] constexpr double Exact() const noexcept { return ocm::base::from_binary64(Exact_raw()); }
  constexpr void set_Exact(double value_) noexcept {
    ocm::protocol::write_field(bytes, Exact_at, ocm::base::to_binary64(value_));
  }

  /// Scaled. In m.
  static constexpr ocm::protocol::Position Scaled_at{320, 64};
  [[nodiscard]] constexpr std::uint64_t Scaled_raw() const noexcept {
    return ocm::protocol::read_field<std::uint64_t>(bytes, Scaled_at);
  }
  constexpr void set_Scaled_raw(std::uint64_t value_) noexcept {
    ocm::protocol::write_field(bytes, Scaled_at, value_);
  }
  [[nodiscard]] constexpr double Scaled() const noexcept {
    return static_cast<double>(ocm::base::from_binary64(Scaled_raw())) / 2.0;
  }
  constexpr void set_Scaled(double value_) noexcept {
    ocm::protocol::write_field(bytes, Scaled_at, ocm::base::to_binary64(value_ * 2.0));
  }

  /// Plain. In A.
  static constexpr ocm::protocol::Position Plain_at{384, 32};
  [[nodiscard]] constexpr std::uint32_t Plain_raw() const noexcept {
    return ocm::protocol::read_field<std::uint32_t>(bytes, Plain_at);
  }
  constexpr void set_Plain_raw(std::uint32_t value_) noexcept {
    ocm::protocol::write_field(bytes, Plain_at, value_);
  }
  [[nodiscard]] constexpr float Plain() const noexcept { return std::bit_cast<float>(Plain_raw()); }
  constexpr void set_Plain(float value_) noexcept {
    ocm::protocol::write_field(bytes, Plain_at, std::bit_cast<std::uint32_t>(value_));
  }

  /// Scaled64. In bit.
  static constexpr ocm::protocol::Position Scaled64_at{416, 64};
  [[nodiscard]] constexpr std::uint64_t Scaled64_raw() const noexcept {
    return ocm::protocol::read_field<std::uint64_t>(bytes, Scaled64_at);
  }
  constexpr void set_Scaled64_raw(std::uint64_t value_) noexcept {
    ocm::protocol::write_field(bytes, Scaled64_at, value_);
  }
  [[nodiscard]] constexpr double Scaled64() const noexcept {
    return static_cast<double>(Scaled64_raw()) / 2.0;
  }
  constexpr void set_Scaled64(double value_) noexcept {
    ocm::protocol::write_nearest<std::uint64_t>(bytes, Scaled64_at, value_ * 2.0);
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Service>(data_);
  }
  friend constexpr bool operator==(const Service&, const Service&) = default;
};

/// int. ends in a backslash/ 5 bytes, identifier 0x18FEF100.
struct int_ {
  static constexpr std::string_view name = "int";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, true, 0x18FEF100};
  static constexpr std::size_t length = 5;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "";

  ocm::protocol::MessageBytes<8> bytes{};

  /// NULL.
  static constexpr ocm::protocol::Position NULL_at{7, 12, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::uint16_t NULL_() const noexcept {
    return ocm::protocol::read_field<std::uint16_t>(bytes, NULL_at);
  }
  constexpr void set_NULL_(std::uint16_t value_) noexcept {
    ocm::protocol::write_field(bytes, NULL_at, value_);
  }

  /// a.b. Stated range: 0 to 0.
  static constexpr ocm::protocol::Position a_b_at{11, 12, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::uint16_t a_b() const noexcept {
    return ocm::protocol::read_field<std::uint16_t>(bytes, a_b_at);
  }
  constexpr void set_a_b(std::uint16_t value_) noexcept { ocm::protocol::write_field(bytes, a_b_at, value_); }

  /// a-b. In 1/.
  static constexpr ocm::protocol::Position a_b_2_at{31, 16, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::uint16_t a_b_2() const noexcept {
    return ocm::protocol::read_field<std::uint16_t>(bytes, a_b_2_at);
  }
  constexpr void set_a_b_2(std::uint16_t value_) noexcept {
    ocm::protocol::write_field(bytes, a_b_2_at, value_);
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<int_>(data_);
  }
  friend constexpr bool operator==(const int_&, const int_&) = default;
};

/// 2nd_message_of_a_long_name_for_DBC. 1 byte, identifier 0x002. Beyond its length, and not here: Later.
struct n2nd_message_of_a_long_name_for_DBC {
  static constexpr std::string_view name = "2nd_message_of_a_long_name_for_DBC";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x002};
  static constexpr std::size_t length = 1;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "";

  struct BitValue {
    static constexpr std::uint8_t set_ = 0x01;
  };
  ocm::protocol::MessageBytes<8> bytes{};

  /// a_signal_that_has_a_name_longer_than_32_characters. In |<_*.
  static constexpr ocm::protocol::Position a_signal_that_has_a_name_longer_than_32_characters_at{0, 3};
  [[nodiscard]] constexpr std::uint8_t a_signal_that_has_a_name_longer_than_32_characters() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, a_signal_that_has_a_name_longer_than_32_characters_at);
  }
  constexpr void set_a_signal_that_has_a_name_longer_than_32_characters(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, a_signal_that_has_a_name_longer_than_32_characters_at, value_);
  }

  /// Bit.
  static constexpr ocm::protocol::Position Bit_at{7, 1};
  [[nodiscard]] constexpr std::uint8_t Bit() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Bit_at);
  }
  constexpr void set_Bit(std::uint8_t value_) noexcept { ocm::protocol::write_field(bytes, Bit_at, value_); }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<n2nd_message_of_a_long_name_for_DBC>(data_);
  }
  friend constexpr bool operator==(const n2nd_message_of_a_long_name_for_DBC&, const n2nd_message_of_a_long_name_for_DBC&) = default;
};

/// Simple. 3 bytes, identifier 0x101.
struct Simple {
  static constexpr std::string_view name = "Simple";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x101};
  static constexpr std::size_t length = 3;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "dash";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Page.
  static constexpr ocm::protocol::Position Page_at{0, 8};
  [[nodiscard]] constexpr std::uint8_t Page() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Page_at);
  }
  constexpr void set_Page(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Page_at, value_);
  }

  /// First.
  static constexpr ocm::protocol::Position First_at{8, 16};
  [[nodiscard]] constexpr bool has_First() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, Page_at);
    return selector_ == 0;
  }
  [[nodiscard]] constexpr std::int16_t First_raw() const noexcept {
    return ocm::protocol::read_field<std::int16_t>(bytes, First_at);
  }
  constexpr void set_First_raw(std::int16_t value_) noexcept {
    ocm::protocol::write_field(bytes, First_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::int16_t> First() const noexcept {
    if (!has_First()) return std::nullopt;
    return First_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_First(std::int16_t value_) noexcept {
    if (!has_First()) return false;
    ocm::protocol::write_field(bytes, First_at, value_);
    return true;
  }

  /// Second.
  static constexpr ocm::protocol::Position Second_at{15, 16, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr bool has_Second() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, Page_at);
    return selector_ == 1;
  }
  [[nodiscard]] constexpr std::uint16_t Second_raw() const noexcept {
    return ocm::protocol::read_field<std::uint16_t>(bytes, Second_at);
  }
  constexpr void set_Second_raw(std::uint16_t value_) noexcept {
    ocm::protocol::write_field(bytes, Second_at, value_);
  }
  [[nodiscard]] constexpr std::optional<double> Second() const noexcept {
    if (!has_Second()) return std::nullopt;
    return static_cast<double>(Second_raw()) * 10.0 + 5.0;
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_Second(double value_) noexcept {
    if (!has_Second()) return false;
    ocm::protocol::write_nearest<std::uint16_t>(bytes, Second_at, (value_ - 5.0) / 10.0);
    return true;
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Simple>(data_);
  }
  friend constexpr bool operator==(const Simple&, const Simple&) = default;
};

/// Two_pages. 3 bytes, identifier 0x102.
struct Two_pages {
  static constexpr std::string_view name = "Two_pages";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x102};
  static constexpr std::size_t length = 3;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Page.
  static constexpr ocm::protocol::Position Page_at{0, 4};
  [[nodiscard]] constexpr std::uint8_t Page() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Page_at);
  }
  constexpr void set_Page(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Page_at, value_);
  }

  /// Other.
  static constexpr ocm::protocol::Position Other_at{4, 4};
  [[nodiscard]] constexpr std::uint8_t Other() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Other_at);
  }
  constexpr void set_Other(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Other_at, value_);
  }

  /// First.
  static constexpr ocm::protocol::Position First_at{8, 8};
  [[nodiscard]] constexpr bool has_First() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, Page_at);
    return selector_ == 0;
  }
  [[nodiscard]] constexpr std::uint8_t First_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, First_at);
  }
  constexpr void set_First_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, First_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint8_t> First() const noexcept {
    if (!has_First()) return std::nullopt;
    return First_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_First(std::uint8_t value_) noexcept {
    if (!has_First()) return false;
    ocm::protocol::write_field(bytes, First_at, value_);
    return true;
  }

  /// Second.
  static constexpr ocm::protocol::Position Second_at{16, 8};
  [[nodiscard]] constexpr bool has_Second() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, Other_at);
    return selector_ == 15;
  }
  [[nodiscard]] constexpr std::uint8_t Second_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Second_at);
  }
  constexpr void set_Second_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Second_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint8_t> Second() const noexcept {
    if (!has_Second()) return std::nullopt;
    return Second_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_Second(std::uint8_t value_) noexcept {
    if (!has_Second()) return false;
    ocm::protocol::write_field(bytes, Second_at, value_);
    return true;
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Two_pages>(data_);
  }
  friend constexpr bool operator==(const Two_pages&, const Two_pages&) = default;
};

/// Nothing. 0 bytes, identifier 0x000.
struct Nothing {
  static constexpr std::string_view name = "Nothing";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x000};
  static constexpr std::size_t length = 0;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Nothing>(data_);
  }
  friend constexpr bool operator==(const Nothing&, const Nothing&) = default;
};

// clang-format off
namespace detail {
namespace protocol = ocm::protocol;

// Fields: name, {start, width, order}, signed, scale, offset, unit, lowest and highest raw number,
// names of values or flags, whether flags. Scale and offset: {digits, power of ten}.
// Frames: name, id, DLC, fields, most bits by priority, fields with what is derived of them.
// Laws of what is derived: at one, offset, noise, least and greatest value at which they hold.
// Topics: index of the board, aliases, frames, source, and of several of a kind: number and name.

namespace status_identity {
inline constexpr std::array<protocol::Field, 3> fields{{
  {"uptime", {0, 24, protocol::ByteOrder::little}, false, {1, 0}, {}, "s", 0, 16'777'215, {}, false},
  {"reset", {24, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"wire_hash", {32, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 4'294'967'295, {}, false},
}};
}  // namespace status_identity
namespace status_health {
inline constexpr std::array<protocol::Field, 6> fields{{
  {"load", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "%", 0, 100, {}, false},
  {"bus", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"publishing", {16, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"faults", {24, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"overload", {32, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"bus_errors", {48, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
}  // namespace status_health
namespace status {
inline constexpr std::array<protocol::FrameLayout, 2> frames{{
  {"identity", protocol::TopicId{0x70}, 8, status_identity::fields, {131, 131, 131, 131}},
  {"health", protocol::TopicId{0x71}, 8, status_health::fields, {130, 130, 130, 130}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace status

namespace refusal {
inline constexpr std::array<protocol::Field, 3> fields{{
  {"topic", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"reason", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"refused", {16, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x72}, 4, fields, {90, 90, 90, 90}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace refusal

namespace gyroscope {
inline constexpr std::array<std::string_view, 2> aliases{"gyro", "turn"};
inline constexpr std::array<protocol::NamedValue, 2> value_names{{{0, "off"}, {1, "on"}}};
inline constexpr std::array<protocol::NamedValue, 1> temperature_names{{{255, "unknown"}}};
inline constexpr std::array<protocol::NamedValue, 4> state_names{{{0, "ready"}, {7, "data"}, {8, "late"},
                                                                  {15, "broken"}}};
inline constexpr std::array<protocol::NamedValue, 2> spare_names{{{-128, "least"}, {0, "none"}}};
inline constexpr std::array<protocol::Field, 6> fields{{
  {"x", {0, 16, protocol::ByteOrder::little}, true, {175, -4}, {}, "deg/s", -28'571, 28'571, {}, false},
  {"y", {16, 12, protocol::ByteOrder::little}, true, {-25, -2}, {3, 0}, "deg/s", -2'048, 2'047, {}, false},
  {"value", {28, 4, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 15, value_names, false},
  {"temperature", {32, 8, protocol::ByteOrder::little}, false, {5, -1}, {-4, 1}, "°C", 0, 255, temperature_names, false},
  {"state", {40, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, state_names, true},
  {"spare", {56, 8, protocol::ByteOrder::little}, true, {1, 0}, {}, "", -128, 127, spare_names, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x08}, 8, fields, {132, 131, 132, 131}},
}};
inline constexpr std::string_view source =
  "data sheet \"A\"; id decided: free; period: table 2; deadline: table 3; jitter: table 4; priority decided: first";
}  // namespace gyroscope

namespace position_pose {
inline constexpr std::array<protocol::Field, 3> fields{{
  {"x", {7, 24, protocol::ByteOrder::big}, true, {1, -3}, {}, "m", -8'388'608, 8'388'607, {}, false},
  {"y", {31, 24, protocol::ByteOrder::big}, true, {1, -3}, {}, "m", -8'388'608, 8'388'607, {}, false},
  {"orientation", {55, 16, protocol::ByteOrder::big}, false, {1, -4}, {}, "rad", 0, 65'535, {}, false},
}};
}  // namespace position_pose
namespace position_cell {
inline constexpr std::array<protocol::NamedValue, 2> restrict_names{{{0, "low"}, {18, "high"}}};
inline constexpr std::array<protocol::Field, 3> fields{{
  {"data", {0, 32, protocol::ByteOrder::little}, false, {5, -1}, {}, "V", 0, 4'294'967'295, {}, false, protocol::Number::float32, protocol::no_selector, {}, 0, {-25, -1}, {4, 1}},
  {"on", {33, 12, protocol::ByteOrder::little}, false, {1, 0}, {}, "mA", 0, 4'000, {}, false},
  {"restrict", {45, 19, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 524'287, restrict_names, true},
}};
}  // namespace position_cell
namespace position_value {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"all", {0, 64, protocol::ByteOrder::little}, false, {1, -3}, {-2, 0}, "km", 0, 9'223'372'036'854'775'807, {}, false, protocol::Number::float64},
}};
}  // namespace position_value
namespace position_i {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"wide", {7, 64, protocol::ByteOrder::big}, true, {1, 0}, {}, "", INT64_MIN, 9'223'372'036'854'775'807, {}, false},
}};
}  // namespace position_i
namespace position_tail {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"far", {1, 63, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 9'223'372'036'854'775'807, {}, false},
}};
}  // namespace position_tail
namespace position {
inline constexpr std::array<protocol::FrameLayout, 8> frames{{
  {"pose", protocol::TopicId{0x10}, 8, position_pose::fields, {131, 131, 131, 131}},
  {"cell_1", protocol::TopicId{0x11}, 8, position_cell::fields, {131, 130, 130, 130}},
  {"cell_2", protocol::TopicId{0x12}, 8, position_cell::fields, {131, 130, 130, 130}},
  {"cell_3", protocol::TopicId{0x13}, 8, position_cell::fields, {131, 130, 130, 130}},
  {"value", protocol::TopicId{0x14}, 8, position_value::fields, {131, 131, 131, 131}},
  {"i", protocol::TopicId{0x15}, 8, position_i::fields, {131, 130, 130, 130}},
  {"tail", protocol::TopicId{0x16}, 8, position_tail::fields, {131, 130, 130, 130}},
  {"last", protocol::TopicId{0x17}, 0, {}, {49, 49, 49, 49}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace position

namespace second_position_pose {
inline constexpr std::array<protocol::Field, 3> fields{{
  {"x", {7, 24, protocol::ByteOrder::big}, true, {1, -3}, {}, "m", -8'388'608, 8'388'607, {}, false},
  {"y", {31, 24, protocol::ByteOrder::big}, true, {1, -3}, {}, "m", -8'388'608, 8'388'607, {}, false},
  {"orientation", {55, 16, protocol::ByteOrder::big}, false, {1, -4}, {}, "rad", 0, 65'535, {}, false},
}};
}  // namespace second_position_pose
namespace second_position_cell {
inline constexpr std::array<protocol::NamedValue, 2> restrict_names{{{0, "low"}, {18, "high"}}};
inline constexpr std::array<protocol::Field, 3> fields{{
  {"data", {0, 32, protocol::ByteOrder::little}, false, {5, -1}, {}, "V", 0, 4'294'967'295, {}, false, protocol::Number::float32, protocol::no_selector, {}, 0, {-25, -1}, {4, 1}},
  {"on", {33, 12, protocol::ByteOrder::little}, false, {1, 0}, {}, "mA", 0, 4'000, {}, false},
  {"restrict", {45, 19, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 524'287, restrict_names, true},
}};
}  // namespace second_position_cell
namespace second_position_value {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"all", {0, 64, protocol::ByteOrder::little}, false, {1, -3}, {-2, 0}, "km", 0, 9'223'372'036'854'775'807, {}, false, protocol::Number::float64},
}};
}  // namespace second_position_value
namespace second_position_i {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"wide", {7, 64, protocol::ByteOrder::big}, true, {1, 0}, {}, "", INT64_MIN, 9'223'372'036'854'775'807, {}, false},
}};
}  // namespace second_position_i
namespace second_position_tail {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"far", {1, 63, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 9'223'372'036'854'775'807, {}, false},
}};
}  // namespace second_position_tail
namespace second_position {
inline constexpr std::array<protocol::FrameLayout, 8> frames{{
  {"pose", protocol::TopicId{0x18}, 8, second_position_pose::fields, {131, 131, 131, 131}},
  {"cell_1", protocol::TopicId{0x19}, 8, second_position_cell::fields, {131, 130, 129, 130}},
  {"cell_2", protocol::TopicId{0x1A}, 8, second_position_cell::fields, {131, 130, 130, 129}},
  {"cell_3", protocol::TopicId{0x1B}, 8, second_position_cell::fields, {131, 130, 130, 130}},
  {"value", protocol::TopicId{0x1C}, 8, second_position_value::fields, {132, 131, 131, 131}},
  {"i", protocol::TopicId{0x1D}, 8, second_position_i::fields, {131, 130, 130, 130}},
  {"tail", protocol::TopicId{0x1E}, 8, second_position_tail::fields, {133, 130, 130, 130}},
  {"last", protocol::TopicId{0x1F}, 0, {}, {50, 50, 49, 50}},
}};
inline constexpr std::string_view source =
  "decided: the same";
}  // namespace second_position

namespace ring_sensor {
inline constexpr std::array<protocol::Field, 2> fields{{
  {"proximity", {0, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
  {"ambient", {16, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
inline constexpr std::array<protocol::Law, 4> distance_laws{{
  {{942693757, -9}, {2289, 0}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {2302, 0}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {}, {457, -2}, {38, -4}, {2, -1}},
  {{942693757, -9}, {-5, 0}, {457, -2}, {38, -4}, {2, -1}},
}};
inline constexpr std::array<protocol::Law, 4> glow_laws{{
  {{3, 0}, {7, 0}, {}, {1, 0}, {2, 0}},
  {{3, 0}, {7, 0}, {}, {1, 0}, {2, 0}},
  {{3, 0}, {7, 0}, {}, {1, 0}, {2, 0}},
  {{3, 0}, {7, 0}, {}, {1, 0}, {2, 0}},
}};
inline constexpr std::array<protocol::Field, 5> with_derived_1{{
  fields[0],
  fields[1],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[0], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[0], true),
  protocol::derived(fields[1], 1, "glow", "m", glow_laws[0], false),
}};
inline constexpr std::array<protocol::Field, 5> with_derived_2{{
  fields[0],
  fields[1],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[1], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[1], true),
  protocol::derived(fields[1], 1, "glow", "m", glow_laws[1], false),
}};
inline constexpr std::array<protocol::Field, 5> with_derived_3{{
  fields[0],
  fields[1],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[2], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[2], true),
  protocol::derived(fields[1], 1, "glow", "m", glow_laws[2], false),
}};
inline constexpr std::array<protocol::Field, 5> with_derived_4{{
  fields[0],
  fields[1],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[3], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[3], true),
  protocol::derived(fields[1], 1, "glow", "m", glow_laws[3], false),
}};
}  // namespace ring_sensor
namespace ring_mean {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"proximity", {0, 16, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 65'535, {}, false},
}};
inline constexpr std::array<protocol::Law, 1> distance_laws{{
  {{1, 0}, {}, {2, 0}, {1, -2}, {1, 0}},
}};
inline constexpr std::array<protocol::Field, 3> with_derived{{
  fields[0],
  protocol::derived(fields[0], 0, "distance", "m", distance_laws[0], false),
  protocol::derived(fields[0], 0, "distance_uncertainty", "m", distance_laws[0], true),
}};
}  // namespace ring_mean
namespace ring {
inline constexpr std::array<protocol::FrameLayout, 5> frames{{
  {"sensor_1", protocol::TopicId{0x30}, 4, ring_sensor::fields, {90, 90, 90, 90}, ring_sensor::with_derived_1},
  {"sensor_2", protocol::TopicId{0x31}, 4, ring_sensor::fields, {89, 89, 89, 89}, ring_sensor::with_derived_2},
  {"sensor_3", protocol::TopicId{0x32}, 4, ring_sensor::fields, {90, 90, 90, 90}, ring_sensor::with_derived_3},
  {"sensor_4", protocol::TopicId{0x33}, 4, ring_sensor::fields, {89, 89, 89, 89}, ring_sensor::with_derived_4},
  {"mean", protocol::TopicId{0x34}, 2, ring_mean::fields, {69, 69, 70, 70}, ring_mean::with_derived},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace ring

namespace floor {
inline constexpr std::array<protocol::NamedValue, 1> sum_names{{{0, "none"}}};
inline constexpr std::array<protocol::Field, 4> fields{{
  {"left", {7, 12, protocol::ByteOrder::big}, false, {1, 0}, {}, "", 0, 4'095, {}, false},
  {"right", {11, 12, protocol::ByteOrder::big}, false, {1, 0}, {}, "", 0, 4'095, {}, false},
  {"a_field_with_a_name_of_some_37_letters", {24, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 4'294'967'295, {}, false, protocol::Number::float32},
  {"sum", {56, 8, protocol::ByteOrder::little}, true, {1, 0}, {}, "", -128, 127, sum_names, false},
}};
inline constexpr std::array<protocol::Law, 1> height_laws{{
  {{2, 0}, {15, -1}, {25, -2}, {5, -1}, {3, 0}},
}};
inline constexpr std::array<protocol::Field, 6> with_derived{{
  fields[0],
  fields[1],
  fields[2],
  fields[3],
  protocol::derived(fields[0], 0, "height", "cm", height_laws[0], false),
  protocol::derived(fields[0], 0, "height_uncertainty", "cm", height_laws[0], true),
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x40}, 8, fields, {131, 131, 131, 131}, with_derived},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace floor

namespace a_topic_with_a_name_longer_than_dbc_has {
inline constexpr std::array<protocol::NamedValue, 2> count_of_wheels_names{{{0, "first"}, {31, "all"}}};
inline constexpr std::array<protocol::Field, 1> fields{{
  {"count_of_wheels", {0, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 4'294'967'295, count_of_wheels_names, true},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x41}, 4, fields, {90, 90, 90, 90}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace a_topic_with_a_name_longer_than_dbc_has

namespace motors {
inline constexpr std::array<std::string_view, 1> aliases{"speed"};
inline constexpr std::array<protocol::Field, 2> fields{{
  {"x", {0, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "m/s", -500'000, 500'000, {}, false},
  {"z", {32, 32, protocol::ByteOrder::little}, true, {1, -6}, {}, "rad/s", INT32_MIN, 2'147'483'647, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x01}, 8, fields, {132, 131, 131, 131}},
}};
inline constexpr std::string_view source =
  "decided: for tests; timeout: table 8";
}  // namespace motors

namespace lamp {
inline constexpr std::array<protocol::Field, 3> fields{{
  {"red", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"green", {8, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
  {"blue", {16, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 3> frames{{
  {"", protocol::TopicId{0x20}, 3, fields, {82, 81, 81, 81}},
  {"", protocol::TopicId{0x21}, 3, fields, {81, 80, 80, 81}},
  {"", protocol::TopicId{0x22}, 3, fields, {81, 80, 81, 80}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace lamp

namespace brake {
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x28}, 0, {}, {50, 50, 50, 50}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace brake

namespace arm {
inline constexpr std::array<protocol::NamedValue, 1> angle_names{{{0, "rest"}}};
inline constexpr std::array<protocol::Field, 2> fields{{
  {"angle", {0, 16, protocol::ByteOrder::little}, true, {1, 0}, {}, "deg", -32'768, 32'767, angle_names, false},
  {"bend", {16, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "deg", 0, 4'294'967'295, {}, false, protocol::Number::float32, protocol::no_selector, {}, 0, {-9, 1}, {9, 1}},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x29}, 6, fields, {110, 109, 109, 109}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace arm

inline constexpr std::array<protocol::Board, 5> boards{{
  {"main_board", "STM32F405"},
  {"a_board_with_a_name_of_35_characters", "STM32G0B1"},
  {"idle", "none"},
  {"engine", "8051"},
  {"dash", "none"},
}};

inline constexpr std::array<protocol::Topic, 14> topics{{
  protocol::catalogue_entry<Status>(0, {}, status::frames, status::source),
  protocol::catalogue_entry<Refusal>(0, {}, refusal::frames, refusal::source),
  protocol::catalogue_entry<Gyroscope>(0, gyroscope::aliases, gyroscope::frames, gyroscope::source),
  protocol::catalogue_entry<Position>(0, {}, position::frames, position::source),
  protocol::catalogue_entry<SecondPosition>(1, {}, second_position::frames, second_position::source),
  protocol::catalogue_entry<Ring>(1, {}, ring::frames, ring::source),
  protocol::catalogue_entry<Floor>(2, {}, floor::frames, floor::source),
  protocol::catalogue_entry<ATopicWithANameLongerThanDbcHas>(2, {}, a_topic_with_a_name_longer_than_dbc_has::frames, a_topic_with_a_name_longer_than_dbc_has::source),
  protocol::catalogue_entry<Motors>(0, motors::aliases, motors::frames, motors::source),
  protocol::catalogue_entry<Lamp>(2, {}, {&lamp::frames[0], 1}, lamp::source, 1, "lamp_1"),
  protocol::catalogue_entry<Lamp>(2, {}, {&lamp::frames[1], 1}, lamp::source, 2, "lamp_2"),
  protocol::catalogue_entry<Lamp>(2, {}, {&lamp::frames[2], 1}, lamp::source, 3, "lamp_3"),
  protocol::catalogue_entry<Brake>(2, {}, brake::frames, brake::source),
  protocol::catalogue_entry<Arm>(2, {}, arm::frames, arm::source),
}};
}  // namespace detail
// clang-format on

/// Everything that is said on the bus, as a tool sees it that loads the spec when it runs.
inline constexpr ocm::protocol::Catalogue catalogue{"Whole", bit_rate, detail::boards, detail::topics};

/// What tells a board that was built from another spec: boards report it in their status.
inline constexpr std::uint32_t wire_hash = ocm::protocol::wire_hash(catalogue);

/// The board main_board: which drives. [schematic]
struct MainBoard {
  static constexpr std::string_view name = "main_board";
  static constexpr std::string_view mcu = "STM32F405";
  static constexpr std::uint32_t clock_hz = 168'000'000;
  static constexpr std::uint32_t can_clock_hz = 42'000'000;
  using sensors = ocm::protocol::TopicList<Status, Refusal, Gyroscope, Position>;
  using actuators = ocm::protocol::TopicList<Motors>;
  using status = Status;
  using refusal = Refusal;
  static constexpr std::uint32_t wire_hash = whole::wire_hash;
};

/// The board a_board_with_a_name_of_35_characters: Has a name longer than DBC's. [schematic]
struct ABoardWithANameOf35Characters {
  static constexpr std::string_view name = "a_board_with_a_name_of_35_characters";
  static constexpr std::string_view mcu = "STM32G0B1";
  using sensors = ocm::protocol::TopicList<SecondPosition, Ring>;
  using actuators = ocm::protocol::TopicList<>;
  using status = void;
  using refusal = void;
  static constexpr std::uint32_t wire_hash = whole::wire_hash;
};

/// The board idle. [decided: for tests]
struct Idle {
  static constexpr std::string_view name = "idle";
  static constexpr std::string_view mcu = "none";
  using sensors = ocm::protocol::TopicList<Floor, ATopicWithANameLongerThanDbcHas>;
  using actuators = ocm::protocol::TopicList<Lamp, Brake, Arm>;
  using status = void;
  using refusal = void;
  static constexpr std::uint32_t wire_hash = whole::wire_hash;
};

/// The board engine: says "rpm"; from Köln, Škoda and Łódź. [a letter; mcu: its lid]
struct Engine {
  static constexpr std::string_view name = "engine";
  static constexpr std::string_view mcu = "8051";
  using sensors = ocm::protocol::TopicList<>;
  using actuators = ocm::protocol::TopicList<>;
  using status = void;
  using refusal = void;
  static constexpr std::uint32_t wire_hash = whole::wire_hash;
};

/// The board dash. [decided: for tests]
struct Dash {
  static constexpr std::string_view name = "dash";
  static constexpr std::string_view mcu = "none";
  using sensors = ocm::protocol::TopicList<>;
  using actuators = ocm::protocol::TopicList<>;
  using status = void;
  using refusal = void;
  static constexpr std::uint32_t wire_hash = whole::wire_hash;
};

}  // namespace whole
