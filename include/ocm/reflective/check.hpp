/// What is wrong with an operator's tables, whatever the bus carries: names that lead nowhere, limits outside
/// the spec, configurations that cannot be reached or left for the fall-back, transitions that can fire at
/// once. (Whether it is in time: proof.hpp.)
///
///     static_assert(first_mistake(guard).kind == Mistake::no_mistake);
///
/// Two transitions can fire at once if an assignment of true and false to their conditions makes both
/// monitors true and some values, with all hysteresis, allow that assignment. Conditions on different things
/// count as independent, more than 12 conditions as able to be true at once.
///
/// Pure, constexpr, no heap. O(tables), and 2^conditions for each such pair.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "ocm/protocol/request.hpp"
#include "ocm/reflective/monitor.hpp"
#include "ocm/reflective/operator.hpp"
#include "ocm/reflective/supervisor.hpp"

namespace ocm::reflective {

enum class Mistake : std::uint8_t {
  no_mistake,
  no_catalogue,
  no_configuration,  ///< none at all, more than 64, or an initial or fall-back one that is not there
  bad_time,          ///< settle of 0, or a negative time
  name_twice,        ///< `where` and `other` have one name
  no_such_topic,     ///< an index outside the catalogue
  not_a_stream,      ///< an actuator cannot be asked for samples
  not_an_actuator,   ///< only actuators take set points and limits
  stream_twice,      ///< one topic twice in a configuration
  bad_period,        ///< not above 0, or not on the wire
  no_such_field,
  field_of_some_frames,    ///< a multiplexed one: when it comes is not known
  limit_outside_spec,      ///< a limit is empty, or allows what the field's range does not
  set_point_outside_spec,  ///< a value that the field cannot have
  set_point_beyond_limit,  ///< of its own configuration
  bad_condition,           ///< a comparison, a limit, a hysteresis or a window that means nothing there
  bad_expression,          ///< operands are missing, left over, or more than 64
  bad_transition,          ///< its configuration or monitor is not there, or it leads where it comes from
  not_watched,             ///< it looks at a topic that its configuration does not stream
  bad_adaptation,          ///< its stream is not there or has two, or bounds that mean nothing
  both_fire,               ///< at once, with one precedence, to different configurations
  unreachable,             ///< nothing leads there from the initial configuration
  no_way_to_fall_back,     ///< nothing leads to the fall-back from there
};

[[nodiscard]] constexpr std::string_view describe(Mistake mistake) noexcept {
  constexpr std::string_view texts[] = {
      "no mistake",
      "there is no catalogue",
      "no initial or fall-back configuration, or more than 64 configurations",
      "a time that is negative, or a settling time of 0",
      "a name is used twice",
      "unknown topic",
      "an actuator sends no samples",
      "only an actuator takes set points",
      "a topic is asked for twice in one configuration",
      "a period that a request cannot carry",
      "unknown field",
      "a field that only some frames of its message have",
      "a limit is outside the range of its field, or is empty",
      "a set point is outside the range of its field",
      "a set point is beyond the limit of its own configuration",
      "a condition that can never be evaluated",
      "an expression is not complete, or needs more than 64 operands",
      "a transition between configurations or with a monitor that do not exist",
      "a transition depends on a topic that its configuration does not ask for",
      "an adaptation of a stream that is not there, or with invalid bounds",
      "two transitions can fire at once, with one precedence and different targets",
      "a configuration cannot be reached",
      "no transitions lead from a configuration to the fall-back",
  };
  return texts[static_cast<std::size_t>(mistake)];
}

/// Which part of the tables is meant.
enum class Part : std::uint8_t {
  whole,
  configuration,
  stream,
  limit,
  entry,
  adaptation,
  condition,
  monitor,
  transition
};

struct Finding {
  Mistake kind = Mistake::no_mistake;
  Part part = Part::whole;
  std::size_t configuration = none;  ///< whose stream, limit, ...; for transitions: in which
  std::size_t where = 0;             ///< index in its table
  std::size_t other = 0;             ///< of the second one that it takes two of
};

/// Whether all topics that a monitor needs are streamed in a configuration.
[[nodiscard]] constexpr bool sees(const Operator& tables, std::size_t configuration,
                                  const Monitor& monitor) noexcept {
  for (const Term& term : monitor.terms) {
    if (term.op != Op::condition) continue;
    const std::uint16_t topic = tables.conditions[term.condition].topic;
    if (topic == none) continue;
    bool streamed = false;
    for (const Stream& stream : tables.configurations[configuration].streams)
      streamed = streamed || stream.topic == topic;
    if (!streamed) return false;
  }
  return true;
}

namespace detail {

/// What values of one watched thing an assignment allows.
struct Allowed {
  std::int64_t low = INT64_MIN;
  std::int64_t high = INT64_MAX;
  std::uint64_t zero = 0;  ///< bits that must not be set
  std::array<std::int64_t, 12> excluded{};
  std::size_t exclusions = 0;
  bool impossible = false;

