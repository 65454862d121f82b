#include "cli/watch/chosen_topics.hpp"

#include <fmt/format.h>

#include "cli/logs/format.hpp"
#include "cli/shared/messages.hpp"
#include "cli/words/topics.hpp"

namespace ocm::cli {

std::vector<const protocol::Topic*> chosen_topics(std::string_view verb, const protocol::Catalogue& catalogue,
                                                  std::span<const std::string> words) {
  std::vector<const protocol::Topic*> topics;
  for (const auto& word : words) {
    bool found = false;
    const auto* const named = words::find_topic(catalogue, word);
    for (const auto& topic : catalogue.topics) {
      const bool is_named = named != nullptr && topic.name == named->name;  // on several interfaces
      if (!is_named && !words::is_in_group(topic, word)) continue;
      topics.push_back(&topic);
      found = true;
    }
    if (found) continue;
    if (logs::names_file(word))
      fail({fmt::format("{}: no topic '{}', which names a file", verb, word),
            fmt::format(
                "decode, stats and plot read logs, record -o {} writes one; `amiroctl list` shows the topics",
                word)},
           exit_usage);
    fail({fmt::format("{}: no topic '{}'", verb, word), words::topic_suggestion(catalogue, word)},
         exit_usage);
  }
  return topics;
}

void tell_to_ask(const protocol::Catalogue& catalogue, std::span<const protocol::Topic* const> topics) {
  const auto is_asked = [](const protocol::Topic& topic) {
    return topic.kind == protocol::Kind::sensor && topic.role != protocol::Role::status &&
           topic.role != protocol::Role::refusal;
  };
  const protocol::Topic* asked = nullptr;
  for (const protocol::Topic* topic : topics)
    if (asked == nullptr && is_asked(*topic)) asked = topic;
  for (const protocol::Topic& topic : catalogue.topics)
    if (topics.empty() && asked == nullptr && is_asked(topic)) asked = &topic;
  if (asked != nullptr)
    remark(
        fmt::format("a sensor is silent until it is asked, as by `amiroctl publish {} 500ms`", asked->name));
}

}  // namespace ocm::cli
