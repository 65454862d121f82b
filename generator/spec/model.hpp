/// A robot, or another bus, as its spec tells it, checked and complete: what the generator writes from, and
/// what the catalogue is made of.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/decimal.hpp"
#include "ocm/base/text.hpp"
#include "ocm/base/time.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::spec {

/// Where the facts of an object of the spec come from.
struct Source {
  std::string general;                                          ///< of all that `particular` does not name
  std::vector<std::pair<std::string, std::string>> particular;  ///< fact, source

  [[nodiscard]] const std::string& of(std::string_view fact) const noexcept {
    for (const auto& [name, text] : particular)
      if (name == fact) return text;
    return general;
  }
  /// On one line: "Thesis table 4.1; scale: data sheet; id decided: none given".
  [[nodiscard]] std::string joined() const {
    std::string line = general;
    for (const auto& [name, text] : particular) {
      if (!line.empty()) line += "; ";
      line.append(name).append(text.rfind("decided", 0) == 0 ? " " : ": ").append(text);
    }
    return line;
  }
};

/// Behind the bit-rate switch of CAN FD, bit/s: what the attribute BaudrateCANFD can be. Controllers reach 8
/// M.
inline constexpr std::uint32_t max_data_bit_rate = 16'000'000;

/// What a DBC file says of an object by a name of its own; kept as it is written.
struct AttributeModel {
  std::string name;
  std::string text;
  friend bool operator==(const AttributeModel&, const AttributeModel&) = default;
};

/// What a DBC file says of an attribute itself: BA_DEF_ with its BA_DEF_DEF_. Of those that become members
/// here, such as GenMsgCycleTime, there is none.
struct AttributeDefinitionModel {
  enum class Of : std::uint8_t { bus, board, message, field };
  enum class Type : std::uint8_t { integer, hexadecimal, floating, string, enumeration };
  Of of = Of::bus;
  std::string name;
  Type type = Type::string;
  std::string min;  ///< as written; empty: none
  std::string max;
  std::vector<std::string> values;          ///< of an enumeration, by number
  std::optional<std::string> default_text;  ///< an enumeration's is one of its values
  friend bool operator==(const AttributeDefinitionModel&, const AttributeDefinitionModel&) = default;
};

/// What a source has and a model does not.
struct NotKept {
  std::string what;  ///< "SIG_GROUP_"
  std::size_t count = 0;
};

/// A range that a source states, physical, in its own words.
struct RangeModel {
  base::Decimal min;
  base::Decimal max;
  friend bool operator==(const RangeModel&, const RangeModel&) = default;
};

struct ValueModel {
  std::string name;
  std::int64_t raw = 0;  ///< of a flag: the number of its bit
};

struct FieldModel {
  std::string name;
  std::string description;
  protocol::Position position;
  bool is_signed = false;
  base::Decimal scale{1, 0};
  base::Decimal offset{};
  std::string unit;       ///< as a person writes it: "deg/s"
  std::string unit_name;  ///< as an identifier: "deg_per_s"; empty for counts
  std::int64_t raw_min = 0;
  std::int64_t raw_max = 0;
  bool has_range = false;  ///< the spec gives one; otherwise raw_min and raw_max are what the width holds
  std::vector<ValueModel> values;
  bool flags = false;
  Source source;  ///< empty: as the frame's

  // Of a message's field only.
  protocol::Number number = protocol::Number::integer;
  std::string selector;                           ///< the field that selects this one; empty: none
  std::vector<protocol::SelectorRange> selected;  ///< the selector's raw bits with which it is there
  std::optional<std::int64_t> start;              ///< raw; of a float its bits
  std::optional<RangeModel> range;                ///< as stated; raw_min and raw_max follow from it
  std::vector<std::string> receivers;             ///< names of boards
  std::vector<AttributeModel> attributes;

  /// A raw number as a text: of all 64 bits the upper half is no negative number.
  [[nodiscard]] std::string raw_text(std::int64_t raw) const {
    return position.width == 64 && !is_signed ? std::to_string(static_cast<std::uint64_t>(raw))
                                              : std::to_string(raw);
  }