  constexpr void take(const Condition& c, bool value) noexcept {
    const bool timed = c.watched == Watched::age || c.watched == Watched::gap;
    const auto up = [](std::int64_t a, std::int64_t b) {
      std::int64_t sum = 0;
      return __builtin_add_overflow(a, b, &sum) ? (b < 0 ? INT64_MIN : INT64_MAX) : sum;
    };
    switch (c.is) {
      case Is::above:
        if (timed)
          value ? void(low = std::max(low, c.limit)) : void(high = std::min(high, up(c.limit, -1)));
        else if (value)
          low = std::max(low, up(up(c.limit, -c.hysteresis), 1));
        else
          high = std::min(high, c.limit);
        return;
      case Is::below:
        if (value)
          high = std::min(high, up(up(c.limit, c.hysteresis), -1));
        else
          low = std::max(low, c.limit);
        return;
      case Is::equal:
      case Is::other:
        if (value == (c.is == Is::equal)) {
          low = std::max(low, c.limit);
          high = std::min(high, c.limit);
        } else if (exclusions < excluded.size()) {
          excluded[exclusions++] = c.limit;
        }
        return;
      case Is::any_bit:
        if (!value) zero |= static_cast<std::uint64_t>(c.limit);
        return;
    }
  }
  /// Once `zero` is known.
  constexpr void take_bits(const Condition& c, bool value) noexcept {
    if (c.is == Is::any_bit && value && (static_cast<std::uint64_t>(c.limit) & ~zero) == 0) impossible = true;
    if (c.is == Is::any_bit && low == high) {
      const bool set = (static_cast<std::uint64_t>(low) & static_cast<std::uint64_t>(c.limit)) != 0;
      impossible = impossible || set != value;
    }
  }
  [[nodiscard]] constexpr bool none_left() const noexcept {
    if (impossible || low > high) return true;
    if (low != high) return false;
    for (std::size_t i = 0; i < exclusions; ++i)
      if (excluded[i] == low) return true;
    return false;
  }
};

/// Whether two conditions are about one value.
[[nodiscard]] constexpr bool same_value(const Operator& op, const Condition& a, const Condition& b) noexcept {
  if (a.watched != b.watched) return false;
  if (a.watched == Watched::rate) return a.topic == b.topic && a.window == b.window;
  if (a.watched == Watched::age || a.watched == Watched::gap) return a.topic == b.topic;
  if (a.watched != Watched::field) return true;
  if (a.topic != b.topic || a.frame != b.frame || a.field != b.field) return false;
  const bool a_ordered = a.is == Is::above || a.is == Is::below;
  const bool b_ordered = b.is == Is::above || b.is == Is::below;
  const protocol::Field& field = op.topic(a.topic).frames[a.frame].fields[a.field];
  const bool raw_is_ordered = !field.is_float() && (field.is_signed || field.position.width < 64);
  return a_ordered == b_ordered || raw_is_ordered;
}

inline constexpr std::size_t most_together = 12;

/// Whether both monitors can be true at one time.
[[nodiscard]] constexpr bool both_can_be_true(const Operator& op, const Monitor& a,
                                              const Monitor& b) noexcept {
  std::array<std::uint16_t, most_together> used{};
  std::size_t count = 0;
  for (const Monitor* monitor : {&a, &b}) {
    for (const Term& term : monitor->terms) {
      if (term.op != Op::condition) continue;
      const auto end = used.begin() + static_cast<std::ptrdiff_t>(count);
      if (std::find(used.begin(), end, term.condition) != end) continue;
      if (count == most_together) return true;
      used[count++] = term.condition;
    }
  }
  const auto place = [&](std::size_t condition) {
    std::size_t i = 0;
    while (used[i] != condition) ++i;
    return i;
  };
  for (std::uint32_t bits = 0; bits < (std::uint32_t{1} << count); ++bits) {
    const auto of = [&](std::size_t condition) { return truth((bits >> place(condition) & 1U) != 0); };
    if (evaluate(a.terms, of) != Truth::yes || evaluate(b.terms, of) != Truth::yes) continue;
    bool possible = true;
    for (std::size_t i = 0; i < count && possible; ++i) {
      Allowed allowed;
      const Condition& first = op.conditions[used[i]];
      for (std::size_t k = 0; k < count; ++k)
        if (same_value(op, first, op.conditions[used[k]]))
          allowed.take(op.conditions[used[k]], (bits >> k & 1U) != 0);
      for (std::size_t k = 0; k < count; ++k)
        if (same_value(op, first, op.conditions[used[k]]))
          allowed.take_bits(op.conditions[used[k]], (bits >> k & 1U) != 0);
      possible = !allowed.none_left();
    }
    if (possible) return true;
  }
  return false;
}

/// Collects what is wrong; `report(Finding)` gets each.
template <class Report>
class Checker {
 public:
  constexpr Checker(const Operator& op, Report& report) noexcept : op_(op), report_(report) {}

