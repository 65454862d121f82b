/// Whether an operator is always in time: each configuration and each change between two of them fits on the
/// bus, and how long it takes at most from an event to the frame that acts.
///
///     Proof<256> proof{guard, 500'000};
///     proof.check([](const Doubt& doubt) { ... });      // nothing reported: it is in time
///     proof.latency(transition, from).total();          // and by when it acts
///
/// Mode change. All frames of a change are handed over at once: set points, stops, requests. Old and new
/// streams overlap then, as in an asynchronous protocol without periodicity of the change itself [Real,
/// Crespo 2004, "Mode change protocols for real-time systems: a survey and a new proposal", Real-Time Systems
/// 26(2), section 3; Tindell, Burns, Wellings 1992, "Mode changes in priority pre-emptively scheduled
/// systems", RTSS]. An old stream releases until its stop is taken, a new one as soon as its request is. Both
/// at full rate together are more than any overlap, so their union is what is analysed: coarser than the
/// analysis of Tindell et al., which knows when the change begins, and always safe. A stream that changes its
/// period is there once, at the shorter one, and once as one frame a change: its grid begins again. A change
/// must be over before the next one begins: `settle` is compared with
///
///     L = reaction + busy period of all the operator's frames + handling + longest R of the old streams
///
/// Latency, from the event, or if later from `settle` after its configuration was entered:
///
///     field                  T + J + S + (R - J - S) + reaction
///     age, gap               S + (R - J - S) + reaction + limit + reaction, from the last sample on
///     rate                   S + (R - J - S) + reaction + 2 windows + reaction
///     bus load               2 windows + reaction;   bus state: reaction;   refusals: R + reaction
///     `lasting`, if any      + lasting + reaction
///     the set points         + busy period of what the operator's queue can hold before them
///
/// Of a monitor the latest of its conditions counts. R is the exact response time of the topic's last frame
/// (analysis/can_response.hpp), of which J + S is jitter: a frame is handed over as late as the sample is
/// [Tindell, Clark 1994, "Holistic schedulability analysis for distributed hard real-time systems",
/// Microprocessing and Microprogramming 40]. An event in the first `settle` of a configuration acts by
/// `settle` later.
///
/// Recovery of a stream, from when a board that has lost its streams takes requests again (or `settle` after
/// the entry of a configuration, if that is later; it is not left until then):
///
///     the longer of          3 T + S + (R - J - S) + reaction, since its last sample was read, and retry,
///                            since a request that was lost
///     the request            + reaction + busy period of all the operator's frames + handling
///     its first sample       + R, without its own request, if the next one is later
///
/// A request that is made after the board's return arrives; so the last sample and the last lost request are
/// not later than that. In the first `settle` of a configuration no stream is late (`check`), so that what
/// its entry asks for comes within a period of the end of that.
///
/// Assumed: a board begins a sample at the release, which is J late at most, reads the value at any time from
/// then on, and hands its frames over S later at most, in the order of the samples: `Sampling`, what the
/// caller's analysis of the boards' processors says, 0 where it says nothing. It begins a stream when it
/// takes the request; the operator's frames leave in their order; of what is not in the tables, `others` is
/// all there is; clocks of one speed; no frame is lost (a lost one costs a period, or for a request `retry`).
/// For set points that actuate later than their frame ends, the board's time comes on top.
///
/// Pure, constexpr, no heap; 400 bytes a message, N messages. O(messages^2) an analysis.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "ocm/analysis/can_response.hpp"
#include "ocm/analysis/checked.hpp"
#include "ocm/analysis/message_set.hpp"
#include "ocm/base/fixed_vector.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/reflective/check.hpp"
#include "ocm/reflective/latency.hpp"
#include "ocm/reflective/operator.hpp"

