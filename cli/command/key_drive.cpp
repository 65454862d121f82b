#include "cli/command/key_drive.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "cli/command/operated_bus.hpp"
#include "cli/output/printer.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/key_input.hpp"
#include "cli/shared/terminal.hpp"
#include "cli/words/steering.hpp"

namespace ocm::cli {
namespace {

using namespace std::chrono_literals;
using words::Direction;
using words::KeySpeed;
using words::Steering;

constexpr std::array<std::string_view, 2> stop_words{"drive", "stop"};
/// So soon a key is noticed.
constexpr base::Duration look_interval = 20ms;

KeySpeed speed_of(const KeyDriveOptions& options, std::size_t which, std::string_view usual) {
  auto speed =
      KeySpeed::parse(which < options.speeds.size() ? std::string_view{options.speeds[which]} : usual);
  if (!speed) fail({"drive: --keys: " + speed.error.what, speed.error.remedy}, exit_usage);
  return std::move(speed.value);
}

class KeyDrive {
 public:
  KeyDrive(Session& session, const KeyDriveOptions& options)
      : options_(&options),
        parser_(session.catalogue_on_bus(true), "amiroctl "),
        forward_(speed_of(options, 0, "10cm/s")),
        turning_(speed_of(options, 1, "45deg/s")) {
    // What a person asks for now is within the limits, or is refused before anything moves.
    if (const auto error = beyond()) fail({"drive: --keys: " + error->what, error->remedy}, exit_usage);
  }

  /// The motors were set to rest, and no key is read any more: so it stays in the terminal.
  void show_end() {
    note_.clear();
    show({}, Keys::over);
    if (redraws_) write_out("\n");
  }

  /// false: a signal ended it, or the terminal has gone.
  bool run(KeyInput& keys, Timeline& timeline) {
    show({});
    Direction shown;
    for (;;) {
      const auto pressed = keys.read();
      if (!pressed) return false;
      if (driven_ == Direction{}) timeline.forgive_a_stop();  // nothing was held meanwhile
      const auto now = Timeline::Clock::now();
      if (!take(*pressed, timeline, now.time_since_epoch())) return true;
      const Direction direction = steering_.direction(now.time_since_epoch());
      if (direction != driven_ || std::exchange(changed_, false)) drive(direction, timeline);
      if (direction != shown || std::exchange(stale_, false)) show(shown = direction);
      if (!timeline.wait(now + look_interval)) return false;
    }
  }

 private:
  enum class Keys : bool { read, over };

  /// false: quit.
  bool take(std::string_view bytes, Timeline& timeline, base::Duration now) {
    while (!bytes.empty()) {
      switch (steering_.take(bytes, now)) {
        case Steering::Ask::nothing:
          break;
        case Steering::Ask::stop:
          timeline.carry_out(*parser_.parse(stop_words, options_->command));
          driven_ = {};
          note_ = "stop";
          stale_ = true;
          break;
        case Steering::Ask::faster:
          change(1);
          break;
        case Steering::Ask::slower:
          change(-1);
          break;
        case Steering::Ask::quit:
          return false;
      }
    }
    return true;
  }

  /// As far as the spec's limits go.
  void change(int steps) {
    const auto before = std::pair{forward_, turning_};
    forward_.change(steps);
    turning_.change(steps);
    note_.clear();
    if (beyond()) {
      std::tie(forward_, turning_) = before;
      note_ = "no faster: the limit of the spec";
    }
    changed_ = driven_ != Direction{};
    stale_ = true;
  }

  void drive(Direction direction, Timeline& timeline) {
    driven_ = direction;
    note_.clear();
    if (direction == Direction{})
      timeline.rest();
    else
      timeline.carry_out(*command_to(direction));  // within the limits, as looked at before
  }

  /// What is wrong with the speeds: a robot may go back more slowly than ahead.
  [[nodiscard]] std::optional<words::WordError> beyond() const {
    for (const Direction direction : {Direction{1, 0}, Direction{-1, 0}, Direction{0, 1}, Direction{0, -1}})
      if (auto command = command_to(direction); !command) return std::move(command.error);
    return std::nullopt;
  }

  [[nodiscard]] base::Result<client::Command, words::WordError> command_to(Direction direction) const {
    const std::string x = forward_.text(direction.forward);
    const std::string z = turning_.text(direction.left);
    const std::array<std::string_view, 3> words{"drive", x, z};
    return parser_.parse(words, options_->command);
  }

  /// One line, drawn over the one before; a line of its own where that is not possible: a file, TERM=dumb.
  void show(Direction direction, Keys keys = Keys::read) {
    constexpr std::string_view forward[] = {"back", "", "forward"};
    constexpr std::string_view turning[] = {"right", "", "left"};
    std::string going{forward[direction.forward + 1]};
    if (direction.left != 0) going += (going.empty() ? "" : ", ") + std::string{turning[direction.left + 1]};
    if (going.empty()) going = note_.empty() ? "rests" : note_;
    std::string line = fmt::format("{} {}  {}", forward_.shown(), turning_.shown(), going);
    const std::size_t columns = terminal_size(STDOUT_FILENO).columns;
    const std::string_view help = "   arrows drive, space stops, + - speed, q quits";
    if (keys == Keys::read && line.size() + help.size() < columns) line += help;
    line.resize(std::min(line.size(), columns - 1));
    if (redraws_)
      write_out("\r\x1b[K" + line);
    else if (line != std::exchange(written_, line))
      write_out(line + '\n');
  }

  const KeyDriveOptions* options_;
  words::CommandParser parser_;
  KeySpeed forward_, turning_;
  Steering steering_;
  Direction driven_;
  bool changed_ = false;  ///< the speed, while it drives
  bool stale_ = false;    ///< the line
  bool redraws_ = can_redraw(STDOUT_FILENO);
  std::string written_;
  std::string note_;
};

}  // namespace

int drive_by_keys(Session& session, const KeyDriveOptions& options) {
  KeyDrive drive{session, options};
  catch_interrupts();
  catch_hangups();
  catch_broken_pipe();
  KeyInput keys;
  if (!keys.is_terminal())
    fail({"drive: --keys reads keys of a terminal, and standard input is none",
          "drive a script with amiroctl run, or say the velocities: amiroctl drive 10cm/s --for 2s"},
         exit_usage);
  const auto bus = open_to_command(session, "drive");
  Timeline timeline{*bus, session.catalogue_on_bus(true), "drive", options.others, options.confirm, {}};
  bool quit = timeline.listen_first();
  if (quit) {
    timeline.expect_no_other();
    quit = drive.run(keys, timeline);
    timeline.rest();
    const bool is_gone = !quit && (interrupted() == 0 || interrupted() == SIGHUP);  // the terminal
    if (!is_gone) drive.show_end();
    if (is_gone && interrupted() == 0) remark("drive: the terminal is gone");
  }
  const bool fine = timeline.finish();
  return exit_code_after_interrupt(quit && fine ? exit_success : exit_failure);
}

}  // namespace ocm::cli
