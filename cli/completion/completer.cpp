#include "cli/completion/completer.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "ocm/transport/interfaces.hpp"
#include "ocm/transport/virtual_bus.hpp"

#include "cli/shared/operator_link.hpp"
#include "cli/words/colour.hpp"
#include "cli/words/topics.hpp"
#include "generator/targets/target.hpp"
#include "generator/text/messages.hpp"
#include "sim/worlds/texts.hpp"

namespace ocm::cli {
namespace {

/// Of the verb, else of those that it is a verb of.
std::optional<Option> find_option(Verb verb, const std::string& name) {
  std::optional<Option> found;
  for (; verb && !found; verb = verb.parent())
    for (const Option& option : verb.options())
      if (option.is_option() && option.is_named(name)) found = option;
  return found;
}

bool wants_value(const Option& option) {
  return option.least_values() > 0;
}

Verb find_verb(Verb of, const std::string& name) {
  for (const Verb verb : of.verbs())
    if (verb.is_named(name)) return verb;
  return {};
}

/// The command line so far.
struct Line {
  Verb verb;                             ///< the innermost
  std::vector<std::string> positionals;  ///< of it
  std::optional<Option> waiting;         ///< for its value, which is the word being typed
  bool only_positionals = false;         ///< after --
};

Line read_line(Verb program, Session& session, const std::vector<std::string>& words) {
  Line line{program, {}, std::nullopt, false};
  const auto heed = [&session](const Option& option, const std::string& value) {
    if (option.is_named("--spec")) session.spec_files.push_back(value);
    if (option.is_named("--bus")) session.bus_name = value;
  };
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const std::string& word = words[i];
    if (line.waiting) {
      heed(*line.waiting, word);
      line.waiting.reset();
    } else if (line.only_positionals || word.size() < 2 || word.front() != '-') {
      const Verb verb = line.positionals.empty() ? find_verb(line.verb, word) : Verb{};
      if (verb)
        line.verb = verb;
      else
        line.positionals.push_back(word);
    } else if (word == "--") {
      line.only_positionals = true;
    } else if (const std::size_t equals = word.find('='); equals != std::string::npos) {
      if (const auto option = find_option(line.verb, word.substr(0, equals)))
        heed(*option, word.substr(equals + 1));
    } else if (const auto option = find_option(line.verb, word); option && wants_value(*option)) {
      line.waiting = option;
    }
  }
  return line;
}

class Completer {
 public:
  Completer(Verb program, Session& session, std::string typed)
      : program_(program), session_(session), typed_(std::move(typed)) {}

  Completion take() { return std::move(completion_); }
  void files() { completion_.files = true; }
  void add(std::string_view word, std::string_view what = {}) {
    if (std::string_view{prefix_ + std::string{word}}.starts_with(typed_))
      completion_.candidates.push_back({prefix_ + std::string{word}, std::string{what}});
  }
  /// What precedes every candidate: "--priority=".
  void set_prefix(std::string prefix) { prefix_ = std::move(prefix); }

  void verbs_of(Verb of) {
    for (const Verb verb : of.verbs_for_all()) add(verb.name(), verb.description());
  }

  void options_of(Verb verb) {
    for (; verb; verb = verb.parent())
      for (const Option& option : verb.options())
        if (const auto names = option.long_names(); !option.is_hidden() && !names.empty())
          add("--" + names.front(), option.description());
  }

  enum class Of { sensors, settable, all };
  void topics(Of which, std::string_view tail = {}) {
    for (const auto& topic : session_.catalogue().topics) {
      if (which == Of::sensors && topic.kind != protocol::Kind::sensor) continue;
      if (which == Of::settable && topic.kind == protocol::Kind::sensor) continue;
      const std::string board{session_.catalogue().board_name(topic)};
      const std::string what =
          std::string{protocol::name(topic.kind)} + (board.empty() ? "" : " of ") + board;
      add(std::string{topic.name} + std::string{tail}, what);
      for (const auto alias : topic.aliases) add(std::string{alias} + std::string{tail}, what);
    }
  }

  void fields(const std::string& name) {
    const protocol::Topic* topic = words::find_topic(session_.catalogue(), name);
    if (topic == nullptr) return;
    for (const auto& frame : topic->frames)
      for (const auto& field : frame.fields) {
        add(std::string{field.name} + "=", field.unit);
        for (const auto& value : field.values)
          if (!field.flags) add(std::string{field.name} + "=" + std::string{value.name});
      }
  }

  void priorities() {
    for (const auto priority : generate::priorities) add(protocol::name(priority));
  }

  void buses() {
    for (const auto& interface : transport::can_interfaces())
      add(interface.name, interface.up ? "up" : "down");
    add("sim",
        transport::VirtualBus::running() ? "the running simulator" : "the simulator, which does not run");
    add("slcan:", "a serial adapter, as slcan:/dev/ttyACM0@500k");
  }

