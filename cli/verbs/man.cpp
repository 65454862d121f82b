#include "generator/text/man.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/shared/output_file.hpp"
#include "cli/verbs/verbs.hpp"

namespace ocm::cli {
namespace {

std::string page_name(Verb verb) {
  return verb.parent() ? page_name(verb.parent()) + "-" + verb.name() : verb.name();
}

/// The help of --help, cut at its blank lines: what it is comes first, how it is called second.
std::string page_of(Verb verb, Verb root) {
  std::string command;
  for (Verb each = verb; each.parent(); each = each.parent()) command = " " + each.name() + command;
  std::string help = verb.help(root.name() + command);
  const std::string footer = verb.footer();
  if (const auto at = help.rfind(footer); !footer.empty() && at != std::string::npos) help.erase(at);
  const auto usage = help.find("Usage: ");
  const auto usage_end = help.find('\n', usage);
  generate::ManPage page{page_name(verb), verb.description(), OCM_VERSION};
  page.literal("SYNOPSIS", help.substr(usage + 7, usage_end - usage - 7));
  page.literal("OPTIONS", std::string_view{help}.substr(help.find_first_not_of('\n', usage_end)));
  const bool is_root = !verb.parent();
  page.literal(is_root ? "EXIT STATUS" : "EXAMPLES", footer);
  std::string others;
  for (const Verb other : root.verbs_for_all())
    if (other != verb)
      others += fmt::format("{}{}-{}(1)", others.empty() ? "" : ",\n", root.name(), other.name());
  return page.text("SEE ALSO", (is_root ? "" : root.name() + "(1),\n") + others + ",\nocm-generate(1)")
      .make();
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

void add_man(Verb app, Session&, int&) {
  auto verb = app.add_verb("man", "manual pages, as man(1) reads them", help_group,
                           "  amiroctl man | man -l -\n"
                           "  amiroctl man publish | man -l -\n"
                           "  amiroctl man --all ~/.local/share/man/man1");
  struct Options {
    std::string verb;
    std::string folder;
  };
  const auto options = std::make_shared<Options>();
  verb.add_option("verb", options->verb, "whose page; default: that of amiroctl").type_name("VERB");
  verb.add_option("--all", options->folder, "write every page into this folder").type_name("FOLDER");
  verb.callback([options, app] {
    if (!options->folder.empty()) return write_all(app, options->folder);
    Verb chosen = options->verb.empty() ? app : Verb{};
    for (const Verb each : app.verbs_for_all())
      if (each.is_named(options->verb)) chosen = each;
    if (!chosen)
      fail({fmt::format("man: unknown verb {}", options->verb), "`amiroctl --help` lists them"}, exit_usage);
    fmt::print("{}", page_of(chosen, app));
  });
}

}  // namespace ocm::cli
