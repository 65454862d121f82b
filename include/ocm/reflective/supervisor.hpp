/// Runs an operator's tables: watches, switches between configurations, asks for streams and asks again,
/// commands. Pure steps: an event and the time go in, actions come out; the caller has the bus and the clock.
///
///     Supervisor<Room{}> supervisor{guard};
///     send(supervisor.start(now));
///     for (;;) send(supervisor.step(wait_for_event(supervisor.next()), now));
///
/// Mode change, without waiting for idle time (asynchronous, with a union of old and new streams as its
/// bound: proof.hpp): set points of the new configuration first, then stops, then requests, all in the step
/// that decides. The next change begins `settle` later at the earliest, when the last one is over. A request
/// waits for that; of several the last one counts.
///
/// While it is held, monitors lead to the fall-back only, and requests anywhere: people work on the robot,
/// and it is guarded all the same. That takes transitions away and adds none, so that all bounds hold.
///
/// The order of a step: what the event says, then what time says, then at most one transition, then what is
/// due to be repeated, adapted or asked for again. Tables must be without mistakes (check.hpp).
///
/// No heap, no clock. O(conditions + terms + transitions + streams) a step. Not reentrant.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/fixed_vector.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/reflective/adaptation.hpp"
#include "ocm/reflective/limits.hpp"
#include "ocm/reflective/monitor.hpp"
#include "ocm/reflective/operator.hpp"

namespace ocm::reflective {

/// How large the tables of a supervisor may be.
struct Room {
  std::size_t conditions = 64;
  std::size_t monitors = 32;
  std::size_t streams = 32;  ///< of one configuration
  std::size_t entry = 16;
  std::size_t limits = 16;
  std::size_t adaptations = 8;
  /// Of one step: a switch, its set points, the stops of the old streams and the requests of the new ones.
  [[nodiscard]] constexpr std::size_t actions() const noexcept { return 2 + entry + 2 * streams; }
};

/// A stream that has been silent for so many periods is asked for again, and its last values count no more.
inline constexpr int stale_periods = 3;

struct Event {
  enum class Kind : std::uint8_t {
    tick,       ///< nothing but time
    sample,     ///< of `topic`: `bytes`
    refusal,    ///< a board has refused something
    bus_load,   ///< `value` per mille
    bus_state,  ///< `value`, a BusState
    request,    ///< a request for configuration `value`
  };
  Kind kind = Kind::tick;
  std::uint16_t topic = none;
  /// Of a topic: its frames, eight bytes each; of a message what came.
  std::span<const std::uint8_t> bytes{};
  std::int64_t value = 0;
  /// sample: since it was on the bus. An operator that did not run for a while does not take it for a new
  /// one.
  base::Duration age{};
};

struct Action {
  enum class Kind : std::uint8_t {
    switched,     ///< to configuration `to`; nothing to send
    command,      ///< a set point
    unsubscribe,  ///< a stream that is not needed any more
    subscribe,    ///< a stream that is new, or has another period
    again,        ///< a stream that should run, and is silent
    refused,      ///< nothing leads from here to the configuration that was asked for; nothing to send
  };
  Kind kind = Kind::switched;
  can::Frame frame{};  ///< to send, but for `switched` and `refused`
  std::uint16_t topic = none;
  base::Duration period{};    ///< subscribe, again
  std::uint16_t from = none;  ///< switched, refused; none: at the start
  std::uint16_t to = none;
  std::uint16_t transition = none;  ///< switched: which; none: at the start
  [[nodiscard]] constexpr bool sends() const noexcept {
    return kind != Kind::switched && kind != Kind::refused;
  }
};

/// What happened, since the start. They wrap.
struct SupervisorCounters {
  std::uint32_t switches = 0;
  std::uint32_t asked_again = 0;        ///< streams that were silent
  std::uint32_t adapted = 0;            ///< periods that followed a value
  std::uint32_t requests_refused = 0;   ///< nothing leads there
  std::uint32_t requests_replaced = 0;  ///< by a later one, before they could be met
  std::uint32_t requests_dropped = 0;   ///< another transition came before they could be met
  std::uint32_t limited = 0;            ///< values of set points that were changed
  std::uint32_t not_a_number = 0;       ///< values of watched fields
  friend constexpr bool operator==(const SupervisorCounters&, const SupervisorCounters&) = default;
};

template <Room room>
class Supervisor {
  static_assert(room.streams <= 64, "which streams go on is kept in 64 bits");

