#include "cli/shared/arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/shared/folding.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/misuse.hpp"
#include "cli/shared/option_value.hpp"
#include "cli/shared/terminal.hpp"
#include "cli/shared/usage.hpp"
#include "cli/words/suggestion.hpp"

namespace ocm::cli {
namespace {

/// The help in the tool's words: usages with the names of positionals, options without the names that they
/// had in earlier versions.
class HelpText : public CLI::Formatter {
 public:
  void hide(const CLI::Option* option, const std::string& name) { former_.emplace(option, name); }
  [[nodiscard]] bool hides(const CLI::Option* option, const std::string& name) const {
    return former_.count({option, name}) != 0;
  }

  std::string make_usage(const CLI::App* app, std::string) const override {
    return "Usage: " + usage(Verb{const_cast<CLI::App*>(app)}) + "\n";  // a handle that only reads
  }

  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    if (is_positional) return positional(Option{const_cast<CLI::Option*>(option), nullptr});
    std::string names;
    const auto add = [&](const std::string& name) {
      if (!hides(option, name)) names += (names.empty() ? "" : ",") + name;
    };
    for (const auto& name : option->get_snames()) add("-" + name);
    for (const auto& name : option->get_lnames()) add("--" + name);
    return names;
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_positional()) return {};
    std::string text;
    if (option->get_type_size() != 0) {
      const std::string type = option->get_type_name();
      if (!type.empty()) text += " " + value_of(Option{const_cast<CLI::Option*>(option), nullptr});
      if (!option->get_default_str().empty()) text += "=" + option->get_default_str();
      if (const auto range = type.find(':');
          range != std::string::npos && type.find('{') == std::string::npos)
        text += " (" + type.substr(range + 1) + ")";
      if (option->get_expected_max() == CLI::detail::expected_max_vector_size && !text.ends_with(" ..."))
        text += " ...";
    }
    if (!option->get_envname().empty()) text += " (" + option->get_envname() + ")";
    const auto add_others = [&text](std::string_view how, const std::set<CLI::Option*>& options) {
      std::string names;
      for (CLI::Option* other : options)
        names += (names.empty() ? "" : ", ") + written(Option{other, nullptr});
      if (!names.empty()) text += fmt::format(" ({} {})", how, names);
    };
    add_others("with", option->get_needs());
    add_others("not with", option->get_excludes());
    return text;
  }

  /// The examples, and where the options are that every verb takes.
  std::string make_footer(const CLI::App* app) const override {
    const std::string footer = CLI::Formatter::make_footer(app);
    const CLI::App* root = app;
    while (root->get_parent() != nullptr) root = root->get_parent();
    if (root == app || footer.empty()) return footer;
    return fmt::format("Every verb takes the bus, the spec and more: `{} help` lists these options.\n\n{}",
                       root->get_name(), footer);
  }

  /// Options of add_choice: as the other groups, below a heading that says that they exclude each other.
  std::string make_expanded(const CLI::App* choice) const override {
    if (!choice->get_name().empty() || choice->get_group().empty())
      return CLI::Formatter::make_expanded(choice);
    std::string text =
        fmt::format("\n{}, at most one ({}):\n", choice->get_group(), choice->get_description());
    for (const CLI::Option* option : choice->get_options())
      if (!option->get_group().empty() && option != choice->get_help_ptr())
        text += make_option(option, false);
    return text;
  }

 private:
  std::set<std::pair<const CLI::Option*, std::string>> former_;
};

HelpText& help_text(CLI::App& app) {
  return dynamic_cast<HelpText&>(*app.get_formatter());
}

/// What a check says of a text: in CLI11 it is one string, which `split` parts again.
std::string wrong(const std::string& text, std::string_view what, std::string_view remedy) {
  return fmt::format("{}: {}\n{}", text, what, remedy);
}

Misuse split(const std::string& text) {
  const std::size_t end = text.find('\n');
  return {text.substr(0, end), end == std::string::npos ? "" : text.substr(end + 1)};
}

/// Before CLI11 converts a text, so that the error is in our words.
CLI::Option* add_check(CLI::Option* option, std::string_view description,
                       std::function<std::string(const std::string&)> check) {
  return option->check(CLI::Validator{[check = std::move(check)](std::string& text) { return check(text); },
                                      std::string{description}});
}

