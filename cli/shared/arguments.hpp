/// How a verb says what it takes on the command line: a thin layer over CLI11, which takes seconds to compile
/// and so is seen by arguments.cpp alone. Handles: they are copied freely and hold as long as their Program.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/shared/option_value.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace ocm::cli {

/// What is wrong on a command line, and what would be right.
struct Misuse {
  std::string what;
  std::string remedy;
};

/// Takes the text of an option's value, or says what is wrong with it: {"not a time", "write 500ms"}.
using TakeValue = std::function<std::optional<Misuse>(const std::string& text)>;

/// An option, a flag or a positional.
class Option {
 public:
  Option(CLI::Option* option, CLI::App* owner) noexcept : option_(option), owner_(owner) {}

  // What it is declared to be; each returns the option itself.
  Option type_name(const std::string& name) const;  ///< for the help: "FILE"
  Option required() const;
  Option excludes(Option other) const;
  Option needs(Option other) const;
  Option one_of(std::initializer_list<const char*> words) const;
  /// What a value of it is, where the verb itself reads the text; looked at in a config file and in the
  /// environment.
  Option takes(Accepted accepted) const;
  Option range(double least, double most) const;
  Option range(unsigned least, unsigned most) const;
  Option positive() const;
  Option environment(const std::string& name) const;
  Option delimiter(char separator) const;
  /// How many values one mention takes: 0, 1.
  Option expected(int least, int most) const;
  /// One value a mention, however often it is mentioned.
  Option one_a_mention() const;
  /// The value that the variable has now is shown as the default.
  Option show_default() const;
  /// Shown as the default, and the value of an option that may stand without one.
  Option default_text(const std::string& text) const;
  /// How usages write a positional, if not by its type: "X|stop [Z]".
  Option in_usage(const std::string& words) const;
  /// One of its names, of an earlier version: it works, but no help shows it.
  Option formerly(const std::string& name) const;

  /// How often the command line has it.
  [[nodiscard]] std::size_t count() const;
  /// Its values there, as they were typed.
  [[nodiscard]] std::vector<std::string> texts() const;

  // What was declared.
  [[nodiscard]] std::vector<std::string> long_names() const;  ///< without --; former ones, too
  [[nodiscard]] std::string name() const;                     ///< as it is typed: "--count"
  [[nodiscard]] std::string usage() const;                    ///< what in_usage said
  [[nodiscard]] std::string description() const;
  [[nodiscard]] std::string type() const;
  [[nodiscard]] bool is_positional() const;
  [[nodiscard]] bool is_option() const;  ///< not (only) a positional
  [[nodiscard]] bool is_hidden() const;
  [[nodiscard]] bool is_required() const;
  [[nodiscard]] bool is_named(const std::string& name) const;   ///< "--spec"
  [[nodiscard]] bool is_former(const std::string& name) const;  ///< whether `formerly` named it, "--watch"
  [[nodiscard]] std::vector<Option> excluded() const;
  [[nodiscard]] std::vector<Option> needed() const;
  [[nodiscard]] int least_values() const;
  [[nodiscard]] int most_values() const;
  [[nodiscard]] const Accepted& accepted() const;

  /// Whether it has a value by now, is declined, or another one that excludes it has a value.
  [[nodiscard]] bool is_decided() const;
  /// What the command line says of this text as its value: "soon: not a time". Of one that it refuses; it
  /// takes any other one.
  [[nodiscard]] std::optional<Misuse> misuse_of(const std::string& text) const;
  /// As if the command line had it, as --key; without a value where it needs none. What is wrong with the
  /// values, after the key: "soon: not a time".
  [[nodiscard]] std::optional<Misuse> give(const std::string& key,
                                           const std::vector<std::string>& values) const;
  /// Decides that it is not given, whatever is read later says.
  void decline() const;

 private:
  CLI::Option* option_;
  CLI::App* owner_;
};

/// A verb, a verb of a verb ("analyse bus"), a group of options, or the program.
class Verb {
 public:
  Verb() noexcept = default;
  explicit Verb(CLI::App* app) noexcept : app_(app) {}
  explicit operator bool() const noexcept { return app_ != nullptr; }
  friend bool operator==(Verb, Verb) = default;

