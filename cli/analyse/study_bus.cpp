/// Bus sets through the analysis of ocm/analysis/can_response.hpp.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "ocm/analysis/can_assignment.hpp"
#include "ocm/analysis/can_offsets.hpp"
#include "ocm/analysis/can_queues.hpp"
#include "ocm/analysis/checked.hpp"
#include "ocm/can/fd_worst_bits.hpp"
#include "ocm/can/worst_bits.hpp"
#include "ocm/protocol/identifier.hpp"

#include "cli/analyse/search.hpp"
#include "cli/analyse/study.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::analyse {
namespace {

using analysis::CanTest;
using analysis::Checked;
using analysis::Explained;
using analysis::Message;
using Analysis = analysis::CanResponse<most_messages>;

/// Enough for any robot's bus; what takes longer counts as "does not pass".
/// Beyond, what each message could still do is not looked for: 62 tests of the set each.
constexpr std::size_t most_rooms = 128;
/// [CiA 301, table 1]
constexpr std::array<std::int64_t, 8> usual_bit_rates{10'000,  20'000,  50'000,  125'000,
                                                      250'000, 500'000, 800'000, 1'000'000};

std::string bit_rate_text(std::int64_t rate) {
  if (rate % 1'000'000 == 0) return fmt::format("{} Mbit/s", rate / 1'000'000);
  return rate % 1000 == 0 ? fmt::format("{} kbit/s", rate / 1000) : fmt::format("{} bit/s", rate);
}

std::string id_text(const can::AnyFrame& head) {
  return can::is_extended(head.format) ? fmt::format("0x{:08X}", head.id) : fmt::format("0x{:03X}", head.id);
}

std::string size_text(const can::AnyFrame& head, const can::FdBits& bits) {
  if (bits.data == 0)
    return fmt::format("{} B{}, {} bits", head.length, head.is_fd() ? " FD" : "", bits.nominal);
  return fmt::format("{} B FD, {} + {} bits", head.length, bits.nominal, bits.data);
}

/// The longest frames of a CAN FD message. Where no rate is known for its data, all of it counts at that of
/// the rest, with the switch or without: longer than it is.
can::FdBits longest_fd(const can::AnyFrame& head, const BusOptions& options) {
  const auto bits = [&](bool switches) {
    return options.lengths == Lengths::exact ? can::fd_worst_bits(head.id, head.format, head.length, switches)
                                             : can::fd_worst_bits(head.format, head.length, switches);
  };
  const bool switches = (head.flags & can::frame_flag::bit_rate_switch) != 0;
  if (!switches || options.data_bit_rate != 0) return bits(switches);
  const can::FdBits fast = bits(true);
  return {std::max(fast.nominal + fast.data, bits(false).nominal), 0};
}

/// Of any message; `exact` is made when it is needed first.
can::FdBits longest_of(const BusEntry& entry, const BusOptions& options,
                       std::unique_ptr<can::WorstBits>& exact) {
  const can::AnyFrame& head = entry.head;
  if (head.is_fd()) {
    if (options.lengths == Lengths::generic || entry.any_id == 0) return longest_fd(head, options);
    BusOptions any = options;  // a parameter group: the closed bound
    any.lengths = Lengths::generic;
    return longest_fd(head, any);
  }
  if (options.lengths == Lengths::generic) return {can::worst_frame_bits(head.format, head.length), 0};
  if (entry.bits != 0) return {entry.bits, 0};
  // A group to one address is 65536 identifiers, and each variant of a set asks again.
  static std::map<std::tuple<std::uint32_t, std::uint32_t, can::Format, std::uint8_t>, unsigned> known;
  const auto [at, is_new] = known.try_emplace({head.id, entry.any_id, head.format, head.length}, 0);
  if (!is_new) return {at->second, 0};
  if (exact == nullptr) exact = std::make_unique<can::WorstBits>();
  at->second = exact->bits_of_any(head.id, entry.any_id, head.format, head.length);
  return {at->second, 0};
}

std::int64_t cost_of(const can::FdBits& bits, const BusOptions& options) {
  const auto rate = static_cast<std::uint32_t>(options.bit_rate);
  const auto data_rate = static_cast<std::uint32_t>(std::max(options.data_bit_rate, options.bit_rate));
  return analysis::bits_ns(bits, rate, data_rate);
}

/// The analysis that a model needs. Where queues are given, offsets do not count: that is safe.
class Solver {
 public:
  explicit Solver(const BusModel& model) {
    if (!model.queues.empty())
      queues_ = std::make_unique<analysis::CanQueues<most_messages>>();
    else if (model.offsets)
      offsets_ = std::make_unique<analysis::CanOffsets<most_messages, most_clocks>>();
    else
      plain_ = std::make_unique<Analysis>();
  }
  /// `observe` as CanResponse::analyse has it; it is not called for queues and offsets.
  template <class Observer = decltype(analysis::unobserved)>
  std::span<const Explained> solve(const BusModel& model, CanTest test, analysis::Limits limits = {},
                                   Observer&& observe = Observer{}) {
    if (queues_) return queues_->analyse(model.messages, model.queues, model.bus, limits);
    if (offsets_) return with_offsets(model, test, limits);
    return plain_->analyse(model.messages, model.bus, test, limits, observe);
  }
  /// Whether a test of the whole set is quick enough for thousands of them.
  [[nodiscard]] bool fast() const { return queues_ == nullptr && offsets_ == nullptr; }

 private:
  /// Patterns may be too long to search; without offsets there may be a bound all the same.
  std::span<const Explained> with_offsets(const BusModel& model, CanTest test, analysis::Limits limits) {
    const auto results = offsets_->analyse(model.messages, model.bus, limits);
    const auto gave_up = [](const Explained& result) { return result.reason == analysis::Reason::too_long; };
    if (std::none_of(results.begin(), results.end(), gave_up)) return results;
    if (plain_ == nullptr) plain_ = std::make_unique<Analysis>();
    const auto without = plain_->analyse(model.messages, model.bus, test, limits);
    best_.assign(results.begin(), results.end());
    for (std::size_t i = 0; i < best_.size(); ++i)
      if (gave_up(best_[i])) best_[i] = without[i];
    return best_;
  }

  std::vector<Explained> best_;
  std::unique_ptr<Analysis> plain_;
  std::unique_ptr<analysis::CanQueues<most_messages>> queues_;
  std::unique_ptr<analysis::CanOffsets<most_messages, most_clocks>> offsets_;
};

/// Tests variants of a set.
class Trial {
 public:
  Trial(const BusModel& model, CanTest test) : model_(model), test_(test), solver_(model) {}
  /// All meet their deadlines.
  [[nodiscard]] bool passes() {
    const auto results = solver_.solve(model_, test_, quick);
    return std::all_of(results.begin(), results.end(), [](const auto& result) { return result.ok(); });
  }
  BusModel& model() { return model_; }
  [[nodiscard]] bool fast() const { return solver_.fast(); }

 private:
  BusModel model_;
  CanTest test_;
  Solver solver_;
};

std::vector<std::string> names_of(const std::vector<std::string>& nodes) {
  std::vector<std::string> names;
  for (const std::string& node : nodes)
    if (!node.empty()) names.push_back(node);
  return names;
}

/// Names of nodes become numbers.
void set_nodes(const BusSet& set, const BusOptions& options, BusModel& model) {
  model.offsets = options.test == CanTest::exact && options.queues.empty() &&
                  std::any_of(set.entries.begin(), set.entries.end(),
                              [](const BusEntry& entry) { return entry.offset > 0; });
  for (std::size_t i = 0; i < set.entries.size(); ++i) {
    const BusEntry& entry = set.entries[i];
    // What comes on events comes by no clock.
    const bool own = entry.node.empty() || (model.offsets && entry.sporadic);
    const auto known =
        own ? model.nodes.end() : std::find(model.nodes.begin(), model.nodes.end(), entry.node);
    model.messages[i].node = static_cast<std::uint16_t>(known - model.nodes.begin());
    model.messages[i].offset = entry.offset;
    if (known == model.nodes.end()) model.nodes.push_back(own ? std::string{} : entry.node);
  }
  if (model.offsets && model.nodes.size() > most_clocks)
    fail({fmt::format("analyse bus: offsets by more than {} clocks", most_clocks),
          "a message of no node has a clock of its own: name the nodes, or leave out the offsets"},
         exit_usage);
  if (options.queues.empty()) return;
  model.queues.resize(model.nodes.size());
  for (const BusOptions::Queue& queue : options.queues) {
    const auto node = std::find(model.nodes.begin(), model.nodes.end(), queue.node);
    if (node == model.nodes.end())
      fail({fmt::format("--queue {}: no node of this name sends anything", queue.node),
            fmt::format("one of {}", fmt::join(names_of(model.nodes), ", "))},
           exit_usage);
    model.queues[static_cast<std::size_t>(node - model.nodes.begin())] = queue.queue;
  }
}

/// Audsley's order, as indices; first the lowest level that no message can take, or none.
std::pair<std::size_t, std::vector<std::size_t>> best_order(BusModel model) {
  for (std::size_t i = 0; i < model.messages.size(); ++i)
    model.messages[i].key = static_cast<std::uint32_t>(i);
  const auto analysis = std::make_unique<Analysis>();
  const std::size_t stuck = analysis::assign_priorities<most_messages>(model.messages, model.bus, *analysis);
  std::vector<std::size_t> order;
  for (const Message& message : model.messages) order.push_back(message.key);
  return {stuck, order};
}

/// The identifiers that there are, handed out in Audsley's order.
void assign_identifiers(BusSet& set, const BusOptions& options) {
  const auto [stuck, order] = best_order(model_of(set, options));
  if (stuck != analysis::no_index) {
    set.remarks.push_back(
        fmt::format("No order of identifiers makes all meet their deadlines: {} of the "
                    "messages cannot share the bus whatever their order is.",
                    stuck + 1));
    return;
  }
  std::vector<BusEntry> entries;
  for (std::size_t i = 0; i < order.size(); ++i) {
    entries.push_back(set.entries[order[i]]);
    entries.back().head.id = set.entries[i].head.id;
  }
  set.entries = std::move(entries);
  set.remarks.emplace_back("The identifiers are assigned again: in this order all meet their deadlines.");
}

/// Direction and topic stay, the priority is chosen: the least urgent one with which all are in time.
void assign_layout(BusSet& set, const BusOptions& options) {
  const BusModel model = model_of(set, options);
  const auto lengths = std::make_unique<can::WorstBits>();
  std::vector<analysis::TopicMessage> topics;
  std::map<std::pair<protocol::Direction, std::uint8_t>, BusEntry> of;
  for (std::size_t i = 0; i < set.entries.size(); ++i) {
    const auto id = protocol::Identifier::decode(static_cast<std::uint16_t>(set.entries[i].head.id));
    analysis::TopicMessage topic{model.messages[i], id.direction, id.topic};
    unsigned bits = 0;  // whatever its priority will be
    for (unsigned level = 0; level < protocol::priority_levels; ++level) {
      const protocol::Identifier tried{id.direction, static_cast<protocol::Priority>(level), id.topic};
      bits = std::max(bits, lengths->bits(tried.encode(), can::Format::base, set.entries[i].head.length));
    }
    topic.message.cost = analysis::bits_ns(bits, static_cast<std::uint32_t>(options.bit_rate));
    topics.push_back(topic);
    of[{id.direction, id.topic.value}] = set.entries[i];
  }
  const auto analysis = std::make_unique<Analysis>();
  const std::size_t stuck =
      analysis::assign_in_layout<most_messages>(std::span{topics}, model.bus, *analysis);
  if (stuck != analysis::no_index) {
    const auto& late = topics[stuck];
    set.remarks.push_back(
        fmt::format("No choice of priorities makes all meet their deadlines: {} is late "
                    "even at urgent.",
                    of.at({late.direction, late.topic.value}).name));
    return;
  }
  set.entries.clear();
  for (const auto& topic : topics) {
    set.entries.push_back(of.at({topic.direction, topic.topic.value}));
    set.entries.back().head.id = topic.identifier();
    set.entries.back().bits = 0;  // of the new identifier
  }
  set.remarks.emplace_back(
      "The priorities are assigned again: the least urgent ones with which all meet their deadlines.");
}

}  // namespace

void assign(BusSet& set, const BusOptions& options, Assign what) {
  if (what == Assign::identifiers) assign_identifiers(set, options);
  if (what == Assign::priorities) assign_layout(set, options);
}

BusOptions at_rates_of(const BusSet& set, BusOptions options) {
  if (options.bit_rate == 0) options.bit_rate = set.bit_rate != 0 ? set.bit_rate : options.usual_bit_rate;
  if (options.bit_rate == 0)
    fail({"the spec says no bit rate", "--bitrate gives it, such as --bitrate 500k"}, exit_usage);
  const bool given = options.data_bit_rate != 0;
  if (!given) options.data_bit_rate = set.data_bit_rate;
  if (options.data_bit_rate != 0 && options.data_bit_rate < options.bit_rate)
    fail({fmt::format("{}: {} is slower than the rest of the frame, {}",
                      given ? "--data-bitrate" : "the data rate of the set",
                      bit_rate_text(options.data_bit_rate), bit_rate_text(options.bit_rate)),
          given ? "the data of CAN FD are sent at least as fast"
                : "the data of CAN FD are sent at least as fast; --data-bitrate gives another one"},
         exit_usage);
  return options;
}

BusModel model_of(const BusSet& set, const BusOptions& options) {
  BusModel model;
  std::unique_ptr<can::WorstBits> exact;
  for (const BusEntry& entry : set.entries) {
    const can::FdBits bits = longest_of(entry, options, exact);
    model.bits.push_back(bits);
    model.messages.push_back({.cost = cost_of(bits, options),
                              .period = entry.period,
                              .deadline = entry.deadline_at(entry.period),
                              .jitter = entry.jitter,
                              .key = can::arbitration_key(entry.head)});
  }
  set_nodes(set, options, model);
  model.bus.bit = analysis::bits_ns(1, static_cast<std::uint32_t>(options.bit_rate));
  model.bus.errors = {.burst = options.error_burst, .every = options.error_every};
  return model;
}

Study study_bus(const BusSet& set, const BusOptions& options) {
  const BusModel model = model_of(set, options);
  Solver solver{model};
  std::vector<std::vector<std::int64_t>> instances(set.entries.size());
  const auto results =
      solver.solve(model, options.test, {}, [&](std::size_t m, std::int64_t, std::int64_t response) {
        if (instances[m].size() < most_instances) instances[m].push_back(response);
      });
  Study study;
  study.kind = Study::Kind::bus;
  study.with_errors = options.error_burst > 0;
  for (std::size_t i = 0; i < set.entries.size(); ++i) {
    const BusEntry& entry = set.entries[i];
    const Message& message = model.messages[i];
    study.load.add(message.cost, message.period);
    if (!results[i].bounded()) instances[i].clear();
    if (results[i].bounded() && instances[i].empty()) instances[i] = {results[i].response};
    study.rows.push_back({entry.name,
                          id_text(entry.head),
                          size_text(entry.head, model.bits[i]),
                          message.cost,
                          message.period,
                          message.jitter,
                          results[i],
                          std::move(instances[i]),
                          {},
                          model.bits[i].nominal,
                          model.bits[i].data,
                          entry.sporadic});
  }
  for (std::size_t i = 0; i < study.rows.size(); ++i) study.rows[i].why = explain(study, i);
  const bool fd = std::any_of(set.entries.begin(), set.entries.end(),
                              [](const BusEntry& entry) { return entry.head.is_fd(); });
  study.head = fmt::format("{}{}, {} lengths, {} test", bit_rate_text(options.bit_rate),
                           fd && options.data_bit_rate != 0
                               ? fmt::format(" and {} for data", bit_rate_text(options.data_bit_rate))
                               : "",
                           options.lengths == Lengths::exact ? "exact" : "generic",
                           options.test == CanTest::exact ? "exact" : "sufficient");
  if (options.error_burst > 0)
    study.head +=
        options.error_every > 0
            ? fmt::format(", {} at once and one more every {}",
                          counted(static_cast<std::uint64_t>(options.error_burst), "error"),
                          time_text(options.error_every))
            : fmt::format(", {} at most", counted(static_cast<std::uint64_t>(options.error_burst), "error"));
  if (model.offsets) study.head += ", with offsets";
  if (!model.queues.empty()) study.head += ", with queues";
  for (const BusOptions::Queue& queue : options.queues) {
    const auto node = std::find(model.nodes.begin(), model.nodes.end(), queue.node) - model.nodes.begin();
    study.queues.push_back(
        {queue.node, analysis::queue_bound(model.messages, results, static_cast<std::uint16_t>(node))});
  }
  study.left_out = set.left_out;
  study.remarks = set.remarks;
  if (fd && options.data_bit_rate == 0)
    study.remarks.emplace_back(
        "No data bit rate is given: CAN FD frames count at the bit rate, longer than they are. "
        "--data-bitrate "
        "gives it.");
  return study;
}

Advice advise_bus(const BusSet& set, const BusOptions& options, const Study& study) {
  Advice advice;
  Trial trial{model_of(set, options), options.test};
  auto& messages = trial.model().messages;
  const bool passes = study.passes();
  if (messages.size() <= most_rooms && trial.fast()) {
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const std::int64_t before = messages[i].period;
      const auto shortest = last_good(analysis::longest_looked_for, 1, [&](std::int64_t period) {
        messages[i].period = period;
        messages[i].deadline = set.entries[i].deadline_at(period);
        return trial.passes();
      });
      messages[i].period = before;
      messages[i].deadline = set.entries[i].deadline_at(before);
      advice.rooms.push_back({.shortest_period = shortest.value_or(0), .greatest_cost = 0});
      if (!passes && shortest)
        advice.changes.push_back(fmt::format("{} every {} instead of every {}", set.entries[i].name,
                                             time_text(*shortest), time_text(before)));
    }
  }
  if (passes) {
    for (const std::int64_t rate : usual_bit_rates) {
      if (rate >= options.bit_rate) break;
      BusOptions slower = options;
      slower.bit_rate = rate;
      Trial slow{model_of(set, slower), options.test};
      if (!slow.passes()) continue;
      advice.changes.push_back(fmt::format("{} would do, too", bit_rate_text(rate)));
      break;
    }
    return advice;
  }
  for (const std::int64_t rate : usual_bit_rates) {
    if (rate <= options.bit_rate) continue;
    BusOptions faster = options;
    faster.bit_rate = rate;
    Trial fast{model_of(set, faster), options.test};
    if (!fast.passes()) continue;
    advice.changes.push_back(fmt::format("a bit rate of {}", bit_rate_text(rate)));
    break;
  }
  constexpr std::int64_t permille = 1000;
  const auto stretched = last_good(1000 * permille, permille, [&](std::int64_t factor) {
    BusModel& model = trial.model();
    const BusModel before = model;
    for (std::size_t i = 0; i < model.messages.size(); ++i) {
      Message& message = model.messages[i];
      message.period =
          analysis::ceil_div(Checked{message.period} * factor, permille).value_or(message.period);
      message.deadline = set.entries[i].deadline_at(message.period);
    }
    const bool good = trial.passes();
    model = before;
    return good;
  });
  if (stretched)
    advice.changes.push_back(
        fmt::format("all periods {}.{:03} times as long", *stretched / permille, *stretched % permille));
  if (options.test == CanTest::exact && options.lengths == Lengths::generic &&
      messages.size() <= most_rooms && trial.fast()) {
    const auto [stuck, order] = best_order(trial.model());
    std::string names;
    for (const std::size_t i : order) names += (names.empty() ? "" : ", ") + set.entries[i].name;
    if (stuck == analysis::no_index) advice.changes.push_back("identifiers in this order: " + names);
  }
  return advice;
}

}  // namespace ocm::cli::analyse