 public:
  using Actions = std::span<const Action>;

  /// The tables must outlive it, be without mistakes and fit (check.hpp: fits).
  constexpr explicit Supervisor(const Operator& tables) noexcept : tables_(&tables) {}

  /// Enters the initial configuration, and stops the streams of all others: a run before may have left them.
  constexpr Actions start(base::Time now) noexcept {
    actions_.clear();
    enter(tables_->initial, none, now, true);
    repeat_and_ask(now);
    return done(now);
  }

  constexpr Actions step(const Event& event, base::Time now) noexcept {
    actions_.clear();
    take(event, now);
    pass(now);
    if (now >= settled_) change(now);
    repeat_and_ask(now);
    return done(now);
  }

  /// When a step is due at the latest, with an event or without; never: none is.
  [[nodiscard]] constexpr base::Time next() const noexcept { return next_; }

  /// A set point of another program, as the configuration permits it. Returns how many values were changed.
  constexpr std::size_t permit(std::uint16_t topic, std::span<std::int64_t> raw, base::Time now) noexcept {
    before_ = limiter_;
    const std::size_t changed = limiter_.permit(topic, raw, now);
    counters_.limited += static_cast<std::uint32_t>(changed);
    return changed;
  }

  /// A set point that is sent as it is, such as rest, which no limit slows down: the next one starts from it.
  constexpr void commanded(std::uint16_t topic, std::span<const std::int64_t> raw, base::Time now) noexcept {
    before_ = limiter_;
    limiter_.commanded(topic, raw, now);
  }

  /// The set point of the last `permit` or `commanded` could not be sent: the next one does not start from
  /// it, or else a change in steps would go on unseen while the bus takes nothing. Before any other call.
  constexpr void not_sent() noexcept { limiter_ = before_; }

  /// From the next step on: make one, since `next()` is as before until then.
  constexpr void hold(bool held) noexcept { on_hold_ = held; }
  [[nodiscard]] constexpr bool on_hold() const noexcept { return on_hold_; }

  [[nodiscard]] constexpr std::uint16_t configuration() const noexcept { return current_; }
  [[nodiscard]] constexpr base::Time since() const noexcept { return entered_; }
  /// Why it is in this configuration: a transition; none: since the start.
  [[nodiscard]] constexpr std::uint16_t transition() const noexcept { return transition_; }
  [[nodiscard]] constexpr Truth condition(std::size_t index) const noexcept { return states_[index].truth; }
  /// What a condition was when this configuration was entered by a transition: why.
  [[nodiscard]] constexpr Truth held(std::size_t index) const noexcept { return held_[index]; }
  [[nodiscard]] constexpr Truth monitor(std::size_t index) const noexcept {
    return evaluate(tables_->monitors[index].terms, [this](std::size_t c) { return states_[c].truth; });
  }
  /// The period at which a stream of the configuration is asked for now.
  [[nodiscard]] constexpr base::Duration period(std::size_t stream) const noexcept {
    return streams_[stream].period;
  }
  /// When a stream of the configuration was heard last, or asked for if that is later.
  [[nodiscard]] constexpr base::Time heard(std::size_t stream) const noexcept {
    return streams_[stream].last;
  }
  /// A configuration that was asked for, and waits until the last change is over; none.
  [[nodiscard]] constexpr std::uint16_t requested() const noexcept { return requested_; }
  /// Whether a request leads from here to that configuration.
  [[nodiscard]] constexpr bool leads_to(std::uint16_t configuration) const noexcept {
    return configuration == current_ || leads(configuration);
  }
  [[nodiscard]] constexpr const SupervisorCounters& counters() const noexcept { return counters_; }

 private:
  struct ConditionState {
    Truth truth = Truth::unknown;
    bool late = false;       ///< gap: the last distance was one
    bool watching = false;   ///< field, age, gap, rate: its topic is streamed, or it needs none
    std::int64_t count = 0;  ///< rate: samples in this window
    base::Time last{};       ///< age, gap: of the last sample; rate: when the window began
  };
  struct StreamState {
    base::Duration period{};
    base::Time last{};  ///< sample, or when it was asked for
    base::Time asked{};
  };

  [[nodiscard]] constexpr const Configuration& here() const noexcept {
    return tables_->configurations[current_];
  }

