#include "cli/operate/value_reader.hpp"

#include <utility>

#include "ocm/base/decimal.hpp"

#include "cli/output/selection.hpp"
#include "cli/words/quantity.hpp"
#include "cli/words/topics.hpp"
#include "cli/words/value.hpp"

namespace ocm::cli::operate {

using reflective::none;
using spec::Kind;

std::optional<base::Duration> ValueReader::duration(const At& at, base::Duration longest) {
  const auto read = NodeReader::duration(at);
  if (!read || *read <= longest) return read;
  const std::string most = spec::quoted(words::to_text(longest));
  tell(at, spec::quoted(at.node->text) + " is too long", "at most " + most);
  return std::nullopt;
}

base::Duration ValueReader::time(const At& object, std::string_view key, std::string_view remedy) {
  const auto at = require(object, key, remedy);
  return at ? duration(*at, longest_analysed).value_or(base::Duration{}) : base::Duration{};
}

std::optional<std::string> ValueReader::word(const At& at, std::string_view remedy) {
  if (!is_kind(at, Kind::string, remedy)) return std::nullopt;
  return at.node->text;
}

bool ValueReader::is_list(const At& at, std::string_view remedy) {
  return is_kind(at, Kind::array, remedy);
}

std::uint16_t ValueReader::topic(const At& at, Takes takes) {
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

std::optional<FieldRef> ValueReader::field(const At& at, const std::string& text) {
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
  // Else each frame without it would make its condition unknown, and the proof would take the period of all
  // frames for that of the field.
  if (chosen.field->selector != protocol::no_selector) {
    tell(at,
         spec::quoted(text) + " is in some frames of " + std::string{chosen.topic->name} +
             " only: when it comes is not known",
         "a field that is in all of them");
    return std::nullopt;
  }
  return FieldRef{static_cast<std::uint16_t>(chosen.topic - catalogue_.topics.data()),
                  static_cast<std::uint16_t>(chosen.layout - chosen.topic->frames.data()),
                  chosen.field->is_derived()
                      ? chosen.field->derived_from
                      : static_cast<std::uint16_t>(chosen.field - chosen.layout->values().data()),
                  chosen.field};
}

std::optional<FieldRef> ValueReader::field(const At& object, std::string_view key, std::string_view remedy) {
  const auto at = require(object, key, remedy);
  if (!at) return std::nullopt;
  const auto text = word(*at, remedy);
  return text ? field(*at, *text) : std::nullopt;
}

std::string ValueReader::measured(const FieldRef& of) const {
  const auto& topic = catalogue_.topics[of.topic];
  const auto& layout = topic.frames[of.frame];
  std::string name{topic.name};
  for (const std::string_view part : {layout.name, layout.fields[of.field].name})
    if (!part.empty()) name.append(".").append(part);
  return spec::quoted(name);
}

std::optional<std::int64_t> ValueReader::value(const At& at, const protocol::Field& of) {
  const auto text = word(at, words::detail::takes(of));
  if (!text) return std::nullopt;
  const auto raw = words::parse_typed_value(of, *text);
  if (raw) return *raw;
  tell(at, raw.error.substr(0, raw.error.find(": ")),
       raw.error.find(": ") == std::string::npos ? words::detail::takes(of)
                                                 : raw.error.substr(raw.error.find(": ") + 2));
  return std::nullopt;
}

std::optional<std::int64_t> ValueReader::distance(const At& at, const protocol::Field& of) {
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
  if (!raw || number->digits <= 0) {
    tell(at, spec::quoted(*text) + " is no distance of two values",
         unit + " above 0, such as \"1" + std::string{of.unit} + "\"");
    return std::nullopt;
  }
  const auto back = base::multiply({*raw, 0}, step);
  return back && base::compare(*back, *number) < 0 ? *raw + 1 : *raw;
}

void ValueReader::unknown(const At& at, std::string_view what, const std::string& text,
                          const std::vector<std::string>& names) {
  const std::string near = spec::nearest_name(text, names);
  tell(at, "there is no " + std::string{what} + " " + spec::quoted(text),
       !near.empty()   ? "did you mean " + spec::quoted(near) + "?"
       : names.empty() ? "add it to " + std::string{what} + "s"
                       : "one of " + spec::list_of(names));
}

}  // namespace ocm::cli::operate