namespace ocm::reflective {

/// What a sample of a topic takes on its board at most, in a configuration, or in a change to it: response
/// time of the task that takes it, from its release to the hand-over of its last frame.
struct Sampling {
  std::uint16_t from = none;  ///< the change from there; none: the configuration itself, and a start in it
  std::uint16_t configuration = none;
  std::uint16_t topic = none;
  std::int64_t time = 0;  ///< ns, at least 0; analysis::unbounded: its board cannot serve it
};

/// Why an operator may not be in time.
struct Doubt {
  enum class Kind : std::uint8_t {
    too_many,   ///< messages for the Proof: nothing is known
    late,       ///< a stream misses its deadline: `topic`, `why`
    unsettled,  ///< a change takes longer than `settle`: `needs`
    /// A healthy stream reaches the limit of an age or a gap, or the three periods after which its values
    /// count no more: `condition`. Must be above `needs`.
    restless,
  };
  Kind kind = Kind::too_many;
  std::uint16_t from = none;  ///< the change from there; none: the configuration itself, or the start
  std::uint16_t configuration = none;
  std::uint16_t topic = none;  ///< late; none: one of `others`
  std::uint16_t condition = none;
  analysis::Explained why{};
  std::int64_t sampling = 0;  ///< late: on its board, part of it; unbounded: its board cannot serve it
  std::int64_t needs = 0;
};

template <std::size_t N>
class Proof {
 public:
  /// The tables must outlive it and be without mistakes; the bit rate is at least 1. Of `sampling` the
  /// longest of a topic counts; what is not in it takes no time.
  constexpr Proof(const Operator& tables, std::uint32_t bit_rate, std::span<const Sampling> sampling = {},
                  analysis::ErrorModel errors = {}) noexcept
      : op_(&tables),
        bit_rate_(bit_rate),
        sampling_(sampling),
        bus_{analysis::bits_ns(1, bit_rate), errors} {}

  /// Calls report(Doubt) for whatever cannot be shown to be in time.
  template <class Report>
  constexpr void check(Report&& report) noexcept {
    const auto count = static_cast<std::uint16_t>(op_->configurations.size());
    for (std::uint16_t c = 0; c < count; ++c) {
      if (!set(none, c, false)) return report(Doubt{.configuration = c});
      late(none, c, report);
      restless(c, report);
    }
    change(none, op_->initial, report);
    for (std::uint16_t from = 0; from < count; ++from)
      for (std::uint16_t to = 0; to < count; ++to)
        if (leads(from, to)) change(from, to, report);
  }

  /// How long a change takes, L above; `from` none: the start.
  [[nodiscard]] constexpr std::int64_t settling(std::uint16_t from, std::uint16_t to) noexcept {
    if (!set(from, to, true)) return analysis::unbounded;
    const auto results = solve();
    analysis::Checked sum = analysis::Checked{op_->reaction.count()} + op_->handling.count();
    sum += busy([](const Item& item) { return item.kind == Item::Kind::command; });
    std::int64_t oldest = 0;
    for (std::size_t i = 0; i < items_.size(); ++i)
      if (items_[i].kind == Item::Kind::stream && items_[i].old)
        oldest = std::max(oldest, response_of(items_[i], results[i]));
    sum += oldest;
    return oldest == analysis::unbounded ? oldest : sum.value_or(analysis::unbounded);
  }

  /// By when a transition acts, from a configuration that it leaves. Not bounded: that configuration does not
  /// stream what the monitor needs, or no bound exists. Of a request: from the step that gets it. `only`:
  /// when it is this condition of the monitor that changes last, and not the latest of all.
  [[nodiscard]] constexpr Latency latency(std::size_t transition, std::uint16_t from,
                                          std::uint16_t only = none) noexcept {
    const Transition& t = op_->transitions[transition];
    Latency latest;
    if (!op_->leaves(t, from)) return latest;
    const std::int64_t command = acting(from, t.to);
    if (command == analysis::unbounded) return latest;
    if (t.monitor == by_request) {
      latest.bounded = true;
      latest.reading = op_->reaction.count();
    } else {
      const Monitor& monitor = op_->monitors[t.monitor];
      if (!sees(*op_, from, monitor) || !set(none, from, false)) return latest;
      const auto results = solve();
      for (const Term& term : monitor.terms) {
        if (term.op != Op::condition || (only != none && term.condition != only)) continue;
        const Latency one = detect(from, term.condition, results);
        if (!one.bounded) return {};
        if (!latest.bounded || one.total() > latest.total()) latest = one;
      }
      latest.lasting = monitor.lasting.count();
      if (latest.lasting > 0) latest.timer += op_->reaction.count();
    }
    latest.command = command;
    latest.settle = op_->settle.count();
    return latest;
  }

