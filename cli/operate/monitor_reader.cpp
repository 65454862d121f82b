#include "cli/operate/monitor_reader.hpp"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <utility>

#include "ocm/base/decimal.hpp"

#include "cli/operate/threshold.hpp"
#include "cli/words/condition.hpp"

namespace ocm::cli::operate {
namespace {

using reflective::Condition;
using reflective::Is;
using reflective::none;
using reflective::Op;
using reflective::Watched;
using spec::At;
using spec::Kind;

constexpr std::string_view condition_form =
    "\"ring.sensor_4>3000\", or an object with one of where, age, gap, rate, refusals, bus_load, bus_state, "
    "all, any and not";
constexpr std::string_view kinds[] = {"where",    "age",       "gap", "rate", "refusals",
                                      "bus_load", "bus_state", "all", "any",  "not"};

class MonitorReader : private ValueReader {
 public:
  explicit MonitorReader(const Reading& reading) : ValueReader(reading), file_(reading.file) {}

  void read(const At& at) {
    if (!is_list(at, "a list of monitors")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      OperatorFile::Item& of = file_.monitor_items.emplace_back();
      of.place = place(item);
      auto& terms = file_.terms.emplace_back();
      reflective::Monitor& monitor = file_.monitors.emplace_back();
      if (!is_object(item, R"({"name": "obstacle", "when": "ring.sensor_4>3000"})")) continue;
      check_keys(item, {"name", "when", "for"});
      if (const auto text = require(item, "name", "what it is called")) of.text = name(*text);
      if (const auto when = require(item, "when", condition_form)) expression(*when, terms);
      if (const auto lasting = item.member("for"))
        monitor.lasting = duration(*lasting).value_or(monitor.lasting);
    }
  }

 private:
  void expression(const At& at, std::vector<reflective::Term>& terms) {
    if (at.node->is(Kind::string)) return where(at, at, terms);
    if (!is_object(at, condition_form)) return;
    check_keys(at, {"where", "hysteresis", "age", "gap", "rate", "refusals", "bus_load", "bus_state", "above",
                    "below", "window", "all", "any", "not"});
    std::optional<std::string_view> kind;
    for (const auto each : kinds) {
      if (!at.member(each)) continue;
      if (kind)
        return tell(at, "both " + spec::quoted(*kind) + " and " + spec::quoted(each),
                    "one of them, or both within \"all\" or \"any\"");
      kind = each;
    }
    if (!kind) return tell(at, "it says nothing of what is watched", "one of " + spec::list_of(kinds));
    const At of = *at.member(*kind);
    const auto takes = [&](std::initializer_list<std::string_view> keys) {
      for (const auto& [key, node] : at.node->members)
        if (key != *kind && std::find(keys.begin(), keys.end(), key) == keys.end())
          tell({&node, at.path + "/" + spec::pointer_step(key)},
               spec::quoted(key) + " means nothing beside " + spec::quoted(*kind),
               keys.size() == 0 ? "leave it out" : spec::list_of(keys));
    };
    if (*kind == "all" || *kind == "any") {
      takes({});
      if (!is_list(of, "a list of conditions")) return;
      if (of.node->items.empty()) tell(of, "an empty list", "at least one condition");
      for (std::size_t i = 0; i < of.node->items.size(); ++i) {
        expression(of.item(i), terms);
        if (i != 0) terms.push_back({.op = *kind == "all" ? Op::all : Op::any});
      }
    } else if (*kind == "not") {
      takes({});
      expression(of, terms);
      terms.push_back({.op = Op::negation});
    } else if (*kind == "where") {
      takes({"hysteresis"});
      where(at, of, terms);
    } else if (*kind == "age" || *kind == "gap") {
      takes({"above"});
      watch_time(at, of, *kind == "age" ? Watched::age : Watched::gap, terms);
    } else if (*kind == "rate") {
      takes({"above", "below", "window"});
      watch_rate(at, of, terms);
    } else if (*kind == "bus_state") {
      takes({});
      watch_bus_state(of, terms);
    } else {
      if (!is_kind(of, Kind::boolean, "true")) return;
      if (!of.node->truth) return tell(of, "false", "true, or {\"not\": ...}");
      if (*kind == "refusals") {
        takes({"above"});
        Condition condition{.watched = Watched::refusals};
        if (const auto above = at.member("above"))
          condition.limit = integer(*above, 0, 1'000'000).value_or(0);
        add(at, condition, "refusals above " + std::to_string(condition.limit), terms);
      } else {
        takes({"above", "below", "window"});
        watch_load(at, terms);
      }
    }
  }

  void add(const At& at, const Condition& condition, std::string text, std::vector<reflective::Term>& terms) {
    const auto same = [&](const Condition& other) {
      return other.watched == condition.watched && other.is == condition.is &&
             other.topic == condition.topic && other.frame == condition.frame &&
             other.field == condition.field && other.limit == condition.limit &&
             other.hysteresis == condition.hysteresis && other.window == condition.window;
    };
    const auto found = std::find_if(file_.conditions.begin(), file_.conditions.end(), same);
    const auto index = static_cast<std::uint16_t>(found - file_.conditions.begin());
    if (found == file_.conditions.end()) {
      file_.conditions.push_back(condition);
      file_.condition_items.push_back({std::move(text), place(at)});
    }
    terms.push_back({.condition = index});
  }

