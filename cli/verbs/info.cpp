#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "ocm/j1939/identifier.hpp"

#include "cli/output/named_value.hpp"
#include "cli/shared/fitted.hpp"
#include "cli/shared/messages.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/command.hpp"
#include "cli/words/quantity.hpp"
#include "cli/words/value.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli {
namespace {

std::string number(base::Decimal decimal) {
  return std::string{base::to_text(decimal).view()};
}

/// A line of a table, or one of a frame's fields, which begins with more blanks.
template <class... Arguments>
void print_line(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  const std::string line = fmt::format(format, std::forward<Arguments>(arguments)...);
  print_fitted(line, line.starts_with("    ") ? 8 : 13);
}

/// "rpm is 3 or 5..7", for a field that is in some frames only.
std::string presence(const protocol::FrameLayout& layout, const protocol::Field& field) {
  if (field.selector >= layout.fields.size()) return {};
  std::string ranges;
  for (const auto& [first, last] : field.selected)
    ranges += fmt::format("{}{}", ranges.empty() ? "" : ", ",
                          first == last ? std::to_string(first) : fmt::format("{}..{}", first, last));
  return fmt::format("  when {} is {}", layout.fields[field.selector].name, ranges);
}

/// What is on no wire: by which law it follows.
void print_derived(const protocol::FrameLayout& layout, const protocol::Field& field) {
  const protocol::Law& law = *field.law;
  const std::string_view of = layout.fields[field.derived_from].name;
  if (field.uncertainty)
    return print_line("    {:<14} standard deviation of {} by the noise of {}, {}  [0, {}] {}\n", field.name,
                      layout.values()[static_cast<std::size_t>(&field - layout.values().data()) - 1].name, of,
                      number(law.noise), number(field.max), field.unit);
  print_line("    {:<14} derived: root of {} / ({} - {})  [{}, {}] {}\n", field.name, number(law.at_one), of,
             number(law.offset), number(field.min), number(field.max), field.unit);
}

void print_field(const protocol::FrameLayout& layout, const protocol::Field& field) {
  if (field.is_derived()) return print_derived(layout, field);
  const auto position = field.position;
  const std::string place =
      position.start % 8 == 0 && position.width % 8 == 0 && position.order == protocol::ByteOrder::little
          ? position.width == 8
                ? fmt::format("byte {}", position.start / 8)
                : fmt::format("bytes {}..{}", position.start / 8, (position.start + position.width) / 8 - 1)
          : fmt::format("bit {}, {} wide", position.start, position.width);
  const bool states = field.min != field.max;
  print_line("    {:<14} {:<14} {}{:<3} {:<3}  1 bit = {}{}{}  [{}, {}]{}{}{}\n", field.name, place,
             field.is_float()  ? 'f'
             : field.is_signed ? 'i'
                               : 'u',
             position.width,
             position.width <= 8                             ? ""
             : position.order == protocol::ByteOrder::little ? "LE"
                                                             : "BE",
             number(field.scale), field.unit.empty() ? "" : " ", field.unit,
             states             ? number(field.min)
             : field.is_float() ? "any"
                                : words::physical_text(field, field.raw_min),
             states             ? number(field.max)
             : field.is_float() ? "any"
                                : words::physical_text(field, words::greatest_raw(field)),
             field.unit.empty() ? "" : " ", field.unit, presence(layout, field));
  for (const auto& value : field.values)
    print_line(
        "      {} {:<6} {}\n", field.flags ? "bit" : "  =",
        field.is_signed ? std::to_string(value.raw) : std::to_string(static_cast<std::uint64_t>(value.raw)),
        value.name);
}

/// What the source says in its own words; its further lines begin with `indent` blanks.
std::string prose(std::string_view text, std::size_t indent) {
  std::string out;
  for (const char c : text) {
    if (c == '\r') continue;
    out += c;
    if (c == '\n') out.append(indent, ' ');
  }
  return printable(out);
}

/// A field's start value as it is sent, in its unit, with the name that it has.
std::string start_text(const protocol::Field& field, std::int64_t raw) {
  const bool plain = field.scale == base::Decimal{1, 0} && field.offset.digits == 0;
  std::string text = !field.is_float() ? words::physical_text(field, raw)
                     : plain && field.number == protocol::Number::float32
                         ? fmt::format("{}", static_cast<float>(field.unscaled(raw)))
                         : fmt::format("{}", field.value(raw));
  if (!field.unit.empty()) text.append(" ").append(field.unit);
  if (const std::string name = names_of(field, raw); !name.empty()) text += " (" + name + ')';
  return text;
}

void print_comment(std::string_view text) {
  if (!text.empty()) print_line("      comment   {}\n", prose(text, 16));
}

/// What the catalogue has not, because no frame needs it.
void print_facts(const protocol::Field& field, const spec::FieldModel& model) {
  if (model.start) print_line("      start     {}\n", start_text(field, *model.start));
  if (!model.receivers.empty()) print_line("      receivers {}\n", fmt::join(model.receivers, ", "));
  print_comment(model.description);
  for (const auto& [name, text] : model.attributes)
    print_line("      attribute {} = {}\n", name, prose(text, 16));
}

/// The model of a message; a catalogue has messages behind all topics, in the order of the model.
const spec::MessageModel& model_of(const spec::Spec& spec, const protocol::Topic& topic) {
  const auto& topics = spec.catalogue().topics;
  const auto from_end = static_cast<std::size_t>(topics.data() + topics.size() - &topic);
  const auto& messages = spec.model().messages;
  return messages[messages.size() - from_end];
}

void message(const spec::Spec& spec, const protocol::Topic& topic) {
  const protocol::Catalogue& catalogue = spec.catalogue();
  const spec::MessageModel& model = model_of(spec, topic);
  const auto& layout = topic.frames[0];
  const auto sender = catalogue.board_name(topic);
  const auto [by, extended, number] = layout.address;
  print_line("{} (message{}{}, id 0x{:0{}X})\n", topic.name, sender.empty() ? "" : " of ", sender, number,
             extended ? 8 : 3);
  if (by == protocol::Address::By::pgn) {
    const auto id = j1939::Identifier::decode(number);
    print_line("  J1939      parameter group {} (0x{:05X}), here at priority {} from source {}\n", id.pgn,
               id.pgn, id.priority, id.source);
  }
  if (!model.description.empty()) print_line("  comment    {}\n", prose(model.description, 13));
  if (!model.other_senders.empty())
    print_line("  senders    {}{}{}\n", sender, sender.empty() ? "" : ", ",
               fmt::join(model.other_senders, ", "));
  if (!topic.bus.empty()) print_line("  bus        {}\n", topic.bus);
  if (!model.send_type.empty()) print_line("  send type  {}\n", prose(model.send_type, 13));
  print_line("  period     {}\n", topic.cycle.count() != 0 ? words::to_text(topic.cycle) : "none is stated");
  if (topic.shortest_period.count() != 0)
    print_line("  distance   at least {}\n", words::to_text(topic.shortest_period));
  for (const auto& [name, text] : model.attributes)
    print_line("  attribute  {} = {}\n", name, prose(text, 13));
  print_line("  frame      {}{}\n", counted(layout.length, "byte"), layout.fd ? ", CAN FD" : "");
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    print_field(layout, layout.fields[i]);
    print_facts(layout.fields[i], model.fields[i]);
  }
  if (!topic.source.empty()) print_line("  source     {}\n", topic.source);
}