  // --- events ---

  constexpr void take(const Event& event, base::Time now) noexcept {
    switch (event.kind) {
      case Event::Kind::tick:
        return;
      case Event::Kind::sample:
        return sample(event, now);
      case Event::Kind::refusal:
        ++refusals_;
        return set_all(Watched::refusals, refusals_);
      case Event::Kind::bus_load:
        return set_all(Watched::bus_load, event.value);
      case Event::Kind::bus_state:
        return set_all(Watched::bus_state, event.value);
      case Event::Kind::request:
        return request(event.value);
    }
  }

  constexpr void set_all(Watched watched, std::int64_t value) noexcept {
    for (std::size_t c = 0; c < tables_->conditions.size(); ++c)
      if (tables_->conditions[c].watched == watched) set(c, value);
  }
  constexpr void set(std::size_t c, std::int64_t value) noexcept {
    ConditionState& state = states_[c];
    state.truth = truth(holds(tables_->conditions[c], value, state.truth == Truth::yes));
  }

  constexpr void sample(const Event& event, base::Time now) noexcept {
    const auto streams = here().streams;
    const base::Time at = now - std::max(event.age, base::Duration{});
    for (std::size_t s = 0; s < streams.size(); ++s)
      if (streams[s].topic == event.topic) streams_[s].last = std::max(streams_[s].last, at);
    for (std::size_t c = 0; c < tables_->conditions.size(); ++c) {
      const Condition& condition = tables_->conditions[c];
      if (condition.topic != event.topic) continue;
      ConditionState& state = states_[c];
      if (condition.watched == Watched::field) {
        // A sample that another program has asked for would count, and never grow old.
        if (state.watching) take_field(c, event);
      } else if (condition.watched == Watched::age || condition.watched == Watched::gap) {
        if (!state.watching) continue;
        const base::Time later = std::max(state.last, at);
        state.late =
            condition.watched == Watched::gap && holds(condition, (later - state.last).count(), false);
        state.last = later;
      } else if (condition.watched == Watched::rate) {
        roll(c, now);
        ++state.count;
      }
    }
    for (std::size_t a = 0; a < here().adaptations.size(); ++a)
      if (here().adaptations[a].topic == event.topic) adapt(a, event);
  }

  /// The value of a field in a sample; false: the sample is without it, or it is not a number.
  constexpr bool read(const Event& event, std::uint16_t frame, std::uint16_t field_index, bool in_order,
                      std::int64_t& value) noexcept {
    const protocol::Topic& topic = tables_->topic(event.topic);
    const protocol::FrameLayout& layout = topic.frames[frame];
    const protocol::Field& field = layout.fields[field_index];
    const std::size_t first = topic.is_message() ? 0 : std::size_t{frame} * sizeof(can::Payload);
    if (event.bytes.size() < first) return false;
    auto bytes = event.bytes.subspan(first);
    if (!topic.is_message()) bytes = bytes.first(std::min<std::size_t>(bytes.size(), layout.length));
    if (!layout.has(field, bytes)) return false;
    can::Payload padded{};  // reading looks at eight bytes at least
    const std::int64_t raw = bytes.size() < padded.size()
                                 ? (std::copy(bytes.begin(), bytes.end(), padded.begin()), field.raw(padded))
                                 : field.raw(bytes);
    if (!is_number(field, raw)) {
      ++counters_.not_a_number;
      return false;
    }
    value = in_order ? ordered(field, raw) : raw;
    return true;
  }
  constexpr void take_field(std::size_t c, const Event& event) noexcept {
    const Condition& condition = tables_->conditions[c];
    std::int64_t value = 0;
    const bool in_order = condition.is == Is::above || condition.is == Is::below;
    if (read(event, condition.frame, condition.field, in_order, value))
      set(c, value);
    else
      states_[c].truth = Truth::unknown;
  }

  constexpr void request(std::int64_t configuration) noexcept {
    const bool known =
        configuration >= 0 && configuration < static_cast<std::int64_t>(tables_->configurations.size());
    if (known && configuration == current_) {
      if (requested_ != none) ++counters_.requests_replaced;
      requested_ = none;
      return;
    }
    if (!known || !leads(static_cast<std::uint16_t>(configuration))) {
      ++counters_.requests_refused;
      act({.kind = Action::Kind::refused,
           .from = current_,
           .to = known ? static_cast<std::uint16_t>(configuration) : none});
      return;
    }
    if (requested_ != none) ++counters_.requests_replaced;
    requested_ = static_cast<std::uint16_t>(configuration);
  }
  [[nodiscard]] constexpr bool leads(std::uint16_t configuration) const noexcept {
    for (const Transition& transition : tables_->transitions)
      if (transition.monitor == by_request && transition.to == configuration &&
          tables_->leaves(transition, current_))
        return true;
    return false;
  }

