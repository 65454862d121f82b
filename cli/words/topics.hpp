/// Topics as people name them: by name, by alias, and by number, as the thesis's menus do. [Thesis,
/// figure 6.2]
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/text.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/words/suggestion.hpp"

namespace ocm::cli::words {

/// "gyroscope", "gyro" or "0x08", a message also by its identifier, such as "0x201", of 11 bits before one of
/// 29; nullptr if there is none. A number has its 0x: a spec may name a topic "be" or "add".
[[nodiscard]] constexpr const protocol::Topic* find_topic(const protocol::Catalogue& catalogue,
                                                          std::string_view word) noexcept {
  if (const auto* const named = catalogue.find(word)) return named;
  if (!word.starts_with("0x") && !word.starts_with("0X")) return nullptr;
  const auto id = base::parse_unsigned(word.substr(2), 16);
  if (!id) return nullptr;
  if (*id <= 0xFF)
    if (const auto* const topic = catalogue.find(protocol::TopicId{static_cast<std::uint8_t>(*id)}))
      return topic;
  const protocol::Topic* of_29_bits = nullptr;
  for (const auto& topic : catalogue.topics) {
    if (!topic.is_message()) continue;
    const protocol::Address& address = topic.frames[0].address;
    if (address.by != protocol::Address::By::identifier || address.number != *id) continue;
    if (!address.extended) return &topic;
    if (of_29_bits == nullptr) of_29_bits = &topic;
  }
  return of_29_bits;
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

/// "it is a field of Status: Status.Torque", of at most three topics; with the frame where a topic has
/// several. Empty: of none.
[[nodiscard]] inline std::string whose_field(const protocol::Catalogue& catalogue, std::string_view word) {
  std::string topics;
  std::string example;
  std::size_t found = 0;
  for (const auto& topic : catalogue.topics) {
    const auto frame = std::find_if(topic.frames.begin(), topic.frames.end(), [word](const auto& each) {
      return std::any_of(each.fields.begin(), each.fields.end(),
                         [word](const protocol::Field& field) { return field.name == word; });
    });
    if (frame == topic.frames.end() || ++found > 3) continue;
    if (example.empty()) {
      example = std::string{topic.name} + '.';
      if (topic.frames.size() > 1) example.append(frame->name).append(".");
      example += word;
    }
    topics.append(topics.empty() ? "" : ", ").append(topic.name);
  }
  if (found == 0) return {};
  if (found > 3) topics += " and " + std::to_string(found - 3) + " more";
  return "it is a field of " + topics + ": " + example;
}

/// How to see a topic's value such as gyro.z; empty: the word is not a topic with one of its values.
[[nodiscard]] inline std::string topic_of_field(const protocol::Catalogue& catalogue, std::string_view word) {
  const std::size_t point = word.find('.');
  const auto* const topic = find_topic(catalogue, word.substr(0, point));
  if (point == word.npos || topic == nullptr) return {};
  const std::string_view rest = word.substr(point + 1);
  for (const protocol::FrameLayout& frame : topic->frames)
    for (const protocol::Field& field : frame.values()) {
      const bool whole = rest.size() == frame.name.size() + 1 + field.name.size() &&
                         rest.starts_with(frame.name) && rest[frame.name.size()] == '.' &&
                         rest.ends_with(field.name);
      if (whole || rest == field.name)
        return "the topic is '" + std::string{topic->name} +
               "'; listen and decode show one of its fields with --field " + std::string{word};
    }
  return {};
}

/// "it is the identifier of a sample of gyroscope", for one as candump shows it; empty: of none.
[[nodiscard]] inline std::string whose_identifier(const protocol::Catalogue& catalogue,
                                                  std::string_view word) {
  const bool marked = word.starts_with("0x") || word.starts_with("0X");
  const auto number = base::parse_unsigned(word.substr(marked ? 2 : 0), 16);
  if (!number || *number <= 0xFF || *number > can::max_base_id) return {};
  const auto id = protocol::Identifier::decode(static_cast<std::uint32_t>(*number));
  for (const auto& topic : catalogue.topics) {
    if (topic.is_message()) continue;
    const bool sensor = topic.kind == protocol::Kind::sensor;
    const bool asked = sensor && id.direction == protocol::Direction::command && id.topic == topic.id;
    const bool sent = sensor == (id.direction == protocol::Direction::sensor) &&
                      std::any_of(topic.frames.begin(), topic.frames.end(),
                                  [&id](const protocol::FrameLayout& frame) { return frame.id == id.topic; });
    if (!asked && !sent) continue;
    return std::string{"it is the identifier of "} +
           (asked    ? "a request to "
            : sensor ? "a sample of "
                     : "a set point of ") +
           std::string{topic.name};
  }
  return {};
}

/// What to say of a word that is no topic: it may be a number that lacks its 0x, hexadecimal or decimal, one
/// of a topic's fields, or an identifier of the bus; else as of any mistyped word.
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
  if (std::string of = topic_of_field(catalogue, word); !of.empty() && kind != protocol::Kind::actuator)
    return of;
  if (std::string field = whose_field(catalogue, word); !field.empty()) return field;
  if (std::string of = whose_identifier(catalogue, word); !of.empty()) return of;
  const auto words = topic_words(catalogue, kind);
  if (words.empty()) return "the spec has none: --spec or AMIROCTL_SPEC names another";
  return suggestion(word, words);
}

}  // namespace ocm::cli::words
