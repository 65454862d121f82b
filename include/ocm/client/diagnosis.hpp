/// How a robot is, from what its boards say of themselves: takes samples of topics with the roles status and
/// refusal and of batteries, and makes findings of them: what each is about, in a sentence, and what to do.
/// Knows the roles' fields by name and nothing of the robot, so it serves every spec.
///
/// Pure: sends nothing, reads no clock. O(1) a frame; allocates a little for each board and each finding.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/client/counted.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/protocol/wire_hash.hpp"

namespace ocm::client {

enum class Severity : std::uint8_t {
  note,     ///< worth knowing
  warning,  ///< something does not work as it should
  problem,  ///< the robot cannot be used so
};

[[nodiscard]] constexpr std::string_view name(Severity severity) noexcept {
  constexpr std::string_view names[]{"note", "warning", "problem"};
  return names[static_cast<std::size_t>(severity)];
}

/// What a finding is about, for programs that have something of their own to say about it.
enum class Ailment : std::uint8_t {
  other,
  no_answer,            ///< of any board
  statusless,           ///< the board sends, but no status
  silent,               ///< the board does not answer
  foreign_spec,         ///< the board was built from another spec
  bus_state,            ///< of its CAN controller
  part_faults,          ///< parts of the board that do not answer
  overload,             ///< releases came late or not at all
  busy,                 ///< its CPU
  restarted,            ///< because of a watchdog, a fault or another breakdown
  bus_errors,           ///< on the bus, or frames given up
  line_lost,            ///< frames and characters of a host on the board's serial line
  refusals,             ///< requests that the board refused; `topic` is the last one's
  not_schedulable,      ///< the same, the last one because a deadline would be missed
  battery_low,          ///<
  no_battery,           ///< one of several is not inserted
  battery_temperature,  ///< too hot or too cold
  two_commanders,       ///< an actuator that two programs command in turns
};

struct Finding {
  Severity severity = Severity::note;
  std::string_view board;  ///< empty: the bus, or the robot as a whole
  std::string what;
  std::string remedy;  ///< holds for every program
  Ailment ailment = Ailment::other;
  std::string_view topic{};  ///< that it is about, if it is about one that is known
};

/// Why a board started, if it broke down before: by the spec's name of the cause. Empty: it did not.
[[nodiscard]] constexpr std::string_view breakdown_in_words(std::string_view reset) noexcept {
  struct Words {
    std::string_view name;
    std::string_view words;
  };
  constexpr Words all[]{
      {"watchdog", "a watchdog"},
      {"fault", "a fault"},
      {"memory_fault", "a memory fault of its processor"},
      {"bus_fault", "a bus fault of its processor"},
      {"usage_fault", "a usage fault of its processor"},
      {"kernel_halt", "a halt of its kernel"},
      {"clock_failure", "a failure of its clock"},
  };
  for (const Words& each : all)
    if (each.name == reset) return each.words;
  return {};
}

/// What one board says of itself. Raw numbers, as they came.
struct BoardReport {
  const protocol::Topic* status = nullptr;   ///< the topics that it comes on; nullptr: the spec has none
  const protocol::Topic* refusal = nullptr;  ///<
  bool heard = false;                        ///< any frame of it came
  bool answered = false;                     ///< a status came; the numbers below mean something
  std::int64_t uptime_s = 0;
  std::int64_t wire_hash = 0;
  std::string_view reset;            ///< by the spec's names; empty: a number without one
  std::string_view bus;              ///<
  std::optional<std::int64_t> load;  ///< percent
  std::int64_t publishing = 0;       ///< bits, by the order of the board's sensors in the spec
  std::int64_t faults = 0;           ///<
  std::int64_t overload = 0;
  std::int64_t bus_errors = 0;
  std::int64_t refused = 0;  ///< of the last refusal that came
  std::int64_t refused_topic = 0;
  std::int64_t line_lost = 0;
  std::string_view reason;
};

struct BatteryReport {
  const protocol::Topic* topic = nullptr;  ///< the one that has a field state_of_charge in percent
  bool answered = false;
  std::int64_t state_of_charge = 0;  ///< percent
  bool plugged = false;
};

/// What the gauge of one of several batteries measures.
struct BatteryMeasurement {
  std::string_view name;  ///< of its frame
  bool present = false;   ///< the rest means something
  double voltage_v = 0;
  double current_a = 0;  ///< negative: out of the battery
  double remaining_mah = 0;
  double temperature_celsius = 0;
};

/// The topic of which each frame has the fields voltage in V, current in A, remaining in mAh and temperature
/// in degC: a battery.
struct BatteriesReport {
  const protocol::Topic* topic = nullptr;
  std::vector<BatteryMeasurement> all;  ///< of the last sample; empty: none came
};

class Diagnosis {
 public:
  // Below these a robot is about to stop, or will within the experiment. [decided]
  static constexpr std::int64_t battery_low_percent = 20;
  static constexpr std::int64_t battery_empty_percent = 10;
  static constexpr std::int64_t load_high_percent = 90;
  // What cells of lithium-ion usually bear while they are discharged; the robot's own limits have no public
  // source. [decided]
  static constexpr double battery_hot_celsius = 60;
  static constexpr double battery_cold_celsius = -20;

