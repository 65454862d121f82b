#include "cli/output/selection.hpp"

#include <algorithm>

#include "cli/words/command.hpp"

namespace ocm::cli {
namespace {

/// "x", or "velocity.x" where the topic has several frames.
std::string name_within(const protocol::FrameLayout& layout, const protocol::Field& field) {
  std::string name{layout.name};
  if (!name.empty()) name += '.';
  return name += field.name;
}

}  // namespace

transport::Outcome<Selection> Selection::of(const protocol::Catalogue& catalogue,
                                            std::span<const std::string> words) {
  Selection selection;
  for (const std::string_view word : words) {
    const auto point = word.find('.');
    const std::string_view of_topic = word.substr(0, point);
    const std::string_view rest =
        point == std::string_view::npos ? std::string_view{} : word.substr(point + 1);
    std::vector<std::string> names;
    bool topic_found = false;
    const auto* const named = words::find_topic(catalogue, of_topic);
    bool found = false;
    for (const auto& topic : catalogue.topics) {
      const bool is_named = named != nullptr && topic.name == named->name;  // on several interfaces
      if (!is_named && !words::is_in_group(topic, of_topic)) continue;
      topic_found = true;
      for (const auto& layout : topic.frames)
        for (const auto& field : layout.values()) {
          const std::string name = name_within(layout, field);
          names.push_back(std::string{of_topic} + '.' + name);
          // A topic or a frame is what is on the wire; a field of several frames is meant in each of them.
          const bool whole = point == std::string_view::npos || rest == layout.name;
          const bool is_meant = rest == name || (rest == field.name && rest != layout.name);
          if (!is_meant && (!whole || field.is_derived())) continue;
          found = true;
          if (!selection.fields_.empty() && selection.has(layout, field)) continue;
          selection.fields_.push_back({&topic, &layout, &field, std::string{topic.name} + '.' + name});
        }
    }
    if (found) continue;
    if (!topic_found)
      return transport::Failure{"no topic '" + std::string{of_topic} + "'",
                                words::topic_suggestion(catalogue, of_topic)};
    const std::vector<std::string_view> candidates{names.begin(), names.end()};
    return transport::Failure{"no field '" + std::string{word} + "'", words::suggestion(word, candidates)};
  }
  return selection;
}

bool Selection::has(const protocol::FrameLayout& layout, const protocol::Field& field) const noexcept {
  return everything() || std::any_of(fields_.begin(), fields_.end(), [&](const ChosenField& chosen) {
           return chosen.layout == &layout && chosen.field == &field;
         });
}

bool Selection::has(const protocol::FrameLayout& layout) const noexcept {
  return everything() || std::any_of(fields_.begin(), fields_.end(),
                                     [&](const ChosenField& chosen) { return chosen.layout == &layout; });
}

}  // namespace ocm::cli