  /// What the declaration of an option or positional says of its values.
  void values_of(const Option& option) {
    if (option.is_named("--bus")) return buses();
    if (option.is_named("--priority")) return priorities();
    for (const std::string& word : option.accepted().words) add(word);
    if (!option.accepted().words.empty()) return;
    const std::string type = option.type();
    // Without a type of its own a positional says by its name what it is: FILE, but not words.
    const std::string name = option.name();
    const bool telling = std::any_of(name.begin(), name.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
    if (!type.empty() && type != "TEXT")
      words_of(type);
    else if (option.is_positional() && telling)
      words_of(name);
  }

  void positional(const Line& line) {
    const std::string verb = line.verb.name();
    const std::size_t index = line.positionals.size();
    if (verb == "publish" || verb == "once") return index == 0 ? topics(Of::sensors) : void();
    if (verb == "stop") {
      add("all", "motors to zero, then every sensor");
      return topics(Of::all);
    }
    if (verb == "set") return index == 0 ? topics(Of::settable) : fields(line.positionals[0]);
    if (verb == "led") return index == 0 ? lights() : index == 1 ? colours() : void();
    if (verb == "drive") return add("stop");
    std::size_t number = 0;
    for (const Option& option : line.verb.options()) {
      if (!option.is_positional()) continue;
      const bool many = option.most_values() > 1;
      if (number++ == index || (many && number <= index + 1)) values_of(option);
    }
  }

 private:
  /// "FILE|BOARD", "host|qemu", "[TOPIC ...]": words in capitals are placeholders, others are literal.
  void words_of(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('|'), text.size());
      word_of(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }

  void word_of(std::string_view word) {
    const auto names = [&](std::string_view what) { return word.find(what) != std::string_view::npos; };
    if (names("TOPIC")) return topics(Of::all);
    if (names("FIELD") || names("CONDITION")) return all_fields();
    if (names("VERB")) return verbs_of(program_);
    if (names("FILE") || names("FOLDER") || names("SCRIPT") || names("LOG")) return files();
    if (names("BOARD")) return boards();
    if (names("WORLD")) return worlds();
    if (names("BUS")) return buses();
    if (names("RATE")) return topics(Of::sensors, "=");
    if (names("CONFIGURATION")) return configurations();
    if (names("TARGET")) {
      for (const auto& target : generate::targets()) add(target.name, target.description);
      return;
    }
    const bool literal =
        std::all_of(word.begin(), word.end(), [](char c) { return (c >= 'a' && c <= 'z') || c == '-'; });
    if (literal && !word.empty()) add(word);
  }

  /// Engine.Speed, odometry.velocity.x; a condition begins with one.
  void all_fields() {
    for (const auto& topic : session_.catalogue().topics)
      for (const auto& layout : topic.frames)
        for (const auto& field : layout.values())
          add(fmt::format("{}.{}{}{}", topic.name, layout.name, layout.name.empty() ? "" : ".", field.name),
              field.unit);
  }
  void worlds() {
    for (const auto& world : sim::worlds::world_texts()) add(world.name, "built in");
    files();
  }
  /// Where a request would lead the operator that runs, of a bus that was named or of any. One that is
  /// stopped takes a second.
  void configurations() {
    std::vector<std::string> buses;
    if (!session_.bus_name.empty()) {
      buses.push_back(session_.bus_name);
    } else {
      for (const auto& interface : transport::can_interfaces()) buses.push_back(interface.name);
      buses.emplace_back("sim");
    }
    for (const std::string& bus : buses) {
      const auto link = connect_operator(bus, "completion");
      if (!link || *link == nullptr) continue;
      const std::string answer = (*link)->ask(operator_ways).text;
      std::string_view rest = answer;
      const auto next_line = [&rest] {
        const std::size_t size = std::min(rest.find('\n'), rest.size());
        const std::string_view line = rest.substr(0, size);
        rest.remove_prefix(std::min(size + 1, rest.size()));
        return line;
      };
      const std::string from = fmt::format("from {}", next_line());
      while (!rest.empty()) add(next_line(), from);
    }
  }
  void boards() {
    for (const auto& board : session_.catalogue().boards) add(board.name, board.mcu);
  }
  void lights() {
    for (const auto& topic : session_.catalogue().topics)
      if (topic.role == protocol::Role::light && topic.instance != 0)
        add(std::to_string(topic.instance), topic.name);
    add("all");
  }
  void colours() {
    for (const auto& colour : words::named_colours) add(colour.name);
  }

  Verb program_;
  Session& session_;
  std::string typed_;
  std::string prefix_;
  Completion completion_;
};

}  // namespace

Completion complete(Verb program, Session& session, const std::vector<std::string>& words) {
  const Line line = read_line(program, session, words);
  const std::string typed = words.empty() ? "" : words.back();
  Completer completer{program, session, typed};
  if (line.waiting) {
    completer.values_of(*line.waiting);
  } else if (!line.only_positionals && typed.starts_with('-')) {
    const std::size_t equals = typed.find('=');
    const auto option =
        equals == std::string::npos ? std::nullopt : find_option(line.verb, typed.substr(0, equals));
    if (option) {
      completer.set_prefix(typed.substr(0, equals + 1));
      completer.values_of(*option);
    } else {
      completer.options_of(line.verb);
    }
  } else {
    const bool helps = line.verb == program && line.positionals == std::vector<std::string>{"help"};
    if (line.positionals.empty() || helps) completer.verbs_of(line.verb);
    completer.positional(line);
  }
  return completer.take();
}

}  // namespace ocm::cli
