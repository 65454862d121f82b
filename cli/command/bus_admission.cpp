#include "cli/command/bus_admission.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "ocm/analysis/board_check.hpp"
#include "ocm/analysis/bus_check.hpp"
#include "ocm/analysis/utilisation.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/command/traffic.hpp"
#include "cli/shared/fitted.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/values.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

using analysis::Explained;
using words::to_text;

/// An analysis that takes longer than some tens of milliseconds is not waited for: it counts as a miss.
constexpr analysis::Limits limits{.terms = 1'000'000};

/// The stream that a command asks for, if it does.
std::optional<Stream> stream_of(const client::Command& command) {
  if (command.answers == nullptr || command.frames.size() != 1) return {};
  const auto request = protocol::decode_request(command.frames[0]);
  if (!request || request->mode != protocol::Mode::publish) return {};
  const bool named = command.frames[0].dlc > 1;
  return Stream{command.answers, request->priority,
                named ? request->period.duration() : command.answers->period.duration()};
}

void listen(transport::Bus& bus, Traffic& traffic, RefusalWatch& refusals, base::Duration duration) {
  const auto begin = Live::Clock::now();
  Live{bus}.receive_or_leave(time_after(begin, duration), [&](const can::Received& received) {
    traffic.take(received);
    refusals.take(received);
    return true;
  });
  traffic.end(Live::Clock::now() - begin);
}

/// To the microsecond, for people.
std::string us(std::int64_t ns) {
  return to_text(base::Duration{(ns + (ns < 0 ? -500 : 500)) / 1000 * 1000});
}

/// A stream that is asked for against all that was heard.
class Judgement {
 public:
  Judgement(const protocol::Catalogue& catalogue, Traffic& traffic, const Stream& asked)
      : catalogue_(catalogue),
        traffic_(traffic),
        asked_(asked),
        bus_(check(Traffic::Unheard::left_out)),
        sure_bus_(check(Traffic::Unheard::may_be_late)) {}

  /// Whether the bus can carry it beside what was heard.
  [[nodiscard]] analysis::Decision decide() { return bus_->decide(asked_.period.count()); }
  /// Whether its board would take it beside what was heard.
  [[nodiscard]] bool board_takes() const { return board_takes(asked_.period, Traffic::Unheard::left_out); }

  [[nodiscard]] const BusCheck& bus() const { return *bus_; }
  [[nodiscard]] std::string name(std::uint32_t key) const {
    return key == Traffic::any_other ? "any other frame" : traffic_.line(key).name;
  }

  /// The shortest period above `refused` that passes here, and that the wire carries; none: there is none
  /// below a minute.
  [[nodiscard]] std::optional<base::Duration> shortest(base::Duration refused) {
    constexpr std::int64_t ms = 1'000'000;
    constexpr std::int64_t finest = std::int64_t{UINT16_MAX} * 1000;
    std::int64_t period = 0;
    if (refused.count() < finest) period = least_passing(refused.count(), 1000, finest);
    if (period == 0) period = least_passing(std::max(refused.count(), finest / ms * ms), ms, UINT16_MAX * ms);
    if (period == 0) return {};
    return base::Duration{period};
  }

  /// Whether such a period passes beside whatever may run without having been heard, too.
  [[nodiscard]] bool surely_passes(base::Duration period) {
    return sure_bus_->decide(period.count()).admitted && board_takes(period, Traffic::Unheard::may_be_late);
  }

  void print_table();

