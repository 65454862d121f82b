/// What is known about a bus: a robot's topics, which are asked for and commanded, and plain messages, which
/// are only sent; which frames, which fields, which units, whose board. The generator writes these as
/// constexpr data; a tool loads the same types from a spec at run time. Views only: the catalogue's maker
/// owns the text.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

#include "ocm/base/binary64.hpp"
#include "ocm/base/decimal.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/length.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/law.hpp"
#include "ocm/protocol/request.hpp"

namespace ocm::protocol {

/// A name for a value, or for a bit when the field is a set of flags.
struct NamedValue {
  std::int64_t raw = 0;  ///< the value; for flags the number of the bit
  std::string_view name;
  friend constexpr bool operator==(const NamedValue&, const NamedValue&) = default;
};

/// What a field's bits are.
enum class Number : std::uint8_t {
  integer,
  float32,  ///< IEEE 754, 32 bits wide
  float64,  ///< IEEE 754, 64 bits wide
};

/// Raw bits of a selector, both ends included.
struct SelectorRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  friend constexpr bool operator==(const SelectorRange&, const SelectorRange&) = default;
};

/// What a field is whose presence no other field decides.
inline constexpr std::uint16_t no_selector = 0xFFFF;

/// One number in a frame. physical = raw * scale + offset, in `unit`. The raw number of a float is its bits.
struct Field {
  std::string_view name;
  Position position{};
  bool is_signed = false;
  base::Decimal scale{1, 0};
  base::Decimal offset{};
  std::string_view unit;     ///< as a person writes it: "deg/s"; empty for counts
  std::int64_t raw_min = 0;  ///< the range that the source gives, in raw units
  std::int64_t raw_max = 0;
  std::span<const NamedValue> values;  ///< names of values, or of flags
  bool flags = false;                  ///< `values` names bits, several of which may be set
  Number number = Number::integer;
  /// Which field of the frame says whether this one is there: its index; no_selector: it always is.
  std::uint16_t selector = no_selector;
  std::span<const SelectorRange> selected{};  ///< the raw bits of the selector with which it is there
  std::int64_t start = 0;                     ///< raw; what is sent where nothing else is said
  /// The range that the source states, physical, in its own words: advice, which senders leave. Both 0: none,
  /// or no other than raw_min and raw_max.
  base::Decimal min{};
  base::Decimal max{};
  /// Of a derived field, which is on no wire: by which law its value follows from another field of the frame,
  /// `derived_from`, whose place, scale and offset are here, too. nullptr: this one is on the wire.
  const Law* law = nullptr;
  std::uint16_t derived_from = 0;
  bool uncertainty = false;  ///< not the law's value, but one standard deviation of it

