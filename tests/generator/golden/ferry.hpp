// Made by ocm-generate from topics.json. Do not edit: change the spec, and generate again.

/// The topics of Ferry: an invented robot that carries boxes: other ids, big-endian, packed fields, two
/// boards.
///
/// Members of a frame are raw numbers, as they travel. name_unit() is the physical value, rounded once where
/// raw number times scale stays below 2^53; set_name_unit() takes the nearest raw number within the field's
/// range, and the one nearest to zero for not a number. encode() puts the nearest number that the width
/// holds. `frames` has of each frame the id, the DLC, and the most bits that it takes on the bus at each
/// priority, whatever its content. No heap, no exceptions; everything is constexpr.
///
/// Where a period, deadline, jitter, priority or timeout names no source: [decided]
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

namespace ferry {

/// Bits per second on the bus. [decided]
inline constexpr std::uint32_t bit_rate = 250'000;

/// Range: distance to the nearest obstacle on either side. Sensor of Chassis, requests on 0xA0. [decided]
struct Range {
  static constexpr std::string_view name = "range";
  static constexpr ocm::protocol::TopicId id{0xA0};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0xA0}, 3, {81, 81, 81, 81}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{20, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{10};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{20};
  static constexpr ocm::base::Duration jitter = std::chrono::microseconds{200};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  std::uint16_t left = 0;   ///< 0.001 m a bit, [0, 4.095] m
  std::uint16_t right = 0;  ///< 0.001 m a bit, [0, 4.095] m

  using LeftBits = ocm::protocol::Bits<std::uint16_t, 7, 12, ocm::protocol::ByteOrder::big>;
  using RightBits = ocm::protocol::Bits<std::uint16_t, 11, 12, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr double left_m() const noexcept { return left / 1'000.0; }
  constexpr void set_left_m(double value) noexcept {
    left = ocm::protocol::nearest_raw<std::uint16_t>(value * 1'000.0, LeftBits::min, LeftBits::max);
  }
  [[nodiscard]] constexpr double right_m() const noexcept { return right / 1'000.0; }
  constexpr void set_right_m(double value) noexcept {
    right = ocm::protocol::nearest_raw<std::uint16_t>(value * 1'000.0, RightBits::min, RightBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    LeftBits::put(data, left);
    RightBits::put(data, right);
    return data;
  }
  [[nodiscard]] static constexpr Range decode(const ocm::can::Payload& data) noexcept {
    Range value;
    value.left = LeftBits::get(data);
    value.right = RightBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Range decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Range&, const Range&) = default;
};
static_assert(ocm::protocol::TopicType<Range>);

/// Fork status, state.
struct ForkStatusState {
  static constexpr ocm::protocol::TopicId id{0xB1};
  static constexpr std::uint8_t dlc = 4;

  enum class Mode : std::uint8_t {
    parked = 0,
    moving = 1,
    holding = 2,
    jammed = 7,
  };
  static constexpr std::uint8_t loaded_flag = 0x01;
  static constexpr std::uint8_t top_flag = 0x02;
  static constexpr std::uint8_t bottom_flag = 0x10;
  static constexpr std::int16_t height_unknown = -1;

  Mode mode{};
  std::uint8_t flags = 0;
  std::uint8_t temperature = 0;  ///< 0.5 °C a bit, from -40 °C on, [-40, 85] °C
  std::int16_t height = 0;       ///< 0.1 mm a bit, [0, 1800] mm

  using ModeBits = ocm::protocol::Bits<std::uint8_t, 7, 3, ocm::protocol::ByteOrder::big>;
  using FlagsBits = ocm::protocol::Bits<std::uint8_t, 4, 5, ocm::protocol::ByteOrder::big>;
  using TemperatureBits = ocm::protocol::Bits<std::uint8_t, 15, 8, ocm::protocol::ByteOrder::big>;
  using HeightBits = ocm::protocol::Bits<std::int16_t, 16>;

  [[nodiscard]] constexpr bool loaded() const noexcept { return (flags & loaded_flag) != 0; }
  constexpr void set_loaded(bool on) noexcept {
    flags = static_cast<std::uint8_t>(on ? flags | loaded_flag : flags & ~loaded_flag);
  }
  [[nodiscard]] constexpr bool top() const noexcept { return (flags & top_flag) != 0; }
  constexpr void set_top(bool on) noexcept {
    flags = static_cast<std::uint8_t>(on ? flags | top_flag : flags & ~top_flag);
  }
  [[nodiscard]] constexpr bool bottom() const noexcept { return (flags & bottom_flag) != 0; }
  constexpr void set_bottom(bool on) noexcept {
    flags = static_cast<std::uint8_t>(on ? flags | bottom_flag : flags & ~bottom_flag);
  }
  [[nodiscard]] constexpr double temperature_celsius() const noexcept {
    return (temperature * 5.0 - 400.0) / 10.0;
  }
  constexpr void set_temperature_celsius(double value) noexcept {
    temperature = ocm::protocol::nearest_raw<std::uint8_t>((value * 10.0 + 400.0) / 5.0, 0, 250);
  }
  [[nodiscard]] constexpr double height_mm() const noexcept { return height / 10.0; }
  constexpr void set_height_mm(double value) noexcept {
    height = ocm::protocol::nearest_raw<std::int16_t>(value * 10.0, 0, 18'000);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    ModeBits::put(data, static_cast<std::uint8_t>(mode));
    FlagsBits::put(data, flags);
    TemperatureBits::put(data, temperature);
    HeightBits::put(data, height);
    return data;
  }
  [[nodiscard]] static constexpr ForkStatusState decode(const ocm::can::Payload& data) noexcept {
    ForkStatusState value;
    value.mode = static_cast<Mode>(ModeBits::get(data));
    value.flags = FlagsBits::get(data);
    value.temperature = TemperatureBits::get(data);
    value.height = HeightBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const ForkStatusState&, const ForkStatusState&) = default;
};

/// Fork status, one cell: load cells, front left first, clockwise.
struct ForkStatusCell {
  static constexpr ocm::protocol::TopicId id{0xB2};  ///< of the first of 4
  static constexpr std::uint8_t dlc = 4;

  std::int32_t force = 0;  ///< -0.25 N a bit, from 3.5 N on, [-131068.25, 131075.5] N

  using ForceBits = ocm::protocol::Bits<std::int32_t, 7, 20, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr double force_N() const noexcept { return (force * -25.0 + 350.0) / 100.0; }
  constexpr void set_force_N(double value) noexcept {
    force = ocm::protocol::nearest_raw<std::int32_t>((value * 100.0 - 350.0) / -25.0, ForceBits::min,
                                                     ForceBits::max);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    ForceBits::put(data, force);
    return data;
  }
  [[nodiscard]] static constexpr ForkStatusCell decode(const ocm::can::Payload& data) noexcept {
    ForkStatusCell value;
    value.force = ForceBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const ForkStatusCell&, const ForkStatusCell&) = default;
};

/// Fork status: where the fork is and how it feels. Sensor of Lift, requests on 0xB0. [decided]
struct ForkStatus {
  static constexpr std::string_view name = "fork_status";
  static constexpr ocm::protocol::TopicId id{0xB0};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 5> frames{{
      {ocm::protocol::TopicId{0xB1}, 4, {89, 89, 89, 89}},
      {ocm::protocol::TopicId{0xB2}, 4, {90, 90, 91, 90}},
      {ocm::protocol::TopicId{0xB3}, 4, {89, 90, 89, 89}},
      {ocm::protocol::TopicId{0xB4}, 4, {90, 90, 90, 90}},
      {ocm::protocol::TopicId{0xB5}, 4, {89, 89, 89, 89}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period = std::chrono::milliseconds{100};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{20};
  static constexpr ocm::base::Duration jitter = std::chrono::microseconds{200};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::low;

  ForkStatusState state;
  std::array<ForkStatusCell, 4> cell{};

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return state.encode();
    if (frame >= 1 && frame < 5) return cell[frame - 1].encode();
    return {};
  }
  [[nodiscard]] static constexpr ForkStatus decode(const std::array<ocm::can::Payload, 5>& all) noexcept {
    ForkStatus value;
    value.state = ForkStatusState::decode(all[0]);
    for (std::size_t i = 0; i < value.cell.size(); ++i) value.cell[i] = ForkStatusCell::decode(all[1 + i]);
    return value;
  }
  friend constexpr bool operator==(const ForkStatus&, const ForkStatus&) = default;
};
static_assert(ocm::protocol::TopicType<ForkStatus>);

/// Heartbeat: says all by coming. Sensor of Lift, requests on 0xC0. [decided]
struct Heartbeat {
  static constexpr std::string_view name = "heartbeat";
  static constexpr ocm::protocol::TopicId id{0xC0};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0xC0}, 0, {49, 49, 49, 51}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{500, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period{};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{20};
  static constexpr ocm::base::Duration jitter = std::chrono::microseconds{200};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept { return {}; }
  [[nodiscard]] static constexpr Heartbeat decode(const ocm::can::Payload&) noexcept { return {}; }
  [[nodiscard]] static constexpr Heartbeat decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Heartbeat&, const Heartbeat&) = default;
};
static_assert(ocm::protocol::TopicType<Heartbeat>);

/// Wheels: velocity set point. Actuator of Chassis, set points on 0x10. [decided]
struct Wheels {
  static constexpr std::string_view name = "wheels";
  static constexpr ocm::protocol::TopicId id{0x10};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x10}, 4, {91, 90, 90, 90}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout = std::chrono::milliseconds{200};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::drive;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{20};
  static constexpr ocm::base::Duration jitter = std::chrono::microseconds{200};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::urgent;

  std::int16_t x = 0;  ///< 0.001 m/s a bit, [-2, 2] m/s
  std::int16_t z = 0;  ///< 0.001 rad/s a bit, [-6.5, 6.5] rad/s

  using XBits = ocm::protocol::Bits<std::int16_t, 7, 16, ocm::protocol::ByteOrder::big>;
  using ZBits = ocm::protocol::Bits<std::int16_t, 23, 16, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr double x_m_per_s() const noexcept { return x / 1'000.0; }
  constexpr void set_x_m_per_s(double value) noexcept {
    x = ocm::protocol::nearest_raw<std::int16_t>(value * 1'000.0, -2'000, 2'000);
  }
  [[nodiscard]] constexpr double z_rad_per_s() const noexcept { return z / 1'000.0; }
  constexpr void set_z_rad_per_s(double value) noexcept {
    z = ocm::protocol::nearest_raw<std::int16_t>(value * 1'000.0, -6'500, 6'500);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    XBits::put(data, x);
    ZBits::put(data, z);
    return data;
  }
  [[nodiscard]] static constexpr Wheels decode(const ocm::can::Payload& data) noexcept {
    Wheels value;
    value.x = XBits::get(data);
    value.z = ZBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Wheels decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Wheels&, const Wheels&) = default;
};
static_assert(ocm::protocol::TopicType<Wheels>);

/// Beacon: warning lights. Actuator of Lift, set points on 0x20 to 0x21. [decided]
struct Beacon {
  static constexpr std::string_view name = "beacon";
  static constexpr ocm::protocol::TopicId id{0x20};
  static constexpr std::uint8_t instances = 2;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x20}, 2, {72, 71, 71, 70}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout{};
  static constexpr ocm::protocol::Role role = ocm::protocol::Role::light;
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{20};
  static constexpr ocm::base::Duration jitter = std::chrono::microseconds{200};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  std::uint8_t red = 0;    ///< [0, 15]
  std::uint8_t green = 0;  ///< [0, 15]
  std::uint8_t blue = 0;   ///< [0, 15]

  using RedBits = ocm::protocol::Bits<std::uint8_t, 7, 4, ocm::protocol::ByteOrder::big>;
  using GreenBits = ocm::protocol::Bits<std::uint8_t, 3, 4, ocm::protocol::ByteOrder::big>;
  using BlueBits = ocm::protocol::Bits<std::uint8_t, 15, 4, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    RedBits::put(data, red);
    GreenBits::put(data, green);
    BlueBits::put(data, blue);
    return data;
  }
  [[nodiscard]] static constexpr Beacon decode(const ocm::can::Payload& data) noexcept {
    Beacon value;
    value.red = RedBits::get(data);
    value.green = GreenBits::get(data);
    value.blue = BlueBits::get(data);
    return value;
  }
  [[nodiscard]] static constexpr Beacon decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Beacon&, const Beacon&) = default;
};
static_assert(ocm::protocol::TopicType<Beacon>);

/// Winch: height to go to, in nanometres. Actuator of Lift, set points on 0x30. [decided]
struct Winch {
  static constexpr std::string_view name = "winch";
  static constexpr ocm::protocol::TopicId id{0x30};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x30}, 8, {132, 131, 131, 130}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout{};
  static constexpr ocm::base::Duration deadline = std::chrono::milliseconds{20};
  static constexpr ocm::base::Duration jitter = std::chrono::microseconds{200};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::high;

  std::int64_t value = 0;  ///< 0.000000001 m a bit, [0, 1.8] m

  using ValueBits = ocm::protocol::Bits<std::int64_t, 0>;

  [[nodiscard]] constexpr double value_m() const noexcept {
    return static_cast<double>(value) / 1'000'000'000.0;
  }
  constexpr void set_value_m(double value_) noexcept {
    value = ocm::protocol::nearest_raw<std::int64_t>(value_ * 1'000'000'000.0, 0, 1'800'000'000);
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    ValueBits::put(data, value);
    return data;
  }
  [[nodiscard]] static constexpr Winch decode(const ocm::can::Payload& data) noexcept {
    Winch value_;
    value_.value = ValueBits::get(data);
    return value_;
  }
  [[nodiscard]] static constexpr Winch decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Winch&, const Winch&) = default;
};
static_assert(ocm::protocol::TopicType<Winch>);

// clang-format off
namespace detail {
namespace protocol = ocm::protocol;

// Fields: name, {start, width, order}, signed, scale, offset, unit, lowest and highest raw number,
// names of values or flags, whether flags. Scale and offset: {digits, power of ten}.
// Frames: name, id, DLC, fields, most bits by priority, fields with what is derived of them.
// Laws of what is derived: at one, offset, noise, least and greatest value at which they hold.
// Topics: index of the board, aliases, frames, source, and of several of a kind: number and name.

namespace range {
inline constexpr std::array<std::string_view, 1> aliases{"lidar"};
inline constexpr std::array<protocol::Field, 2> fields{{
  {"left", {7, 12, protocol::ByteOrder::big}, false, {1, -3}, {}, "m", 0, 4'095, {}, false},
  {"right", {11, 12, protocol::ByteOrder::big}, false, {1, -3}, {}, "m", 0, 4'095, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0xA0}, 3, fields, {81, 81, 81, 81}},
}};
inline constexpr std::string_view source =
  "decided";
}  // namespace range

namespace fork_status_state {
inline constexpr std::array<protocol::NamedValue, 4> mode_names{{{0, "parked"}, {1, "moving"}, {2, "holding"},
                                                                 {7, "jammed"}}};
inline constexpr std::array<protocol::NamedValue, 3> flags_names{{{0, "loaded"}, {1, "top"}, {4, "bottom"}}};
inline constexpr std::array<protocol::NamedValue, 1> height_names{{{-1, "unknown"}}};
inline constexpr std::array<protocol::Field, 4> fields{{
  {"mode", {7, 3, protocol::ByteOrder::big}, false, {1, 0}, {}, "", 0, 7, mode_names, false},
  {"flags", {4, 5, protocol::ByteOrder::big}, false, {1, 0}, {}, "", 0, 31, flags_names, true},
  {"temperature", {15, 8, protocol::ByteOrder::big}, false, {5, -1}, {-4, 1}, "°C", 0, 250, {}, false},
  {"height", {16, 16, protocol::ByteOrder::little}, true, {1, -1}, {}, "mm", 0, 18'000, height_names, false},
}};
}  // namespace fork_status_state
namespace fork_status_cell {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"force", {7, 20, protocol::ByteOrder::big}, true, {-25, -2}, {35, -1}, "N", -524'288, 524'287, {}, false},
}};
}  // namespace fork_status_cell
namespace fork_status {
inline constexpr std::array<std::string_view, 1> aliases{"fork"};
inline constexpr std::array<protocol::FrameLayout, 5> frames{{
  {"state", protocol::TopicId{0xB1}, 4, fork_status_state::fields, {89, 89, 89, 89}},
  {"cell_1", protocol::TopicId{0xB2}, 4, fork_status_cell::fields, {90, 90, 91, 90}},
  {"cell_2", protocol::TopicId{0xB3}, 4, fork_status_cell::fields, {89, 90, 89, 89}},
  {"cell_3", protocol::TopicId{0xB4}, 4, fork_status_cell::fields, {90, 90, 90, 90}},
  {"cell_4", protocol::TopicId{0xB5}, 4, fork_status_cell::fields, {89, 89, 89, 89}},
}};
inline constexpr std::string_view source =
  "decided";
}  // namespace fork_status

namespace heartbeat {
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0xC0}, 0, {}, {49, 49, 49, 51}},
}};
inline constexpr std::string_view source =
  "decided";
}  // namespace heartbeat

namespace wheels {
inline constexpr std::array<protocol::Field, 2> fields{{
  {"x", {7, 16, protocol::ByteOrder::big}, true, {1, -3}, {}, "m/s", -2'000, 2'000, {}, false},
  {"z", {23, 16, protocol::ByteOrder::big}, true, {1, -3}, {}, "rad/s", -6'500, 6'500, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x10}, 4, fields, {91, 90, 90, 90}},
}};
inline constexpr std::string_view source =
  "decided";
}  // namespace wheels

namespace beacon {
inline constexpr std::array<protocol::Field, 3> fields{{
  {"red", {7, 4, protocol::ByteOrder::big}, false, {1, 0}, {}, "", 0, 15, {}, false},
  {"green", {3, 4, protocol::ByteOrder::big}, false, {1, 0}, {}, "", 0, 15, {}, false},
  {"blue", {15, 4, protocol::ByteOrder::big}, false, {1, 0}, {}, "", 0, 15, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 2> frames{{
  {"", protocol::TopicId{0x20}, 2, fields, {72, 71, 71, 70}},
  {"", protocol::TopicId{0x21}, 2, fields, {71, 69, 69, 69}},
}};
inline constexpr std::string_view source =
  "decided";
}  // namespace beacon

namespace winch {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"value", {0, 64, protocol::ByteOrder::little}, true, {1, -9}, {}, "m", 0, 1'800'000'000, {}, false},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x30}, 8, fields, {132, 131, 131, 130}},
}};
inline constexpr std::string_view source =
  "decided";
}  // namespace winch

inline constexpr std::array<protocol::Board, 2> boards{{
  {"chassis", "STM32G0B1"},
  {"lift", "RP2040 with MCP2515"},
}};

inline constexpr std::array<protocol::Topic, 7> topics{{
  protocol::catalogue_entry<Range>(0, range::aliases, range::frames, range::source),
  protocol::catalogue_entry<ForkStatus>(1, fork_status::aliases, fork_status::frames, fork_status::source),
  protocol::catalogue_entry<Heartbeat>(1, {}, heartbeat::frames, heartbeat::source),
  protocol::catalogue_entry<Wheels>(0, {}, wheels::frames, wheels::source),
  protocol::catalogue_entry<Beacon>(1, {}, {&beacon::frames[0], 1}, beacon::source, 1, "beacon_1"),
  protocol::catalogue_entry<Beacon>(1, {}, {&beacon::frames[1], 1}, beacon::source, 2, "beacon_2"),
  protocol::catalogue_entry<Winch>(1, {}, winch::frames, winch::source),
}};
}  // namespace detail
// clang-format on

/// Everything that is said on the bus, as a tool sees it that loads the spec when it runs.
inline constexpr ocm::protocol::Catalogue catalogue{"Ferry", bit_rate, detail::boards, detail::topics};

/// What tells a board that was built from another spec: boards report it in their status.
inline constexpr std::uint32_t wire_hash = ocm::protocol::wire_hash(catalogue);

/// The board chassis: wheels and range finders. [decided]
struct Chassis {
  static constexpr std::string_view name = "chassis";
  static constexpr std::string_view mcu = "STM32G0B1";
  static constexpr std::uint32_t clock_hz = 64'000'000;
  using sensors = ocm::protocol::TopicList<Range>;
  using actuators = ocm::protocol::TopicList<Wheels>;
  using status = void;
  using refusal = void;
  static constexpr std::uint32_t wire_hash = ferry::wire_hash;
};

/// The board lift: the fork. [decided]
struct Lift {
  static constexpr std::string_view name = "lift";
  static constexpr std::string_view mcu = "RP2040 with MCP2515";
  using sensors = ocm::protocol::TopicList<ForkStatus, Heartbeat>;
  using actuators = ocm::protocol::TopicList<Beacon, Winch>;
  using status = void;
  using refusal = void;
  static constexpr std::uint32_t wire_hash = ferry::wire_hash;
};

}  // namespace ferry
