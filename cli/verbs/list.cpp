#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "ocm/j1939/identifier.hpp"

#include "cli/shared/fitted.hpp"
#include "cli/shared/json.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

std::string aliases_of(const protocol::Topic& topic) {
  std::string text;
  for (const auto alias : topic.aliases) text += (text.empty() ? "" : ", ") + std::string{alias};
  return text;
}

std::optional<std::uint32_t> pgn_of(const protocol::Topic& topic) {
  const auto& address = topic.frames[0].address;
  if (address.by != protocol::Address::By::pgn) return std::nullopt;
  return j1939::pgn_of(address.number);
}

/// A topic's number, or a message's identifier with as many digits as its format has.
std::string id_of(const protocol::Topic& topic) {
  if (!topic.is_message()) return fmt::format("0x{:02X}", topic.id.value);
  const auto& address = topic.frames[0].address;
  return fmt::format("0x{:0{}X}", address.number, address.extended ? 8 : 3);
}

/// By what its frames are known: of a parameter group that is not the whole identifier; as --pgn takes it.
std::string known_by(const protocol::Topic& topic) {
  const auto pgn = pgn_of(topic);
  return pgn ? fmt::format("PGN 0x{:04X}", *pgn) : id_of(topic);
}

/// Of its frames: "8", "8x2" are eight with two bytes each, "8+6" two; "64 FD" one of CAN FD.
std::string bytes_of(const protocol::Topic& topic) {
  std::string text;
  for (std::size_t begin = 0, end = 0; begin < topic.frames.size(); begin = end) {
    while (end < topic.frames.size() && topic.frames[end].length == topic.frames[begin].length) ++end;
    if (begin > 0) text += '+';
    if (end - begin > 1) text += fmt::format("{}x", end - begin);
    text += fmt::format("{}", topic.frames[begin].length);
  }
  return text + (topic.frames[0].fd ? " FD" : "");
}

std::string period_of(const protocol::Topic& topic) {
  if (topic.kind == protocol::Kind::sensor) return words::to_text(topic.period);
  return topic.cycle.count() != 0 ? words::to_text(topic.cycle) : "-";
}

void list_json(const protocol::Catalogue& catalogue) {
  for (const auto& topic : catalogue.topics) {
    Json line;
    line["topic"] = topic.name;
    line["aliases"] = topic.aliases;
    line["id"] = id_of(topic);
    line["kind"] = name(topic.kind);
    line["board"] = catalogue.board_name(topic);
    if (!topic.bus.empty()) line["bus"] = topic.bus;
    line["frames"] = topic.frames.size();
    line["bytes"] = Json::array();
    for (const auto& frame : topic.frames) line["bytes"].push_back(frame.length);
    if (topic.frames[0].fd) line["fd"] = true;
    if (const auto pgn = pgn_of(topic)) line["pgn"] = *pgn;
    if (const auto period = topic.usual_period(); period.count() != 0) line["period_ns"] = period.count();
    fmt::print("{}\n", line.line());
  }
}

void list_table(const protocol::Catalogue& catalogue) {
  std::size_t name_width = 5;
  std::size_t bus_width = 3;
  bool has_aliases = false;
  std::size_t board_width = 5;
  std::size_t id_width = 4;
  std::size_t bytes_width = 5;
  std::size_t period_width = 6;
  for (const auto& topic : catalogue.topics) {
    name_width = std::max(name_width, topic.name.size());
    bus_width = std::max(bus_width, topic.bus.size());
    has_aliases = has_aliases || !topic.aliases.empty();
    board_width = std::max(board_width, catalogue.board_name(topic).size());
    id_width = std::max(id_width, known_by(topic).size());
    bytes_width = std::max(bytes_width, bytes_of(topic).size());
    period_width = std::max(period_width, period_of(topic).size());
  }
  const bool has_buses = catalogue.has_buses();
  // What has no fixed width comes last, so that a narrow terminal breaks no row that fits without it.
  const auto print = [&](std::string_view bus, std::string_view aliases, const auto&... columns) {
    std::string line = fmt::format("{:<{}}  {:<{}}  {:<8}  {:<{}}  {:>{}}  {:>{}}", columns...);
    if (has_buses) line += fmt::format("  {:<{}}", bus, bus_width);
    line += fmt::format("  {}", aliases);
    line.erase(line.find_last_not_of(' ') + 1);
    print_fitted(line + '\n', 4);
  };
  print("BUS", has_aliases ? "ALIAS" : "", "TOPIC", name_width, "ID", id_width, "KIND", "BOARD", board_width,
        "BYTES", bytes_width, "PERIOD", period_width);
  for (const auto& topic : catalogue.topics)
    print(topic.bus, aliases_of(topic), topic.name, name_width, known_by(topic), id_width, name(topic.kind),
          catalogue.board_name(topic), board_width, bytes_of(topic), bytes_width, period_of(topic),
          period_width);
}

}  // namespace

void declare_list(Verb verb, Session& session, int&) {
  verb.describe("the robot's topics", look_group,
                "  amiroctl list\n"
                "  amiroctl list --json | jq -r .topic\n"
                "  amiroctl --spec other.json list");
  const auto json = std::make_shared<bool>(false);
  verb.add_flag("--json", *json, "an object a topic");
  verb.callback(
      [json, &session] { *json ? list_json(session.catalogue()) : list_table(session.catalogue()); });
}

}  // namespace ocm::cli
