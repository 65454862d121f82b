/// Bus sets through the analysis of ocm/analysis/can_response.hpp.
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <numeric>

#include <fmt/format.h>

#include "ocm/analysis/can_assignment.hpp"
#include "ocm/analysis/checked.hpp"
#include "ocm/can/worst_bits.hpp"

#include "cli/analyse/search.hpp"
#include "cli/analyse/study.hpp"

namespace ocm::cli::analyse {
namespace {

using analysis::CanTest;
using analysis::Checked;
using analysis::Message;
using Analysis = analysis::CanResponse<most_messages>;

/// Enough for whatever anybody means to build; what takes longer counts as "does not pass".
constexpr analysis::Limits quick{.terms = 200'000};
/// Beyond, what each message could still do is not looked for: 62 tests of the set each.
constexpr std::size_t most_rooms = 128;
/// [CiA 301, table 1]
constexpr std::array<std::int64_t, 8> usual_bit_rates{10'000,  20'000,  50'000,  125'000,
                                                      250'000, 500'000, 800'000, 1'000'000};
/// Responses listed of one busy period.
constexpr std::size_t most_instances = 1000;

/// The response of each release of the busy period, by the equation as it stands. The analysis gives the
/// worst only; that one is among these.
std::vector<std::int64_t> instances_of(const BusModel& model, std::size_t m,
                                       const analysis::Explained& result, CanTest test) {
  if (!result.bounded()) return {};
  if (result.instances <= 1 || test == CanTest::sufficient) return {result.response};
  const Message& message = model.messages[m];
  std::int64_t longest = 0;
  for (std::size_t k = 0; k <= m; ++k) longest = std::max(longest, model.messages[k].cost);
  std::vector<std::int64_t> responses;
  Checked window = result.blocking;
  const std::size_t count = std::min(result.instances, most_instances);
  for (std::size_t q = 0; q < count; ++q) {
    const Checked own = Checked{message.cost} * static_cast<std::int64_t>(q) + result.blocking;
    for (;;) {
      Checked next = own + analysis::error_delay(model.bus, longest, window + message.cost);
      for (std::size_t k = 0; k < m; ++k) {
        const Message& above = model.messages[k];
        next += analysis::ceil_div(window + above.jitter + model.bus.bit, above.period) * above.cost;
      }
      if (!next.ok() || next <= window) break;
      window = next;
    }
    responses.push_back(
        (window + message.jitter + message.cost - Checked{message.period} * static_cast<std::int64_t>(q))
            .value_or(analysis::unbounded));
    window += message.cost;
  }
  return responses;
}

std::string bit_rate_text(std::int64_t rate) {
  if (rate % 1'000'000 == 0) return fmt::format("{} Mbit/s", rate / 1'000'000);
  return rate % 1000 == 0 ? fmt::format("{} kbit/s", rate / 1000) : fmt::format("{} bit/s", rate);
}

std::string id_text(const can::Frame& head) {
  return can::is_extended(head.format) ? fmt::format("0x{:08X}", head.id) : fmt::format("0x{:03X}", head.id);
}

/// Tests variants of a set; nobody: all meet their deadlines.
class Trial {
 public:
  Trial(const BusModel& model, CanTest test)
      : model_(model), test_(test), analysis_(std::make_unique<Analysis>()) {}
  [[nodiscard]] bool passes() {
    const auto results = analysis_->analyse(model_.messages, model_.bus, test_, quick);
    return std::all_of(results.begin(), results.end(), [](const auto& result) { return result.ok(); });
  }
  BusModel& model() { return model_; }
  Analysis& analysis() { return *analysis_; }

 private:
  BusModel model_;
  CanTest test_;
  std::unique_ptr<Analysis> analysis_;
};

}  // namespace

BusModel model_of(const BusSet& set, const BusOptions& options) {
  BusModel model;
  const auto rate = static_cast<std::uint32_t>(options.bit_rate);
  std::unique_ptr<can::WorstBits> exact;
  for (const BusEntry& entry : set.entries) {
    unsigned bits = can::worst_frame_bits(entry.head.format, entry.head.dlc);
    if (options.lengths == Lengths::exact && entry.bits != 0) {
      bits = entry.bits;
    } else if (options.lengths == Lengths::exact) {
      if (exact == nullptr) exact = std::make_unique<can::WorstBits>();
      bits = exact->bits(entry.head.id, entry.head.format, entry.head.dlc);
    }
    model.bits.push_back(bits);
    model.messages.push_back({.cost = analysis::bits_ns(bits, rate),
                              .period = entry.period,
                              .deadline = entry.deadline_at(entry.period),
                              .jitter = entry.jitter,
                              .key = can::arbitration_key(entry.head)});
  }
  model.bus.bit = analysis::bits_ns(1, rate);
  model.bus.errors = {.burst = options.error_burst, .every = options.error_every};
  return model;
}

Study study_bus(const BusSet& set, const BusOptions& options) {
  const BusModel model = model_of(set, options);
  const auto analysis = std::make_unique<Analysis>();
  const auto results = analysis->analyse(model.messages, model.bus, options.test);
  Study study;
  study.kind = Study::Kind::bus;
  study.with_errors = options.error_burst > 0;
  for (std::size_t i = 0; i < set.entries.size(); ++i) {
    const BusEntry& entry = set.entries[i];
    const Message& message = model.messages[i];
    study.load.add(message.cost, message.period);
    study.rows.push_back({entry.name,
                          id_text(entry.head),
                          fmt::format("{} B, {} bits", entry.head.dlc, model.bits[i]),
                          message.cost,
                          message.period,
                          message.jitter,
                          results[i],
                          instances_of(model, i, results[i], options.test),
                          {}});
  }
  for (std::size_t i = 0; i < study.rows.size(); ++i) study.rows[i].why = explain(study, i);
  study.head = fmt::format("{}, {} lengths, {} test", bit_rate_text(options.bit_rate),
                           options.lengths == Lengths::exact ? "exact" : "generic",
                           options.test == CanTest::exact ? "exact" : "sufficient");
  if (options.error_burst > 0)
    study.head += options.error_every > 0 ? fmt::format(", {} errors at once and one more every {}",
                                                        options.error_burst, time_text(options.error_every))
                                          : fmt::format(", {} errors at most", options.error_burst);
  study.remarks = set.remarks;
  return study;
}

Advice advise_bus(const BusSet& set, const BusOptions& options, const Study& study) {
  Advice advice;
  Trial trial{model_of(set, options), options.test};
  auto& messages = trial.model().messages;
  const bool passes = study.passes();
  if (messages.size() <= most_rooms) {
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
      messages.size() <= most_rooms) {
    BusModel model = trial.model();
    for (std::size_t i = 0; i < model.messages.size(); ++i)
      model.messages[i].key = static_cast<std::uint32_t>(i);
    if (analysis::assign_priorities<most_messages>(model.messages, model.bus, trial.analysis()) ==
        analysis::nobody) {
      std::string order;
      for (const Message& message : model.messages)
        order += (order.empty() ? "" : ", ") + set.entries[message.key].name;
      advice.changes.push_back("identifiers in this order: " + order);
    }
  }
  return advice;
}

}  // namespace ocm::cli::analyse
