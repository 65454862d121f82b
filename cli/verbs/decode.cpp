#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "ocm/client/frame_index.hpp"

#include "cli/logs/opened_log.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verbs.hpp"
#include "cli/watch/chosen_topics.hpp"
#include "cli/watch/display.hpp"

namespace ocm::cli {
namespace {

struct DecodeOptions {
  std::vector<std::string> files;
  std::vector<std::string> topics;
  DisplayOptions display;
  std::string from;
  std::optional<base::Duration> since, until;
  std::uint64_t count = 0;
  bool strict = false;
};

/// Which frames are looked at: those of the chosen topics and messages, within the chosen time.
class Window {
 public:
  Window(const protocol::Catalogue& catalogue, const DecodeOptions& options)
      : chosen_(chosen_topics("decode", catalogue, options.topics)) {
    since_ = options.since.value_or(since_);
    until_ = options.until.value_or(until_);
    if (!chosen_.empty()) index_ = client::FrameIndex{catalogue};
  }

  [[nodiscard]] bool has(const log::Entry& entry) {
    if (!begin_) begin_ = entry.time;
    const base::Duration at = entry.time - *begin_;
    if (at < since_ || at > until_) return false;
    return chosen_.empty() || is_of_chosen(entry);
  }

 private:
  /// Its data, and what is said to it. No topic has frames of CAN FD.
  [[nodiscard]] bool is_of_chosen(const log::Entry& entry) const {
    const auto* const topic = index_.subject(entry.id, entry.format).topic;
    return topic != nullptr && (topic->is_message() || !entry.is_fd()) &&
           std::find(chosen_.begin(), chosen_.end(), topic) != chosen_.end();
  }

  std::vector<const protocol::Topic*> chosen_;  // none: all
  client::FrameIndex index_;
  std::optional<base::Time> begin_;
  base::Duration since_ = base::Duration::min();
  base::Duration until_ = base::Duration::max();
};

struct Decoding {
  Display display;
  Window window;
  std::uint64_t most = 0;  ///< lines to show; 0: all
  bool unreadable = false;
  bool ended_early = false;

  [[nodiscard]] bool over() const { return interrupted() != 0 || (most != 0 && display.shown() >= most); }

  void take(std::span<const log::Entry> entries, const log::Interfaces& interfaces) {
    for (const auto& entry : entries) {
      if (over()) return;
      if (!window.has(entry)) continue;
      display.understand(entry);
      display.show(interfaces.name(entry.interface), entry);
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
    unreadable |= log.complain();
    ended_early |= log.ended_early();
  }
};

/// Frames that are of topics of this robot.
std::uint64_t understood(const Display& display) {
  const auto& seen = display.counters();
  return seen.frames - seen.unknown - seen.wrong_dlc - seen.errors;
}

void decode(Session& session, const DecodeOptions& options, int& exit_code) {
  const auto& catalogue = session.catalogue();
  catch_interrupts();
  Decoding decoding{Display{"decode", session, options.display}, Window{catalogue, options}, options.count};
  const std::vector<std::string> standard_input{"-"};
  for (const auto& file : options.files.empty() ? standard_input : options.files) {
    if (decoding.over()) break;
    logs::OpenedLog log{file, options.from, catalogue};
    decoding.read(log);
  }
  const Display& display = decoding.display;
  display.summarise(0);
  if (display.counters().frames == 0) remark("no frame to decode");
  display.tell_contradictions("a log of another bus?");
  const bool not_all = decoding.unreadable || display.counters().faults() != 0;
  if (understood(display) == 0 || decoding.ended_early || (options.strict && not_all))
    exit_code = exit_failure;
  exit_code = exit_code_after_interrupt(exit_code);
}

}  // namespace

void add_decode(Verb app, Session& session, int& exit_code) {
  auto verb =
      app.add_verb("decode", "say what the frames of a log mean", log_group,
                   "  amiroctl decode drive.log | jq -c .fields\n"
                   "  amiroctl decode drive.pcapng --csv --field gyroscope.z --field odom.velocity.x\n"
                   "  amiroctl decode drive.log.zst --topic power --since 10s --until 1min --pretty\n"
                   "  candump -L can0 | amiroctl decode --pretty\n"
                   "  amiroctl decode drive.log | amiroctl encode    the log again, to the byte");
  const auto options = std::make_shared<DecodeOptions>();
  verb.add_option("files", options->files,
                  "logs of any format, one after another; default: - (standard input)")
      .type_name("[FILE ...]");
  add_display_options(verb, options->display);
  verb.add_option("--topic", options->topics, "only this topic; repeatable")
      .type_name("TOPIC")
      .one_a_mention();
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