  /// By when a stream is back on the bus after its board was reset. Not bounded: `retry` is 0, the topic is
  /// no stream that can be asked for, or no bound exists.
  [[nodiscard]] constexpr Recovery recovery(std::uint16_t configuration, std::uint16_t topic) noexcept {
    Recovery found;
    Latency sample;
    if (op_->retry.count() <= 0 || op_->topic(topic).is_message() || !set(none, configuration, false))
      return found;
    found.request = busy([](const Item& item) { return item.kind == Item::Kind::command; });
    if (!on_bus(topic, solve(), sample) || found.request == analysis::unbounded) return found;
    // Its own next request, and the grid that this begins, are later than the samples in question, if each is
    // gone by then; unless its period follows a value.
    const analysis::Checked gone = analysis::Checked{op_->reaction.count()} + found.request +
                                   op_->handling.count() + sample.jitter + sample.sampling + sample.bus;
    if (!is_adapted(configuration, topic) && gone <= op_->retry.count()) {
      erase_own(topic);
      if (!on_bus(topic, solve(), sample)) return found;
    }
    found.bounded = true;
    found.jitter = sample.jitter;
    found.sampling = sample.sampling;
    found.bus = sample.bus;
    const analysis::Checked silence = analysis::Checked{stale_periods} * period_of(configuration, topic);
    const analysis::Checked last = analysis::Checked{sample.sampling} + sample.bus + op_->reaction.count();
    if (silence + last < op_->retry.count()) {
      found.retry = op_->retry.count();
    } else {
      found.silence = silence.value_or(analysis::unbounded);
      found.last = last.value_or(analysis::unbounded);
    }
    found.timer = op_->reaction.count();
    found.handling = op_->handling.count();
    found.settle = op_->settle.count();
    return found;
  }

  /// What the last analysis was of, for those who want to show it: messages in the order of arbitration.
  [[nodiscard]] constexpr std::span<const analysis::Message> messages() const noexcept {
    return {messages_.begin(), messages_.size()};
  }
  /// The load of a configuration, per mille, with all that the operator may send in it.
  [[nodiscard]] constexpr std::int64_t load(std::uint16_t configuration) noexcept {
    return set(none, configuration, false) ? load_of_all() : analysis::unbounded;
  }
  /// Of a change, as if old and new streams ran for all of it; `from` none: the start.
  [[nodiscard]] constexpr std::int64_t load(std::uint16_t from, std::uint16_t to) noexcept {
    return set(from, to, true) ? load_of_all() : analysis::unbounded;
  }
  /// From the planned release of a topic's sample to the end of its last frame, at most; unbounded: no bound,
  /// or no stream of the configuration.
  [[nodiscard]] constexpr std::int64_t response(std::uint16_t configuration, std::uint16_t topic) noexcept {
    Latency found;
    if (!set(none, configuration, false) || !on_bus(topic, solve(), found)) return analysis::unbounded;
    return found.jitter + found.sampling + found.bus;
  }

 private:
  struct Item {
    enum class Kind : std::uint8_t { stream, again, command, refusal, other };
    analysis::Message message{};
    Kind kind = Kind::other;
    std::uint16_t topic = none;
    bool old =
        false;  ///< stream: is not wanted any more, or changes. command: of the configuration that is left
    bool entry = false;         ///< command: of the set points of the change
    std::int64_t sampling = 0;  ///< stream: part of the message's jitter, if it is bounded
  };

