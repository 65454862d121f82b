#include "cli/serve/fleet_order.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/serve/foxglove.hpp"
#include "generator/spec/json.hpp"

namespace ocm::cli::serve {
namespace {

using spec::Node;
using Kind = FleetOrder::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 5> order_words{{{"stop", Kind::stop},
                                                                        {"pause", Kind::pause},
                                                                        {"go_on", Kind::go_on},
                                                                        {"call_back", Kind::call_back},
                                                                        {"look", Kind::look}}};
constexpr std::string_view expected =
    R"(expected a robot with a place or an order, such as {"robot":"AVR","x_m":1.2,"y_m":0.4} or )"
    R"({"robot":"AVR","order":"stop"}; orders: stop, pause, go_on, call_back, look)";
/// As far as a map reaches.
constexpr double farthest_m = 1000;

bool read(const Node& node, std::optional<float>& metres) {
  double number = 0;
  const char* const end = node.text.data() + node.text.size();
  if (!node.is(Node::Kind::number) || std::from_chars(node.text.data(), end, number).ec != std::errc{})
    return false;
  metres = static_cast<float>(number);
  return std::abs(number) <= farthest_m;
}

}  // namespace

base::Result<FleetOrder, std::string> fleet_order_of(std::string_view payload) {
  static constexpr spec::Document document{"a message", "an order", "the channel's page", 3,
                                           foxglove::longest_message};
  std::vector<spec::Problem> problems;
  const Node object = spec::parse_json(payload, "message", problems, document);
  if (!problems.empty()) return "no JSON: " + problems.front().what;
  if (!object.is(Node::Kind::object)) return std::string{expected};
  FleetOrder order;
  std::optional<float> x, y;
  bool has_order = false;
  for (const Node::Member& member : object.members) {
    const Node& node = member.node;
    if (member.name == "robot" && (node.is(Node::Kind::string) || node.is(Node::Kind::number))) {
      order.robot = node.text;
    } else if (member.name == "x_m" || member.name == "y_m") {
      if (!read(node, member.name == "x_m" ? x : y))
        return fmt::format("{} '{}' is no place: expected metres, {} to {}", member.name, node.text,
                           -farthest_m, farthest_m);
    } else if (member.name == "order" && node.is(Node::Kind::string)) {
      for (const auto& [word, kind] : order_words)
        if (word == node.text) order.kind = kind, has_order = true;
      if (!has_order) return fmt::format("unknown order '{}'; {}", node.text, expected);
    } else {
      return fmt::format("unexpected '{}'; {}", member.name, expected);
    }
  }
  const bool has_place = x && y;
  if (has_place == has_order || x.has_value() != y.has_value()) return std::string{expected};
  if (has_place) {
    order.kind = Kind::go;
    order.place = {*x, *y};
  }
  if (order.robot.empty() && order.kind != Kind::look) return fmt::format("missing robot; {}", expected);
  return order;
}

}  // namespace ocm::cli::serve
