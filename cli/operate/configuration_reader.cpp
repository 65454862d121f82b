#include "cli/operate/configuration_reader.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include "ocm/client/command.hpp"

#include "cli/words/value.hpp"

namespace ocm::cli::operate {
namespace {

using reflective::none;
using spec::At;
using spec::Kind;

constexpr std::string_view commanding[] = {"behave", "drive", "led", "replay", "run", "set", "travel"};

class ConfigurationReader : private ValueReader {
 public:
  explicit ConfigurationReader(const Reading& reading)
      : ValueReader(reading), bit_rate_(reading.bit_rate), file_(reading.file) {}

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

  void read_others(const At& at) {
    if (!is_list(at, "a list of streams and set points of other programs")) return;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const auto stream = read_stream(at.item(i), Takes::anything, false);
      if (stream.topic == none || stream.period.count() <= 0) continue;
      file_.stated_others.push_back(stream);
      add_frames(stream, file_.others);
    }
  }
  void count_others(OperatorFile::Parts& parts) const {
    const auto is_stated = [&](std::uint16_t topic) {
      const auto& stated = file_.stated_others;
      return std::any_of(stated.begin(), stated.end(),
                         [topic](const auto& stream) { return stream.topic == topic; });
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

 private:
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
      } else if (const auto read = duration(*of)) {
        stream.period = *read;
        if (read->count() == 0) tell(*of, "a period of 0", "a period above 0, such as \"50ms\"");
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

  std::uint32_t bit_rate_;
  OperatorFile& file_;
};

}  // namespace

void read_others(const spec::At& at, const Reading& reading) {
  ConfigurationReader{reading}.read_others(at);
}

void read_configurations(const spec::At& at, const Reading& reading) {
  ConfigurationReader{reading}.read_configurations(at);
}

void count_others(const Reading& reading) {
  const ConfigurationReader reader{reading};
  for (auto& parts : reading.file.parts) reader.count_others(parts);
}

}  // namespace ocm::cli::operate
