#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "cli/analyse/chain.hpp"
#include "cli/analyse/report.hpp"
#include "cli/analyse/set.hpp"
#include "cli/analyse/study.hpp"
#include "cli/analyse/trace.hpp"
#include "cli/shared/fitted.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/quantity.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli {
namespace {

using namespace analyse;

struct Options {
  std::string file;
  std::vector<std::string> rates;
  std::optional<std::uint32_t> bit_rate;
  std::optional<std::uint32_t> data_bit_rate;
  std::string lengths;
  std::string test = "exact";
  std::string errors;
  std::optional<base::Duration> context_switch;
  std::optional<base::Duration> interrupt;
  std::optional<base::Duration> lock;
  std::optional<base::Duration> tick;
  std::optional<base::Duration> tick_cost;
  bool released_by_tick = false;
  std::vector<std::string> queues;
  std::string assign;
  std::optional<base::Duration> deadline;
  std::string set;
  std::string svg;
  bool json = false;
  bool csv = false;
};

/// "burst=1,every=10ms": one of them, or both.
void read_errors(std::string_view text, BusOptions& options) {
  const std::string whole{text};
  bool has_burst = false;
  const auto wrong = [&whole](std::string_view what) {
    fail({fmt::format("--errors {}: {}", whole, what),
          "burst=N,every=TIME: N faults at once, and one more every TIME, such as burst=2,every=10ms"},
         exit_usage);
  };
  while (!text.empty()) {
    const auto comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    if (part.starts_with("burst=")) {
      const auto count = base::parse_unsigned(part.substr(6));
      if (!count || *count > 1'000'000) wrong("no number of faults");
      options.error_burst = static_cast<std::int64_t>(*count);
      has_burst = true;
    } else if (part.starts_with("every=")) {
      const auto time = words::parse_duration(part.substr(6));
      if (!time || time->count() < 1) wrong("no time between faults");
      options.error_every = time->count();
    } else {
      wrong(fmt::format("'{}' is neither burst=N nor every=TIME", part));
    }
  }
  if (options.error_every > 0 && options.error_burst == 0) {
    if (has_burst) wrong("every=TIME needs burst=N");
    options.error_burst = 1;
  }
}

/// "motor=fifo", "motor=mailboxes:3"
BusOptions::Queue read_queue(const std::string& text) {
  const auto equals = text.rfind('=');
  const std::string_view kind =
      std::string_view{text}.substr(equals == std::string::npos ? text.size() : equals + 1);
  BusOptions::Queue result{text.substr(0, equals), {}};
  if (kind == "fifo") {
    result.queue.kind = analysis::NodeQueue::Kind::fifo;
    return result;
  }
  constexpr std::string_view mailboxes = "mailboxes:";
  const auto count = kind.starts_with(mailboxes) ? base::parse_unsigned(kind.substr(mailboxes.size()))
                                                 : base::Error::bad_syntax;
  if (!count || *count < 1 || *count > most_messages)
    fail({fmt::format("--queue {}: no queue", text),
          "NODE=fifo or NODE=mailboxes:N, such as di_wheel_drive=mailboxes:3"},
         exit_usage);
  result.queue = {analysis::NodeQueue::Kind::mailboxes, static_cast<std::size_t>(*count)};
  return result;
}

Assign assignment(const Options& options, const BusOptions& how, const BusSet& set) {
  if (options.assign.empty()) return Assign::nothing;
  const auto wrong = [&](std::string_view what, std::string_view remedy) {
    fail({fmt::format("--assign {}: {}", options.assign, what), std::string{remedy}}, exit_usage);
  };
  if (how.test != analysis::CanTest::exact || !how.queues.empty())
    wrong("orders are judged by the exact test, without queues", "leave out --test and --queue");
  if (options.assign == "priorities") {
    if (!options.file.empty())
      wrong("the identifiers of a file have no bits of priority", "--assign identifiers");
    return Assign::priorities;
  }
  if (how.lengths == Lengths::exact)
    wrong("exact lengths depend on the identifiers that are looked for", "--lengths generic");
  for (const BusEntry& entry : set.entries)
    if (entry.head.format != set.entries.front().head.format)
      wrong("identifiers of 11 and of 29 bits cannot be exchanged", "analyse them one kind at a time");
  return Assign::identifiers;
}

BusOptions bus_options(const Options& options, const protocol::Catalogue& catalogue) {
  BusOptions result;
  result.bit_rate = options.bit_rate.value_or(0);
  result.data_bit_rate = options.data_bit_rate.value_or(0);
  result.usual_bit_rate = catalogue.bit_rate;
  const bool own = options.file.empty();
  const std::string lengths = options.lengths.empty() ? (own ? "exact" : "generic") : options.lengths;
  result.lengths = lengths == "exact" ? Lengths::exact : Lengths::generic;
  result.test = options.test == "exact" ? analysis::CanTest::exact : analysis::CanTest::sufficient;
  read_errors(options.errors, result);
  for (const std::string& queue : options.queues) result.queues.push_back(read_queue(queue));
  if (!result.queues.empty() && result.test == analysis::CanTest::sufficient)
    fail({"--queue: --test sufficient knows no queues", "leave out one of them"}, exit_usage);
  return result;
}

/// The spec that --spec names; the compiled one has no messages.
const spec::Model* model_of(Session& session) {
  return session.spec_files.empty() ? nullptr : &session.spec().model();
}

template <class Advise>
int show(const Study& study, const Options& options, const Session& session, Advise advise) {
  if (!options.svg.empty()) write_file(options.svg, to_svg(study));
  if (options.json)
    fmt::print("{}", to_json(study));
  else if (options.csv) {
    fmt::print("{}", to_csv(study));
    if (!study.left_out.empty()) remark(left_out_text(study.left_out));
  } else if (options.svg != "-")
    print_fitted(to_table(study, advise(), session.colour()), 4);
  return study.passes() ? exit_success : exit_failure;
}

void narrow(std::string_view verb, Session& session) {
  static_cast<void>(session.narrow_to_bus(verb, session.bus_name));
}

int bus(const Options& options, Session& session) {
  if (options.file.empty()) narrow("analyse bus", session);
  const auto rates = read_rates(options.rates);
  BusOptions how = bus_options(options, session.catalogue());
  const auto& specs = session.spec_files;
  const std::string source = specs.empty() ? "--rates" : fmt::format("{}", fmt::join(specs, ", "));
  BusSet set = options.file.empty() ? robot_bus(session.catalogue(), model_of(session), rates, source)
                                    : read_bus(options.file, rates);
  how = at_rates_of(set, how);
  assign(set, how, assignment(options, how, set));
  const Study study = study_bus(set, how);
  return show(study, options, session, [&] { return advise_bus(set, how, study); });
}

analysis::Processor processor_of(const Options& options) {
  analysis::Processor processor;
  const auto take = [](const std::optional<base::Duration>& given, std::int64_t& time) {
    if (given) time = given->count();
  };
  take(options.context_switch, processor.context_switch);
  take(options.interrupt, processor.interrupt);
  take(options.lock, processor.lock);
  take(options.tick, processor.tick_period);
  take(options.tick_cost, processor.tick_cost);
  processor.released_by_tick = options.released_by_tick;
  if (!processor.valid())
    fail({"analyse tasks: a tick needs a period of more than 0", "--tick TIME, such as --tick 1ms"},
         exit_usage);
  return processor;
}

int tasks(const Options& options, Session& session) {
  // A board's name, unless there is a file of that name.
  TaskSet set;
  std::error_code error;
  if (!std::filesystem::exists(options.file, error)) set = own_tasks(options.file);
  if (set.entries.empty() && options.file != "-" && !std::filesystem::exists(options.file, error))
    fail({fmt::format("analyse tasks: {} is neither a file nor a board", options.file),
          fmt::format("a CSV file, - for standard input, or one of {}", fmt::join(own_task_sets(), ", "))});
  if (set.entries.empty()) set = read_tasks(options.file);
  const analysis::Processor processor = processor_of(options);
  const Study study = study_tasks(set, processor);
  return show(study, options, session, [&] { return advise_tasks(set, processor, study); });
}

int chain(const Options& options, Session& session) {
  narrow("analyse chain", session);
  const std::int64_t deadline = options.deadline ? options.deadline->count() : analysis::unbounded;
  const ChainStudy study = study_chain(options.file, deadline, bus_options(options, session.catalogue()),
                                       session.catalogue(), model_of(session), read_rates(options.rates));
  if (options.json || options.csv)
    fmt::print("{}", options.json ? to_json(study) : to_csv(study));
  else
    print_fitted(to_table(study), 4);
  return study.bound.ok() ? exit_success : exit_failure;
}

int trace(const Options& options, Session& session) {
  if (options.set.empty()) narrow("analyse trace", session);
  Options how = options;
  how.file = options.set;
  const TraceStudy study =
      study_trace(options.file, options.set, bus_options(how, session.catalogue()), session.catalogue(),
                  options.set.empty() ? model_of(session) : nullptr, read_rates(options.rates));
  if (options.json || options.csv)
    fmt::print("{}", options.json ? to_json(study) : to_csv(study));
  else
    print_fitted(to_table(study), 4);
  return study.passes() ? exit_success : exit_failure;
}

void add_outputs(Verb verb, Options& options) {
  const auto json = verb.add_flag("--json", options.json, "one object, for programs");
  verb.add_flag("--csv", options.csv, "a line each, times in nanoseconds").excludes(json);
  verb.add_option("--svg", options.svg, "draw the worst case into FILE; - for standard output")
      .type_name("FILE")
      .excludes(json);
}

void add_bus_options(Verb verb, Options& options) {
  verb.add_option("--rates", options.rates,
                  "topic=period, topic=period@priority or topic=off, several; or a file of such lines")
      .type_name("RATE");
  add_bit_rate(verb, "--bitrate", options.bit_rate, "such as 500k or 125000; default: the spec's");
  add_data_bit_rate(verb, "--data-bitrate", options.data_bit_rate,
                    "of CAN FD behind its bit-rate switch, such as 2M; default: the spec's");
  verb.add_option("--lengths", options.lengths,
                  "generic: the longest that any identifier could make a frame; exact: of its identifier. "
                  "Default: generic for a FILE, exact for the robot")
      .one_of({"generic", "exact"});
  verb.add_option("--test", options.test, "exact (default), or sufficient: one instance, for D <= T")
      .one_of({"exact", "sufficient"});
  verb.add_option("--errors", options.errors, "burst=N,every=TIME: N faults at once, and one more every TIME")
      .type_name("MODEL");
}

void add_bus(Verb outer, Session& session, int& exit_code) {
  const auto options = std::make_shared<Options>();
  const auto verb =
      outer.add_inner_verb("bus", "the messages of a CAN bus: the robot's own, or a FILE's",
                           "  amiroctl analyse bus\n"
                           "  amiroctl analyse bus --rates gyro=50ms ring=2ms@high\n"
                           "  amiroctl analyse bus messages.csv --bitrate 125k --svg worst-case.svg\n"
                           "  amiroctl analyse bus --queue di_wheel_drive=fifo\n"
                           "  amiroctl analyse bus --rates ring=4ms@low --assign priorities");
  verb.add_option(
      "FILE", options->file,
      "CSV (name,id,dlc,period_ns,deadline_ns,jitter_ns,node,offset_ns,fd) or a spec, DBC or JSON; "
      "none: the robot's topics");
  add_bus_options(verb, *options);
  verb.add_option("--queue", options->queues,
                  "NODE=fifo: it sends in the order of release; NODE=mailboxes:N: what is in one of its N "
                  "mailboxes is not taken back. Several; default: each node sends its most urgent first")
      .type_name("QUEUE");
  verb.add_option("--assign", options->assign,
                  "identifiers: hand out those that there are; priorities: choose the robot's. So that all "
                  "meet their deadlines, if that is possible")
      .one_of({"identifiers", "priorities"});
  add_outputs(verb, *options);
  verb.callback([options, &session, &exit_code] { exit_code = bus(*options, session); });
}

void add_tasks(Verb outer, Session& session, int& exit_code) {
  const auto options = std::make_shared<Options>();
  const auto verb = outer.add_inner_verb(
      "tasks", "the tasks of a processor",
      "  amiroctl analyse tasks tasks.csv --json\n"
      "  amiroctl analyse tasks di_wheel_drive --context-switch 2us --tick 1ms --tick-cost 3us");
  verb.add_option("FILE|BOARD", options->file,
                  fmt::format("CSV: name,priority,C_ns,T_ns,D_ns,J_ns,B_ns; or one of {}",
                              fmt::join(own_task_sets(), ", ")))
      .required();
  add_duration(verb, "--context-switch", options->context_switch,
               "what one costs; a job pays two. Default: nothing");
  add_duration(verb, "--interrupt", options->interrupt,
               "what each release of each task costs ahead of all priorities. Default: nothing");
  add_duration(verb, "--lock", options->lock,
               "the longest stretch with interrupts off: each task may wait for one. Default: none");
  const auto tick =
      add_duration(verb, "--tick", options->tick, "the system's timer interrupt comes so often");
  add_duration(verb, "--tick-cost", options->tick_cost, "and costs so much. Default: nothing").needs(tick);
  verb.add_flag("--released-by-tick", options->released_by_tick,
                "releases are noticed at ticks only: a tick more jitter for each task")
      .needs(tick);
  add_outputs(verb, *options);
  verb.callback([options, &session, &exit_code] { exit_code = tasks(*options, session); });
}

void add_chain(Verb outer, Session& session, int& exit_code) {
  const auto options = std::make_shared<Options>();
  const auto verb = outer.add_inner_verb("chain", "from a sensor to a motor, over tasks and frames",
                                         "  amiroctl analyse chain chain.csv --deadline 50ms\n"
                                         "  amiroctl analyse chain chain.csv --rates gyro=10ms --json");
  verb.add_option("FILE", options->file, "CSV: hop,set,activation,response_ns,best_ns,period_ns").required();
  add_duration(verb, "--deadline", options->deadline,
               "from an event to the end of the reaction; default: none");
  add_bus_options(verb, *options);
  const auto json = verb.add_flag("--json", options->json, "one object, for programs");
  verb.add_flag("--csv", options->csv, "a line a hop, times in nanoseconds").excludes(json);
  verb.callback([options, &session, &exit_code] { exit_code = chain(*options, session); });
}

void add_trace(Verb outer, Session& session, int& exit_code) {
  const auto options = std::make_shared<Options>();
  const auto verb = outer.add_inner_verb("trace", "a recorded log, held against the bounds",
                                         "  amiroctl analyse trace drive.log\n"
                                         "  amiroctl analyse trace drive.log --set car.dbc --csv");
  verb.add_option("LOG", options->file, "in any format that convert reads; - for standard input").required();
  verb.add_option("--set", options->set,
                  "its messages, CSV or DBC; default: the robot's topics that are in it")
      .type_name("FILE");
  add_bus_options(verb, *options);
  const auto json = verb.add_flag("--json", options->json, "one object, for programs");
  verb.add_flag("--csv", options->csv, "a line a message, times in nanoseconds").excludes(json);
  verb.callback([options, &session, &exit_code] { exit_code = trace(*options, session); });
}

}  // namespace

void declare_analyse(Verb verb, Session& session, int& exit_code) {
  verb.describe("schedulability analysis of bus and tasks", look_group,
                "  amiroctl analyse bus --rates gyro=50ms ring=2ms@high\n"
                "  amiroctl analyse tasks di_wheel_drive\n"
                "  amiroctl analyse chain chain.csv --deadline 50ms\n"
                "  amiroctl analyse trace drive.log");
  verb.alias("analyze");
  verb.require_verb();
  add_bus(verb, session, exit_code);
  add_tasks(verb, session, exit_code);
  add_chain(verb, session, exit_code);
  add_trace(verb, session, exit_code);
}

}  // namespace ocm::cli