/// Decimal, or hexadecimal behind 0x, and nothing else.
template <class Number>
std::errc read_whole(std::string_view text, Number& number) {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  const char* const all = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), all, number, hexadecimal ? 16 : 10);
  return error != std::errc::invalid_argument && end != all ? std::errc::invalid_argument : error;
}

template <class Number>
CLI::Option* only_numbers(CLI::Option* option, std::string_view what, std::string_view remedy) {
  if (std::is_integral_v<Number>)  // CLI11 would read 010 as C++ does: 8
    option->transform(CLI::Validator{[](std::string& text) {
                                       text = without_leading_zeros(text);
                                       return std::string{};
                                     },
                                     ""});
  return add_check(option, "", [what, remedy](const std::string& text) {
    Number number{};
    const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
    bool taken = false, too_large = digits;
    if constexpr (std::is_unsigned_v<Number>) {  // of 64 bits CLI11 looks neither at signs nor at the size
      const auto error = read_whole(text, number);
      taken = error == std::errc{};
      too_large = error == std::errc::result_out_of_range;
    } else {
      taken = CLI::detail::lexical_cast(text, number);
    }
    if (taken) return std::string{};
    return too_large ? wrong(text, "too large",
                             fmt::format("the greatest is {}", std::numeric_limits<Number>::max()))
                     : wrong(text, what, remedy);
  });
}

void add_range(CLI::Option* option, double least, double most) {
  const std::string range = fmt::format("{} to {}", least, most);
  add_check(option, range, [=](const std::string& text) {
    double number = 0;
    const bool in_range = CLI::detail::lexical_cast(text, number) && number >= least && number <= most;
    return in_range ? std::string{} : wrong(text, "out of range", "write a number from " + range);
  });
}

/// What is wrong with the value of an option, named as the command line has it.
Misuse misuse_of(const CLI::ParseError& error) {
  const std::string text = error.what();
  const std::string name = text.substr(0, text.find(':'));
  if (error.get_name() == "ValidationError") {
    auto misuse = split(text.substr(std::min(text.size(), name.size() + 2)));
    return {name + " " + misuse.what, misuse.remedy};
  }
  if (error.get_name() == "ArgumentMismatch" && text.find("At Most") != std::string::npos)
    return {name + " is given more than once", "give it once"};
  if (error.get_name() == "ArgumentMismatch") return {"missing value for " + name, ""};
  return {text, ""};
}
/// The program, which knows of each of its options what CLI11 does not keep.
struct Root : CLI::App {
  using CLI::App::App;
  std::map<const CLI::Option*, Accepted> accepted;
  std::set<const CLI::Option*> given;     ///< by the environment or a config file
  std::set<const CLI::Option*> declined;  ///< by `false` there

  struct Each {
    std::string name;
    Program::About about;
    std::function<void(Verb)> declare;
    CLI::App* app = nullptr;  ///< nullptr: it is not declared yet
  };
  std::vector<Each> verbs;  ///< in the order of the help
};

Root& root_of(CLI::App* app) {
  while (app->get_parent() != nullptr) app = app->get_parent();
  return static_cast<Root&>(*app);  // a Verb is of a Program, whose root is one
}

Verb declared(Root& root, Root::Each& verb) {
  if (verb.app == nullptr) {
    verb.app = root.add_subcommand(verb.name, "");
    verb.app->fallthrough();
    verb.declare(Verb{verb.app});
  }
  return Verb{verb.app};
}

Option declare(CLI::Option* option, CLI::App* app, Accepted accepted) {
  root_of(app).accepted[option] = std::move(accepted);
  return {option, app};
}

constexpr double no_bound = std::numeric_limits<double>::infinity();

/// Groups of options are applications without a name.
bool is_verb(const CLI::App* app) {
  return !app->get_name().empty();
}

void collect_options(CLI::App& app, std::vector<Option>& options) {
  for (CLI::Option* option : app.get_options()) options.emplace_back(option, &app);
  for (CLI::App* group : app.get_subcommands([](const CLI::App* each) { return !is_verb(each); }))
    collect_options(*group, options);
}

std::vector<Option> handles(const std::set<CLI::Option*>& found, CLI::App* owner) {
  std::vector<Option> options;
  for (CLI::Option* option : found) options.emplace_back(option, owner);
  return options;
}

std::vector<Verb> handles(const std::vector<CLI::App*>& apps) {
  std::vector<Verb> verbs;
  for (CLI::App* app : apps) verbs.emplace_back(app);
  return verbs;
}

