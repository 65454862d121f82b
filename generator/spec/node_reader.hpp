/// Reading single values of a document's JSON, and telling what is wrong with them: what the readers of
/// specs, of worlds and of operator files stand on.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "generator/spec/json.hpp"
#include "generator/spec/model.hpp"
#include "generator/spec/names.hpp"
#include "generator/spec/problem.hpp"

namespace ocm::spec {

using base::Decimal;
using base::Duration;
using Kind = Node::Kind;

/// A node and how it is reached.
struct At {
  const Node* node;
  std::string path;

  [[nodiscard]] At item(std::size_t i) const { return {&node->items[i], path + "/" + std::to_string(i)}; }
  [[nodiscard]] std::optional<At> member(std::string_view key) const {
    const Node* found = node->find(key);
    if (found == nullptr) return std::nullopt;
    return At{found, path + "/" + pointer_step(key)};
  }
};

[[nodiscard]] inline std::string quoted(std::string_view text) {
  return "\"" + std::string{text} + "\"";
}
/// As the spec has it, for messages.
[[nodiscard]] inline std::string shown(const Node& node) {
  if (node.is(Kind::string)) return spec::quoted(node.text);
  if (node.is(Kind::number)) return node.text;
  return std::string{describe(node.kind)};
}
[[nodiscard]] inline std::string hex(std::uint64_t number) {
  base::Text<18> text;
  text << "0x";
  text.hex(number, std::max(2, (static_cast<int>(std::bit_width(number)) + 3) / 4));
  return std::string{text.view()};
}
[[nodiscard]] inline std::string print(Decimal number) {
  return std::string{base::to_text(number).view()};
}
/// The shortest spelling: "50ms", "13334us".
[[nodiscard]] inline std::string print(Duration duration) {
  const std::int64_t ns = duration.count();
  if (ns % 1'000'000'000 == 0) return std::to_string(ns / 1'000'000'000) + "s";
  if (ns % 1'000'000 == 0) return std::to_string(ns / 1'000'000) + "ms";
  if (ns % 1'000 == 0) return std::to_string(ns / 1'000) + "us";
  return std::to_string(ns) + "ns";
}
template <class Names>
[[nodiscard]] std::string list_of(const Names& names) {
  std::string list;
  for (const auto& name : names) list.append(list.empty() ? "" : ", ").append(name);
  return list;
}

inline constexpr std::string_view name_form =
    "lower-case letters, digits and single underscores, a letter first: \"sensor_1\"";
inline constexpr std::string_view duration_form = "a number with ns, us, ms or s: \"50ms\"";

/// Each function reads one value, and tells what is wrong with it where it cannot.
class NodeReader {
 public:
  NodeReader(std::string_view file_name, std::vector<Problem>& problems)
      : file_name_(file_name), problems_(problems) {}

 protected:
  /// How many problems there are so far.
  [[nodiscard]] std::size_t told() const noexcept { return problems_.size(); }

  // --- telling ---

  [[nodiscard]] std::string place(const At& at) const {
    return std::string{file_name_} + ":" + std::to_string(at.node->line) + ": " +
           (at.path.empty() ? "/" : at.path);
  }
  void tell(const At& at, std::string what, std::string remedy) {
    problems_.push_back({place(at), std::move(what), std::move(remedy)});
  }

  // --- reading JSON ---

  [[nodiscard]] bool is_kind(const At& at, Kind kind, std::string_view remedy) {
    if (at.node->is(kind)) return true;
    tell(at,
         shown(*at.node) + (at.node->is(Kind::string) || at.node->is(Kind::number) ? " is not " : ", not ") +
             std::string{describe(kind)},
         std::string{remedy});
    return false;
  }
  [[nodiscard]] bool is_object(const At& at, std::string_view remedy) {
    return is_kind(at, Kind::object, remedy);
  }

  void check_keys(const At& at, std::initializer_list<std::string_view> known) {
    for (const auto& [key, node] : at.node->members) {
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      const std::string near = nearest_name(key, known);
      tell({&node, at.path + "/" + pointer_step(key)}, "unknown member " + spec::quoted(key),
           near.empty() ? "one of " + list_of(known) : "did you mean " + spec::quoted(near) + "?");
    }
  }
  [[nodiscard]] std::optional<At> require(const At& at, std::string_view key, std::string_view remedy) {
    auto found = at.member(key);
    if (!found) tell(at, "no " + spec::quoted(key), "add " + spec::quoted(key) + ": " + std::string{remedy});
    return found;
  }

