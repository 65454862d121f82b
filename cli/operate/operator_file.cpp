#include "cli/operate/operator_file.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "ocm/client/command.hpp"
#include "ocm/reflective/check.hpp"

#include "cli/operate/mistakes.hpp"
#include "cli/operate/threshold.hpp"
#include "cli/output/selection.hpp"
#include "cli/words/condition.hpp"
#include "cli/words/quantity.hpp"
#include "cli/words/topics.hpp"
#include "cli/words/value.hpp"
#include "generator/spec/checker.hpp"
#include "generator/spec/file.hpp"
#include "generator/spec/json.hpp"
#include "generator/spec/schema.hpp"

namespace ocm::cli::operate {
namespace {

using reflective::Condition;
using reflective::Is;
using reflective::none;
using reflective::Op;
using reflective::Watched;
using spec::At;
using spec::Kind;

constexpr spec::Document document{.what = "an operator",
                                  .members =
                                      "name, initial, fall_back, settle, reaction, handling, "
                                      "configurations, monitors and transitions",
                                  .schema = "operator.schema.json",
                                  .levels = 16};
constexpr std::size_t max_operator_bytes = 1'000'000;

constexpr std::string_view condition_form =
    "\"ring.sensor_4>3000\", or an object with one of where, age, gap, rate, refusals, bus_load, bus_state, "
    "all, any and not";
constexpr std::string_view commanding[] = {"behave", "drive", "led", "replay", "run", "set", "travel"};
constexpr std::string_view kinds[] = {"where",    "age",       "gap", "rate", "refusals",
                                      "bus_load", "bus_state", "all", "any",  "not"};

/// A field of the catalogue by its place in it.
struct FieldRef {
  std::uint16_t topic = none;
  std::uint16_t frame = 0;
  std::uint16_t field = 0;
  const protocol::Field* of = nullptr;
};

class Reader : private spec::Checker {
 public:
  Reader(std::string_view file_name, std::vector<spec::Problem>& problems,
         const protocol::Catalogue& catalogue, std::uint32_t bit_rate, OperatorFile& file)
      : Checker(file_name, problems), catalogue_(catalogue), bit_rate_(bit_rate), file_(file) {}

  void read(const spec::Node& node) {
    const At root{&node, ""};
    if (!is_object(root, "an object with " + std::string{document.members})) return;
    check_keys(root, {"$schema", "name", "description", "initial", "fall_back", "settle", "retry", "reaction",
                      "handling", "others", "configurations", "monitors", "transitions"});
    if (const auto at = require(root, "name", "what it is called")) file_.name = name(*at);
    if (const auto at = root.member("description")) file_.description = line(*at);
    file_.settle_place = place(root);
    reflective::Operator& op = file_.tables;
    op.settle = time(root, "settle", "when a change of configuration is over, such as \"50ms\"");
    if (const auto at = root.member("settle")) file_.settle_place = place(*at);
    op.reaction =
        time(root, "reaction", "the longest time from a frame to the operator's own, such as \"5ms\"");
    op.handling =
        time(root, "handling", "the longest time in which a board takes a request, such as \"1ms\"");
    if (const auto at = root.member("retry")) op.retry = duration(*at).value_or(op.retry);
    if (const auto at = root.member("others")) read_others(*at);
    if (const auto at = require(root, "configurations", "a list of at least one")) read_configurations(*at);
    for (auto& parts : file_.parts) count_others(parts);
    if (const auto at = root.member("monitors")) read_monitors(*at);
    if (const auto at = root.member("transitions")) read_transitions(*at);
    if (const auto at = require(root, "initial", "the configuration in which it begins"))
      op.initial = configuration(*at);
    if (const auto at = require(root, "fall_back", "the configuration that everything leads to"))
      op.fall_back = configuration(*at);
  }

 private:
  // --- single values ---