/// A help as wide as the terminal is.
void print_help(const std::string& text) {
  const std::size_t columns = columns_of_output();
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    std::fputs((folded_help(line, columns) + '\n').c_str(), stdout);
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
}

/// "-.1m/s" is a number and not an option: "-0.1m/s" is what the parser of options takes for one.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> result;
  // `help drive` is `drive --help`, as in other programs with verbs; `help help` is help.
  int first = 1;
  while (first < argc && argv[first] == std::string_view{"help"}) ++first;
  if (first > 1) result.emplace_back("--help");
  for (int i = argc - 1; i >= first; --i) {  // CLI11 takes them from the back
    std::string word = argv[i];
    if (word.size() > 2 && word.starts_with("-.") && word[2] >= '0' && word[2] <= '9') word.insert(1, "0");
    result.push_back(std::move(word));
  }
  return result;
}

}  // namespace

// --- option ------------------------------------------------------------------------------------------------

Option Option::type_name(const std::string& name) const {
  option_->type_name(name);
  return *this;
}

Option Option::required() const {
  option_->required();
  return *this;
}

Option Option::excludes(Option other) const {
  option_->excludes(other.option_);
  return *this;
}

Option Option::needs(Option other) const {
  option_->needs(other.option_);
  return *this;
}

Option Option::one_of(std::initializer_list<const char*> words) const {
  const std::vector<std::string> known{words.begin(), words.end()};
  add_check(option_, "{" + CLI::detail::join(known, ",") + "}", [known](const std::string& text) {
    if (std::find(known.begin(), known.end(), text) != known.end()) return std::string{};
    return wrong(text, "unknown value",
                 words::suggestion(text, std::vector<std::string_view>(known.begin(), known.end())));
  });
  return takes(accepted_words(known));
}

Option Option::takes(Accepted accepted) const {
  return declare(option_, owner_, std::move(accepted));
}

Option Option::range(double least, double most) const {
  add_range(option_, least, most);
  return takes(accepted_number(least, most, fmt::format("a number from {} to {}", least, most)));
}

Option Option::range(unsigned least, unsigned most) const {
  add_range(option_, least, most);
  return takes(accepted_whole(least, most, fmt::format("a whole number from {} to {}", least, most)));
}

Option Option::positive() const {
  // Before what any number is asked: a sign alone would be no whole number.
  option_->transform(
      CLI::Validator{[](std::string& text) {
                       double number = 0;
                       const bool whole = text.find_first_not_of("-0123456789") == std::string::npos;
                       return !whole || !CLI::detail::lexical_cast(text, number) || number > 0
                                  ? std::string{}
                                  : wrong(text, "not above zero", "write a number above zero, such as 10");
                     },
                     ""});
  return takes(
      accepted_whole(1, std::numeric_limits<std::uint64_t>::max(), "a whole number that is at least 1"));
}

Option Option::environment(const std::string& name) const {
  option_->envname(name);
  return *this;
}

Option Option::delimiter(char separator) const {
  option_->delimiter(separator);
  return *this;
}

Option Option::expected(int least, int most) const {
  option_->expected(least, most);
  return *this;
}

Option Option::one_a_mention() const {
  option_->allow_extra_args(false);
  return *this;
}

Option Option::show_default() const {
  option_->capture_default_str();
  return *this;
}

Option Option::default_text(const std::string& text) const {
  option_->default_str(text);
  return *this;
}

Option Option::in_usage(const std::string& words) const {
  option_->option_text(words);
  return *this;
}

Option Option::formerly(const std::string& name) const {
  help_text(*owner_).hide(option_, name);
  return *this;
}

std::size_t Option::count() const {
  return option_->count();
}

std::vector<std::string> Option::long_names() const {
  return option_->get_lnames();
}

std::string Option::name() const {
  return option_->get_name();
}

std::string Option::usage() const {
  return option_->get_option_text();
}

std::string Option::description() const {
  return option_->get_description();
}

std::string Option::type() const {
  return option_->get_type_name();
}

bool Option::is_positional() const {
  return option_->get_positional();
}

bool Option::is_option() const {
  return option_->nonpositional();
}

bool Option::is_hidden() const {
  return option_->get_group().empty();
}

bool Option::is_required() const {
  return option_->get_required();
}

bool Option::is_named(const std::string& name) const {
  return option_->check_name(name);
}

bool Option::is_former(const std::string& name) const {
  return help_text(*owner_).hides(option_, name);
}

