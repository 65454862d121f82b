#include "cli/serve/commands.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/serve/foxglove.hpp"
#include "cli/words/command.hpp"
#include "generator/spec/json.hpp"

namespace ocm::cli::serve {
namespace {

using spec::Node;
using Parsed = base::Result<client::Command, std::string>;

base::Result<Node, std::string> read_object(std::string_view payload) {
  static constexpr spec::Document document{"a message", "its fields", "the channel's schema", 3,
                                           foxglove::longest_message};
  if (payload.find_first_not_of(" \t\r\n") == std::string_view::npos)
    return std::string{"an empty message: expected an object of fields, such as {\"x\":0.1}"};
  std::vector<spec::Problem> problems;
  Node node = spec::parse_json(payload, "message", problems, document);
  if (!problems.empty()) return "no JSON: " + problems.front().what;
  if (!node.is(Node::Kind::object)) return std::string{"no object of fields, such as {\"x\":0.1}"};
  base::Result<Node, std::string> result;
  result.value = std::move(node);
  return result;
}

Parsed parse_words(const protocol::Catalogue& catalogue, const std::vector<std::string>& words) {
  const std::vector<std::string_view> line{words.begin(), words.end()};
  auto command = words::CommandParser{catalogue}.parse_line(line);
  if (!command)
    return command.error.remedy.empty() ? command.error.what
                                        : fmt::format("{}; {}", command.error.what, command.error.remedy);
  if (command->broadcast)
    return fmt::format("{} takes several frames, at times of their own: `amiroctl set` sends it",
                       command->broadcast->message->name);
  return std::move(command.value);
}

Parsed line_command(const protocol::Catalogue& catalogue, const Node& object) {
  const Node* const line = object.find("line");
  if (line == nullptr || !line->is(Node::Kind::string))
    return fmt::format(R"({} takes a line, such as {{"line":"publish gyro 50ms"}})", line_topic);
  std::vector<std::string> words;
  for (std::string_view rest = line->text; !rest.empty();) {
    const auto end = std::min(rest.find(' '), rest.size());
    if (end != 0) words.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  auto command = parse_words(catalogue, words);
  if (command && (command->hold || command->repeat))
    return std::string{"a line here is sent once; to drive, publish set points on the channel of the motors"};
  return command;
}

/// What a field cannot be: JSON has more kinds of values than fields have.
std::string wrong_kind(const protocol::Topic& topic, const Node::Member& member) {
  const auto& fields = topic.frames.front().fields;
  const auto field = std::find_if(fields.begin(), fields.end(),
                                  [&](const protocol::Field& each) { return each.name == member.name; });
  const bool has_unit = field != fields.end() && !field->unit.empty();
  const Node& value = member.node;
  if (value.is(Node::Kind::number) || value.is(Node::Kind::string) ||
      (value.is(Node::Kind::boolean) && !has_unit))
    return {};
  return fmt::format(R"({}: expected a number{}, such as {{"{}":0}}, and got {})", member.name,
                     has_unit ? " in " + std::string{field->unit} : "", member.name,
                     value.is(Node::Kind::null)      ? "null"
                     : value.is(Node::Kind::boolean) ? (value.truth ? "true" : "false")
                                                     : spec::describe(value.kind));
}

/// A number as a command's words have it: with the unit that the spec says.
std::string value_text(const protocol::Topic& topic, std::string_view name, const Node& value) {
  std::string text = value.is(Node::Kind::boolean) ? (value.truth ? "1" : "0") : value.text;
  if (!value.is(Node::Kind::number) || topic.is_message()) return text;
  // JSON may write 1e-3, which no command does.
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc{} && text.find_first_of("eE") != std::string::npos)
    text = fmt::format("{:.9f}", number);
  for (const protocol::Field& field : topic.frames.front().fields)
    if (field.name == name) text += field.unit;
  return text;
}

}  // namespace

Parsed command_of(const protocol::Catalogue& catalogue, std::string_view topic, std::string_view payload) {
  const auto object = read_object(payload);
  if (!object) return object.error;
  if (topic == line_topic) return line_command(catalogue, *object);
  // One bus has no interfaces in its topics: "/can0/motors" is of another server.
  const std::string_view name = topic.starts_with('/') ? topic.substr(1) : std::string_view{};
  const protocol::Topic* const target = catalogue.find(name);
  if (target == nullptr || target->kind == protocol::Kind::sensor)
    return fmt::format("{} takes nothing: publish on the channel of an actuator, or lines on {}", topic,
                       line_topic);
  if (object->members.empty() && !target->is_message()) {
    const auto& fields = target->frames.front().fields;
    return fmt::format(R"(no field in it: expected at least one, such as {{"{}":0}})",
                       fields.empty() ? std::string_view{} : fields.front().name);
  }
  std::vector<std::string> words{"set", std::string{target->name}};
  for (const Node::Member& member : object->members) {
    if (std::string why = wrong_kind(*target, member); !why.empty()) return why;
    words.push_back(fmt::format("{}={}", member.name, value_text(*target, member.name, member.node)));
  }
  auto command = parse_words(catalogue, words);
  if (command && target->role == protocol::Role::drive) {
    const can::Frame frame = command->frames.front();
    command->frames.clear();
    command->hold = client::Hold{frame, client::set_point(*target, {}), {}};
  }
  return command;
}

Parsed period_command(const protocol::Catalogue& catalogue, std::string_view sensor, double milliseconds) {
  if (!(milliseconds >= 0 && milliseconds <= 1e9))
    return fmt::format("{} ms is no period: 0 stops the sensor, 50 publishes it twenty times a second",
                       milliseconds);
  if (milliseconds == 0) return parse_words(catalogue, {"stop", std::string{sensor}});
  const auto us = static_cast<std::int64_t>(std::llround(milliseconds * 1000));
  return parse_words(catalogue, {"publish", std::string{sensor},
                                 us % 1000 == 0 ? fmt::format("{}ms", us / 1000) : fmt::format("{}us", us)});
}

base::Result<PlaybackRequest, std::string> playback_of(std::string_view payload) {
  const auto object = read_object(payload);
  if (!object) return object.error;
  PlaybackRequest request;
  for (const Node::Member& member : object->members) {
    const std::string& text = member.node.text;
    double number = 0;
    const bool is_number = member.node.is(Node::Kind::number) &&
                           std::from_chars(text.data(), text.data() + text.size(), number).ec == std::errc{};
    if (member.name == "at_s" && is_number && number >= 0 && number < 1e9)
      // Rounded: the end of a log, written in seconds, is its end and not 1 ns before it.
      request.at = base::Duration{std::llround(number * 1e9)};
    else if (member.name == "speed" && is_number && number >= 1.0 / 64 && number <= 1024)
      request.speed = number;
    else if (member.name == "paused" && member.node.is(Node::Kind::boolean))
      request.paused = member.node.truth ? 1 : 0;
    else
      return std::string{"a time bar takes at_s in seconds, speed from 1/64 to 1024, and paused"};
  }
  return request;
}

}  // namespace ocm::cli::serve
