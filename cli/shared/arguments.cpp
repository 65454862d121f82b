#include "cli/shared/arguments.hpp"

#include <limits>
#include <map>
#include <set>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace ocm::cli {
namespace {

/// The program, which knows of each of its options what CLI11 does not keep.
struct Root : CLI::App {
  using CLI::App::App;
  std::map<const CLI::Option*, Accepted> accepted;
  std::set<const CLI::Option*> given;  ///< by the environment or a config file
};

Root& root_of(CLI::App* app) {
  while (app->get_parent() != nullptr) app = app->get_parent();
  return static_cast<Root&>(*app);  // a Verb is of a Program, whose root is one
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

std::vector<Verb> handles(const std::vector<CLI::App*>& apps) {
  std::vector<Verb> verbs;
  for (CLI::App* app : apps) verbs.emplace_back(app);
  return verbs;
}

/// "-.1m/s" is a number and not an option: "-0.1m/s" is what the parser of options takes for one.
std::vector<std::string> words(int argc, char** argv) {
  std::vector<std::string> result;
  for (int i = argc - 1; i > 0; --i) {  // CLI11 takes them from the back
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
  std::vector<std::string> all{words.begin(), words.end()};
  option_->check(CLI::IsMember(all));
  return takes(accepted_words(std::move(all)));
}

Option Option::takes(Accepted accepted) const {
  return declare(option_, owner_, std::move(accepted));
}

Option Option::range(double least, double most) const {
  option_->check(CLI::Range(least, most));
  return takes(accepted_number(least, most, fmt::format("a number from {} to {}", least, most)));
}

Option Option::range(unsigned least, unsigned most) const {
  option_->check(CLI::Range(least, most));
  return takes(accepted_whole(least, most, fmt::format("a whole number from {} to {}", least, most)));
}

Option Option::positive() const {
  option_->check(CLI::PositiveNumber);
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

std::size_t Option::count() const {
  return option_->count();
}

std::vector<std::string> Option::long_names() const {
  return option_->get_lnames();
}

std::string Option::name() const {
  return option_->get_name();
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

bool Option::is_named(const std::string& name) const {
  return option_->check_name(name);
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
  if (option_->count() > 0) return true;
  for (const CLI::Option* other : option_->get_excludes())
    if (other->count() > 0) return true;
  if (is_verb(owner_)) return false;
  for (const CLI::Option* other : owner_->get_options())
    if (other->count() > 0) return true;
  return false;
}

void Option::give(const std::string& key, const std::vector<std::string>& values) const {
  try {
    if (option_->get_items_expected_max() == 0 || (option_->get_items_expected_min() == 0 && values.empty()))
      option_->add_result(option_->get_flag_value(key, values.empty() ? "" : values.front()));
    else
      option_->add_result(values);
    option_->run_callback();
    root_of(owner_).given.insert(option_);
  } catch (const CLI::ParseError& error) {
    throw BadValue{error.what()};
  }
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
  return declare(app_->add_option(names, value, help), app_,
                 accepted_whole(0, std::numeric_limits<std::uint32_t>::max(), "a whole number"));
}

Option Verb::add_option(const std::string& names, std::uint64_t& value, const std::string& help) const {
  return declare(app_->add_option(names, value, help), app_,
                 accepted_whole(0, std::numeric_limits<std::uint64_t>::max(), "a whole number"));
}

Option Verb::add_option(const std::string& names, double& value, const std::string& help) const {
  return declare(app_->add_option(names, value, help), app_,
                 accepted_number(-no_bound, no_bound, "a number"));
}

Option Verb::add_flag(const std::string& names, bool& value, const std::string& help) const {
  return declare(app_->add_flag(names, value, help), app_, accepted_truth());
}

Verb Verb::add_choice(const std::string& heading, const std::string& help) const {
  auto* group = app_->add_option_group(heading, help);
  group->require_option(0, 1);
  return Verb{group};
}

Verb Verb::add_verb(std::string_view name, std::string_view description, std::string_view heading,
                    std::string_view examples) const {
  auto* verb = app_->add_subcommand(std::string{name}, std::string{description});
  verb->group(std::string{heading});
  verb->footer("Examples:\n" + std::string{examples});
  verb->fallthrough();
  return Verb{verb};
}

Verb Verb::add_inner_verb(const std::string& name, const std::string& description) const {
  auto* verb = app_->add_subcommand(name, description);
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
  app_->callback(std::move(run));
}

void Verb::after_parsing(std::function<void()> run) const {
  app_->parse_complete_callback(std::move(run));
}

std::size_t Verb::count(const std::string& option) const {
  return app_->count(option);
}

bool Verb::is_typed(const std::string& option) const {
  const CLI::Option* found = app_->get_option(option);
  return found->count() != 0 && root_of(app_).given.count(found) == 0;
}

Option Verb::option(const std::string& name) const {
  return {app_->get_option(name), app_};
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

std::string Verb::help(const std::string& as_called) const {
  return app_->help(as_called);
}

std::vector<Option> Verb::options() const {
  std::vector<Option> found;
  collect_options(*app_, found);
  return found;
}

std::vector<Verb> Verb::verbs() const {
  return handles(app_->get_subcommands([](const CLI::App* each) { return is_verb(each); }));
}

std::vector<Verb> Verb::verbs_for_all() const {
  return handles(app_->get_subcommands(
      [](const CLI::App* each) { return is_verb(each) && !each->get_group().empty(); }));
}

Verb Verb::called() const {
  for (CLI::App* each : app_->get_subcommands())
    if (is_verb(each)) return Verb{each};
  return {};
}

// --- program -----------------------------------------------------------------------------------------------

Program::Program(const std::string& name, const std::string& description, const std::string& version,
                 const std::string& footer)
    : app_(std::make_unique<Root>(description, name)) {
  app_->set_version_flag("--version", version);
  app_->require_subcommand(1);
  app_->footer(footer);
}

Program::~Program() = default;

Verb Program::root() noexcept {
  return Verb{app_.get()};
}

Program::Outcome Program::run(int argc, char** argv) {
  try {
    app_->parse(words(argc, argv));
    return Outcome::done;
  } catch (const CLI::ParseError& error) {
    return app_->exit(error) == 0 ? Outcome::told : Outcome::refused;
  }
}

}  // namespace ocm::cli
