#include "generator/dbc/reader.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <unordered_map>
#include <utility>

#include "generator/dbc/encoding.hpp"
#include "generator/dbc/syntax.hpp"

namespace ocm::dbc {
namespace {

/// Two signals of a message are compared with each other to find overlaps, up to so many signals.
constexpr std::size_t most_compared = 2000;

/// As many as have an index of 16 bits beside the one that stands for none (protocol::no_selector).
constexpr std::size_t most_signals = 0xFFFF;

/// `VAL_` and the like name a signal by the message's identifier, as written, and its short name.
struct SignalKey {
  std::uint32_t id = 0;
  std::string_view name;
  friend bool operator==(const SignalKey&, const SignalKey&) = default;
};
struct SignalHash {
  std::size_t operator()(const SignalKey& key) const noexcept {
    return std::hash<std::string_view>{}(key.name) ^ key.id * std::size_t{0x9E37'79B1};
  }
};
struct SignalAt {
  std::size_t message = 0;
  std::size_t signal = 0;
};

/// Selectors above a signal, one above another. Files have three of them; each costs time in every frame.
constexpr std::size_t most_nested = 64;

/// As have_common, of many ranges.
bool have_common_of_many(std::vector<SelectorRange> a, std::vector<SelectorRange> b) {
  const auto by_first = [](const SelectorRange& one, const SelectorRange& other) {
    return one.first < other.first;
  };
  std::sort(a.begin(), a.end(), by_first);
  std::sort(b.begin(), b.end(), by_first);
  for (auto one = a.begin(), other = b.begin(); one != a.end() && other != b.end();) {
    if (one->first <= other->last && other->first <= one->last) return true;
    if (one->last < other->last)
      ++one;
    else
      ++other;
  }
  return false;
}

bool have_common(const std::vector<SelectorRange>& a, const std::vector<SelectorRange>& b) {
  constexpr std::size_t few = 4096;  // comparisons
  if (a.size() * b.size() > few) return have_common_of_many(a, b);
  return std::any_of(a.begin(), a.end(), [&](const SelectorRange& one) {
    return std::any_of(b.begin(), b.end(), [&](const SelectorRange& other) {
      return one.first <= other.last && other.first <= one.last;
    });
  });
}

/// Makes a document of statements: looks up what they refer to.
class Resolver {
 public:
  Resolver(Statements statements, std::vector<Finding>& problems, std::vector<Finding>& doubts)
      : statements_(std::move(statements)), problems_(problems), doubts_(doubts) {}

  Document resolve() {
    index();
    defaults();
    for (auto& statement : statements_.comments) comment(statement);
    for (auto& statement : statements_.values) values(statement);
    for (const auto& statement : statements_.numbers) number(statement);
    for (auto& statement : statements_.senders) senders(statement);
    for (auto& statement : statements_.selectors) selector(statement);
    for (auto& statement : statements_.attributes) attribute(statement);
    for (std::size_t i = 0; i < statements_.messages.size(); ++i)
      if (!replaced_[i]) expect_countable(statements_.messages[i]);
    for (std::size_t i = 0; i < statements_.messages.size(); ++i)
      if (!replaced_[i]) multiplexing(statements_.messages[i]);
    for (auto& statement : statements_.messages) meaning(statement.message);
    send_types_of_signals();
    long_names();
    Document document = std::move(statements_.document);
    document.messages.reserve(statements_.messages.size());
    for (std::size_t i = 0; i < statements_.messages.size(); ++i) {
      auto& [message, written_id, signals] = statements_.messages[i];
      std::vector<Signal>& to =
          message.name == "VECTOR__INDEPENDENT_SIG_MSG" ? document.independent : message.signals;
      to.reserve(to.size() + signals.size());
      for (auto& statement : signals) to.push_back(std::move(statement.signal));
      std::vector<SignalStatement>{}.swap(signals);  // for what is made next
      if (&to == &document.independent || replaced_[i]) continue;
      if (problems_.empty()) check(message);  // selectors in a circle have no end
      document.messages.push_back(std::move(message));
    }
    return document;
  }

 private:
  void doubt(std::size_t line, std::string what, std::string remedy) {
    doubts_.push_back({line, std::move(what), std::move(remedy)});
  }

