#include "cli/logs/mcap_samples.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "ocm/log/mcap.hpp"

#include "cli/output/json_text.hpp"
#include "cli/output/output.hpp"

namespace ocm::cli::logs {
namespace {

std::string json_string(std::string_view text) {
  std::string out{'"'};
  append_json(out, text);
  return out += '"';
}

/// The unit, and the names of values: "0 off, 1 on".
std::string description(const protocol::Field& field) {
  std::string text{field.unit};
  for (const protocol::NamedValue& value : field.values)
    text +=
        fmt::format("{}{}{} {}", text.empty() ? "" : ", ", field.flags ? "bit " : "", value.raw, value.name);
  return text;
}

std::string object(std::string_view properties) {
  return fmt::format(R"("type":"object","properties":{{{}}})", properties);
}

std::string fields_schema(const protocol::FrameLayout& frame) {
  std::string properties;
  for (const protocol::Field& field : frame.fields) {
    const std::string about = description(field);
    properties +=
        fmt::format(R"({}{}:{{"type":"number"{}{}}})", properties.empty() ? "" : ",", json_string(field.name),
                    about.empty() ? "" : R"(,"description":)", about.empty() ? "" : json_string(about));
  }
  return object(properties);
}

char* copy(char* to, std::string_view text) {
  return std::copy(text.begin(), text.end(), to);
}

}  // namespace

std::string mcap_schema(const protocol::Topic& topic) {
  std::string type;
  if (topic.frames.size() == 1) {
    type = fields_schema(topic.frames.front());
  } else {
    std::string properties;
    for (std::size_t i = 0; i < topic.frames.size(); ++i)
      properties += fmt::format("{}{}:{{{}}}", i == 0 ? "" : ",",
                                json_string(frame_name({&topic, static_cast<std::uint8_t>(i)})),
                                fields_schema(topic.frames[i]));
    type = object(properties);
  }
  return fmt::format(
      R"({{"$schema":"https://json-schema.org/draft/2020-12/schema","title":{},"description":{},{}}})",
      json_string(topic.name), json_string(topic.source), type);
}

McapSamples::McapSamples(const protocol::Catalogue& catalogue) : catalogue_(&catalogue) {
  for (const protocol::Topic& topic : catalogue.topics) {
    TopicText& text = topics_.emplace_back();
    text.room = 2;
    for (const protocol::FrameLayout& frame : topic.frames) {
      const FrameText& made = text.frames.emplace_back(text_of(frame, topic.frames.size() == 1));
      for (const Value& value : made.values) text.room += 1 + value.before.size() + FieldText::room;
      text.room += made.begin.size() + made.end.size() + 1;
    }
  }
}

McapSamples::FrameText McapSamples::text_of(const protocol::FrameLayout& frame, bool alone) {
  FrameText made{alone ? "" : json_string(frame.name) + ":{", {}, alone ? "" : "}", &frame};
  for (const protocol::Field& field : frame.fields) {
    made.values.push_back({json_string(field.name) + ':', FieldText{field}});
    made.varies = made.varies || frame.may_lack(field);
  }
  return made;
}

char* McapSamples::print(char* to, const FrameText& frame, std::span<const std::uint8_t> data) {
  to = copy(to, frame.begin);
  bool first = true;
  for (const Value& value : frame.values) {
    if (frame.varies && !frame.layout->has(value.text.field(), data)) continue;
    if (!first) *to++ = ',';
    first = false;
    to = value.text.print_json(copy(to, value.before), data.data());
  }
  return copy(to, frame.end);
}

std::uint16_t McapSamples::channel(log::Bytes& out, log::mcap::Container& container, Heard& heard,
                                   const protocol::Topic& topic, std::string_view interface) {
  const auto number = static_cast<std::size_t>(&topic - catalogue_->topics.data());
  std::uint16_t& channel = heard.channels[number];
  if (channel != 0) return channel;
  std::uint16_t& schema = topics_[number].schema;
  if (schema == 0)
    schema =
        container.add_schema(out, fmt::format("{}.{}", catalogue_->robot, topic.name), mcap_schema(topic));
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
  char* to = container.begin_message(out, to_channel, time_ns, text.room);
  *to++ = '{';
  if (is_sample) {
    for (std::size_t i = 0; i < text.frames.size(); ++i) {
      if (i != 0) *to++ = ',';
      to = print(to, text.frames[i], reception.sample.data(i));
    }
  } else {
    to = print(to, text.frames[reception.frame.frame], entry.bytes());
  }
  *to++ = '}';
  container.end_message(to);
}

}  // namespace ocm::cli::logs
