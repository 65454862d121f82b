#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/shared/buses.hpp"
#include "cli/shared/clock.hpp"
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

/// What comes from a bus, shown until something ends it.
class Listening {
 public:
  Listening(Session& session, const ListenOptions& options)
      : options_(&options),
        catalogue_(&session.catalogue()),
        choice_("listen", *catalogue_, options.choice),
        bus_(open(session)),
        display_("listen", session, options.format),
        awaited_(awaited_topics(*catalogue_, choice_, options)),
        commands_wanted_(options.commands || std::any_of(choice_.topics().begin(), choice_.topics().end(),
                                                         [](const protocol::Topic* topic) {
                                                           return topic->kind == protocol::Kind::actuator;
                                                         })),
        any_will_do_(awaited_.empty() || !options.choice.conditions.empty()),
        any_(awaited_.empty() && (!options.choice.filters.empty() || !options.choice.groups.empty())) {
    choice_.on_interface(0, bus_->name());
    display_.on_interface(0, bus_->name());
  }

  /// Returns the exit code.
  [[nodiscard]] int run() {
    Live live{*bus_, [&] { display_.flush(); }};
    const auto take = [this](const transport::ReceivedAny& received) { return this->take(received); };
    Over over = live.receive_any(std::min(end(), begin_ + silence), take);
    if (over == Over::time) tell_why_nothing_is_shown();
    while (over == Over::time && Clock::now() < end()) over = live.receive_any(end(), take);
    display_.flush();
    display_.summarise(bus_->counters().lost, listened_.now());
    display_.tell_contradictions(Seen::live);
    if (over == Over::gone) fail(bus_->failure());
    if (over == Over::time) expect_answer(bus_->name());
    int exit_code = exit_success;
    // As with candump -n: frames that were expected and did not come are a failure.
    if (over == Over::time && options_->count != 0) {
      remark(fmt::format("amiroctl: listen: expected {}, only {} came in time",
                         counted(options_->count, "frame"), display_.shown()));
      exit_code = exit_failure;
    }
    if (options_->strict && (display_.any_fault() || bus_->counters().lost != 0)) exit_code = exit_failure;
    return exit_code_after_interrupt(exit_code);
  }

 private:
  /// Mistakes in words come first: of those nothing on a bus is to be seen.
  [[nodiscard]] std::unique_ptr<transport::Bus> open(Session& session) const {
    choice_.expect_any_of(options_->format.fields);
    catch_interrupts();
    auto bus = session.open_bus();
    choice_.subscribe(*bus, options_->commands);
    return bus;
  }

  [[nodiscard]] Clock::time_point end() const {
    return std::min(time_after(begin_, options_->timeout.value_or(base::Duration::max())),
                    time_after(last_, options_->idle_timeout.value_or(base::Duration::max())));
  }

  /// Whether it goes on.
  bool take(const transport::ReceivedAny& received) {
    using client::Meaning;
    const log::Entry entry{received.time, received.frame};
    any_ |= any_will_do_;
    if (!choice_.has(entry)) return true;
    const client::Reception reception = display_.understand(entry);
    any_ |= std::find(awaited_.begin(), awaited_.end(), reception.topic) != awaited_.end();
    if (!choice_.shows(entry, reception)) return true;
    const auto meaning = reception.meaning;
    const bool command = meaning == Meaning::request || meaning == Meaning::set_point;
    if (command && !commands_wanted_) return true;
    last_ = Clock::now();
    display_.show(bus_->name(), entry, reception);
    if (meaning == Meaning::sample) sampled_ = reception.topic;
    return options_->count == 0 || display_.shown() < options_->count;
  }

  /// After a while in which nothing was.
  void tell_why_nothing_is_shown() {
    if (!any_) tell_to_ask(*catalogue_, awaited_);
    if (sampled_ != nullptr && display_.shown() == 0)
      remark(
          fmt::format("listen: {} comes, and no field that was chosen has a value; what is derived has "
                      "none beyond its range: see `amiroctl info {}`",
                      sampled_->name, sampled_->name));
  }

  const ListenOptions* options_;
  const protocol::Catalogue* catalogue_;
  Choice choice_;
  std::unique_ptr<transport::Bus> bus_;
  Display display_;
  std::vector<const protocol::Topic*> awaited_;
  bool commands_wanted_;
  bool any_will_do_;  ///< to show that something is sent: where there are conditions not all meet them
  bool any_;          ///< of what is awaited has come; of what an identifier chooses nothing could be asked
  const protocol::Topic* sampled_ = nullptr;  ///< the newest sample's
  ListenedUntil listened_;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point last_ = begin_;  ///< that something was shown
};

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
  verb.callback([options, &session, &exit_code] { exit_code = Listening{session, *options}.run(); });
}

}  // namespace ocm::cli