  // --- looking up ---

  void index() {
    auto& messages = statements_.messages;
    replaced_.resize(messages.size());
    std::unordered_map<std::string_view, std::size_t> names;
    std::size_t signals = 0;
    for (const MessageStatement& message : messages) signals += message.signals.size();
    signals_.reserve(signals);  // it would hash all names again each time that it grows
    by_id_.reserve(messages.size());
    names.reserve(messages.size());
    for (std::size_t i = 0; i < messages.size(); ++i) {
      MessageStatement& message = messages[i];
      const auto [at, is_new] = by_id_.try_emplace(message.written_id, i);
      if (!is_new) {
        doubt(message.message.line,
              "the identifier " + std::to_string(message.written_id) + " of " + message.message.name +
                  " is that of " + messages[at->second].message.name + " in line " +
                  std::to_string(messages[at->second].message.line),
              "this one counts");
        replaced_[at->second] = true;
        at->second = i;
      } else if (const auto [same, unique] = names.try_emplace(message.message.name, i); !unique) {
        doubt(message.message.line,
              "the name " + message.message.name + " is that of the message in line " +
                  std::to_string(messages[same->second].message.line),
              "both are kept; give one another name");
      }
      for (std::size_t j = 0; j < message.signals.size(); ++j) {
        const Signal& signal = message.signals[j].signal;
        const auto [there, first] =
            signals_.insert_or_assign({message.written_id, signal.name}, SignalAt{i, j});
        if (!first && is_new)
          doubt(signal.line, message.message.name + " has two signals " + signal.name,
                "give one another name");
      }
    }
    for (std::size_t i = 0; i < statements_.document.nodes.size(); ++i)
      nodes_.try_emplace(statements_.document.nodes[i].name, i);
    for (std::size_t i = 0; i < statements_.document.definitions.size(); ++i)
      definitions_[statements_.document.definitions[i].name].push_back(i);
  }
  [[nodiscard]] Message* message_of(const Subject& subject) {
    const auto at = by_id_.find(subject.id);
    return at == by_id_.end() ? nullptr : &statements_.messages[at->second].message;
  }
  [[nodiscard]] SignalStatement* signal_of(const Subject& subject) {
    const auto at = signals_.find({subject.id, subject.name});
    if (at == signals_.end()) return nullptr;
    return &statements_.messages[at->second.message].signals[at->second.signal];
  }
  [[nodiscard]] Node* node_of(const Subject& subject) {
    const auto at = nodes_.find(subject.name);
    return at == nodes_.end() ? nullptr : &statements_.document.nodes[at->second];
  }
  void nothing_there(const Subject& subject, std::string_view statement) {
    std::string what{statement};
    switch (subject.of) {
      case Of::message:
        what += " is of a message " + std::to_string(subject.id);
        break;
      case Of::signal:
        what.append(" is of a signal ")
            .append(subject.name)
            .append(" of message ")
            .append(std::to_string(subject.id));
        break;
      default:
        what.append(" is of a node ").append(subject.name);
    }
    doubt(subject.line, what + ", which is not in the file", "left out");
  }

  // --- statements that refer to others ---

  void comment(CommentStatement& statement) {
    std::string* to = nullptr;
    switch (statement.subject.of) {
      case Of::network:
        to = &statements_.document.comment;
        break;
      case Of::node:
        if (Node* node = node_of(statement.subject)) to = &node->comment;
        break;
      case Of::message:
        if (Message* message = message_of(statement.subject)) to = &message->comment;
        break;
      case Of::signal:
        if (SignalStatement* signal = signal_of(statement.subject)) to = &signal->signal.comment;
        break;
      case Of::variable:
        return;
    }
    if (to == nullptr) return nothing_there(statement.subject, "the comment");
    *to = std::move(statement.text);
  }

  void values(ValuesStatement& statement) {
    if (statement.subject.of == Of::variable) return;
    SignalStatement* signal = signal_of(statement.subject);
    if (signal == nullptr) return nothing_there(statement.subject, "the list of values");
    if (statement.table.empty()) {
      signal->signal.values = std::move(statement.values);
      return;
    }
    for (const ValueTable& table : statements_.document.tables)
      if (table.name == statement.table) {
        signal->signal.values = table.values;
        return;
      }
    doubt(statement.subject.line, "there is no VAL_TABLE_ " + std::string{statement.table}, "left out");
  }

