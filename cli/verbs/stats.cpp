/// How regularly topics come, what is missing, and how full the bus is: of a log, or of the bus as it is.
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/output/printer.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/terminal.hpp"
#include "cli/shared/values.hpp"
#include "cli/stats/assertion.hpp"
#include "cli/stats/report.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/chosen_topics.hpp"
#include "cli/watch/contradictions.hpp"
#include "cli/watch/watching.hpp"
#include "cli/words/command.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli {
namespace {

struct StatsOptions {
  std::vector<std::string> words;
  WatchOptions watch;
  std::vector<std::string> assertions;
  std::optional<std::uint32_t> bit_rate, data_bit_rate;
  bool json = false, csv = false;
};

/// A table on a terminal that is drawn again over the last one.
class Screen {
 public:
  Screen() : terminal_(can_redraw(STDOUT_FILENO)) {}
  [[nodiscard]] bool terminal() const noexcept { return terminal_; }

  /// The lines fit `columns`.
  void show(const std::vector<std::string>& lines) {
    if (!terminal_) return print(lines, lines.size());
    const std::size_t before =
        std::exchange(drawn_, std::min(lines.size(), terminal_size(STDOUT_FILENO).rows - 1));
    print(lines, drawn_, before);
  }
  /// What a table should fit into.
  [[nodiscard]] static std::size_t columns() { return columns_of_output(); }
  /// The last one, in full.
  void finish(const std::vector<std::string>& lines) { print(lines, lines.size(), drawn_); }

 private:
  /// In place of this many lines above. From the first column on: the terminal may have written ^C there.
  static void print(const std::vector<std::string>& lines, std::size_t rows, std::size_t drawn = 0) {
    std::string text;
    if (drawn > 0) text = fmt::format("\r\x1b[{}A\x1b[J", drawn);
    for (std::size_t i = 0; i < std::min(rows, lines.size()); ++i) text += lines[i] + '\n';
    write_out(text);
  }