  /// One line of text for people.
  [[nodiscard]] std::string line(const At& at, bool may_be_empty = true) {
    if (!is_kind(at, Kind::string, "a line of text in double quotes")) return {};
    if (at.node->text.size() > 1000) {
      tell(at, "a text of " + std::to_string(at.node->text.size()) + " bytes", "at most 1000");
      return {};
    }
    for (const char c : at.node->text) {
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
        tell(at, "the text has a line break or another control character", "one line of plain text");
        return {};
      }
      if (c == '\\') {  // at the end of a comment it would swallow the next line of the generated header
        tell(at, "the text has a backslash", "leave it out, or write /");
        return {};
      }
    }
    if (at.node->text.empty() && !may_be_empty) tell(at, "the text is empty", "at least one character");
    return at.node->text;
  }

  /// A name as the spec and C++ want it; empty if it is none.
  [[nodiscard]] std::string name(const At& at) {
    if (!is_kind(at, Kind::string, name_form)) return {};
    const std::string& text = at.node->text;
    if (!is_name(text)) {
      tell(at, spec::quoted(text) + " is not a name", std::string{name_form});
      return {};
    }
    if (text.size() > 40) {
      tell(at, "the name " + spec::quoted(text) + " has " + std::to_string(text.size()) + " characters",
           "at most 40");
      return {};
    }
    if (is_reserved(text)) {
      tell(at, spec::quoted(text) + " is a word of C++",
           "another name, such as " + spec::quoted(text + "_value"));
      return {};
    }
    return text;
  }

  [[nodiscard]] std::optional<Decimal> decimal(const At& at, std::string_view remedy) {
    if (!is_kind(at, Kind::number, remedy)) return std::nullopt;
    const auto number = base::parse_decimal(at.node->text);
    if (number) return *number;
    tell(at, "number " + at.node->text.substr(0, 40) + " has more digits than can be kept exactly",
         "at most 18 digits, and an exponent of at most 100");
    return std::nullopt;
  }

  /// A whole number within [min, max].
  [[nodiscard]] std::optional<std::int64_t> integer(const At& at, std::int64_t min, std::int64_t max) {
    const std::string remedy = "a whole number from " + std::to_string(min) + " to " + std::to_string(max);
    const auto number = decimal(at, remedy);
    if (!number) return std::nullopt;
    const auto whole = number->exponent < 0 || number->exponent > 18
                           ? base::Result<std::int64_t>{base::Error::out_of_range}
                           : base::detail::scaled(number->digits, number->exponent);
    if (whole && *whole >= min && *whole <= max) return *whole;
    tell(at, at.node->text.substr(0, 40) + (number->exponent < 0 ? " is not whole" : " is out of range"),
         remedy);
    return std::nullopt;
  }

  /// 3 or "0x03".
  [[nodiscard]] std::optional<std::uint8_t> id(const At& at) {
    static constexpr std::string_view form = "a topic's number has 8 bits: \"0x00\" to \"0xFF\"";
    std::optional<std::uint64_t> number;
    if (at.node->is(Kind::number)) {
      if (const auto parsed = base::parse_unsigned(at.node->text)) number = *parsed;
    } else if (at.node->is(Kind::string)) {
      const std::string_view text = at.node->text;
      if (text.substr(0, 2) == "0x" && text.size() <= 18)
        if (const auto parsed = base::parse_unsigned(text.substr(2), 16)) number = *parsed;
    }
    if (!number) {
      tell(at, shown(*at.node) + " is not an id", std::string{form});
      return std::nullopt;
    }
    if (*number > 0xFF) {
      tell(at, shown(*at.node) + " is wider than 8 bits", std::string{form});
      return std::nullopt;
    }
    return static_cast<std::uint8_t>(*number);
  }