  void number(const NumberStatement& statement) {
    SignalStatement* signal = signal_of(statement.subject);
    if (signal == nullptr) return nothing_there(statement.subject, "the type");
    if (statement.type == 0) return;
    const unsigned width = statement.type == 1 ? 32 : 64;
    if (statement.type == 3 || signal->signal.position.width != width) {
      doubt(statement.subject.line,
            signal->signal.name + " is a floating-point number of " +
                std::to_string(signal->signal.position.width) + " bits",
            "read as an integer: 1 is float32, with 32 bits, and 2 float64, with 64");
      return;
    }
    signal->signal.number = statement.type == 1 ? Signal::Number::float32 : Signal::Number::float64;
  }

  void senders(SendersStatement& statement) {
    Message* message = message_of(statement.subject);
    if (message == nullptr) return nothing_there(statement.subject, "the list of senders");
    for (auto& name : statement.names)
      if (name != message->sender) message->other_senders.push_back(std::move(name));
  }

  void selector(SelectorStatement& statement) {
    SignalStatement* signal = signal_of(statement.subject);
    if (signal == nullptr) return nothing_there(statement.subject, "the selector");
    signal->selector = statement.selector;
    for (const SelectorRange range : statement.ranges) signal->signal.selected.push_back(range);
  }

  /// The name of an ENUM's value, whether it is given by number or by name.
  [[nodiscard]] std::string attribute_text(const AttributeDefinition* definition, std::string text) const {
    if (definition == nullptr || definition->type != AttributeDefinition::Type::enumeration) return text;
    const auto number = base::parse_unsigned(text);
    const auto& names = definition->names;
    if (!number || *number >= names.size() || std::find(names.begin(), names.end(), text) != names.end())
      return text;
    return names[static_cast<std::size_t>(*number)];
  }
  [[nodiscard]] AttributeDefinition* definition(Of of, std::string_view name) noexcept {
    const auto at = definitions_.find(name);
    if (at == definitions_.end()) return nullptr;
    for (const std::size_t i : at->second)
      if (AttributeDefinition& candidate = statements_.document.definitions[i]; candidate.of == of)
        return &candidate;
    return nullptr;
  }
  void defaults() {
    for (auto& statement : statements_.defaults) {
      const auto at = definitions_.find(statement.name);
      if (at != definitions_.end())
        for (const std::size_t i : at->second) {
          AttributeDefinition& candidate = statements_.document.definitions[i];
          candidate.default_text = attribute_text(&candidate, statement.text);
        }
      else if (!is_relation(statement.name))
        doubt(statement.line, "a default of the attribute " + statement.name + ", which is not defined",
              "left out");
    }
  }
  /// BA_DEF_REL_ defines attributes of pairs of objects, which are not read.
  [[nodiscard]] bool is_relation(std::string_view) const noexcept {
    return !statements_.document.unused.empty();
  }

  void attribute(AttributeStatement& statement) {
    const Subject& subject = statement.subject;
    Attribute attribute{statement.name,
                        attribute_text(definition(subject.of, statement.name), statement.text)};
    std::vector<Attribute>* to = nullptr;
    switch (subject.of) {
      case Of::network:
        to = &statements_.document.attributes;
        break;
      case Of::node:
        if (Node* node = node_of(subject)) to = &node->attributes;
        break;
      case Of::message:
        if (Message* message = message_of(subject)) to = &message->attributes;
        break;
      case Of::signal:
        if (SignalStatement* signal = signal_of(subject)) to = &signal->signal.attributes;
        break;
      case Of::variable:
        return;
    }
    if (to == nullptr) return nothing_there(subject, "the attribute " + statement.name);
    std::erase_if(*to, [&](const Attribute& other) { return other.name == attribute.name; });
    to->push_back(std::move(attribute));
  }

  // --- what it means ---

