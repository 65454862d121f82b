#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "ocm/can/any_text.hpp"
#include "ocm/log/playback.hpp"

#include "cli/command/commanding.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/frame_lines.hpp"

namespace ocm::cli {
namespace {

struct SendOptions {
  bool from_input = false;
  bool timed = false;
  bool keep_going = false;
};

/// Holds frames back until as much time has passed since the first as between their times.
class Pace {
 public:
  /// false: a signal came.
  [[nodiscard]] bool wait_for(base::Time time) {
    if (!first_) {
      first_ = time;
      start_ = Clock::now();
    }
    const auto at = time_after(start_, log::Playback::distance(time, *first_));
    for (;;) {
      if (interrupted() != 0) return false;
      const auto left = at - Clock::now();
      if (left.count() <= 0) return true;
      // In pieces, so that a signal that comes just before the wait is seen soon.
      sleep_for(std::min<Clock::duration>(left, std::chrono::milliseconds{200}));
    }
  }

 private:
  std::optional<base::Time> first_;
  Clock::time_point start_;
};

void send_lines(Session& session, const SendOptions& options, bool dry_run, int& exit_code) {
  catch_interrupts();
  const auto bus = dry_run ? nullptr : session.open_bus();
  std::optional<Outgoing> outgoing;
  std::optional<transport::Failure> obstacle;  // in the way of CAN FD frames
  if (bus != nullptr) {
    outgoing.emplace(*bus, "send");
    obstacle = bus->fd_obstacle();
  }
  FrameLines lines{"-", session.catalogue(), options.keep_going};
  Pace pace;
  std::uint64_t sent = 0;
  std::uint64_t errors = 0;
  std::uint64_t fd = 0;  ///< that the bus cannot carry
  const auto report = [&] {
    std::string text = fmt::format("{} {}", counted(sent, "frame"), dry_run ? "read" : "sent");
    add_count(text, errors, "error frame", "left out, which only reports");
    if (fd != 0)
      add_count(text, fd, "CAN FD frame", fmt::format("not sent: {} ({})", obstacle->what, obstacle->remedy));
    add_count(text, lines.bad_lines(), "line", "could not be read");
    remark(text);
    lines.tell_unknown_keys();
  };
  log::Entry entry;
  std::string_view from;
  try {
    while (lines.next(entry, from)) {
      if (entry.format == can::Format::error) {
        ++errors;
        continue;
      }
      const can::AnyFrame frame = entry.frame();
      if (frame.is_fd() && obstacle && !obstacle->what.empty()) {
        ++fd;
        continue;
      }
      if (options.timed && lines.has_time() && !pace.wait_for(entry.time)) break;
      if (dry_run)
        fmt::print("{}\n", can::to_text(frame).view());
      else
        outgoing->send(frame);
      ++sent;
    }
    if (outgoing) outgoing->expect_all_left();
  } catch (const Exit&) {  // the error is said
    report();
    throw;
  }
  report();
  if (lines.failed() || fd != 0) exit_code = exit_failure;
  exit_code = exit_code_after_interrupt(exit_code);
}

}  // namespace

void declare_send(Verb verb, Session& session, int& exit_code) {
  verb.describe("send a frame as it is, or frames from the standard input", act_group,
                "  amiroctl send 205#01840302        magnetometer every 900us, as in the thesis\n"
                "  amiroctl send 1F334455#DEADBEEF   extended identifier\n"
                "  amiroctl send 123#R               remote frame\n"
                "  amiroctl send 123##1DEAD          CAN FD, data at the higher bit rate\n"
                "  amiroctl --bus can0 listen --json | amiroctl --bus can1 send --stdin\n"
                "  amiroctl decode drive.log --topic motors | amiroctl send --stdin --timed");
  const auto commanding =
      std::make_shared<Commanding>(verb, session, "frame in candump notation", Commanding::Sends::raw_frames);
  const auto options = std::make_shared<SendOptions>();
  const auto input =
      verb.add_flag("--stdin", options->from_input,
                    "send what comes in: JSON lines, candump's log lines or frames, one a line");
  input.excludes(verb.option("words"));
  verb.add_flag("--timed", options->timed, "with the distances of their times; default: at once")
      .needs(input);
  verb.add_flag("--keep-going", options->keep_going, "report bad lines and go on; exit 1 at the end")
      .needs(input);
  verb.callback([commanding, options, &session, &exit_code] {
    if (options->from_input) return send_lines(session, *options, commanding->dry_run(), exit_code);
    carry_out(session, *commanding, commanding->parse());
  });
}

}  // namespace ocm::cli