  [[nodiscard]] constexpr bool leads(std::uint16_t from, std::uint16_t to) const noexcept {
    for (const Transition& t : op_->transitions)
      if (t.to == to && op_->leaves(t, from)) return true;
    return false;
  }

  [[nodiscard]] constexpr std::int64_t load_of_all() const noexcept {
    analysis::Checked sum;
    // In parts of 2^20 of a per mille, rounded up.
    for (const Item& item : items_)
      sum += analysis::ceil_div(analysis::Checked{item.message.cost} * (1000LL << 20U), item.message.period);
    return analysis::ceil_div(sum, 1LL << 20U).value_or(analysis::unbounded);
  }

  // --- what is on the bus ---

  /// Collects a configuration, or the change to it. false: more than N.
  constexpr bool set(std::uint16_t from, std::uint16_t to, bool changes) noexcept {
    items_.clear();
    room_ = true;
    from_ = from;
    to_ = to;
    const Configuration& target = op_->configurations[to];
    const Configuration* const source = from == none ? nullptr : &op_->configurations[from];
    for (const analysis::Message& other : op_->others) add({.message = other});
    for (const analysis::Message& other : target.others) add({.message = other});
    if (source != nullptr)
      for (const analysis::Message& other : source->others)
        if (std::find(target.others.begin(), target.others.end(), other) == target.others.end())
          add({.message = other});
    for (std::size_t s = 0; s < target.streams.size(); ++s) stream(target, s, source);
    commands(target, source == nullptr && !changes);
    if (source != nullptr) {
      for (std::size_t s = 0; s < source->streams.size(); ++s) old_stream(*source, s, target);
      commands(*source, true);
    }
    if (changes) burst(target, source);
    // In the order of arbitration; of one key the frames that come now and then first, so that the stream
    // itself, the last, is delayed by all of them.
    for (std::size_t i = 1; i < items_.size(); ++i)
      for (std::size_t k = i; k > 0 && goes_before(items_[k], items_[k - 1]); --k)
        std::swap(items_[k], items_[k - 1]);
    collect_messages();
    return room_;
  }
  /// Leaves out what the operator asks for this topic, and the frames of a grid that begins again.
  constexpr void erase_own(std::uint16_t topic) noexcept {
    for (std::size_t i = items_.size(); i-- > 0;)
      if (items_[i].topic == topic &&
          (items_[i].kind == Item::Kind::again || items_[i].kind == Item::Kind::command))
        items_.erase(i);
    collect_messages();
  }
  constexpr void collect_messages() noexcept {
    messages_.clear();
    for (const Item& item : items_) room_ = messages_.push_back(item.message).ok() && room_;
  }
  static constexpr bool goes_before(const Item& a, const Item& b) noexcept {
    if (a.message.key != b.message.key) return a.message.key < b.message.key;
    return a.kind != Item::Kind::stream && b.kind == Item::Kind::stream;
  }
  constexpr void add(const Item& item) noexcept { room_ = items_.push_back(item).ok() && room_; }

