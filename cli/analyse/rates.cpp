/// A robot's own traffic as a set of messages, and periods that differ from the spec's.
#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "ocm/protocol/identifier.hpp"

#include "cli/analyse/set.hpp"
#include "cli/shared/messages.hpp"
#include "cli/words/command.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli::analyse {
namespace {

/// The node that sends requests and set points.
constexpr std::string_view operator_node = "operator";

constexpr std::string_view rate_remedy =
    "topic=period, such as gyro=50ms; topic=period@priority, such as ring=2ms@urgent; topic=off";

void read_rate(std::string_view text, std::string place, std::vector<Rate>& rates,
               std::vector<Mistake>& mistakes) {
  Rate rate;
  rate.place = std::move(place);
  const auto equals = text.rfind('=');
  if (equals == std::string_view::npos || equals == 0) {
    mistakes.push_back({rate.place, fmt::format("'{}' is not a rate", text), std::string{rate_remedy}});
    return;
  }
  rate.name = text.substr(0, equals);
  std::string_view period = text.substr(equals + 1);
  const auto at = period.find('@');
  if (at != std::string_view::npos) {
    const auto priority = words::read_priority(period.substr(at + 1));
    if (!priority)
      mistakes.push_back(
          {rate.place, fmt::format("no priority '{}'", period.substr(at + 1)), priority.error.remedy});
    rate.has_priority = true;
    rate.priority = *priority;
    period = period.substr(0, at);
  }
  rate.off = period == "off";
  if (!rate.off) {
    const auto parsed = words::parse_duration(period);
    if (!parsed || parsed->count() <= 0)
      mistakes.push_back({rate.place, fmt::format("no period '{}'", period),
                          "a time with its unit, such as 900us, 50ms or 2s; or off"});
    else
      rate.period = *parsed;
  }
  rates.push_back(std::move(rate));
}

std::string_view stripped(std::string_view line) {
  line = line.substr(0, line.find('#'));
  const auto begin = line.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1);
}

}  // namespace

std::vector<Rate> read_rates(const std::vector<std::string>& words) {
  std::vector<Rate> rates;
  std::vector<Mistake> mistakes;
  for (const std::string& word : words) {
    std::error_code error;
    if (word.find('=') != std::string::npos && !std::filesystem::exists(word, error)) {
      read_rate(word, "--rates " + word, rates, mistakes);
      continue;
    }
    const std::string text = read_text(word);
    std::string_view rest = text;
    for (std::size_t number = 1; !rest.empty(); ++number) {
      const auto end = rest.find('\n');
      const std::string_view line = stripped(rest.substr(0, end));
      rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
      if (!line.empty()) read_rate(line, fmt::format("{}:{}", word, number), rates, mistakes);
    }
  }
  stop_at(mistakes, "--rates");
  return rates;
}

BusSet robot_bus(const protocol::Catalogue& catalogue, const std::vector<Rate>& rates) {
  std::vector<Mistake> mistakes;
  std::vector<std::pair<const protocol::Topic*, const Rate*>> chosen;
  for (const Rate& rate : rates) {
    bool found = false;
    const auto* const named = words::find_topic(catalogue, rate.name);
    for (const auto& topic : catalogue.topics) {
      if (named != &topic && !words::is_in_group(topic, rate.name)) continue;
      found = true;
      chosen.emplace_back(&topic, &rate);
    }
    const auto words = words::topic_words(catalogue);
    if (!found)
      mistakes.push_back(
          {rate.place, fmt::format("no topic '{}'", rate.name), words::suggestion(rate.name, words)});
  }

  BusSet set;
  std::string left_out;
  std::string not_classic;
  for (const auto& topic : catalogue.topics) {
    base::Duration period = topic.usual_period();
    if (topic.role == protocol::Role::drive) period = client::hold_period;
    protocol::Priority priority = topic.priority;
    bool off = false;
    for (const auto& [of, rate] : chosen) {
      if (of != &topic) continue;
      off = rate->off;
      if (!off) period = rate->period;
      if (rate->has_priority) priority = rate->priority;
    }
    if (off) continue;
    const auto& first = topic.frames[0];  // a message's only one
    if (first.fd || first.length > can::max_dlc) {
      not_classic += (not_classic.empty() ? "" : ", ") + std::string{topic.name};
      continue;
    }
    if (period.count() == 0) {
      left_out += (left_out.empty() ? "" : ", ") + std::string{topic.name};
      continue;
    }
    for (std::size_t i = 0; i < topic.frames.size(); ++i) {
      const protocol::FrameRef ref{&topic, static_cast<std::uint8_t>(i)};
      const auto& frame = ref.layout();
      BusEntry entry;
      entry.name =
          frame.name.empty() ? std::string{topic.name} : fmt::format("{}.{}", topic.name, frame.name);
      entry.head.id = protocol::identifier_of(ref, priority);
      entry.head.format = protocol::format_of(frame);
      entry.head.dlc = frame.dlc();
      entry.bits = frame.worst_bits[static_cast<std::size_t>(priority)];
      entry.period = period.count();
      entry.deadline = topic.deadline.count() == 0 ? analysis::implicit_deadline : topic.deadline.count();
      entry.overwritten = true;
      entry.node = topic.kind == protocol::Kind::actuator ? operator_node : catalogue.board_name(topic);
      entry.jitter = topic.jitter.count();
      set.entries.push_back(std::move(entry));
    }
  }
  if (mistakes.empty() && set.entries.empty())
    mistakes.push_back({"--rates", "every topic is off", "leave one on"});
  order_bus(set, catalogue.robot, mistakes);
  stop_at(mistakes, "--rates");
  if (!left_out.empty())
    set.remarks.push_back(
        fmt::format("Not in the set, as they have no period: requests, {}. --rates TOPIC=PERIOD "
                    "counts a topic's set points.",
                    left_out));
  if (!not_classic.empty())
    set.remarks.push_back(fmt::format(
        "Not in the set, as they are not classic frames: {}. Their load comes on top.", not_classic));
  return set;
}

void apply_rates(BusSet& set, const std::vector<Rate>& rates) {
  std::vector<Mistake> mistakes;
  for (const Rate& rate : rates) {
    bool found = false;
    for (BusEntry& entry : set.entries) {
      if (entry.name != rate.name) continue;
      found = true;
      if (!rate.off) entry.period = rate.period.count();
    }
    if (!found)
      mistakes.push_back(
          {rate.place, fmt::format("no message '{}'", rate.name), "a name from the set, as it is there"});
    if (rate.has_priority)
      mistakes.push_back(
          {rate.place, "a message of a file has the priority of its identifier", "leave out the @"});
    if (rate.off) std::erase_if(set.entries, [&](const BusEntry& entry) { return entry.name == rate.name; });
  }
  stop_at(mistakes, "--rates");
}

}  // namespace ocm::cli::analyse
