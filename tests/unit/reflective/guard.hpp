/// A small operator for the AMiRo, by which the tests of this floor try what the headers do: it stops before
/// an obstacle, when the ring falls silent and when the bus is bad.
#pragma once

#include <array>
#include <chrono>
#include <span>

#include "ocm/protocol/codec.hpp"
#include "ocm/reflective/operator.hpp"
#include "ocm/topics/amiro.hpp"

namespace ocm::test::guard {

using namespace std::chrono_literals;
using namespace ocm::reflective;

inline constexpr std::uint16_t ring = topic_index(amiro::catalogue, "ring");
inline constexpr std::uint16_t odometry = topic_index(amiro::catalogue, "odometry");
inline constexpr std::uint16_t power = topic_index(amiro::catalogue, "power");
inline constexpr std::uint16_t motors = topic_index(amiro::catalogue, "motors");

enum : std::uint16_t { idle, driving, stopped };
enum : std::uint16_t { near, silent, clear, bad_bus, near_right, clear_right };
/// Of the ring: sensors 4 and 5, which look ahead.
inline constexpr std::uint16_t front_left = 3, front_right = 4;

inline constexpr std::array<Stream, 1> idle_streams{{{power, 1000ms}}};
inline constexpr std::array<Stream, 3> driving_streams{{
    {ring, 50ms, protocol::Priority::high},
    {odometry, 100ms},
    {power, 1000ms},
}};
inline constexpr std::array<Stream, 2> stopped_streams{
    {{ring, 100ms, protocol::Priority::high}, {power, 1000ms}}};
inline constexpr std::array<std::int64_t, 2> rest{0, 0};
inline constexpr std::array<SetPoint, 1> stop{{{motors, rest}}};
inline constexpr std::array<SetPoint, 1> keep_stopped{{{motors, rest, protocol::Priority::urgent, 100ms}}};
inline constexpr std::array<Limit, 1> slow{{{motors, 0, -100'000, 100'000, 200'000}}};
inline constexpr std::array<Configuration, 3> configurations{{
    {"idle", idle_streams, {}, stop, {}},
    {"driving", driving_streams, slow, {}, {}},
    {"stopped", stopped_streams, {}, keep_stopped, {}},
}};

inline constexpr std::array<Condition, 6> conditions{{
    {.name = "near, left", .topic = ring, .frame = front_left, .limit = 3'000, .hysteresis = 150},
    {.name = "silent", .watched = Watched::age, .topic = ring, .limit = 250'000'000},
    {.name = "far, left", .is = Is::below, .topic = ring, .frame = front_left, .limit = 2'800},
    {.name = "bus", .watched = Watched::bus_state, .limit = 1},
    {.name = "near, right", .topic = ring, .frame = front_right, .limit = 3'000, .hysteresis = 150},
    {.name = "far, right", .is = Is::below, .topic = ring, .frame = front_right, .limit = 2'800},
}};
inline constexpr std::array<Term, 5> near_or_silent{{{.condition = near},
                                                     {.condition = near_right},
                                                     {.op = Op::any},
                                                     {.condition = silent},
                                                     {.op = Op::any}}};
inline constexpr std::array<Term, 3> when_clear{
    {{.condition = clear}, {.condition = clear_right}, {.op = Op::all}}};
inline constexpr std::array<Term, 1> when_bad{{{.condition = bad_bus}}};
inline constexpr std::array<Monitor, 3> monitors{{
    {"obstacle", near_or_silent, {}},
    {"clear", when_clear, 300ms},
    {"bus", when_bad, {}},
}};
inline constexpr std::array<Transition, 6> transitions{{
    {"obstacle", driving, stopped, 0},
    {"clear", stopped, driving, 1},
    {"bus", any_configuration, stopped, 2},
    {"asked", idle, driving, by_request},
    {"asked", any_configuration, idle, by_request},
    {"asked", any_configuration, stopped, by_request},
}};

inline constexpr Operator make() {
  Operator op;
  op.name = "guard";
  op.catalogue = &amiro::catalogue;
  op.configurations = configurations;
  op.conditions = conditions;
  op.monitors = monitors;
  op.transitions = transitions;
  op.initial = idle;
  op.fall_back = stopped;
  op.settle = 50ms;
  op.retry = 1000ms;
  op.reaction = 5ms;
  op.handling = 1ms;
  return op;
}
inline constexpr Operator tables = make();

/// A sample of the ring, all sensors at one value.
struct RingSample {
  std::array<std::uint8_t, 64> bytes{};
  constexpr explicit RingSample(std::int64_t value) {
    const auto& topic = amiro::catalogue.topics[ring];
    for (std::size_t f = 0; f < topic.frames.size(); ++f) {
      can::Payload payload{};
      protocol::put(payload, topic.frames[f].fields[0].position, value);
      for (std::size_t i = 0; i < payload.size(); ++i) bytes[f * payload.size() + i] = payload[i];
    }
  }
};

}  // namespace ocm::test::guard
