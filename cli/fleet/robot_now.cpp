#include "cli/fleet/robot_now.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <type_traits>

#include <fmt/format.h>

namespace ocm::cli::fleet {
namespace {

using mapper::link::Kind;
using mapper::server::Calibrator;
using mapper::server::Progress;

// In the order of the enumerations.
constexpr std::array<std::string_view, 8> progress_words{"none",    "waiting", "said",     "heard",
                                                         "reached", "ended",   "stopping", "stopped"};
constexpr std::array<std::string_view, 6> compass_words{"none",    "asking",  "ordering",
                                                        "turning", "storing", "done"};
constexpr std::array<std::string_view, 3> advice_words{"stay", "bad_link", "far_away"};
static_assert(static_cast<std::size_t>(Progress::stopped) + 1 == progress_words.size());
static_assert(static_cast<std::size_t>(Calibrator::Phase::done) + 1 == compass_words.size());
static_assert(static_cast<std::size_t>(cognitive::Advice::far_away) + 1 == advice_words.size());

template <class Enum>
std::string_view word(std::span<const std::string_view> words, Enum value) {
  return words[static_cast<std::size_t>(value)];
}

/// Tabs and line ends divide rows: a name that has one cannot be typed either.
std::string plain(std::string_view text) {
  std::string out{text};
  std::replace_if(
      out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, '_');
  return out;
}

template <class Sentence>
std::string integers(const Sentence& sentence) {
  std::string out;
  for (const auto& field : Sentence::fields)
    out += fmt::format("{}{}", out.empty() ? "" : ",", sentence.*field.member);
  return out;
}

// --- what is read: each says whether it could be ---

bool read(std::string_view text, bool& value) {
  value = text == "1";
  return text == "0" || text == "1";
}
bool read(std::string_view text, std::string& value) {
  value = text;
  return true;
}
template <class Number>
requires std::is_arithmetic_v<Number>
bool read(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if constexpr (std::is_floating_point_v<Number>)
    if (!std::isfinite(value)) return false;
  return error == std::errc{} && end == text.data() + text.size();
}
bool read(std::string_view text, base::Time& value) {
  std::int64_t nanoseconds = 0;
  if (!read(text, nanoseconds)) return false;
  value = base::Time{base::Duration{nanoseconds}};
  return true;
}
/// "x,y,heading" in metres and radians.
bool read(std::string_view text, motion::Pose& pose) {
  for (float* const value : {&pose.x_m, &pose.y_m, &pose.heading_rad}) {
    const std::size_t comma = text.find(',');
    const bool last = value == &pose.heading_rad;
    if ((comma == std::string_view::npos) != last || !read(text.substr(0, comma), *value)) return false;
    text.remove_prefix(last ? text.size() : comma + 1);
  }
  return true;
}
template <class Enum>
bool read(std::string_view text, std::span<const std::string_view> words, Enum& value) {
  const auto at = std::find(words.begin(), words.end(), text);
  value = static_cast<Enum>(at - words.begin());
  return at != words.end();
}
bool read(std::string_view text, Kind& kind) {
  for (auto each = static_cast<unsigned>(Kind::none); each <= static_cast<unsigned>(Kind::pong); ++each) {
    kind = static_cast<Kind>(each);
    if (name(kind) == text) return true;
  }
  return false;
}
/// All integers of a sentence, each in its range.
template <class Sentence>
bool read_integers(std::string_view text, Sentence& sentence) {
  for (const auto& field : Sentence::fields) {
    const std::size_t comma = text.find(',');
    const bool last = &field == &Sentence::fields.back();
    if ((comma == std::string_view::npos) != last) return false;
    std::int16_t& value = sentence.*field.member;
    if (!read(text.substr(0, comma), value) || value < field.min || value > field.max) return false;
    text.remove_prefix(last ? text.size() : comma + 1);
  }
  return true;
}
template <class Sentence>
bool read(std::string_view text, std::optional<Sentence>& sentence) {
  return read_integers(text, sentence.emplace());
}

bool read(std::string_view key, std::string_view text, RobotNow& robot) {
  if (key == "index") return read(text, robot.index) && robot.index < cognitive::Fleet::most_robots;
  if (key == "address") return read(text, robot.address);
  if (key == "name") return read(text, robot.name);
  if (key == "linked") return read(text, robot.linked);
  if (key == "confirmed") return read(text, robot.confirmed);
  if (key == "idle") return read(text, robot.idle);
  if (key == "located") return read(text, robot.located);
  if (key == "paused") return read(text, robot.paused);
  if (key == "lost") return read(text, robot.lost);
  if (key == "held") return read(text, robot.held);
  if (key == "handshake") return read(text, robot.handshake);
  if (key == "update") return read(text, robot.update);
  if (key == "updated") return read(text, robot.updated);
  if (key == "heard") return read(text, robot.heard);
  if (key == "last") return read(text, robot.last);
  if (key == "advice") return read(text, advice_words, robot.advice);
  if (key == "quality") return read(text, robot.quality_per_mille) && robot.quality_per_mille <= 1000;
  if (key == "pieces") return read(text, robot.pieces);
  if (key == "torn") return read(text, robot.torn);
  if (key == "progress") return read(text, progress_words, robot.progress);
  if (key == "said") return read(text, robot.times_said);
  if (key == "standing") return read(text, robot.standing);
  if (key == "blocked") return read(text, robot.blocked);
  if (key == "off_cm") return read(text, robot.off_cm);
  if (key == "off_deg") return read(text, robot.off_deg);
  if (key == "compass") return read(text, compass_words, robot.compass);
  if (key == "asked") return read(text, robot.compass_asked);
  if (key == "calibration") return read_integers(text, robot.calibration);
  if (key == "order") return read(text, robot.order);
  if (key == "by") return read(text, robot.by);
  if (key == "origin") return read(text, robot.origin);
  if (key == "origin_known") return read(text, robot.origin_known);
  return true;
}

}  // namespace

RobotNow robot_now(const cognitive::Fleet& fleet, const mapper::server::Peer& peer) {
  RobotNow now;
  static_cast<cognitive::Robot&>(now) = fleet.robot(peer.index);
  now.index = peer.index;
  now.address = peer.address;
  now.name = peer.name;
  now.quality_per_mille = fleet.quality_per_mille(peer.index);
  const mapper::link::Ear& ear = fleet.ear(peer.index);
  now.torn = ear.text().faults().total();
  now.pieces = now.torn + ear.text().stray() + ear.packed().faults().total();
  const mapper::server::Sender& sender = fleet.sender(peer.index);
  now.progress = sender.progress();
  now.times_said = sender.times_said();
  now.standing = sender.standing();
  now.blocked = sender.blocked();
  now.off_cm = sender.off_cm();
  now.off_deg = sender.off_deg();
  const Calibrator& calibrator = fleet.calibrator(peer.index);
  now.compass = calibrator.phase();
  now.compass_asked = calibrator.times_said();
  now.calibration = calibrator.result();
  return now;
}

std::string_view state_of(const RobotNow& robot) {
  if (!robot.linked) return "no link";
  if (robot.lost) return "silent";
  if (robot.held) return "held";
  if (robot.paused || (robot.idle && !robot.update))
    return "paused";  // by any program: it only reports that it is idle
  if (!robot.confirmed) return "connected";
  return robot.idle ? "idle" : "moving";
}

Json to_json(const RobotNow& robot) {
  Json out{
      {"robot", robot.name}, {"index", robot.index}, {"address", robot.address}, {"state", state_of(robot)}};
  out["linked"] = robot.linked;
  out["confirmed"] = robot.confirmed;
  out["idle"] = robot.idle;
  out["held"] = robot.held;
  out["quality"] = robot.linked ? Json(robot.quality_per_mille / 1000.0) : Json();
  out["call_back"] =
      robot.advice == cognitive::Advice::stay ? Json() : Json(word(advice_words, robot.advice));
  out["pose"] = Json();
  if (robot.update)
    out["pose"] = {
        {"x_cm", robot.update->x}, {"y_cm", robot.update->y}, {"heading_deg", robot.update->heading}};
  out["body"] = Json();
  if (robot.handshake)
    out["body"] = {{"width_cm", robot.handshake->width},
                   {"length_cm", robot.handshake->length},
                   {"axle_offset_cm", robot.handshake->axle_offset},
                   {"tower_offset_cm", robot.handshake->tower_offset},
                   {"sensor_out_cm", robot.handshake->sensor_out},
                   {"deadline_ms", robot.handshake->deadline},
                   {"packed", mapper::link::offers_packed(*robot.handshake)}};
  return out;
}

std::string to_row(const RobotNow& robot) {
  const auto flag = [](bool value) { return value ? 1 : 0; };
  std::string row = fmt::format(
      "index={}\taddress={}\tname={}\tlinked={}\tconfirmed={}\tidle={}\tlocated={}\tpaused={}\tlost={}"
      "\theld={}",
      robot.index, plain(robot.address), plain(robot.name), flag(robot.linked), flag(robot.confirmed),
      flag(robot.idle), flag(robot.located), flag(robot.paused), flag(robot.lost), flag(robot.held));
  if (robot.handshake) row += "\thandshake=" + integers(*robot.handshake);
  if (robot.update) row += "\tupdate=" + integers(*robot.update);
  row += fmt::format("\tupdated={}\theard={}\tlast={}\tadvice={}\tquality={}\tpieces={}\ttorn={}",
                     robot.updated.time_since_epoch().count(), robot.heard.time_since_epoch().count(),
                     name(robot.last), word(advice_words, robot.advice), robot.quality_per_mille,
                     robot.pieces, robot.torn);
  row += fmt::format("\tprogress={}\tsaid={}\tstanding={}\tblocked={}\toff_cm={}\toff_deg={}",
                     word(progress_words, robot.progress), robot.times_said, flag(robot.standing),
                     flag(robot.blocked), robot.off_cm, robot.off_deg);
  row += fmt::format("\tcompass={}\tasked={}\tcalibration={}\torder={}\tby={}",
                     word(compass_words, robot.compass), robot.compass_asked, integers(robot.calibration),
                     robot.order, plain(robot.by));
  row += fmt::format("\torigin={},{},{}\torigin_known={}", robot.origin.x_m, robot.origin.y_m,
                     robot.origin.heading_rad, flag(robot.origin_known));
  return row;
}

std::optional<RobotNow> parse_row(std::string_view row) {
  RobotNow robot;
  bool has_index = false, has_name = false;
  while (!row.empty()) {
    const std::string_view pair = row.substr(0, row.find('\t'));
    row.remove_prefix(std::min(row.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    const std::string_view key = pair.substr(0, equals);
    if (!read(key, pair.substr(equals + 1), robot)) return std::nullopt;
    has_index = has_index || key == "index";
    has_name = has_name || key == "name";
  }
  if (!has_index || !has_name) return std::nullopt;
  return robot;
}

}  // namespace ocm::cli::fleet