  /// The catalogue must outlive it.
  explicit Diagnosis(const protocol::Catalogue& catalogue) : catalogue_(&catalogue) {
    boards_.resize(catalogue.boards.size());
    sensors_.resize(catalogue.boards.size());
    for (const protocol::Topic& topic : catalogue.topics) {
      if (topic.kind != protocol::Kind::sensor || topic.board >= boards_.size()) continue;
      sensors_[topic.board].push_back(&topic);
      if (topic.role == protocol::Role::status) boards_[topic.board].status = &topic;
      if (topic.role == protocol::Role::refusal) boards_[topic.board].refusal = &topic;
      if (!topic.frames.empty() &&
          std::all_of(topic.frames.begin(), topic.frames.end(),
                      [](const auto& frame) { return of_battery(frame).size() == 4; }))
        batteries_.topic = &topic;
      for (const protocol::FrameLayout& frame : topic.frames)
        for (const protocol::Field& field : frame.fields)
          if (field.name == "state_of_charge" && field.unit == "%") battery_.topic = &topic;
    }
  }

  /// Every reception, of whatever kind.
  void take(const Reception& reception) {
    if (reception.topic == nullptr || reception.topic->board >= boards_.size()) return;
    if (reception.meaning != Meaning::part && reception.meaning != Meaning::sample) return;
    BoardReport& board = boards_[reception.topic->board];
    board.heard = true;
    if (reception.meaning != Meaning::sample) return;
    const Reader reader{reception.sample};
    if (reception.topic == board.status) take_status(reader, board);
    if (reception.topic == board.refusal) {
      board.refused = reader.raw("", "refused");
      board.refused_topic = reader.raw("", "topic");
      board.reason = reader.word("", "reason");
      board.line_lost = reader.raw("", "line_lost");
    }
    if (reception.topic == battery_.topic) take_battery(reader);
    if (reception.topic == batteries_.topic) take_batteries(reception.sample);
  }

  /// In the order of the spec's boards.
  [[nodiscard]] const std::vector<BoardReport>& boards() const noexcept { return boards_; }
  [[nodiscard]] const BatteryReport& battery() const noexcept { return battery_; }
  [[nodiscard]] const BatteriesReport& batteries() const noexcept { return batteries_; }
  /// Whether the board publishes this sensor now, as its last status has it.
  [[nodiscard]] bool publishes(const protocol::Topic& topic) const noexcept {
    return status_bit(topic) == true;
  }
  /// Whether the board does not, as its last status has it. Without one neither is known.
  [[nodiscard]] bool is_silent(const protocol::Topic& topic) const noexcept {
    return status_bit(topic) == false;
  }
  /// The names of the sensors whose bits are set: "gyroscope, odometry".
  [[nodiscard]] std::string sensors_of(std::size_t board, std::int64_t bits) const {
    std::string text;
    for (std::size_t i = 0; i < sensors_[board].size() && i < 8; ++i)
      if ((bits >> i & 1) != 0) text.append(text.empty() ? "" : ", ").append(sensors_[board][i]->name);
    return text;
  }

