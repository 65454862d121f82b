/// Reading a spec's plain messages: what is sent on the bus by an identifier of its own. Their names are
/// those of the bus's maker, as DBC files have them. For reader.cpp only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/j1939/identifier.hpp"

#include "generator/spec/node_reader.hpp"

namespace ocm::spec {

class MessageReader : private NodeReader {
 public:
  MessageReader(std::string_view file_name, std::vector<Problem>& problems, std::vector<Problem>& doubts)
      : NodeReader(file_name, problems), doubts_(doubts) {}

  /// Into `model`, the boards of which are known. `taken`: names and aliases of topics, and where.
  void read(const At& at, protocol::ByteOrder order, std::map<std::string, std::string> taken, Model& model) {
    names_ = std::move(taken);
    for (const BoardModel& board : model.boards) boards_.push_back(board.name);
    if (!is_kind(at, Kind::array, "a list of messages")) return;
    if (at.node->items.empty()) tell(at, "the list is empty", "at least one message");
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At message_at = at.item(i);
      if (is_object(message_at, R"(a message: {"name": "Engine", "id": "0x100", "fields": [...]})"))
        model.messages.push_back(message(message_at, order));
    }
  }

  /// A name as DBC files have it; empty if it is none.
  [[nodiscard]] std::string word(const At& at) {
    if (!is_kind(at, Kind::string, word_form)) return {};
    if (is_word(at.node->text)) return at.node->text;
    tell(at, quoted(at.node->text) + " is not a name", std::string{word_form});
    return {};
  }

  /// "attributes" of any object.
  [[nodiscard]] std::vector<AttributeModel> attributes(const At& object) {
    std::vector<AttributeModel> out;
    const auto at = object.member("attributes");
    if (!at || !is_object(*at, R"(names and texts: {"GenMsgILSupport": "Yes"})")) return out;
    for (const auto& [key, node] : at->node->members)
      out.push_back({key, text({&node, at->path + "/" + pointer_step(key)})});
    return out;
  }