  [[nodiscard]] constexpr bool is_derived() const noexcept { return law != nullptr; }
  [[nodiscard]] constexpr bool is_float() const noexcept { return number != Number::integer; }
  [[nodiscard]] constexpr std::int64_t raw(const can::Payload& data) const noexcept {
    return get(data, position, is_signed);
  }
  /// The frame must hold the field: see FrameLayout::has.
  [[nodiscard]] constexpr std::int64_t raw(std::span<const std::uint8_t> data) const noexcept {
    return get(data, position, is_signed);
  }
  /// A float's value before scale and offset.
  [[nodiscard]] constexpr double unscaled(std::int64_t raw_value) const noexcept {
    return number == Number::float32 ? double{std::bit_cast<float>(static_cast<std::uint32_t>(raw_value))}
                                     : base::from_binary64(static_cast<std::uint64_t>(raw_value));
  }
  /// As a double, of any kind of number, or derived of it.
  [[nodiscard]] constexpr double value(std::int64_t raw_value) const noexcept {
    if (law == nullptr) return measured(raw_value);
    return uncertainty ? law->uncertainty(measured(raw_value)) : law->value(measured(raw_value));
  }
  /// What is on the wire, in its unit: the value, or that from which it is derived.
  [[nodiscard]] constexpr double measured(std::int64_t raw_value) const noexcept {
    const bool unsigned_64 = !is_signed && position.width == 64;
    const double plain = is_float()    ? unscaled(raw_value)
                         : unsigned_64 ? static_cast<double>(static_cast<std::uint64_t>(raw_value))
                                       : static_cast<double>(raw_value);
    if (scale == base::Decimal{1, 0} && offset.digits == 0) return plain;
    return plain * scale.as_double() + offset.as_double();
  }
  /// Exact; out_of_range for scales that no sensor has, and for nine in ten of the unsigned words of 64 bits
  /// from 2^63 on, which have more digits than a Decimal. A derived value has four significant digits, its
  /// uncertainty two; out_of_range where the law says nothing.
  [[nodiscard]] constexpr base::Result<base::Decimal> physical(std::int64_t raw_value) const noexcept {
    if (law != nullptr) {
      if (!law->holds(measured(raw_value))) return base::Error::out_of_range;
      return rounded(value(raw_value), uncertainty ? 2 : 4);
    }
    base::Decimal plain{raw_value, 0};
    if (raw_value < 0 && !is_signed && position.width == 64) {  // the highest bit is no sign
      const auto word = static_cast<std::uint64_t>(raw_value);
      if (word % 10 != 0) return base::Error::out_of_range;
      plain = {static_cast<std::int64_t>(word / 10), 1};
    }
    const auto scaled = base::multiply(plain, scale);
    if (!scaled) return scaled.error;
    return base::add(*scaled, offset);
  }
  /// The bits of the float nearest to a physical value; out_of_range where it is too large for 32 bits.
  [[nodiscard]] constexpr base::Result<std::int64_t> float_from(double physical_value) const noexcept {
    const bool plain = scale == base::Decimal{1, 0} && offset.digits == 0;
    const double value = plain ? physical_value : (physical_value - offset.as_double()) / scale.as_double();
    if (number == Number::float64) return static_cast<std::int64_t>(base::to_binary64(value));
    constexpr double greatest = std::numeric_limits<float>::max();
    const bool finite = value - value == 0;  // neither infinite nor NaN
    if (finite && (value > greatest || value < -greatest)) return base::Error::out_of_range;
    return std::int64_t{std::bit_cast<std::uint32_t>(static_cast<float>(value))};
  }
  /// An integer field's raw number nearest to a physical value; out_of_range beyond the field's range, and
  /// for a derived field, which is on no wire.
  [[nodiscard]] constexpr base::Result<std::int64_t> raw_from(base::Decimal physical_value) const noexcept {
    if (law != nullptr) return base::Error::out_of_range;
    const auto above_offset = base::subtract(physical_value, offset);
    if (!above_offset) return above_offset.error;
    const auto raw_value = base::divide_rounded(*above_offset, scale);
    if (!raw_value) return raw_value.error;
    if (*raw_value < raw_min || *raw_value > raw_max) return base::Error::out_of_range;
    return *raw_value;
  }
};

/// The field that a law derives of `field`, the `index`-th of its frame, or that one's uncertainty.
[[nodiscard]] constexpr Field derived(const Field& field, std::uint16_t index, std::string_view name,
                                      std::string_view unit, const Law& law, bool uncertainty) noexcept {
  Field out = field;
  out.name = name;
  out.unit = unit;
  out.values = {};
  out.flags = false;
  out.min = law.min;
  out.max = law.max;
  if (uncertainty) {
    out.min = {};
    out.max = rounded(law.uncertainty(law.offset.as_double() +
                                      law.at_one.as_double() / law.max.as_double() / law.max.as_double()),
                      2);
  }
  out.law = &law;
  out.derived_from = index;
  out.uncertainty = uncertainty;
  return out;
}

/// The most bits that a frame can take with any content, intermission included, by the priority at which it
/// is sent: the priority is in the identifier, and with it changes where stuff bits fall. 0: not known.
using BitsByPriority = std::array<std::uint8_t, priority_levels>;

/// By what a frame is known on the bus.
struct Address {
  enum class By : std::uint8_t {
    topic,       ///< the number of a topic in an 11-bit identifier, at any priority
    identifier,  ///< all of its 11 or 29 bits
    pgn,         ///< J1939's parameter group; source, destination and priority are any
  };
  By by = By::topic;
  bool extended = false;     ///< 29 bits
  std::uint32_t number = 0;  ///< the identifier with which it is sent; a topic's is FrameLayout::id
  friend constexpr bool operator==(const Address&, const Address&) = default;
};