  [[nodiscard]] base::Duration time(const At& object, std::string_view key, std::string_view remedy) {
    const auto at = require(object, key, remedy);
    return at ? duration(*at).value_or(base::Duration{}) : base::Duration{};
  }
  [[nodiscard]] std::optional<std::string> word(const At& at, std::string_view remedy) {
    if (!is_kind(at, Kind::string, remedy)) return std::nullopt;
    return at.node->text;
  }
  [[nodiscard]] bool is_list(const At& at, std::string_view remedy) {
    return is_kind(at, Kind::array, remedy);
  }

  enum class Takes : std::uint8_t { streams, actuators, anything };
  [[nodiscard]] std::uint16_t topic(const At& at, Takes takes) {
    const auto text = word(at, "the name of a topic, such as \"ring\"");
    if (!text) return none;
    const auto* const found = words::find_topic(catalogue_, *text);
    if (found == nullptr) {
      const auto kind = takes == Takes::actuators ? std::optional{protocol::Kind::actuator} : std::nullopt;
      tell(at, "there is no topic " + spec::quoted(*text), words::topic_suggestion(catalogue_, *text, kind));
      return none;
    }
    if (takes == Takes::streams && found->kind == protocol::Kind::actuator) {
      tell(at, spec::quoted(*text) + " is an actuator, which sends no samples", "a sensor or a message");
      return none;
    }
    if (takes == Takes::actuators && found->kind != protocol::Kind::actuator) {
      tell(at, spec::quoted(*text) + " takes no set points", "an actuator");
      return none;
    }
    return static_cast<std::uint16_t>(found - catalogue_.topics.data());
  }
  /// The only field that a text names.
  [[nodiscard]] std::optional<FieldRef> field(const At& at, const std::string& text) {
    const std::vector<std::string> names{text};
    const auto selection = Selection::of(catalogue_, names);
    if (!selection) {
      tell(at, selection.error.what, selection.error.remedy);
      return std::nullopt;
    }
    const auto fields = selection->fields();
    if (fields.size() != 1) {
      tell(at, spec::quoted(text) + " has " + std::to_string(fields.size()) + " fields",
           fields.empty() ? "a topic with a field" : "name one, such as " + spec::quoted(fields[0].name));
      return std::nullopt;
    }
    const ChosenField& chosen = fields[0];
    return FieldRef{static_cast<std::uint16_t>(chosen.topic - catalogue_.topics.data()),
                    static_cast<std::uint16_t>(chosen.layout - chosen.topic->frames.data()),
                    chosen.field->is_derived()
                        ? chosen.field->derived_from
                        : static_cast<std::uint16_t>(chosen.field - chosen.layout->values().data()),
                    chosen.field};
  }
  [[nodiscard]] std::optional<FieldRef> field(const At& object, std::string_view key,
                                              std::string_view remedy) {
    const auto at = require(object, key, remedy);
    if (!at) return std::nullopt;
    const auto text = word(*at, remedy);
    return text ? field(*at, *text) : std::nullopt;
  }
  /// The name of what a derived field is derived of.
  [[nodiscard]] std::string measured(const FieldRef& of) const {
    const auto& topic = catalogue_.topics[of.topic];
    const auto& layout = topic.frames[of.frame];
    std::string name{topic.name};
    for (const std::string_view part : {layout.name, layout.fields[of.field].name})
      if (!part.empty()) name.append(".").append(part);
    return spec::quoted(name);
  }
  [[nodiscard]] std::optional<std::int64_t> value(const At& at, const protocol::Field& of) {
    const auto text = word(at, words::detail::takes(of));
    if (!text) return std::nullopt;
    const auto raw = words::parse_typed_value(of, *text);
    if (raw) return *raw;
    tell(at, raw.error.substr(0, raw.error.find(": ")),
         raw.error.find(": ") == std::string::npos ? words::detail::takes(of)
                                                   : raw.error.substr(raw.error.find(": ") + 2));
    return std::nullopt;
  }
  /// How far apart two values are, in raw units, rounded up.
  [[nodiscard]] std::optional<std::int64_t> distance(const At& at, const protocol::Field& of) {
    const std::string unit = of.unit.empty() ? "a number" : "a number of " + std::string{of.unit};
    const auto text = word(at, unit + " above 0, as a text");
    if (!text) return std::nullopt;
    if (of.is_float()) {
      tell(at, "the field is a float", "leave it out, it is for integers only");
      return std::nullopt;
    }
    const auto quantity = words::detail::quantity_for(of, *text);
    const auto number =
        quantity ? words::convert(*quantity, of.unit) : base::Result<base::Decimal>{quantity.error};
    base::Decimal step = of.scale;
    if (step.digits < 0) step.digits = -step.digits;
    const auto raw = number ? base::divide_rounded(*number, step) : base::Result<std::int64_t>{number.error};
    if (!raw || number->digits < 0) {
      tell(at, spec::quoted(*text) + " is no distance of two values",
           unit + " above 0, such as \"1" + std::string{of.unit} + "\"");
      return std::nullopt;
    }
    const auto back = base::multiply({*raw, 0}, step);
    return back && base::compare(*back, *number) < 0 ? *raw + 1 : *raw;
  }
  [[nodiscard]] std::uint16_t configuration(const At& at) {
    const auto text = word(at, "the name of a configuration");
    if (!text) return none;
    std::vector<std::string> names;
    for (std::size_t c = 0; c < file_.parts.size(); ++c) {
      names.push_back(file_.parts[c].of.text);
      if (names.back() == *text) return static_cast<std::uint16_t>(c);
    }
    unknown(at, "configuration", *text, names);
    return none;
  }
  void unknown(const At& at, std::string_view what, const std::string& text,
               const std::vector<std::string>& names) {
    const std::string near = spec::nearest_name(text, names);
    tell(at, "there is no " + std::string{what} + " " + spec::quoted(text),
         !near.empty()   ? "did you mean " + spec::quoted(near) + "?"
         : names.empty() ? "add it to " + std::string{what} + "s"
                         : "one of " + spec::list_of(names));
  }

