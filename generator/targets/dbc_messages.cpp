#include "generator/targets/dbc_messages.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "ocm/base/decimal.hpp"
#include "ocm/base/utf8.hpp"

#include "generator/dbc/encoding.hpp"
#include "generator/targets/dbc_names.hpp"
#include "generator/targets/numbers.hpp"
#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

using spec::AttributeModel;
using spec::FieldModel;
using spec::MessageModel;
using spec::Model;

constexpr std::string_view no_node = "Vector__XXX";
constexpr std::string_view formats[] = {"StandardCAN", "ExtendedCAN", "reserved", "J1939PG"};
constexpr std::size_t fd_formats = 14;  ///< StandardCAN_FD, ExtendedCAN_FD

std::string as_milliseconds(base::Duration duration) {
  return print(base::normalised(duration.count(), -6));
}
/// As INT holds it: 32 bits.
bool is_whole(const std::string& number) {
  std::int32_t value = 0;
  const char* const end = number.data() + number.size();
  const auto [last, error] = std::from_chars(number.data(), end, value);
  return error == std::errc{} && last == end;
}
bool is_number(const std::string& text) {
  return base::parse_decimal(text).ok();
}

/// The model's messages, statement by statement.
class MessagesWriter {
 public:
  MessagesWriter(const Model& model, const std::vector<std::string>& nodes, DbcNames& names,
                 std::set<std::string> defined)
      : model_(model), message_names_(names), defined_(std::move(defined)) {
    for (std::size_t i = 0; i < nodes.size(); ++i) nodes_.emplace(model.boards[i].name, nodes[i]);
  }

