/// Whether one more stream fits on a CAN bus, and if not, who would be late and how often it could be sent
/// instead. The question behind admission, for the operator's tool and other programs that know what runs.
///
///     BusCheck<512> check{{.bit = 2'000}};          // ns: 500 kbit/s
///     check.runs(message);                          // each frame that is on the bus already
///     check.asks(message);                          // each frame of the stream that is asked for
///     const Decision d = check.decide(1'000'000);   // sent every millisecond
///     if (!d.admitted) check.shortest(1'000'000, 1'000, limit);  // ... what would do
///
/// A frame must be gone before the next one of its kind comes, or by its own deadline if that is earlier.
/// What is late already without the new stream is not held against it.
///
/// Cost: `decide` is one analysis (can_response.hpp) of all messages, two if a running one is late;
/// `shortest` some 2 log2(limit / step) of them. No heap; 250 bytes a message, in the object. Constexpr.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/analysis/can_response.hpp"
#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/message_set.hpp"
#include "ocm/analysis/verdict.hpp"
#include "ocm/base/fixed_vector.hpp"
#include "ocm/base/result.hpp"

namespace ocm::analysis {

struct Decision {
  bool admitted = false;
  std::size_t late = no_index;  ///< in BusCheck::messages(): the most urgent that would be; no_index: none
  Explained why{};              ///< of that one
};

template <std::size_t N>
class BusCheck {
 public:
  constexpr explicit BusCheck(const CanBus& bus, CanTest test = CanTest::exact, Limits limits = {}) noexcept
      : bus_(bus), test_(test), limits_(limits) {}

  /// On the bus now. Of one key that comes twice the more frequent counts. full: more than N.
  constexpr base::Status runs(const Message& message) noexcept { return put(running_, message); }
  /// Of the stream that is asked for: period and, where the period is shorter, deadline come with the
  /// question. It takes the place of a running one with its key.
  constexpr base::Status asks(const Message& message) noexcept { return put(asked_, message); }
  constexpr void clear() noexcept {
    running_.clear();
    asked_.clear();
  }

  /// With the stream sent every `period` ticks, at least 1.
  constexpr Decision decide(std::int64_t period) noexcept {
    if (period < 1 || !collect(period)) return {};  // or more than N: not known
    const auto results = analysis_.analyse(messages(), bus_, test_, limits_);
    std::size_t late = no_index;
    bool running_late = false;
    for (std::size_t i = 0; i < results.size() && late == no_index; ++i) {
      if (results[i].ok()) continue;
      if (is_asked(set_[i].key))
        late = i;
      else
        running_late = true;
    }
    if (late == no_index && !running_late) return {.admitted = true};
    if (!running_late) return {false, late, results[late]};
    return blame(period);
  }

  /// The shortest period that is admitted, in whole `step`s, above `refused`, which is not, and up to
  /// `limit`; 0: none is. (A longer period never makes another one later.)
  constexpr std::int64_t shortest(std::int64_t refused, std::int64_t step, std::int64_t limit) noexcept {
    std::int64_t low = refused / step;
    const std::int64_t end = limit / step;
    std::int64_t high = low;
    for (std::int64_t stride = 1;; stride *= 2) {
      if (high >= end) return 0;
      high = std::min(low + stride, end);
      if (decide(high * step).admitted) break;
      low = high;
    }
    while (high - low > 1) {
      const std::int64_t middle = low + (high - low) / 2;
      (decide(middle * step).admitted ? high : low) = middle;
    }
    return high * step;
  }

  /// What the last decision was about, in the order of arbitration.
  [[nodiscard]] constexpr std::span<const Message> messages() const noexcept {
    return {set_.begin(), set_.size()};
  }
  /// The results behind the last decision, as `messages`.
  [[nodiscard]] constexpr std::span<const Explained> explain(std::int64_t period) noexcept {
    static_cast<void>(collect(period));
    return analysis_.analyse(messages(), bus_, test_, limits_);
  }
  /// A message with this key is of the stream that is asked for.
  [[nodiscard]] constexpr bool is_asked(std::uint32_t key) const noexcept { return find(asked_, key) < N; }

 private:
  using Set = base::FixedVector<Message, N>;

  static constexpr std::size_t find(const Set& set, std::uint32_t key) noexcept {
    for (std::size_t i = 0; i < set.size(); ++i)
      if (set[i].key == key) return i;
    return N;
  }
  static constexpr base::Status put(Set& set, const Message& message) noexcept {
    const std::size_t place = find(set, message.key);
    if (place == N) return set.push_back(message);
    if (message.period < set[place].period) set[place] = message;
    return {};
  }

  static constexpr Message due_within_period(Message message) noexcept {
    message.deadline = std::min(message.due(), message.period);
    return message;
  }
  /// period 0: without the stream.
  constexpr bool collect(std::int64_t period) noexcept {
    set_.clear();
    bool fits = true;
    for (const Message& message : running_)
      if (period == 0 || !is_asked(message.key)) fits = add(message) && fits;
    for (std::size_t i = 0; i < asked_.size() && period != 0; ++i) {
      Message message = asked_[i];
      message.period = period;
      fits = add(message) && fits;
    }
    sort_by_key({set_.begin(), set_.size()});
    return fits;
  }
  constexpr bool add(const Message& message) noexcept {
    return set_.push_back(due_within_period(message)).ok();
  }

  /// A stream that runs is late: would it be without the new one?
  constexpr Decision blame(std::int64_t period) noexcept {
    static_cast<void>(collect(0));
    late_before_.clear();
    const auto before = analysis_.analyse(messages(), bus_, test_, limits_);
    for (std::size_t i = 0; i < before.size(); ++i)
      if (!before[i].ok()) static_cast<void>(late_before_.push_back(set_[i].key));
    const auto after = explain(period);
    for (std::size_t i = 0; i < after.size(); ++i) {
      if (after[i].ok()) continue;
      const std::uint32_t key = set_[i].key;
      if (is_asked(key) || std::find(late_before_.begin(), late_before_.end(), key) == late_before_.end())
        return {false, i, after[i]};
    }
    return {.admitted = true};
  }

  CanBus bus_;
  CanTest test_;
  Limits limits_;
  Set running_;
  Set asked_;
  Set set_;
  base::FixedVector<std::uint32_t, N> late_before_;
  CanResponse<N> analysis_;
};

}  // namespace ocm::analysis
