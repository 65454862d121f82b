/// The messages of a DBC file: identifier, name and length from BO_, cycle time from the attribute
/// GenMsgCycleTime in milliseconds, with its default. All else that a DBC says is passed over. There is no
/// public standard; [Vector, DBC File Format Documentation 1.0.1; readers such as
/// canmatrix and cantools] agree on this much.
#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"
#include "ocm/base/text.hpp"

#include "cli/analyse/set.hpp"

namespace ocm::cli::analyse {
namespace {

constexpr std::uint32_t extended_flag = 0x8000'0000;
/// Vector's pseudo message for signals without one; it is never sent.
constexpr std::uint32_t independent_signals = 0xC000'0000;
/// The name of a missing node.
constexpr std::string_view no_sender = "Vector__XXX";

/// Words, numbers, quoted strings and punctuation, one by one.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) {}

  struct Token {
    std::string_view text;
    bool quoted = false;
    std::size_t line = 0;
    bool starts_line = false;
  };
  std::optional<Token> next() {
    bool starts = at_start_;
    while (at_ < text_.size() && is_space(text_[at_])) {
      if (text_[at_] == '\n') {
        ++line_;
        starts = true;
      }
      ++at_;
    }
    if (at_ == text_.size()) return std::nullopt;
    at_start_ = false;
    Token token{{}, false, line_, starts};
    const std::size_t begin = at_;
    if (text_[at_] == '"') {
      ++at_;
      while (at_ < text_.size() && text_[at_] != '"') {
        if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
        if (text_[at_] == '\n') ++line_;
        ++at_;
      }
      token.quoted = true;
      token.text = text_.substr(begin + 1, at_ - begin - 1);
      if (at_ < text_.size()) ++at_;
      return token;
    }
    if (is_mark(text_[at_])) {
      ++at_;
    } else {
      while (at_ < text_.size() && !is_space(text_[at_]) && !is_mark(text_[at_]) && text_[at_] != '"') ++at_;
    }
    token.text = text_.substr(begin, at_ - begin);
    return token;
  }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  static bool is_mark(char c) { return c == ':' || c == ';' || c == ','; }
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  bool at_start_ = true;
};

/// Milliseconds, perhaps with a fraction, as nanoseconds.
std::optional<std::int64_t> nanoseconds(std::string_view milliseconds) {
  const auto number = base::parse_decimal(milliseconds);
  if (!number) return std::nullopt;
  const auto ns = base::divide_rounded(*number, base::Decimal{1, -6});
  if (!ns || *ns < 0) return std::nullopt;
  return *ns;
}

}  // namespace

BusSet parse_dbc(std::string_view text, const std::string& file, std::vector<Mistake>& mistakes) {
  struct Raw {
    BusEntry entry;
    std::uint32_t id = 0;
  };
  std::vector<Raw> found;
  std::map<std::uint32_t, std::int64_t> cycles;
  std::int64_t usual = 0;
  const auto mistake = [&](std::size_t line, std::string what, std::string remedy) {
    mistakes.push_back({fmt::format("{}:{}", file, line), std::move(what), std::move(remedy)});
  };

  Tokens tokens{text};
  for (auto token = tokens.next(); token; token = tokens.next()) {
    if (!token->starts_line || token->quoted) continue;
    const std::size_t line = token->line;
    if (token->text == "BO_") {
      const auto id = tokens.next();
      const auto name = tokens.next();
      const auto colon = tokens.next();
      const auto dlc = tokens.next();
      const auto number = id ? base::parse_unsigned(id->text) : base::Error::bad_syntax;
      const auto length = dlc ? base::parse_unsigned(dlc->text) : base::Error::bad_syntax;
      if (!number || *number > UINT32_MAX || !colon || colon->text != ":" || !length) {
        mistake(line, "BO_ without identifier, name or length", "BO_ 257 Name: 8 Sender");
        continue;
      }
      if (*number == independent_signals) continue;
      Raw raw;
      raw.id = static_cast<std::uint32_t>(*number);
      raw.entry.name = name->text;
      raw.entry.line = line;
      Tokens ahead = tokens;  // a line that ends here has no sender
      if (const auto sender = ahead.next(); sender && !sender->starts_line && sender->text != no_sender)
        raw.entry.node = sender->text;
      raw.entry.head.id = raw.id & ~extended_flag;
      raw.entry.head.format = (raw.id & extended_flag) != 0 ? can::Format::extended : can::Format::base;
      if (*length > can::max_dlc)
        mistake(line, fmt::format("'{}' has {} bytes", name->text, *length),
                "0 to 8: classic CAN; CAN FD is not covered");
      else
        raw.entry.head.dlc = static_cast<std::uint8_t>(*length);
      if (!can::validate(raw.entry.head))
        mistake(line, fmt::format("'{}' has the identifier {}", name->text, *number),
                "11 bits, or 29 bits and 2147483648 more");
      found.push_back(std::move(raw));
    } else if (token->text == "BA_DEF_DEF_") {
      const auto attribute = tokens.next();
      if (!attribute || attribute->text != "GenMsgCycleTime") continue;
      const auto value = tokens.next();
      const auto ns = value ? nanoseconds(value->text) : std::nullopt;
      if (!ns) {
        mistake(line, "the default of GenMsgCycleTime is not a time", "a number of milliseconds, 0 for none");
        continue;
      }
      usual = *ns;
    } else if (token->text == "BA_") {
      const auto attribute = tokens.next();
      if (!attribute || attribute->text != "GenMsgCycleTime") continue;
      const auto of = tokens.next();
      if (!of || of->text != "BO_") continue;
      const auto id = tokens.next();
      const auto value = tokens.next();
      const auto number = id ? base::parse_unsigned(id->text) : base::Error::bad_syntax;
      const auto ns = value ? nanoseconds(value->text) : std::nullopt;
      if (!number || *number > UINT32_MAX || !ns) {
        mistake(line, "GenMsgCycleTime without identifier or time", "BA_ \"GenMsgCycleTime\" BO_ 257 10;");
        continue;
      }
      cycles[static_cast<std::uint32_t>(*number)] = *ns;
    }
  }

  BusSet set;
  std::string without;
  for (Raw& raw : found) {
    const auto cycle = cycles.find(raw.id);
    raw.entry.period = cycle == cycles.end() ? usual : cycle->second;
    if (raw.entry.period > 0)
      set.entries.push_back(std::move(raw.entry));
    else
      without += (without.empty() ? "" : ", ") + raw.entry.name;
  }
  if (set.entries.empty() && mistakes.empty())
    mistakes.push_back({file, found.empty() ? "no message" : "no message has a cycle time",
                        "BA_ \"GenMsgCycleTime\" BO_ 257 10; says every 10 ms"});
  if (!without.empty())
    set.remarks.push_back(fmt::format("Not in the set, as they have no cycle time: {}.", without));
  order_bus(set, file, mistakes);
  return set;
}

}  // namespace ocm::cli::analyse
