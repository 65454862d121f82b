// Made by ocm-generate from probe.json. Do not edit: change the spec, and generate again.

/// The topics of Probe: A robot whose topics have floating-point numbers, for tests alone.
///
/// Members of a frame are raw numbers, as they travel. name_unit() is the physical value, rounded once where
/// raw number times scale stays below 2^53; set_name_unit() takes the nearest raw number within the field's
/// range, and the one nearest to zero for not a number. encode() puts the nearest number that the width
/// holds. `frames` has of each frame the id, the DLC, and the most bits that it takes on the bus at each
/// priority, whatever its content. No heap, no exceptions; everything is constexpr.
#pragma once

#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/binary64.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/physical.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/protocol/wire_hash.hpp"

namespace probe {

/// Bits per second on the bus. [decided: for tests]
inline constexpr std::uint32_t bit_rate = 250'000;

/// Depth. Sensor of Head, requests on 0x10. [decided: for tests]
struct Depth {
  static constexpr std::string_view name = "depth";
  static constexpr ocm::protocol::TopicId id{0x10};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x10}, 8, {131, 131, 131, 131}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{20, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period{};
  static constexpr ocm::base::Duration deadline{};
  static constexpr ocm::base::Duration jitter{};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  float depth = 0;  ///< Below the surface; in m
  float ratio = 0;

  using DepthBits = ocm::protocol::Bits<std::uint32_t, 0>;
  using RatioBits = ocm::protocol::Bits<std::uint32_t, 39, 32, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr double depth_m() const noexcept { return depth; }
  constexpr void set_depth_m(double value) noexcept { depth = static_cast<float>(value); }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    DepthBits::put(data, std::bit_cast<std::uint32_t>(depth));
    RatioBits::put(data, std::bit_cast<std::uint32_t>(ratio));
    return data;
  }
  [[nodiscard]] static constexpr Depth decode(const ocm::can::Payload& data) noexcept {
    Depth value;
    value.depth = std::bit_cast<float>(DepthBits::get(data));
    value.ratio = std::bit_cast<float>(RatioBits::get(data));
    return value;
  }
  [[nodiscard]] static constexpr Depth decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Depth&, const Depth&) = default;
};
static_assert(ocm::protocol::TopicType<Depth>);

/// Position, north.
struct PositionNorth {
  static constexpr ocm::protocol::TopicId id{0x20};
  static constexpr std::uint8_t dlc = 8;

  double value = 0;  ///< [-90, 90] deg

  using ValueBits = ocm::protocol::Bits<std::uint64_t, 0>;

  [[nodiscard]] constexpr double value_deg() const noexcept { return static_cast<double>(value); }
  constexpr void set_value_deg(double value_) noexcept { value = ocm::protocol::within(value_, -90.0, 90.0); }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    ValueBits::put(data, ocm::base::to_binary64(value));
    return data;
  }
  [[nodiscard]] static constexpr PositionNorth decode(const ocm::can::Payload& data) noexcept {
    PositionNorth value_;
    value_.value = ocm::base::from_binary64(ValueBits::get(data));
    return value_;
  }
  friend constexpr bool operator==(const PositionNorth&, const PositionNorth&) = default;
};

/// Position, east.
struct PositionEast {
  static constexpr ocm::protocol::TopicId id{0x21};
  static constexpr std::uint8_t dlc = 8;

  double value = 0;  ///< 0.5 deg a unit, from -10 deg on

  using ValueBits = ocm::protocol::Bits<std::uint64_t, 7, 64, ocm::protocol::ByteOrder::big>;

  [[nodiscard]] constexpr double value_deg() const noexcept {
    return (static_cast<double>(value) * 5.0 - 100.0) / 10.0;
  }
  constexpr void set_value_deg(double value_) noexcept { value = (value_ * 10.0 + 100.0) / 5.0; }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    ValueBits::put(data, ocm::base::to_binary64(value));
    return data;
  }
  [[nodiscard]] static constexpr PositionEast decode(const ocm::can::Payload& data) noexcept {
    PositionEast value_;
    value_.value = ocm::base::from_binary64(ValueBits::get(data));
    return value_;
  }
  friend constexpr bool operator==(const PositionEast&, const PositionEast&) = default;
};

/// Position, one cell.
struct PositionCell {
  static constexpr ocm::protocol::TopicId id{0x22};  ///< of the first of 2
  static constexpr std::uint8_t dlc = 8;

  enum class Valid : std::uint8_t {
    no = 0,
    yes = 1,
  };

  Valid valid{};
  float voltage = 0;        ///< 0.001 mV a unit
  std::int32_t number = 0;  ///< [-8388608, 8388607]

  using ValidBits = ocm::protocol::Bits<std::uint8_t, 0, 1>;
  using VoltageBits = ocm::protocol::Bits<std::uint32_t, 3>;
  using NumberBits = ocm::protocol::Bits<std::int32_t, 40, 24>;

