/// How is the robot? Watches the bus for a moment, asks every board, and says in words what is wrong and what
/// to do about it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/can/error_frame.hpp"
#include "ocm/client/commanders.hpp"
#include "ocm/client/diagnosis.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/shared/clock.hpp"
#include "cli/shared/fitted.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/remedies.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

using client::BoardReport;
using client::Diagnosis;
using client::Finding;
using client::Severity;

struct DoctorOptions {
  base::Duration listen = std::chrono::seconds{1};
  base::Duration patience = std::chrono::milliseconds{500};
  bool json = false;
};

/// Which messages of the spec came, of those that have a period.
class Messages {
 public:
  explicit Messages(const protocol::Catalogue& catalogue)
      : catalogue_(&catalogue), came_(catalogue.topics.size()) {}

  void take(const client::Reception& reception) {
    if (reception.topic != nullptr && reception.topic->is_message())
      came_[static_cast<std::size_t>(reception.topic - catalogue_->topics.data())] = true;
  }
  /// What should have come three times in `listened`, and did not come: a finding a sender.
  [[nodiscard]] std::vector<Finding> findings(std::string_view interface, base::Duration listened) const {
    std::map<std::uint8_t, std::pair<std::size_t, std::vector<std::string_view>>> of_sender;
    for (std::size_t i = 0; i < came_.size(); ++i) {
      const protocol::Topic& topic = catalogue_->topics[i];
      if (!is_due(topic, interface, listened)) continue;
      auto& [due, missing] = of_sender[topic.board];
      ++due;
      if (!came_[i]) missing.push_back(topic.name);
    }
    std::vector<Finding> all;
    for (auto& [board, each] : of_sender) {
      auto& [due, missing] = each;
      if (missing.empty()) continue;
      const std::size_t more = missing.size() - std::min(missing.size(), most_named);
      missing.resize(missing.size() - more);
      all.push_back({Severity::warning,
                     board < catalogue_->boards.size() ? catalogue_->boards[board].name : std::string_view{},
                     fmt::format("of {} due in {} nothing came of {}{}", counted(due, "message"),
                                 words::to_text(listened), fmt::join(missing, ", "),
                                 more == 0 ? "" : fmt::format(" and {} more", more)),
                     "is the sender switched on and on this bus? `amiroctl stats` measures every period"});
    }
    return all;
  }

  /// Whether there is one that should have come.
  [[nodiscard]] bool any_due(std::string_view interface, base::Duration listened) const {
    return std::any_of(catalogue_->topics.begin(), catalogue_->topics.end(),
                       [&](const protocol::Topic& topic) { return is_due(topic, interface, listened); });
  }

 private:
  static constexpr std::size_t most_named = 4;
  /// Three times: one may be late, and one lost.
  static bool is_due(const protocol::Topic& topic, std::string_view interface, base::Duration listened) {
    return topic.is_message() && topic.is_on(interface) && topic.cycle.count() != 0 &&
           3 * topic.cycle <= listened;
  }
  const protocol::Catalogue* catalogue_;
  std::vector<bool> came_;  ///< of each topic of the catalogue
};

/// The bus and what was seen on it.
class Examination {
 public:
  Examination(Session& session)
      : catalogue_(session.catalogue()),
        bus_(session.open_bus()),
        live_(*bus_),
        receiver_(catalogue_, client::Transport::together),
        diagnosis_(catalogue_),
        messages_(catalogue_) {}

  /// Listens for `duration`, or until `done`.
  template <class Done>
  void listen(base::Duration duration, Done done) {
    if (done()) return;
    const auto end = time_after(Live::Clock::now(), duration);
    const Over over = live_.receive_any(end, [&](const transport::ReceivedAny& received) {
      const auto classic = received.frame.classic();
      if (classic && can::lost_in_controller(*classic)) ++overflows_;
      const auto reception = receiver_.take(received.frame.view(), received.time);
      diagnosis_.take(reception);
      if (classic) commanders_.take({received.time, *classic}, reception);
      messages_.take(reception);
      return !done();
    });
    if (over == Over::gone) fail(bus_->failure());
    if (over == Over::signal) throw Exit{exit_code_after_interrupt(exit_failure)};
  }

