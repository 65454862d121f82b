#include "cli/serve/sessions.hpp"

#include <utility>

#include <fmt/format.h>

#include "cli/serve/commands.hpp"
#include "cli/serve/fleet_order.hpp"
#include "cli/serve/parameters.hpp"

namespace ocm::cli::serve {
namespace {

constexpr std::string_view no_commands =
    "this viewer may only look: start amiroctl serve with --allow-commands, and open the address that it "
    "prints";

}  // namespace

Sessions::Sessions(SessionsOptions options, const protocol::Catalogue& catalogue, const Channels& channels,
                   Viewers& viewers, Orders& orders)
    : options_(std::move(options)),
      catalogue_(&catalogue),
      channels_(&channels),
      viewers_(&viewers),
      orders_(&orders) {}

void Sessions::opened(ViewerId viewer, bool commands) {
  const bool may = commands && options_.commands;
  open_[viewer] = {may, {}};
  viewers_->greet(viewer, {foxglove::server_info({options_.name, options_.id, may || options_.playback, may}),
                           foxglove::advertise(channels_->all())});
}

void Sessions::gone(ViewerId viewer) {
  open_.erase(viewer);
  put({Order::Kind::gone, viewer});
  if (options_.fleet != nullptr) put(*options_.fleet, {Order::Kind::gone, viewer});
}

void Sessions::refuse(ViewerId viewer, std::string_view why) {
  viewers_->tell(viewer, foxglove::status(foxglove::Level::error, why));
}

void Sessions::put(Order order) {
  put(*orders_, std::move(order));
}

void Sessions::put(Orders& orders, Order order) {
  const ViewerId viewer = order.viewer;
  if (!orders.put(std::move(order)))
    refuse(viewer, "too many commands at a time: this one was not carried out");
}

void Sessions::text(ViewerId viewer, std::string_view message) {
  const auto found = open_.find(viewer);
  if (found == open_.end()) return;
  const auto request = foxglove::parse(message);
  if (!request) return refuse(viewer, request.error);
  using Op = foxglove::Request::Op;
  switch (request->op) {
    case Op::subscribe:
      return subscribe(viewer, *request);
    case Op::unsubscribe:
      for (const std::uint32_t id : request->ids)
        if (const std::string why = viewers_->unsubscribe(viewer, id); !why.empty()) refuse(viewer, why);
      return;
    case Op::advertise:
      return advertise(viewer, found->second, *request);
    case Op::unadvertise:
      for (const std::uint32_t id : request->ids)
        if (found->second.publishes.erase(id) == 0)
          refuse(viewer, fmt::format("channel {} was not advertised", id));
      return;
    case Op::get_parameters:
      return parameters(viewer, Order::Kind::get_parameters, *request);
    case Op::subscribe_parameters:
      return parameters(viewer, Order::Kind::subscribe_parameters, *request);
    case Op::set_parameters:
      return set_parameters(viewer, found->second, *request);
    case Op::unsubscribe_parameters:
      return parameters(viewer, Order::Kind::unsubscribe_parameters, *request);
  }
}

void Sessions::subscribe(ViewerId viewer, const foxglove::Request& request) {
  Order newest{Order::Kind::newest, viewer};
  for (const foxglove::Subscription& subscription : request.subscriptions) {
    if (const std::string why = viewers_->subscribe(viewer, subscription); !why.empty())
      refuse(viewer, why);
    else if (!channels_->is_state(subscription.channel))  // states are there already
      newest.channels.push_back(subscription.channel);
  }
  if (!newest.channels.empty()) put(std::move(newest));
}

void Sessions::advertise(ViewerId id, Viewer& viewer, const foxglove::Request& request) {
  for (const foxglove::ClientChannel& channel : request.channels) {
    const bool of_bar = options_.playback && channel.topic == playback_topic;
    if (!viewer.commands && !of_bar) {
      refuse(id, no_commands);
    } else if (channel.encoding != "json") {
      refuse(id, fmt::format("{}: encoding '{}': only json is taken", channel.topic, channel.encoding));
    } else if (viewer.publishes.size() >= most_channels) {
      refuse(id, fmt::format("{} channels of a viewer are the most", most_channels));
    } else if (!viewer.publishes.try_emplace(channel.id, channel.topic).second) {
      refuse(id, fmt::format("channel {} was advertised already", channel.id));
    }
  }
}

void Sessions::parameters(ViewerId viewer, Order::Kind kind, const foxglove::Request& request) {
  Order order{kind, viewer};
  order.payload = request.request;
  order.names = request.names;
  put(std::move(order));
}

void Sessions::set_parameters(ViewerId id, const Viewer& viewer, const foxglove::Request& request) {
  if (!viewer.commands) return refuse(id, no_commands);
  Order confirm{Order::Kind::confirm_parameters, id};
  for (const foxglove::Parameter& parameter : request.parameters)
    if (sensor_of(*catalogue_, parameter.name) == nullptr) {
      refuse(id, fmt::format("there is no parameter {}", parameter.name));
    } else {
      put({Order::Kind::parameter, id, parameter.name, {}, parameter.value.value_or(0)});
      confirm.names.push_back(parameter.name);
    }
  if (request.request.empty()) return;
  confirm.payload = request.request;
  if (confirm.names.empty())  // all would be meant
    viewers_->tell(id, foxglove::parameter_values({}, request.request));
  else
    put(std::move(confirm));
}

void Sessions::binary(ViewerId viewer, std::string_view message) {
  const auto found = open_.find(viewer);
  if (found == open_.end()) return;
  const auto published = foxglove::parse_binary(message);
  if (!published) return refuse(viewer, published.error);
  const auto topic = found->second.publishes.find(published->channel);
  if (topic == found->second.publishes.end())
    return refuse(viewer, fmt::format("channel {} was not advertised", published->channel));
  const bool of_bar = options_.playback && topic->second == playback_topic;
  Orders& orders = options_.fleet != nullptr && topic->second == fleet_topic ? *options_.fleet : *orders_;
  put(orders, {of_bar ? Order::Kind::playback : Order::Kind::publish, viewer, topic->second,
               std::string{published->payload}});
}

}  // namespace ocm::cli::serve