  void where(const At& object, const At& at, std::vector<reflective::Term>& terms) {
    const auto text = word(at, "a field, a comparison and a value: \"ring.sensor_4>3000\"");
    if (!text) return;
    const auto parts = words::split_condition(*text);
    if (!parts)
      return tell(at, spec::quoted(*text) + " is not a condition",
                  "a field, =, !=, <, <=, > or >=, and a value: \"ring.sensor_4>3000\"");
    const auto of = field(at, std::string{parts->field});
    if (!of) return;
    if (catalogue_.topics[of->topic].kind == protocol::Kind::actuator)
      return tell(at,
                  spec::quoted(catalogue_.topics[of->topic].name) + " is an actuator, which sends no samples",
                  "a field of a sensor or a message");
    const auto found = threshold(*of->of, parts->comparison, parts->value);
    if (!found) return tell(at, spec::quoted(*text) + " is no condition on values", found.error);
    Condition condition{
        .is = found->is, .topic = of->topic, .frame = of->frame, .field = of->field, .limit = found->limit};
    if (const auto width = object.node->is(Kind::object) ? object.member("hysteresis") : std::nullopt) {
      if (condition.is != Is::above && condition.is != Is::below)
        return tell(*width, "only < and > have a hysteresis", "leave it out");
      if (of->of->is_derived())
        return tell(*width, spec::quoted(*text) + " is on a derived field, which has no hysteresis",
                    "a condition on " + measured(*of) + ", of which it is derived");
      condition.hysteresis = distance(*width, *of->of).value_or(0);
    }
    add(at, condition, *text, terms);
    if (found->negated) terms.push_back({.op = Op::negation});
  }

  void watch_time(const At& at, const At& of, Watched watched, std::vector<reflective::Term>& terms) {
    Condition condition{.watched = watched, .topic = topic(of, Takes::streams)};
    const auto above = require(at, "above", "a time, such as \"250ms\"");
    const auto limit = above ? duration(*above) : std::nullopt;
    if (condition.topic == none || !limit) return;
    condition.limit = limit->count();
    add(at, condition,
        std::string{watched == Watched::age ? "age" : "gap"} + " of " + of.node->text + " above " +
            above->node->text,
        terms);
  }

  /// Which of above and below there is.
  [[nodiscard]] std::optional<std::pair<Is, At>> comparison(const At& at) {
    const auto above = at.member("above");
    const auto below = at.member("below");
    if (above.has_value() == below.has_value()) {
      tell(at, above ? "both \"above\" and \"below\"" : "neither \"above\" nor \"below\"", "one of them");
      return std::nullopt;
    }
    return std::pair{above ? Is::above : Is::below, above ? *above : *below};
  }

  void watch_rate(const At& at, const At& of, std::vector<reflective::Term>& terms) {
    Condition condition{.watched = Watched::rate, .topic = topic(of, Takes::streams)};
    condition.window = time(at, "window", "in which samples are counted, such as \"1s\"");
    const auto limit = comparison(at);
    const auto count = limit ? integer(limit->second, 0, 1'000'000'000) : std::nullopt;
    if (condition.topic == none || !count) return;
    condition.is = limit->first;
    condition.limit = *count;
    add(at, condition,
        "rate of " + of.node->text + (condition.is == Is::above ? " above " : " below ") +
            std::to_string(*count) + " in " + spec::print(condition.window),
        terms);
  }

  void watch_load(const At& at, std::vector<reflective::Term>& terms) {
    static constexpr std::string_view form = "percent: \"70%\"";
    Condition condition{.watched = Watched::bus_load};
    condition.window = time(at, "window", "over which the load is taken, such as \"1s\"");
    const auto limit = comparison(at);
    const auto text = limit ? word(limit->second, form) : std::nullopt;
    if (!text) return;
    std::string_view digits = *text;
    if (digits.ends_with('%')) digits.remove_suffix(1);
    const auto percent = base::parse_decimal(digits);
    const auto per_mille =
        percent ? base::divide_rounded(*percent, {1, -1}) : base::Result<std::int64_t>{percent.error};
    if (!per_mille || *per_mille < 0 || *per_mille > 1000)
      return tell(limit->second, spec::quoted(*text) + " is no load of a bus", std::string{form});
    if (*per_mille == (limit->first == Is::above ? 1000 : 0))
      return tell(
          limit->second,
          spec::quoted(*text) + (limit->first == Is::above ? " is 100 % in tenths, and no load is above that"
                                                           : " is 0 % in tenths, and no load is below that"),
          std::string{form});
    for (const Condition& other : file_.conditions)
      if (other.watched == Watched::bus_load && other.window != condition.window)
        return tell(at, "another window than that of an earlier bus_load",
                    "one window for all of them: " + spec::quoted(spec::print(other.window)));
    condition.is = limit->first;
    condition.limit = *per_mille;
    add(at, condition, std::string{"bus load "} + (condition.is == Is::above ? "above " : "below ") + *text,
        terms);
  }

  void watch_bus_state(const At& of, std::vector<reflective::Term>& terms) {
    static constexpr std::pair<std::string_view, reflective::BusState> states[] = {
        {"warning", reflective::BusState::warning},
        {"passive", reflective::BusState::passive},
        {"off", reflective::BusState::off},
        {"down", reflective::BusState::down}};
    const auto state = one_of(of, states);
    if (!state) return;
    add(of, {.watched = Watched::bus_state, .limit = static_cast<std::int64_t>(*state) - 1},
        "bus state " + of.node->text, terms);
  }

  OperatorFile& file_;
};

}  // namespace

void read_monitors(const spec::At& at, const Reading& reading) {
  MonitorReader{reading}.read(at);
}

}  // namespace ocm::cli::operate