  /// "50ms". Not negative; 292 years at most.
  [[nodiscard]] std::optional<Duration> duration(const At& at) {
    static constexpr std::pair<std::string_view, Decimal> units[] = {
        {"ns", {1, 0}}, {"us", {1, 3}}, {"ms", {1, 6}}, {"s", {1, 9}}};
    if (!is_kind(at, Kind::string, duration_form)) return std::nullopt;
    const std::string_view text = at.node->text;
    const std::size_t split = text.find_first_not_of("0123456789.");
    if (split != std::string_view::npos && split != 0) {
      for (const auto& [unit, nanoseconds] : units) {
        if (text.substr(split) != unit) continue;
        const auto count = base::parse_decimal(text.substr(0, split));
        if (!count) break;
        const auto product = base::multiply(*count, nanoseconds);
        const auto whole = !product || product->exponent < 0
                               ? base::Result<std::int64_t>{base::Error::out_of_range}
                               : base::detail::scaled(product->digits, product->exponent);
        if (whole) return Duration{*whole};
        tell(at, spec::quoted(text) + " is not a whole number of nanoseconds within 292 years",
             std::string{duration_form});
        return std::nullopt;
      }
    }
    tell(at, spec::quoted(text) + " is not a duration", std::string{duration_form});
    return std::nullopt;
  }

  /// A duration that a request can carry.
  [[nodiscard]] std::optional<protocol::Period> period(const At& at) {
    const auto wanted = duration(at);
    if (!wanted) return std::nullopt;
    if (const auto wire = protocol::Period::from(*wanted)) return *wire;
    tell(at, "a request cannot carry the period " + spec::quoted(at.node->text),
         "1 to 65535 of us, ms or s; the nearest is \"" +
             print(protocol::Period::nearest(*wanted).duration()) + "\"");
    return std::nullopt;
  }

  [[nodiscard]] std::optional<protocol::Priority> priority(const At& at) {
    static constexpr std::pair<std::string_view, protocol::Priority> priorities[] = {
        {"urgent", protocol::Priority::urgent},
        {"high", protocol::Priority::high},
        {"medium", protocol::Priority::medium},
        {"low", protocol::Priority::low}};
    return one_of(at, priorities);
  }

  template <class T, std::size_t N>
  [[nodiscard]] std::optional<T> one_of(const At& at, const std::pair<std::string_view, T> (&choices)[N]) {
    std::vector<std::string_view> names;
    for (const auto& [text, value] : choices) {
      if (at.node->is(Kind::string) && at.node->text == text) return value;
      names.push_back(text);
    }
    tell(at, shown(*at.node) + " is not known here", "one of " + list_of(names));
    return std::nullopt;
  }

  [[nodiscard]] protocol::ByteOrder read_order(const At& at, protocol::ByteOrder inherited) {
    static constexpr std::pair<std::string_view, protocol::ByteOrder> choices[] = {
        {"little", protocol::ByteOrder::little}, {"big", protocol::ByteOrder::big}};
    const auto order = at.member("byte_order");
    return order ? one_of(*order, choices).value_or(inherited) : inherited;
  }

  /// `facts` are the members that need a source; `inherited`: it may be missing, for it is further out.
  [[nodiscard]] Source read_source(const At& object, std::initializer_list<std::string_view> facts,
                                   bool inherited) {
    const auto at = object.member("source");
    Source source;
    if (!at) {
      if (!inherited)
        tell(object, "no \"source\"", R"(add "source": where the facts come from, or "decided: why")");
      return source;
    }
    if (at->node->is(Kind::string)) {
      source.general = line(*at, false);
      return source;
    }
    if (!is_object(*at, R"(a line of text, or {"default": "...", "id": "..."} with a text for each fact)"))
      return source;
    for (const auto& [key, node] : at->node->members) {
      const At entry{&node, at->path + "/" + pointer_step(key)};
      std::string text = line(entry, false);
      if (key == "default") {
        source.general = std::move(text);
      } else if (std::find(facts.begin(), facts.end(), key) == facts.end() || !object.member(key)) {
        std::vector<std::string> present;
        for (const auto fact : facts)
          if (object.member(fact)) present.emplace_back(fact);
        tell(entry, "source for " + spec::quoted(key) + ", which is not a fact of this object",
             "default, or one of " + list_of(present));
      } else {
        source.particular.emplace_back(key, std::move(text));
      }
    }
    if (at->member("default") || inherited) return source;
    for (const auto fact : facts)
      if (object.member(fact) && !at->member(fact))
        tell(*at, "no source for " + spec::quoted(fact), "add " + spec::quoted(fact) + " or \"default\"");
    return source;
  }

 private:
  std::string_view file_name_;
  std::vector<Problem>& problems_;
};

}  // namespace ocm::spec
