/// What the analysis says of a set, for all outputs: a row a message or task, the load, and what would help.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/analysis/can_queues.hpp"
#include "ocm/analysis/can_response.hpp"
#include "ocm/analysis/task_set.hpp"
#include "ocm/analysis/utilisation.hpp"
#include "ocm/analysis/verdict.hpp"
#include "ocm/can/fd_bits.hpp"

#include "cli/analyse/set.hpp"

namespace ocm::cli::analyse {

/// Responses listed of one busy period.
inline constexpr std::size_t most_instances = 1000;

/// Times are nanoseconds.
struct Row {
  std::string name;
  std::string rank;  ///< the identifier, or the priority
  std::string size;  ///< "8 B, 131 bits"; empty for tasks
  std::int64_t cost = 0;
  std::int64_t period = 0;
  std::int64_t jitter = 0;
  analysis::Explained result;
  std::vector<std::int64_t> instances;  ///< responses in the busy period; none where there is no bound
  std::string why;
  unsigned bits = 0;       ///< of a frame, at the bit rate
  unsigned data_bits = 0;  ///< at that of the data of CAN FD
  bool sporadic = false;   ///< on no grid: T is the shortest distance of two
};

/// Rows are in order of priority, the most urgent first.
struct Study {
  enum class Kind { bus, tasks } kind = Kind::bus;
  std::vector<Row> rows;
  analysis::Utilisation load;
  bool with_errors = false;          ///< an error model takes its share on top of the load
  std::string head;                  ///< bit rate and assumptions, or the processor's
  std::vector<LeftOut> left_out;     ///< what is sent and not in the set, or not all of it
  std::vector<std::string> remarks;  ///< other things to know
  struct Queue {
    std::string node;
    std::int64_t frames = 0;  ///< that wait or are sent at once, at most; 0: no bound
  };
  std::vector<Queue> queues;  ///< of the nodes of which the queue was given
  /// What the utilisation alone proves, of tasks: sufficient, and not necessary.
  struct QuickTest {
    std::string key;    ///< "liu_layland"
    std::string title;  ///< "Liu and Layland, sum of C/T"
    double value = 0;
    double bound = 0;  ///< the greatest value that proves anything
    bool proven = false;
    std::string verdict;
  };
  std::vector<QuickTest> tests;
  [[nodiscard]] bool passes() const;
  [[nodiscard]] double utilisation() const;
};

enum class Lengths { generic, exact };

struct BusOptions {
  std::int64_t bit_rate = 0;        ///< 0: that of the set
  std::int64_t data_bit_rate = 0;   ///< of CAN FD; 0: that of the set
  std::int64_t usual_bit_rate = 0;  ///< where the set has none
  Lengths lengths = Lengths::generic;
  analysis::CanTest test = analysis::CanTest::exact;
  std::int64_t error_burst = 0;
  std::int64_t error_every = 0;  ///< nanoseconds
  struct Queue {
    std::string node;
    analysis::NodeQueue queue;
  };
  std::vector<Queue> queues;  ///< of nodes that do not always offer their most urgent frame
};

/// A set ready for the analysis: nanoseconds, in the order of the entries.
struct BusModel {
  std::vector<analysis::Message> messages;
  std::vector<can::FdBits> bits;  ///< of a classic frame all nominal
  analysis::CanBus bus;
  std::vector<std::string> nodes;           ///< Message::node is an index; a message of no node has its own
  std::vector<analysis::NodeQueue> queues;  ///< one a node; empty: each offers its most urgent frame
  bool offsets = false;
};
/// With the bit rates that hold for a set.
[[nodiscard]] BusOptions at_rates_of(const BusSet& set, BusOptions options);
/// `options` are at_rates_of the set.
[[nodiscard]] BusModel model_of(const BusSet& set, const BusOptions& options);

[[nodiscard]] Study study_bus(const BusSet& set, const BusOptions& options);

/// Which identifiers may be assigned again: all of them, or the two bits of priority in a robot's.
enum class Assign { nothing, identifiers, priorities };
/// Gives the set identifiers with which all meet their deadlines, with a remark that says whether there are
/// any; if not, it stays as it is.
void assign(BusSet& set, const BusOptions& options, Assign what);
[[nodiscard]] Study study_tasks(const TaskSet& set, const analysis::Processor& processor);

/// For people: what of each row can change, and what would make all meet their deadlines.
struct Advice {
  struct Room {
    std::int64_t shortest_period = 0;  ///< 0: none found, or none looked for
    std::int64_t greatest_cost = 0;    ///< tasks; 0: none
  };
  std::vector<Room> rooms;           ///< one a row; empty: a set too large to look
  std::vector<std::string> changes;  ///< sentences
};
[[nodiscard]] Advice advise_bus(const BusSet& set, const BusOptions& options, const Study& study);
[[nodiscard]] Advice advise_tasks(const TaskSet& set, const analysis::Processor& processor,
                                  const Study& study);

/// One sentence: what delays it and by how much, or why there is no bound.
[[nodiscard]] std::string explain(const Study& study, std::size_t row);
[[nodiscard]] std::string time_text(std::int64_t nanoseconds);

}  // namespace ocm::cli::analyse
