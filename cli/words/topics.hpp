/// Topics as people name them: by name, by alias, and by number, as the thesis's menus do. [Thesis,
/// figure 6.2]
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/text.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/words/suggestion.hpp"

namespace ocm::cli::words {

/// "gyroscope", "gyro" or "0x08"; nullptr if there is none. A number has its 0x: a spec may name a topic "be"
/// or "add".
[[nodiscard]] constexpr const protocol::Topic* find_topic(const protocol::Catalogue& catalogue,
                                                          std::string_view word) noexcept {
  if (const auto* const named = catalogue.find(word)) return named;
  if (!word.starts_with("0x") && !word.starts_with("0X")) return nullptr;
  const auto id = base::parse_unsigned(word.substr(2), 16);
  if (!id || *id > 0xFF) return nullptr;
  return catalogue.find(protocol::TopicId{static_cast<std::uint8_t>(*id)});
}

/// "lights" is a group of topics; an empty word is none, though topics without a group have an empty one.
[[nodiscard]] constexpr bool is_in_group(const protocol::Topic& topic, std::string_view word) noexcept {
  return !word.empty() && topic.group == word;
}

/// The topics of one kind by name and alias, for suggestions.
[[nodiscard]] inline std::vector<std::string_view> topic_words(const protocol::Catalogue& catalogue,
                                                               std::optional<protocol::Kind> kind = {}) {
  std::vector<std::string_view> words;
  for (const auto& topic : catalogue.topics) {
    if (kind && topic.kind != *kind) continue;
    words.push_back(topic.name);
    words.insert(words.end(), topic.aliases.begin(), topic.aliases.end());
  }
  return words;
}

/// What to say of a word that is no topic: it may be a number that lacks its 0x, hexadecimal or decimal; else
/// as of any mistyped word.
[[nodiscard]] inline std::string topic_suggestion(const protocol::Catalogue& catalogue, std::string_view word,
                                                  std::optional<protocol::Kind> kind = {}) {
  for (const unsigned radix : {16U, 10U}) {
    const auto number = base::parse_unsigned(word, radix);
    if (!number || *number > 0xFF) continue;
    const auto* const topic = catalogue.find(protocol::TopicId{static_cast<std::uint8_t>(*number)});
    if (topic == nullptr || (kind && topic->kind != *kind)) continue;
    base::Text<8> id;
    id << "0x";
    id.hex(*number, 2);
    return "did you mean '" + std::string{id.view()} + "' (" + std::string{topic->name} + ")?";
  }
  return suggestion(word, topic_words(catalogue, kind));
}

}  // namespace ocm::cli::words
