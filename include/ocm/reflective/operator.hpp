/// The tables of a Reflective Operator: in which configurations a robot can be, what is watched in them, and
/// what leads from one to another. Data only, views over the caller's memory, so that all of it can be
/// constexpr; check.hpp says what is wrong with it, proof.hpp how late it can be, supervisor.hpp runs it.
///
///     constexpr Stream driving_streams[] = {{topic_index(amiro::catalogue, "ring"), 50ms}};
///     constexpr Configuration configurations[] = {{.name = "driving", .streams = driving_streams}, ...};
///     constexpr Operator guard{.catalogue = &amiro::catalogue, .configurations = configurations, ...};
///     static_assert(first_mistake(guard).kind == Mistake::no_mistake);
///
/// Topics are indices into Catalogue::topics. Values of fields are `ordered` (below): raw numbers whose order
/// is that of the values, for floats too, so that no floating point is used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "ocm/analysis/message_set.hpp"
#include "ocm/base/time.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::reflective {

/// An index that is none.
inline constexpr std::uint16_t none = 0xFFFF;

/// A topic that a configuration asks for; a plain message is not asked for, and `period` is how often it
/// comes.
struct Stream {
  std::uint16_t topic = none;
  base::Duration period{};
  protocol::Priority priority = protocol::default_priority;
  friend constexpr bool operator==(const Stream&, const Stream&) = default;
};

/// Within what a field of an actuator may be commanded.
struct Limit {
  std::uint16_t topic = none;
  std::uint16_t field = 0;  ///< of the actuator's only frame
  std::int64_t min = 0;     ///< raw
  std::int64_t max = 0;
  std::int64_t per_second = 0;  ///< it may change by so much in a second, raw; 0: at once
};

/// What is commanded when a configuration is entered, and again every `repeat`.
struct SetPoint {
  std::uint16_t topic = none;
  std::span<const std::int64_t> raw{};  ///< fields that it does not give are zero
  protocol::Priority priority = protocol::Priority::urgent;
  base::Duration repeat{};  ///< 0: once
};

/// The period of a stream follows a value: `at_from` up to the value `from`, `at_to` from the value `to` on,
/// in between in proportion, in whole `grain`s.
struct Adaptation {
  std::uint16_t stream = none;  ///< of the configuration
  std::uint16_t topic = none;   ///< whose value it follows
  std::uint16_t frame = 0;
  std::uint16_t field = 0;
  bool magnitude = false;  ///< of the value without its sign: driving backwards is driving
  std::int64_t from = 0;   ///< ordered, less than `to`
  std::int64_t to = 0;
  base::Duration at_from{};
  base::Duration at_to{};
  base::Duration grain{1'000'000};
  base::Duration every{1'000'000'000};  ///< not asked for again sooner
  [[nodiscard]] constexpr base::Duration shortest() const noexcept {
    return at_from < at_to ? at_from : at_to;
  }
  [[nodiscard]] constexpr base::Duration longest() const noexcept {
    return at_from < at_to ? at_to : at_from;
  }
};

struct Configuration {
  std::string_view name{};
  std::span<const Stream> streams{};  ///< a topic once
  std::span<const Limit> limits{};
  std::span<const SetPoint> entry{};  ///< in this order: what must act first comes first
  std::span<const Adaptation> adaptations{};
  /// What else is on the bus in it, besides Operator::others: what programs may command here, for instance.
  std::span<const analysis::Message> others{};
};

enum class Watched : std::uint8_t {
  field,      ///< a value of the last sample
  age,        ///< ns since the last sample, or since the topic was asked for
  gap,        ///< as age, and stays until two samples have come in time
  rate,       ///< samples in a window
  refusals,   ///< requests and set points that were refused since the configuration was entered
  bus_load,   ///< per mille, of a window of the caller's
  bus_state,  ///< BusState
};
[[nodiscard]] constexpr std::string_view name(Watched watched) noexcept {
  constexpr std::string_view names[] = {"field", "age", "gap", "rate", "refusals", "bus_load", "bus_state"};
  return names[static_cast<std::size_t>(watched)];
}

enum class BusState : std::uint8_t { active, warning, passive, off, down };

/// When a condition holds.
enum class Is : std::uint8_t {
  above,    ///< more than the limit; an age or a gap: as much, or more
  below,    ///< less than the limit
  equal,    ///< the limit
  other,    ///< anything but the limit
  any_bit,  ///< one of the limit's bits is set
};

struct Condition {
  std::string_view name{};
  Watched watched = Watched::field;
  Is is = Is::above;
  std::uint16_t topic = none;  ///< field, age, gap, rate
  std::uint16_t frame = 0;     ///< field
  std::uint16_t field = 0;
  /// field: ordered (above, below) or raw; age, gap: ns; rate: samples in a window; else see Watched.
  std::int64_t limit = 0;
  std::int64_t hysteresis = 0;  ///< above, below of values: it ends only so far on the other side
  base::Duration window{};      ///< rate, bus_load
};

/// A step of an expression in postfix notation.
enum class Op : std::uint8_t { condition, all, any, negation };
struct Term {
  Op op = Op::condition;
  std::uint16_t condition = 0;
  friend constexpr bool operator==(const Term&, const Term&) = default;
};

/// An expression over conditions that has held for `lasting`. What is not known yet is neither true nor
/// false, and fires nothing.
struct Monitor {
  std::string_view name{};
  std::span<const Term> terms{};
  base::Duration lasting{};
};

/// From any configuration but where it leads to.
inline constexpr std::uint16_t any_configuration = none;
/// On request, not by a monitor.
inline constexpr std::uint16_t by_request = none;

struct Transition {
  std::string_view cause{};
  std::uint16_t from = any_configuration;
  std::uint16_t to = none;
  std::uint16_t monitor = by_request;
  std::uint8_t precedence = 0;  ///< of two that fire at once the lower goes first
};

struct Operator {
  std::string_view name{};
  const protocol::Catalogue* catalogue = nullptr;
  std::span<const Configuration> configurations{};
  std::span<const Condition> conditions{};
  std::span<const Monitor> monitors{};
  std::span<const Transition> transitions{};
  std::uint16_t initial = 0;
  std::uint16_t fall_back = 0;
  /// A change of configuration is over after so long, and the next one may begin. proof.hpp says the least.
  base::Duration settle{};
  /// A stream that is silent is asked for again no sooner; 0: never.
  base::Duration retry{};
  /// Longest time from a frame on the bus, or a timer, until the frames of the step are handed to the bus.
  base::Duration reaction{};
  /// Longest time from a request on the bus until a board has taken it.
  base::Duration handling{};
  /// What else is on the bus: other programs' streams and set points.
  std::span<const analysis::Message> others{};

