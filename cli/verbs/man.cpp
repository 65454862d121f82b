#include "generator/text/man.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/verbs/verbs.hpp"
#include "generator/text/output_file.hpp"

namespace ocm::cli {
namespace {

std::vector<const CLI::App*> verbs_of(const CLI::App& app) {
  return app.get_subcommands(
      [](const CLI::App* each) { return !each->get_name().empty() && !each->get_group().empty(); });
}

std::string page_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : page_name(*app.get_parent()) + "-" + app.get_name();
}

/// The help of --help, cut at its blank lines: what it is comes first, how it is called second.
std::string page_of(const CLI::App& app, const CLI::App& root) {
  std::string command;
  for (const CLI::App* each = &app; each->get_parent() != nullptr; each = each->get_parent())
    command = " " + each->get_name() + command;
  std::string help = app.help(root.get_name() + command);
  const std::string footer = app.get_footer();
  if (const auto at = help.rfind(footer); !footer.empty() && at != std::string::npos) help.erase(at);
  const auto usage = help.find("Usage: ");
  const auto usage_end = help.find('\n', usage);
  generate::ManPage page{page_name(app), app.get_description(), OCM_VERSION};
  page.literal("SYNOPSIS", help.substr(usage + 7, usage_end - usage - 7));
  page.literal("OPTIONS", std::string_view{help}.substr(help.find_first_not_of('\n', usage_end)));
  const bool is_root = app.get_parent() == nullptr;
  page.literal(is_root ? "EXIT STATUS" : "EXAMPLES", footer);
  std::string others;
  for (const CLI::App* verb : verbs_of(root))
    if (verb != &app)
      others += fmt::format("{}{}-{}(1)", others.empty() ? "" : ",\n", root.get_name(), verb->get_name());
  return page.text("SEE ALSO", (is_root ? "" : root.get_name() + "(1),\n") + others + ",\nocm-generate(1)")
      .make();
}

void write_all(const CLI::App& root, const std::string& folder) {
  std::vector<const CLI::App*> apps = verbs_of(root);
  apps.insert(apps.begin(), &root);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const CLI::App* app : apps)
    if (const auto problem =
            generate::write_file(fmt::format("{}/{}.1", folder, page_name(*app)), page_of(*app, root)))
      fail({fmt::format("{}: {}", problem->place, problem->what), problem->remedy});
}

}  // namespace

void add_man(CLI::App& app, Session&, int&) {
  auto* verb = add_verb(app, "man", "manual pages, as man(1) reads them", help_group,
                        "  amiroctl man | man -l -\n"
                        "  amiroctl man publish | man -l -\n"
                        "  amiroctl man --all ~/.local/share/man/man1");
  struct Options {
    std::string verb;
    std::string folder;
  };
  const auto options = std::make_shared<Options>();
  verb->add_option("verb", options->verb, "whose page; default: that of amiroctl")->type_name("VERB");
  verb->add_option("--all", options->folder, "write every page into this folder")->type_name("FOLDER");
  verb->callback([options, &app] {
    if (!options->folder.empty()) return write_all(app, options->folder);
    const CLI::App* chosen = options->verb.empty() ? &app : nullptr;
    for (const CLI::App* each : verbs_of(app))
      if (each->check_name(options->verb)) chosen = each;
    if (chosen == nullptr)
      fail({fmt::format("man: unknown verb {}", options->verb), "`amiroctl --help` lists them"}, exit_usage);
    fmt::print("{}", page_of(*chosen, app));
  });
}

}  // namespace ocm::cli