 private:
  [[nodiscard]] std::unique_ptr<BusCheck> check(Traffic::Unheard unheard) {
    auto made = std::make_unique<BusCheck>(analysis::CanBus{.bit = analysis::bits_ns(1, catalogue_.bit_rate)},
                                           analysis::CanTest::exact, limits);
    traffic_.fill(*made, asked_, unheard);
    return made;
  }
  [[nodiscard]] bool board_takes(base::Duration period, Traffic::Unheard unheard) const {
    BoardCheck board{catalogue_, asked_.topic->board};
    traffic_.fill(board, {asked_.topic, asked_.priority, period}, unheard);
    return board.fits();
  }
  /// A longer period makes no message later, so halving finds it. In whole steps above `refused`, up to
  /// `limit`; 0: none.
  [[nodiscard]] std::int64_t least_passing(std::int64_t refused, std::int64_t step, std::int64_t limit) {
    const std::int64_t period = bus_->shortest(refused, step, limit);
    std::int64_t low = period / step - 1;
    std::int64_t high = limit / step;
    const auto takes = [&](std::int64_t steps) {
      return board_takes(base::Duration{steps * step}, Traffic::Unheard::left_out);
    };
    if (period == 0 || !takes(high)) return 0;
    while (high - low > 1) {
      const std::int64_t middle = low + (high - low) / 2;
      (takes(middle) ? high : low) = middle;
    }
    return high * step;
  }
  [[nodiscard]] std::string fate(const Explained& result, bool asked, bool surely) const;

  const protocol::Catalogue& catalogue_;
  Traffic& traffic_;
  Stream asked_;
  std::unique_ptr<BusCheck> bus_;       ///< with what was heard
  std::unique_ptr<BusCheck> sure_bus_;  ///< with what may run besides
};

std::string Judgement::fate(const Explained& result, bool asked, bool surely) const {
  if (result.reason == analysis::Reason::misses_deadline)
    return fmt::format("late by {}", us(-result.slack()));
  if (result.reason == analysis::Reason::overloaded) return "never gets through";
  if (!result.ok()) return "no bound found";
  if (asked && !board_takes()) return "its board may refuse it";
  return surely ? "in time" : "not known";
}

void Judgement::print_table() {
  const auto sure_results = sure_bus_->explain(asked_.period.count());
  const auto sure_messages = sure_bus_->messages();
  const bool board_surely_takes = board_takes(asked_.period, Traffic::Unheard::may_be_late);
  const auto surely = [&](std::uint32_t key) {
    if (bus_->is_asked(key) && !board_surely_takes) return false;
    for (std::size_t i = 0; i < sure_results.size(); ++i)
      if (sure_messages[i].key == key) return sure_results[i].ok();
    return false;
  };
  const auto results = bus_->explain(asked_.period.count());
  const auto messages = bus_->messages();
  std::size_t width = 7;
  for (const auto& message : messages)
    if (message.key != Traffic::any_other) width = std::max(width, name(message.key).size());
  print_fitted(fmt::format("{:<8}  {:<{}}  {:>9}  {:>9}  {:>4}  {:>9}  {:>9}  {}\n", "ID", "MESSAGE", width,
                           "PERIOD", "DEADLINE", "BITS", "RESPONSE", "SLACK", "VERDICT"),
               4);
  const std::int64_t load = analysis::utilisation(messages).parts_per_million();
  bool all_known = true;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const std::uint32_t key = messages[i].key;
    if (key == Traffic::any_other) continue;
    const auto& line = traffic_.line(key);
    const auto& result = results[i];
    const std::string verdict = fate(result, bus_->is_asked(key), surely(key));
    all_known = all_known && verdict != "not known";
    print_fitted(fmt::format("{:<8}  {:<{}}  {:>9}  {:>9}  {:>4}  {:>9}  {:>9}  {}{}\n",
                             fmt::format("{:03X}", line.id), line.name, width, us(messages[i].period),
                             us(result.deadline), line.bits, result.bounded() ? us(result.response) : "-",
                             result.bounded() ? us(result.slack()) : "-", verdict,
                             bus_->is_asked(key) ? ", asked for" : ""),
                 4);
  }
  if (!all_known) {
    std::string names;
    for (const auto* topic : traffic_.unheard(asked_))
      names.append(names.empty() ? "" : ", ").append(topic->name);
    print_fitted(fmt::format("not known: in time unless one of these runs unheard, at a period above {} "
                             "(--listen hears more): {}\n",
                             us(traffic_.window().count()), names),
                 4);
  }
  const auto better = shortest(base::Duration{0});
  if (better)
    print_fitted(
        fmt::format("the shortest period that passes beside what was heard is {}\n", to_text(*better)), 4);
  print_fitted(fmt::format("load {}.{} % of {} bit/s at worst; {} heard within {}\n", load / 10'000,
                           load / 1'000 % 10, catalogue_.bit_rate,
                           counted(traffic_.identifiers(), "identifier"), us(traffic_.window().count())),
               4);
}

}  // namespace