  // --- time ---

  /// Ends the windows that are over: the last whole one counts.
  constexpr void roll(std::size_t c, base::Time now) noexcept {
    const Condition& condition = tables_->conditions[c];
    ConditionState& state = states_[c];
    if (!state.watching || condition.window.count() < 1) return;
    const std::int64_t windows = (now - state.last) / condition.window;
    if (windows < 1) return;
    set(c, windows == 1 ? state.count : 0);
    state.count = 0;
    state.last += windows * condition.window;
  }

  constexpr void pass(base::Time now) noexcept {
    for (std::size_t c = 0; c < tables_->conditions.size(); ++c) {
      const Condition& condition = tables_->conditions[c];
      ConditionState& state = states_[c];
      if (condition.watched == Watched::rate) roll(c, now);
      if ((condition.watched == Watched::age || condition.watched == Watched::gap) && state.watching)
        state.truth = truth(state.late || holds(condition, (now - state.last).count(), false));
      if (condition.watched == Watched::field && is_stale(condition.topic, now)) state.truth = Truth::unknown;
    }
    for (std::size_t m = 0; m < tables_->monitors.size(); ++m) since_[m].take(monitor(m), now);
  }

  /// What was measured three periods ago says nothing any more. Of what is not streamed here it is not known.
  [[nodiscard]] constexpr bool is_stale(std::uint16_t topic, base::Time now) const noexcept {
    const std::uint16_t s = find(here().streams, topic);
    return s != none && now - streams_[s].last >= stale_periods * streams_[s].period;
  }

  // --- transitions ---

  constexpr void change(base::Time now) noexcept {
    std::size_t best = tables_->transitions.size();
    for (std::size_t t = 0; t < tables_->transitions.size(); ++t) {
      const Transition& transition = tables_->transitions[t];
      if (!tables_->leaves(transition, current_) || !fires(transition, now)) continue;
      if (best == tables_->transitions.size() || before(transition, tables_->transitions[best])) best = t;
    }
    if (best == tables_->transitions.size()) return;
    for (std::size_t c = 0; c < tables_->conditions.size(); ++c) held_[c] = states_[c].truth;
    enter(tables_->transitions[best].to, static_cast<std::uint16_t>(best), now, false);
  }
  /// By precedence; of one precedence what a monitor says goes before a request.
  static constexpr bool before(const Transition& a, const Transition& b) noexcept {
    if (a.precedence != b.precedence) return a.precedence < b.precedence;
    return a.monitor != by_request && b.monitor == by_request;
  }
  [[nodiscard]] constexpr bool fires(const Transition& transition, base::Time now) const noexcept {
    if (transition.monitor == by_request) return requested_ != none && requested_ == transition.to;
    if (held_back(transition)) return false;
    const auto at = since_[transition.monitor].fires_at(tables_->monitors[transition.monitor].lasting);
    return at != base::never && at <= now;
  }

  [[nodiscard]] constexpr bool held_back(const Transition& transition) const noexcept {
    return on_hold_ && transition.monitor != by_request && transition.to != tables_->fall_back;
  }