  /// Fields are numbered with 16 bits, one of which stands for none.
  void expect_countable(const MessageStatement& statement) {
    if (statement.signals.size() > most_signals)
      problems_.push_back(
          {statement.message.line,
           statement.message.name + " has " + std::to_string(statement.signals.size()) + " signals",
           "at most " + std::to_string(most_signals) + " in a message"});
  }
  void multiplexing(MessageStatement& statement) {
    auto& signals = statement.signals;
    const auto is_multiplexed = [](const SignalStatement& each) {
      return each.page || !each.selector.empty();
    };
    if (std::none_of(signals.begin(), signals.end(), is_multiplexed)) return;
    std::size_t root = 0;  // the selector that stands above all others
    std::size_t roots = 0;
    std::size_t selectors = 0;
    for (std::size_t i = 0; i < signals.size(); ++i) {
      if (!signals[i].signal.is_selector) continue;
      ++selectors;
      if (signals[i].page) continue;
      ++roots;
      root = i;
    }
    for (std::size_t i = 0; i < signals.size(); ++i) {
      SignalStatement& each = signals[i];
      if (!each.selector.empty()) {
        each.signal.selector = selector_of(statement, each);
        if (!each.signal.selector) return;
      }
      // With several selectors only SG_MUL_VAL_ says which of them.
      if (!each.page || (each.signal.selector && selectors > 1)) continue;
      if (roots != 1)
        doubt(each.signal.line,
              each.signal.name + " of " + statement.message.name +
                  " is there with some value of a selector, and " +
                  (roots == 0 ? "there is none" : "there are several"),
              "read as always there");
      else if (i != root)
        select_by_root(statement.message, signals[root].signal, root, each, selectors);
    }
    expect_no_circle(statement);
  }
  void select_by_root(const Message& message, const Signal& root, std::size_t index, SignalStatement& each,
                      std::size_t selectors) {
    if (selectors > 1)
      doubt(each.signal.line,
            each.signal.name + " does not say which of the selectors of " + message.name + " it is of",
            "read as of " + root.name + "; SG_MUL_VAL_ would say it");
    each.signal.selector = index;
    // SG_MUL_VAL_ may have said it already, in its ranges.
    const SelectorRange own{*each.page, *each.page};
    if (!have_common(each.signal.selected, {own})) each.signal.selected.push_back(own);
  }
  /// The signal that SG_MUL_VAL_ names, or a problem.
  [[nodiscard]] std::optional<std::size_t> selector_of(const MessageStatement& statement,
                                                       const SignalStatement& each) {
    const auto at = signals_.find({statement.written_id, each.selector});
    const bool here = at != signals_.end() && &statements_.messages[at->second.message] == &statement;
    if (here && &statement.signals[at->second.signal] != &each) return at->second.signal;
    problems_.push_back({each.signal.line,
                         "the selector " + std::string{each.selector} + " of " + each.signal.name +
                             " is not in " + statement.message.name,
                         "another signal of the same message"});
    return std::nullopt;
  }
  /// Selectors that select each other would never be there, and a long row of them has no use.
  void expect_no_circle(const MessageStatement& statement) {
    for (const SignalStatement& each : statement.signals) {
      std::size_t above = 0;
      for (auto at = each.signal.selector; at; at = statement.signals[*at].signal.selector) {
        if (++above <= most_nested) continue;
        if (!is_circle(statement, *at))
          problems_.push_back({each.signal.line,
                               each.signal.name + " has more than " + std::to_string(most_nested) +
                                   " selectors one above another",
                               "fewer: files have two or three"});
        else
          problems_.push_back({each.signal.line,
                               "the selectors above " + each.signal.name + " go in a circle",
                               "a selector that is always there above all others"});
        return;
      }
    }
  }

  /// Whether the selectors above this one have no end.
  [[nodiscard]] static bool is_circle(const MessageStatement& statement, std::size_t index) {
    std::size_t above = 0;
    for (std::optional<std::size_t> at = index; at; at = statement.signals[*at].signal.selector)
      if (++above > statement.signals.size()) return true;
    return false;
  }