  bool terminal_;
  std::size_t drawn_ = 0;
};

std::vector<stats::Assertion> read_assertions(const std::vector<std::string>& texts,
                                              const protocol::Catalogue& catalogue) {
  std::vector<stats::Assertion> assertions;
  for (const auto& text : texts) {
    auto assertion = stats::Assertion::parse(text, catalogue);
    if (!assertion) fail({"stats: " + assertion.error.what, assertion.error.remedy}, exit_usage);
    assertions.push_back(std::move(assertion.value));
  }
  return assertions;
}

/// Those that are typed, else those that the spec has for the interface; 0: neither says it, as of many DBC
/// files.
measure::BitRates chosen_bit_rates(Session& session, const StatsOptions& options,
                                   std::string_view interface) {
  spec::BusModel bus;
  bus.bit_rate = session.catalogue().bit_rate;
  if (!session.spec_files.empty()) bus = session.spec().model().bus(interface);
  return {options.bit_rate.value_or(bus.bit_rate), options.data_bit_rate.value_or(bus.data_bit_rate)};
}

/// Of each bus, for its figures are its own.
void tell_contradictions(const stats::Report& report, const protocol::Catalogue& catalogue, Seen where) {
  for (const stats::Bus& bus : report.buses) {
    const auto& counters = bus.figures.counters;
    const std::string beginning = report.buses.size() > 1 ? bus.name + ": " : "";
    cli::tell_contradictions({counters.frames - counters.errors, counters.unknown + counters.fd,
                              counters.wrong_dlc, bus.figures.wrong_length},
                             catalogue, where, beginning);
  }
}

bool any_shown(const stats::Report& report, const stats::Shown& shown) {
  for (const stats::Bus& bus : report.buses)
    for (const auto& topic : bus.figures.topics)
      if (std::find(shown.begin(), shown.end(), topic.topic) != shown.end()) return true;
  return false;
}
std::vector<std::string_view> names_of(const stats::Shown& shown) {
  std::vector<std::string_view> names;
  for (const auto* topic : shown) names.push_back(topic->name);
  return names;
}

void run(Session& session, const StatsOptions& options, int& exit_code) {
  const auto& catalogue = session.catalogue();
  const auto means_topic = [&catalogue](std::string_view word) {
    return std::any_of(catalogue.topics.begin(), catalogue.topics.end(), [&](const protocol::Topic& topic) {
      return words::find_topic(catalogue, word) == &topic || words::is_in_group(topic, word);
    });
  };
  Words words = split_words("stats", options.words, means_topic);
  const auto shown = chosen_topics("stats", catalogue, words.others);
  const auto assertions = read_assertions(options.assertions, catalogue);
  stats::Collector collector{
      catalogue, [&](std::string_view interface) { return chosen_bit_rates(session, options, interface); }};
  Watching watching{session, options.watch, std::move(words.files)};

  const ListenedUntil listened;
  const bool table = !options.json && !options.csv;
  Screen screen;
  const auto report = [&](std::optional<base::Time> now) {
    stats::Report all{catalogue.robot, watching.source(), collector.buses(now)};
    all.never_came = collector.never_came(all.buses);
    return all;
  };
  // In a pipe, a command with a given end prints at the end.
  const bool tell = table && (screen.terminal() || !watching.ends());
  watching.run(
      [&](auto entries, const auto& interfaces) { collector.take(entries, interfaces); },
      [&](auto interface, auto frames) { collector.lost(interface, frames); },
      [&] {
        if (tell && collector.any())
          screen.show(stats::to_table(report(listened.now()), shown, session.colour(), Screen::columns()));
      });

  std::optional<base::Time> now;
  if (watching.live() && collector.any()) now = listened.now();
  const auto result = report(now);
  if (options.json)
    write_out(stats::to_json(result, shown, assertions));
  else if (options.csv)
    write_out(stats::to_csv(result, shown));
  else
    screen.finish(stats::to_table(result, shown, session.colour(), Screen::columns()));
  // A CSV file has a line for what came on a bus.
  if (const std::string text = stats::never_came_text(result, shown); options.csv && !text.empty())
    remark(text);
  tell_contradictions(result, catalogue, watching.live() ? Seen::live : Seen::in_log);
  if (!collector.any() && interrupted() == 0) {
    remark(fmt::format("amiroctl: stats: no frame came from {}", watching.source()));
    if (watching.live()) tell_to_ask(catalogue, shown);
    exit_code = exit_failure;
  } else if (!shown.empty() && !any_shown(result, shown) && interrupted() == 0) {
    remark(fmt::format("amiroctl: stats: nothing came of {}", fmt::join(names_of(shown), ", ")));
    if (watching.live()) tell_to_ask(catalogue, shown);
    exit_code = exit_failure;
  }
  for (const auto& assertion : assertions) {
    const auto verdict = assertion.check(result.buses);
    if (verdict.holds) continue;
    remark("does not hold: " + verdict.said);
    exit_code = exit_failure;
  }
  exit_code = exit_code_after_interrupt(watching.ending(exit_code));
}

}  // namespace

void declare_stats(Verb verb, Session& session, int& exit_code) {
  verb.describe("rates, jitter, gaps and losses of topics, and the load of the bus", log_group,
                "  amiroctl stats                          the bus, a table that is renewed every second\n"
                "  amiroctl stats gyro --duration 10s\n"
                "  amiroctl stats drive.log --json | jq '.buses[0].topics'\n"
                "  amiroctl stats drive.log --assert 'gyro.rate>1.9' --assert 'bus.load<40%'");
  verb.alias("hz");
  const auto options = std::make_shared<StatsOptions>();
  verb.add_option("words", options->words,
                  "logs, any format; none, or live: the bus. Topics to show; default: all")
      .type_name("[FILE ...|live] [TOPIC ...]");
  add_watch_options(verb, options->watch);
  verb.add_option("--assert", options->assertions,
                  "exit 1 unless this holds, such as 'gyro.rate>1.9'; may be given again")
      .type_name("EXPRESSION")
      .takes({ValueKind::text, false, stats::assertion_form, {}, stats::Assertion::is_well_formed})
      .one_a_mention();
  add_bit_rate(verb, "--bitrate", options->bit_rate, "such as 500k or 125000; default: the spec's");
  add_data_bit_rate(verb, "--data-bitrate", options->data_bit_rate,
                    "of CAN FD behind its bit-rate switch, such as 2M; default: the spec's");
  const auto json = verb.add_flag("--json", options->json, "one object, for programs");
  verb.add_flag("--csv", options->csv, "a line a topic, times in nanoseconds").excludes(json);
  verb.callback([options, &session, &exit_code] { run(session, *options, exit_code); });
}

}  // namespace ocm::cli