/// One frame of a topic, or a message's only one.
struct FrameLayout {
  std::string_view name;  ///< within the topic: "velocity", "x", "sensor_1"; empty for a topic's only frame
  TopicId id{};
  std::uint16_t length = 0;  ///< bytes; 0..8, with CAN FD to 64, by the transport protocol of J1939 to 1785
  std::span<const Field> fields;
  BitsByPriority worst_bits{};
  std::span<const Field>
      with_derived{};  ///< `fields`, and behind them what is derived of them; empty: nothing is
  Address address{};
  bool fd = false;              ///< sent as CAN FD
  bool bit_rate_switch = true;  ///< of CAN FD: its data go at a bit rate of their own

  /// What a frame says: its fields, and behind them what is derived of them.
  [[nodiscard]] constexpr std::span<const Field> values() const noexcept {
    return with_derived.empty() ? fields : with_derived;
  }
  /// The length code as a classic frame.
  [[nodiscard]] constexpr std::uint8_t dlc() const noexcept {
    return static_cast<std::uint8_t>(length < can::max_dlc ? length : can::max_dlc);
  }
  /// Whether a frame of so many bytes can be this one. A topic's length is exact; of a message, whose bytes
  /// beyond the last field mean nothing, a frame may be longer.
  [[nodiscard]] constexpr bool accepts(std::size_t bytes) const noexcept {
    return address.by == Address::By::topic ? bytes == length : bytes >= length || any_length();
  }
  /// A parameter group of more than eight bytes: what of it fits into one frame is sent in one. [SAE
  /// J1939-21, 5.10; trouble codes (DM1) are such a list]
  [[nodiscard]] constexpr bool any_length() const noexcept {
    return address.by == Address::By::pgn && length > can::max_dlc;
  }
  /// Whether field `index` says which other fields are there. O(fields).
  [[nodiscard]] constexpr bool selects(std::size_t index) const noexcept {
    for (const Field& field : fields)
      if (field.selector == index) return true;
    return false;
  }
  /// Whether a frame of this layout may be without `field`.
  [[nodiscard]] constexpr bool may_lack(const Field& field) const noexcept {
    return field.is_derived() || field.selector != no_selector || field.position.bytes() > length ||
           any_length();
  }
  /// Whether `field`, one of `values`, is in a frame: the frame is long enough, and it is chosen.
  [[nodiscard]] constexpr bool has(const Field& field, std::span<const std::uint8_t> data) const noexcept {
    return field.position.bytes() <= data.size() && chooses(field, data);
  }
  /// Whether selectors, which may be selected by others themselves, say that `field` is in a frame; of a
  /// derived one, whether its law holds. The frame must be long enough for it. O(selectors above the field).
  [[nodiscard]] constexpr bool chooses(const Field& field,
                                       std::span<const std::uint8_t> data) const noexcept {
    if (field.is_derived() && !field.law->holds(field.measured(field.raw(data)))) return false;
    const Field* at = &field;
    for (std::size_t depth = 0; depth <= fields.size(); ++depth) {
      if (at->selector == no_selector) return true;
      if (at->selector >= fields.size()) return false;
      const Field& selector = fields[at->selector];
      if (selector.position.bytes() > data.size()) return false;
      const auto bits = static_cast<std::uint64_t>(get(data, selector.position, false));
      bool selected = false;
      for (const SelectorRange& range : at->selected)
        selected = selected || (range.first <= bits && bits <= range.last);
      if (!selected) return false;
      at = &selector;
    }
    return false;  // fields that select one another in a circle
  }
  /// Whether of two fields of `values` for which a frame is long enough, it chooses both or neither.
  [[nodiscard]] static constexpr bool choose_together(const Field& one, const Field& other) noexcept {
    const bool same_law =
        one.law == other.law && (one.law == nullptr || one.derived_from == other.derived_from);
    if (!same_law || one.selector != other.selector || one.selected.size() != other.selected.size())
      return false;
    for (std::size_t i = 0; i < one.selected.size(); ++i)
      if (!(one.selected[i] == other.selected[i])) return false;
    return true;
  }
};

/// A sensor is asked for samples, an actuator takes set points; a message is sent, and that is all that is
/// known of it.
enum class Kind : std::uint8_t { sensor, actuator, message };