void add_admission_options(Verb verb, AdmissionOptions& options) {
  verb.add_flag("--force", options.force, "send it even if the bus could not carry it");
  verb.add_flag("--explain", options.explain, "show what is on the bus, and how late each frame can be");
  add_duration(verb, "--listen", options.listen, "how long to listen to what runs, before asking");
}

void admit(const protocol::Catalogue& catalogue, transport::Bus& bus, const client::Command& command,
           const AdmissionOptions& options, RefusalWatch& refusals) {
  const auto asked = stream_of(command);
  if (!asked || (options.force && !options.explain)) return;
  if (catalogue.bit_rate == 0) return;
  catch_interrupts();
  Traffic traffic{catalogue};
  listen(bus, traffic, refusals, options.listen);
  Judgement judgement{catalogue, traffic, *asked};
  const auto decision = judgement.decide();
  std::string who;
  bool own = false;
  if (decision.late != analysis::no_index) {
    const std::uint32_t key = judgement.bus().messages()[decision.late].key;
    who = judgement.name(key);
    own = judgement.bus().is_asked(key);
  }
  if (options.explain) judgement.print_table();
  const base::Duration part_period = asked->topic->shortest_period;
  const auto offer = [&](base::Duration period) {
    const std::string of_part = period < part_period
                                    ? fmt::format("; the part samples every {}", to_text(part_period))
                                    : std::string{};
    if (judgement.surely_passes(period))
      return fmt::format("the shortest period that passes is {}{}", to_text(period), of_part);
    return fmt::format(
        "the shortest period that passes beside what was heard within {} is {} (--listen hears more){}",
        to_text(options.listen), to_text(period), of_part);
  };
  if (decision.admitted || options.force) {
    if (asked->period < part_period)
      remark(fmt::format("publish: the part samples {} every {}: samples will be repeated",
                         asked->topic->name, to_text(part_period)));
    // Its board decides about it, and says so; this is what it would take. It knows of streams that were not
    // heard here, so that only what passes beside those, too, helps after its refusal.
    if (!judgement.board_takes())
      if (const auto better = judgement.shortest(asked->period); better && judgement.surely_passes(*better))
        refusals.offer(offer(*better) + "; --explain shows all");
    return;
  }

  const Explained& why = decision.why;
  std::string what = fmt::format("publish: {} every {} at {} does not fit on the bus: {}{} ",
                                 asked->topic->name, to_text(asked->period), protocol::name(asked->priority),
                                 who, own ? "" : ", which runs already,");
  if (why.reason == analysis::Reason::misses_deadline)
    what += fmt::format("would miss its deadline of {} by {}", us(why.deadline), us(-why.slack()));
  else if (why.reason == analysis::Reason::overloaded)
    what += "would never get through: it and what is more urgent ask for all there is, or more";
  else
    what += std::string{analysis::describe(why.reason)};
  const auto better = judgement.shortest(asked->period);
  std::string remedy = better ? offer(*better)
                       : asked->priority == protocol::Priority::low
                           ? "no period passes: stop something first"
                           : "no period passes: ask at a lower priority, or stop something first";
  fail({what, remedy + "; --explain shows all, --force sends it anyway"});
}

}  // namespace ocm::cli