  DbcParts write() {
    starts_everywhere_ =
        std::all_of(model_.messages.begin(), model_.messages.end(), [](const MessageModel& message) {
          return std::all_of(message.fields.begin(), message.fields.end(),
                             [](const FieldModel& field) { return field.start.has_value(); });
        });
    for (const MessageModel& message : model_.messages) add(message);
    times();
    send_types();
    if (needs_formats()) frame_formats();
    start_values();
    long_names();
    for (const auto& definition : model_.definitions) define(definition);
    const auto network = [this](const auto& take) { take("", model_.attributes); };
    const auto boards = [this](const auto& take) {
      for (const auto& board : model_.boards) take("BU_ " + nodes_.at(board.name) + " ", board.attributes);
    };
    const auto messages = [this](const auto& take) {
      for (std::size_t i = 0; i < ids_.size(); ++i)
        take("BO_ " + ids_[i] + " ", model_.messages[i].attributes);
    };
    const auto signals = [this](const auto& take) {
      for (std::size_t i = 0; i < ids_.size(); ++i)
        for (std::size_t j = 0; j < names_[i].size(); ++j)
          take("SG_ " + ids_[i] + " " + names_[i][j] + " ", model_.messages[i].fields[j].attributes);
    };
    attributes("", network);
    attributes("BU_ ", boards);
    attributes("BO_ ", messages);
    attributes("SG_ ", signals);
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::string node(const std::string& board) const {
    const auto at = nodes_.find(board);
    return at == nodes_.end() ? board : at->second;
  }

  void add(const MessageModel& message) {
    const std::string id =
        std::to_string(message.address.number | (message.address.extended ? 0x8000'0000U : 0U));
    const std::string name = message_names_.unique(message.name);
    if (name != message.name) long_names_.push_back({"BO_ " + id, "SystemMessageLongSymbol", message.name});
    ids_.push_back(id);
    const bool known = message.board < model_.boards.size();
    const std::string sender = known ? node(model_.boards[message.board].name) : std::string{no_node};
    out_.messages += "\nBO_ " + id + " " + name + ": " + std::to_string(message.length) + " " + sender + "\n";
    if (!message.other_senders.empty()) {
      out_.senders += "BO_TX_BU_ " + id + " : " + sender;
      for (const std::string& other : message.other_senders) out_.senders += "," + node(other);
      out_.senders += ";\n";
    }
    if (!message.description.empty())
      out_.comments += "CM_ BO_ " + id + " " + dbc_text(message.description) + ";\n";
    DbcNames signal_names;
    auto& names = names_.emplace_back();
    for (const FieldModel& field : message.fields) signal_names.expect(field.name);
    for (const FieldModel& field : message.fields) {
      names.push_back(signal_names.unique(field.name));
      if (names.back() != field.name)
        long_names_.push_back({"SG_ " + id + " " + names.back(), "SystemSignalLongSymbol", field.name});
    }
    const bool simple = is_simple(message);
    for (std::size_t i = 0; i < message.fields.size(); ++i)
      signal(message, message.fields[i], id, names, names[i], simple);
  }

  [[nodiscard]] static bool is_selector(const MessageModel& message, const std::string& field) {
    return std::any_of(message.fields.begin(), message.fields.end(),
                       [&](const FieldModel& other) { return other.selector == field; });
  }
  /// One selector, one value each: what `M` and `m0` say without SG_MUL_VAL_.
  [[nodiscard]] static bool is_simple(const MessageModel& message) {
    std::set<std::string> selectors;
    for (const FieldModel& field : message.fields) {
      if (field.selector.empty()) continue;
      selectors.insert(field.selector);
      if (field.selected.size() != 1 || field.selected[0].first != field.selected[0].last) return false;
    }
    return selectors.size() <= 1;
  }

  void signal(const MessageModel& message, const FieldModel& field, const std::string& id,
              const std::vector<std::string>& names, const std::string& name, bool simple) {
    std::string mark;
    if (!field.selector.empty() && !field.selected.empty())
      mark = " m" + std::to_string(field.selected[0].first);
    if (is_selector(message, field.name)) mark += mark.empty() ? " M" : "M";
    const protocol::Position at = field.position;
    const base::Decimal zero{};
    out_.messages += " SG_ " + name + mark + " : " + std::to_string(at.start) + "|" +
                     std::to_string(at.width) + "@" + (at.order == protocol::ByteOrder::little ? "1" : "0") +
                     (field.is_signed || field.number != protocol::Number::integer ? "-" : "+") + " (" +
                     print(field.scale) + "," + print(field.offset) + ") [" +
                     print(field.range ? field.range->min : zero) + "|" +
                     print(field.range ? field.range->max : zero) + "] " + dbc_text(field.unit) + " ";
    if (field.receivers.empty()) out_.messages += no_node;
    for (std::size_t i = 0; i < field.receivers.size(); ++i)
      out_.messages += (i == 0 ? "" : ",") + node(field.receivers[i]);
    out_.messages += "\n";
    if (!field.selector.empty() && !simple) selector(message, field, id, names, name);
    if (!field.description.empty())
      out_.comments += "CM_ SG_ " + id + " " + name + " " + dbc_text(field.description) + ";\n";
    if (field.number != protocol::Number::integer)
      out_.numbers += "SIG_VALTYPE_ " + id + " " + name + " : " +
                      (field.number == protocol::Number::float32 ? "1" : "2") + ";\n";
    if (field.values.empty() || field.flags) return;
    out_.values += "VAL_ " + id + " " + name;
    for (const auto& value : field.values)
      out_.values += " " + field.raw_text(value.raw) + " " + dbc_text(value.name);
    out_.values += " ;\n";
  }

  void selector(const MessageModel& message, const FieldModel& field, const std::string& id,
                const std::vector<std::string>& names, const std::string& name) {
    out_.selectors += "SG_MUL_VAL_ " + id + " " + name + " ";
    for (std::size_t i = 0; i < message.fields.size(); ++i)
      if (message.fields[i].name == field.selector) out_.selectors += names[i];
    for (std::size_t i = 0; i < field.selected.size(); ++i)
      out_.selectors += (i == 0 ? " " : ", ") + std::to_string(field.selected[i].first) + "-" +
                        std::to_string(field.selected[i].last);
    out_.selectors += ";\n";
  }

  // --- attributes that mean something ---

  void define(std::string_view of, std::string_view name, const std::string& type, const std::string& value) {
    if (!defined_.insert(std::string{of}.append(name)).second) return;
    out_.definitions.append("BA_DEF_ ")
        .append(of)
        .append("\"")
        .append(name)
        .append("\" ")
        .append(type)
        .append(" ;\n");
    if (!value.empty())
      out_.defaults.append("BA_DEF_DEF_ \"").append(name).append("\" ").append(value).append(";\n");
  }
  /// "BO_ ", and nothing for the bus.
  [[nodiscard]] static std::string_view word_of(spec::AttributeDefinitionModel::Of of) noexcept {
    static constexpr std::string_view words[] = {"", "BU_ ", "BO_ ", "SG_ "};
    return words[static_cast<std::size_t>(of)];
  }
  void define(const spec::AttributeDefinitionModel& definition) {
    using Type = spec::AttributeDefinitionModel::Type;
    static constexpr std::string_view types[] = {"INT", "HEX", "FLOAT", "STRING", "ENUM"};
    std::string type{types[static_cast<std::size_t>(definition.type)]};
    if (!definition.min.empty()) type += " " + definition.min + " " + definition.max;
    std::string names;
    for (const std::string& value : definition.values) names += (names.empty() ? " " : ",") + dbc_text(value);
    std::string usual;
    if (definition.default_text) {
      const bool is_text = definition.type == Type::string || definition.type == Type::enumeration;
      usual = is_text || !is_number(*definition.default_text) ? dbc_text(*definition.default_text)
                                                              : *definition.default_text;
    }
    define(word_of(definition.of), definition.name, type + names, usual);
  }
  /// As the attribute's definition has it: an enumeration's by number, if that cannot be one of its names.
  [[nodiscard]] std::optional<std::string> value_by_definition(std::string_view of,
                                                               const AttributeModel& attribute) const {
    using Type = spec::AttributeDefinitionModel::Type;
    for (const auto& definition : model_.definitions) {
      if (word_of(definition.of) != of || definition.name != attribute.name) continue;
      const auto& values = definition.values;
      const auto at = std::find(values.begin(), values.end(), attribute.text);
      const bool numbers = std::any_of(values.begin(), values.end(), is_number);
      if (at != values.end() && !numbers) return std::to_string(at - values.begin());
      const bool is_text = definition.type == Type::string || definition.type == Type::enumeration;
      return is_text || !is_number(attribute.text) ? dbc_text(attribute.text) : attribute.text;
    }
    return std::nullopt;
  }
  void set(std::string_view name, const std::string& object, const std::string& value) {
    out_.attributes.append("BA_ \"")
        .append(name)
        .append("\" ")
        .append(object)
        .append(" ")
        .append(value)
        .append(";\n");
  }

  void times() {
    const auto each = [this](std::string_view name, base::Duration MessageModel::*time) {
      bool any = false;
      bool whole = true;
      for (const MessageModel& message : model_.messages) {
        any = any || (message.*time).count() != 0;
        whole = whole && (message.*time).count() % 1'000'000 == 0;
      }
      if (!any) return;
      define("BO_ ", name, whole ? "INT 0 2147483647" : "FLOAT 0 2147483647", "0");
      for (std::size_t i = 0; i < ids_.size(); ++i)
        if ((model_.messages[i].*time).count() != 0)
          set(name, "BO_ " + ids_[i], as_milliseconds(model_.messages[i].*time));
    };
    each("GenMsgCycleTime", &MessageModel::period);
    each("GenMsgDelayTime", &MessageModel::shortest_period);
  }

  void send_types() {
    std::vector<std::string> types;
    bool listed = true;  // an enumeration can hold them
    for (const MessageModel& message : model_.messages) {
      const std::string& type = message.send_type;
      listed =
          listed && !type.empty() && type.find_first_of("\",\\") == std::string::npos && !is_number(type);
      if (!type.empty() && std::find(types.begin(), types.end(), type) == types.end()) types.push_back(type);
    }
    if (types.empty()) return;
    if (!listed) {
      define("BO_ ", "GenMsgSendType", "STRING", "\"\"");
    } else {
      std::string names;
      for (const std::string& type : types) names += (names.empty() ? "" : ",") + dbc_text(type);
      define("BO_ ", "GenMsgSendType", "ENUM " + names, dbc_text(types.front()));
    }
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      const std::string& type = model_.messages[i].send_type;
      if (type.empty() || (listed && type == types.front())) continue;
      const auto number = std::find(types.begin(), types.end(), type) - types.begin();
      set("GenMsgSendType", "BO_ " + ids_[i], listed ? std::to_string(number) : dbc_text(type));
    }
  }

  [[nodiscard]] bool needs_formats() const {
    const auto is_protocol = [](const auto& each) { return each.name == "ProtocolType"; };
    const bool by_protocol = std::any_of(model_.attributes.begin(), model_.attributes.end(), is_protocol) ||
                             std::any_of(model_.definitions.begin(), model_.definitions.end(), is_protocol);
    return by_protocol ||
           std::any_of(model_.messages.begin(), model_.messages.end(),
                       [](const MessageModel& message) { return message.fd || message.is_j1939(); });
  }
  void frame_formats() {
    std::string names;
    for (std::size_t i = 0; i < fd_formats; ++i)
      names += "\"" + std::string{i < std::size(formats) ? formats[i] : "reserved"} + "\",";
    define("BO_ ", "VFrameFormat", "ENUM " + names + "\"StandardCAN_FD\",\"ExtendedCAN_FD\"",
           "\"StandardCAN\"");
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      const MessageModel& message = model_.messages[i];
      const std::size_t wide = message.address.extended ? 1 : 0;
      const std::size_t format = message.is_j1939() ? 3 : message.fd ? fd_formats + wide : wide;
      if (format != 0) set("VFrameFormat", "BO_ " + ids_[i], std::to_string(format));
    }
  }

  void start_values() {
    std::vector<std::pair<std::string, std::string>> starts;  // signal, value
    bool whole = true;
    for (std::size_t i = 0; i < ids_.size(); ++i)
      for (std::size_t j = 0; j < names_[i].size(); ++j) {
        const FieldModel& field = model_.messages[i].fields[j];
        if (!field.start || (starts_everywhere_ && *field.start == 0)) continue;
        starts.emplace_back("SG_ " + ids_[i] + " " + names_[i][j], start_text(field));
        whole = whole && is_whole(starts.back().second);
      }
    if (starts.empty() && !(starts_everywhere_ && !names_.empty())) return;
    define("SG_ ", "GenSigStartValue", whole ? "INT -2147483648 2147483647" : "FLOAT -1e19 1e19",
           starts_everywhere_ ? "0" : "");
    for (const auto& [signal, value] : starts) set("GenSigStartValue", signal, value);
  }

  void long_names() {
    for (const char* of : {"BU_ ", "BO_ ", "SG_ "}) {
      bool any = false;
      for (const auto& [object, attribute, name] : long_names_)
        if (object.starts_with(of)) {
          if (!any) define(of, attribute, "STRING", "\"\"");
          any = true;
          set(attribute, object, dbc_text(name));
        }
    }
  }

  // --- all others ---

  template <class Each>
  void attributes(std::string_view of, const Each& each) {
    struct Type {
      bool whole = true;
      bool number = true;
    };
    std::vector<std::pair<std::string, Type>> types;  // in the order in which they come
    const auto type_of = [&](const std::string& name) -> Type& {
      for (auto& [known, type] : types)
        if (known == name) return type;
      return types.emplace_back(name, Type{}).second;
    };
    each([&](const std::string&, const std::vector<AttributeModel>& list) {
      for (const AttributeModel& attribute : list) {
        Type& type = type_of(attribute.name);
        type.whole = type.whole && is_whole(attribute.text);
        type.number = type.number && is_number(attribute.text);
      }
    });
    for (const auto& [name, type] : types)
      define(of, name,
             type.whole    ? "INT -2147483648 2147483647"
             : type.number ? "FLOAT -1e19 1e19"
                           : "STRING",
             !type.number          ? "\"\""
             : name == "CANFD_BRS" ? "1"  // what does not say otherwise switches its rate
                                   : "0");
    each([&](const std::string& object, const std::vector<AttributeModel>& list) {
      for (const AttributeModel& attribute : list)
        out_.attributes +=
            "BA_ \"" + attribute.name + "\" " + object +
            value_by_definition(of, attribute)
                .value_or(type_of(attribute.name).number ? attribute.text : dbc_text(attribute.text)) +
            ";\n";
    });
  }

  struct LongName {
    std::string object;
    std::string attribute;
    std::string name;
  };

  const Model& model_;
  std::map<std::string, std::string> nodes_;
  DbcNames& message_names_;
  std::set<std::string> defined_;
  std::vector<std::string> ids_;                 ///< of the messages, as written
  std::vector<std::vector<std::string>> names_;  ///< short names of their signals
  std::vector<LongName> long_names_;
  bool starts_everywhere_ = false;
  DbcParts out_;
};

}  // namespace