  /// The most serious first; within a severity in the order of the boards. For who has asked all boards for
  /// their status, and given them the time to answer.
  [[nodiscard]] std::vector<Finding> findings() const {
    return findings([](std::size_t) { return true; });
  }
  /// The same where that is not so: that a board says nothing is found only if `was_asked(board)`, its
  /// number, so that nothing is found on absence of evidence.
  template <class WasAsked>
  [[nodiscard]] std::vector<Finding> findings(const WasAsked& was_asked) const {
    std::vector<Finding> all;
    bool any_status = false;
    bool any_answer = false;
    bool all_asked = true;
    for (std::size_t i = 0; i < boards_.size(); ++i) {
      const BoardReport& board = boards_[i];
      any_status = any_status || board.status != nullptr;
      any_answer = any_answer || board.answered || board.heard;
      all_asked = all_asked && (board.status == nullptr || was_asked(i));
    }
    if (any_status && !any_answer && all_asked) {
      all.push_back({Severity::problem, "", "no board answers",
                     "is the robot on, is the bus terminated at both ends, is its bit rate " +
                         std::to_string(catalogue_->bit_rate) + " bit/s?",
                     Ailment::no_answer});
    } else {
      for (std::size_t i = 0; i < boards_.size(); ++i)
        if (boards_[i].answered || was_asked(i)) examine(i, all);
    }
    if (battery_.answered) examine_battery(all);
    for (const BatteryMeasurement& each : batteries_.all) examine(each, all);
    std::vector<Finding> sorted;
    for (const Severity severity : {Severity::problem, Severity::warning, Severity::note})
      for (Finding& finding : all)
        if (finding.severity == severity) sorted.push_back(std::move(finding));
    return sorted;
  }

 private:
  /// A sample's fields by name.
  class Reader {
   public:
    explicit Reader(const Sample& sample) : sample_(&sample) {}
    [[nodiscard]] const protocol::Field* find(std::string_view frame, std::string_view field,
                                              std::int64_t& raw) const {
      const auto frames = sample_->topic->frames;
      for (std::size_t i = 0; i < frames.size(); ++i) {
        if (frames[i].name != frame) continue;
        for (const protocol::Field& f : frames[i].fields) {
          if (f.name != field) continue;
          raw = f.raw(sample_->data(i));
          return &f;
        }
      }
      return nullptr;
    }
    [[nodiscard]] std::int64_t raw(std::string_view frame, std::string_view field) const {
      std::int64_t number = 0;
      static_cast<void>(find(frame, field, number));
      return number;
    }
    [[nodiscard]] std::string_view word(std::string_view frame, std::string_view field) const {
      std::int64_t number = 0;
      const protocol::Field* f = find(frame, field, number);
      if (f == nullptr || f->flags) return {};
      for (const protocol::NamedValue& value : f->values)
        if (value.raw == number) return value.name;
      return {};
    }
    [[nodiscard]] bool flag(std::string_view flag_name) const {
      const auto frames = sample_->topic->frames;
      for (std::size_t i = 0; i < frames.size(); ++i)
        for (const protocol::Field& f : frames[i].fields)
          if (f.flags)
            for (const protocol::NamedValue& bit : f.values)
              if (bit.name == flag_name) return (f.raw(sample_->data(i)) >> bit.raw & 1) != 0;
      return false;
    }

   private:
    const Sample* sample_;
  };

  /// Of `publishing`; none: the board has not said, or has more sensors than bits.
  [[nodiscard]] std::optional<bool> status_bit(const protocol::Topic& topic) const noexcept {
    if (topic.board >= boards_.size() || !boards_[topic.board].answered) return {};
    const auto& sensors = sensors_[topic.board];
    for (std::size_t i = 0; i < sensors.size() && i < 8; ++i)
      if (sensors[i] == &topic) return (boards_[topic.board].publishing >> i & 1) != 0;
    return {};
  }

  static void take_status(const Reader& reader, BoardReport& board) {
    board.answered = true;
    board.uptime_s = reader.raw("identity", "uptime");
    board.reset = reader.word("identity", "reset");
    board.wire_hash = reader.raw("identity", "wire_hash");
    board.load = reader.raw("health", "load");
    if (reader.word("health", "load") == "unknown") board.load.reset();
    board.bus = reader.word("health", "bus");
    board.publishing = reader.raw("health", "publishing");
    board.faults = reader.raw("health", "faults");
    board.overload = reader.raw("health", "overload");
    board.bus_errors = reader.raw("health", "bus_errors");
  }
  void take_battery(const Reader& reader) {
    battery_.answered = true;
    for (const protocol::FrameLayout& frame : battery_.topic->frames)
      static_cast<void>(reader.find(frame.name, "state_of_charge", battery_.state_of_charge));
    battery_.plugged = reader.flag("plugged");
  }

