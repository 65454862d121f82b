#include "cli/watch/display.hpp"

#include <algorithm>
#include <unistd.h>

#include <fmt/format.h>

#include "cli/shared/messages.hpp"
#include "cli/shared/terminal.hpp"
#include "cli/watch/contradictions.hpp"

namespace ocm::cli {
namespace {

Format format_of(const DisplayOptions& options) {
  if (options.json) return Format::json;
  if (options.csv) return Format::csv;
  if (options.raw) return Format::raw;
  if (options.pretty || isatty(STDOUT_FILENO) != 0) return Format::pretty;
  return Format::json;
}

Selection selection_of(std::string_view verb, const protocol::Catalogue& catalogue,
                       const DisplayOptions& options) {
  if (options.raw && !options.fields.empty())
    fail({fmt::format("{}: --field with --raw, which shows no fields", verb),
          "leave one of them out; topics select frames"},
         exit_usage);
  auto selection = Selection::of(catalogue, options.fields);
  if (!selection)
    fail({fmt::format("{}: {}", verb, selection.error.what), selection.error.remedy}, exit_usage);
  return std::move(*selection);
}

}  // namespace

void add_display_options(Verb verb, DisplayOptions& options) {
  auto format = verb.add_choice("Format", "default: pretty on a terminal, JSON lines otherwise");
  format.add_flag("--pretty", options.pretty, "a line a sample, values with units");
  format.add_flag("--json", options.json, "an object a frame");
  format.add_flag("--csv", options.csv,
                  "a line a field: time, topic, field, value, unit; with --field a column a field");
  format.add_flag("--raw", options.raw, "candump's log line");
  verb.add_option("--field", options.fields,
                  "only this, such as gyroscope.x or odometry.velocity.x; repeatable")
      .type_name("NAME")
      .one_a_mention();
}

Display::Display(std::string_view verb, Session& session, const DisplayOptions& options)
    : receiver_(session.catalogue(), client::Transport::together),
      printer_(make_output(format_of(options), session.catalogue(),
                           selection_of(verb, session.catalogue(), options), session.colour(),
                           columns_of_output)) {
  printer_.flush();
}

bool Display::any_fault() noexcept {
  const auto transport = receiver_.transport_counters(last_);
  return counters().faults() != 0 || transport.lost() + transport.malformed != 0;
}

void Display::summarise(std::uint64_t lost, base::Time until) {
  last_ = std::max(last_, until);
  const auto& seen = receiver_.counters();
  std::string text = fmt::format("{} frames, {} samples", seen.frames, seen.samples);
  const auto add = [&text](std::uint64_t count, std::string_view what) {
    if (count != 0) text += fmt::format(", {} {}", count, what);
  };
  add(seen.commands, "commands");
  add(seen.unknown, "of unknown identifier");
  add(seen.remote, "remote");
  add(seen.fd, "of CAN FD");
  add(seen.wrong_dlc, "of wrong length");
  add(seen.incomplete, "incomplete samples");
  add(seen.errors, "error frames");
  add(lost, "lost in the receive queue");
  remark(text);
  summarise_transport();
}

/// Nothing where there was none.
void Display::summarise_transport() {
  const std::uint64_t frames = counters().transport;
  const j1939::TransportCounters seen = receiver_.transport_counters(last_);
  if (frames + seen.complete == 0) return;
  std::string text = fmt::format("transport protocol of J1939: {} messages put together, {} other frames",
                                 seen.complete, frames);
  const auto add = [&text](std::uint64_t count, std::string_view what) {
    if (count != 0) text += fmt::format(", {} {}", count, what);
  };
  add(seen.lost_packet, "messages lost a packet");
  add(seen.wrong_sequence, "had a packet of a wrong number");
  add(seen.aborted, "aborted");
  add(seen.timed_out, "timed out");
  add(seen.replaced, "followed by the next before the end");
  add(seen.no_session, "too many at a time");
  add(seen.bad_size, "of an impossible size");
  add(receiver_.transports_open(), "not at the end yet");
  add(seen.stray, "packets of no message");
  add(seen.malformed, "frames of another form");
  remark(text);
}

void Display::tell_contradictions(Seen where) const {
  const auto& seen = receiver_.counters();
  const Contradictions found{seen.frames - seen.errors, seen.unknown + seen.fd, seen.wrong_dlc,
                             wrong_length_};
  cli::tell_contradictions(found, receiver_.catalogue(), where);
}

}  // namespace ocm::cli