std::string dbc_text(std::string_view text) {
  std::string out = quoted(text);
  if (text.ends_with('\\')) out.insert(out.size() - 1, " ");
  return out;
}

DbcParts dbc_messages(const Model& model, const std::vector<std::string>& nodes, DbcNames& names,
                      std::set<std::string> defined) {
  return MessagesWriter{model, nodes, names, std::move(defined)}.write();
}

std::vector<std::string> lost_in_dbc(const Model& model) {
  std::vector<std::string> lost;
  const auto count = [&](std::string_view what, auto has) {
    std::size_t number = 0;
    std::string_view first;
    for (const MessageModel& message : model.messages)
      if (has(message)) {
        if (number++ == 0) first = message.name;
      }
    if (number != 0)
      lost.push_back(std::string{what} + " of " + std::string{first} +
                     (number == 1 ? "" : " and " + std::to_string(number - 1) + " more"));
  };
  const auto any_field = [](auto has) {
    return [has](const MessageModel& message) {
      return std::any_of(message.fields.begin(), message.fields.end(), has);
    };
  };
  count("other names", [](const MessageModel& message) { return !message.aliases.empty(); });
  count("deadlines", [](const MessageModel& message) { return message.deadline.count() != 0; });
  count("jitter", [](const MessageModel& message) { return message.jitter.count() != 0; });
  count("names of flags", any_field([](const FieldModel& field) { return field.flags; }));
  count("the end of texts at a backslash, which gets a blank behind it,", [](const MessageModel& message) {
    return message.description.ends_with('\\') ||
           std::any_of(message.fields.begin(), message.fields.end(), [](const FieldModel& field) {
             return field.description.ends_with('\\') || field.unit.ends_with('\\');
           });
  });
  count("a range of [0, 0]", any_field([](const FieldModel& field) {
          return field.range && field.range->min.digits == 0 && field.range->max.digits == 0;
        }));
  return lost;
}

std::string dbc_bytes(std::string_view utf8) {
  return dbc::to_cp1252(utf8).value_or(std::string{utf8});
}

}  // namespace ocm::generate