  [[nodiscard]] static constexpr const Stream* same_topic(const Configuration& configuration,
                                                          const Stream& stream) noexcept {
    for (const Stream& other : configuration.streams)
      if (other.topic == stream.topic) return &other;
    return nullptr;
  }
  /// The same topic at the same priority: frames of one identifier.
  [[nodiscard]] static constexpr const Stream* same_stream(const Configuration& configuration,
                                                           const Stream& stream) noexcept {
    const Stream* const same = same_topic(configuration, stream);
    return same != nullptr && same->priority == stream.priority ? same : nullptr;
  }
  /// The source has that stream, but at another period, or one that may have been adapted.
  [[nodiscard]] static constexpr bool changes_period(const Configuration& source, const Configuration& target,
                                                     std::size_t s) noexcept {
    const Stream* const before = same_stream(source, target.streams[s]);
    if (before == nullptr) return false;
    const auto index = static_cast<std::size_t>(before - source.streams.data());
    return before->period != target.streams[s].period || adaptation_of(source, index) != nullptr;
  }
  [[nodiscard]] static constexpr const Adaptation* adaptation_of(const Configuration& configuration,
                                                                 std::size_t s) noexcept {
    for (const Adaptation& adaptation : configuration.adaptations)
      if (adaptation.stream == s) return &adaptation;
    return nullptr;
  }
  [[nodiscard]] static constexpr base::Duration shortest(const Configuration& configuration,
                                                         std::size_t s) noexcept {
    const Adaptation* const adaptation = adaptation_of(configuration, s);
    return adaptation == nullptr ? configuration.streams[s].period : adaptation->shortest();
  }
  [[nodiscard]] static constexpr base::Duration longest(const Configuration& configuration,
                                                        std::size_t s) noexcept {
    const Adaptation* const adaptation = adaptation_of(configuration, s);
    return adaptation == nullptr ? configuration.streams[s].period : adaptation->longest();
  }

  [[nodiscard]] constexpr bool is_adapted(std::uint16_t configuration, std::uint16_t topic) const noexcept {
    const Configuration& c = op_->configurations[configuration];
    for (const Adaptation& adaptation : c.adaptations)
      if (c.streams[adaptation.stream].topic == topic) return true;
    return false;
  }

  constexpr void stream(const Configuration& target, std::size_t s, const Configuration* source) noexcept {
    const Stream& stream = target.streams[s];
    base::Duration period = shortest(target, s);
    base::Duration again = op_->retry;  // its grid may begin again so often; 0: never
    const auto more_often = [&](base::Duration every) {
      again = again.count() == 0 ? every : std::min(again, every);
    };
    if (const Adaptation* adaptation = adaptation_of(target, s)) more_often(adaptation->every);
    const bool old = source != nullptr && changes_period(*source, target, s);
    if (const Stream* before = source == nullptr ? nullptr : same_stream(*source, stream)) {
      const auto index = static_cast<std::size_t>(before - source->streams.data());
      period = std::min(period, shortest(*source, index));
      if (const Adaptation* adaptation = adaptation_of(*source, index)) more_often(adaptation->every);
    }
    if (old) more_often(op_->settle);
    frames(stream, period, again, old);
  }
  /// What the change ends: all but what the new configuration has, too, at the same priority.
  constexpr void old_stream(const Configuration& source, std::size_t s,
                            const Configuration& target) noexcept {
    const Stream& stream = source.streams[s];
    if (same_stream(target, stream) != nullptr) return;
    base::Duration again = op_->retry;
    if (const Adaptation* adaptation = adaptation_of(source, s))
      again = again.count() == 0 ? adaptation->every : std::min(again, adaptation->every);
    frames(stream, shortest(source, s), again, true);
  }
  constexpr void frames(const Stream& stream, base::Duration period, base::Duration again,
                        bool old) noexcept {
    const protocol::Topic& topic = op_->topic(stream.topic);
    for (const protocol::FrameLayout& layout : topic.frames) {
      analysis::Message message = analysis::message_of(layout, protocol::Direction::sensor, stream.priority,
                                                       period, topic.deadline, topic.jitter, bit_rate_);
      if (topic.is_message())
        message.key =
            can::arbitration_key({.id = layout.address.number, .format = protocol::format_of(layout)});
      message.deadline = std::min(message.due(), message.period);
      const std::int64_t sampling = sampling_of(stream.topic);
      if (sampling != analysis::unbounded)
        message.jitter = (analysis::Checked{message.jitter} + sampling).value_or(analysis::unbounded);
      add({.message = message,
           .kind = Item::Kind::stream,
           .topic = stream.topic,
           .old = old,
           .sampling = sampling});
      if (again.count() == 0 || topic.is_message()) continue;
      message.period = again.count();
      message.jitter = op_->settle.count();
      message.deadline = analysis::unbounded;
      add({.message = message, .kind = Item::Kind::again, .topic = stream.topic});
    }
  }

