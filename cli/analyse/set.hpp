/// The sets that `amiroctl analyse` looks at, and where they come from: CSV, a spec (JSON or DBC), a robot's
/// catalogue.
///
/// A reader that finds mistakes prints each with its file, line and remedy, and leaves with exit_usage; a
/// file that cannot be read is exit_failure.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/analysis/message_set.hpp"
#include "ocm/analysis/task_set.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/protocol/topic.hpp"

#include "generator/spec/model.hpp"

namespace ocm::cli::analyse {

/// A message as its file has it. Times are nanoseconds.
struct BusEntry {
  std::string name;
  can::AnyFrame head;        ///< identifier, format, length and flags; no data
  std::uint32_t any_id = 0;  ///< bits of the identifier that may be others: of J1939 its source
  unsigned bits = 0;         ///< the most bits that a spec gives for it; 0: none given
  std::int64_t period = 0;
  std::int64_t deadline = analysis::implicit_deadline;
  std::int64_t jitter = 0;
  std::int64_t offset = 0;   ///< of its first release, by the clock of its node
  std::string node;          ///< who sends it; empty: not told
  std::size_t line = 0;      ///< of its file; 0: from no file
  bool overwritten = false;  ///< the next of its kind has to find it gone: D is T at most
  bool sporadic = false;     ///< on no grid: `period` is the shortest distance of two, and no clock is its

  [[nodiscard]] std::int64_t deadline_at(std::int64_t at_period) const {
    const bool implicit = deadline == analysis::implicit_deadline;
    return overwritten && !implicit ? std::min(deadline, at_period) : deadline;
  }
};
/// What is sent on the bus and is not in the set, or not all of it.
struct LeftOut {
  enum class Reason : std::uint8_t {
    no_period,           ///< nor a shortest distance
    no_distance,         ///< on events, as close to each other as they like
    events,              ///< in the set on its grid; its events are not
    transport_protocol,  ///< longer than a frame: several frames of J1939
    too_long,            ///< longer than any frame
  };
  std::string name;
  Reason reason = Reason::no_period;
};
[[nodiscard]] std::string_view key_of(LeftOut::Reason reason);   ///< "no_period"
[[nodiscard]] std::string_view text_of(LeftOut::Reason reason);  ///< a few words

/// In the order of arbitration, with identifiers that differ.
struct BusSet {
  std::vector<BusEntry> entries;
  std::vector<LeftOut> left_out;     ///< in the order of their source
  std::uint32_t bit_rate = 0;        ///< as its source says; 0: it does not
  std::uint32_t data_bit_rate = 0;   ///< of CAN FD
  std::vector<std::string> remarks;  ///< what is not in the set, and other things to know
};

struct TaskEntry {
  std::string name;
  std::int64_t priority = 0;  ///< greater is more urgent
  analysis::Task task;        ///< its level is the place of its priority
};
/// The most urgent first.
struct TaskSet {
  std::vector<TaskEntry> entries;
};

/// A period given on the command line or in a file of rates.
struct Rate {
  std::string name;  ///< a topic's name or alias, or a message's
  base::Duration period{};
  bool off = false;
  bool has_priority = false;
  protocol::Priority priority = protocol::default_priority;
  std::string place;  ///< for messages: "--rates gyro=1", "rates.txt:3"
};

/// More messages than a bus with 11-bit identifiers can have; the analysis takes this many.
inline constexpr std::size_t most_messages = 4096;
inline constexpr std::size_t most_tasks = 4096;
/// Clocks that offsets can count from.
inline constexpr std::size_t most_clocks = 64;

/// One mistake: "place: what", and below it the remedy.
struct Mistake {
  std::string place;
  std::string what;
  std::string remedy;
};
/// Prints them, and leaves with exit_usage; does nothing if there are none.
void stop_at(const std::vector<Mistake>& mistakes, std::string_view file);

/// The names of the sets of spec/tasks.json: the boards', and those of the robots of the theses.
[[nodiscard]] std::vector<std::string> own_task_sets();
/// One of them; empty if there is none of this name.
[[nodiscard]] TaskSet own_tasks(std::string_view name);

/// All of a file, or of standard input for "-".
[[nodiscard]] std::string read_text(const std::string& file);

/// Lines of a table with a header, as csv.cpp splits them.
struct Line {
  std::size_t number = 0;
  std::vector<std::string> cells;
};
/// Cells are separated by commas and may be in double quotes; empty lines and those that begin with # are
/// left out, and so are spaces around a cell.
[[nodiscard]] std::vector<Line> split_csv(std::string_view text);

/// A spec (DBC or JSON, by its content), or CSV:
/// `name,id,dlc,period_ns,deadline_ns,jitter_ns,node,offset_ns,fd`. Changed by `rates`.
[[nodiscard]] BusSet read_bus(const std::string& file, const std::vector<Rate>& rates = {});
/// `name,priority,C_ns,T_ns,D_ns,J_ns,B_ns`
[[nodiscard]] TaskSet read_tasks(const std::string& file);

/// Whether a file is a set of tasks: its header has C_ns.
[[nodiscard]] bool is_task_set(const std::string& file);

/// A hop of a chain: `hop,set,activation,response_ns,best_ns,period_ns`.
struct HopEntry {
  std::string name;  ///< of the task or message in its set
  std::string
      set;  ///< a file beside that of the chain; "robot": the robot's topics; empty: `response` is given
  bool sampled = true;  ///< or triggered by the hop before
  std::int64_t response = 0;
  std::int64_t best = 0;
  std::int64_t period = 0;
  std::size_t line = 0;
};
[[nodiscard]] std::vector<HopEntry> read_chain(const std::string& file);

/// Words of --rates: "topic=period", "topic=period@priority", "topic=off", or the name of a file of such
/// lines.
[[nodiscard]] std::vector<Rate> read_rates(const std::vector<std::string>& words);
/// A robot's sensors as they are sent unless a request changes it, its drive, and plain messages, changed by
/// `rates`. `model`: what else the catalogue's spec says of the messages; none has messages without it.
/// `source` is named where something is wrong.
[[nodiscard]] BusSet robot_bus(const protocol::Catalogue& catalogue, const spec::Model* model,
                               const std::vector<Rate>& rates, const std::string& source = "--rates");
/// The same of a spec, JSON or DBC; what is doubtful in it becomes remarks.
[[nodiscard]] BusSet read_spec(std::string_view text, const std::string& file,
                               const std::vector<Rate>& rates);
/// Changes the periods of a set of a table.
void apply_rates(BusSet& set, const std::vector<Rate>& rates);
/// A plain message for a set; `period`: what a rate gives, 0: as its source says. Nothing where no frame of
/// it can be counted; `left_out` says what is not, then or of its events.
[[nodiscard]] std::optional<BusEntry> entry_of(const spec::MessageModel& message, std::string_view sender,
                                               std::int64_t period, std::vector<LeftOut>& left_out);
/// Of a spec with start delays by more clocks than can be counted from: all are left out, with a remark.
void limit_clocks(BusSet& set);

/// Puts messages into the order of arbitration; of equal identifiers the second is a mistake.
void order_bus(BusSet& set, std::string_view file, std::vector<Mistake>& mistakes);

}  // namespace ocm::cli::analyse
