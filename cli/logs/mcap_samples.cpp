#include "cli/logs/mcap_samples.hpp"

#include <fmt/format.h>

#include "ocm/log/mcap.hpp"

#include "cli/output/output.hpp"

namespace ocm::cli::logs {

McapSamples::McapSamples(const protocol::Catalogue& catalogue) : catalogue_(&catalogue) {
  for (const protocol::Topic& topic : catalogue.topics) topics_.push_back({SampleText{topic}, 0});
}

std::uint16_t McapSamples::channel(log::Bytes& out, log::mcap::Container& container, Heard& heard,
                                   const protocol::Topic& topic, std::string_view interface) {
  const auto number = static_cast<std::size_t>(&topic - catalogue_->topics.data());
  std::uint16_t& channel = heard.channels[number];
  if (channel != 0) return channel;
  std::uint16_t& schema = topics_[number].schema;
  if (schema == 0)
    schema =
        container.add_schema(out, fmt::format("{}.{}", catalogue_->robot, topic.name), sample_schema(topic));
  const std::string name = log::mcap::escaped(interface);
  const log::mcap::Pair metadata[] = {{"interface", name}};
  return channel = container.add_channel(out, schema, fmt::format("/{}", topic.name), metadata);
}

void McapSamples::put(log::Bytes& out, log::mcap::Container& container, const log::Entry& entry,
                      std::uint64_t time_ns, const log::Interfaces& interfaces) {
  if (entry.interface >= most_interfaces) return;
  if (heard_.size() <= entry.interface) heard_.resize(entry.interface + std::size_t{1});
  auto& heard = heard_[entry.interface];
  if (heard == nullptr) {
    heard = std::make_unique<Heard>(*catalogue_);
    heard->receiver.on_interface(entry.interface, interfaces.name(entry.interface));
  }
  const client::Reception reception = understand(heard->receiver, entry);
  const bool is_sample = reception.meaning == client::Meaning::sample;
  if (!is_sample && reception.meaning != client::Meaning::set_point) return;

  const protocol::Topic& topic = *reception.topic;
  const TopicText& text = topics_[static_cast<std::size_t>(&topic - catalogue_->topics.data())];
  const std::uint16_t to_channel = channel(out, container, *heard, topic, interfaces.name(entry.interface));
  char* const to = container.begin_message(out, to_channel, time_ns, text.sample.room());
  container.end_message(is_sample ? text.sample.print(to, reception.sample)
                                  : text.sample.print(to, reception.frame.frame, entry.bytes()));
}

}  // namespace ocm::cli::logs