  constexpr void run() noexcept {
    if (op_.catalogue == nullptr) return say({.kind = Mistake::no_catalogue});
    const std::size_t count = op_.configurations.size();
    if (count == 0 || count > 64 || op_.initial >= count || op_.fall_back >= count)
      return say({.kind = Mistake::no_configuration});
    if (op_.settle.count() <= 0 || op_.retry.count() < 0 || op_.reaction.count() < 0 ||
        op_.handling.count() < 0)
      say({.kind = Mistake::bad_time});
    names(op_.configurations, Part::configuration);
    names(op_.conditions, Part::condition);
    names(op_.monitors, Part::monitor);
    for (std::size_t c = 0; c < count; ++c) configuration(c);
    for (std::size_t c = 0; c < op_.conditions.size(); ++c) condition(c);
    for (std::size_t m = 0; m < op_.monitors.size(); ++m)
      if (!well_formed(op_.monitors[m].terms, op_.conditions.size()) || op_.monitors[m].lasting.count() < 0)
        say({.kind = Mistake::bad_expression, .part = Part::monitor, .where = m});
    for (std::size_t t = 0; t < op_.transitions.size(); ++t) transition(t);
    if (said_) return;  // what follows follows indices
    for (std::size_t t = 0; t < op_.transitions.size(); ++t) watched(t);
    for (std::size_t c = 0; c < count; ++c) at_once(c);
    ways();
  }

