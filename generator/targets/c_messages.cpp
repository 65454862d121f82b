#include "generator/targets/c_messages.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "generator/targets/c_helpers.hpp"
#include "generator/targets/c_text.hpp"
#include "generator/targets/cpp_messages.hpp"
#include "generator/targets/message_fields.hpp"
#include "generator/text/conversion.hpp"
#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

using protocol::Number;
using spec::FieldModel;
using spec::MessageModel;
using spec::Model;

/// The raw number is what it means.
bool is_plain(const FieldModel& field) {
  return field.number == Number::integer && base::compare(field.scale, {1, 0}) == 0 &&
         field.offset.digits == 0;
}
bool has_identity(const FieldModel& field) {
  return base::compare(field.scale, {1, 0}) == 0 && field.offset.digits == 0;
}
std::string meaning_type(const FieldModel& field) {
  if (is_plain(field)) return type_of(field);
  return field.number == Number::float32 && has_identity(field) ? "float" : "double";
}

class MessageWriter {
 public:
  MessageWriter(Writer& out, const Model& model, const MessageModel& message, std::set<std::string>& taken)
      : out_(out), robot_(name_space_of(model)), macro_(upper(robot_)), message_(message), taken_(taken) {
    Scope scope{taken_};
    const std::string before = robot_ + "_";
    const std::string name = scope.claim(
        cpp_name(message.name), {{before, ""}, {before, "_init"}, {before, "_is"}, {before, "_decode"}});
    type_ = before + name;
    const std::string of = joined(type_, "_");
    for (const FieldModel* const field : fields_within(message))
      names_.emplace_back(
          field,
          scope.claim(cpp_name(field->name),
                      {{of, ""}, {of + "set_", ""}, {of + "has_", ""}, {of, "_raw"}, {of + "set_", "_raw"}}));
  }

  void write() {
    head();
    out_.line("typedef struct " + type_ + " { uint8_t bytes[" + std::to_string(held_bytes(message_)) +
              "]; } " + type_ + ";");
    values();
    init();
    is();
    decode();
    for (const auto& [field, name] : in_order()) accessors(*field, name);
    out_.line();
  }

 private:
  void comment(std::string_view text) { out_.comment(text, "// "); }
  void define(const std::string& name, const std::string& value) {
    std::string full = joined(macro_, "_" + name);
    while (!taken_.insert(full).second) full += '_';
    out_.line("#define " + full + " " + value);
  }
  void define_of(const char* name, const std::string& value) { define(joined(stem(), name), value); }
  [[nodiscard]] std::string stem() const { return upper(type_.substr(robot_.size() + 1)); }
  [[nodiscard]] std::string function(const std::string& name) const { return joined(type_, "_" + name); }
  [[nodiscard]] const std::string* name_of(const FieldModel* wanted) const {
    for (const auto& [field, name] : names_)
      if (field == wanted) return &name;
    return nullptr;
  }

  /// What selects a field before it.
  [[nodiscard]] std::vector<std::pair<const FieldModel*, std::string>> in_order() const {
    const auto levels = selection_levels(message_);
    auto ordered = names_;
    std::stable_sort(ordered.begin(), ordered.end(),
                     [&](const auto& a, const auto& b) { return levels.at(a.first) < levels.at(b.first); });
    return ordered;
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
    comment(with_source(std::move(text), comment_text(message_.source.joined())));
    const auto& address = message_.address;
    define_of("_ID", hexadecimal(address.number, address.extended ? 8 : 3) + "u");
    define_of("_EXTENDED", address.extended ? "1" : "0");
    define_of("_LENGTH", std::to_string(message_.length) + "u");
    define_of("_FD", message_.fd ? "1" : "0");
    if (message_.period.count() != 0)
      define_of("_PERIOD_US", std::to_string(message_.period.count() / 1000) + "u");
  }

  void values() {
    for (const auto& [field, name] : names_)
      for (const auto& value : field->values)
        define(joined(joined(stem(), "_" + upper(name)), "_" + upper(cpp_name(value.name))),
               field->flags ? word_literal(std::uint64_t{1} << value.raw, is_wide(*field))
               : !field->is_signed && field->position.width > 32
                   ? word_literal(static_cast<std::uint64_t>(value.raw), true)
               : value.raw < 0 ? "(" + literal(value.raw) + ")"
                               : literal(value.raw));
  }

  void init() {
    comment("Each field at its start value, all other bits zero.");
    out_.open("static inline void " + function("init") + "(" + type_ + "* message) {");
    out_.line("unsigned i;");
    out_.line("for (i = 0; i < " + std::to_string(held_bytes(message_)) + "u; ++i) message->bytes[i] = 0;");
    const auto bytes = start_bytes(message_);
    for (std::size_t i = 0; i < bytes.size(); ++i)
      if (bytes[i] != 0)
        out_.line("message->bytes[" + std::to_string(i) + "] = " + hexadecimal(bytes[i], 2) + "u;");
    out_.close("}");
  }