[[nodiscard]] constexpr std::string_view name(Kind kind) noexcept {
  constexpr std::string_view names[] = {"sensor", "actuator", "message"};
  return names[static_cast<std::uint8_t>(kind)];
}

/// What a topic is for, so that a tool that does not know the robot can use it: `drive` takes velocities,
/// `light` a colour; `status` tells how its board is, `refusal` which request the board refused, and why;
/// `pose` says where the robot is, `ring` what is around it, `floor` how bright the ground is.
enum class Role : std::uint8_t { none, drive, light, status, refusal, pose, ring, floor };

[[nodiscard]] constexpr std::string_view name(Role role) noexcept {
  constexpr std::string_view names[] = {"none",    "drive", "light", "status",
                                        "refusal", "pose",  "ring",  "floor"};
  return names[static_cast<std::uint8_t>(role)];
}

/// Of a message of which no sender is known.
inline constexpr std::uint8_t no_board = 0xFF;

struct Topic {
  std::string_view name;
  std::span<const std::string_view> aliases;
  TopicId id{};  ///< requests (sensor) or set points (actuator) carry it
  Kind kind = Kind::sensor;
  Role role = Role::none;
  std::uint8_t board = 0;  ///< index into Catalogue::boards: who has it, or sends it; or no_board
  std::span<const FrameLayout> frames;  ///< in the order in which they are sent
  Priority priority = default_priority;
  Period period = default_period;    ///< sensors: sent so often when a request names no period
  base::Duration shortest_period{};  ///< sensors: how often the part delivers something new; messages: the
                                     ///< shortest distance of two, where one is stated
  base::Duration deadline{};         ///< from release to the end of the last frame; 0: none given
  base::Duration jitter{};           ///< of the release
  base::Duration timeout{};   ///< actuators: set point goes to zero when none came for so long; 0: never
  std::string_view group;     ///< "led" for led_1..led_8; empty otherwise
  std::uint8_t instance = 0;  ///< 1..8 within the group
  std::string_view source;    ///< where the facts come from
  base::Duration cycle{};     ///< messages: sent so often; 0: no period is stated
  std::string_view bus{};     ///< the only interface that it is on; empty: any

  [[nodiscard]] constexpr bool is_message() const noexcept { return kind == Kind::message; }
  [[nodiscard]] constexpr bool is_on(std::string_view interface) const noexcept {
    return bus.empty() || bus == interface;
  }
  /// How often it is sent unless asked otherwise; 0 for what has no period.
  [[nodiscard]] constexpr base::Duration usual_period() const noexcept {
    return kind == Kind::sensor ? period.duration() : cycle;
  }
};

struct Board {
  std::string_view name;
  std::string_view mcu;
};

/// A frame's place in the catalogue.
struct FrameRef {
  const Topic* topic = nullptr;
  std::uint8_t frame = 0;  ///< index into topic->frames
  [[nodiscard]] constexpr const FrameLayout& layout() const noexcept { return topic->frames[frame]; }
  constexpr explicit operator bool() const noexcept { return topic != nullptr; }
};

struct Catalogue {
  std::string_view robot;
  std::uint32_t bit_rate = 0;
  std::span<const Board> boards;
  std::span<const Topic> topics;

  /// By name or alias; nullptr when there is none. O(topics).
  [[nodiscard]] constexpr const Topic* find(std::string_view name_or_alias) const noexcept {
    if (name_or_alias.empty()) return nullptr;  // unused aliases are empty
    for (const Topic& topic : topics) {
      if (topic.name == name_or_alias) return &topic;
      for (const auto alias : topic.aliases)
        if (alias == name_or_alias) return &topic;
    }
    return nullptr;
  }
  /// Whether some topics are on one interface only. O(topics).
  [[nodiscard]] constexpr bool has_buses() const noexcept {
    for (const Topic& topic : topics)
      if (!topic.bus.empty()) return true;
    return false;
  }
  /// Who has a topic or sends a message; empty where that is not known.
  [[nodiscard]] constexpr std::string_view board_name(const Topic& topic) const noexcept {
    return topic.board < boards.size() ? boards[topic.board].name : std::string_view{};
  }
  /// Whose request or set point has this number.
  [[nodiscard]] constexpr const Topic* find(TopicId id) const noexcept {
    for (const Topic& topic : topics)
      if (topic.id == id && !topic.is_message()) return &topic;
    return nullptr;
  }
};