  [[nodiscard]] constexpr double voltage_mV() const noexcept { return voltage / 1'000.0; }
  constexpr void set_voltage_mV(double value) noexcept { voltage = static_cast<float>(value * 1'000.0); }

  [[nodiscard]] constexpr ocm::can::Payload encode() const noexcept {
    ocm::can::Payload data{};
    ValidBits::put(data, static_cast<std::uint8_t>(valid));
    VoltageBits::put(data, std::bit_cast<std::uint32_t>(voltage));
    NumberBits::put(data, number);
    return data;
  }
  [[nodiscard]] static constexpr PositionCell decode(const ocm::can::Payload& data) noexcept {
    PositionCell value;
    value.valid = static_cast<Valid>(ValidBits::get(data));
    value.voltage = std::bit_cast<float>(VoltageBits::get(data));
    value.number = NumberBits::get(data);
    return value;
  }
  friend constexpr bool operator==(const PositionCell&, const PositionCell&) = default;
};

/// Position. Sensor of Head, requests on 0x20. [decided: for tests]
struct Position {
  static constexpr std::string_view name = "position";
  static constexpr ocm::protocol::TopicId id{0x20};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 4> frames{{
      {ocm::protocol::TopicId{0x20}, 8, {131, 130, 131, 131}},
      {ocm::protocol::TopicId{0x21}, 8, {130, 130, 130, 129}},
      {ocm::protocol::TopicId{0x22}, 8, {130, 130, 130, 130}},
      {ocm::protocol::TopicId{0x23}, 8, {130, 130, 130, 130}},
  }};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::sensor;
  static constexpr ocm::protocol::Period period{1000, ocm::protocol::PeriodUnit::milliseconds};
  static constexpr ocm::base::Duration shortest_period{};
  static constexpr ocm::base::Duration deadline{};
  static constexpr ocm::base::Duration jitter{};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  PositionNorth north;
  PositionEast east;
  std::array<PositionCell, 2> cell{};

  /// In the order in which they are sent; no data where there is no such frame.
  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t frame) const noexcept {
    if (frame == 0) return north.encode();
    if (frame == 1) return east.encode();
    if (frame >= 2 && frame < 4) return cell[frame - 2].encode();
    return {};
  }
  [[nodiscard]] static constexpr Position decode(const std::array<ocm::can::Payload, 4>& all) noexcept {
    Position value;
    value.north = PositionNorth::decode(all[0]);
    value.east = PositionEast::decode(all[1]);
    for (std::size_t i = 0; i < value.cell.size(); ++i) value.cell[i] = PositionCell::decode(all[2 + i]);
    return value;
  }
  friend constexpr bool operator==(const Position&, const Position&) = default;
};
static_assert(ocm::protocol::TopicType<Position>);

/// Thrust. Actuator of Head, set points on 0x30. [decided: for tests]
struct Thrust {
  static constexpr std::string_view name = "thrust";
  static constexpr ocm::protocol::TopicId id{0x30};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<ocm::protocol::FrameHead, 1> frames{
      {{ocm::protocol::TopicId{0x30}, 8, {132, 131, 131, 130}}}};
  static constexpr ocm::protocol::Kind kind = ocm::protocol::Kind::actuator;
  static constexpr ocm::base::Duration timeout = std::chrono::milliseconds{200};
  static constexpr ocm::base::Duration deadline{};
  static constexpr ocm::base::Duration jitter{};
  static constexpr ocm::protocol::Priority priority = ocm::protocol::Priority::medium;

  float force = 0;  ///< [-2.5, 40] N [range decided: for tests]
  float gain = 0;

  using ForceBits = ocm::protocol::Bits<std::uint32_t, 0>;
  using GainBits = ocm::protocol::Bits<std::uint32_t, 32>;

  [[nodiscard]] constexpr double force_N() const noexcept { return force; }
  constexpr void set_force_N(double value) noexcept {
    force = static_cast<float>(ocm::protocol::within(value, -2.5, 40.0));
  }

  [[nodiscard]] constexpr ocm::can::Payload encode(std::size_t /*frame*/ = 0) const noexcept {
    ocm::can::Payload data{};
    ForceBits::put(data, std::bit_cast<std::uint32_t>(force));
    GainBits::put(data, std::bit_cast<std::uint32_t>(gain));
    return data;
  }
  [[nodiscard]] static constexpr Thrust decode(const ocm::can::Payload& data) noexcept {
    Thrust value;
    value.force = std::bit_cast<float>(ForceBits::get(data));
    value.gain = std::bit_cast<float>(GainBits::get(data));
    return value;
  }
  [[nodiscard]] static constexpr Thrust decode(const std::array<ocm::can::Payload, 1>& all) noexcept {
    return decode(all[0]);
  }
  friend constexpr bool operator==(const Thrust&, const Thrust&) = default;
};
static_assert(ocm::protocol::TopicType<Thrust>);

// clang-format off
namespace detail {
namespace protocol = ocm::protocol;

// Fields: name, {start, width, order}, signed, scale, offset, unit, lowest and highest raw number,
// names of values or flags, whether flags. Scale and offset: {digits, power of ten}.
// Frames: name, id, DLC, fields, most bits by priority, fields with what is derived of them.
// Laws of what is derived: at one, offset, noise, least and greatest value at which they hold.
// Topics: index of the board, aliases, frames, source, and of several of a kind: number and name.

namespace depth {
inline constexpr std::array<protocol::Field, 2> fields{{
  {"depth", {0, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "m", 0, 4'294'967'295, {}, false, protocol::Number::float32},
  {"ratio", {39, 32, protocol::ByteOrder::big}, false, {1, 0}, {}, "", 0, 4'294'967'295, {}, false, protocol::Number::float32},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x10}, 8, fields, {131, 131, 131, 131}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace depth

namespace position_north {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"value", {0, 64, protocol::ByteOrder::little}, false, {1, 0}, {}, "deg", 0, 9'223'372'036'854'775'807, {}, false, protocol::Number::float64, protocol::no_selector, {}, 0, {-9, 1}, {9, 1}},
}};
}  // namespace position_north
namespace position_east {
inline constexpr std::array<protocol::Field, 1> fields{{
  {"value", {7, 64, protocol::ByteOrder::big}, false, {5, -1}, {-1, 1}, "deg", 0, 9'223'372'036'854'775'807, {}, false, protocol::Number::float64},
}};
}  // namespace position_east
namespace position_cell {
inline constexpr std::array<protocol::NamedValue, 2> valid_names{{{0, "no"}, {1, "yes"}}};
inline constexpr std::array<protocol::Field, 3> fields{{
  {"valid", {0, 1, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 1, valid_names, false},
  {"voltage", {3, 32, protocol::ByteOrder::little}, false, {1, -3}, {}, "mV", 0, 4'294'967'295, {}, false, protocol::Number::float32},
  {"number", {40, 24, protocol::ByteOrder::little}, true, {1, 0}, {}, "", -8'388'608, 8'388'607, {}, false},
}};
}  // namespace position_cell
namespace position {
inline constexpr std::array<protocol::FrameLayout, 4> frames{{
  {"north", protocol::TopicId{0x20}, 8, position_north::fields, {131, 130, 131, 131}},
  {"east", protocol::TopicId{0x21}, 8, position_east::fields, {130, 130, 130, 129}},
  {"cell_1", protocol::TopicId{0x22}, 8, position_cell::fields, {130, 130, 130, 130}},
  {"cell_2", protocol::TopicId{0x23}, 8, position_cell::fields, {130, 130, 130, 130}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace position

namespace thrust {
inline constexpr std::array<std::string_view, 1> aliases{"thr"};
inline constexpr std::array<protocol::Field, 2> fields{{
  {"force", {0, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "N", 0, 4'294'967'295, {}, false, protocol::Number::float32, protocol::no_selector, {}, 0, {-25, -1}, {4, 1}},
  {"gain", {32, 32, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 4'294'967'295, {}, false, protocol::Number::float32},
}};
inline constexpr std::array<protocol::FrameLayout, 1> frames{{
  {"", protocol::TopicId{0x30}, 8, fields, {132, 131, 131, 130}},
}};
inline constexpr std::string_view source =
  "decided: for tests";
}  // namespace thrust

inline constexpr std::array<protocol::Board, 1> boards{{
  {"head", "STM32F103"},
}};

inline constexpr std::array<protocol::Topic, 3> topics{{
  protocol::catalogue_entry<Depth>(0, {}, depth::frames, depth::source),
  protocol::catalogue_entry<Position>(0, {}, position::frames, position::source),
  protocol::catalogue_entry<Thrust>(0, thrust::aliases, thrust::frames, thrust::source),
}};
}  // namespace detail
// clang-format on

/// Everything that is said on the bus, as a tool sees it that loads the spec when it runs.
inline constexpr ocm::protocol::Catalogue catalogue{"Probe", bit_rate, detail::boards, detail::topics};

/// What tells a board that was built from another spec: boards report it in their status.
inline constexpr std::uint32_t wire_hash = ocm::protocol::wire_hash(catalogue);

/// The board head. [decided: for tests]
struct Head {
  static constexpr std::string_view name = "head";
  static constexpr std::string_view mcu = "STM32F103";
  using sensors = ocm::protocol::TopicList<Depth, Position>;
  using actuators = ocm::protocol::TopicList<Thrust>;
  using status = void;
  using refusal = void;
  static constexpr std::uint32_t wire_hash = probe::wire_hash;
};

}  // namespace probe