  // --- configurations ---

  void read_configurations(const At& at) {
    if (!is_list(at, "a list of configurations")) return;
    if (at.node->items.empty()) tell(at, "an empty list", "at least one configuration");
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      OperatorFile::Parts& parts = file_.parts.emplace_back();
      parts.of.place = place(item);
      if (!is_object(item, R"({"name": "driving", "streams": [...]})")) continue;
      check_keys(item, {"name", "description", "streams", "limits", "entry", "commanders"});
      if (const auto text = require(item, "name", "what it is called")) parts.of.text = name(*text);
      if (const auto text = item.member("description")) static_cast<void>(line(*text));
      if (const auto list = item.member("streams")) read_streams(*list, parts);
      if (const auto list = item.member("limits")) read_limits(*list, parts);
      if (const auto list = item.member("entry")) read_entry(*list, parts);
      if (const auto list = item.member("commanders")) read_commanders(*list, parts);
      if (const auto list = item.member("commanders"); list && parts.commanders)
        judge_commanders(*list, parts);
    }
  }

  [[nodiscard]] reflective::Stream read_stream(const At& at, Takes takes, bool may_adapt) {
    reflective::Stream stream;
    if (!is_object(at, R"({"topic": "ring", "period": "50ms"})")) return stream;
    if (may_adapt)
      check_keys(at, {"topic", "period", "priority", "adapt"});
    else
      check_keys(at, {"topic", "period", "priority"});
    if (const auto of = require(at, "topic", "which one, such as \"ring\"")) stream.topic = topic(*of, takes);
    const protocol::Topic* const known = stream.topic == none ? nullptr : &catalogue_.topics[stream.topic];
    if (known != nullptr) stream.priority = known->priority;
    if (const auto of = at.member("priority")) stream.priority = priority(*of).value_or(stream.priority);
    if (const auto of = at.member("period")) {
      if (known != nullptr && known->kind == protocol::Kind::sensor) {
        if (const auto wire = period(*of)) stream.period = wire->duration();
      } else {
        stream.period = duration(*of).value_or(base::Duration{});
      }
    } else if (known != nullptr) {
      stream.period = known->usual_period();
      if (stream.period.count() == 0)
        tell(at, "no \"period\"", "add \"period\": the spec states none for " + spec::quoted(known->name));
    }
    return stream;
  }