/// Of equal topics, or frames, a spec has one model: that of the one with this index, and whether it is the
/// first of them.
template <class Model>
std::pair<const Model&, bool> model_at(const std::vector<Model>& models, std::size_t index) {
  auto model = models.begin();
  for (; index >= model->count; ++model) index -= model->count;
  return {*model, index == 0};
}

/// A topic's frames; what the spec says of fields once for equal ones.
void print_frames(const protocol::Topic& topic, const spec::TopicModel& of) {
  for (std::size_t i = 0; i < topic.frames.size(); ++i) {
    const protocol::FrameRef frame{&topic, static_cast<std::uint8_t>(i)};
    const auto& layout = frame.layout();
    const auto [model, is_first] = model_at(of.frames, i);
    print_line("  frame      {}{}id 0x{:02X}, on the bus {:03X} at {} priority, DLC {}\n", layout.name,
               layout.name.empty() ? "" : ": ", layout.id.value,
               protocol::identifier_of(frame, topic.priority), name(topic.priority), layout.length);
    if (is_first && !model.description.empty()) print_line("             {}\n", prose(model.description, 13));
    std::size_t fields = 0, derived = 0;
    for (const protocol::Field& value : layout.values()) {
      print_field(layout, value);
      if (!is_first) continue;
      if (!value.is_derived())
        print_comment(model.fields[fields++].description);
      else if (!value.uncertainty)
        print_comment(model.derived[derived++].description);
    }
  }
}

