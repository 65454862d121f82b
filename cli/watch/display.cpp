#include "cli/watch/display.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "cli/shared/messages.hpp"
#include "cli/watch/contradictions.hpp"

namespace ocm::cli {
Display::Display(std::string_view verb, Session& session, const FormatOptions& options)
    : receiver_(session.catalogue(), client::Transport::together),
      printer_(chosen_output(verb, session.catalogue(), session.colour(), options)) {
  printer_.flush();
}

bool Display::any_fault() noexcept {
  const auto transport = receiver_.transport_counters(last_);
  return counters().faults() + counters().unselected != 0 || transport.lost() + transport.malformed != 0;
}

void Display::summarise(std::uint64_t lost, base::Time until) {
  last_ = std::max(last_, until);
  const auto& seen = receiver_.counters();
  std::string text = fmt::format("{}, {}", counted(seen.frames, "frame"), counted(seen.samples, "sample"));
  add_count(text, seen.commands, "command", "");
  add_count(text, seen.unknown, "of unknown identifier");
  add_count(text, seen.remote, "remote");
  add_count(text, seen.fd, "of CAN FD");
  add_count(text, seen.wrong_dlc, "of wrong length");
  add_count(text, seen.incomplete, "incomplete sample", "");
  add_count(text, seen.errors, "error frame", "");
  add_count(text, lost, "lost in the receive queue");
  add_count(text, seen.unselected, "frame", "whose selector chooses no field");
  remark(text);
  summarise_transport();
}

/// Nothing where there was none.
void Display::summarise_transport() {
  const std::uint64_t frames = counters().transport;
  const j1939::TransportCounters seen = receiver_.transport_counters(last_);
  if (frames + seen.complete == 0) return;
  std::string text = fmt::format("transport protocol of J1939: {} put together, {}",
                                 counted(seen.complete, "message"), counted(frames, "other frame"));
  add_count(text, seen.lost_packet, "message", "lost a packet");
  add_count(text, seen.wrong_sequence, "had a packet of a wrong number");
  add_count(text, seen.aborted, "aborted");
  add_count(text, seen.timed_out, "timed out");
  add_count(text, seen.replaced, "followed by the next before the end");
  add_count(text, seen.no_session, "too many at a time");
  add_count(text, seen.bad_size, "of an impossible size");
  add_count(text, receiver_.transports_open(), "not at the end yet");
  add_count(text, seen.stray, "packet", "of no message");
  add_count(text, seen.malformed, "frame", "of another form");
  remark(text);
}

void Display::tell_contradictions(Seen where) const {
  const auto& seen = receiver_.counters();
  const Contradictions found{seen.frames - seen.errors, seen.unknown + seen.fd, seen.wrong_dlc,
                             wrong_length_};
  cli::tell_contradictions(found, receiver_.catalogue(), where);
}

}  // namespace ocm::cli