  [[nodiscard]] constexpr const protocol::Topic& topic(std::uint16_t index) const noexcept {
    return catalogue->topics[index];
  }
  /// Whether a transition can begin in a configuration.
  [[nodiscard]] constexpr bool leaves(const Transition& transition,
                                      std::size_t configuration) const noexcept {
    return transition.to != configuration &&
           (transition.from == any_configuration || transition.from == configuration);
  }
};

/// By name or alias; none if there is no such topic. O(topics).
[[nodiscard]] constexpr std::uint16_t topic_index(const protocol::Catalogue& catalogue,
                                                  std::string_view name) noexcept {
  const protocol::Topic* const topic = catalogue.find(name);
  return topic == nullptr ? none : static_cast<std::uint16_t>(topic - catalogue.topics.data());
}

/// Each topic once that other configurations ask for and this one does not. O(streams of all, squared).
template <class See>
constexpr void for_each_stream_elsewhere(const Operator& tables, std::size_t configuration, See&& see) {
  const auto asks = [&](std::size_t c, std::uint16_t topic) {
    for (const Stream& stream : tables.configurations[c].streams)
      if (stream.topic == topic) return true;
    return false;
  };
  for (std::size_t c = 0; c < tables.configurations.size(); ++c)
    for (const Stream& stream : tables.configurations[c].streams) {
      bool known = asks(configuration, stream.topic);
      for (std::size_t before = 0; before < c && !known; ++before) known = asks(before, stream.topic);
      if (!known) see(stream);
    }
}

/// Whether a raw number is one: all but the NaNs of floats.
[[nodiscard]] constexpr bool is_number(const protocol::Field& field, std::int64_t raw) noexcept {
  if (field.number == protocol::Number::float32)
    return (static_cast<std::uint64_t>(raw) & 0x7FFF'FFFF) <= 0x7F80'0000;
  if (field.number == protocol::Number::float64)
    return (static_cast<std::uint64_t>(raw) & 0x7FFF'FFFF'FFFF'FFFF) <= 0x7FF0'0000'0000'0000;
  return true;
}

/// A raw number as one whose order is that of the values: itself for integers, of a float its bits with the
/// negative ones turned round. (A negative scale turns the order of both.)
[[nodiscard]] constexpr std::int64_t ordered(const protocol::Field& field, std::int64_t raw) noexcept {
  if (field.number == protocol::Number::float32) {
    const auto bits = static_cast<std::int32_t>(static_cast<std::uint32_t>(raw));
    return bits < 0 ? std::int64_t{INT32_MIN} - bits : bits;
  }
  if (field.number == protocol::Number::float64) return raw < 0 ? INT64_MIN - raw : raw;
  const bool unsigned_64 = !field.is_signed && field.position.width == 64;
  return unsigned_64 ? static_cast<std::int64_t>(static_cast<std::uint64_t>(raw) ^ std::uint64_t{1} << 63U)
                     : raw;
}

}  // namespace ocm::reflective
