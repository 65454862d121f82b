#include "cli/serve/foxglove.hpp"

#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/utf8.hpp"

#include "cli/shared/json.hpp"
#include "generator/spec/json.hpp"

namespace ocm::cli::serve::foxglove {
namespace {

using spec::Node;

template <class Number>
void put_little_endian(std::uint8_t* to, Number number) noexcept {
  for (std::size_t i = 0; i < sizeof number; ++i) to[i] = static_cast<std::uint8_t>(number >> 8 * i);
}

constexpr std::uint8_t opcode_message_data = 0x01;    // of a server
constexpr std::uint8_t opcode_client_message = 0x01;  // of a client

/// An id is a number of 32 bits without a sign.
bool read_id(const Node* node, std::uint32_t& id) {
  if (node == nullptr || !node->is(Node::Kind::number)) return false;
  const char* const end = node->text.data() + node->text.size();
  const auto [to, error] = std::from_chars(node->text.data(), end, id);
  return error == std::errc{} && to == end;
}

bool read_text(const Node* node, std::string& text) {
  if (node == nullptr || !node->is(Node::Kind::string)) return false;
  text = node->text;
  return true;
}

bool read_number(const Node& node, double& number) {
  if (!node.is(Node::Kind::number)) return false;
  const char* const end = node.text.data() + node.text.size();
  const auto [to, error] = std::from_chars(node.text.data(), end, number);
  return error == std::errc{} && to == end;
}

struct Known {
  std::string_view name;
  Request::Op op;
  const char* list;  // its member
  const char* each;  // what is in the list, for messages
};
constexpr Known known_ops[] = {
    {"subscribe", Request::Op::subscribe, "subscriptions", "an id and a channelId, both whole numbers"},
    {"unsubscribe", Request::Op::unsubscribe, "subscriptionIds", "a whole number"},
    {"advertise", Request::Op::advertise, "channels", "an id, a topic of 256 bytes at most, and an encoding"},
    {"unadvertise", Request::Op::unadvertise, "channelIds", "a whole number"},
    {"getParameters", Request::Op::get_parameters, "parameterNames", "a text"},
    {"setParameters", Request::Op::set_parameters, "parameters", "a name and a number as its value"},
    {"subscribeParameterUpdates", Request::Op::subscribe_parameters, "parameterNames", "a text"},
    {"unsubscribeParameterUpdates", Request::Op::unsubscribe_parameters, "parameterNames", "a text"},
};

bool take_item(Request& request, const Node& item) {
  switch (request.op) {
    case Request::Op::subscribe: {
      Subscription subscription;
      if (!read_id(item.find("id"), subscription.id) ||
          !read_id(item.find("channelId"), subscription.channel))
        return false;
      request.subscriptions.push_back(subscription);
      return true;
    }
    case Request::Op::unsubscribe:
    case Request::Op::unadvertise:
      return read_id(&item, request.ids.emplace_back());
    case Request::Op::advertise: {
      ClientChannel& channel = request.channels.emplace_back();
      return read_id(item.find("id"), channel.id) && read_text(item.find("topic"), channel.topic) &&
             read_text(item.find("encoding"), channel.encoding) && channel.topic.size() <= longest_name;
    }
    case Request::Op::set_parameters: {
      Parameter& parameter = request.parameters.emplace_back();
      const Node* const value = item.find("value");
      if (!read_text(item.find("name"), parameter.name)) return false;
      return value != nullptr && read_number(*value, parameter.value.emplace());
    }
    case Request::Op::get_parameters:
    case Request::Op::subscribe_parameters:
    case Request::Op::unsubscribe_parameters:
      return read_text(&item, request.names.emplace_back());
  }
  return false;
}

}  // namespace

std::string server_info(const ServerInfo& info) {
  Json json{{"op", "serverInfo"}, {"name", info.name}, {"capabilities", Json::array()}};
  if (info.takes_commands) {
    json["capabilities"].push_back("clientPublish");
    json["supportedEncodings"].push_back("json");
  }
  if (info.has_parameters) {
    json["capabilities"].push_back("parameters");
    json["capabilities"].push_back("parametersSubscribe");
  }
  json["metadata"] = Json::object();
  json["sessionId"] = info.session;
  return json.line();
}

std::string advertise(std::span<const Channel> channels) {
  Json json{{"op", "advertise"}, {"channels", Json::array()}};
  for (const Channel& channel : channels)
    json["channels"].push_back({{"id", channel.id},
                                {"topic", channel.topic},
                                {"encoding", "json"},
                                {"schemaName", channel.schema_name},
                                {"schemaEncoding", "jsonschema"},
                                {"schema", channel.schema}});
  return json.line();
}

std::string status(Level level, std::string_view message, std::string_view id) {
  std::string text{message.substr(0, longest_status)};
  if (text.size() < message.size()) {
    while (!text.empty() && base::continues_character(message[text.size()])) text.pop_back();
    text += " ...";
  }
  Json json{{"op", "status"}, {"level", static_cast<int>(level)}, {"message", std::move(text)}};
  if (!id.empty()) json["id"] = id;
  return json.line();
}

std::string parameter_values(std::span<const Parameter> parameters, std::string_view request) {
  Json json{{"op", "parameterValues"}, {"parameters", Json::array()}};
  for (const Parameter& parameter : parameters) {
    Json one{{"name", parameter.name}};
    if (parameter.value) {
      one["value"] = *parameter.value;
      one["type"] = "float64";
    }
    json["parameters"].push_back(std::move(one));
  }
  if (!request.empty()) json["id"] = request;
  return json.line();
}

MessageHead message_head(std::uint32_t subscription, std::uint64_t time_ns) noexcept {
  MessageHead head{};
  head[0] = opcode_message_data;
  put_little_endian(&head[1], subscription);
  put_little_endian(&head[5], time_ns);
  return head;
}

base::Result<Request, std::string> parse(std::string_view text) {
  static constexpr spec::Document document{"a message", "op", "Foxglove's protocol", 7, longest_message};
  std::vector<spec::Problem> problems;
  const Node root = spec::parse_json(text, "message", problems, document);
  if (!problems.empty()) return "no JSON: " + problems.front().what;
  std::string op;
  if (!read_text(root.find("op"), op)) return std::string{"no text 'op', which says what is asked"};
  for (const Known& known : known_ops) {
    if (known.name != op) continue;
    Request request;
    request.op = known.op;
    read_text(root.find("id"), request.request);
    if (request.request.size() > longest_name)
      return fmt::format("the id of a request has {} bytes at most", longest_name);
    const Node* const list = root.find(known.list);
    if (list == nullptr || !list->is(Node::Kind::array))
      return fmt::format("{} without its list '{}'", op, known.list);
    for (const Node& item : list->items)
      if (!take_item(request, item))
        return fmt::format("{}: each of its {} is {}", op, known.list, known.each);
    return request;
  }
  return fmt::format("'{}' is nothing that this server does", op);
}

base::Result<Published, std::string> parse_binary(std::string_view message) {
  constexpr std::size_t head = 5;
  if (message.size() < head || static_cast<std::uint8_t>(message[0]) != opcode_client_message)
    return std::string{"a binary message that begins neither with 1 nor with a channel"};
  Published published;
  for (std::size_t i = 0; i < 4; ++i)
    published.channel |= std::uint32_t{static_cast<std::uint8_t>(message[1 + i])} << 8 * i;
  published.payload = message.substr(head);
  return published;
}

}  // namespace ocm::cli::serve::foxglove