  /// The raw number of a start value as specs give it: raw, not scaled, of a signed field also as its bits
  /// (255 is -1 of 8); of a float its number. Rounded to a whole number. Nothing where the text is no number,
  /// or one that the field cannot hold.
  [[nodiscard]] std::optional<std::int64_t> start_from(std::string_view text) const noexcept {
    const unsigned width = position.width;
    if (number == protocol::Number::integer)
      if (const auto bits = base::parse_unsigned(text)) return start_of_bits(*bits);
    const auto parsed = base::parse_decimal(text);
    if (!parsed) return std::nullopt;
    const base::Decimal value = *parsed;
    if (number == protocol::Number::float32) {
      const auto real = static_cast<float>(value.as_double());
      return std::isfinite(real) ? std::optional<std::int64_t>{std::bit_cast<std::uint32_t>(real)}
                                 : std::nullopt;
    }
    if (number == protocol::Number::float64) {
      const double real = value.as_double();
      return std::isfinite(real) ? std::optional{std::bit_cast<std::int64_t>(real)} : std::nullopt;
    }
    const auto raw = base::divide_rounded(value, {1, 0});
    if (!raw || *raw < protocol::lowest(width, is_signed)) return std::nullopt;
    return *raw < 0 ? std::optional{*raw} : start_of_bits(static_cast<std::uint64_t>(*raw));
  }

  /// The values are all that the field can be, so that it is an enumeration: they have names and no unit.
  [[nodiscard]] bool is_enumeration() const noexcept { return !values.empty() && !flags && unit.empty(); }

 private:
  [[nodiscard]] std::optional<std::int64_t> start_of_bits(std::uint64_t bits) const noexcept {
    const unsigned above = 64U - position.width;
    if (bits << above >> above != bits) return std::nullopt;
    return is_signed ? static_cast<std::int64_t>(bits << above) >> above : static_cast<std::int64_t>(bits);
  }
};

/// What follows from a field by a law, with its uncertainty; on no wire.
struct DerivedModel {
  std::string name;
  std::string description;
  std::size_t of = 0;  ///< index of the field
  std::string unit;
  std::vector<protocol::Law> laws;  ///< one, or one a frame of a count: their offsets differ
  Source source;                    ///< empty: as the frame's

  [[nodiscard]] std::string uncertainty_name() const { return name + "_uncertainty"; }
  [[nodiscard]] const protocol::Law& law(std::size_t frame) const noexcept {
    return laws[laws.size() == 1 ? 0 : frame];
  }
};

struct FrameModel {
  std::string name;  ///< empty for a topic's only frame
  std::string description;
  std::uint8_t id = 0;     ///< of the first
  std::uint8_t count = 1;  ///< equal frames with consecutive ids
  bool is_array = false;   ///< the spec gives a count: frames are called name_1, name_2, ...
  std::uint8_t dlc = 0;
  std::vector<FieldModel> fields;
  std::vector<DerivedModel> derived;
  Source source;  ///< empty: as the topic's
};

/// Where the sensors of a topic of role ring are on the robot, in the order of the topic's fields. What their
/// counts mean say the derived fields.
struct RingGeometry {
  base::Decimal radius;  ///< m, from the robot's middle
  base::Decimal first;   ///< rad, of the first sensor, counter-clockwise from ahead
  base::Decimal step;    ///< rad, from one to the next
};

struct TopicModel {
  std::string name;
  std::string description;
  std::vector<std::string> aliases;
  std::uint8_t id = 0;
  std::uint8_t count = 1;  ///< equal topics with consecutive ids, such as eight lights
  bool is_group = false;   ///< the spec gives a count: topics are called name_1, name_2, ...
  protocol::Kind kind = protocol::Kind::sensor;
  protocol::Role role = protocol::Role::none;
  std::optional<RingGeometry> geometry;  ///< of a ring
  std::uint8_t board = 0;
  std::vector<FrameModel> frames;
  protocol::Priority priority = protocol::default_priority;
  protocol::Period period = protocol::default_period;
  base::Duration shortest_period{};
  base::Duration deadline{};
  base::Duration jitter{};
  base::Duration timeout{};
  Source source;
  std::string bus;  ///< the only interface that it is on; empty: any
};

