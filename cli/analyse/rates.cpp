/// A robot's own traffic as a set of messages, and periods that differ from the spec's.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <system_error>

#include <fmt/format.h>

#include "ocm/protocol/identifier.hpp"

#include "cli/analyse/set.hpp"
#include "cli/shared/messages.hpp"
#include "cli/words/command.hpp"
#include "cli/words/quantity.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli::analyse {
namespace {

/// So many doubts are listed one by one: a file may have hundreds, of which few matter for the load.
constexpr std::size_t most_doubts = 5;

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

namespace {

/// A topic that a rate names, by itself or with its group; the last one counts.
struct Chosen {
  const protocol::Topic* topic;
  const Rate* rate;
};

std::vector<Chosen> choose(const protocol::Catalogue& catalogue, const std::vector<Rate>& rates,
                           std::vector<Mistake>& mistakes) {
  std::vector<Chosen> chosen;
  for (const Rate& rate : rates) {
    bool found = false;
    const auto* const named = words::find_topic(catalogue, rate.name);
    for (const auto& topic : catalogue.topics) {
      if (named != &topic && !words::is_in_group(topic, rate.name)) continue;
      found = true;
      chosen.push_back({&topic, &rate});
    }
    const auto words = words::topic_words(catalogue);
    if (!found)
      mistakes.push_back(
          {rate.place, fmt::format("no topic '{}'", rate.name), words::suggestion(rate.name, words)});
    if (rate.has_priority && named != nullptr && named->is_message())
      mistakes.push_back(
          {rate.place, fmt::format("'{}' has the priority of its identifier", rate.name), "leave out the @"});
  }
  return chosen;
}

/// How a topic is sent.
struct Sending {
  base::Duration period;
  protocol::Priority priority;
  bool rated = false;  ///< a rate names it
  bool off = false;
};

Sending sending_of(const protocol::Topic& topic, std::span<const Chosen> chosen) {
  const bool drives = topic.role == protocol::Role::drive;
  Sending sending{drives ? client::hold_period : topic.usual_period(), topic.priority};
  for (const Chosen& each : chosen) {
    if (each.topic != &topic) continue;
    sending.rated = true;
    sending.off = each.rate->off;
    if (!sending.off) sending.period = each.rate->period;
    if (each.rate->has_priority) sending.priority = each.rate->priority;
  }
  return sending;
}

void add_frames(const protocol::Catalogue& catalogue, const protocol::Topic& topic, const Sending& sending,
                BusSet& set) {
  if (sending.period.count() == 0) {
    set.left_out.push_back({std::string{topic.name}, LeftOut::Reason::no_period});
    return;
  }
  for (std::size_t i = 0; i < topic.frames.size(); ++i) {
    const protocol::FrameRef ref{&topic, static_cast<std::uint8_t>(i)};
    const auto& frame = ref.layout();
    BusEntry entry;
    entry.name = frame.name.empty() ? std::string{topic.name} : fmt::format("{}.{}", topic.name, frame.name);
    entry.head.id = protocol::identifier_of(ref, sending.priority);
    entry.head.format = protocol::format_of(frame);
    entry.head.length = frame.dlc();
    entry.bits = frame.worst_bits[static_cast<std::size_t>(sending.priority)];
    entry.period = sending.period.count();
    entry.deadline = topic.deadline.count() == 0 ? analysis::implicit_deadline : topic.deadline.count();
    entry.overwritten = true;
    entry.node = topic.kind == protocol::Kind::actuator ? operator_node : catalogue.board_name(topic);
    entry.jitter = topic.jitter.count();
    set.entries.push_back(std::move(entry));
  }
}

/// Nothing: the set has an entry, or nothing but what the spec leaves out.
std::optional<Mistake> nothing_sent(const BusSet& set, const protocol::Catalogue& catalogue,
                                    const std::string& source) {
  if (catalogue.topics.empty() && set.left_out.empty())
    return Mistake{source, "the file has no message", "a file that has some"};
  if (!set.entries.empty()) return std::nullopt;
  if (set.left_out.empty()) return Mistake{"--rates", "every topic is off", "leave one on"};
  return Mistake{
      source, fmt::format("no message has a cycle time or a shortest distance, of {}", set.left_out.size()),
      "--rates NAME=PERIOD gives one; in a DBC file BA_ \"GenMsgCycleTime\" BO_ 257 10; says "
      "every 10 ms"};
}

}  // namespace

BusSet robot_bus(const protocol::Catalogue& catalogue, const spec::Model* model,
                 const std::vector<Rate>& rates, const std::string& source) {
  std::vector<Mistake> mistakes;
  const auto chosen = choose(catalogue, rates, mistakes);
  BusSet set;
  set.bit_rate = catalogue.bit_rate;
  bool has_topics = false;
  std::size_t messages = 0;  // messages of a catalogue are in the order of their model
  for (const auto& topic : catalogue.topics) {
    const spec::MessageModel* message = nullptr;
    if (topic.is_message() && model != nullptr && messages < model->messages.size())
      message = &model->messages[messages++];
    has_topics = has_topics || !topic.is_message();
    const Sending sending = sending_of(topic, chosen);
    if (sending.off) continue;
    if (message == nullptr) {
      add_frames(catalogue, topic, sending, set);
    } else if (auto entry = entry_of(*message, catalogue.board_name(topic),
                                     sending.rated ? sending.period.count() : 0, set.left_out)) {
      set.entries.push_back(std::move(*entry));
    }
  }
  if (model != nullptr) {
    set.data_bit_rate = model->data_bit_rate;
    for (const std::string& name : model->too_long) set.left_out.push_back({name, LeftOut::Reason::too_long});
  }
  if (const auto nothing = nothing_sent(set, catalogue, source); nothing && mistakes.empty())
    mistakes.push_back(*nothing);
  order_bus(set, source, mistakes);
  stop_at(mistakes, source);
  limit_clocks(set);
  if (has_topics)
    set.remarks.emplace_back("Requests are not in the set: each can delay a frame by its own length.");
  if (std::any_of(set.entries.begin(), set.entries.end(),
                  [](const BusEntry& entry) { return entry.any_id != 0; }))
    set.remarks.emplace_back(
        "A parameter group of J1939 counts once, with the priority that the spec gives it: as one node sends "
        "it.");
  return set;
}

BusSet read_spec(std::string_view text, const std::string& file, const std::vector<Rate>& rates) {
  const spec::Loaded loaded = spec::parse(text, file);
  std::vector<Mistake> mistakes;
  for (const spec::Problem& problem : loaded.problems)
    mistakes.push_back({problem.place, problem.what, problem.remedy});
  stop_at(mistakes, file);
  BusSet set = robot_bus(loaded.spec->catalogue(), &loaded.spec->model(), rates, file);
  const std::size_t told = std::min(loaded.doubts.size(), most_doubts);
  for (const spec::Problem& doubt : std::span{loaded.doubts}.first(told))
    set.remarks.push_back(fmt::format("{}: {}; {}.", doubt.place, doubt.what, doubt.remedy));
  if (told < loaded.doubts.size())
    set.remarks.push_back(
        fmt::format("{}: {}.", file, counted(loaded.doubts.size() - told, "more doubtful place")));
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
  if (set.entries.empty() && !rates.empty() && mistakes.empty())
    mistakes.push_back({"--rates", "every message is off", "leave one on"});
  stop_at(mistakes, "--rates");
}

}  // namespace ocm::cli::analyse
