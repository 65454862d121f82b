#include "cli/stats/assertion.hpp"

#include <cmath>

#include <fmt/format.h>

#include "cli/words/command.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli::stats {

using measure::PeriodFrom;
using measure::TopicFigures;

/// Something that can be demanded, of a topic or of a bus. Nothing measured: empty.
struct Quantity {
  std::string_view name;
  Unit unit;
  std::optional<double> (*of_topic)(const TopicFigures&);
  std::optional<double> (*of_bus)(const Bus&);
};

namespace {

double number(std::uint64_t count) {
  return static_cast<double>(count);
}
/// Whether anything says how the samples come.
bool has_data(const TopicFigures& topic) {
  return topic.timing.count + topic.timing.missing + topic.incomplete != 0;
}
std::optional<double> if_any(const TopicFigures& topic, double value) {
  return has_data(topic) ? std::optional{value} : std::nullopt;
}
std::optional<double> if_distances(const TopicFigures& topic, double value) {
  return topic.timing.distances != 0 ? std::optional{value} : std::nullopt;
}

constexpr Quantity quantities[] = {
    {"rate", Unit::hertz,
     [](const TopicFigures& t) -> std::optional<double> {  // none in a log without times
       return t.timing.rate_hz > 0 ? if_distances(t, t.timing.rate_hz) : std::nullopt;
     },
     [](const Bus& b) -> std::optional<double> {
       return b.figures.span().count() > 0 ? std::optional{b.figures.rate_hz} : std::nullopt;
     }},
    {"count", Unit::none,
     [](const TopicFigures& t) -> std::optional<double> { return number(t.timing.count); }, nullptr},
    {"period", Unit::time, [](const TopicFigures& t) { return if_distances(t, t.timing.mean_ns); }, nullptr},
    {"jitter", Unit::time, [](const TopicFigures& t) { return if_distances(t, t.timing.jitter_ns); },
     nullptr},
    {"spread", Unit::time,
     [](const TopicFigures& t) { return if_distances(t, static_cast<double>(t.timing.spread_ns)); }, nullptr},
    {"lateness", Unit::time,
     [](const TopicFigures& t) -> std::optional<double> {
       const bool measured =
           t.timing.period_from == PeriodFrom::request || t.timing.period_from == PeriodFrom::spec;
       return measured ? if_distances(t, static_cast<double>(t.timing.lateness_ns)) : std::nullopt;
     },
     nullptr},
    {"gap", Unit::time,
     [](const TopicFigures& t) -> std::optional<double> {
       return t.timing.distances != 0 || t.timing.gap_ns != 0
                  ? std::optional{static_cast<double>(t.timing.gap_ns)}
                  : std::nullopt;
     },
     nullptr},
    {"missing", Unit::none,
     [](const TopicFigures& t) -> std::optional<double> {
       return t.timing.period_from != PeriodFrom::nothing ? if_any(t, number(t.timing.missing))
                                                          : std::nullopt;
     },
     nullptr},
    {"incomplete", Unit::none, [](const TopicFigures& t) { return if_any(t, number(t.incomplete)); },
     [](const Bus& b) -> std::optional<double> { return number(b.figures.counters.incomplete); }},
    {"wrong", Unit::none, [](const TopicFigures& t) { return if_any(t, number(t.wrong_dlc)); },
     [](const Bus& b) -> std::optional<double> { return number(b.figures.counters.wrong_dlc); }},
    {"load", Unit::percent,
     [](const TopicFigures& t) { return std::isnan(t.load) ? std::nullopt : if_any(t, t.load * 100); },
     [](const Bus& b) -> std::optional<double> {
       const bool known = b.figures.bit_rates.nominal != 0 && b.figures.span().count() > 0;
       return known ? std::optional{b.figures.load * 100} : std::nullopt;
     }},
    {"peak", Unit::percent, nullptr,
     [](const Bus& b) -> std::optional<double> {
       if (b.figures.bit_rates.nominal == 0) return std::nullopt;
       return b.figures.worst_load * 100;
     }},
    {"frames", Unit::none, nullptr,
     [](const Bus& b) -> std::optional<double> {
       return number(b.figures.counters.frames - b.figures.counters.errors);
     }},
    {"errors", Unit::none, nullptr,
     [](const Bus& b) -> std::optional<double> { return number(b.figures.counters.errors); }},
    {"drops", Unit::none, nullptr, [](const Bus& b) -> std::optional<double> { return number(b.drops); }},
    {"unknown", Unit::none, nullptr,
     [](const Bus& b) -> std::optional<double> {
       return number(b.figures.counters.unknown + b.figures.counters.fd);
     }},
};

std::vector<std::string_view> names_of(bool bus) {
  std::vector<std::string_view> names;
  for (const Quantity& quantity : quantities)
    if (bus ? quantity.of_bus != nullptr : quantity.of_topic != nullptr) names.push_back(quantity.name);
  return names;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// In the unit that the quantity is measured in: Hz, ns, %. The failure says how to write it.
base::Result<double, std::string> parse_limit(std::string_view text, Unit unit) {
  const auto quantity = words::parse_quantity(text);
  const bool bare = quantity && quantity->unit.empty();
  switch (unit) {
    case Unit::none:
      if (bare) return quantity->number.as_double();
      return std::string{"a plain number, such as 0"};
    case Unit::hertz:
      if (bare || (quantity && quantity->unit == "Hz")) return quantity->number.as_double();
      return std::string{"a number of Hz, such as 1.9 or 1.9Hz"};
    case Unit::percent:
      if (quantity && (quantity->unit == "%" || (bare && quantity->number.digits == 0)))
        return quantity->number.as_double();
      return std::string{"a number with %, such as 40%"};
    case Unit::time:
      break;
  }
  const auto duration = words::parse_duration(text);
  if (duration) return static_cast<double>(duration->count());
  if (bare && quantity->number.digits == 0) return 0.0;
  return std::string{"a time with its unit, such as 900us or 50ms"};
}

}  // namespace

std::string to_text(double value, Unit unit, int digits) {
  switch (unit) {
    case Unit::none:
      return fmt::format("{:.0f}", value);
    case Unit::hertz:
      return fmt::format("{:.{}g} Hz", value, digits);
    case Unit::percent:
      return fmt::format("{:.{}g} %", value, digits - 1);
    case Unit::time:
      break;
  }
  if (value < 1e3) return fmt::format("{:.{}g} ns", value, digits);
  if (value < 1e6) return fmt::format("{:.{}g} us", value / 1e3, digits);
  if (value < 1e9) return fmt::format("{:.{}g} ms", value / 1e6, digits);
  return fmt::format("{:.{}f} s", value / 1e9, value < 1e10 ? digits - 1 : 1);
}

transport::Outcome<Assertion::Parts> Assertion::read(std::string_view text) {
  const auto wrong = [text](std::string what, std::string remedy) {
    return transport::Failure{fmt::format("--assert {}: {}", text, what), std::move(remedy)};
  };
  const std::string form = fmt::format("write {}", assertion_form);
  const std::size_t begin = text.find_first_of("<>=!");
  if (begin == std::string_view::npos) return wrong("compares nothing", form);
  std::size_t end = begin + 1;
  if (end < text.size() && text[end] == '=') ++end;
  struct Sign {
    std::string_view text;
    Relation relation;
  };
  constexpr Sign signs[] = {{"<", Relation::less},      {"<=", Relation::at_most}, {">", Relation::greater},
                            {">=", Relation::at_least}, {"=", Relation::equal},    {"==", Relation::equal},
                            {"!=", Relation::other}};
  const std::string_view sign = text.substr(begin, end - begin);
  const Sign* known = nullptr;
  for (const Sign& each : signs)
    if (each.text == sign) known = &each;
  if (known == nullptr)
    return wrong(fmt::format("'{}' compares nothing", sign), "one of: <, <=, >, >=, ==, !=");

  const std::string_view left = trimmed(text.substr(0, begin));
  const std::size_t point = left.rfind('.');
  if (point == std::string_view::npos) return wrong("has no quantity", form);
  const std::string_view name = left.substr(point + 1);
  Parts parts;
  parts.subject = left.substr(0, point);
  parts.relation = known->relation;
  const bool bus = parts.subject == "bus";
  for (const Quantity& quantity : quantities)
    if (quantity.name == name && (bus ? quantity.of_bus != nullptr : quantity.of_topic != nullptr))
      parts.quantity = &quantity;
  if (parts.quantity == nullptr)
    return wrong(fmt::format("no quantity '{}' of {}", name, bus ? "the bus" : "a topic"),
                 words::suggestion(name, names_of(bus)));
  const std::string_view right = trimmed(text.substr(end));
  auto limit = parse_limit(right, parts.quantity->unit);
  if (!limit)
    return wrong(fmt::format("'{}' is nothing to compare a {} with", right, name), "write " + limit.error);
  parts.limit = *limit;
  return parts;
}

bool Assertion::is_well_formed(std::string_view text) {
  return static_cast<bool>(read(text));
}

transport::Outcome<Assertion> Assertion::parse(std::string_view text, const protocol::Catalogue& catalogue) {
  const auto parts = read(text);
  if (!parts) return parts.error;
  Assertion assertion;
  assertion.text_ = text;
  assertion.quantity_ = parts->quantity;
  assertion.relation_ = parts->relation;
  assertion.limit_ = parts->limit;
  if (parts->subject == "bus") return assertion;
  assertion.topic_ = words::find_topic(catalogue, parts->subject);
  if (assertion.topic_ != nullptr) return assertion;
  auto words = words::topic_words(catalogue);
  words.push_back("bus");
  return transport::Failure{fmt::format("--assert {}: no topic '{}'", text, parts->subject),
                            words::suggestion(parts->subject, words)};
}

bool Assertion::holds(double measured) const noexcept {
  switch (relation_) {
    case Relation::less:
      return measured < limit_;
    case Relation::at_most:
      return measured <= limit_;
    case Relation::greater:
      return measured > limit_;
    case Relation::at_least:
      return measured >= limit_;
    case Relation::equal:
      return measured == limit_;
    case Relation::other:
      return measured != limit_;
  }
  return false;
}

Assertion::Verdict Assertion::check(std::span<const Bus> buses) const {
  // A topic that was never seen has none of anything.
  TopicFigures never;
  never.topic = topic_;
  bool seen = false;
  Verdict verdict{true, {}, {}};
  const auto judge = [&](std::optional<double> measured, std::string_view bus) {
    if (!verdict.holds) return;
    seen = true;
    verdict.holds = measured && holds(*measured);
    verdict.measured = measured;
    const std::string where = buses.size() > 1 ? fmt::format(" on {}", bus) : std::string{};
    verdict.said = measured
                       ? fmt::format("{}: it is {}{}", text_, to_text(*measured, quantity_->unit, 6), where)
                       : fmt::format("{}: nothing was measured{}", text_, where);
  };
  for (const Bus& bus : buses) {
    if (topic_ == nullptr) judge(quantity_->of_bus(bus), bus.name);
    for (const TopicFigures& topic : bus.figures.topics)
      if (topic.topic == topic_) judge(quantity_->of_topic(topic), bus.name);
  }
  if (!seen && topic_ != nullptr) judge(quantity_->of_topic(never), "any bus");
  if (!seen) verdict = {false, {}, fmt::format("{}: nothing was measured", text_)};
  return verdict;
}

}  // namespace ocm::cli::stats