 private:
  constexpr void say(const Finding& finding) noexcept {
    said_ = true;
    report_(finding);
  }
  template <class Items>
  constexpr void names(const Items& items, Part part) noexcept {
    for (std::size_t i = 0; i < items.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        if (items[i].name == items[k].name && !items[i].name.empty())
          say({.kind = Mistake::name_twice, .part = part, .where = i, .other = k});
  }
  /// The field of a topic; nullptr if there is none.
  [[nodiscard]] constexpr const protocol::Field* field(std::uint16_t topic, std::uint16_t frame,
                                                       std::uint16_t index) const noexcept {
    if (topic >= op_.catalogue->topics.size() || frame >= op_.topic(topic).frames.size()) return nullptr;
    const auto fields = op_.topic(topic).frames[frame].fields;
    return index < fields.size() ? &fields[index] : nullptr;
  }
  [[nodiscard]] constexpr bool known(std::uint16_t topic) const noexcept {
    return topic < op_.catalogue->topics.size();
  }

  constexpr void configuration(std::size_t c) noexcept {
    const Configuration& configuration = op_.configurations[c];
    for (std::size_t s = 0; s < configuration.streams.size(); ++s) {
      const Mistake kind = stream(configuration, s);
      if (kind != Mistake::no_mistake)
        say({.kind = kind, .part = Part::stream, .configuration = c, .where = s});
    }
    for (std::size_t l = 0; l < configuration.limits.size(); ++l) {
      const Mistake kind = limit(configuration.limits[l]);
      if (kind != Mistake::no_mistake)
        say({.kind = kind, .part = Part::limit, .configuration = c, .where = l});
    }
    for (std::size_t e = 0; e < configuration.entry.size(); ++e) {
      const Mistake kind = entry(configuration, configuration.entry[e]);
      if (kind != Mistake::no_mistake)
        say({.kind = kind, .part = Part::entry, .configuration = c, .where = e});
    }
    for (std::size_t a = 0; a < configuration.adaptations.size(); ++a)
      if (!adaptation(configuration, a))
        say({.kind = Mistake::bad_adaptation, .part = Part::adaptation, .configuration = c, .where = a});
  }
  [[nodiscard]] constexpr Mistake stream(const Configuration& configuration, std::size_t s) const noexcept {
    const Stream& stream = configuration.streams[s];
    if (!known(stream.topic)) return Mistake::no_such_topic;
    for (std::size_t k = 0; k < s; ++k)
      if (configuration.streams[k].topic == stream.topic) return Mistake::stream_twice;
    const protocol::Topic& topic = op_.topic(stream.topic);
    if (topic.kind == protocol::Kind::actuator) return Mistake::not_a_stream;
    const bool carried = topic.is_message() || protocol::Period::from(stream.period).ok();
    return stream.period.count() > 0 && carried ? Mistake::no_mistake : Mistake::bad_period;
  }
  [[nodiscard]] constexpr Mistake limit(const Limit& limit) const noexcept {
    if (!known(limit.topic)) return Mistake::no_such_topic;
    if (op_.topic(limit.topic).kind != protocol::Kind::actuator) return Mistake::not_an_actuator;
    const protocol::Field* const f = field(limit.topic, 0, limit.field);
    if (f == nullptr || f->is_float()) return Mistake::no_such_field;
    const bool inside = limit.min >= f->raw_min && limit.max <= f->raw_max;
    return inside && limit.min <= limit.max && limit.per_second >= 0 ? Mistake::no_mistake
                                                                     : Mistake::limit_outside_spec;
  }
  [[nodiscard]] constexpr Mistake entry(const Configuration& configuration,
                                        const SetPoint& set_point) const noexcept {
    if (!known(set_point.topic)) return Mistake::no_such_topic;
    const protocol::Topic& topic = op_.topic(set_point.topic);
    if (topic.kind != protocol::Kind::actuator) return Mistake::not_an_actuator;
    if (set_point.repeat.count() < 0) return Mistake::bad_time;
    if (set_point.raw.size() > topic.frames[0].fields.size()) return Mistake::no_such_field;
    for (std::size_t i = 0; i < set_point.raw.size(); ++i) {
      const protocol::Field& f = topic.frames[0].fields[i];
      if (!f.is_float() && (set_point.raw[i] < f.raw_min || set_point.raw[i] > f.raw_max))
        return Mistake::set_point_outside_spec;
    }
    for (const Limit& limit : configuration.limits) {
      if (limit.topic != set_point.topic) continue;
      const std::int64_t value = limit.field < set_point.raw.size() ? set_point.raw[limit.field] : 0;
      if (value < limit.min || value > limit.max) return Mistake::set_point_beyond_limit;
    }
    return Mistake::no_mistake;
  }
  [[nodiscard]] constexpr bool adaptation(const Configuration& configuration, std::size_t a) const noexcept {
    const Adaptation& adaptation = configuration.adaptations[a];
    if (adaptation.stream >= configuration.streams.size()) return false;
    const Stream& stream = configuration.streams[adaptation.stream];
    if (!known(stream.topic) || op_.topic(stream.topic).is_message()) return false;
    for (std::size_t k = 0; k < a; ++k)
      if (configuration.adaptations[k].stream == adaptation.stream) return false;
    const protocol::Field* const f = field(adaptation.topic, adaptation.frame, adaptation.field);
    if (f == nullptr || f->selector != protocol::no_selector) return false;
    const base::Duration grain = adaptation.grain;
    const base::Duration width = adaptation.longest() - adaptation.shortest();
    if (grain.count() < 1 || adaptation.every < grain || adaptation.from >= adaptation.to) return false;
    // All periods that there can be are on the wire: both ends, and a grain is a whole unit of what has room.
    return adaptation.shortest().count() > 0 && width.count() % grain.count() == 0 &&
           stream.period >= adaptation.shortest() && stream.period <= adaptation.longest() &&
           wire(adaptation.shortest(), grain, width);
  }
  static constexpr bool wire(base::Duration shortest, base::Duration grain, base::Duration width) noexcept {
    for (const auto unit : {protocol::PeriodUnit::microseconds, protocol::PeriodUnit::milliseconds,
                            protocol::PeriodUnit::seconds}) {
      const std::int64_t size = protocol::Period::nanoseconds_of(unit);
      if (shortest.count() % size == 0 && grain.count() % size == 0 &&
          (shortest + width).count() / size <= UINT16_MAX)
        return true;
    }
    return false;
  }

  constexpr void condition(std::size_t c) noexcept {
    const Condition& condition = op_.conditions[c];
    const bool compares = condition.is == Is::above || condition.is == Is::below;
    Mistake kind = Mistake::no_mistake;
    std::int64_t reach = 0;
    if (condition.hysteresis < 0 || __builtin_sub_overflow(condition.limit, condition.hysteresis, &reach) ||
        __builtin_add_overflow(condition.limit, condition.hysteresis, &reach))
      kind = Mistake::bad_condition;
    switch (condition.watched) {
      case Watched::field:
        if (!known(condition.topic))
          kind = Mistake::no_such_topic;
        else if (op_.topic(condition.topic).kind == protocol::Kind::actuator)
          kind = Mistake::not_a_stream;
        else if (const auto* f = field(condition.topic, condition.frame, condition.field); f == nullptr)
          kind = Mistake::no_such_field;
        else if (f->selector != protocol::no_selector)
          kind = Mistake::field_of_some_frames;
        break;
      case Watched::age:
      case Watched::gap:
        if (!known(condition.topic)) kind = Mistake::no_such_topic;
        if (condition.is != Is::above || condition.limit < 1 || condition.hysteresis != 0)
          kind = Mistake::bad_condition;
        break;
      case Watched::rate:
        if (!known(condition.topic)) kind = Mistake::no_such_topic;
        if (!compares || condition.window.count() < 1) kind = Mistake::bad_condition;
        break;
      case Watched::bus_load:
        if (!compares || condition.window.count() < 1) kind = Mistake::bad_condition;
        break;
      case Watched::refusals:
        if (condition.is != Is::above) kind = Mistake::bad_condition;
        break;
      case Watched::bus_state:
        if (condition.is == Is::any_bit) kind = Mistake::bad_condition;
        break;
    }
    if (kind != Mistake::no_mistake) say({.kind = kind, .part = Part::condition, .where = c});
  }

  constexpr void transition(std::size_t t) noexcept {
    const Transition& transition = op_.transitions[t];
    const std::size_t count = op_.configurations.size();
    const bool from = transition.from == any_configuration || transition.from < count;
    const bool by = transition.monitor == by_request || transition.monitor < op_.monitors.size();
    if (!from || !by || transition.to >= count || transition.from == transition.to)
      say({.kind = Mistake::bad_transition, .part = Part::transition, .where = t});
  }

  /// From one configuration it must be able to see; from any, in one of them.
  constexpr void watched(std::size_t t) noexcept {
    const Transition& transition = op_.transitions[t];
    if (transition.monitor == by_request) return;
    for (std::size_t c = 0; c < op_.configurations.size(); ++c)
      if (op_.leaves(transition, c) && sees(op_, c, op_.monitors[transition.monitor])) return;
    say({.kind = Mistake::not_watched,
         .part = Part::transition,
         .configuration = transition.from,
         .where = t});
  }

  constexpr void at_once(std::size_t c) noexcept {
    for (std::size_t a = 0; a < op_.transitions.size(); ++a) {
      const Transition& first = op_.transitions[a];
      if (first.monitor == by_request || !op_.leaves(first, c)) continue;
      for (std::size_t b = a + 1; b < op_.transitions.size(); ++b) {
        const Transition& second = op_.transitions[b];
        if (second.monitor == by_request || !op_.leaves(second, c) || first.to == second.to ||
            first.precedence != second.precedence)
          continue;
        if (both_can_be_true(op_, op_.monitors[first.monitor], op_.monitors[second.monitor]))
          say({.kind = Mistake::both_fire,
               .part = Part::transition,
               .configuration = c,
               .where = a,
               .other = b});
      }
    }
  }

  constexpr void ways() noexcept {
    const std::size_t count = op_.configurations.size();
    std::uint64_t reached = std::uint64_t{1} << op_.initial;
    std::uint64_t leads = std::uint64_t{1} << op_.fall_back;
    for (std::size_t round = 0; round < count; ++round) {
      for (const Transition& transition : op_.transitions) {
        for (std::size_t c = 0; c < count; ++c) {
          if (!op_.leaves(transition, c)) continue;
          if ((reached >> c & 1U) != 0) reached |= std::uint64_t{1} << transition.to;
          if ((leads >> transition.to & 1U) != 0) leads |= std::uint64_t{1} << c;
        }
      }
    }
    for (std::size_t c = 0; c < count; ++c) {
      if ((reached >> c & 1U) == 0)
        say({.kind = Mistake::unreachable, .part = Part::configuration, .where = c});
      if ((leads >> c & 1U) == 0)
        say({.kind = Mistake::no_way_to_fall_back, .part = Part::configuration, .where = c});
    }
  }

  const Operator& op_;
  Report& report_;
  bool said_ = false;
};

}  // namespace detail

/// Calls report(Finding) for each mistake. What needs sound indices is looked at only if all are.
template <class Report>
constexpr void check(const Operator& tables, Report&& report) noexcept {
  detail::Checker checker{tables, report};
  checker.run();
}

[[nodiscard]] constexpr Finding first_mistake(const Operator& tables) noexcept {
  Finding first;
  check(tables, [&](const Finding& finding) {
    if (first.kind == Mistake::no_mistake) first = finding;
  });
  return first;
}

/// Whether the tables have room in a Supervisor<room>.
[[nodiscard]] constexpr bool fits(const Operator& tables, const Room& room) noexcept {
  if (tables.conditions.size() > room.conditions || tables.monitors.size() > room.monitors) return false;
  for (const Configuration& c : tables.configurations)
    if (c.streams.size() > room.streams || c.entry.size() > room.entry || c.limits.size() > room.limits ||
        c.adaptations.size() > room.adaptations)
      return false;
  std::size_t elsewhere = 0;  // are stopped at the start
  if (tables.initial < tables.configurations.size())
    for_each_stream_elsewhere(tables, tables.initial, [&](const Stream& stream) {
      elsewhere += tables.topic(stream.topic).is_message() ? 0U : 1U;
    });
  return elsewhere <= room.streams;
}

}  // namespace ocm::reflective