  void read_streams(const At& at, OperatorFile::Parts& parts) {
    if (!is_list(at, "a list of streams")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      const auto stream = read_stream(item, Takes::streams, true);
      if (const auto adapt = item.node->is(Kind::object) ? item.member("adapt") : std::nullopt)
        read_adaptation(*adapt, parts);
      parts.streams.push_back(stream);
      parts.stream_places.push_back(place(item));
    }
  }

  void read_adaptation(const At& at, OperatorFile::Parts& parts) {
    if (!is_object(at, R"({"field": "odometry.velocity.x", "from": "0m/s", "to": "0.1m/s", ...})")) return;
    check_keys(at, {"field", "magnitude", "from", "to", "at_from", "at_to", "grain", "every"});
    reflective::Adaptation adaptation;
    adaptation.stream = static_cast<std::uint16_t>(parts.streams.size());
    const auto followed = field(at, "field", "the field that the period follows");
    if (followed && followed->of->is_derived()) {
      tell(at, "a period does not follow a derived field", measured(*followed) + ", of which it is derived");
    } else if (const auto& of = followed) {
      adaptation.topic = of->topic;
      adaptation.frame = of->frame;
      adaptation.field = of->field;
      const auto bound = [&](std::string_view key, std::int64_t& to) {
        const auto text = require(at, key, words::detail::takes(*of->of));
        const auto raw = text ? value(*text, *of->of) : std::nullopt;
        if (raw) to = reflective::ordered(*of->of, *raw);
      };
      bound("from", adaptation.from);
      bound("to", adaptation.to);
    }
    if (const auto of = at.member("magnitude"))
      if (is_kind(*of, Kind::boolean, "true or false")) adaptation.magnitude = of->node->truth;
    adaptation.at_from = time(at, "at_from", "the period while the value is at most `from`");
    adaptation.at_to = time(at, "at_to", "the period while the value is at least `to`");
    if (const auto of = at.member("grain")) adaptation.grain = duration(*of).value_or(adaptation.grain);
    if (const auto of = at.member("every")) adaptation.every = duration(*of).value_or(adaptation.every);
    parts.adaptations.push_back(adaptation);
    parts.adaptation_places.push_back(place(at));
  }