std::vector<Option> Option::excluded() const {
  return handles(option_->get_excludes(), owner_);
}

std::vector<Option> Option::needed() const {
  return handles(option_->get_needs(), owner_);
}

std::vector<std::string> Option::texts() const {
  return option_->results();
}

int Option::least_values() const {
  return option_->get_items_expected_min();
}

int Option::most_values() const {
  return option_->get_items_expected_max();
}

const Accepted& Option::accepted() const {
  return root_of(owner_).accepted[option_];
}

bool Option::is_decided() const {
  if (option_->count() > 0 || root_of(owner_).declined.count(option_) != 0) return true;
  for (const CLI::Option* other : option_->get_excludes())
    if (other->count() > 0) return true;
  if (is_verb(owner_)) return false;
  for (const CLI::Option* other : owner_->get_options())
    if (other->count() > 0) return true;
  return false;
}

std::optional<Misuse> Option::misuse_of(const std::string& text) const {
  try {
    std::string value = text;  // what a check changes, as leading zeros, the next one reads so
    for (int i = 0;; ++i) {
      if (const std::string error = (*option_->get_validator(i))(value); !error.empty()) return split(error);
    }
  } catch (const CLI::OptionNotFound&) {  // that was the last one
    return {};
  }
}

namespace {
/// False, as CLI11 reads a flag's value. What is no truth value is not.
bool is_off(const std::string& flag) {
  try {
    return CLI::detail::to_flag_value(flag) < 0;
  } catch (const std::logic_error&) {
    return false;
  }
}
}  // namespace

std::optional<Misuse> Option::give(const std::string& key, const std::vector<std::string>& values) const {
  try {
    if (option_->get_items_expected_max() == 0 ||
        (option_->get_items_expected_min() == 0 && values.empty())) {
      const std::string flag = option_->get_flag_value(key, values.empty() ? "" : values.front());
      if (is_off(flag)) {  // as if it were not there: what it excludes can be given
        decline();
        return {};
      }
      option_->add_result(flag);
    } else {
      option_->add_result(values);
    }
    option_->run_callback();
    root_of(owner_).given.insert(option_);
  } catch (const CLI::ParseError& error) {
    option_->clear();
    Misuse misuse = cli::misuse_of(error);
    if (const std::string before = name() + " "; misuse.what.starts_with(before))
      misuse.what.erase(0, before.size());
    return misuse;
  }
  return {};
}

void Option::decline() const {
  root_of(owner_).declined.insert(option_);
}

// --- verb --------------------------------------------------------------------------------------------------

Option Verb::add_option(const std::string& names, std::string& value, const std::string& help) const {
  return {app_->add_option(names, value, help), app_};
}

Option Verb::add_option(const std::string& names, std::vector<std::string>& value,
                        const std::string& help) const {
  return {app_->add_option(names, value, help), app_};
}

Option Verb::add_option(const std::string& names, std::uint32_t& value, const std::string& help) const {
  auto* option = app_->add_option(names, value, help);
  only_numbers<std::uint32_t>(option, "not a whole number", "write a whole number, such as 10");
  return declare(option, app_,
                 accepted_whole(0, std::numeric_limits<std::uint32_t>::max(), "a whole number"));
}

Option Verb::add_option(const std::string& names, std::uint64_t& value, const std::string& help) const {
  auto* option = app_->add_option(names, value, help);
  only_numbers<std::uint64_t>(option, "not a whole number", "write a whole number, such as 10");
  return declare(option, app_,
                 accepted_whole(0, std::numeric_limits<std::uint64_t>::max(), "a whole number"));
}

Option Verb::add_option(const std::string& names, double& value, const std::string& help) const {
  auto* option = app_->add_option(names, value, help);
  only_numbers<double>(option, "not a number", "write a number, such as 1.5");
  return declare(option, app_, accepted_number(-no_bound, no_bound, "a number"));
}

Option Verb::add_value(const std::string& names, TakeValue take, const std::string& help) const {
  // CLI11 checks each text once, before it would convert it: here the check is the conversion.
  auto* option = app_->add_option_function<std::string>(
      names, [](const std::string&) {}, help);
  add_check(option, "", [take = std::move(take), declared = Option{option, app_}](const std::string& text) {
    const auto misuse = take(text);
    if (!misuse) return std::string{};
    // Of one or two characters any short word is near: 4 is no misspelt 0.
    const std::string_view near =
        text.size() < 3 ? std::string_view{} : words::nearest(text, declared.accepted().words);
    return wrong(text, misuse->what, near.empty() ? misuse->remedy : fmt::format("did you mean '{}'?", near));
  });
  return {option, app_};
}