/// The identifier with which a frame of a topic is sent at a priority; a message has one of its own.
[[nodiscard]] constexpr std::uint32_t identifier_of(FrameRef frame, Priority priority) noexcept {
  const FrameLayout& layout = frame.layout();
  if (layout.address.by != Address::By::topic) return layout.address.number;
  const auto direction = frame.topic->kind == Kind::sensor ? Direction::sensor : Direction::command;
  return Identifier{direction, priority, layout.id}.encode();
}
[[nodiscard]] constexpr can::Format format_of(const FrameLayout& layout) noexcept {
  return layout.address.extended ? can::Format::extended : can::Format::base;
}

/// What a board needs of a topic's type; what the generator writes satisfies it.
template <class T>
concept TopicType = requires(const T& topic, std::size_t frame,
                             const std::array<can::Payload, T::frames.size()>& all) {
  { T::id } -> std::convertible_to<TopicId>;
  {
    T::instances
    } -> std::convertible_to<std::uint8_t>;  // 1, or how many of a kind follow each other: eight LEDs
  { T::frames[frame].id } -> std::convertible_to<TopicId>;
  { T::frames[frame].dlc } -> std::convertible_to<std::uint8_t>;
  { topic.encode(frame) } -> std::same_as<can::Payload>;
  { T::decode(all) } -> std::same_as<T>;
};

/// What a generated topic says of each of its frames.
struct FrameHead {
  TopicId id{};
  std::uint8_t dlc = 0;
  BitsByPriority worst_bits{};  ///< of several instances of a topic: the greatest
};

/// The most bits that a frame takes at a priority, intermission included: what the spec's generator found, or
/// the closed bound where none was computed.
template <class Frame>
requires std::same_as<Frame, FrameHead> || std::same_as<Frame, FrameLayout>
[[nodiscard]] constexpr unsigned worst_bits(const Frame& frame, Priority priority) noexcept {
  const unsigned exact = frame.worst_bits[static_cast<std::size_t>(priority)];
  if (exact != 0) return exact;
  if constexpr (std::same_as<Frame, FrameHead>)
    return can::worst_frame_bits(can::Format::base, frame.dlc);
  else
    return can::worst_frame_bits(format_of(frame), frame.length);
}

/// The types of a board's sensors or actuators.
template <class... Topics>
struct TopicList {
  static constexpr std::size_t size = sizeof...(Topics);
  template <class T>
  static constexpr bool contains = (std::is_same_v<T, Topics> || ...);
  /// The number of T in the list; `size` when it is not there.
  template <class T>
  static constexpr std::size_t index = [] {
    std::size_t i = 0;
    static_cast<void>(((std::is_same_v<T, Topics> || (++i, false)) || ...));
    return i;
  }();
};

/// A generated topic as an entry of its catalogue. `instance` is 1..T::instances for one of several of a
/// kind, whose `entry_name` is then led_1 and whose group is T's name; 0 otherwise.
template <TopicType T>
[[nodiscard]] constexpr Topic catalogue_entry(std::uint8_t board, std::span<const std::string_view> aliases,
                                              std::span<const FrameLayout> frames, std::string_view source,
                                              std::uint8_t instance = 0,
                                              std::string_view entry_name = T::name) noexcept {
  Topic topic;
  topic.name = entry_name;
  topic.aliases = aliases;
  topic.id = TopicId{static_cast<std::uint8_t>(T::id.value + (instance == 0 ? 0 : instance - 1))};
  topic.kind = T::kind;
  topic.board = board;
  topic.frames = frames;
  topic.priority = T::priority;
  topic.deadline = T::deadline;
  topic.jitter = T::jitter;
  topic.source = source;
  if constexpr (T::kind == Kind::sensor) {
    topic.period = T::period;
    topic.shortest_period = T::shortest_period;
  } else {
    topic.timeout = T::timeout;
  }
  if constexpr (requires { T::role; }) topic.role = T::role;
  if (instance != 0) topic.group = T::name;
  topic.instance = instance;
  return topic;
}

}  // namespace ocm::protocol