  void is() {
    const auto& address = message_.address;
    out_.open("static inline int " + function("is") + "(uint32_t id, int extended) {");
    std::string same = "id == " + hexadecimal(address.number, address.extended ? 8 : 3) + "u";
    if (message_.is_j1939()) {
      // Whatever the priority and the addresses. [SAE J1939-21, 5.1]
      const bool to_one = (address.number >> 16 & 0xFF) < 240;
      const std::uint32_t mask = to_one ? 0x03FF'0000 : 0x03FF'FF00;
      same = "(id & " + hexadecimal(mask, 8) + "u) == " + hexadecimal(address.number & mask, 8) + "u";
    }
    out_.line("return " + std::string{address.extended ? "extended && " : "!extended && "} + same + ";");
    out_.close("}");
  }

  void decode() {
    comment("0, and the struct is as it was, where it is shorter than the message.");
    out_.open("static inline int " + function("decode") + "(" + type_ +
              "* message, const uint8_t* data, unsigned length) {");
    out_.line("unsigned i;");
    out_.line(message_.length == 0 ? "(void)length;"
                                   : "if (length < " + std::to_string(message_.length) + "u) return 0;");
    if (message_.length < held_bytes(message_))
      out_.line("for (i = 0; i < " + std::to_string(held_bytes(message_)) + "u; ++i) message->bytes[i] = 0;");
    if (message_.length != 0)
      out_.line("for (i = 0; i < " + std::to_string(message_.length) +
                "u; ++i) message->bytes[i] = data[i];");
    else
      out_.line("(void)data;");
    out_.line("return 1;");
    out_.close("}");
  }

  // --- fields ---

  void accessors(const FieldModel& field, const std::string& name) {
    std::string text = comment_text(field.name);
    if (!field.description.empty()) text += ": " + comment_text(field.description);
    if (!text.ends_with('.')) text += ".";
    if (!field.unit.empty()) text += " In " + comment_text(field.unit) + ".";
    if (field.range)
      text += " Stated range: " + print(field.range->min) + " to " + print(field.range->max) + ".";
    comment(with_source(std::move(text), comment_text(field.source.joined())));
    const bool optional = !field.selector.empty();
    if (optional) presence(field, name);
    if (!is_plain(field)) {
      read(field, type_of(field), joined(name, "_raw"));
      write(field, type_of(field), joined("set_" + name, "_raw"));
    }
    const std::string type = meaning_type(field);
    const std::string has = function("has_" + name);
    if (optional) {
      // Of a plain one the reader is in the same function.
      out_.open("static inline int " + function(name) + "(const " + type_ + "* message, " + type +
                "* value) {");
      if (is_plain(field)) declare_bits(field);
      out_.line("if (!" + has + "(message)) return 0;");
      if (is_plain(field)) assign_bits(field);
      out_.line("*value = " + (is_plain(field) ? signed_bits(field) : meaning(field, name)) + ";");
      out_.line("return 1;");
      out_.close("}");
      out_.open("static inline int " + function("set_" + name) + "(" + type_ + "* message, " + type +
                " value) {");
      if (is_plain(field)) {
        out_.line("const " + word_type(field) + " bits = (" + word_type(field) + ")" +
                  held(field, "value", robot_) + ";");
        out_.line("if (!" + has + "(message)) return 0;");
        put_bits(field);
      } else {
        out_.line("if (!" + has + "(message)) return 0;");
        out_.line(putting(field, name));
      }
      out_.line("return 1;");
      return out_.close("}");
    }
    if (is_plain(field)) {
      read(field, type, name);
      return write(field, type, "set_" + name);
    }
    out_.open("static inline " + type + " " + function(name) + "(const " + type_ + "* message) {");
    out_.line("return " + meaning(field, name) + ";");
    out_.close("}");
    out_.open("static inline void " + function("set_" + name) + "(" + type_ + "* message, " + type +
              " value) {");
    out_.line(putting(field, name));
    out_.close("}");
  }

  void presence(const FieldModel& field, const std::string& name) {
    const FieldModel* const selector = selector_of(message_, field);
    out_.open("static inline int " + function("has_" + name) + "(const " + type_ + "* message) {");
    std::string cases;
    if (selector != nullptr)
      cases = in_ranges(field.selected, protocol::detail::low_mask(selector->position.width), "bits", "1",
                        [&](std::uint64_t value) { return word_literal(value, is_wide(*selector)); });
    if (cases.empty()) {
      out_.line("(void)message;");
      out_.line("return 0;");
      return out_.close("}");
    }
    const bool looks = cases.find("bits") != std::string::npos;
    if (looks) declare_bits(*selector);
    if (!selector->selector.empty())
      out_.line("if (!" + function("has_" + *name_of(selector)) + "(message)) return 0;");
    if (looks) assign_bits(*selector);
    if (!looks && selector->selector.empty()) out_.line("(void)message;");
    out_.line("return " + cases + ";");
    out_.close("}");
  }

  // Bits, in a variable `bits` without sign.