Option Verb::add_flag(const std::string& names, bool& value, const std::string& help) const {
  auto* option = app_->add_flag(names, value, help);
  add_check(option, "", [](const std::string& text) {
    // What CLI11 takes; of "150ms" it would take the number.
    constexpr std::string_view known[] = {"true", "false", "on", "off", "yes", "no",
                                          "y",    "n",     "t",  "f",   "1",   "0"};
    return std::find(std::begin(known), std::end(known), CLI::detail::to_lower(text)) != std::end(known)
               ? std::string{}
               : wrong(text, "neither true nor false", "a flag takes no value, or true or false");
  });
  return declare(option, app_, accepted_truth());
}

Verb Verb::add_choice(const std::string& heading, const std::string& help) const {
  auto* group = app_->add_option_group(heading, help);
  group->require_option(0, 1);
  return Verb{group};
}

void Verb::describe(std::string_view description, std::string_view heading, std::string_view examples) const {
  app_->description(std::string{description});
  app_->group(std::string{heading});
  app_->footer("Examples:\n" + std::string{examples});
}

Verb Verb::add_inner_verb(const std::string& name, const std::string& description,
                          std::string_view examples) const {
  auto* verb = app_->add_subcommand(name, description);
  verb->group("Verbs");
  verb->footer("Examples:\n" + std::string{examples});
  verb->fallthrough();
  return Verb{verb};
}

Verb Verb::alias(const std::string& name) const {
  app_->alias(name);
  return *this;
}

Verb Verb::require_verb() const {
  app_->require_subcommand(1);
  return *this;
}

Verb Verb::footer(const std::string& text) const {
  app_->footer(text);
  return *this;
}

void Verb::callback(std::function<void()> run) const {
  app_->callback([verb = *this, run = std::move(run)] {
    speak_for(verb.path());
    run();
  });
}

void Verb::after_parsing(std::function<void()> run) const {
  app_->parse_complete_callback(std::move(run));
}

namespace {

/// One that was added, of this verb or of a group of its options. As CLI::App::get_option, which may not
/// throw where memory is short: it is noexcept inside, and copies names.
CLI::Option* find_option(CLI::App& app, const std::string& name) {
  for (CLI::Option* const each : app.get_options())
    if (each->check_name(name)) return each;
  for (CLI::App* const group : app.get_subcommands([](const CLI::App*) { return true; }))
    if (group->get_name().empty())
      if (CLI::Option* const found = find_option(*group, name)) return found;
  return nullptr;
}

CLI::Option& known_option(CLI::App& app, const std::string& name) {
  CLI::Option* const found = find_option(app, name);
  if (found == nullptr) throw CLI::OptionNotFound(name);
  return *found;
}

}  // namespace

std::size_t Verb::count(const std::string& option) const {
  return known_option(*app_, option).count();
}

bool Verb::is_typed(const std::string& option) const {
  const CLI::Option& found = known_option(*app_, option);
  return found.count() != 0 && root_of(app_).given.count(&found) == 0;
}

Option Verb::option(const std::string& name) const {
  return {&known_option(*app_, name), app_};
}

std::string Verb::name() const {
  return app_->get_name();
}

bool Verb::is_named(const std::string& name) const {
  return app_->check_name(name);
}

std::string Verb::description() const {
  return app_->get_description();
}

std::string Verb::footer() const {
  return app_->get_footer();
}

bool Verb::is_hidden() const {
  return app_->get_group().empty();
}

Verb Verb::parent() const {
  return Verb{app_->get_parent()};
}

std::string Verb::path() const {
  if (!parent()) return {};
  const std::string before = parent().path();
  return before.empty() ? name() : before + " " + name();
}

std::string Verb::help() const {
  static_cast<void>(verbs());  // declares them: the help lists all
  // Not App::help, which shows that of the verb that was called.
  return app_->get_formatter()->make_help(app_, "", CLI::AppFormatMode::Normal);
}

std::vector<Option> Verb::options() const {
  std::vector<Option> found;
  collect_options(*app_, found);
  return found;
}

