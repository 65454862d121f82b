#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "ocm/log/playback.hpp"

#include "cli/logs/opened_log.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/choice.hpp"
#include "cli/watch/display.hpp"
#include "cli/words/topics.hpp"

namespace ocm::cli {
namespace {

struct DecodeOptions {
  std::vector<std::string> files;
  ChoiceOptions choice;
  FormatOptions format;
  std::string from;
  std::optional<base::Duration> since, until;
  std::uint64_t count = 0;
  bool strict = false;
};

/// Which frames are looked at: the chosen ones, within the chosen time.
class Window {
 public:
  Window(const protocol::Catalogue& catalogue, const DecodeOptions& options)
      : choice_("decode", catalogue, options.choice) {
    choice_.expect_any_of(options.format.fields);
    since_ = options.since.value_or(since_);
    until_ = options.until.value_or(until_);
  }

  /// A condition holds by what came before the window, too.
  [[nodiscard]] bool has(const log::Entry& entry) {
    if (!begin_) begin_ = entry.time;
    const base::Duration at = log::Playback::distance(entry.time, *begin_);
    return choice_.has(entry) && at >= since_ && at <= until_;
  }
  void on_interface(std::uint16_t number, std::string_view name) { choice_.on_interface(number, name); }
  [[nodiscard]] bool shows(const log::Entry& entry, const client::Reception& reception) {
    return choice_.shows(entry, reception);
  }

 private:
  Choice choice_;
  std::optional<base::Time> begin_;
  base::Duration since_ = base::Duration::min();
  base::Duration until_ = base::Duration::max();
};

struct Decoding {
  Display display;
  Window window;
  std::uint64_t most = 0;    ///< lines to show; 0: all
  std::uint64_t frames = 0;  ///< of the logs, chosen or not
  bool unreadable = false;
  bool ended_early = false;

  [[nodiscard]] bool over() const { return interrupted() != 0 || (most != 0 && display.shown() >= most); }

  void take(std::span<const log::Entry> entries, const log::Interfaces& interfaces) {
    for (std::size_t i = 0; i < interfaces.size() && display.has_buses(); ++i) {
      const auto number = static_cast<std::uint16_t>(i);
      window.on_interface(number, interfaces.name(number));
      display.on_interface(number, interfaces.name(number));
    }
    std::uint16_t number = 0;
    std::string_view name = interfaces.name(number);
    for (const auto& entry : entries) {
      if (over()) return;
      ++frames;
      if (!window.has(entry)) continue;
      const client::Reception reception = display.understand(entry);
      if (!window.shows(entry, reception)) continue;
      if (entry.interface != number) name = interfaces.name(number = entry.interface);
      display.show(name, entry, reception);
    }
  }

  void read(logs::OpenedLog& log) {
    std::array<log::Entry, log::batch> entries;
    while (!over()) {
      const std::size_t count = log.reader().read(entries);
      if (count == 0) break;
      take(std::span{entries}.first(count), log.reader().interfaces());
      if (count < entries.size()) display.flush();  // a pipe from a live bus: now, not with the next frames
    }
    display.flush();
    if (!over()) tell_lost(log);  // it stands at the end, or anywhere
    unreadable |= log.complain();
    ended_early |= log.ended_early();
  }

  /// What the log itself says that it lacks.
  static void tell_lost(logs::OpenedLog& log) {
    const auto& recorded = log.reader().recorded();
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      if (recorded[i].dropped == 0) continue;
      const std::string_view name = log.reader().interfaces().name(static_cast<std::uint16_t>(i));
      remark(fmt::format("{}: {} of {} lost while it was recorded",
                         log.path() == "-" ? "the standard input" : log::Complaints::printable(log.path()),
                         counted(recorded[i].dropped, "frame"),
                         name.empty() ? "a bus without a name" : log::Complaints::printable(name)));
    }
  }
};

/// Frames that are of topics of this robot.
std::uint64_t understood(const Display& display) {
  const auto& seen = display.counters();
  return seen.frames - seen.unknown - seen.remote - seen.fd - seen.wrong_dlc - seen.errors - seen.transport;
}

void decode(Session& session, const DecodeOptions& options, int& exit_code) {
  const auto& catalogue = session.catalogue();
  catch_interrupts();
  Decoding decoding{Display{"decode", session, options.format}, Window{catalogue, options}, options.count};
  if (options.since && options.until && *options.until < *options.since)
    fail({"decode: --until is before --since", "both count from the first frame of the log"}, exit_usage);
  // A topic among the files is better known before the first of them is printed.
  for (const auto& file : options.files)
    if (words::find_topic(catalogue, file) != nullptr && !std::filesystem::exists(file))
      fail({fmt::format("decode: '{}' is a topic, and no file", file),
            fmt::format("--topic {} chooses it", file)},
           exit_usage);
  const std::vector<std::string> standard_input{"-"};
  const auto& files = options.files.empty() ? standard_input : options.files;
  for (const auto& file : files) refuse_same_file("decode", file, "-");
  for (const auto& file : files) {
    if (decoding.over()) break;
    logs::OpenedLog log{file, options.from, catalogue};
    decoding.read(log);
  }
  Display& display = decoding.display;
  display.summarise(0);
  if (decoding.frames == 0)
    remark("no frame to decode");
  else if (display.shown() == 0 && (display.counters().frames == 0 || understood(display) != 0) &&
           !decoding.over())
    remark(decoding.frames == 1 ? "the one frame does not match"
                                : fmt::format("none of {} frames matches", decoding.frames));
  display.tell_contradictions(Seen::in_log);
  const bool not_all = decoding.unreadable || display.any_fault();
  if (understood(display) == 0 || display.shown() == 0 || decoding.ended_early || (options.strict && not_all))
    exit_code = exit_failure;
  exit_code = exit_code_after_interrupt(exit_code);
}

}  // namespace

void declare_decode(Verb verb, Session& session, int& exit_code) {
  verb.describe("say what the frames of a log mean", log_group,
                "  amiroctl decode drive.log | jq -c .fields\n"
                "  amiroctl decode drive.pcapng --csv --field gyroscope.z --field odom.velocity.x\n"
                "  amiroctl --spec car.dbc decode drive.log --where 'Engine.Speed>3000'\n"
                "  amiroctl decode drive.log.zst --topic power --since 10s --until 1min --pretty\n"
                "  candump -L can0 | amiroctl decode --pretty\n"
                "  amiroctl decode drive.log | amiroctl encode    the log again, to the byte");
  const auto options = std::make_shared<DecodeOptions>();
  verb.add_option("files", options->files,
                  "logs of any format, one after another; default: - (standard input)")
      .type_name("[FILE ...]");
  add_format_options(verb, options->format);
  verb.add_option("--topic", options->choice.topics, "only this topic; repeatable")
      .type_name("TOPIC")
      .one_a_mention();
  add_choice_options(verb, options->choice);
  verb.add_option("--from", options->from, "the format of the logs; default: what they begin with says it")
      .type_name("FORMAT")
      .takes(accepted_words(logs::readable_formats()));
  add_duration(verb, "--since", options->since, "from this time after the first frame");
  add_duration(verb, "--until", options->until, "up to this time after the first frame");
  verb.add_option("-n,--count", options->count, "end after so many").type_name("N").positive();
  verb.add_flag("--strict", options->strict, "exit 1 when any line or frame could not be decoded");
  verb.callback([options, &session, &exit_code] { decode(session, *options, exit_code); });
}

}  // namespace ocm::cli
