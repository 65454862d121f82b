#include "cli/command/drive_by_pad.hpp"

#include <algorithm>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "cli/command/gamepad.hpp"
#include "cli/command/operated_bus.hpp"
#include "cli/command/pad_drive.hpp"
#include "cli/output/printer.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/terminal.hpp"

namespace ocm::cli {
namespace {

words::KeySpeed pad_speed(const PadDriveOptions& options, std::size_t which, std::string_view usual) {
  auto speed =
      words::KeySpeed::parse(which < options.speeds.size() ? std::string_view{options.speeds[which]} : usual);
  if (!speed) fail({"drive: --gamepad: " + speed.error.what, speed.error.remedy}, exit_usage);
  return std::move(speed.value);
}

/// One line, drawn over the one before; a line of its own where that is not possible: a file, TERM=dumb.
void show_line(std::string_view text) {
  if (!can_redraw(STDOUT_FILENO)) return write_out(fmt::format("{}\n", text));
  std::string line = fmt::format("{}   Start quits", text);
  line.resize(std::min(line.size(), terminal_size(STDOUT_FILENO).columns - 1));
  write_out("\r\x1b[K" + line);
}

}  // namespace

int drive_by_pad(Session& session, const PadDriveOptions& options) {
  const protocol::Catalogue& catalogue = session.catalogue_on_bus(true);
  PadDrive drive{catalogue, options.command, pad_speed(options, 0, "10cm/s"),
                 pad_speed(options, 1, "45deg/s"), show_line};
  auto pad = open_gamepad(options.device);
  if (!pad) fail({"drive: " + pad.error.what, pad.error.remedy});
  catch_interrupts();
  catch_hangups();
  catch_broken_pipe();
  const auto bus = open_to_command(session, "drive");
  remark("gamepad: " + (*pad)->name());
  Timeline timeline{*bus, catalogue, "drive", options.others, options.confirm, {}};
  PadDrive::End end = PadDrive::End::signal;
  if (timeline.listen_first()) {
    timeline.expect_no_other();
    end = drive.run(**pad, timeline);
    if (can_redraw(STDOUT_FILENO)) write_out("\n");
  }
  const bool fine = timeline.finish();
  if (end == PadDrive::End::gone)
    fail({fmt::format("drive: gamepad {} is gone; the motors rest", options.device),
          "plug it in or switch it on again, and begin the drive again"});
  return exit_code_after_interrupt(fine && end != PadDrive::End::signal ? exit_success : exit_failure);
}

}  // namespace ocm::cli