  /// On its board, in the configuration or change that is being collected.
  [[nodiscard]] constexpr std::int64_t sampling_of(std::uint16_t topic) const noexcept {
    std::int64_t longest = 0;
    for (const Sampling& each : sampling_)
      if (each.from == from_ && each.configuration == to_ && each.topic == topic)
        longest = std::max(longest, each.time);
    return longest;
  }
  /// From the planned release on. What its board cannot serve delays nothing on the bus, and has no bound.
  [[nodiscard]] static constexpr std::int64_t response_of(const Item& item,
                                                          const analysis::Explained& result) noexcept {
    return item.sampling == analysis::unbounded ? analysis::unbounded : result.response;
  }

  /// What the operator may send in a configuration at any time.
  constexpr void commands(const Configuration& configuration, bool old) noexcept {
    for (std::size_t s = 0; s < configuration.streams.size(); ++s) {
      const Stream& stream = configuration.streams[s];
      if (op_->retry.count() > 0) request(stream, publish_dlc, op_->retry, old);
      if (const Adaptation* adaptation = adaptation_of(configuration, s))
        request(stream, publish_dlc, adaptation->every, old);
    }
    for (const SetPoint& entry : configuration.entry)
      if (entry.repeat.count() > 0) set_point(entry, entry.repeat, old, false);
  }
  /// What it sends to enter one.
  constexpr void burst(const Configuration& target, const Configuration* source) noexcept {
    for (const SetPoint& entry : target.entry) set_point(entry, op_->settle, false, true);
    if (source != nullptr)
      for (const Stream& stream : source->streams)
        if (same_topic(target, stream) == nullptr) request(stream, stop_dlc, op_->settle, false);
    if (source == nullptr)
      for_each_stream_elsewhere(
          *op_, to_, [this](const Stream& stream) { request(stream, stop_dlc, op_->settle, false); });
    for (std::size_t s = 0; s < target.streams.size(); ++s)
      if (source == nullptr || same_stream(*source, target.streams[s]) == nullptr ||
          changes_period(*source, target, s))
        request(target.streams[s], publish_dlc, op_->settle, false);
  }
  static constexpr std::uint8_t publish_dlc = 4;
  static constexpr std::uint8_t stop_dlc = 1;

  constexpr void request(const Stream& stream, std::uint8_t dlc, base::Duration every, bool old) noexcept {
    const protocol::Topic& topic = op_->topic(stream.topic);
    if (topic.is_message()) return;
    const unsigned bits = can::worst_frame_bits(can::Format::base, dlc);
    const auto id = protocol::Identifier{protocol::Direction::command, stream.priority, topic.id}.encode();
    command(topic, bits, id, every, old, false);
  }
  constexpr void set_point(const SetPoint& entry, base::Duration every, bool old, bool of_change) noexcept {
    const protocol::Topic& topic = op_->topic(entry.topic);
    const protocol::FrameLayout& layout = topic.frames[0];
    const auto id = protocol::Identifier{protocol::Direction::command, entry.priority, layout.id}.encode();
    command(topic, protocol::worst_bits(layout, entry.priority), id, every, old, of_change);
  }
  constexpr void command(const protocol::Topic& topic, unsigned bits, std::uint32_t id, base::Duration every,
                         bool old, bool of_change) noexcept {
    analysis::Message message;
    message.cost = analysis::bits_ns(bits, bit_rate_);
    message.period = every.count();
    message.jitter = op_->reaction.count();
    message.deadline = analysis::unbounded;
    message.key = can::arbitration_key({.id = id});
    add({.message = message,
         .kind = Item::Kind::command,
         .topic = index_of(topic),
         .old = old,
         .entry = of_change});
    // Each can be refused.
    for (const protocol::Topic& other : op_->catalogue->topics) {
      if (other.role != protocol::Role::refusal || other.board != topic.board) continue;
      for (const protocol::FrameLayout& layout : other.frames) {
        message = analysis::message_of(layout, protocol::Direction::sensor, other.priority, every, {},
                                       op_->settle, bit_rate_);
        message.deadline = analysis::unbounded;
        add({.message = message, .kind = Item::Kind::refusal, .topic = index_of(other)});
      }
    }
  }
  [[nodiscard]] constexpr std::uint16_t index_of(const protocol::Topic& topic) const noexcept {
    return static_cast<std::uint16_t>(&topic - op_->catalogue->topics.data());
  }

