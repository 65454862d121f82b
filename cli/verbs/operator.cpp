/// Asks the operator that runs on a bus of this machine, and tells it what to do.
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "cli/shared/buses.hpp"
#include "cli/shared/operator_link.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {
namespace {

/// Prints the answer; leaves with what is wrong.
void ask(Session& session, std::string_view verb, const std::string& request) {
  const std::string bus = session.bus_name.empty() ? only_bus() : session.bus_name;
  const auto link = connect_operator(bus, "operator");
  if (!link) fail({fmt::format("operator {}: {}", verb, link.error.what), link.error.remedy});
  if (*link == nullptr)
    fail({fmt::format("operator {}: no operator of yours runs on {}", verb, bus),
          "start one: amiroctl operate FILE"});
  const auto answer = (*link)->ask(request, std::chrono::seconds{1});
  if (answer.kind != OperatorAnswer::Kind::ok)
    fail({fmt::format("operator {}: {}", verb, answer.failure.what), answer.failure.remedy});
  fmt::print("{}", answer.text);
}

void add_question(Verb verb, Session& session, const std::string& name, const std::string& description,
                  std::string_view examples) {
  auto inner = verb.add_inner_verb(name, description, examples);
  const auto json = std::make_shared<bool>(false);
  inner.add_flag("--json", *json, "one object, for programs");
  inner.callback([=, &session] { ask(session, name, *json ? name + " json" : name); });
}

}  // namespace

void declare_operator(Verb verb, Session& session, int&) {
  verb.describe("ask the operator that runs on this bus, or tell it what to do", act_group,
                "  amiroctl operator status\n"
                "  amiroctl operator why              the last changes, and what leads on\n"
                "  amiroctl operator switch driving   where a transition on request leads there\n"
                "  amiroctl operator hold             until resume it leaves for the fall-back only");
  verb.require_verb();
  add_question(verb, session, "status", "the configuration, its streams and monitors",
               "  amiroctl operator status\n"
               "  amiroctl operator status --json | jq -r .configuration");
  add_question(verb, session, "why", "the last changes with their causes, and what leads on",
               "  amiroctl operator why");
  {
    auto inner =
        verb.add_inner_verb("switch", "ask for a configuration",
                            "  amiroctl operator switch driving   where a transition on request leads there");
    const auto name = std::make_shared<std::string>();
    inner.add_option("configuration", *name, "its name in the operator file")
        .required()
        .type_name("CONFIGURATION");
    inner.callback([=, &session] { ask(session, "switch", "switch " + *name); });
  }
  verb.add_inner_verb("hold", "stay: monitors lead to the fall-back only, until resume",
                      "  amiroctl operator hold")
      .callback([&session] { ask(session, "hold", "hold"); });
  verb.add_inner_verb("resume", "go on after hold", "  amiroctl operator resume").callback([&session] {
    ask(session, "resume", "resume");
  });
}

}  // namespace ocm::cli
