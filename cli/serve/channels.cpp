#include "cli/serve/channels.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "cli/output/output.hpp"

namespace ocm::cli::serve {
namespace {

/// Of foxglove.Grid, by its own name, under which Foxglove draws it. [github.com/foxglove/schemas, Grid]
constexpr std::string_view grid_schema =
    R"({"title":"foxglove.Grid","type":"object","properties":{)"
    R"("timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}},)"
    R"("frame_id":{"type":"string"},)"
    R"("pose":{"type":"object","title":"foxglove.Pose","properties":{)"
    R"("position":{"type":"object","title":"foxglove.Vector3","properties":)"
    R"({"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}},)"
    R"("orientation":{"type":"object","title":"foxglove.Quaternion","properties":)"
    R"({"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}}}}},)"
    R"("column_count":{"type":"integer"},)"
    R"("cell_size":{"type":"object","title":"foxglove.Vector2","properties":{"x":{"type":"number"},"y":{"type":"number"}}},)"
    R"("row_stride":{"type":"integer"},"cell_stride":{"type":"integer"},)"
    R"("fields":{"type":"array","items":{"type":"object","title":"foxglove.PackedElementField","properties":)"
    R"({"name":{"type":"string"},"offset":{"type":"integer"},"type":{"type":"integer"}}}},)"
    R"("data":{"type":"string","contentEncoding":"base64","description":"0 unknown, 1 free, 2 occupied"}}})";

}  // namespace

Channels::Channels(const protocol::Catalogue& catalogue, std::span<const std::string> interfaces, bool fleet)
    : topics_(catalogue.topics.size()) {
  const std::size_t room = topics_ == 0 ? 1 : std::max<std::size_t>(most / topics_, 1);
  interfaces_.assign(interfaces.begin(),
                     interfaces.begin() + static_cast<std::ptrdiff_t>(std::min(interfaces.size(), room)));
  for (const std::string& interface : interfaces_)
    for (const protocol::Topic& topic : catalogue.topics)
      all_.push_back({static_cast<std::uint32_t>(all_.size()),
                      interfaces_.size() == 1 ? fmt::format("/{}", topic.name)
                                              : fmt::format("/{}/{}", interface, topic.name),
                      fmt::format("{}.{}", catalogue.robot, topic.name), sample_schema(topic)});
  for (const std::string_view name : state_names)
    all_.push_back({static_cast<std::uint32_t>(all_.size()), fmt::format("/ocm/{}", name),
                    fmt::format("ocm.{}", name), R"({"type":"object"})"});
  if (fleet) {
    all_.push_back(
        {static_cast<std::uint32_t>(all_.size()), "/ocm/fleet", "ocm.fleet", R"({"type":"object"})"});
    all_.push_back(
        {static_cast<std::uint32_t>(all_.size()), "/ocm/map", "foxglove.Grid", std::string{grid_schema}});
  }
  states_end_ = all_.size();
}

Publisher::Publisher(const protocol::Catalogue& catalogue, const Channels& channels, Viewers& viewers)
    : catalogue_(&catalogue), channels_(&channels), viewers_(&viewers) {
  texts_.reserve(catalogue.topics.size());
  for (const protocol::Topic& topic : catalogue.topics) texts_.emplace_back(topic);
  forget();
}

void Publisher::forget() {
  receivers_.clear();
  for (std::size_t i = 0; i < channels_->interfaces().size(); ++i)
    receivers_.emplace_back(*catalogue_, client::Transport::together);
}

client::Reception Publisher::take(const log::Entry& entry, std::string_view interface) {
  const auto interfaces = channels_->interfaces();
  if (last_ >= interfaces.size() || interfaces[last_] != interface)
    last_ = static_cast<std::size_t>(std::find(interfaces.begin(), interfaces.end(), interface) -
                                     interfaces.begin());
  if (last_ >= interfaces.size()) return {};
  const client::Reception reception = understand(receivers_[last_], entry);
  const bool is_sample = reception.meaning == client::Meaning::sample;
  if (!is_sample && reception.meaning != client::Meaning::set_point) return reception;

  const auto number = static_cast<std::size_t>(reception.topic - catalogue_->topics.data());
  const std::uint32_t channel = channels_->of(last_, number);
  if (!viewers_->wanted(channel)) return reception;
  const SampleText& text = texts_[number];
  std::string payload(text.room(), '\0');
  char* const end = is_sample ? text.print(payload.data(), reception.sample)
                              : text.print(payload.data(), reception.frame.frame, entry.bytes());
  payload.resize(static_cast<std::size_t>(end - payload.data()));
  payload.shrink_to_fit();
  const auto time_ns = static_cast<std::uint64_t>(entry.time.time_since_epoch().count());
  if (holds_back_)
    kept_[channel] = Kept{time_ns, std::move(payload)};
  else
    viewers_->publish(channel, time_ns, std::move(payload));
  return reception;
}

std::string Publisher::text_of(const client::Sample& sample) const {
  const SampleText& text = texts_[static_cast<std::size_t>(sample.topic - catalogue_->topics.data())];
  std::string payload(text.room(), '\0');
  payload.resize(static_cast<std::size_t>(text.print(payload.data(), sample) - payload.data()));
  return payload;
}

void Publisher::hold_back() {
  holds_back_ = true;
  kept_.assign(channels_->all().size(), {});
}

void Publisher::go_on() {
  holds_back_ = false;
  for (std::size_t channel = 0; channel < kept_.size(); ++channel)
    if (!kept_[channel].payload.empty())
      viewers_->publish(static_cast<std::uint32_t>(channel), kept_[channel].time_ns,
                        std::move(kept_[channel].payload));
  kept_.clear();
}

client::ReceiverCounters Publisher::counters() const {
  client::ReceiverCounters sum;
  for (const client::Receiver& receiver : receivers_) sum += receiver.counters();
  return sum;
}

}  // namespace ocm::cli::serve