void info(Session& session, const std::string& word) {
  const auto& catalogue = session.catalogue();
  const protocol::Topic* topic = words::find_topic(catalogue, word);
  for (const auto& candidate : catalogue.topics)
    if (topic == nullptr && words::is_in_group(candidate, word)) topic = &candidate;
  if (topic == nullptr) {
    fail({"info: no topic '" + word + "'", words::topic_suggestion(catalogue, word)}, exit_usage);
  }
  const bool sensor = topic->kind == protocol::Kind::sensor;
  if (topic->is_message()) {
    for (const auto& same : catalogue.topics)  // on several interfaces, or twice in a file
      if (same.is_message() && same.name == topic->name) message(session.spec(), same);
    return;
  }
  print_line("{} ({} of {}, id 0x{:02X})\n", topic->name, name(topic->kind), catalogue.board_name(*topic),
             topic->id.value);
  if (!topic->group.empty()) {
    const auto is_alike = [topic](const protocol::Topic& other) { return other.group == topic->group; };
    const auto& topics = catalogue.topics;
    print_line("  group      {} to {}, which are alike\n",
               std::find_if(topics.begin(), topics.end(), is_alike)->name,
               std::find_if(topics.rbegin(), topics.rend(), is_alike)->name);
  }
  const auto index = static_cast<std::size_t>(topic - catalogue.topics.data());
  const spec::TopicModel& model = model_at(session.spec().model().topics, index).first;
  if (!model.description.empty()) print_line("  comment    {}\n", prose(model.description, 13));
  if (!topic->aliases.empty()) {
    print_line("  aliases    {}\n", fmt::join(topic->aliases, " "));
  }
  print_line("  priority   {} unless asked otherwise\n", name(topic->priority));
  if (sensor) {
    const bool known = topic->shortest_period.count() != 0;
    print_line("  period     {} unless asked otherwise{}\n", words::to_text(topic->period),
               known ? "; the part samples every " + words::to_text(topic->shortest_period) : "");
    if (topic->deadline.count() != 0) print_line("  deadline   {}\n", words::to_text(topic->deadline));
    if (topic->jitter.count() != 0) print_line("  jitter     {}\n", words::to_text(topic->jitter));
  } else if (topic->timeout.count() != 0) {
    print_line("  timeout    at rest {} after the last set point\n", words::to_text(topic->timeout));
  }
  print_frames(*topic, model);
  print_line("  source     {}\n", topic->source);
}

}  // namespace

void declare_info(Verb verb, Session& session, int&) {
  verb.describe("all about one topic: frames, fields, units, ranges, where the facts come from", look_group,
                "  amiroctl info gyro\n"
                "  amiroctl info motors");
  const auto topic = std::make_shared<std::string>();
  verb.add_option("topic", *topic, "name, alias or id").required().type_name("TOPIC");
  verb.callback([topic, &session] { info(session, *topic); });
}

}  // namespace ocm::cli
