// The log of a central's line: any piece comes back from its line; what is read of a log is written and read
// again to the same, each line has one outcome; a drive that is wound back and played again ends the same.
#include "cli/fleet/line_log.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "cli/fleet/line_replay.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

namespace {

constexpr base::Time latest_time{std::chrono::seconds{7'258'118'401} - std::chrono::microseconds{1}};

std::string_view without_end(std::string_view line) {
  fuzz::expect(!line.empty() && line.find('\n') == line.size() - 1, "a piece is one line");
  return line.substr(0, line.size() - 1);
}
bool is_printed(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

/// The input as what a central has said.
void write_and_read(std::string_view text) {
  const base::Time time{std::chrono::microseconds{1'795'599'207'000'000 + static_cast<int>(text.size())}};
  const std::string line = cli::fleet::to_log_line(time, text);
  const auto said = cli::fleet::parse_log_line(without_end(line));
  fuzz::expect(said && said->time == time && said->text == text, "any piece comes back from its line");
}

void check_line(std::string_view line) {
  const auto said = cli::fleet::parse_log_line(line);
  if (!said) return;
  fuzz::expect(is_printed(line) && line.starts_with('('), "a line begins with its time, and can be printed");
  fuzz::expect(said->time >= base::Time{} && said->time <= latest_time,
               "a time is one of the years 1970 to 2200");
  fuzz::expect(said->time.time_since_epoch() % std::chrono::microseconds{1} == base::Duration{},
               "a time is of whole microseconds");
  fuzz::expect(said->text.size() <= line.size(), "a piece is no longer than its line");
  const std::string written = cli::fleet::to_log_line(said->time, said->text);
  const auto again = cli::fleet::parse_log_line(without_end(written));
  fuzz::expect(again && again->time == said->time && again->text == said->text,
               "a line reads again the same");
}

/// What a page shows of it.
struct Shown {
  std::vector<std::string> robots;
  std::uint32_t drawn = 0, turning = 0;
  friend bool operator==(const Shown&, const Shown&) = default;
};
Shown shown(const cli::fleet::LineReplay& replay) {
  Shown now;
  for (const cli::fleet::RobotNow& robot : replay.robots()) {
    fuzz::expect(robot.index < cognitive::Fleet::most_robots, "a robot is one of the list");
    fuzz::expect(std::isfinite(robot.pose().x_m) && std::isfinite(robot.pose().y_m) &&
                     std::isfinite(robot.pose().heading_rad),
                 "a robot is somewhere");
    now.robots.push_back(cli::fleet::to_row(robot));
  }
  now.drawn = replay.drawing().counters().drawn;
  now.turning = replay.drawing().counters().turning;
  return now;
}
void play(const cli::fleet::ReadLineLog& log) {
  cli::fleet::LineReplay replay{log, {}};
  const base::Duration length = replay.playing().length;
  replay.go_to(length / 2);
  const Shown half = shown(replay);
  replay.go_to(length);
  fuzz::expect(replay.playing().ended, "a log that is played ends");
  const Shown end = shown(replay);
  replay.go_to(length / 2);
  fuzz::expect(shown(replay) == half, "wound back, all is as it was");
  replay.play(length / 3);
  replay.go_to(length);
  fuzz::expect(shown(replay) == end, "played again, it ends the same");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::text_of(data, size);
  write_and_read(text);
  std::uint64_t lines = 0;
  for (std::string_view rest = text; !rest.empty(); ++lines) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    check_line(line);
  }
  const auto log = cli::fleet::parse_line_log(text);
  if (!log) return 0;
  fuzz::expect(log->said.size() + log->damaged + 1 == lines,
               "each line but the first is a piece, or counted");
  fuzz::expect((log->damaged == 0) == (log->first_damaged == 0) && log->first_damaged <= lines &&
                   log->first_damaged != 1,
               "the first damaged line is one of the log");
  std::string written{cli::fleet::line_log_begins};
  written += '\n';
  base::Time before{};
  for (const cli::fleet::Said& said : log->said) {
    fuzz::expect(said.time >= std::exchange(before, said.time), "pieces are in the order of time");
    written += cli::fleet::to_log_line(said.time, said.text);
  }
  const auto again = cli::fleet::parse_line_log(written);
  fuzz::expect(
      again && again->damaged == 0 &&
          std::equal(log->said.begin(), log->said.end(), again->said.begin(), again->said.end(),
                     [](const auto& a, const auto& b) { return a.time == b.time && a.text == b.text; }),
      "what is read of a log is written, and read again to the same");
  play(*log);
  return 0;
}
