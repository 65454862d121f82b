#include "cli/watch/frame_lines.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/log/candump.hpp"

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli {

FrameLines::FrameLines(std::string path, const protocol::Catalogue& catalogue, bool keep_going,
                       logs::Values values)
    : path_(path == "-" ? "standard input" : path),
      source_(path),
      input_(source_),
      json_(catalogue, values),
      keep_going_(keep_going) {
  if (!source_.failure().empty())
    fail({fmt::format("cannot read {}: {}", path_, source_.failure()), "expected a file of JSON lines"});
  logs::skip_byte_order_mark(input_);
}

bool FrameLines::next(log::Entry& entry, std::string_view& bus) {
  using log::Input;
  for (;;) {
    std::string_view line;
    const auto taken = input_.take_line(line);
    if (taken == Input::Line::none || interrupted() != 0) {
      broken_ = interrupted() == 0 && !input_.failure().empty();
      if (broken_) remark(fmt::format("{}: {}", path_, input_.failure()));
      return false;
    }
    const auto begin = line.find_first_not_of(" \t");
    if (begin == std::string_view::npos) continue;
    if (taken == Input::Line::too_long)
      problem_ = {log::Cause::too_long, "a line of more than 16 MiB", "expected a frame a line"};
    else if (parse(line.substr(begin), entry, bus))
      return true;
    ++bad_;
    if (!keep_going_ || bad_ <= log::Complaints::kept) tell();
    if (!keep_going_) return false;
  }
}

void FrameLines::tell() const {
  remark(fmt::format("amiroctl: {}:{}: {}\n          {}", path_, input_.line_number(), problem_.what,
                     problem_.remedy));
}

void FrameLines::tell_unknown_keys() const {
  constexpr std::size_t most = 8;
  const auto unknown = json_.unknown_keys();
  std::vector<logs::UnknownKey> keys(unknown.begin(), unknown.end());
  // Those that may be meant for another one come first, then those of most lines.
  const auto rank = [](const logs::UnknownKey& key) {
    return std::pair{logs::JsonLineParser::meant_by(key.name).empty(), UINT64_MAX - key.lines};
  };
  std::stable_sort(keys.begin(), keys.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  std::uint64_t more = json_.more_unknown_keys();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i >= most) {
      more += keys[i].lines;
      continue;
    }
    std::string text = fmt::format("{}: key '{}' is not read ({})", path_,
                                   log::Complaints::printable(keys[i].name), counted(keys[i].lines, "line"));
    if (const auto meant = logs::JsonLineParser::meant_by(keys[i].name); !meant.empty())
      text += fmt::format("; did you mean '{}'?", meant);
    remark(text);
  }
  if (more != 0) remark(fmt::format("{}: other keys are not read, either ({} times)", path_, more));
}

bool FrameLines::parse(std::string_view line, log::Entry& entry, std::string_view& bus) {
  if (line.front() == '{') {
    if (json_.parse(line, entry, bus)) return true;
    problem_ = json_.problem();
    return false;
  }
  return parse_log_line(line, entry, bus);
}

bool FrameLines::parse_log_line(std::string_view line, log::Entry& entry, std::string_view& bus) {
  std::optional<log::Cause> wrong;
  if (line.front() == '(') {
    const auto parsed = log::candump::parse_line(line);
    entry = parsed.entry;
    bus = parsed.interface;
    wrong = parsed.wrong;
    if (!wrong) json_.follow(entry.time);
  } else {
    const auto frame = can::parse_any_frame(line.substr(0, line.find_last_not_of(" \t") + 1));
    entry = log::Entry{json_.last_time().value_or(base::Time{}), *frame};
    bus = {};
    if (!frame) wrong = log::candump::cause_of(frame.error);
  }
  if (!wrong) return true;
  problem_ = {*wrong, fmt::format("\"{}\": {}", log::Complaints::printable(line), log::describe(*wrong)),
              "a line is a JSON object as listen --json prints it, a candump log line, or a frame such as "
              "205#01840302"};
  return false;
}

}  // namespace ocm::cli