  void read_limits(const At& at, OperatorFile::Parts& parts) {
    if (!is_list(at, "a list of limits")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, R"({"field": "motors.x", "min": "-0.1m/s", "max": "0.1m/s"})")) continue;
      check_keys(item, {"field", "min", "max", "per_second"});
      const auto of = field(item, "field", "a field of an actuator, such as \"motors.x\"");
      if (!of) continue;
      if (catalogue_.topics[of->topic].kind != protocol::Kind::actuator) {
        tell(item, spec::quoted(catalogue_.topics[of->topic].name) + " takes no set points",
             "a field of an actuator");
        continue;
      }
      reflective::Limit limit{of->topic, of->field, of->of->raw_min, of->of->raw_max, 0};
      if (const auto bound = item.member("min")) limit.min = value(*bound, *of->of).value_or(limit.min);
      if (const auto bound = item.member("max")) limit.max = value(*bound, *of->of).value_or(limit.max);
      if (const auto bound = item.member("per_second"))
        limit.per_second = distance(*bound, *of->of).value_or(limit.per_second);
      parts.limits.push_back(limit);
      parts.limit_places.push_back(place(item));
    }
  }

  void read_commanders(const At& at, OperatorFile::Parts& parts) {
    if (!is_list(at, "a list of verbs: who may command actuators")) return;
    auto& list = parts.commanders.emplace();
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_kind(item, Kind::string, "a verb, such as \"drive\"")) continue;
      const std::string& verb = item.node->text;
      if (std::find(std::begin(commanding), std::end(commanding), verb) == std::end(commanding))
        tell(item, spec::quoted(verb) + " commands nothing", "one of " + spec::list_of(commanding));
      list.push_back(verb);
    }
  }

  /// A verb that commands one kind of actuator alone cannot command what the operator repeats there.
  void judge_commanders(const At& at, const OperatorFile::Parts& parts) {
    for (const auto& own : parts.entry) {
      if (own.topic == none || own.repeat.count() <= 0) continue;
      const auto& topic = catalogue_.topics[own.topic];
      const std::string_view verb = topic.role == protocol::Role::drive   ? "drive"
                                    : topic.role == protocol::Role::light ? "led"
                                                                          : "";
      if (verb.empty() ||
          std::find(parts.commanders->begin(), parts.commanders->end(), verb) == parts.commanders->end())
        continue;
      tell(at,
           spec::quoted(verb) + " may command " + spec::quoted(topic.name) +
               ", of which \"entry\" repeats a set point",
           "leave out " + spec::quoted(verb) + ", or \"repeat\"");
    }
  }

  void read_entry(const At& at, OperatorFile::Parts& parts) {
    if (!is_list(at, "a list of set points")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, R"({"topic": "motors", "values": {"x": "0m/s"}})")) continue;
      check_keys(item, {"topic", "values", "priority", "repeat"});
      reflective::SetPoint set_point;
      if (const auto of = require(item, "topic", "which actuator"))
        set_point.topic = topic(*of, Takes::actuators);
      if (const auto of = item.member("priority"))
        set_point.priority = priority(*of).value_or(set_point.priority);
      if (const auto of = item.member("repeat")) set_point.repeat = duration(*of).value_or(set_point.repeat);
      if (set_point.topic == none) continue;
      const auto& fields = catalogue_.topics[set_point.topic].frames[0].fields;
      std::vector<std::int64_t>& raw = parts.raw.emplace_back(fields.size(), 0);
      if (const auto values = item.member("values"))
        if (is_object(*values, R"({"x": "0m/s"})")) read_values(*values, fields, raw);
      set_point.raw = raw;
      parts.entry.push_back(set_point);
      parts.entry_places.push_back(place(item));
    }
  }
  void read_values(const At& at, std::span<const protocol::Field> fields, std::vector<std::int64_t>& raw) {
    std::vector<std::string> names;
    for (const protocol::Field& each : fields) names.emplace_back(each.name);
    for (const auto& [key, node] : at.node->members) {
      const At item{&node, at.path + "/" + spec::pointer_step(key)};
      const auto found = std::find(names.begin(), names.end(), key);
      if (found == names.end()) {
        unknown(item, "field", key, names);
        continue;
      }
      const auto index = static_cast<std::size_t>(found - names.begin());
      raw[index] = value(item, fields[index]).value_or(0);
    }
  }

  void read_others(const At& at) {
    if (!is_list(at, "a list of streams and set points of other programs")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const auto stream = read_stream(at.item(i), Takes::anything, false);
      if (stream.topic == none || stream.period.count() <= 0) continue;
      file_.stated_others.push_back(stream.topic);
      add_frames(stream, file_.others);
    }
  }
  void add_frames(const reflective::Stream& stream, std::vector<analysis::Message>& to) const {
    const protocol::Topic& of = catalogue_.topics[stream.topic];
    const auto direction =
        of.kind == protocol::Kind::sensor ? protocol::Direction::sensor : protocol::Direction::command;
    for (const protocol::FrameLayout& layout : of.frames) {
      auto message = analysis::message_of(layout, direction, stream.priority, stream.period, of.deadline,
                                          of.jitter, bit_rate_);
      if (of.is_message())
        message.key =
            can::arbitration_key({.id = layout.address.number, .format = protocol::format_of(layout)});
      to.push_back(message);
    }
  }

  /// What is on the bus in a configuration though the file does not say it: the spec's messages that come by
  /// themselves, and the set points that programs may hold there, which boards may refuse. What "others"
  /// states is left to it.
  void count_others(OperatorFile::Parts& parts) const {
    const auto is_stated = [&](std::uint16_t topic) {
      const auto& stated = file_.stated_others;
      return std::find(stated.begin(), stated.end(), topic) != stated.end();
    };
    for (std::uint16_t t = 0; t < catalogue_.topics.size(); ++t) {
      const protocol::Topic& topic = catalogue_.topics[t];
      if (is_stated(t)) continue;
      if (topic.is_message()) {
        const auto same = [t](const auto& stream) { return stream.topic == t; };
        if (topic.usual_period().count() <= 0 ||
            std::any_of(parts.streams.begin(), parts.streams.end(), same))
          continue;
        parts.expected.push_back({t, topic.usual_period(), topic.priority});
        add_frames(parts.expected.back(), parts.others);
      } else if (topic.kind == protocol::Kind::actuator && may_be_commanded(parts, t)) {
        if (topic.role == protocol::Role::drive)
          add_held({t, client::hold_period, topic.priority}, parts);
        else
          parts.uncounted.push_back(t);
      }
    }
  }
  [[nodiscard]] bool may_be_commanded(const OperatorFile::Parts& parts, std::uint16_t topic) const {
    const auto repeats = [topic](const auto& own) { return own.topic == topic && own.repeat.count() > 0; };
    if (std::any_of(parts.entry.begin(), parts.entry.end(), repeats)) return false;
    if (!parts.commanders) return true;
    const auto role = catalogue_.topics[topic].role;
    return std::any_of(parts.commanders->begin(), parts.commanders->end(), [role](const auto& verb) {
      return verb == "drive" ? role == protocol::Role::drive
             : verb == "led" ? role == protocol::Role::light
                             : true;
    });
  }
  /// A program may hand a set point over a whole period late, and the next one in time.
  void add_held(const reflective::Stream& held, OperatorFile::Parts& parts) const {
    parts.expected.push_back(held);
    const auto first = parts.others.size();
    add_frames(held, parts.others);
    for (const protocol::Topic& refusal : catalogue_.topics)
      if (refusal.role == protocol::Role::refusal && refusal.board == catalogue_.topics[held.topic].board)
        for (const protocol::FrameLayout& layout : refusal.frames)
          parts.others.push_back(analysis::message_of(layout, protocol::Direction::sensor, refusal.priority,
                                                      held.period, {}, {}, bit_rate_));
    for (auto i = first; i < parts.others.size(); ++i) {
      parts.others[i].jitter = held.period.count();
      parts.others[i].deadline = analysis::unbounded;
    }
  }

  // --- monitors ---

  void read_monitors(const At& at) {
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

  // --- transitions ---

  void read_transitions(const At& at) {
    if (!is_list(at, "a list of transitions")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, R"({"from": "driving", "to": "stopped", "when": "obstacle"})")) continue;
      check_keys(item, {"from", "to", "when", "on_request", "cause", "precedence"});
      reflective::Transition transition;
      if (const auto to = require(item, "to", "a configuration")) transition.to = configuration(*to);
      std::string cause;
      const auto when = item.member("when");
      const auto on_request = item.member("on_request");
      const bool requested =
          on_request && is_kind(*on_request, Kind::boolean, "true") && on_request->node->truth;
      if (requested == when.has_value())
        tell(item, requested ? "both \"when\" and \"on_request\"" : "neither \"when\" nor \"on_request\"",
             "\"when\": a monitor, or \"on_request\": true");
      if (when) {
        transition.monitor = monitor(*when);
        cause = when->node->text;
      } else {
        cause = "on request";
      }
      if (const auto text = item.member("cause")) cause = line(*text, false);
      if (const auto of = item.member("precedence"))
        transition.precedence = static_cast<std::uint8_t>(integer(*of, 0, 255).value_or(0));
      const auto add = [&] {
        file_.transitions.push_back(transition);
        file_.transition_items.push_back({cause, place(item)});
      };
      const auto from = item.member("from");
      if (from && from->node->is(Kind::array)) {
        for (std::size_t k = 0; k < from->node->items.size(); ++k) {
          transition.from = configuration(from->item(k));
          add();
        }
        if (from->node->items.empty()) tell(*from, "an empty list", "configurations, or no \"from\" for any");
        continue;
      }
      if (from) transition.from = configuration(*from);
      add();
    }
  }
  [[nodiscard]] std::uint16_t monitor(const At& at) {
    const auto text = word(at, "the name of a monitor");
    if (!text) return none;
    std::vector<std::string> names;
    for (std::size_t m = 0; m < file_.monitor_items.size(); ++m) {
      names.push_back(file_.monitor_items[m].text);
      if (names.back() == *text) return static_cast<std::uint16_t>(m);
    }
    unknown(at, "monitor", *text, names);
    return none;
  }

  const protocol::Catalogue& catalogue_;
  std::uint32_t bit_rate_;
  OperatorFile& file_;
};

