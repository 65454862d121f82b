#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "cli/shared/output_file.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/suggestion.hpp"
#include "generator/robot_spec.hpp"
#include "generator/spec/spec.hpp"
#include "generator/targets/target.hpp"

namespace ocm::cli {
namespace {

struct GenerateOptions {
  std::string target;
  std::string output = "-";
  std::optional<protocol::Priority> priority;
  bool priority_typed = false;
};

std::string base_name(const std::string& path) {
  return path.substr(path.rfind('/') + 1);  // npos + 1 is 0
}

std::string targets_help() {
  std::string text = "Targets:\n";
  for (const auto& target : generate::targets())
    text += fmt::format("  {:<12} {}\n", target.name, target.description);
  return text;
}

std::string remedy_for(std::string_view target) {
  std::vector<std::string_view> names;
  for (const auto& each : generate::targets()) names.push_back(each.name);
  return words::suggestion(target, names);
}

void generate_file(Session& session, const GenerateOptions& options) {
  session.refuse_interfaces("generate");
  const auto* target = generate::find_target(options.target);
  if (target == nullptr)
    fail({fmt::format("generate: unknown target '{}'", options.target), remedy_for(options.target)},
         exit_usage);
  generate::Options how{std::string{generate::robot_spec_name}, std::nullopt};
  if (!session.spec_files.empty()) how.spec_name = base_name(session.spec_files.front());
  if (target->name == "dbc")
    how.priority = options.priority;
  else if (options.priority_typed)  // that of a config file is for other verbs
    fail({fmt::format("generate {}: --priority is for dbc", target->name), "drop --priority"}, exit_usage);
  const spec::Model& model = session.spec().model();
  if (model.topics.empty() && model.messages.empty())
    fail({fmt::format("generate {}: {} has neither topics nor messages", target->name, how.spec_name),
          "a file that has some"});
  if (!generate::has_any(*target, model))
    fail({fmt::format("generate {}: {} has only {}, which it has no place for", target->name, how.spec_name,
                      target->of_topics ? "messages" : "topics"),
          target->of_topics ? "messages become " + generate::message_target_names()
                            : "topics are in the spec already"});
  for (const std::string& what : generate::left_out(*target, model))
    remark(fmt::format("generate {}: left out: {}", target->name, what));
  session.keep_specs("generate", options.output);
  const std::string text = target->make(model, how);
  write_file(options.output, text);
}

}  // namespace

void declare_generate(Verb verb, Session& session, int&) {
  verb.describe("files for other programs, from the robot's spec", look_group,
                "  amiroctl generate dbc -o amiro.dbc\n"
                "  amiroctl generate wireshark -o ~/.local/lib/wireshark/plugins/amiro.lua\n"
                "  amiroctl --spec other.json generate c > other.h");
  verb.footer(targets_help() + "\n" + verb.footer());
  const auto options = std::make_shared<GenerateOptions>();
  verb.add_option("target", options->target, generate::target_names()).required().type_name("TARGET");
  verb.add_option("-o,--output", options->output, "the file, replaced in one step; default: standard output")
      .type_name("FILE");
  add_priority(verb, "--priority", options->priority,
               "dbc: frames at this priority only, and their names without it");
  verb.callback([verb, options, &session] {
    options->priority_typed = verb.is_typed("--priority");
    generate_file(session, *options);
  });
}

}  // namespace ocm::cli
