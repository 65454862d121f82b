/// Two topics as a generator could have written them, for the tests of this floor, which knows no robot: a
/// sensor of two frames and an actuator of which there are three.
#pragma once

#include <array>
#include <chrono>
#include <string_view>

#include "ocm/protocol/topic.hpp"

namespace ocm::test {

struct Scale {
  static constexpr std::string_view name = "scale";
  static constexpr protocol::TopicId id{0x10};
  static constexpr std::uint8_t instances = 1;
  static constexpr std::array<protocol::FrameHead, 2> frames{
      {{protocol::TopicId{0x10}, 4}, {protocol::TopicId{0x21}, 1}}};
  static constexpr protocol::Kind kind = protocol::Kind::sensor;
  static constexpr protocol::Period period{1, protocol::PeriodUnit::seconds};
  static constexpr base::Duration shortest_period = std::chrono::milliseconds{10};
  static constexpr base::Duration deadline = std::chrono::milliseconds{20};
  static constexpr base::Duration jitter = std::chrono::milliseconds{1};
  static constexpr protocol::Priority priority = protocol::Priority::high;

  std::int32_t weight = 0;
  std::uint8_t state = 0;

  using WeightBits = protocol::Bits<std::int32_t, 7, 32, protocol::ByteOrder::big>;
  using StateBits = protocol::Bits<std::uint8_t, 0>;

  [[nodiscard]] constexpr can::Payload encode(std::size_t frame) const noexcept {
    can::Payload data{};
    if (frame == 0) WeightBits::put(data, weight);
    if (frame == 1) StateBits::put(data, state);
    return data;
  }
  [[nodiscard]] static constexpr Scale decode(const std::array<can::Payload, 2>& all) noexcept {
    return {WeightBits::get(all[0]), StateBits::get(all[1])};
  }
  friend constexpr bool operator==(const Scale&, const Scale&) = default;
};

struct Lamp {
  static constexpr std::string_view name = "lamp";
  static constexpr protocol::TopicId id{0x30};
  static constexpr std::uint8_t instances = 3;
  static constexpr std::array<protocol::FrameHead, 1> frames{{{protocol::TopicId{0x30}, 1}}};
  static constexpr protocol::Kind kind = protocol::Kind::actuator;
  static constexpr protocol::Role role = protocol::Role::light;
  static constexpr base::Duration timeout = std::chrono::seconds{1};
  static constexpr base::Duration deadline{};
  static constexpr base::Duration jitter{};
  static constexpr protocol::Priority priority = protocol::Priority::low;

  std::uint8_t level = 0;

  using LevelBits = protocol::Bits<std::uint8_t, 0>;

  [[nodiscard]] constexpr can::Payload encode(std::size_t = 0) const noexcept {
    can::Payload data{};
    LevelBits::put(data, level);
    return data;
  }
  [[nodiscard]] static constexpr Lamp decode(const std::array<can::Payload, 1>& all) noexcept {
    return {LevelBits::get(all[0])};
  }
  friend constexpr bool operator==(const Lamp&, const Lamp&) = default;
};

static_assert(protocol::TopicType<Scale>);
static_assert(protocol::TopicType<Lamp>);

inline constexpr std::array<protocol::NamedValue, 2> state_names{{{0, "stable"}, {7, "overload"}}};
/// Grams in steps of a quarter, above a tare of 100 g.
inline constexpr std::array<protocol::Field, 1> weight_fields{
    {{"weight", {7, 32, protocol::ByteOrder::big}, true, {25, -2}, {1, 2}, "g", -400, 4000, {}, false}}};
inline constexpr std::array<protocol::Field, 1> state_fields{
    {{"state", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, state_names, true}}};
inline constexpr std::array<protocol::Field, 1> lamp_fields{
    {{"level", {0, 8, protocol::ByteOrder::little}, false, {1, 0}, {}, "", 0, 200, {}, false}}};
inline constexpr std::array<protocol::FrameLayout, 2> scale_frames{
    {{"weight", protocol::TopicId{0x10}, 4, weight_fields},
     {"state", protocol::TopicId{0x21}, 1, state_fields}}};
inline constexpr std::array<protocol::FrameLayout, 3> lamp_frames{
    {{"", protocol::TopicId{0x30}, 1, lamp_fields},
     {"", protocol::TopicId{0x31}, 1, lamp_fields},
     {"", protocol::TopicId{0x32}, 1, lamp_fields}}};
inline constexpr std::array<std::string_view, 2> scale_aliases{"weight", "w"};
inline constexpr std::array<protocol::Board, 2> boards{{{"left", "MCU"}, {"right", "MCU"}}};
inline constexpr std::array<protocol::Topic, 4> topics{{
    protocol::catalogue_entry<Scale>(1, scale_aliases, scale_frames, "a data sheet"),
    protocol::catalogue_entry<Lamp>(0, {}, {&lamp_frames[0], 1}, "", 1, "lamp_1"),
    protocol::catalogue_entry<Lamp>(0, {}, {&lamp_frames[1], 1}, "", 2, "lamp_2"),
    protocol::catalogue_entry<Lamp>(0, {}, {&lamp_frames[2], 1}, "", 3, "lamp_3"),
}};
inline constexpr protocol::Catalogue catalogue{"example", 250'000, boards, topics};

}  // namespace ocm::test