  /// The value of an attribute, given or by default; empty: none. What is given is taken out.
  [[nodiscard]] std::string take(std::vector<Attribute>& attributes, Of of, std::string_view name) {
    const auto at = std::find_if(attributes.begin(), attributes.end(),
                                 [&](const Attribute& attribute) { return attribute.name == name; });
    if (at != attributes.end()) {
      std::string text = std::move(at->text);
      attributes.erase(at);
      return text;
    }
    const AttributeDefinition* defined = definition(of, name);
    return defined != nullptr && defined->default_text ? *defined->default_text : std::string{};
  }
  [[nodiscard]] static std::optional<base::Decimal> positive(std::string_view text) {
    const auto number = base::parse_decimal(text);
    if (!number || number->digits <= 0) return std::nullopt;
    return *number;
  }

  /// What an attribute's default says of all objects that do not give it becomes an attribute of each, where
  /// it means something that its absence does not.
  void give_default(std::vector<Attribute>& attributes, Of of, std::string_view name,
                    std::string_view absent) {
    const AttributeDefinition* defined = definition(of, name);
    if (defined == nullptr || !defined->default_text || *defined->default_text == absent ||
        defined->default_text->empty())
      return;
    if (std::none_of(attributes.begin(), attributes.end(),
                     [&](const Attribute& attribute) { return attribute.name == name; }))
      attributes.push_back({std::string{name}, *defined->default_text});
  }

  /// A signal that is sent when it changes makes its message come at any time.
  void send_types_of_signals() {
    const AttributeDefinition* defined = definition(Of::signal, "GenSigSendType");
    if (defined == nullptr || !defined->default_text) return;
    const std::string_view usual = *defined->default_text;
    if (!usual.starts_with("On") && !usual.starts_with("IfActive")) return;
    for (auto& statement : statements_.messages)
      for (SignalStatement& each : statement.signals)
        give_default(each.signal.attributes, Of::signal, "GenSigSendType", {});
  }

  void meaning(Message& message) {
    for (const std::string_view name : {"GenMsgStartDelayTime", "GenMsgCycleTimeFast"})
      give_default(message.attributes, Of::message, name, "0");
    give_default(message.attributes, Of::message, "CANFD_BRS", "1");
    message.cycle_ms = positive(take(message.attributes, Of::message, "GenMsgCycleTime"));
    message.delay_ms = positive(take(message.attributes, Of::message, "GenMsgDelayTime"));
    message.send_type = take(message.attributes, Of::message, "GenMsgSendType");
    const std::string format = take(message.attributes, Of::message, "VFrameFormat");
    const bool wide = message.format == Message::Format::extended;
    const bool by_protocol = definition(Of::message, "VFrameFormat") == nullptr && protocol_type() == "J1939";
    if (wide && (format == "J1939PG" || by_protocol)) message.format = Message::Format::j1939;
    const bool is_j1939 = message.format == Message::Format::j1939;
    const bool said = format.size() > 3 && format.substr(format.size() - 3) == "_FD";
    message.fd = said || (message.length > 8 && !is_j1939);
  }
  [[nodiscard]] std::string_view protocol_type() const noexcept {
    for (const Attribute& attribute : statements_.document.attributes)
      if (attribute.name == "ProtocolType") return attribute.text;
    for (const AttributeDefinition& candidate : statements_.document.definitions)
      if (candidate.of == Of::network && candidate.name == "ProtocolType" && candidate.default_text)
        return *candidate.default_text;
    return {};
  }

  /// Names of more than 32 characters stand in attributes. Last, since all else goes by the short ones.
  void long_names() {
    std::unordered_map<std::string, std::string> nodes;
    for (Node& node : statements_.document.nodes) {
      const std::string name = take(node.attributes, Of::node, "SystemNodeLongSymbol");
      if (name.empty()) continue;
      nodes.emplace(node.name, name);
      node.name = name;
    }
    const auto rename = [&](std::string& node) {
      if (const auto at = nodes.find(node); at != nodes.end()) node = at->second;
    };
    const auto has_default = [&](std::string_view name) {
      const AttributeDefinition* defined = definition(Of::signal, name);
      return defined != nullptr && defined->default_text.has_value();
    };
    const bool defaults = has_default("GenSigStartValue") || has_default("SystemSignalLongSymbol");
    for (auto& [message, written_id, signals] : statements_.messages) {
      if (std::string name = take(message.attributes, Of::message, "SystemMessageLongSymbol"); !name.empty())
        message.name = std::move(name);
      rename(message.sender);
      for (auto& sender : message.other_senders) rename(sender);
      for (SignalStatement& each : signals) {
        Signal& signal = each.signal;
        if (!nodes.empty())
          for (auto& receiver : signal.receivers) rename(receiver);
        if (signal.attributes.empty() && !defaults) continue;
        signal.start_value = take(signal.attributes, Of::signal, "GenSigStartValue");
        if (std::string name = take(signal.attributes, Of::signal, "SystemSignalLongSymbol"); !name.empty())
          signal.name = std::move(name);
      }
    }
  }

