#include "cli/shared/session.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/topics/amiro.hpp"

#include "cli/shared/buses.hpp"
#include "cli/shared/config.hpp"
#include "cli/shared/memory.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/shared/spec_word.hpp"
#include "generator/robot_spec.hpp"
#include "generator/spec/merge.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli {
namespace {

/// So many doubts are listed one by one: a file may have hundreds.
constexpr std::size_t most_doubts = 3;

/// On stderr, all of them, and the end; nothing when there are none.
void stop_at(const std::vector<spec::Problem>& problems) {
  for (const auto& problem : problems)
    complain({fmt::format("{}: {}", problem.place, problem.what), problem.remedy});
  if (!problems.empty()) throw Exit{exit_failure};
}

/// A file that is there twice for one interface has all its names twice.
void refuse_twice(const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const SpecWord a = parse_spec_word(words[j]);
      const SpecWord b = parse_spec_word(words[i]);
      std::error_code error;
      if (a.interface == b.interface && std::filesystem::equivalent(a.file, b.file, error))
        fail({fmt::format("--spec {}: the same file as --spec {}", words[i], words[j]), "give it once"},
             exit_usage);
    }
}

}  // namespace

Session::Session() = default;
Session::~Session() {
  // The process ends, and the kernel takes a large spec back at once; piece by piece that takes a
  // millisecond. It stays where checks for leaks see it.
  [[maybe_unused]] static spec::Spec* kept = nullptr;
  kept = spec_.release();
}

void Session::add_options(Verb app) {
  app.add_option(
         "--bus", bus_name,
         "CAN interface (can0, vcan0, ...), slcan:/dev/ttyACM0@500k (a serial adapter) or sim; default: "
         "the only interface that is up or sim")
      .environment("AMIROCTL_BUS")
      .type_name("NAME");
  app.add_option(
         "--spec", spec_files,
         "what is said on another bus: a robot's topics as JSON, or messages as DBC; can0=FILE: on that "
         "interface only; may be given again; default: the AMiRo's, compiled in")
      .environment("AMIROCTL_SPEC")
      .type_name("FILE")
      .one_a_mention();
  app.add_flag("--strict-spec", strict_spec_, "refuse a DBC file with doubtful places");
  app.add_option("--config", config_file,
                 "configuration file (TOML); default: ~/.config/amiroctl/config.toml")
      .environment("AMIROCTL_CONFIG")
      .type_name("FILE");
  app.after_parsing([this, app] { apply_config(app, config_file); });
  app.add_flag("--no-color,--no-colour", no_colour_, "never colour the output (also: NO_COLOR)");
}

const protocol::Catalogue& Session::catalogue() {
  return spec_files.empty() ? amiro::catalogue : spec().catalogue();
}

const spec::Spec& Session::spec() {
  if (spec_ == nullptr) {
    const EndsWithoutMemory ends;
    if (spec_files.empty()) {
      spec_ = std::move(spec::parse(generate::robot_spec_text(), generate::robot_spec_name).spec);
      return *spec_;
    }
    refuse_twice(spec_files);
    spec::Model all = load(spec_files.front());
    for (std::size_t i = 1; i < spec_files.size(); ++i) {
      std::vector<spec::Problem> problems;
      spec::merge(all, load(spec_files[i]), parse_spec_word(spec_files[i]).file, problems);
      stop_at(problems);
    }
    all.share_bit_rate();
    spec_ = std::make_unique<spec::Spec>(std::move(all));
  }
  return *spec_;
}

spec::Model Session::load(const std::string& word) const {
  const auto [interface, file, bus] = parse_spec_word(word);
  auto loaded = spec::load(file);
  if (strict_spec_) stop_at(loaded.doubts);
  stop_at(loaded.problems);
  const std::size_t told = std::min(loaded.doubts.size(), most_doubts);
  for (const auto& doubt : std::span{loaded.doubts}.first(told))
    remark(fmt::format("{}: {}; {}", doubt.place, doubt.what, doubt.remedy));
  if (told < loaded.doubts.size())
    remark(fmt::format("{}: {}; --strict-spec shows all and refuses", file,
                       counted(loaded.doubts.size() - told, "more doubtful place")));
  spec::Model model = loaded.spec->take_model();
  if (!interface.empty()) model.put_on(interface);
  return model;
}