/// Once all is there: the views.
void close(OperatorFile& file, const protocol::Catalogue& catalogue) {
  for (const OperatorFile::Parts& parts : file.parts)
    file.configurations.push_back(
        {parts.of.text, parts.streams, parts.limits, parts.entry, parts.adaptations, parts.others});
  for (std::size_t c = 0; c < file.conditions.size(); ++c)
    file.conditions[c].name = file.condition_items[c].text;
  for (std::size_t m = 0; m < file.monitors.size(); ++m) {
    file.monitors[m].name = file.monitor_items[m].text;
    file.monitors[m].terms = file.terms[m];
  }
  for (std::size_t t = 0; t < file.transitions.size(); ++t)
    file.transitions[t].cause = file.transition_items[t].text;
  file.tables.name = file.name;
  file.tables.catalogue = &catalogue;
  file.tables.configurations = file.configurations;
  file.tables.conditions = file.conditions;
  file.tables.monitors = file.monitors;
  file.tables.transitions = file.transitions;
  file.tables.others = file.others;
}

}  // namespace

Loaded parse(std::string_view text, std::string_view file_name, const protocol::Catalogue& catalogue,
             std::uint32_t bit_rate) {
  static const spec::Schema schema{schema_text(), document};
  Loaded loaded;
  auto& problems = loaded.problems;
  const spec::Node root = spec::parse_json(text, file_name, problems, document);
  if (!spec::has_document(problems)) return loaded;
  auto file = std::make_unique<OperatorFile>();
  Reader{file_name, problems, catalogue, bit_rate, *file}.read(root);
  schema.validate(root, file_name, problems);
  if (problems.empty()) {
    close(*file, catalogue);
    report_mistakes(*file, file_name, problems);
    if (problems.empty() && !reflective::fits(file->tables, room))
      problems.push_back({std::string{file_name} + ":1: /", "it is too large",
                          "at most " + std::to_string(room.conditions) + " conditions, " +
                              std::to_string(room.monitors) + " monitors, and in a configuration " +
                              std::to_string(room.streams) + " streams, " + std::to_string(room.entry) +
                              " set points, " + std::to_string(room.limits) + " limits and " +
                              std::to_string(room.adaptations) + " adaptations"});
  }
  spec::sort_by_line(problems, file_name);
  if (problems.empty()) loaded.file = std::move(file);
  return loaded;
}

Loaded load(const std::string& file, const protocol::Catalogue& catalogue, std::uint32_t bit_rate) {
  Loaded loaded;
  const auto text = spec::read_document(file, "an operator", "examples/guard.operator.json", loaded.problems,
                                        max_operator_bytes);
  return text ? parse(*text, file, catalogue, bit_rate) : std::move(loaded);
}

}  // namespace ocm::cli::operate