  // --- what is doubtful about a whole message ---

  void check(const Message& message) {
    for (const Signal& signal : message.signals)
      if (signal.position.bytes() > message.length)
        doubt(signal.line,
              signal.name + " ends in byte " + std::to_string(signal.position.bytes() - 1) + " of " +
                  message.name + ", which has " + std::to_string(message.length) + " bytes",
              "it is there in longer frames only");
    if (message.signals.size() > most_compared || are_apart(message)) return;
    for (std::size_t i = 0; i < message.signals.size(); ++i)
      for (std::size_t j = i + 1; j < message.signals.size(); ++j) {
        const Signal& a = message.signals[i];
        const Signal& b = message.signals[j];
        if (!a.position.overlaps(b.position) || exclude(message, a, b)) continue;
        doubt(b.line, a.name + " and " + b.name + " of " + message.name + " have bits in common",
              "each is read by itself");
        return;
      }
  }
  /// Whether no two signals have a bit in common, whatever their selectors say; not looked for beyond 64
  /// bytes. Most messages are so, and need not be compared signal by signal.
  [[nodiscard]] static bool are_apart(const Message& message) noexcept {
    std::array<std::uint8_t, 64> taken{};
    for (const Signal& signal : message.signals) {
      const unsigned end = signal.position.bytes();
      if (end > taken.size()) return false;
      for (unsigned byte = signal.position.start / 8U; byte < end; ++byte) {
        const std::uint8_t bits = signal.position.bits_in_byte(byte);
        if ((taken[byte] & bits) != 0) return false;
        taken[byte] = static_cast<std::uint8_t>(taken[byte] | bits);
      }
    }
    return true;
  }
  /// Whether there is a selector, of both or above them, by which one is there only without the other.
  [[nodiscard]] static bool exclude(const Message& message, const Signal& a, const Signal& b) {
    const auto above = [&](const Signal* of) {
      return of->selector ? &message.signals[*of->selector] : nullptr;
    };
    for (const Signal* one = &a; one->selector; one = above(one))
      for (const Signal* other = &b; other->selector; other = above(other))
        if (one->selector == other->selector && !have_common(one->selected, other->selected)) return true;
    return false;
  }

  Statements statements_;
  std::vector<Finding>& problems_;
  std::vector<Finding>& doubts_;
  std::vector<bool> replaced_;
  std::unordered_map<std::uint32_t, std::size_t> by_id_;
  std::unordered_map<SignalKey, SignalAt, SignalHash> signals_;
  std::unordered_map<std::string_view, std::size_t> nodes_;
  std::unordered_map<std::string_view, std::vector<std::size_t>>
      definitions_;  ///< of one name: of several kinds
};

}  // namespace

Reading read(std::string_view bytes) {
  Reading reading;
  const auto same = as_utf8(bytes);  // the text must outlive its statements
  const std::string converted = same ? std::string{} : to_utf8(bytes);
  const std::string_view text = same ? *same : std::string_view{converted};
  Statements statements = parse(text, reading.problems, reading.doubts);
  if (reading.problems.empty()) {
    Document document = Resolver{std::move(statements), reading.problems, reading.doubts}.resolve();
    if (reading.problems.empty()) reading.document = std::move(document);
  }
  const auto by_line = [](const Finding& a, const Finding& b) { return a.line < b.line; };
  std::stable_sort(reading.problems.begin(), reading.problems.end(), by_line);
  std::stable_sort(reading.doubts.begin(), reading.doubts.end(), by_line);
  return reading;
}

}  // namespace ocm::dbc