const protocol::Catalogue& Session::catalogue_on_bus(bool opens_bus) {
  const protocol::Catalogue& all = catalogue();
  if (!all.has_buses() || (bus_name.empty() && !opens_bus)) return all;
  return catalogue_on(bus_name.empty() ? only_bus() : bus_name);
}

const protocol::Catalogue& Session::catalogue_on(const std::string& bus) {
  const protocol::Catalogue& all = catalogue();
  if (!all.has_buses()) return all;
  const std::string interface = interface_of(bus);
  auto& there = specs_on_[interface];
  if (there == nullptr) {
    spec::Model model = spec().model();
    const auto is_elsewhere = [&](const auto& object) {
      return !object.bus.empty() && object.bus != interface;
    };
    std::erase_if(model.topics, is_elsewhere);
    std::erase_if(model.messages, is_elsewhere);
    there = std::make_unique<spec::Spec>(std::move(model));
  }
  return there->catalogue();
}

void Session::keep_specs(std::string_view verb, const std::string& output) const {
  for (const std::string& word : spec_files) refuse_same_file(verb, parse_spec_word(word).file, output);
}

std::string Session::narrow_to_bus(std::string_view verb, const std::string& bus) {
  std::vector<SpecWord> words;
  std::vector<std::string> named;  // as they were typed first
  std::set<std::string> interfaces;
  for (const std::string& word : spec_files) {
    words.push_back(parse_spec_word(word));
    const SpecWord& last = words.back();
    if (!last.interface.empty() && interfaces.insert(last.interface).second) named.push_back(last.bus);
  }
  if (named.empty()) return bus;
  std::string all = named.front();
  for (std::size_t i = 1; i < named.size(); ++i) all += ", " + named[i];
  if (bus.empty() && named.size() > 1)
    fail({fmt::format("{}: it is about one bus, and --spec names {}", verb, all),
          "choose one with --bus NAME"},
         exit_usage);
  const std::string& chosen = bus.empty() ? named.front() : bus;
  spec_files.clear();
  for (const SpecWord& word : words)
    if (word.interface.empty() || word.interface == interface_of(chosen)) spec_files.push_back(word.file);
  if (spec_files.empty())
    fail({fmt::format("{}: no --spec is for {}, only for {}", verb, chosen, all),
          fmt::format("--spec {}={}, or --bus {}", chosen, words.front().file, named.front())},
         exit_usage);
  spec_.reset();
  specs_on_.clear();
  return chosen;
}

void Session::refuse_interfaces(std::string_view verb) {
  for (const std::string& word : spec_files) {
    const auto [interface, file, bus] = parse_spec_word(word);
    if (!interface.empty())
      fail({fmt::format("{}: --spec {}: it is about one bus, whatever its name", verb, word),
            fmt::format("--spec {}", file)},
           exit_usage);
  }
}

std::unique_ptr<transport::Bus> Session::open_bus(std::string_view name) {
  auto bus = cli::open_bus(parse_bus_name(name));
  if (!bus) fail(bus.error);
  return std::move(*bus);
}

std::unique_ptr<transport::Bus> Session::open_bus() {
  const bool chosen = !bus_name.empty();
  if (!chosen) bus_name = only_bus();
  auto bus = open_bus(bus_name);
  remark(fmt::format("bus: {}{}", bus->name(), chosen ? "" : " (the only one there is; --bus chooses)"));
  return bus;
}

bool Session::colour() const {
  const char* never = std::getenv("NO_COLOR");
  return !no_colour_ && (never == nullptr || *never == '\0') && isatty(STDOUT_FILENO) != 0;
}

}  // namespace ocm::cli