  [[nodiscard]] std::vector<AttributeDefinitionModel> attribute_definitions(const At& at) {
    std::vector<AttributeDefinitionModel> out;
    if (!is_kind(at, Kind::array, "a list of definitions")) return out;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (is_object(
              item,
              R"({"of": "message", "name": "GenMsgILSupport", "type": "enum", "values": ["No", "Yes"]})"))
        out.push_back(attribute_definition(item));
    }
    return out;
  }

 private:
  [[nodiscard]] AttributeDefinitionModel attribute_definition(const At& at) {
    using Of = AttributeDefinitionModel::Of;
    using Type = AttributeDefinitionModel::Type;
    static constexpr std::pair<std::string_view, Of> objects[] = {
        {"bus", Of::bus}, {"board", Of::board}, {"message", Of::message}, {"field", Of::field}};
    static constexpr std::pair<std::string_view, Type> types[] = {{"int", Type::integer},
                                                                  {"hex", Type::hexadecimal},
                                                                  {"float", Type::floating},
                                                                  {"string", Type::string},
                                                                  {"enum", Type::enumeration}};
    check_keys(at, {"of", "name", "type", "min", "max", "values", "default"});
    AttributeDefinitionModel out;
    if (const auto a = require(at, "of", R"(what has it: "message")"))
      out.of = one_of(*a, objects).value_or(out.of);
    if (const auto a = require(at, "name", "what the attribute is called")) out.name = text(*a);
    if (const auto a = require(at, "type", R"("int", "hex", "float", "string" or "enum")"))
      out.type = one_of(*a, types).value_or(out.type);
    if (const auto a = at.member("min")) out.min = text(*a);
    if (const auto a = at.member("max")) out.max = text(*a);
    if (const auto a = at.member("default")) out.default_text = text(*a);
    const auto values = at.member("values");
    if (values && is_kind(*values, Kind::array, R"(a list of texts: ["No", "Yes"])"))
      for (std::size_t i = 0; i < values->node->items.size(); ++i)
        out.values.push_back(text(values->item(i)));
    const bool is_enumeration = out.type == Type::enumeration;
    if (is_enumeration != values.has_value())
      tell(values.value_or(at),
           is_enumeration ? "an enumeration without \"values\"" : "\"values\" of another type",
           R"("type": "enum", "values": ["No", "Yes"])");
    const bool is_number = !is_enumeration && out.type != Type::string;
    if (out.min.empty() != out.max.empty()) tell(at, "one bound of two", R"("min" and "max", or neither)");
    for (const char* bound : {"min", "max"})
      if (const auto a = at.member(bound); a && !(is_number && base::parse_decimal(a->node->text)))
        tell(*a, shown(*a->node) + " is no bound of this type", R"(of a number, as text: "65535")");
    return out;
  }

  enum class Format : std::uint8_t { base, extended, j1939 };
  static constexpr std::string_view word_form = "a name without blanks and punctuation, such as \"Engine_1\"";

  void doubt(const At& at, std::string what, std::string remedy) {
    doubts_.push_back({place(at), std::move(what), std::move(remedy)});
  }

  // --- single values ---

  /// Any text, also of several lines.
  [[nodiscard]] std::string text(const At& at) {
    return is_kind(at, Kind::string, "a text in double quotes") ? at.node->text : std::string{};
  }
  /// 3 or "0x03", of at most `bits` bits.
  [[nodiscard]] std::optional<std::uint32_t> number(const At& at, unsigned bits) {
    std::optional<std::uint64_t> found;
    if (at.node->is(Kind::number)) {
      if (const auto parsed = base::parse_unsigned(at.node->text)) found = *parsed;
    } else if (at.node->is(Kind::string)) {
      const std::string_view digits = at.node->text;
      if (digits.substr(0, 2) == "0x" && digits.size() <= 18)
        if (const auto parsed = base::parse_unsigned(digits.substr(2), 16)) found = *parsed;
    }
    const std::uint64_t most = (std::uint64_t{1} << bits) - 1;
    if (found && *found <= most) return static_cast<std::uint32_t>(*found);
    tell(at, shown(*at.node) + (found ? " is wider than " + std::to_string(bits) + " bits" : " is not an id"),
         "\"0x0\" to \"" + hex(most) + "\"");
    return std::nullopt;
  }
  [[nodiscard]] std::vector<std::string> names_of_boards(const At& object, std::string_view key) {
    std::vector<std::string> out;
    const auto at = object.member(key);
    if (!at || !is_kind(*at, Kind::array, R"(a list of names of boards: ["Dashboard"])")) return out;
    for (std::size_t i = 0; i < at->node->items.size(); ++i) {
      const At item = at->item(i);
      std::string name = word(item);
      if (name.empty()) continue;
      if (std::find(boards_.begin(), boards_.end(), name) == boards_.end())
        doubt(item, "there is no board " + quoted(name), "it is kept; add it to \"boards\"");
      out.push_back(std::move(name));
    }
    return out;
  }

  // --- a message ---

  [[nodiscard]] MessageModel message(const At& at, protocol::ByteOrder order) {
    check_keys(at, {"name", "alias", "description", "id", "pgn", "format", "length", "fd", "sender",
                    "other_senders", "period", "shortest_period", "deadline", "jitter", "send_type",
                    "byte_order", "fields", "attributes", "source"});
    MessageModel out;
    if (const auto a = require(at, "name", "what people call it")) {
      out.name = word(*a);
      claim_name(*a, out.name);
    }
    read_aliases(at, out);
    if (const auto a = at.member("description")) out.description = text(*a);
    out.source = read_source(at,
                             {"id", "pgn", "format", "length", "sender", "period", "shortest_period",
                              "deadline", "jitter", "fields"},
                             true);
    read_address(at, out);
    if (const auto a = at.member("sender")) read_sender(*a, out);
    out.other_senders = names_of_boards(at, "other_senders");
    if (const auto a = at.member("period")) out.period = duration(*a).value_or(Duration{});
    if (const auto a = at.member("shortest_period")) out.shortest_period = duration(*a).value_or(Duration{});
    if (const auto a = at.member("deadline")) out.deadline = duration(*a).value_or(Duration{});
    if (const auto a = at.member("jitter")) out.jitter = duration(*a).value_or(Duration{});
    if (const auto a = at.member("send_type")) out.send_type = text(*a);
    out.attributes = attributes(at);
    read_fields(at, read_order(at, order), out);
    return out;
  }

  /// DBC files have messages of one name, and so may we.
  void claim_name(const At& at, const std::string& name) {
    const auto [other, is_new] = message_names_.emplace(name, at.path);
    if (is_new) return claim(at, name);
    if (!name.empty())
      doubt(at, "the name " + quoted(name) + " is that of another message (see " + other->second + ")",
            "both are kept; give one another name");
  }
  /// Names of topics and aliases are unique over all.
  void claim(const At& at, const std::string& name) {
    if (name.empty()) return;
    const auto [other, is_new] = names_.emplace(name, at.path);
    if (!is_new)
      tell(at, "a second topic or message is called " + quoted(name) + " (see " + other->second + ")",
           "names and aliases are unique over all of them");
  }
  void read_aliases(const At& at, MessageModel& out) {
    const auto list = at.member("alias");
    if (!list || !is_kind(*list, Kind::array, R"(a list of names: ["motor"])")) return;
    for (std::size_t i = 0; i < list->node->items.size(); ++i) {
      std::string alias = word(list->item(i));
      if (alias.empty()) continue;
      claim(list->item(i), alias);
      out.aliases.push_back(std::move(alias));
    }
  }

  void read_address(const At& at, MessageModel& out) {
    using By = protocol::Address::By;
    static constexpr std::pair<std::string_view, Format> formats[] = {
        {"base", Format::base}, {"extended", Format::extended}, {"j1939", Format::j1939}};
    const auto group = at.member("pgn");
    const auto id_at = at.member("id");
    Format format = group ? Format::j1939 : Format::base;
    if (const auto a = at.member("format")) format = one_of(*a, formats).value_or(format);
    out.address = {format == Format::j1939 ? By::pgn : By::identifier, format != Format::base, 0};
    if (group && id_at)
      return tell(*group, "both \"id\" and \"pgn\"", "one of them: an id of J1939 has the pgn in it");
    if (group && format != Format::j1939)
      return tell(*group, "a parameter group in another format",
                  R"("format": "j1939", or "id" in place of "pgn")");
    if (group) {
      const auto pgn = number(*group, 18);
      if (!pgn) return;
      if (j1939::is_pdu1(*pgn) && (*pgn & 0xFF) != 0)
        return tell(*group, shown(*group->node) + " ends with a destination, which is no part of the group",
                    "\"" + hex(*pgn & 0x3'FF00) + "\"");
      out.address.number = j1939::Identifier{.pgn = *pgn}.encode();
    } else if (const auto a = require(at, "id", R"(its identifier, "0x100"; or "pgn" of J1939)")) {
      const auto id = number(*a, 29);
      if (!id) return;
      if (format == Format::base && *id > 0x7FF)
        return tell(*a, shown(*a->node) + " is wider than 11 bits",
                    R"("format": "extended", or an id up to "0x7FF")");
      out.address.number = *id;
    }
    const std::uint32_t known = out.is_j1939() ? j1939::pgn_of(out.address.number) : out.address.number;
    const auto [other, is_new] = ids_.emplace(std::pair{format, known}, at.path);
    if (!is_new)
      doubt(id_at.value_or(at), "its identifier is that of another message (see " + other->second + ")",
            "the first one counts");
  }

  void read_sender(const At& at, MessageModel& out) {
    const std::string name = word(at);
    if (name.empty()) return;
    const auto found = std::find(boards_.begin(), boards_.end(), name);
    if (found != boards_.end() && found - boards_.begin() < protocol::no_board) {
      out.board = static_cast<std::uint8_t>(found - boards_.begin());
      return;
    }
    const std::string near = nearest_name(name, boards_);
    tell(at, "unknown board " + quoted(name),
         !near.empty() ? "did you mean " + quoted(near) + "?" : "the name of one of \"boards\"");
  }

  // --- its fields ---

  void read_fields(const At& at, protocol::ByteOrder order, MessageModel& out) {
    const unsigned most = MessageModel::most_bytes(out.is_j1939());
    std::optional<std::int64_t> length;
    if (const auto a = at.member("length")) length = integer(*a, 0, most);
    const auto list = require(at, "fields", R"([{"name": "Speed", "byte": 0, "type": "u16"}])");
    std::vector<At> places;
    unsigned used = 0;
    if (list && is_kind(*list, Kind::array, "a list of fields")) {
      constexpr std::size_t most_fields =
          protocol::no_selector;  // as many as have an index beside that of none
      if (list->node->items.size() > most_fields)
        return tell(*list, std::to_string(list->node->items.size()) + " fields",
                    "at most " + std::to_string(most_fields) + " in a message");
      std::map<std::string, std::string> names;
      for (std::size_t i = 0; i < list->node->items.size(); ++i) {
        const At field_at = list->item(i);
        if (!is_object(field_at, R"({"name": "Speed", "byte": 0, "type": "u16"})")) continue;
        FieldModel field = read_field(field_at, order);
        if (const auto [other, is_new] = names.emplace(field.name, field_at.path);
            !is_new && !field.name.empty())
          tell(field_at, "a second " + quoted(field.name) + " (see " + other->second + ")",
               "a name of its own for each field of the message");
        used = std::max(used, field.position.start == UINT16_MAX ? 0 : field.position.bytes());
        out.fields.push_back(std::move(field));
        places.push_back(field_at);
      }
    }
    out.length = static_cast<std::uint16_t>(length.value_or(frame_length(used, out.is_j1939())));
    out.fd = out.length > 8 && !out.is_j1939();
    if (const auto a = at.member("fd")) {
      if (!is_kind(*a, Kind::boolean, "true or false")) return;
      if (!a->node->truth && out.fd)
        tell(*a, "a classic frame of " + std::to_string(out.length) + " bytes",
             "\"fd\": true, or at most 8 bytes");
      if (a->node->truth && out.length > 64)
        tell(*a, "a frame of CAN FD of " + std::to_string(out.length) + " bytes",
             "at most 64 bytes, or no \"fd\": a longer parameter group comes in several frames");
      out.fd = a->node->truth;
    }
    const Selectors selectors{out};
    check_selectors(out, selectors, places);
    check_places(out, selectors, places);
  }
  /// The shortest frame of so many bytes. [ISO 11898-1, coding of the DLC]
  [[nodiscard]] static unsigned frame_length(unsigned bytes, bool j1939) {
    if (bytes <= 8 || j1939) return bytes;
    for (const unsigned length : {12U, 16U, 20U, 24U, 32U, 48U})
      if (bytes <= length) return length;
    return 64;
  }

  [[nodiscard]] FieldModel read_field(const At& at, protocol::ByteOrder order) {
    check_keys(
        at, {"name", "description", "byte", "bit", "type", "byte_order", "scale", "offset", "unit", "range",
             "values", "flags", "selector", "selected", "start", "receivers", "attributes", "source"});
    FieldModel field;
    if (const auto a = require(at, "name", "what the number is called")) field.name = word(*a);
    if (const auto a = at.member("description")) field.description = text(*a);
    field.source = read_source(at,
                               {"byte", "bit", "type", "byte_order", "scale", "offset", "unit", "range",
                                "values", "flags", "selector", "selected", "start"},
                               true);
    field.position.order = read_order(at, order);
    field.position.start = UINT16_MAX;  // until the place is known
    const bool typed = read_type(at, field);
    read_place(at, typed, field);
    if (const auto a = at.member("unit")) field.unit = text(*a);
    if (const auto a = at.member("scale")) {
      if (const auto scale = decimal(*a, "physical units a bit, such as 0.25")) {
        field.scale = *scale;
        if (scale->digits == 0) doubt(*a, "a scale of zero", "every value is the offset");
      }
    }
    if (const auto a = at.member("offset"))
      field.offset = decimal(*a, "what the raw number 0 means, such as -40").value_or(Decimal{});
    read_range(at, field);
    if (typed) {
      field.raw_min = protocol::lowest(field.position.width, field.is_signed);
      field.raw_max = protocol::highest(field.position.width, field.is_signed);
      read_values(at, field);
      read_start(at, field);
    }
    read_selected(at, field);
    field.receivers = names_of_boards(at, "receivers");
    field.attributes = attributes(at);
    return field;
  }

  [[nodiscard]] bool read_type(const At& at, FieldModel& field) {
    static constexpr std::string_view form =
        "u1 to u64 (unsigned), i1 to i64 (signed), f32 or f64, such as \"u12\"";
    const auto a = require(at, "type", form);
    if (!a) return false;
    const std::string_view type = a->node->is(Kind::string) ? std::string_view{a->node->text} : "";
    const auto width = type.size() < 2 || type[1] == '0'
                           ? base::Result<std::uint64_t>{base::Error::bad_syntax}
                           : base::parse_unsigned(type.substr(1));
    const char kind = type.empty() ? '\0' : type.front();
    const bool good =
        width && (kind == 'f' ? *width == 32 || *width == 64 : (kind == 'u' || kind == 'i') && *width <= 64);
    if (!good) {
      tell(*a, "unknown type " + shown(*a->node), std::string{form});
      return false;
    }
    if (kind == 'f') field.number = *width == 32 ? protocol::Number::float32 : protocol::Number::float64;
    field.is_signed = kind == 'i';
    field.position.width = static_cast<std::uint8_t>(*width);
    return true;
  }

  /// Beyond the message's length is a doubt, see check_places.
  void read_place(const At& at, bool typed, FieldModel& field) {
    static constexpr unsigned most = MessageModel::most_bytes(true);
    const auto byte = at.member("byte");
    const auto bit = at.member("bit");
    if (byte && bit)
      return tell(*bit, "both \"byte\" and \"bit\"", "one of them says where the field begins");
    if (!byte && !bit)
      return tell(at, "no \"byte\" and no \"bit\"", "add \"byte\" or \"bit\", where the field begins");
    const auto first = integer(byte ? *byte : *bit, 0, (byte ? most : 8 * most) - 1);
    if (!first || !typed) return;
    const bool big = field.position.order == protocol::ByteOrder::big;
    field.position.start = static_cast<std::uint16_t>(!byte ? *first : big ? 8 * *first + 7 : 8 * *first);
    if (field.position.bytes() <= most) return;
    tell(byte ? *byte : *bit,
         "a field of " + std::to_string(field.position.width) +
             " bits that begins here does not end within " + std::to_string(most) + " bytes",
         "an earlier beginning");
    field.position.start = UINT16_MAX;
  }

  /// As stated: advice, which senders leave, and which may be wider than the field.
  void read_range(const At& at, FieldModel& field) {
    const auto a = at.member("range");
    if (!a) return;
    static constexpr std::string_view form = "two numbers in the field's unit, lowest first: [0, 8000]";
    if (!is_kind(*a, Kind::array, form)) return;
    if (a->node->items.size() != 2)
      return tell(*a, "a range of " + std::to_string(a->node->items.size()) + " numbers", std::string{form});
    const auto low = decimal(a->item(0), form);
    const auto high = decimal(a->item(1), form);
    if (!low || !high) return;
    if (base::compare(*low, *high) > 0)
      return tell(*a, "the range begins at " + print(*low) + " and ends below it, at " + print(*high),
                  std::string{form});
    field.range = RangeModel{*low, *high};
  }

  /// {"off": 0, "on": 1}; or, where a name is there twice, [{"raw": 0, "name": "off"}, ...].
  void read_values(const At& at, FieldModel& field) {
    const auto flags = at.member("flags");
    const auto values = at.member("values");
    if (flags && values) return tell(*flags, "both \"values\" and \"flags\"", "a field is one or the other");
    const auto a = flags ? flags : values;
    if (!a) return;
    field.flags = flags.has_value();
    if (field.flags && (field.is_signed || field.number != protocol::Number::integer))
      tell(*a, "flags in a field that is not of bits", "an unsigned type, such as \"u8\"");
    static constexpr std::string_view form = R"(names and raw numbers: {"off": 0, "on": 1})";
    if (values && a->node->is(Kind::array)) {
      for (std::size_t i = 0; i < a->node->items.size(); ++i) {
        const At item = a->item(i);
        if (!is_object(item, R"({"raw": 0, "name": "off"})")) continue;
        check_keys(item, {"raw", "name"});
        const auto name = require(item, "name", "what the value is called");
        const auto raw = require(item, "raw", "the number on the bus");
        if (name && raw) add_value(*raw, text(*name), field);
      }
      return;
    }
    if (!is_object(*a, form)) return;
    for (const auto& [key, node] : a->node->members)
      add_value({&node, a->path + "/" + pointer_step(key)}, key, field);
  }
  void add_value(const At& at, std::string name, FieldModel& field) {
    const unsigned width = field.position.width;
    if (field.flags) {
      if (const auto bit = integer(at, 0, width - 1)) field.values.push_back({std::move(name), *bit});
      return;
    }
    const bool all = width == 64 && !field.is_signed;
    if (all && at.node->is(Kind::number))
      if (const auto bits = base::parse_unsigned(at.node->text)) {
        field.values.push_back({std::move(name), static_cast<std::int64_t>(*bits)});
        return;
      }
    const auto raw = integer(at, INT64_MIN, INT64_MAX);
    if (!raw) return;
    if (!all && (*raw < field.raw_min || *raw > field.raw_max))
      doubt(at, std::to_string(*raw) + " is no value of " + std::to_string(width) + " bits",
            "it is kept, and never comes");
    field.values.push_back({std::move(name), *raw});
  }

  void read_start(const At& at, FieldModel& field) {
    const auto a = at.member("start");
    if (!a) return;
    if (!is_kind(*a, Kind::number,
                 "the raw number that is sent where nothing else is said; of a float its value"))
      return;
    field.start = field.start_from(a->node->text);
    if (!field.start)
      tell(*a, a->node->text.substr(0, 40) + " is out of range",
           "a raw number of " + std::to_string(field.position.width) + " bits");
  }

  void read_selected(const At& at, FieldModel& field) {
    const auto selector = at.member("selector");
    const auto selected = at.member("selected");
    if (selector) field.selector = word(*selector);
    if (!selector && !selected) return;
    static constexpr std::string_view form =
        "raw numbers of the selector, or first and last of them: [0, [4, 7]]";
    if (!selector)
      return tell(*selected, "\"selected\" without \"selector\"", "add \"selector\", the name of a field");
    if (!selected)
      return tell(*selector, "\"selector\" without \"selected\"", "add \"selected\": " + std::string{form});
    if (!is_kind(*selected, Kind::array, form)) return;
    if (selected->node->items.empty()) tell(*selected, "the list is empty", std::string{form});
    for (std::size_t i = 0; i < selected->node->items.size(); ++i) {
      const At item = selected->item(i);
      const bool range = item.node->is(Kind::array);
      if (range && item.node->items.size() != 2) {
        tell(item, "a range of " + std::to_string(item.node->items.size()) + " numbers", std::string{form});
        continue;
      }
      const auto first = bits(range ? item.item(0) : item);
      const auto last = range ? bits(item.item(1)) : first;
      if (!first || !last) continue;
      if (*first > *last)
        tell(item, "the range ends below its beginning", std::string{form});
      else
        field.selected.push_back({*first, *last});
    }
  }
  [[nodiscard]] std::optional<std::uint64_t> bits(const At& at) {
    if (at.node->is(Kind::number))
      if (const auto number = base::parse_unsigned(at.node->text)) return *number;
    tell(at, shown(*at.node) + " is no raw number", "a whole number, not negative");
    return std::nullopt;
  }

  // --- what holds between fields ---

  /// Which field selects which, by their indexes. O(fields log fields).
  class Selectors {
   public:
    static constexpr std::size_t none = SIZE_MAX;

    explicit Selectors(const MessageModel& message) : in_circle_(message.fields.size()) {
      std::map<std::string_view, std::size_t> by_name;  // of two with one name the first
      for (std::size_t i = 0; i < message.fields.size(); ++i) by_name.try_emplace(message.fields[i].name, i);
      for (const FieldModel& field : message.fields) {
        const auto found = field.selector.empty() ? by_name.end() : by_name.find(field.selector);
        above_.push_back(found == by_name.end() ? none : found->second);
      }
      std::vector<bool> known(above_.size());
      for (std::size_t i = 0; i < above_.size(); ++i) {
        std::vector<std::size_t> way;
        std::size_t at = i;
        while (at != none && !known[at]) {
          known[at] = true;
          way.push_back(at);
          at = above_[at];
        }
        // Back on this very way, or on one that leads into a circle.
        const bool circle =
            at != none && (in_circle_[at] || std::find(way.begin(), way.end(), at) != way.end());
        for (const std::size_t each : way) in_circle_[each] = circle;
      }
    }
    /// The field's selector; none: it has none, or one that is no field.
    [[nodiscard]] std::size_t above(std::size_t field) const noexcept { return above_[field]; }
    [[nodiscard]] bool is_circle(std::size_t field) const { return in_circle_[field]; }

   private:
    std::vector<std::size_t> above_;
    std::vector<bool> in_circle_;  ///< the way up from the field does not end
  };

  void check_selectors(const MessageModel& message, const Selectors& selectors,
                       const std::vector<At>& places) {
    std::vector<std::string> names;
    for (const FieldModel& field : message.fields) names.push_back(field.name);
    for (std::size_t i = 0; i < message.fields.size(); ++i) {
      const std::string& name = message.fields[i].selector;
      if (name.empty()) continue;
      const std::size_t above = selectors.above(i);
      const FieldModel* selector = above == Selectors::none ? nullptr : &message.fields[above];
      const At at = places[i].member("selector").value_or(places[i]);
      if (selector == nullptr) {
        const std::string near = nearest_name(name, names);
        tell(at, "there is no field " + quoted(name) + " in this message",
             near.empty() ? "another field of the same message" : "did you mean " + quoted(near) + "?");
      } else if (selector->number != protocol::Number::integer) {
        tell(at, quoted(name) + " is a floating-point number", "a whole number selects");
      } else if (selectors.is_circle(i)) {
        tell(at, "the selectors above " + quoted(message.fields[i].name) + " go in a circle",
             "a selector that is always there above all others");
        return;
      }
    }
  }

  /// Loaded as a DBC file with such fields is.
  void check_places(const MessageModel& message, const Selectors& selectors, const std::vector<At>& places) {
    for (std::size_t i = 0; i < message.fields.size(); ++i) {
      const FieldModel& field = message.fields[i];
      if (field.position.start != UINT16_MAX && field.position.bytes() > message.length)
        doubt(places[i],
              quoted(field.name) + " ends in byte " + std::to_string(field.position.bytes() - 1) +
                  ", and the message has " + std::to_string(message.length) + " bytes",
              "it is there in longer frames only");
    }
    if (message.fields.size() > most_compared) return;
    std::size_t steps = 0;
    for (std::size_t i = 0; i < message.fields.size(); ++i)
      for (std::size_t j = i + 1; j < message.fields.size(); ++j) {
        const FieldModel& a = message.fields[i];
        const FieldModel& b = message.fields[j];
        if (a.position.start == UINT16_MAX || b.position.start == UINT16_MAX ||
            !a.position.overlaps(b.position) || exclude(message, selectors, i, j, steps))
          continue;
        if (steps > most_steps) return;
        doubt(places[j], quoted(a.name) + " and " + quoted(b.name) + " have bits in common",
              "each is read by itself");
        return;
      }
  }
  /// Whether there is a selector, of both or above them, by which one is there only without the other.
  /// Adds to `steps` what it costs, and gives up beyond `most_steps`.
  [[nodiscard]] static bool exclude(const MessageModel& message, const Selectors& selectors, std::size_t a,
                                    std::size_t b, std::size_t& steps) {
    if (selectors.is_circle(a) || selectors.is_circle(b)) return true;  // a problem of its own
    for (std::size_t i = a; selectors.above(i) != Selectors::none; i = selectors.above(i))
      for (std::size_t j = b; selectors.above(j) != Selectors::none; j = selectors.above(j)) {
        const FieldModel& one = message.fields[i];
        const FieldModel& other = message.fields[j];
        steps += 1 + one.selected.size() * other.selected.size();
        if (steps > most_steps) return false;
        if (one.selector == other.selector && !have_common(one.selected, other.selected)) return true;
      }
    return false;
  }
  [[nodiscard]] static bool have_common(const std::vector<protocol::SelectorRange>& a,
                                        const std::vector<protocol::SelectorRange>& b) noexcept {
    return std::any_of(a.begin(), a.end(), [&](const auto& one) {
      return std::any_of(b.begin(), b.end(), [&](const auto& other) {
        return one.first <= other.last && other.first <= one.last;
      });
    });
  }

  /// Two fields are compared with each other to find overlaps, up to so many fields.
  static constexpr std::size_t most_compared = 2000;
  /// And so many of their selectors: a tenth of a second.
  static constexpr std::size_t most_steps = 20'000'000;

  std::vector<Problem>& doubts_;
  std::vector<std::string> boards_;
  std::map<std::string, std::string> names_;  ///< of topics and messages, and where
  std::map<std::string, std::string> message_names_;
  std::map<std::pair<Format, std::uint32_t>, std::string>
      ids_;  ///< identifiers and parameter groups, and where
};

}  // namespace ocm::spec