  // --- how long it takes ---

  constexpr std::span<const analysis::Explained> solve() noexcept {
    return analysis_.analyse(messages(), bus_);
  }

  /// The longest time in which the frames that `counts` picks are sent, in whatever order, with all that goes
  /// before the least urgent of them: t = E(t) + B + sum of ceil((t + J) / T) C.
  template <class Counts>
  [[nodiscard]] constexpr std::int64_t busy(Counts&& counts) const noexcept {
    std::uint32_t level = 0;
    bool any = false;
    for (const Item& item : items_) {
      if (!counts(item)) continue;
      level = std::max(level, item.message.key);
      any = true;
    }
    if (!any) return 0;
    const auto takes_part = [&](const Item& item) {
      return counts(item) || (item.kind != Item::Kind::command && item.message.key <= level);
    };
    std::int64_t blocking = 0;
    std::int64_t longest_frame = 0;
    for (const Item& item : items_) {
      if (takes_part(item))
        longest_frame = std::max(longest_frame, item.message.cost);
      else if (item.kind != Item::Kind::command)
        blocking = std::max(blocking, item.message.cost);
    }
    analysis::Checked t = blocking + 1;
    for (int round = 0; round < 10'000; ++round) {
      analysis::Checked next = analysis::error_delay(bus_, longest_frame, t) + blocking;
      for (const Item& item : items_)
        if (takes_part(item))
          next += analysis::ceil_div(t + item.message.jitter, item.message.period) * item.message.cost;
      if (!next.ok()) break;
      if (next <= t) return next.value();
      t = next;
    }
    return analysis::unbounded;
  }

  /// Until the set points of a change have been sent, from their hand-over on: what is in the operator's
  /// queue before them is what it may send in the old configuration at any time.
  [[nodiscard]] constexpr std::int64_t acting(std::uint16_t from, std::uint16_t to) noexcept {
    if (op_->configurations[to].entry.empty()) return 0;
    if (!set(from, to, true)) return analysis::unbounded;
    return busy(
        [](const Item& item) { return item.kind == Item::Kind::command && (item.old || item.entry); });
  }

  [[nodiscard]] constexpr Latency detect(std::uint16_t configuration, std::uint16_t c,
                                         std::span<const analysis::Explained> results) const noexcept {
    const Condition& condition = op_->conditions[c];
    Latency found;
    found.condition = c;
    found.reading = op_->reaction.count();
    switch (condition.watched) {
      case Watched::field:
        found.bounded = on_bus(condition.topic, results, found);
        found.period = period_of(configuration, condition.topic);
        break;
      case Watched::age:
      case Watched::gap:
        found.bounded = on_bus(condition.topic, results, found);
        found.jitter = 0;  // a sample that was not taken at its event is no sample
        found.limit = condition.limit;
        found.timer = op_->reaction.count();
        break;
      case Watched::rate:
        found.bounded = on_bus(condition.topic, results, found);
        found.jitter = 0;
        found.window = 2 * condition.window.count();
        found.timer = op_->reaction.count();
        break;
      case Watched::refusals:
        found.bounded = true;
        for (std::size_t i = 0; i < items_.size(); ++i)
          if (items_[i].kind == Item::Kind::refusal) found.bus = std::max(found.bus, results[i].response);
        found.bounded = found.bus != analysis::unbounded;
        break;
      case Watched::bus_load:
        found.bounded = true;
        found.window = 2 * condition.window.count();
        break;
      case Watched::bus_state:
        found.bounded = true;
        break;
    }
    return found;
  }
  /// Jitter, sampling and response of a stream; false: no bound.
  constexpr bool on_bus(std::uint16_t topic, std::span<const analysis::Explained> results,
                        Latency& found) const noexcept {
    std::int64_t response = -1;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (items_[i].kind != Item::Kind::stream || items_[i].topic != topic) continue;
      response = std::max(response, response_of(items_[i], results[i]));
      found.sampling = items_[i].sampling;
      found.jitter = items_[i].message.jitter - found.sampling;
    }
    if (response < 0 || response == analysis::unbounded) return false;
    found.bus = response - found.jitter - found.sampling;
    return true;
  }
  [[nodiscard]] constexpr std::int64_t period_of(std::uint16_t configuration,
                                                 std::uint16_t topic) const noexcept {
    const Configuration& c = op_->configurations[configuration];
    for (std::size_t s = 0; s < c.streams.size(); ++s)
      if (c.streams[s].topic == topic) return longest(c, s).count();
    return 0;
  }