  /// The four fields that make a frame that of a battery, in the order of BatteryMeasurement; fewer: it is
  /// none.
  [[nodiscard]] static std::vector<const protocol::Field*> of_battery(const protocol::FrameLayout& frame) {
    struct Wanted {
      std::string_view name;
      std::string_view unit;
    };
    constexpr Wanted all[]{{"voltage", "V"}, {"current", "A"}, {"remaining", "mAh"}, {"temperature", "degC"}};
    std::vector<const protocol::Field*> found;
    for (const Wanted& wanted : all)
      for (const protocol::Field& field : frame.fields)
        if (field.name == wanted.name && field.unit == wanted.unit) found.push_back(&field);
    return found;
  }
  void take_batteries(const Sample& sample) {
    batteries_.all.clear();
    for (std::size_t i = 0; i < batteries_.topic->frames.size(); ++i) {
      const protocol::FrameLayout& frame = batteries_.topic->frames[i];
      const auto fields = of_battery(frame);
      const auto value = [&](std::size_t field) {
        return fields[field]->value(fields[field]->raw(sample.data(i)));
      };
      const std::int64_t voltage = fields[0]->raw(sample.data(i));
      const bool none = std::any_of(fields[0]->values.begin(), fields[0]->values.end(),
                                    [voltage](const protocol::NamedValue& named) {
                                      return named.raw == voltage && named.name == "no_battery";
                                    });
      batteries_.all.push_back({frame.name, !none, value(0), value(1), value(2), value(3)});
    }
  }

  void examine(std::size_t index, std::vector<Finding>& all) const {
    const BoardReport& board = boards_[index];
    const std::string_view who = catalogue_->boards[index].name;
    if (board.status == nullptr) return;
    const auto tell = [&](Ailment ailment, Severity severity, std::string what, std::string remedy,
                          std::string_view topic = {}) {
      all.push_back({severity, who, std::move(what), std::move(remedy), ailment, topic});
    };
    if (!board.answered) {
      if (board.heard)
        return tell(Ailment::statusless, Severity::warning, "sends, and does not say how it is",
                    "it runs a firmware without a status; flash the present one");
      return tell(Ailment::silent, Severity::problem, "does not answer",
                  "is it plugged in, has it power, was it flashed? A board that is off sends nothing");
    }
    if (static_cast<std::uint32_t>(board.wire_hash) != protocol::wire_hash(*catalogue_))
      tell(Ailment::foreign_spec, Severity::problem,
           "was built from another spec: its numbers may mean something else",
           "flash it from this spec, or read its frames with the spec that it was built from");
    if (board.bus != "active")
      tell(Ailment::bus_state, board.bus == "off" ? Severity::problem : Severity::warning,
           "its CAN controller is in state " + std::string{board.bus.empty() ? "?" : board.bus},
           "check cable, termination and that every node has the same bit rate");
    if (board.faults != 0)
      tell(Ailment::part_faults, Severity::warning,
           "no answer from the part behind " + sensors_of(index, board.faults),
           "check how it is connected; the board keeps trying, and everything else goes on");
    if (board.overload != 0) {
      const std::string running = sensors_of(index, board.publishing);
      tell(Ailment::overload, Severity::warning,
           counted(static_cast<std::uint64_t>(board.overload), "release* came late or not at all"),
           "ask for longer periods" + (running.empty() ? std::string{} : "; it publishes " + running));
    }
    if (board.load && *board.load >= load_high_percent)
      tell(Ailment::busy, Severity::warning,
           "its CPU is busy for " + std::to_string(*board.load) + " % of the time",
           "ask for longer periods, or for fewer topics");
    if (const std::string_view breakdown = breakdown_in_words(board.reset); !breakdown.empty())
      tell(Ailment::restarted, Severity::warning, "it started again because of " + std::string{breakdown},
           board.reset == "clock_failure"
               ? "have the board's crystal checked"
               : "a firmware that hung or crashed: note what was asked of it before");
    if (board.bus_errors != 0)
      tell(Ailment::bus_errors, Severity::note,
           counted(static_cast<std::uint64_t>(board.bus_errors),
                   "error* on the bus or frames given up so far"),
           "few are normal when nodes come and go; many point to cable or termination");
    if (board.line_lost != 0)
      tell(Ailment::line_lost, Severity::warning,
           counted(static_cast<std::uint64_t>(board.line_lost),
                   "time* so far a frame or a character of a host on its serial line was lost"),
           "a serial line of 115200 baud carries some 440 frames/s: publish less, or use an adapter on the "
           "CAN bus");
    if (board.refused != 0) {
      const protocol::Topic* topic =
          catalogue_->find(protocol::TopicId{static_cast<std::uint8_t>(board.refused_topic)});
      const std::string_view about = topic != nullptr ? topic->name : std::string_view{};
      const bool late = board.reason == "not_schedulable" && topic != nullptr;
      tell(late ? Ailment::not_schedulable : Ailment::refusals, Severity::note,
           counted(static_cast<std::uint64_t>(board.refused), "request* refused so far, the last for ") +
               std::string{about.empty() ? "?" : about} + ": " +
               std::string{board.reason.empty() ? "?" : board.reason},
           late ? "ask for a longer period, or stop another stream of the board"
                : "ask only for what the spec says that it takes",
           about);
    }
  }

