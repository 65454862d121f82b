#include "cli/watch/choice.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "ocm/base/text.hpp"
#include "ocm/j1939/identifier.hpp"

#include "cli/shared/messages.hpp"
#include "cli/watch/chosen_topics.hpp"
#include "cli/words/suggestion.hpp"

namespace ocm::cli {
namespace {

bool contains(const std::vector<const protocol::Topic*>& topics, const protocol::Topic* topic) {
  return std::find(topics.begin(), topics.end(), topic) != topics.end();
}

/// What a board sends: its sensors' data, or its messages.
void add_sent_by(std::string_view verb, const protocol::Catalogue& catalogue, const std::string& sender,
                 std::vector<const protocol::Topic*>& topics) {
  const auto known = [&](const protocol::Board& board) { return board.name == sender; };
  if (std::none_of(catalogue.boards.begin(), catalogue.boards.end(), known)) {
    std::vector<std::string_view> names;
    for (const auto& board : catalogue.boards) names.push_back(board.name);
    fail({fmt::format("{}: --sender {}: no such board", verb, sender),
          names.empty() ? "the spec names no board" : words::suggestion(sender, names)},
         exit_usage);
  }
  for (const auto& topic : catalogue.topics)
    if (catalogue.board_name(topic) == sender && topic.kind != protocol::Kind::actuator)
      topics.push_back(&topic);
}

can_filter filter_of_group(std::string_view verb, const std::string& text) {
  std::string_view digits = text;
  if (digits.starts_with("0x")) digits.remove_prefix(2);
  const auto pgn = base::parse_unsigned(digits, 16);
  if (!pgn || *pgn > 0x3'FFFF) {
    const auto decimal = base::parse_unsigned(text, 10);  // as the standard, and `list`, write it
    fail({fmt::format("{}: --pgn {}: not a parameter group", verb, text),
          decimal && *decimal <= 0x3'FFFF
              ? fmt::format("write its number in hexadecimal: {} is {:04X}", text, *decimal)
              : "write its number in hexadecimal, such as F004; at most 3FFFF"},
         exit_usage);
  }
  const auto group = static_cast<std::uint32_t>(*pgn);
  if (j1939::is_pdu1(group) && (group & 0xFF) != 0)
    fail({fmt::format("{}: --pgn {}: its last byte is a destination, which is no part of the group", verb,
                      text),
          fmt::format("write {:05X}", group & 0x3'FF00)},
         exit_usage);
  return group_filter(group);
}

/// A field, or one of that name on each of several interfaces.
bool is_one_an_interface(std::span<const ChosenField> fields) {
  for (std::size_t i = 0; i < fields.size() && fields.size() > 1; ++i) {
    const std::string_view bus = fields[i].topic->bus;
    if (bus.empty() || fields[i].name != fields[0].name) return false;
    for (std::size_t j = 0; j < i; ++j)
      if (fields[j].topic->bus == bus) return false;
  }
  return true;
}

transport::Failure too_many_fields(const std::string& beginning, std::string_view word,
                                   std::span<const ChosenField> fields) {
  std::string what = beginning + fmt::format("'{}' has {} fields", word, fields.size());
  const bool one_name = std::all_of(fields.begin(), fields.end(),
                                    [&](const ChosenField& field) { return field.name == fields[0].name; });
  if (!one_name) return {what, fmt::format("name one, such as {}", fields[0].name)};
  return {what + " of that name", "several messages of the spec have that name: rename one"};
}

}  // namespace

void add_choice_options(Verb verb, ChoiceOptions& options) {
  verb.add_option("--sender", options.senders, "only what this board sends; repeatable")
      .type_name("BOARD")
      .one_a_mention();
  verb.add_option("--filter", options.filters,
                  "only frames with id & mask, hexadecimal as candump has it: 600:700; repeatable")
      .type_name("ID:MASK")
      .one_a_mention();
  verb.add_option("--pgn", options.groups, "only this parameter group of J1939, hexadecimal; repeatable")
      .type_name("PGN")
      .one_a_mention();
  verb.add_option("--where", options.conditions,
                  "only while this holds, such as 'Engine.Speed>3000'; repeatable, all must")
      .type_name("CONDITION")
      .one_a_mention();
}

Choice::Choice(std::string_view verb, const protocol::Catalogue& catalogue, const ChoiceOptions& options)
    : verb_(verb), catalogue_(&catalogue), topics_(chosen_topics(verb, catalogue, options.topics)) {
  for (const std::string& sender : options.senders) add_sent_by(verb, catalogue, sender, topics_);
  for (const std::string& text : options.filters) {
    const auto filter = parse_filter(text);
    if (!filter) fail({fmt::format("{}: {}", verb, filter.error.what), filter.error.remedy}, exit_usage);
    filters_.push_back(*filter);
  }
  for (const std::string& text : options.groups) filters_.push_back(filter_of_group(verb, text));
  read_conditions(verb, catalogue, options.conditions);
  // A sender that sends nothing is a choice, too.
  everything_ = topics_.empty() && filters_.empty() && conditions_.empty() && options.senders.empty();
  if (everything_) return;
  index_ = client::InterfaceIndexes{catalogue};
  if (topics_.empty() && filters_.empty() && options.senders.empty())
    for (const Held& held : conditions_)
      for (const HeldField& each : held.fields) topics_.push_back(each.of.topic);
}

void Choice::expect_any_of(const std::vector<std::string>& fields) const {
  const auto selection = Selection::of(*catalogue_, fields);
  if (!selection || selection->everything() || topics_.empty() || !filters_.empty()) return;
  const auto chosen = selection->fields();
  if (std::any_of(chosen.begin(), chosen.end(),
                  [this](const ChosenField& field) { return contains(topics_, field.topic); }))
    return;
  fail({fmt::format("{}: --field {}, and what is chosen is {}", verb_, chosen[0].name, topics_[0]->name),
        fmt::format("choose {}, too, or a field that `amiroctl info {}` shows", chosen[0].topic->name,
                    topics_[0]->name)},
       exit_usage);
}

void Choice::read_conditions(std::string_view verb, const protocol::Catalogue& catalogue,
                             const std::vector<std::string>& conditions) {
  for (const std::string& text : conditions) {
    const std::string beginning = fmt::format("{}: --where '{}': ", verb, text);
    const auto parts = words::split_condition(text);
    if (!parts)
      fail({beginning + "not a condition",
            "write a field, =, !=, <, <=, > or >=, and a value: 'Engine.Speed>3000'"},
           exit_usage);
    const std::vector<std::string> word{std::string{parts->field}};
    const auto selection = Selection::of(catalogue, word);
    if (!selection) fail({beginning + selection.error.what, selection.error.remedy}, exit_usage);
    const auto fields = selection->fields();
    if (!is_one_an_interface(fields)) fail(too_many_fields(beginning, parts->field, fields), exit_usage);
    Held held;
    for (const ChosenField& field : fields) {
      auto condition = words::Condition::of(*field.field, parts->comparison, parts->value);
      const std::string where = fields.size() == 1 ? "" : fmt::format(" on {}", field.topic->bus);
      if (!condition)
        fail({beginning + fmt::format("'{}' is no value of it{}", parts->value, where), condition.error},
             exit_usage);
      held.fields.push_back({field, std::move(*condition)});
    }
    conditions_.push_back(std::move(held));
  }
}

void Choice::on_interface(std::uint16_t number, std::string_view name) {
  index_.name(number, name);
  if (interfaces_.size() <= number) interfaces_.resize(number + std::size_t{1});
  if (interfaces_[number] != name) interfaces_[number] = name;
}

bool Choice::holds(const Held& held, std::uint16_t interface) const {
  bool any = false;
  for (const HeldField& each : held.fields) {
    if (held.fields.size() > 1 && interface < interfaces_.size() &&
        each.of.topic->bus == interfaces_[interface])
      return each.holds;
    any = any || each.holds;
  }
  return any;
}

bool Choice::is_chosen(const log::Entry& entry) {
  if (is_packet(entry)) return true;  // what it completes, `shows` is asked
  client::Subject subject = index_.of(entry.interface).subject(entry.id, entry.format);
  if (subject.topic != nullptr && !subject.topic->is_message() && entry.is_fd())
    subject = {};  // no topic has frames of CAN FD
  return conditions_hold(subject, entry.bytes(), entry.interface) &&
         is_meant(subject.topic, entry.id, entry.format);
}

bool Choice::is_chosen_packet(const log::Entry& entry, const client::Reception& reception) {
  const auto* const message = reception.transported;
  if (message == nullptr) {
    const client::Subject own = index_.of(entry.interface).subject(entry.id, entry.format);
    return conditions_hold(own, entry.bytes(), entry.interface) &&
           is_meant(own.topic, entry.id, entry.format);
  }
  return conditions_hold({reception.topic, reception.frame}, message->data, entry.interface) &&
         (is_meant(reception.topic, message->id.encode(), can::Format::extended) ||
          is_meant(nullptr, entry.id, entry.format));
}

bool Choice::conditions_hold(const client::Subject& subject, std::span<const std::uint8_t> data,
                             std::uint16_t interface) {
  bool all = true;
  for (Held& held : conditions_) {
    for (auto& [of, condition, field_holds] : held.fields) {
      // A request says nothing of it; another frame of a topic belongs to the same sample.
      if (subject.topic == of.topic && subject.is_request()) all = false;
      if (!subject.frame || &subject.frame.layout() != of.layout) continue;
      const bool has_field = of.layout->accepts(data.size()) && of.layout->has(*of.field, data);
      if (has_field) field_holds = condition.holds(of.field->raw(data));
      all = all && has_field;
    }
    all = all && holds(held, interface);
  }
  return all;
}

bool Choice::is_meant(const protocol::Topic* topic, std::uint32_t id, can::Format format) const {
  return (topic != nullptr && contains(topics_, topic)) ||
         (!filters_.empty() && passes(id, format, filters_));
}

void Choice::subscribe(transport::Bus& bus, bool commands) const {
  if (everything_) return;
  std::vector<const protocol::Topic*> looked_at = topics_;
  for (const Held& held : conditions_)
    for (const HeldField& each : held.fields) looked_at.push_back(each.of.topic);
  Filters filters = filters_for(looked_at, commands);
  filters.insert(filters.end(), filters_.begin(), filters_.end());
  const auto simple = bus_filters(filters);
  if (!simple || simple->empty()) return;  // this program filters, then
  if (const auto subscribed = bus.subscribe(*simple); !subscribed) fail(subscribed.error);
}

}  // namespace ocm::cli
