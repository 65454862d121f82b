#include <algorithm>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "cli/shared/json.hpp"
#include "cli/verbs/verbs.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

std::string aliases_of(const protocol::Topic& topic) {
  std::string text;
  for (const auto alias : topic.aliases) text += (text.empty() ? "" : ", ") + std::string{alias};
  return text;
}

void list_json(const protocol::Catalogue& catalogue) {
  for (const auto& topic : catalogue.topics) {
    Json line;
    line["topic"] = topic.name;
    line["aliases"] = topic.aliases;
    line["id"] = fmt::format("0x{:02X}", topic.id.value);
    line["kind"] = topic.kind == protocol::Kind::sensor ? "sensor" : "actuator";
    line["board"] = catalogue.boards[topic.board].name;
    line["frames"] = topic.frames.size();
    if (topic.kind == protocol::Kind::sensor) line["period_ns"] = topic.period.duration().count();
    fmt::print("{}\n", line.line());
  }
}

void list_table(const protocol::Catalogue& catalogue) {
  std::size_t name_width = 5;
  std::size_t alias_width = 7;
  std::size_t board_width = 5;
  for (const auto& topic : catalogue.topics) {
    name_width = std::max(name_width, topic.name.size());
    alias_width = std::max(alias_width, aliases_of(topic).size());
    board_width = std::max(board_width, catalogue.boards[topic.board].name.size());
  }
  fmt::print("{:<{}}  {:<{}}  {:<4}  {:<8}  {:<{}}  {:>6}  {:>7}\n", "TOPIC", name_width, "ALIASES",
             alias_width, "ID", "KIND", "BOARD", board_width, "FRAMES", "PERIOD");
  for (const auto& topic : catalogue.topics) {
    const bool sensor = topic.kind == protocol::Kind::sensor;
    fmt::print("{:<{}}  {:<{}}  0x{:02X}  {:<8}  {:<{}}  {:>6}  {:>7}\n", topic.name, name_width,
               aliases_of(topic), alias_width, topic.id.value, sensor ? "sensor" : "actuator",
               catalogue.boards[topic.board].name, board_width, topic.frames.size(),
               sensor ? words::to_text(topic.period) : "-");
  }
}

}  // namespace

void add_list(Verb app, Session& session, int&) {
  auto verb = app.add_verb("list", "the robot's topics", look_group,
                           "  amiroctl list\n"
                           "  amiroctl list --json | jq -r .topic\n"
                           "  amiroctl --spec other.json list");
  const auto json = std::make_shared<bool>(false);
  verb.add_flag("--json", *json, "an object a topic");
  verb.callback(
      [json, &session] { *json ? list_json(session.catalogue()) : list_table(session.catalogue()); });
}

}  // namespace ocm::cli
