#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/shared/buses.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/choice.hpp"
#include "cli/watch/chosen_topics.hpp"
#include "cli/watch/display.hpp"

namespace ocm::cli {
namespace {

struct ListenOptions {
  ChoiceOptions choice;
  FormatOptions format;
  bool commands = false;
  bool strict = false;
  std::uint64_t count = 0;
  std::optional<base::Duration> timeout;
  std::optional<base::Duration> idle_timeout;
};

/// After so long without a frame the sensor may never have been asked.
constexpr base::Duration silence = std::chrono::seconds{2};

/// The topics that are waited for; none: any frame will do.
std::vector<const protocol::Topic*> awaited_topics(const protocol::Catalogue& catalogue, const Choice& choice,
                                                   const ListenOptions& options) {
  const auto& topics = choice.topics();
  const auto selection = Selection::of(catalogue, options.format.fields);
  if (!selection || selection->everything()) return topics;
  std::vector<const protocol::Topic*> shown;
  for (const ChosenField& field : selection->fields())
    if (topics.empty() || std::find(topics.begin(), topics.end(), field.topic) != topics.end())
      shown.push_back(field.topic);
  return shown;
}

void listen(Session& session, const ListenOptions& options, int& exit_code) {
  const auto& catalogue = session.catalogue();
  Choice choice{"listen", catalogue, options.choice};
  choice.expect_any_of(options.format.fields);
  constexpr base::Duration without_end = base::Duration::max() / 4;
  const base::Duration timeout = options.timeout.value_or(without_end);
  const base::Duration idle = options.idle_timeout.value_or(without_end);
  catch_interrupts();
  const auto bus = session.open_bus();
  choice.subscribe(*bus, options.commands);
  const auto& topics = choice.topics();
  const bool commands_wanted =
      options.commands || std::any_of(topics.begin(), topics.end(), [](const protocol::Topic* topic) {
        return topic->kind == protocol::Kind::actuator;
      });

  Display display{"listen", session, options.format};
  choice.on_interface(0, bus->name());
  display.on_interface(0, bus->name());
  const ListenedUntil listened;
  const auto begin = Clock::now();
  auto last = begin;
  const auto end = [&] { return std::min(begin + timeout, last + idle); };
  const auto awaited = awaited_topics(catalogue, choice, options);
  const bool any_will_do = awaited.empty() || !options.choice.conditions.empty();  // not all meet them
  const bool by_identifier = !options.choice.filters.empty() || !options.choice.groups.empty();
  bool any = awaited.empty() && by_identifier;  // who sends these?
  const auto take = [&](const transport::ReceivedAny& received) {
    const log::Entry entry{received.time, received.frame};
    any |= any_will_do;
    if (!choice.has(entry)) return true;
    const client::Reception reception = display.understand(entry);
    any |= std::find(awaited.begin(), awaited.end(), reception.topic) != awaited.end();
    if (!choice.shows(entry, reception)) return true;
    const auto meaning = reception.meaning;
    using client::Meaning;
    const bool command = meaning == Meaning::request || meaning == Meaning::set_point;
    if (command && !commands_wanted) return true;
    if (options.idle_timeout) last = Clock::now();
    display.show(bus->name(), entry, reception);
    return options.count == 0 || display.shown() < options.count;
  };
  Live live{*bus, [&] { display.flush(); }};
  Over over = live.receive_any(std::min(end(), begin + silence), take);
  if (over == Over::time && !any) tell_to_ask(catalogue, awaited);
  while (over == Over::time && Clock::now() < end()) over = live.receive_any(end(), take);
  display.flush();
  display.summarise(bus->counters().lost, listened.now());
  display.tell_contradictions(Seen::live);
  if (over == Over::gone) fail(bus->failure());
  if (over == Over::time) expect_answer(bus->name());
  // As with candump -n: frames that were expected and did not come are a failure.
  if (over == Over::time && options.count != 0) {
    remark(fmt::format("amiroctl: listen: expected {}, only {} came in time", counted(options.count, "frame"),
                       display.shown()));
    exit_code = exit_failure;
  }
  if (options.strict && (display.any_fault() || bus->counters().lost != 0)) exit_code = exit_failure;
  exit_code = exit_code_after_interrupt(exit_code);
}

}  // namespace

void declare_listen(Verb verb, Session& session, int& exit_code) {
  verb.describe("show what the sensors say", watch_group,
                "  amiroctl listen                        for a person on a terminal, JSON lines in a pipe\n"
                "  amiroctl listen gyro odom --pretty\n"
                "  amiroctl listen --json -n 10 | jq .fields\n"
                "  amiroctl listen --raw > drive.log      a candump log\n"
                "  amiroctl listen --where 'gyro.z>90'    only while it turns that fast\n"
                "  amiroctl listen --strict --timeout 10s  exit 1 when anything was lost or unknown");
  const auto options = std::make_shared<ListenOptions>();
  verb.add_option("topics", options->choice.topics, "only these; default: everything")
      .type_name("[TOPIC ...]");
  add_format_options(verb, options->format);
  add_choice_options(verb, options->choice);
  verb.add_flag("--commands", options->commands, "show requests and set points too");
  verb.add_flag("--strict", options->strict, "exit 1 when frames were lost, unknown, wrong or incomplete");
  verb.add_option("-n,--count", options->count, "end after so many").type_name("N").positive();
  add_lasting(verb, "--timeout", options->timeout, "end after this time; exit 1 when -n is not reached");
  add_lasting(verb, "--idle-timeout", options->idle_timeout, "end when nothing came for this time");
  verb.callback([options, &session, &exit_code] { listen(session, *options, exit_code); });
}

}  // namespace ocm::cli
