/// A DBC file as it stands: every message, signal, name, comment and attribute that it holds, and what is
/// doubtful in it. DBC has no public standard; what real files contain decides. Nothing here knows of a
/// robot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/decimal.hpp"
#include "ocm/protocol/codec.hpp"

namespace ocm::dbc {

/// A name of a raw value; negative keys are of signed signals. One name may stand for several values.
struct NamedValue {
  std::int64_t raw = 0;
  std::string name;
  friend bool operator==(const NamedValue&, const NamedValue&) = default;
};

/// An attribute of an object, as `BA_` gives it: the text of a string, else the number as it is written. An
/// ENUM's value is one of its names, whether the file gives name or number.
struct Attribute {
  std::string name;
  std::string text;
  friend bool operator==(const Attribute&, const Attribute&) = default;
};

/// What an attribute may be attached to: the word behind `BA_DEF_`.
enum class Of : std::uint8_t { network, node, message, signal, variable };

/// `BA_DEF_` with its `BA_DEF_DEF_`.
struct AttributeDefinition {
  enum class Type : std::uint8_t { integer, hexadecimal, floating, string, enumeration };
  Of of = Of::network;
  std::string name;
  Type type = Type::string;
  std::string min;  ///< as written; empty: none
  std::string max;
  std::vector<std::string> names;             ///< of an enumeration, by number
  std::optional<std::string> default_text{};  ///< an enumeration's is one of its names
};

/// The bits of a selector, inclusive.
struct SelectorRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  friend bool operator==(const SelectorRange&, const SelectorRange&) = default;
};

struct Signal {
  enum class Number : std::uint8_t { integer, float32, float64 };

  std::string name;  ///< the long one where there is one
  protocol::Position position;
  bool is_signed = false;
  Number number = Number::integer;
  base::Decimal scale{1, 0};
  base::Decimal offset{};
  base::Decimal min{};  ///< physical; advice: values beyond it are sent all the same
  base::Decimal max{};
  bool has_range = false;  ///< [0|0] is none, and so is a range that is upside down
  std::string unit;
  std::vector<std::string> receivers;
  std::vector<NamedValue> values;
  std::string comment;
  std::string start_value;            ///< as written: raw, not scaled; empty: none
  std::vector<Attribute> attributes;  ///< those that have no member here

  bool is_selector = false;
  /// Index in Message::signals of what says whether this one is there; none: it always is.
  std::optional<std::size_t> selector;
  std::vector<SelectorRange> selected;  ///< the raw bits of the selector with which it is there
  std::size_t line = 0;
};

/// How often, and why, a message is sent: `GenMsgSendType` as it is called in the file, times in
/// milliseconds.
struct Message {
  enum class Format : std::uint8_t { base, extended, j1939 };

  std::string name;      ///< the long one where there is one
  std::uint32_t id = 0;  ///< 11 or 29 bits, without flags
  Format format = Format::base;
  bool fd = false;  ///< `VFrameFormat` says so, or it is longer than 8 bytes and no J1939
  std::uint16_t length = 0;
  std::string sender;                      ///< empty: none is named
  std::vector<std::string> other_senders;  ///< BO_TX_BU_
  std::vector<Signal> signals;
  std::string comment;
  std::optional<base::Decimal> cycle_ms;  ///< GenMsgCycleTime, where it is above 0
  std::optional<base::Decimal> delay_ms;  ///< GenMsgDelayTime, the shortest distance of two
  std::string send_type;
  std::vector<Attribute> attributes;  ///< those that have no member here
  std::size_t line = 0;

  [[nodiscard]] const Signal* find(std::string_view signal) const noexcept {
    for (const Signal& candidate : signals)
      if (candidate.name == signal) return &candidate;
    return nullptr;
  }
};

struct Node {
  std::string name;  ///< the long one where there is one
  std::string comment;
  std::vector<Attribute> attributes;
};

/// `VAL_TABLE_`: values that several signals may share.
struct ValueTable {
  std::string name;
  std::vector<NamedValue> values;
};

/// A statement that is well formed and means nothing for frames, such as EV_ or SIG_GROUP_.
struct Unused {
  std::string keyword;
  std::size_t line = 0;
};

struct Document {
  std::string version;
  std::vector<Node> nodes;
  std::vector<Message> messages;
  std::vector<Signal> independent;  ///< of VECTOR__INDEPENDENT_SIG_MSG, which is never sent
  std::vector<ValueTable> tables;
  std::vector<AttributeDefinition> definitions;
  std::vector<Attribute> attributes;  ///< of the network
  std::string comment;
  std::vector<Unused> unused;
  std::vector<std::string> imports;  ///< files that `CM_ "IMPORT ..."` wants in front of this one
};

}  // namespace ocm::dbc