  constexpr void enter(std::uint16_t to, std::uint16_t transition, base::Time now, bool first) noexcept {
    const std::uint16_t from = first ? none : current_;
    const auto old_streams = first ? std::span<const Stream>{} : here().streams;
    const auto old_states = streams_;
    current_ = to;
    transition_ = transition;
    entered_ = now;
    settled_ = now + tables_->settle;
    if (requested_ != none && requested_ != to) ++counters_.requests_dropped;
    requested_ = none;
    refusals_ = 0;
    if (!first) ++counters_.switches;
    act({.kind = Action::Kind::switched, .from = from, .to = to, .transition = transition});

    limiter_.enter(here().limits);
    for (std::size_t i = 0; i < here().entry.size(); ++i) command(i, now);

    for (std::size_t s = 0; s < old_streams.size(); ++s)
      if (find(here().streams, old_streams[s].topic) == none) unsubscribe(old_streams[s]);
    // A run before that was killed has left its streams.
    if (first) for_each_stream_elsewhere(*tables_, to, [this](const Stream& stream) { unsubscribe(stream); });
    std::uint64_t go_on = 0;
    for (std::size_t s = 0; s < here().streams.size(); ++s) {
      const Stream& stream = here().streams[s];
      const std::uint16_t old = find(old_streams, stream.topic);
      const bool goes_on = old != none && old_streams[old].priority == stream.priority &&
                           old_states[old].period == stream.period;
      if (goes_on) go_on |= std::uint64_t{1} << s;
      streams_[s] = goes_on ? old_states[old] : StreamState{stream.period, now, now};
      if (!goes_on) subscribe(s, Action::Kind::subscribe);
    }
    for (Adapted& adapted : adapted_) adapted = {now, false};
    for (std::size_t c = 0; c < tables_->conditions.size(); ++c) begin(c, go_on, now);
    for (std::size_t m = 0; m < tables_->monitors.size(); ++m) since_[m].take(monitor(m), now);
  }

  /// What a condition knows when a configuration is entered: of a stream that goes on what it knew. So it is
  /// not forgotten that a stream is silent.
  constexpr void begin(std::size_t c, std::uint64_t go_on, base::Time now) noexcept {
    const Condition& condition = tables_->conditions[c];
    ConditionState& state = states_[c];
    if (condition.watched == Watched::refusals) return set(c, 0);
    if (condition.topic == none) return;
    const std::uint16_t stream = find(here().streams, condition.topic);
    const bool goes_on = stream != none && (go_on >> stream & 1U) != 0;
    if (!state.watching || !goes_on) state = {.watching = stream != none, .last = now};
  }
  static constexpr std::uint16_t find(std::span<const Stream> streams, std::uint16_t topic) noexcept {
    for (std::size_t s = 0; s < streams.size(); ++s)
      if (streams[s].topic == topic) return static_cast<std::uint16_t>(s);
    return none;
  }

  // --- actions ---

  constexpr void act(const Action& action) noexcept {
    // check.hpp: fits() proves that there is room.
    static_cast<void>(actions_.push_back(action));
  }
  constexpr void command(std::size_t entry, base::Time now) noexcept {
    const SetPoint& set_point = here().entry[entry];
    repeats_[entry] = set_point.repeat.count() > 0 ? now + set_point.repeat : base::never;
    limiter_.commanded(set_point.topic, set_point.raw, now);
    act({.kind = Action::Kind::command, .frame = frame_of(*tables_, set_point), .topic = set_point.topic});
  }
  constexpr void unsubscribe(const Stream& stream) noexcept {
    const protocol::Topic& topic = tables_->topic(stream.topic);
    if (topic.is_message()) return;
    act({.kind = Action::Kind::unsubscribe,
         .frame = protocol::stop(topic.id, stream.priority),
         .topic = stream.topic});
  }
  constexpr void subscribe(std::size_t s, typename Action::Kind kind) noexcept {
    const Stream& stream = here().streams[s];
    const protocol::Topic& topic = tables_->topic(stream.topic);
    if (topic.is_message()) return;
    const auto frame = protocol::publish_every(topic.id, streams_[s].period, stream.priority);
    act({.kind = kind, .frame = frame.value, .topic = stream.topic, .period = streams_[s].period});
  }

  /// What cannot be asked for yet, since the last one was asked for too short a time ago, is due later.
  constexpr void adapt(std::size_t a, const Event& event) noexcept {
    const Adaptation& adaptation = here().adaptations[a];
    std::int64_t value = 0;
    if (!read(event, adaptation.frame, adaptation.field, true, value)) return;
    adapted_[a].period = adapted_period(adaptation, value);
    adapted_[a].known = true;
  }