  [[nodiscard]] constexpr std::int64_t shortest_of(std::uint16_t configuration,
                                                   std::uint16_t topic) const noexcept {
    const Configuration& c = op_->configurations[configuration];
    for (std::size_t s = 0; s < c.streams.size(); ++s)
      if (c.streams[s].topic == topic) return shortest(c, s).count();
    return 0;
  }

  // --- doubts ---

  template <class Report>
  constexpr void change(std::uint16_t from, std::uint16_t to, Report& report) noexcept {
    if (!set(from, to, true)) return report(Doubt{.from = from, .configuration = to});
    late(from, to, report);
    const std::int64_t needs = settling(from, to);
    if (needs > op_->settle.count())
      report(Doubt{.kind = Doubt::Kind::unsettled, .from = from, .configuration = to, .needs = needs});
  }
  template <class Report>
  constexpr void late(std::uint16_t from, std::uint16_t to, Report& report) noexcept {
    const auto results = solve();
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const Item& item = items_[i];
      if (item.kind != Item::Kind::stream && item.kind != Item::Kind::other) continue;
      if (results[i].ok() && item.sampling != analysis::unbounded) continue;
      report(Doubt{.kind = Doubt::Kind::late,
                   .from = from,
                   .configuration = to,
                   .topic = item.topic,
                   .why = results[i],
                   .sampling = item.sampling});
    }
  }
  /// Ages and gaps that the longest distance of two samples reaches, or the time until the first.
  template <class Report>
  constexpr void restless(std::uint16_t configuration, Report& report) noexcept {
    const auto results = solve();
    for (std::uint16_t c = 0; c < op_->conditions.size(); ++c) {
      const Condition& condition = op_->conditions[c];
      const bool value = condition.watched == Watched::field;
      if (!value && condition.watched != Watched::age && condition.watched != Watched::gap) continue;
      Latency found;
      if (!on_bus(condition.topic, results, found)) continue;
      // A value need not have come when the configuration has settled; an age runs from its entry.
      const std::int64_t period = period_of(configuration, condition.topic);
      const std::int64_t distance = value ? period : std::max(period, op_->settle.count());
      const std::int64_t needs = distance + found.jitter + found.sampling + found.bus + op_->reaction.count();
      if ((value ? stale_periods * shortest_of(configuration, condition.topic) : condition.limit) <= needs)
        report(Doubt{.kind = Doubt::Kind::restless,
                     .configuration = configuration,
                     .topic = condition.topic,
                     .condition = c,
                     .needs = needs});
    }
  }

  const Operator* op_;
  std::uint32_t bit_rate_;
  std::span<const Sampling> sampling_;
  std::uint16_t from_ = none, to_ = none;  ///< what is collected
  analysis::CanBus bus_;
  bool room_ = true;
  base::FixedVector<Item, N> items_;
  base::FixedVector<analysis::Message, N> messages_;
  analysis::CanResponse<N> analysis_;
};

}  // namespace ocm::reflective
