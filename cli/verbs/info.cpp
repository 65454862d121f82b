#include <memory>
#include <string>

#include <fmt/format.h>

#include "cli/verbs/verbs.hpp"
#include "cli/words/command.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

std::string number(base::Decimal decimal) {
  return std::string{base::to_text(decimal).view()};
}

std::string bound(const protocol::Field& field, std::int64_t raw) {
  const auto physical = field.physical(raw);
  return physical ? number(*physical) : std::to_string(raw);
}

void print_field(const protocol::Field& field) {
  const auto position = field.position;
  const std::string place =
      position.start % 8 == 0 && position.width % 8 == 0 && position.order == protocol::ByteOrder::little
          ? position.width == 8
                ? fmt::format("byte {}", position.start / 8)
                : fmt::format("bytes {}..{}", position.start / 8, (position.start + position.width) / 8 - 1)
          : fmt::format("bit {}, {} wide", position.start, position.width);
  fmt::print("    {:<14} {:<14} {}{:<3} {:<3}  1 bit = {}{}{}  [{}, {}]{}{}\n", field.name, place,
             field.is_signed ? 'i' : 'u', position.width,
             position.width <= 8                             ? ""
             : position.order == protocol::ByteOrder::little ? "LE"
                                                             : "BE",
             number(field.scale), field.unit.empty() ? "" : " ", field.unit, bound(field, field.raw_min),
             bound(field, field.raw_max), field.unit.empty() ? "" : " ", field.unit);
  for (const auto& value : field.values)
    fmt::print("      {} {:<6} {}\n", field.flags ? "bit" : "  =", value.raw, value.name);
}

void info(const protocol::Catalogue& catalogue, const std::string& word) {
  const protocol::Topic* topic = words::find_topic(catalogue, word);
  for (const auto& candidate : catalogue.topics)
    if (topic == nullptr && words::is_in_group(candidate, word)) topic = &candidate;
  if (topic == nullptr) {
    fail({"info: no topic '" + word + "'", words::topic_suggestion(catalogue, word)}, exit_usage);
  }
  const bool sensor = topic->kind == protocol::Kind::sensor;
  const auto& board = catalogue.boards[topic->board];
  fmt::print("{} ({} of {}, id 0x{:02X})\n", topic->name, sensor ? "sensor" : "actuator", board.name,
             topic->id.value);
  if (!topic->aliases.empty()) {
    fmt::print("  aliases   ");
    for (const auto alias : topic->aliases) fmt::print(" {}", alias);
    fmt::print("\n");
  }
  fmt::print("  priority   {} unless asked otherwise\n", name(topic->priority));
  if (sensor) {
    fmt::print("  period     {} unless asked otherwise; the part samples every {}\n",
               words::to_text(topic->period), words::to_text(topic->shortest_period));
    if (topic->deadline.count() != 0) fmt::print("  deadline   {}\n", words::to_text(topic->deadline));
    if (topic->jitter.count() != 0) fmt::print("  jitter     {}\n", words::to_text(topic->jitter));
  } else if (topic->timeout.count() != 0) {
    fmt::print("  timeout    at rest {} after the last set point\n", words::to_text(topic->timeout));
  }
  for (const auto& layout : topic->frames) {
    const auto direction = sensor ? protocol::Direction::sensor : protocol::Direction::command;
    fmt::print("  frame      {}{}id 0x{:02X}, on the bus {:03X} at medium priority, DLC {}\n", layout.name,
               layout.name.empty() ? "" : ": ", layout.id.value,
               protocol::Identifier{direction, protocol::default_priority, layout.id}.encode(), layout.dlc);
    for (const auto& field : layout.fields) print_field(field);
  }
  fmt::print("  source     {}\n", topic->source);
}

}  // namespace

void add_info(Verb app, Session& session, int&) {
  auto verb = app.add_verb(
      "info", "all about one topic: frames, fields, units, ranges, where the facts come from", look_group,
      "  amiroctl info gyro\n"
      "  amiroctl info motors");
  const auto topic = std::make_shared<std::string>();
  verb.add_option("topic", *topic, "name, alias or id").required().type_name("TOPIC");
  verb.callback([topic, &session] { info(session.catalogue(), *topic); });
}

}  // namespace ocm::cli
