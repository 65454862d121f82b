#include "generator/text/man.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/shared/output_file.hpp"
#include "cli/shared/usage.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/suggestion.hpp"

namespace ocm::cli {
namespace {

std::string page_name(Verb verb) {
  return verb.parent() ? page_name(verb.parent()) + "-" + verb.name() : verb.name();
}

/// What --help shows between the usage and the footer: positionals, options, verbs.
std::string options_of(Verb verb) {
  std::string help = verb.help();
  const std::string footer = verb.footer();
  if (const auto at = help.rfind(footer); !footer.empty() && at != std::string::npos) help.erase(at);
  help.erase(0, help.find("Usage: "));
  help.erase(0, help.find('\n'));
  help.erase(0, std::min(help.find_first_not_of('\n'), help.size()));
  while (help.ends_with('\n')) help.pop_back();
  return help;
}

constexpr std::string_view environment =
    "AMIROCTL_BUS=NAME         the bus, as --bus\n"
    "AMIROCTL_SPEC=FILE        topics of another robot, as --spec\n"
    "AMIROCTL_CONFIG=FILE      the configuration file, as --config\n"
    "AMIROCTL_OPTION=VALUE     any other option, in capitals and with _ for -: AMIROCTL_PRIORITY=high,\n"
    "                          AMIROCTL_DRY_RUN=true. The command line goes first, then the environment,\n"
    "                          then the configuration file\n"
    "NO_COLOR                  if it is set, no output is coloured\n"
    "XDG_CONFIG_HOME           folder of the configuration file, see FILES\n"
    "XDG_RUNTIME_DIR           folder of the sockets and links that a simulation makes, see FILES";

constexpr std::string_view files =
    "~/.config/amiroctl/config.toml\n"
    "    options that need not be typed, as TOML; $XDG_CONFIG_HOME/amiroctl/config.toml if that is set\n"
    "$XDG_RUNTIME_DIR/ocm/\n"
    "    the virtual bus of `amiroctl sim`, and the lines of simulated mappers and their central;\n"
    "    /tmp/ocm-UID/ without the variable";

std::string see_also(Verb verb, Verb root) {
  std::string others;
  for (const Verb other : root.verbs_for_all())
    if (other != verb)
      others += fmt::format("{}{}-{}(1)", others.empty() ? "" : ",\n", root.name(), other.name());
  return (verb == root ? "" : root.name() + "(1),\n") + others + ",\nocm-generate(1)";
}

std::string page_of_program(Verb root) {
  // The first paragraph is the options that every verb has, the others list the verbs.
  const std::string all = options_of(root);
  const auto end_of_options = all.find("\n\n");
  generate::ManPage page{root.name(), root.description(), OCM_VERSION};
  page.literal("SYNOPSIS", usage(root));
  page.literal("OPTIONS", all.substr(0, end_of_options));
  page.literal("VERBS", all.substr(end_of_options + 2));
  page.literal("ENVIRONMENT", environment);
  page.literal("FILES", files);
  page.literal("EXIT STATUS", root.footer());
  return page.text("SEE ALSO", see_also(root, root)).make();
}

std::string page_of(Verb verb, Verb root) {
  if (verb == root) return page_of_program(root);
  std::string synopsis;
  for (const Verb inner : verb.verbs_for_all()) synopsis += usage(inner) + "\n";
  generate::ManPage page{page_name(verb), verb.description(), OCM_VERSION};
  page.literal("SYNOPSIS", synopsis.empty() ? usage(verb) : synopsis);
  page.literal("OPTIONS",
               options_of(verb) + "\n\nThose of every verb, such as --bus: " + root.name() + "(1)");
  for (const Verb inner : verb.verbs_for_all()) page.literal("OPTIONS OF " + inner.path(), options_of(inner));
  page.literal("EXAMPLES", verb.footer());
  return page.text("SEE ALSO", see_also(verb, root)).make();
}

[[noreturn]] void refuse_verb(Verb root, const std::string& typed) {
  std::vector<std::string> names;
  for (const Verb each : root.verbs_for_all()) names.push_back(each.name());
  const auto near = words::nearest(typed, std::vector<std::string_view>(names.begin(), names.end()));
  fail({fmt::format("man: unknown verb '{}'", typed),
        near.empty() ? "`amiroctl --help` lists the verbs" : fmt::format("did you mean '{}'?", near)},
       exit_usage);
}

void write_all(Verb root, const std::string& folder) {
  std::vector<Verb> verbs = root.verbs_for_all();
  verbs.insert(verbs.begin(), root);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const Verb verb : verbs)
    write_file(fmt::format("{}/{}.1", folder, page_name(verb)), page_of(verb, root));
}

}  // namespace

void declare_man(Verb verb, Session&, int&) {
  verb.describe("manual pages, as man(1) reads them", help_group,
                "  amiroctl man | man -l -\n"
                "  amiroctl man publish | man -l -\n"
                "  amiroctl man --all ~/.local/share/man/man1");
  struct Options {
    std::string verb;
    std::string folder;
  };
  const auto options = std::make_shared<Options>();
  const auto whose =
      verb.add_option("verb", options->verb, "whose page; default: that of amiroctl").type_name("VERB");
  verb.add_option("--all", options->folder, "write every page into this folder")
      .type_name("FOLDER")
      .excludes(whose);
  verb.callback([options, program = verb.parent()] {
    if (!options->folder.empty()) return write_all(program, options->folder);
    Verb chosen = options->verb.empty() ? program : Verb{};
    for (const Verb each : program.verbs_for_all())
      if (each.is_named(options->verb)) chosen = each;
    if (!chosen) refuse_verb(program, options->verb);
    fmt::print("{}", page_of(chosen, program));
  });
}

}  // namespace ocm::cli
