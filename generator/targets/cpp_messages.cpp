#include "generator/targets/cpp_messages.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>

#include "ocm/base/text.hpp"

#include "generator/spec/names.hpp"
#include "generator/targets/message_fields.hpp"
#include "generator/text/conversion.hpp"
#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

using protocol::Number;
using spec::FieldModel;
using spec::MessageModel;
using spec::Model;

/// A message's own names, which no field can have; with those of parameters.
const std::set<std::string>& own_members() {
  static const std::set<std::string> members{"name",  "address", "length", "fd",     "period",   "sender",
                                             "bytes", "decode",  "data_",  "value_", "selector_"};
  return members;
}

// --- texts -------------------------------------------------------------------------------------------------

/// A string literal of any text.
std::string literal_of(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7F') {
      const auto byte = static_cast<unsigned char>(c);  // three digits, so that what follows is no part of it
      out += {'\\', static_cast<char>('0' + byte / 64), static_cast<char>('0' + byte / 8 % 8)};
      out += static_cast<char>('0' + byte % 8);
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string number_literal(std::int64_t number, bool is_signed) {
  if (!is_signed) {
    const auto bits = static_cast<std::uint64_t>(number);
    return grouped(bits) + (bits > INT64_MAX ? "U" : "");
  }
  if (number == INT64_MIN) return "INT64_MIN";
  if (number == INT32_MIN) return "INT32_MIN";
  return number < 0 ? "-" + grouped(static_cast<std::uint64_t>(-number))
                    : grouped(static_cast<std::uint64_t>(number));
}

// --- one message -------------------------------------------------------------------------------------------

/// How C++ calls a field, and what it is there.
struct Member {
  const FieldModel* field = nullptr;
  std::string name;
  std::string raw_type;
  std::string type;  ///< of what it means: a number, an enumeration, a float
  bool is_enumeration = false;
  bool is_plain = false;                                     ///< the raw number is what it means
  std::string position;                                      ///< an initializer
  std::vector<std::pair<std::string, std::int64_t>> values;  ///< spelled
};

class StructWriter {
 public:
  StructWriter(Writer& out, const Model& model, const MessageModel& message, std::string type)
      : out_(out), model_(model), message_(message), type_(std::move(type)) {
    std::set<std::string> taken = own_members();
    taken.insert(type_);  // a member of the type's own name would be a constructor
    Scope scope{taken};
    for (const auto* const field : fields_within(message)) members_.push_back(member(*field, scope));
  }

  void write() {
    head();
    out_.open("struct " + type_ + " {");
    constants();
    for (const Member& each : members_) values(each);
    out_.line("ocm::protocol::MessageBytes<" + std::to_string(held_bytes(message_)) + "> bytes{" + start() +
              "};");
    for (const Member& each : members_) accessors(each);
    out_.line();
    out_.comment(
        "Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.");
    // A template, so that std::optional is compiled of those messages only that are decoded.
    out_.line("[[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {");
    out_.line("  return ocm::protocol::message_from<" + type_ + ">(data_);");
    out_.line("}");
    out_.line("friend constexpr bool operator==(const " + type_ + "&, const " + type_ + "&) = default;");
    out_.close("};");
    out_.line();
  }

 private:
  static std::string integer_type(unsigned width, bool is_signed) {
    const char* bits = width <= 8 ? "8" : width <= 16 ? "16" : width <= 32 ? "32" : "64";
    return std::string{"std::"} + (is_signed ? "int" : "uint") + bits + "_t";
  }

  Member member(const FieldModel& field, Scope& scope) {
    const protocol::Position at = field.position;
    Member out;
    out.field = &field;
    out.name = scope.claim(cpp_name(field.name), {{"", ""},
                                                  {"set_", ""},
                                                  {"has_", ""},
                                                  {"", "_raw"},
                                                  {"set_", "_raw"},
                                                  {"", "_is"},
                                                  {"", "Value"},
                                                  {"", "_at"}});
    const bool identity = base::compare(field.scale, {1, 0}) == 0 && field.offset.digits == 0;
    out.raw_type = integer_type(at.width, field.is_signed);
    out.is_plain = identity && field.number == Number::integer;
    std::set<std::string> spelled;
    for (const auto& value : field.values) {
      const bool all = at.width == 64 && !field.is_signed;
      if (!field.flags && !all && (value.raw < field.raw_min || value.raw > field.raw_max)) continue;
      std::string name = cpp_name(value.name);
      if (!spelled.insert(name).second) {
        const auto bits = static_cast<std::uint64_t>(value.raw);
        name += "_" + (value.raw < 0 ? "minus_" + std::to_string(~bits + 1) : std::to_string(bits));
        while (!spelled.insert(name).second) name += "_";
      }
      out.values.emplace_back(std::move(name), value.raw);
    }
    out.is_enumeration = out.is_plain && !field.flags && !out.values.empty() && field.unit.empty();
    out.type = out.is_enumeration                            ? out.name + "Value"
               : out.is_plain                                ? out.raw_type
               : identity && field.number == Number::float32 ? "float"
                                                             : "double";
    out.position = "{" + std::to_string(at.start) + ", " + std::to_string(at.width) +
                   (at.order == protocol::ByteOrder::big ? ", ocm::protocol::ByteOrder::big}" : "}");
    return out;
  }
  [[nodiscard]] const Member* find(const std::string& field) const {
    for (const Member& each : members_)
      if (each.field->name == field) return &each;
    return nullptr;
  }

  void head() {
    std::string text = comment_text(message_.name) + ". ";
    if (!message_.description.empty()) text += comment_text(message_.description) + " ";
    text += address_text(message_);
    if (const auto beyond = fields_beyond(message_); !beyond.empty()) {
      text += " Beyond its length, and not here:";
      for (const std::string& each : beyond) text += " " + comment_text(each);
      text += ".";
    }
    out_.comment(with_source(std::move(text), comment_text(message_.source.joined())));
  }
  void constants() {
    const auto& address = message_.address;
    out_.line("static constexpr std::string_view name = " + literal_of(message_.name) + ";");
    out_.line(std::string{"static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::"} +
              (message_.is_j1939() ? "pgn" : "identifier") + ", " + (address.extended ? "true" : "false") +
              ", " + hexadecimal(address.number, address.extended ? 8 : 3) + "};");
    out_.line("static constexpr std::size_t length = " + std::to_string(message_.length) + ";");
    out_.line(std::string{"static constexpr bool fd = "} + (message_.fd ? "true;" : "false;"));
    out_.line("static constexpr ocm::base::Duration period{" +
              grouped(static_cast<std::uint64_t>(message_.period.count())) +
              "};  ///< ns; 0: none is stated");
    const bool known = message_.board < model_.boards.size();
    out_.line("static constexpr std::string_view sender = " +
              literal_of(known ? model_.boards[message_.board].name : std::string{}) + ";");
    out_.line();
  }

  void values(const Member& member) {
    if (member.values.empty()) return;
    if (member.field->flags) {
      out_.open("struct " + member.name + "Value {");
      for (const auto& [name, bit] : member.values)
        out_.line("static constexpr " + member.raw_type + " " + name + " = " +
                  hexadecimal(std::uint64_t{1} << bit, 2 * static_cast<int>(bit / 8 + 1)) + ";");
      return out_.close("};");
    }
    out_.open("enum class " + member.name + "Value : " + member.raw_type + " {");
    for (const auto& [name, raw] : member.values)
      out_.line(name + " = " + number_literal(raw, member.field->is_signed) + ",");
    out_.close("};");
  }

  /// The bytes that it begins with.
  std::string start() const {
    auto bytes = start_bytes(message_);
    while (!bytes.empty() && bytes.back() == 0) bytes.pop_back();
    std::string text;
    for (const std::uint8_t byte : bytes) text += (text.empty() ? "" : ", ") + hexadecimal(byte, 2);
    return text;
  }

  // --- accessors ---

  void accessors(const Member& member) {
    const FieldModel& field = *member.field;
    out_.line();
    std::string text = comment_text(field.name);
    if (!field.description.empty()) text += ": " + comment_text(field.description);
    if (!text.ends_with('.')) text += ".";
    if (!field.unit.empty()) text += " In " + comment_text(field.unit) + ".";
    if (field.range)
      text += " Stated range: " + print(field.range->min) + " to " + print(field.range->max) + ".";
    out_.comment(with_source(std::move(text), comment_text(field.source.joined())));
    out_.line("static constexpr ocm::protocol::Position " + joined(member.name, "_at") + member.position +
              ";");
    const bool optional = !field.selector.empty();
    if (optional) presence(member);
    if (has_raw(member)) raw_accessors(member);
    const std::string get = physical_of(member);
    if (optional) {
      out_.open("[[nodiscard]] constexpr std::optional<" + member.type + "> " + member.name +
                "() const noexcept {");
      out_.line("if (!has_" + member.name + "()) return std::nullopt;");
      out_.line("return " + get + ";");
      out_.close("}");
      out_.comment("False, and nothing changes, where the selector says that it is not there.");
      out_.open("constexpr bool set_" + member.name + "(" + member.type + " value_) noexcept {");
      out_.line("if (!has_" + member.name + "()) return false;");
      out_.line(put_of(member) + ";");
      out_.line("return true;");
      out_.close("}");
    } else {
      function("[[nodiscard]] constexpr " + member.type + " " + member.name + "() const noexcept",
               "return " + get + ";");
      function("constexpr void set_" + member.name + "(" + member.type + " value_) noexcept",
               put_of(member) + ";");
    }
    if (!member.values.empty() && !member.is_enumeration && !field.flags)
      function("[[nodiscard]] constexpr bool " + joined(member.name, "_is") + "(" + member.name +
                   "Value value_) const noexcept",
               "return " + (has_raw(member) ? joined(member.name, "_raw") : member.name) + "()" +
                   " == static_cast<" + member.raw_type + ">(value_);");
  }

  void presence(const Member& member) {
    const Member* selector = find(member.field->selector);
    const std::string head = "[[nodiscard]] constexpr bool has_" + member.name + "() const noexcept";
    if (selector == nullptr) return function(head, "return false;");
    const FieldModel& field = *selector->field;
    // Of a signed selector the bits count, not the number.
    const std::string selector_type = integer_type(field.position.width, false);
    const std::string cases =
        in_ranges(member.field->selected, protocol::detail::low_mask(field.position.width), "selector_",
                  "true", [](std::uint64_t value) { return grouped(value); });
    if (cases.empty()) return function(head, "return false;");
    out_.open(head + " {");
    if (!field.selector.empty()) out_.line("if (!has_" + selector->name + "()) return false;");
    if (cases.find("selector_") != std::string::npos)
      out_.line("const auto selector_ = " + read(selector_type, *selector) + ";");
    out_.line("return " + cases + ";");
    out_.close("}");
  }

  void raw_accessors(const Member& member) {
    function("[[nodiscard]] constexpr " + member.raw_type + " " + joined(member.name, "_raw") +
                 "() const noexcept",
             "return " + read(member) + ";");
    function(
        "constexpr void set_" + joined(member.name, "_raw") + "(" + member.raw_type + " value_) noexcept",
        write(member, "value_") + ";");
  }

  /// Its raw number is not what it means, or may not be there.
  static bool has_raw(const Member& member) {
    return !member.is_plain || member.is_enumeration || !member.field->selector.empty();
  }
  /// An expression for what the bits mean.
  std::string physical_of(const Member& member) const {
    const FieldModel& field = *member.field;
    const std::string raw = has_raw(member) ? joined(member.name, "_raw") + "()" : read(member);
    if (member.is_enumeration) return "static_cast<" + member.type + ">(" + raw + ")";
    if (member.is_plain) return raw;
    if (field.number == Number::integer)
      return to_physical(conversion(field), "static_cast<double>(" + raw + ")");
    const std::string real = field.number == Number::float32 ? "std::bit_cast<float>(" + raw + ")"
                                                             : "ocm::base::from_binary64(" + raw + ")";
    if (member.type == "float") return real;
    const bool identity = base::compare(field.scale, {1, 0}) == 0 && field.offset.digits == 0;
    return identity ? real : to_physical(conversion(field), "static_cast<double>(" + real + ")");
  }
  /// A statement, without its end, that puts `value`.
  std::string put_of(const Member& member) const {
    const FieldModel& field = *member.field;
    if (member.is_enumeration) return write(member, "static_cast<" + member.raw_type + ">(value_)");
    if (member.is_plain) return write(member, "value_");
    if (field.scale.digits == 0) return "static_cast<void>(value_)";  // every number means the offset
    const bool identity = base::compare(field.scale, {1, 0}) == 0 && field.offset.digits == 0;
    const std::string raw = identity ? "value_" : to_raw(conversion(field), "value_");
    if (field.number == Number::float32)
      return write(member, "std::bit_cast<std::uint32_t>(" +
                               (member.type == "float" ? raw : "static_cast<float>(" + raw + ")") + ")");
    if (field.number == Number::float64) return write(member, "ocm::base::to_binary64(" + raw + ")");
    return "ocm::protocol::write_nearest<" + member.raw_type + ">(bytes, " + joined(member.name, "_at") +
           ", " + raw + ")";
  }

  static std::string read(const std::string& type, const Member& member) {
    return "ocm::protocol::read_field<" + type + ">(bytes, " + joined(member.name, "_at") + ")";
  }
  static std::string read(const Member& member) { return read(member.raw_type, member); }
  /// `value` has the raw type.
  static std::string write(const Member& member, const std::string& value) {
    return "ocm::protocol::write_field(bytes, " + joined(member.name, "_at") + ", " + value + ")";
  }

  /// On one line where it fits.
  void function(const std::string& head, const std::string& body) {
    if (2 + head.size() + 5 + body.size() <= columns) return out_.line(head + " { " + body + " }");
    out_.open(head + " {");
    out_.line(body);
    out_.close("}");
  }

  Writer& out_;
  const Model& model_;
  const MessageModel& message_;
  std::string type_;
  std::vector<Member> members_;
};

}  // namespace