std::vector<Verb> Verb::verbs() const {
  if (parent()) return handles(app_->get_subcommands([](const CLI::App* each) { return is_verb(each); }));
  Root& root = root_of(app_);
  std::vector<Verb> all;
  for (Root::Each& each : root.verbs) all.push_back(declared(root, each));
  return all;
}

std::vector<Verb> Verb::verbs_for_all() const {
  auto shown = verbs();
  std::erase_if(shown, [](Verb each) { return each.is_hidden(); });
  return shown;
}

Verb Verb::called() const {
  for (CLI::App* each : app_->get_subcommands())
    if (is_verb(each)) return Verb{each};
  return {};
}

std::vector<Verb> Verb::choices() const {
  return handles(app_->get_subcommands([](const CLI::App* each) { return !is_verb(each); }));
}

std::vector<std::string> Verb::left_over() const {
  auto words = app_->remaining(true);
  words.erase(std::remove(words.begin(), words.end(), "--"), words.end());
  return words;
}

// --- program -----------------------------------------------------------------------------------------------

namespace {

/// The verb of a command line, the last word of which is the first of `words`; nullptr: it has none, or what
/// stands before it is no option of the program.
Root::Each* verb_among(Root& root, const std::vector<std::string>& words) {
  for (auto word = words.rbegin(); word != words.rend(); ++word) {
    if (word->size() < 2 || word->front() != '-') {
      const auto found = std::find_if(root.verbs.begin(), root.verbs.end(),
                                      [&](const Root::Each& each) { return each.name == *word; });
      return found == root.verbs.end() ? nullptr : &*found;
    }
    const std::string name = word->substr(0, word->find('='));
    const CLI::Option* const option = find_option(root, name);
    if (option == nullptr) return nullptr;
    const int least = option->get_items_expected_min();
    if (option->get_allow_extra_args() && least != option->get_items_expected_max()) return nullptr;
    const int values = name == *word ? least : 0;
    if (words.rend() - word <= values) return nullptr;
    word += values;
  }
  return nullptr;
}

}  // namespace

Program::Program(const std::string& name, const std::string& description, const std::string& version,
                 const std::string& footer, std::string beginning)
    : beginning_(std::move(beginning)), app_(std::make_unique<Root>(description, name)) {
  app_->formatter(std::make_shared<HelpText>());       // verbs take over that of their program
  app_->set_help_flag("-h,--help", "show this help");  // so do they its options
  app_->set_version_flag("--version", version, "show the version");
  app_->require_subcommand(1);
  app_->footer(footer);
}

Program::~Program() = default;

Verb Program::root() noexcept {
  return Verb{app_.get()};
}

void Program::add_verb(std::string_view name, About about, std::function<void(Verb)> declare) {
  root_of(app_.get()).verbs.push_back({std::string{name}, about, std::move(declare)});
}

Program::Outcome Program::run(int argc, char** argv) {
  if (const auto misuse = empty_word({argv + std::min(argc, 1), argv + argc})) {
    complain({misuse->what, misuse->remedy});
    return Outcome::refused;
  }
  auto words = words_of(argc, argv);
  Root& all = root_of(app_.get());
  if (Root::Each* const verb = verb_among(all, words); verb != nullptr && verb->about == About::itself)
    declared(all, *verb);
  else
    static_cast<void>(root().verbs());  // for the help, or to say what is meant, too
  try {
    app_->parse(words);
    return Outcome::done;
  } catch (const CLI::Success& asked) {
    if (!root().called() && !root().left_over().empty()) {  // help on a verb that there is not
      refuse(root(), misuse_of_words(root(), beginning_));
      return Outcome::refused;
    }
    std::ostringstream text;
    app_->exit(asked, text, text);
    print_help(text.str());
    return Outcome::told;
  } catch (const CLI::ParseError& error) {
    const bool of_a_value = error.get_name() == "ValidationError" || error.get_name() == "ArgumentMismatch" ||
                            error.get_name() == "ConversionError";
    if (const auto misuse = of_a_value ? std::nullopt : misuse_before_verb(root(), {argv + 1, argv + argc})) {
      complain({misuse->what, misuse->remedy});
      return Outcome::refused;
    }
    Misuse misuse = of_a_value ? misuse_of(error) : misuse_of_words(root(), beginning_);
    constexpr std::string_view missing = "missing value for ";
    if (misuse.what.starts_with(missing)) misuse = missing_value(root(), misuse.what.substr(missing.size()));
    refuse(root(), misuse);
    return Outcome::refused;
  }
}

}  // namespace ocm::cli