  /// Who has not spoken by himself is asked, twice at most. What is published is waited for and not asked:
  /// asking once would stop it.
  void ask(base::Duration patience) {
    for (int attempt = 0; attempt < 2 && !complete(); ++attempt) {
      for (const BoardReport& board : diagnosis_.boards())
        if (board.status != nullptr && !board.answered) request(*board.status);
      listen(patience, [this] { return have_statuses(); });
    }
    for (const BoardReport& board : diagnosis_.boards())
      if (board.refusal != nullptr && board.answered && board.reason.empty() &&
          !diagnosis_.publishes(*board.refusal))
        request(*board.refusal);
    const auto ask_of = [this](const protocol::Topic* topic, bool answered) {
      if (topic != nullptr && !answered && diagnosis_.boards()[topic->board].answered &&
          !diagnosis_.publishes(*topic))
        request(*topic);
    };
    ask_of(diagnosis_.battery().topic, diagnosis_.battery().answered);
    ask_of(diagnosis_.batteries().topic, !diagnosis_.batteries().all.empty());
    listen(patience, [this] { return complete(); });
  }

  /// After listening for so long.
  [[nodiscard]] std::vector<Finding> findings(base::Duration listened) const {
    std::vector<Finding> all = diagnosis_.findings();
    const auto disputes = commanders_.findings(catalogue_);
    all.insert(all.end(), disputes.begin(), disputes.end());
    for (Finding& finding : all) finding.remedy = remedy(finding);
    const auto missing = messages_.findings(bus_->name(), listened);
    all.insert(all.end(), missing.begin(), missing.end());
    if (overflows_ != 0) all.push_back(overflow());
    const auto counted = findings_of(bus_->counters(), receiver_.counters());
    all.insert(all.end(), counted.begin(), counted.end());
    std::stable_sort(all.begin(), all.end(),
                     [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
    return all;
  }

  /// What there is to say where nothing was found.
  [[nodiscard]] std::string_view well(base::Duration listened) const {
    if (has_statuses()) return "all is well";
    if (messages_.any_due(bus_->name(), listened))
      return "all messages came that were due; of the boards this spec says nothing";
    return frames() == 0 ? "nothing came, and nothing was due: --listen T listens longer"
                         : "no message was due meanwhile: --listen T listens longer; of the boards this spec "
                           "says nothing";
  }
  [[nodiscard]] const Diagnosis& diagnosis() const { return diagnosis_; }
  [[nodiscard]] const protocol::Catalogue& catalogue() const { return catalogue_; }
  [[nodiscard]] std::string_view bus_name() const { return bus_->name(); }
  [[nodiscard]] std::uint64_t frames() const { return receiver_.counters().frames; }

 private:
  [[nodiscard]] Finding overflow() const {
    const bool on_a_line = bus_->name().starts_with("slcan:");
    return {
        Severity::warning, "",
        fmt::format("{} lost frames for want of room, reported {}",
                    on_a_line ? "the serial adapter" : "the CAN controller", counted(overflows_, "time")),
        on_a_line
            ? "a serial line of 115200 baud carries some 440 frames/s: publish less, or use an adapter on "
              "the CAN bus"
            : "this machine is too busy"};
  }
  void request(const protocol::Topic& topic) {
    Outgoing{*bus_, "doctor"}.send(protocol::once(topic.id, topic.priority));
  }
  /// Whether a board of the spec can say how it is.
  [[nodiscard]] bool has_statuses() const {
    const auto& boards = diagnosis_.boards();
    return std::any_of(boards.begin(), boards.end(),
                       [](const BoardReport& board) { return board.status != nullptr; });
  }
  [[nodiscard]] bool have_statuses() const {
    const auto& boards = diagnosis_.boards();
    return std::all_of(boards.begin(), boards.end(),
                       [](const BoardReport& b) { return b.status == nullptr || b.answered; });
  }
  [[nodiscard]] bool complete() const {
    const auto& boards = diagnosis_.boards();
    return have_statuses() && (diagnosis_.battery().topic == nullptr || diagnosis_.battery().answered) &&
           (diagnosis_.batteries().topic == nullptr || !diagnosis_.batteries().all.empty()) &&
           std::all_of(boards.begin(), boards.end(),
                       [](const BoardReport& b) { return b.refusal == nullptr || !b.reason.empty(); });
  }

  const protocol::Catalogue& catalogue_;
  std::unique_ptr<transport::Bus> bus_;
  Live live_;
  client::Receiver receiver_;
  Diagnosis diagnosis_;
  client::Commanders commanders_;
  Messages messages_;
  std::uint64_t overflows_ = 0;  ///< times that the controller or adapter reported lost frames
};

/// 90061 s as "1 d 1 h".
std::string span(std::int64_t seconds) {
  if (seconds < 120) return fmt::format("{} s", seconds);
  if (seconds < 7200) return fmt::format("{} min", seconds / 60);
  if (seconds < 172'800) return fmt::format("{} h {} min", seconds / 3600, seconds / 60 % 60);
  return fmt::format("{} d {} h", seconds / 86'400, seconds / 3600 % 24);
}

void print_pretty(const Examination& examination, const std::vector<Finding>& findings,
                  base::Duration listened, bool colour) {
  const auto& catalogue = examination.catalogue();
  const auto& diagnosis = examination.diagnosis();
  std::size_t width = 5;
  for (const auto& board : catalogue.boards) width = std::max(width, board.name.size());
  print_fitted(fmt::format("{:<{}}  {:<10}  {:<9}  {:<7}  {:>5}  {:<7}  {}\n", "BOARD", width, "UP", "RESET",
                           "SPEC", "LOAD", "BUS", "PUBLISHES"),
               4);
  for (std::size_t i = 0; i < catalogue.boards.size(); ++i) {
    const BoardReport& board = diagnosis.boards()[i];
    if (!board.answered) {
      fmt::print("{:<{}}  {}\n", catalogue.boards[i].name, width,
                 board.status == nullptr ? "has no status in this spec"
                 : board.heard           ? "sends, but has no status"
                                         : "-");
      continue;
    }
    const bool same = static_cast<std::uint32_t>(board.wire_hash) == protocol::wire_hash(catalogue);
    const std::string running = diagnosis.sensors_of(i, board.publishing);
    print_fitted(fmt::format("{:<{}}  {:<10}  {:<9}  {:<7}  {:>5}  {:<7}  {}\n", catalogue.boards[i].name,
                             width, span(board.uptime_s), board.reset.empty() ? "?" : board.reset,
                             same ? "same" : "another", board.load ? fmt::format("{} %", *board.load) : "-",
                             board.bus.empty() ? "?" : board.bus, running.empty() ? "-" : running),
                 4);
  }
  if (const auto& battery = diagnosis.battery(); battery.answered)
    fmt::print("battery {} %{}\n", battery.state_of_charge, battery.plugged ? ", charger plugged in" : "");
  for (const auto& each : diagnosis.batteries().all)
    if (each.present)
      print_fitted(fmt::format("{} {:.3f} V, {:+.3f} A, {:.0f} mAh left, {:.1f} degC\n", each.name,
                               each.voltage_v, each.current_a, each.remaining_mah, each.temperature_celsius),
                   4);
    else
      fmt::print("{} not inserted\n", each.name);
  fmt::print("\n");
  for (const Finding& finding : findings) {
    const char* mark = !colour                                 ? ""
                       : finding.severity == Severity::problem ? "\x1b[31m"
                       : finding.severity == Severity::warning ? "\x1b[33m"
                                                               : "\x1b[2m";
    print_fitted(
        fmt::format("{}{:<8}{} {}{}{}\n         {}\n", mark, name(finding.severity), colour ? "\x1b[0m" : "",
                    finding.board, finding.board.empty() ? "" : ": ", finding.what, finding.remedy),
        9);
  }
  if (findings.empty()) print_fitted(fmt::format("{}\n", examination.well(listened)), 0);
}

/// To a thousandth: what a double has behind that is no measurement.
double rounded(double value) {
  return std::round(value * 1000) / 1000;
}

void print_json(const Examination& examination, const std::vector<Finding>& findings) {
  const auto& catalogue = examination.catalogue();
  const auto& diagnosis = examination.diagnosis();
  Json out;
  out["robot"] = catalogue.robot;
  out["bus"] = examination.bus_name();
  out["frames"] = examination.frames();
  out["boards"] = Json::array();
  for (std::size_t i = 0; i < catalogue.boards.size(); ++i) {
    const BoardReport& board = diagnosis.boards()[i];
    Json entry{{"board", catalogue.boards[i].name}, {"answers", board.answered}, {"heard", board.heard}};
    if (board.answered) {
      entry["uptime_s"] = board.uptime_s;
      entry["reset"] = board.reset;
      entry["wire_hash"] = fmt::format("0x{:08X}", board.wire_hash);
      entry["load_percent"] = board.load ? Json(*board.load) : Json();
      entry["bus"] = board.bus;
      entry["publishing"] = diagnosis.sensors_of(i, board.publishing);
      entry["faults"] = diagnosis.sensors_of(i, board.faults);
      entry["overload"] = board.overload;
      entry["bus_errors"] = board.bus_errors;
      entry["refused"] = board.refused;
      entry["line_lost"] = board.line_lost;
    }
    out["boards"].push_back(std::move(entry));
  }
  out["wire_hash"] = fmt::format("0x{:08X}", protocol::wire_hash(catalogue));
  const auto& battery = diagnosis.battery();
  out["battery_percent"] = battery.answered ? Json(battery.state_of_charge) : Json();
  out["batteries"] = Json::array();
  for (const auto& each : diagnosis.batteries().all) {
    Json entry{{"battery", each.name}, {"present", each.present}};
    if (each.present) {
      entry["voltage_v"] = rounded(each.voltage_v);
      entry["current_a"] = rounded(each.current_a);
      entry["remaining_mah"] = rounded(each.remaining_mah);
      entry["temperature_celsius"] = rounded(each.temperature_celsius);
    }
    out["batteries"].push_back(std::move(entry));
  }
  out["findings"] = Json::array();
  for (const Finding& finding : findings)
    out["findings"].push_back({{"severity", name(finding.severity)},
                               {"board", finding.board},
                               {"what", finding.what},
                               {"remedy", finding.remedy}});
  fmt::print("{}\n", out.line());
}

}  // namespace

void declare_doctor(Verb verb, Session& session, int& exit_code) {
  verb.describe("check the robot's health and suggest fixes", watch_group,
                "  amiroctl doctor\n"
                "  amiroctl doctor --listen 10s --json | jq '.findings[]'");
  const auto options = std::make_shared<DoctorOptions>();
  add_duration(verb, "--listen,--watch", options->listen, "how long to listen before asking")
      .formerly("--watch");
  add_lasting(verb, "--patience", options->patience, "how long a board may take to answer");
  verb.add_flag("--json", options->json, "one object, for programs");
  verb.callback([options, &session, &exit_code] {
    catch_interrupts();
    Examination examination{session};
    examination.listen(options->listen, [] { return false; });
    examination.ask(options->patience);
    const auto findings = examination.findings(options->listen);
    if (options->json)
      print_json(examination, findings);
    else
      print_pretty(examination, findings, options->listen, session.colour());
    const bool well = std::all_of(findings.begin(), findings.end(),
                                  [](const Finding& f) { return f.severity == Severity::note; });
    exit_code = well ? exit_success : exit_failure;
  });
}

}  // namespace ocm::cli