  void declare_bits(const FieldModel& field) { out_.line(word_type(field) + " bits;"); }
  [[nodiscard]] std::vector<std::string> bits_of(const FieldModel& field) const {
    std::vector<std::string> terms;
    for (const Piece& piece : pieces_of(field.position)) {
      const std::string byte = "(" + word_type(field) + ")message->bytes[" + std::to_string(piece.byte) + "]";
      terms.push_back(shifted(masked(shifted(byte, ">>", piece.shift), piece.width), "<<", piece.from));
    }
    return terms;
  }
  void assign_bits(const FieldModel& field) { write_bits("bits =", bits_of(field)); }
  void write_bits(const std::string& head, std::vector<std::string> terms) {
    std::string all = head;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (i + 1 < terms.size()) terms[i] += " |";
      all += " " + terms[i];
    }
    if (all.size() + 3 <= columns) return out_.line(all + ";");
    out_.open(head);
    for (std::size_t i = 0; i < terms.size(); ++i) out_.line(terms[i] + (i + 1 < terms.size() ? "" : ";"));
    out_.undent();
  }
  [[nodiscard]] static std::string signed_bits(const FieldModel& field) {
    const unsigned width = field.position.width;
    if (!field.is_signed || width == 32 || width == 64) return "(" + type_of(field) + ")bits";
    const std::string sign = word_literal(std::uint64_t{1} << (width - 1), is_wide(field));
    return "(" + type_of(field) + ")((bits ^ " + sign + ") - " + sign + ")";
  }
  void read(const FieldModel& field, const std::string& type, const std::string& name) {
    out_.open("static inline " + type + " " + function(name) + "(const " + type_ + "* message) {");
    write_bits("const " + word_type(field) + " bits =", bits_of(field));
    out_.line("return " + signed_bits(field) + ";");
    out_.close("}");
  }
  void write(const FieldModel& field, const std::string& type, const std::string& name) {
    out_.open("static inline void " + function(name) + "(" + type_ + "* message, " + type + " value) {");
    out_.line("const " + word_type(field) + " bits = (" + word_type(field) + ")" +
              held(field, "value", robot_) + ";");
    put_bits(field);
    out_.close("}");
  }
  void put_bits(const FieldModel& field) {
    for (const Piece& piece : pieces_of(field.position)) {
      const std::string byte = "message->bytes[" + std::to_string(piece.byte) + "]";
      const std::string part = "(uint32_t)" + shifted("bits", ">>", piece.from);
      if (piece.width == 8) {
        out_.line(byte + " = (uint8_t)(" + part + " & 0xFFu);");
        continue;
      }
      const unsigned mask = (1U << piece.width) - 1;
      out_.line(byte + " = (uint8_t)((" + byte + " & " + word_literal(0xFFU & ~(mask << piece.shift), false) +
                ") | " + shifted("(" + part + " & " + word_literal(mask, false) + ")", "<<", piece.shift) +
                ");");
    }
  }

  // What they mean.

  [[nodiscard]] std::string meaning(const FieldModel& field, const std::string& name) const {
    const std::string raw = function(joined(name, "_raw")) + "(message)";
    if (field.number == Number::integer)
      return without_marks(to_physical(conversion(field), "(double)" + raw));
    const std::string real =
        robot_ + (field.number == Number::float32 ? "_float_of(" : "_double_of(") + raw + ")";
    if (has_identity(field)) return real;
    return without_marks(
        to_physical(conversion(field), field.number == Number::float32 ? "(double)" + real : real));
  }
  [[nodiscard]] std::string putting(const FieldModel& field, const std::string& name) const {
    const std::string put = function(joined("set_" + name, "_raw")) + "(message, ";
    if (field.scale.digits == 0) return "(void)message, (void)value;";  // every number means the offset
    const std::string raw = has_identity(field) ? "value" : without_marks(to_raw(conversion(field), "value"));
    if (field.number == Number::float32)
      return put + robot_ + "_bits_of_float(" + (has_identity(field) ? raw : "(float)(" + raw + ")") + "));";
    if (field.number == Number::float64) return put + robot_ + "_bits_of_double(" + raw + "));";
    const unsigned width = field.position.width;
    if (!field.is_signed && width == 64) return put + robot_ + "_nearest_u64(" + raw + "));";
    return put + "(" + type_of(field) + ")" + robot_ + "_nearest(" + raw + ", " +
           literal(protocol::lowest(width, field.is_signed)) + ", " +
           literal(protocol::highest(width, field.is_signed)) + "));";
  }

  Writer& out_;
  std::string robot_;
  std::string macro_;
  const MessageModel& message_;
  std::set<std::string>& taken_;
  std::string type_;
  std::vector<std::pair<const FieldModel*, std::string>> names_;
};

}  // namespace

void write_c_messages(Writer& out, const Model& model, std::set<std::string>& taken) {
  for (const MessageModel& message : model.messages) MessageWriter{out, model, message, taken}.write();
}

}  // namespace ocm::generate