/// A frame that is only sent: known by its identifier, not by a topic's number.
struct MessageModel {
  std::string name;
  std::string description;
  std::vector<std::string> aliases;
  protocol::Address address;
  std::uint16_t length = 0;  ///< bytes, 0..64; of J1939, whose transport protocol cuts it, to 1785
  bool fd = false;
  std::uint8_t board = protocol::no_board;  ///< who sends it
  std::vector<std::string> other_senders;
  std::vector<FieldModel> fields;  ///< with receivers
  base::Duration period{};         ///< 0: none is stated
  base::Duration shortest_period{};
  base::Duration deadline{};
  base::Duration jitter{};
  std::string send_type;  ///< as the source calls it, such as "Cyclic"
  std::vector<AttributeModel> attributes;
  Source source;
  std::string bus;  ///< the only interface that it is on; empty: any

  [[nodiscard]] bool is_j1939() const noexcept { return address.by == protocol::Address::By::pgn; }
  /// What a catalogue's layout can hold: CAN FD, or J1939's transport protocol.
  [[nodiscard]] static constexpr unsigned most_bytes(bool j1939) noexcept { return j1939 ? 1785 : 64; }
};

struct BoardModel {
  std::string name;
  std::string description;
  std::string mcu;
  std::optional<std::uint32_t> clock_hz;
  std::optional<std::uint32_t> can_clock_hz;
  Source source;
  std::vector<AttributeModel> attributes;
};

/// An interface that a spec was given for.
struct BusModel {
  std::string name;
  std::uint32_t bit_rate = 0;
  std::uint32_t data_bit_rate = 0;
};

struct Model {
  std::string robot;
  std::string name_space;
  std::string description;
  std::uint32_t bit_rate = 0;
  std::uint32_t data_bit_rate = 0;  ///< of CAN FD frames behind the switch; 0: none is stated
  Source bus_source;
  Source defaults_source;
  std::vector<BoardModel> boards;
  std::vector<TopicModel> topics;
  std::vector<MessageModel> messages;
  std::vector<std::string> too_long;       ///< messages of the source that no frame can carry: left out
  std::vector<AttributeModel> attributes;  ///< of the bus
  std::vector<AttributeDefinitionModel> definitions;
  std::vector<NotKept> not_kept;
  std::vector<BusModel> buses;  ///< those that specs were given for, with their bit rates

  /// From now on all of it is on this interface only.
  void put_on(const std::string& bus) {
    for (TopicModel& topic : topics) topic.bus = bus;
    for (MessageModel& message : messages) message.bus = bus;
    buses = {{bus, bit_rate, data_bit_rate}};
    bit_rate = data_bit_rate = 0;
  }
  /// Where no spec holds for all interfaces, the bit rate that all of them have is that of the bus.
  void share_bit_rate() {
    const auto share = [this](std::uint32_t& of_all, std::uint32_t BusModel::*rate) {
      if (of_all != 0 || buses.empty()) return;
      const std::uint32_t first = buses.front().*rate;
      for (const BusModel& each : buses)
        if (each.*rate != first) return;
      of_all = first;
    };
    share(bit_rate, &BusModel::bit_rate);
    share(data_bit_rate, &BusModel::data_bit_rate);
  }
  /// The bit rates of an interface: its own, or those that hold for all.
  [[nodiscard]] BusModel bus(std::string_view interface) const {
    BusModel out{std::string{interface}, bit_rate, data_bit_rate};
    for (const BusModel& own : buses) {
      if (own.name != interface) continue;
      if (own.bit_rate != 0) out.bit_rate = own.bit_rate;
      if (own.data_bit_rate != 0) out.data_bit_rate = own.data_bit_rate;
    }
    return out;
  }
};

}  // namespace ocm::spec
