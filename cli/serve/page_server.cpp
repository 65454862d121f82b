#include "cli/serve/page_server.hpp"

#include <algorithm>
#include <optional>
#include <sys/random.h>
#include <utility>

#include <fmt/format.h>

#include "cli/output/printer.hpp"
#include "cli/serve/address.hpp"
#include "cli/serve/fleet_state.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/remedies.hpp"
#include "generator/spec/model.hpp"

namespace ocm::cli::serve {
namespace {

/// So many random bytes, in hexadecimal digits.
std::string random_text(std::size_t bytes) {
  std::vector<unsigned char> numbers(bytes);
  if (::getrandom(numbers.data(), bytes, 0) != static_cast<ssize_t>(bytes))
    fail({"the kernel gives no random numbers", "serve needs them for its token"});
  std::string text;
  for (const unsigned char number : numbers) text += fmt::format("{:02x}", number);
  return text;
}

}  // namespace

PageServer::PageServer(const protocol::Catalogue& catalogue, const spec::Model& model, ServeOptions options,
                       Source source, const std::vector<std::string>& interfaces, std::uint32_t bus_bit_rate)
    : options_(std::move(options)),
      catalogue_(catalogue),
      model_(model),
      source_(std::move(source)),
      rates_{options_.bit_rate.value_or(bus_bit_rate != 0 ? bus_bit_rate : catalogue_.bit_rate),
             options_.data_bit_rate.value_or(model_.data_bit_rate)},
      channels_(catalogue_, interfaces, options_.fleet.has_value()),
      scenes_(catalogue_, model_, channels_.interfaces(), static_cast<std::uint32_t>(channels_.all().size())),
      viewers_(channels_.all().size() + scenes_.channels().size()),
      publisher_(catalogue_, channels_, viewers_),
      models_(catalogue_, rates_.nominal, rates_.data),
      bounds_(catalogue_, rates_.nominal),
      diagnosis_(catalogue_),
      status_requests_(catalogue_),
      parameters_(catalogue_, viewers_),
      sessions_({fmt::format("{}, {}", catalogue_.robot, source_.name), random_text(8), source_.commands,
                 !source_.live, options_.fleet && source_.live ? &fleet_orders_ : nullptr},
                catalogue_, channels_, viewers_, orders_) {
  channels_.add(scenes_.channels());
  model_interfaces();
  if (interfaces.size() > channels_.interfaces().size())
    remark(fmt::format("serve: {} of {} interfaces have no channels: there would be more than {}",
                       interfaces.size() - channels_.interfaces().size(), interfaces.size(), Channels::most));
}

void PageServer::open() {
  if (options_.fleet && source_.live)
    fleet_ = std::make_unique<FleetWatch>(*options_.fleet, viewers_, fleet_channels(), fleet_orders_);
  if (options_.commands || options_.web.token_to_view) options_.web.token = random_text(16);
  auto web = Web::open(options_.web, viewers_, sessions_);
  if (!web) fail(web.error);
  web_ = std::move(*web);
  viewers_.publish_state(channels_.of(State::robot), now_ns(),
                         robot_state(catalogue_, model_, channels_, source_));
  const std::string address = page_address(web_->url(), options_.web.token, options_.shows);
  // Without its address nothing of it is of use: an output that is full or gone ends it, with words.
  write_out(address + "\n");
  if (options_.opens) open_in_browser(address);
  if (fleet_ != nullptr) fleet_->run([web = web_.get()] { web->wake(); });
}

void PageServer::close() {
  fleet_.reset();
  web_.reset();
  if (viewers_.lost() != 0)
    remark(
        fmt::format("serve: viewers that were too slow have lost {}", counted(viewers_.lost(), "message")));
}

void PageServer::take(const log::Entry& entry, const log::Interfaces& interfaces) {
  const std::string_view interface = interfaces.name(entry.interface);
  const client::Reception reception = publisher_.take(entry, interface);
  if (reception.meaning == client::Meaning::sample) show(reception.sample, interface);
  diagnosis_.take(reception);
  if (const auto classic = entry.classic()) {
    status_requests_.take({entry.time, *classic}, reception);
    commanders_.take({entry.time, *classic}, reception);
  }
  models_.take(entry, interfaces);
  if (entry.interface == 0) bounds_.take(entry);
}

void PageServer::lost_so_far(std::string_view interface, std::uint64_t frames) {
  if (frames != lost_) models_.lost(interface, frames - std::exchange(lost_, frames));
}

void PageServer::answer(const Order& order, base::Time now) {
  if (order.kind == Order::Kind::newest) {
    for (const std::uint32_t channel : order.channels)
      if (channel >= channels_.of(State::robot)) {
        if (auto scene = scenes_.newest(channel))
          viewers_.give(order.viewer, channel,
                        static_cast<std::uint64_t>(scene->time.time_since_epoch().count()),
                        std::move(scene->payload));
      } else if (const auto sample =
                     models_.of(channels_.interface_of(channel)).newest_of(channels_.topic_of(channel)))
        viewers_.give(order.viewer, channel,
                      static_cast<std::uint64_t>(sample->time.time_since_epoch().count()),
                      publisher_.text_of(*sample));
    return;
  }
  parameters_.take(order, rows(now));
}

std::vector<bus_model::Row> PageServer::rows(base::Time now) {
  const auto buses = models_.buses();
  return buses.empty() ? std::vector<bus_model::Row>{} : buses.front().model->rows(now, false);
}

void PageServer::show(const client::Sample& sample, std::string_view interface) {
  const auto known = channels_.interfaces();
  const auto at = std::find(known.begin(), known.end(), interface);
  scenes_.take(
      sample, static_cast<std::size_t>(at - known.begin()),
      [this](std::uint32_t channel) { return !winds_ && viewers_.wanted(channel); },
      [&](Scenes::Message message) {
        viewers_.publish(message.channel, static_cast<std::uint64_t>(sample.time.time_since_epoch().count()),
                         std::move(message.payload));
      });
}

void PageServer::model_interfaces() {
  for (const std::string& interface : channels_.interfaces()) models_.of(interface);
}

void PageServer::winds() {
  publisher_.hold_back();
  winds_ = true;
}

void PageServer::wound() {
  publisher_.go_on();
  winds_ = false;
  for (const foxglove::Channel& channel : scenes_.channels())
    if (auto scene = viewers_.wanted(channel.id) ? scenes_.newest(channel.id) : std::nullopt)
      viewers_.publish(channel.id, static_cast<std::uint64_t>(scene->time.time_since_epoch().count()),
                       std::move(scene->payload));
}

void PageServer::forget() {
  publisher_.forget();
  scenes_.forget();
  models_ = bus_model::Models{catalogue_, rates_.nominal, rates_.data};
  model_interfaces();
  diagnosis_ = client::Diagnosis{catalogue_};
  status_requests_ = client::StatusRequests{catalogue_};
  commanders_ = {};
  bounds_ = Bounds{catalogue_, rates_.nominal};
}

void PageServer::say(const std::string& words) {
  remark("serve: " + words);
  viewers_.tell(0, foxglove::status(foxglove::Level::info, words));
}

void PageServer::publish_bounds(base::Time now) {
  const std::uint32_t channel = channels_.of(State::bounds);
  if (!viewers_.wanted(channel)) return;
  bounds_.assume(rows(now));
  viewers_.publish_state(channel, now_ns(), bounds_.state());
}

void PageServer::publish_bus(base::Time now) {
  const std::uint32_t channel = channels_.of(State::bus);
  if (viewers_.wanted(channel))
    viewers_.publish_state(
        channel, now_ns(),
        bus_state(models_.buses(), now, {viewers_.count(), viewers_.lost(), web_->refused()}));
}

void PageServer::publish_boards(const transport::BusCounters& counters, base::Time now) {
  const std::uint32_t channel = channels_.of(State::boards);
  if (!viewers_.wanted(channel)) return;
  std::vector<client::Finding> findings =
      diagnosis_.findings([&](std::size_t board) { return status_requests_.is_due(board, now); });
  const auto disputes = commanders_.findings(catalogue_);
  findings.insert(findings.end(), disputes.begin(), disputes.end());
  for (client::Finding& finding : findings) finding.remedy = remedy(finding);
  const auto counted = findings_of(counters, publisher_.counters());
  findings.insert(findings.end(), counted.begin(), counted.end());
  viewers_.publish_state(channel, now_ns(), boards_state(catalogue_, diagnosis_, status_requests_, findings));
}

bool PageServer::is_looked_at() const {
  const auto& all = channels_.all();
  return std::any_of(all.begin(), all.end(), [this](const foxglove::Channel& channel) {
    return !channels_.is_state(channel.id) && viewers_.wanted(channel.id);
  });
}

void PageServer::publish_parameters(base::Time now) {
  if (parameters_.wanted()) parameters_.update(rows(now));
}

void PageServer::publish_operator(const OperatorWatch& watch) {
  const std::uint32_t channel = channels_.of(State::operator_);
  if (viewers_.wanted(channel)) viewers_.publish_state(channel, now_ns(), watch.newest());
}

void PageServer::publish_playback(const bus_model::Playing& playing, bool paused, std::uint64_t jumps) {
  viewers_.publish_state(channels_.of(State::playback), now_ns(), playback_state(playing, paused, jumps));
}

}  // namespace ocm::cli::serve