std::string cpp_name(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const bool good = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (good)
      out += c;
    else if (!out.empty() && out.back() != '_')
      out += '_';
  }
  if (out.empty()) out = "n";
  if (out.front() >= '0' && out.front() <= '9') out.insert(0, "n");
  static constexpr std::string_view macros[] = {"EOF", "HUGE_VAL", "INFINITY", "NAN", "NULL"};
  const bool is_macro = std::find(std::begin(macros), std::end(macros), out) != std::end(macros);
  return spec::is_reserved(out) || is_macro ? out + "_" : out;
}

std::string comment_text(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7F') c = ' ';
    if (c == '\\') c = '/';
  }
  return text;
}

void write_messages(Writer& out, const Model& model) {
  std::set<std::string> taken{"bit_rate", "catalogue", "detail", "wire_hash", "ocm", "std", model.name_space};
  for (const auto& topic : model.topics) {
    taken.insert(spec::pascal_case(topic.name));
    for (const auto& frame : topic.frames)
      taken.insert(spec::pascal_case(topic.name) + spec::pascal_case(frame.name));
  }
  for (const auto& board : model.boards) taken.insert(spec::pascal_case(board.name));
  Scope scope{taken};
  for (const MessageModel& message : model.messages)
    StructWriter{out, model, message, scope.claim(cpp_name(message.name), {{"", ""}})}.write();
}

}  // namespace ocm::generate