  // What it is declared to take.
  /// "-n,--count" is an option, "file" a positional. What the command line says is written to `value`.
  Option add_option(const std::string& names, std::string& value, const std::string& help) const;
  Option add_option(const std::string& names, std::vector<std::string>& value, const std::string& help) const;
  Option add_option(const std::string& names, std::uint32_t& value, const std::string& help) const;
  Option add_option(const std::string& names, std::uint64_t& value, const std::string& help) const;
  Option add_option(const std::string& names, double& value, const std::string& help) const;
  /// An option of another type, whose text `take` reads.
  Option add_value(const std::string& names, TakeValue take, const std::string& help) const;
  Option add_flag(const std::string& names, bool& value, const std::string& help) const;
  /// Options under a heading of their own, of which at most one may be given.
  Verb add_choice(const std::string& heading, const std::string& help) const;
  /// What the list of verbs says of it, below which heading, and the examples below its options.
  void describe(std::string_view description, std::string_view heading, std::string_view examples) const;
  /// A verb of this verb.
  Verb add_inner_verb(const std::string& name, const std::string& description,
                      std::string_view examples) const;
  Verb alias(const std::string& name) const;
  Verb require_verb() const;
  Verb footer(const std::string& text) const;
  /// What is done when the command line has the verb. What it refuses as wrong usage begins with its name.
  void callback(std::function<void()> run) const;
  /// What is done when the whole command line was read, before any verb.
  void after_parsing(std::function<void()> run) const;

  /// How often this option was given, "--robots".
  [[nodiscard]] std::size_t count(const std::string& option) const;
  /// Whether the command line itself has it, not the environment or a config file: what a person typed is
  /// refused where it has no place, a default is left out there.
  [[nodiscard]] bool is_typed(const std::string& option) const;
  /// An option that was added: "words".
  [[nodiscard]] Option option(const std::string& name) const;

  // What was declared.
  [[nodiscard]] std::string name() const;
  [[nodiscard]] bool is_named(const std::string& name) const;
  [[nodiscard]] std::string description() const;
  [[nodiscard]] std::string footer() const;
  [[nodiscard]] bool is_hidden() const;
  [[nodiscard]] Verb parent() const;       ///< none of the program
  [[nodiscard]] std::string path() const;  ///< "analyse bus"; empty of the program
  [[nodiscard]] std::string help() const;
  /// Options and positionals, those of its groups behind its own.
  [[nodiscard]] std::vector<Option> options() const;
  [[nodiscard]] std::vector<Verb> verbs() const;          ///< hidden ones too
  [[nodiscard]] std::vector<Verb> verbs_for_all() const;  ///< those that the help lists
  [[nodiscard]] Verb called() const;                      ///< the one of its verbs that the command line has
  [[nodiscard]] std::vector<Verb> choices() const;        ///< of add_choice
  /// Words of the command line that nothing took.
  [[nodiscard]] std::vector<std::string> left_over() const;

 private:
  CLI::App* app_ = nullptr;
};

/// The whole of it.
class Program {
 public:
  /// `beginning` is what a command line without a verb gets to read.
  Program(const std::string& name, const std::string& description, const std::string& version,
          const std::string& footer, std::string beginning);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  [[nodiscard]] Verb root() noexcept;
  /// What a verb speaks of: the manual speaks of all.
  enum class About : bool { itself, all_verbs };
  /// In the order of the help. `declare` says what the verb is and takes, when that is asked for: a command
  /// line has one verb, and to declare all of them would be half of a start.
  void add_verb(std::string_view name, About about, std::function<void(Verb)> declare);

  enum class Outcome { done, told, refused };  ///< told: --help or --version
  /// Reads the command line and runs the verb's callback. Prints help, and what is wrong.
  Outcome run(int argc, char** argv);

 private:
  std::string beginning_;
  std::unique_ptr<CLI::App> app_;
};

}  // namespace ocm::cli