  void examine_battery(std::vector<Finding>& all) const {
    if (battery_.plugged || battery_.state_of_charge > battery_low_percent) return;
    all.push_back({battery_.state_of_charge <= battery_empty_percent ? Severity::problem : Severity::warning,
                   catalogue_->boards[battery_.topic->board].name,
                   "the battery has " + std::to_string(battery_.state_of_charge) + " % left",
                   "plug the charger in", Ailment::battery_low});
  }

  void examine(const BatteryMeasurement& battery, std::vector<Finding>& all) const {
    const auto tell = [&](Ailment ailment, Severity severity, std::string_view what,
                          std::string_view remedy) {
      all.push_back({severity, catalogue_->boards[batteries_.topic->board].name,
                     std::string{battery.name} + std::string{what}, std::string{remedy}, ailment,
                     batteries_.topic->name});
    };
    if (!battery.present)
      return tell(Ailment::no_battery, Severity::note, " is not inserted",
                  "the robot runs on the rest; does it sit as it should?");
    if (battery.temperature_celsius >= battery_hot_celsius)
      tell(Ailment::battery_temperature, Severity::warning, " is too hot",
           "switch the robot off and let it cool");
    if (battery.temperature_celsius <= battery_cold_celsius)
      tell(Ailment::battery_temperature, Severity::warning, " is too cold",
           "let it get warm before it is used");
  }

  const protocol::Catalogue* catalogue_;
  std::vector<BoardReport> boards_;
  std::vector<std::vector<const protocol::Topic*>> sensors_;  // of each board, in the order of the spec
  BatteryReport battery_;
  BatteriesReport batteries_;
};

/// Which boards were asked for their status, by any program: for who watches a bus, and does not ask itself.
/// Without it a board that nothing was asked of looks like one that does not answer. O(boards) a request.
class StatusRequests {
 public:
  /// So long a board may take to answer: far more than bus and board need. [decided]
  static constexpr base::Duration patience = std::chrono::milliseconds{500};

  explicit StatusRequests(const protocol::Catalogue& catalogue) : asked_(catalogue.boards.size()) {}

  /// Every frame, those that this program sends, too, and what it turned out to be. Only a request for one
  /// status counts: a board that is to stop or to publish need not answer soon.
  void take(const can::Received& received, const Reception& reception) {
    if (reception.meaning != Meaning::request || reception.topic->role != protocol::Role::status) return;
    if (reception.topic->board >= asked_.size()) return;
    const auto request = protocol::decode_request(received.frame);
    if (!request || request->mode != protocol::Mode::once) return;
    if (auto& first = asked_[reception.topic->board]; !first) first = received.time;
  }
  /// Whether the board was asked.
  [[nodiscard]] bool any(std::size_t board) const noexcept { return asked_[board].has_value(); }
  /// Whether it was asked, and has had the time to answer by now.
  [[nodiscard]] bool is_due(std::size_t board, base::Time now) const noexcept {
    return asked_[board] && now - *asked_[board] >= patience;
  }

 private:
  std::vector<std::optional<base::Time>> asked_;  ///< each board, first
};

}  // namespace ocm::client
