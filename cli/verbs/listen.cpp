#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/reflective/command.hpp"
#include "ocm/reflective/sample.hpp"

#include "cli/interrupt.hpp"
#include "cli/output/output.hpp"
#include "cli/verbs/commanding.hpp"
#include "cli/verbs/subscription.hpp"
#include "cli/verbs/verbs.hpp"

namespace ocm::cli {
namespace {

struct ListenOptions {
  std::vector<std::string> topics;
  bool pretty = false, json = false, csv = false, raw = false;
  bool commands = false;
  bool strict = false;
  std::uint64_t count = 0;
  std::string timeout;
  std::string idle_timeout;
};

std::vector<const protocol::Topic*> chosen_topics(const protocol::Catalogue& catalogue,
                                                  const std::vector<std::string>& words) {
  std::vector<const protocol::Topic*> topics;
  for (const auto& word : words) {
    bool found = false;
    for (const auto& topic : catalogue.topics) {
      if (catalogue.find(word) != &topic && topic.group != word) continue;
      topics.push_back(&topic);
      found = true;
    }
    if (found) continue;
    const auto names = reflective::topic_words(catalogue);
    fail({"listen: no topic '" + word + "'", reflective::detail::suggestion(word, names)}, exit_usage);
  }
  return topics;
}

Format chosen_format(const ListenOptions& options) {
  if (options.json) return Format::json;
  if (options.csv) return Format::csv;
  if (options.raw) return Format::raw;
  if (options.pretty || isatty(STDOUT_FILENO) != 0) return Format::pretty;
  return Format::json;
}

/// What was received, and every fault by its cause, on stderr.
void summarise(const reflective::ReceiverCounters& seen, const transport::BusCounters& bus) {
  std::string text = fmt::format("{} frames, {} samples", seen.frames, seen.samples);
  const auto add = [&text](std::uint64_t count, std::string_view what) {
    if (count != 0) text += fmt::format(", {} {}", count, what);
  };
  add(seen.commands, "commands");
  add(seen.unknown, "of unknown identifier");
  add(seen.wrong_dlc, "of wrong length");
  add(seen.incomplete, "incomplete samples");
  add(seen.errors, "error frames");
  add(bus.lost, "lost in the receive queue");
  remark(text);
}

void listen(Session& session, const ListenOptions& options, int& exit_code) {
  using SteadyClock = std::chrono::steady_clock;
  const auto& catalogue = session.catalogue();
  const auto topics = chosen_topics(catalogue, options.topics);
  const base::Duration timeout =
      options.timeout.empty() ? base::Duration::max() / 4 : duration_option("--timeout", options.timeout);
  const base::Duration idle = options.idle_timeout.empty()
                                  ? base::Duration::max() / 4
                                  : duration_option("--idle-timeout", options.idle_timeout);
  catch_interrupts();
  const auto bus = session.open_bus();
  if (!topics.empty()) {
    const auto filters = filters_for(topics, options.commands);
    if (const auto subscribed = bus->subscribe(filters); !subscribed) fail(subscribed.error);
  }
  const bool commands_wanted =
      options.commands || std::any_of(topics.begin(), topics.end(), [](const protocol::Topic* topic) {
        return topic->kind == protocol::Kind::actuator;
      });

  const Format format = chosen_format(options);
  reflective::Receiver receiver{catalogue};
  Printer printer{make_output(format, catalogue, session.colour())};
  printer.flush();
  const auto begin = SteadyClock::now();
  auto last = begin;
  std::uint64_t shown = 0;
  bool timed_out = false;
  transport::Failure gone;
  StateWatch watch;
  while (interrupted() == 0 && (options.count == 0 || shown < options.count)) {
    auto received = bus->receive(base::Duration{0});
    if (!received && received.error == base::Error::timed_out) {
      printer.flush();
      const auto now = SteadyClock::now();
      const auto left = std::min<SteadyClock::duration>(begin + timeout - now, last + idle - now);
      if (left.count() <= 0) {
        timed_out = true;
        break;
      }
      // In pieces, so that a signal that comes just before the wait is seen soon.
      received = bus->receive(std::min<base::Duration>(left, std::chrono::milliseconds{200}));
    }
    if (!received) {
      watch.look(*bus);
      if (received.error == base::Error::closed) {
        gone = bus->failure();
        break;
      }
      continue;
    }
    const auto reception = receiver.take(*received);
    using reflective::Meaning;
    const bool command = reception.meaning == Meaning::request || reception.meaning == Meaning::set_point;
    if (command && !commands_wanted) continue;
    if (!options.idle_timeout.empty()) last = SteadyClock::now();
    printer.write({bus->name(), *received, reception});
    // -n counts what is shown: lines of samples for a person, frames otherwise.
    if (format != Format::pretty || reception.meaning != Meaning::part) ++shown;
  }
  printer.flush();
  summarise(receiver.counters(), bus->counters());
  if (!gone.what.empty()) fail(gone);
  // As with candump -n: whoever waits for frames and gets none wants to know.
  if (timed_out && options.count != 0) exit_code = exit_failure;
  if (options.strict && (receiver.counters().faults() != 0 || bus->counters().lost != 0))
    exit_code = exit_failure;
  exit_code = exit_code_after_interrupt(exit_code);
}

}  // namespace

void add_listen(CLI::App& app, Session& session, int& exit_code) {
  auto* verb =
      add_verb(app, "listen", "show what the sensors say", watch_group,
               "  amiroctl listen                        for a person on a terminal, JSON lines in a pipe\n"
               "  amiroctl listen gyro odom --pretty\n"
               "  amiroctl listen --json -n 10 | jq .fields\n"
               "  amiroctl listen --raw > drive.log      a candump log\n"
               "  amiroctl listen --strict --timeout 10s  exit 1 when anything was lost or unknown");
  const auto options = std::make_shared<ListenOptions>();
  verb->add_option("topics", options->topics, "only these; default: everything")->type_name("[TOPIC ...]");
  auto* format = verb->add_option_group("Format", "default: pretty on a terminal, JSON lines otherwise");
  format->add_flag("--pretty", options->pretty, "a line a sample, values with units");
  format->add_flag("--json", options->json, "an object a frame");
  format->add_flag("--csv", options->csv, "a line a field: time, topic, field, value, unit");
  format->add_flag("--raw", options->raw, "candump's log line");
  format->require_option(0, 1);
  verb->add_flag("--commands", options->commands, "show requests and set points too");
  verb->add_flag("--strict", options->strict, "exit 1 when frames were lost, unknown, wrong or incomplete");
  verb->add_option("-n,--count", options->count, "end after so many")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  verb->add_option("--timeout", options->timeout, "end after this time; exit 1 when -n is not reached")
      ->type_name("T");
  verb->add_option("--idle-timeout", options->idle_timeout, "end when nothing came for this time")
      ->type_name("T");
  verb->callback([options, &session, &exit_code] { listen(session, *options, exit_code); });
}

}  // namespace ocm::cli