  constexpr void repeat_and_ask(base::Time now) noexcept {
    for (std::size_t i = 0; i < here().entry.size(); ++i)
      if (repeats_[i] <= now) command(i, now);
    for (std::size_t a = 0; a < here().adaptations.size(); ++a) {
      const Adaptation& adaptation = here().adaptations[a];
      StreamState& stream = streams_[adaptation.stream];
      if (!adapted_[a].known || stream.period == adapted_[a].period || now < adapts_at(a)) continue;
      stream.period = adapted_[a].period;
      stream.asked = now;
      adapted_[a].at = now;
      ++counters_.adapted;
      subscribe(adaptation.stream, Action::Kind::subscribe);
    }
    for (std::size_t s = 0; s < here().streams.size(); ++s) {
      if (now < again_at(s)) continue;
      streams_[s].asked = now;
      ++counters_.asked_again;
      subscribe(s, Action::Kind::again);
    }
  }
  [[nodiscard]] constexpr base::Time adapts_at(std::size_t a) const noexcept {
    return std::max(adapted_[a].at + here().adaptations[a].every, settled_);
  }
  /// Silent for so long that its values are stale, and not asked for within `retry`.
  [[nodiscard]] constexpr base::Time again_at(std::size_t s) const noexcept {
    const StreamState& stream = streams_[s];
    if (tables_->retry.count() <= 0 || tables_->topic(here().streams[s].topic).is_message())
      return base::never;
    return std::max({stream.last + stale_periods * stream.period, stream.asked + tables_->retry, settled_});
  }

  constexpr Actions done(base::Time now) noexcept {
    next_ = base::never;
    const auto due = [this](base::Time at) { next_ = std::min(next_, at); };
    for (std::size_t i = 0; i < here().entry.size(); ++i) due(repeats_[i]);
    for (std::size_t s = 0; s < here().streams.size(); ++s) due(again_at(s));
    for (std::size_t a = 0; a < here().adaptations.size(); ++a)
      if (adapted_[a].known && adapted_[a].period != streams_[here().adaptations[a].stream].period)
        due(adapts_at(a));
    for (std::size_t c = 0; c < tables_->conditions.size(); ++c) {
      const Condition& condition = tables_->conditions[c];
      const ConditionState& state = states_[c];
      if (!state.watching) continue;
      if (condition.watched == Watched::rate) due(state.last + condition.window);
      if ((condition.watched == Watched::age || condition.watched == Watched::gap) &&
          state.truth != Truth::yes)
        due(state.last + base::Duration{condition.limit});
    }
    for (const Transition& transition : tables_->transitions) {
      // What is held back is not due, or else it would be until it is let go.
      if (!tables_->leaves(transition, current_) || held_back(transition)) continue;
      if (transition.monitor == by_request) {
        if (requested_ != none && requested_ == transition.to) due(std::max(settled_, now));
        continue;
      }
      const auto at = since_[transition.monitor].fires_at(tables_->monitors[transition.monitor].lasting);
      if (at != base::never) due(std::max(at, settled_));
    }
    return {actions_.begin(), actions_.size()};
  }

 public:
  /// The frame of a set point.
  [[nodiscard]] static constexpr can::Frame frame_of(const Operator& tables,
                                                     const SetPoint& set_point) noexcept {
    const protocol::Topic& topic = tables.topic(set_point.topic);
    const protocol::FrameLayout& layout = topic.frames[0];
    can::Frame frame;
    frame.id = protocol::Identifier{protocol::Direction::command, set_point.priority, layout.id}.encode();
    frame.dlc = layout.dlc();
    for (std::size_t i = 0; i < layout.fields.size(); ++i)
      protocol::put(frame.data, layout.fields[i].position, i < set_point.raw.size() ? set_point.raw[i] : 0);
    return frame;
  }

 private:
  struct Adapted {
    base::Time at{};     ///< when the stream was asked for
    bool known = false;  ///< a value has come
    base::Duration period{};
  };

  const Operator* tables_;
  std::uint16_t current_ = none;
  std::uint16_t transition_ = none;
  std::uint16_t requested_ = none;
  bool on_hold_ = false;
  base::Time entered_{};
  base::Time settled_{};
  base::Time next_ = base::never;
  std::int64_t refusals_ = 0;
  std::array<ConditionState, room.conditions> states_{};
  std::array<Truth, room.conditions> held_{};
  std::array<Since, room.monitors> since_{};
  std::array<StreamState, room.streams> streams_{};
  std::array<base::Time, room.entry> repeats_{};
  std::array<Adapted, room.adaptations> adapted_{};
  Limiter<room.limits> limiter_;
  Limiter<room.limits> before_;  ///< the last set point of another program
  SupervisorCounters counters_;
  base::FixedVector<Action, room.actions()> actions_;
};

}  // namespace ocm::reflective
