/// Commands in words, as a person types them on a command line or writes them into a script:
///
///     publish TOPIC [PERIOD]     once TOPIC     stop [TOPIC|all]
///     drive X [Z] [--for T] | drive stop        led N|all COLOUR|off
///     set ACTUATOR FIELD=VALUE ...              send FRAME
///
/// each with `--priority P`. A command becomes frames; what is wrong is said of the word where it stands.
/// drive and led exist where the catalogue has actuators of that role; set and send always.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/decimal.hpp"
#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/client/command.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/words/quantity.hpp"
#include "generator/spec/edit_distance.hpp"

namespace ocm::cli::words {

using client::Command;
using client::Hold;
using client::set_point;

/// What is wrong with a command: at which word (its index), and what would be right.
struct WordError {
  std::size_t word = 0;
  std::string what;
  std::string remedy;
  friend bool operator==(const WordError&, const WordError&) = default;
};

namespace detail {

using Parsed = base::Result<Command, WordError>;

/// "did you mean gyro?" or, when nothing is near, "one of: a, b, c".
[[nodiscard]] inline std::string suggestion(std::string_view word,
                                            std::span<const std::string_view> candidates) {
  std::string_view nearest;
  std::size_t least = word.size() < 4 ? 2 : 3;
  for (const auto candidate : candidates) {
    const std::size_t d = spec::edit_distance(word, candidate);
    if (d < least) {
      least = d;
      nearest = candidate;
    }
  }
  if (!nearest.empty()) return "did you mean '" + std::string{nearest} + "'?";
  std::string all = "one of: ";
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (i != 0) all += ", ";
    all += candidates[i];
  }
  return all;
}

[[nodiscard]] inline std::string quoted(std::string_view word) {
  return "'" + std::string{word} + "'";
}

}  // namespace detail

/// The topics of one kind by name and alias, as a person may type them.
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

/// A number for a field, from "0.05m/s", "12" (in the field's unit) or the name of a value. The error is said
/// in words, with the field's unit and range.
[[nodiscard]] inline base::Result<std::int64_t, std::string> parse_value(const protocol::Field& field,
                                                                         std::string_view text) {
  for (const auto& value : field.values)
    if (!field.flags && value.name == text) return value.raw;
  const auto number_text = [&field](std::int64_t raw) {
    const auto physical = field.physical(raw);
    return physical ? std::string{base::to_text(*physical).view()} : std::to_string(raw);
  };
  std::string expected = number_text(field.raw_min) + " to " + number_text(field.raw_max);
  if (!field.unit.empty()) expected += " " + std::string{field.unit};
  if (!field.flags && !field.values.empty()) {
    std::string names;
    for (const auto& value : field.values) names.append(names.empty() ? "" : ", ").append(value.name);
    expected = names + ", or " + expected;
  }
  const auto quantity = parse_quantity(text);
  if (!quantity)
    return detail::quoted(text) +
           (field.values.empty() || field.flags ? " is not a number: " : " has no meaning: ") +
           std::string{field.name} + " takes " + expected;
  if (!quantity->unit.empty() && field.unit.empty())
    return detail::quoted(text) + " has a unit, but " + std::string{field.name} + " is a plain number, " +
           expected;
  const auto physical = convert(*quantity, field.unit);
  if (physical.error == base::Error::bad_unit)
    return detail::quoted(text) + " is in another unit: " + std::string{field.name} + " takes " + expected;
  const auto raw = physical ? field.raw_from(*physical) : base::Result<std::int64_t>{physical.error};
  if (!raw)
    return detail::quoted(text) + " is out of range: " + std::string{field.name} + " takes " + expected;
  return *raw;
}

/// "100,50,120", "#643278", "red" or "off".
[[nodiscard]] inline base::Result<std::array<std::uint8_t, 3>> parse_colour(std::string_view text) {
  struct Named {
    std::string_view name;
    std::array<std::uint8_t, 3> rgb;
  };
  constexpr Named names[] = {{"off", {0, 0, 0}},        {"black", {0, 0, 0}},      {"white", {255, 255, 255}},
                             {"red", {255, 0, 0}},      {"green", {0, 255, 0}},    {"blue", {0, 0, 255}},
                             {"yellow", {255, 255, 0}}, {"cyan", {0, 255, 255}},   {"magenta", {255, 0, 255}},
                             {"orange", {255, 128, 0}}, {"purple", {128, 0, 255}}, {"pink", {255, 96, 160}}};
  for (const auto& named : names)
    if (text == named.name) return named.rgb;
  std::array<std::uint8_t, 3> rgb{};
  if (text.starts_with('#')) {
    const auto number = base::parse_unsigned(text.substr(1), 16);
    if (!number || text.size() != 7) return base::Error::bad_syntax;
    for (std::size_t i = 0; i < 3; ++i) rgb[i] = static_cast<std::uint8_t>(*number >> (16 - 8 * i));
    return rgb;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto comma = text.find(',');
    const auto number = base::parse_unsigned(text.substr(0, comma));
    if (!number || (comma == std::string_view::npos) != (i == 2)) return base::Error::bad_syntax;
    if (*number > 255) return base::Error::out_of_range;
    rgb[i] = static_cast<std::uint8_t>(*number);
    text = comma == std::string_view::npos ? std::string_view{} : text.substr(comma + 1);
  }
  return rgb;
}

/// Reads one command at a time against a catalogue.
class CommandParser {
 public:
  explicit CommandParser(const protocol::Catalogue& catalogue) : catalogue_(&catalogue) {}

  /// `words[0]` is the verb. Options may stand anywhere.
  [[nodiscard]] base::Result<Command, WordError> parse(std::span<const std::string_view> words) const {
    if (words.empty()) return WordError{0, "no command", "one of: " + verbs()};
    Line line;
    for (std::size_t i = 0; i < words.size(); ++i) {
      const bool has_value = words[i] == "--priority" || words[i] == "--for";
      if (!has_value && words[i].starts_with("--"))
        return WordError{i, "unknown option " + detail::quoted(words[i]),
                         "--priority P, or --for T with drive"};
      if (!has_value) {
        line.words.push_back({words[i], i});
        continue;
      }
      if (i + 1 == words.size())
        return WordError{i, detail::quoted(words[i]) + " lacks its value", usage(words[i])};
      auto& option = words[i] == "--for" ? line.lasting : line.priority;
      option = Word{words[i + 1], i + 1};
      ++i;
    }
    if (line.words.empty()) return WordError{0, "no command", "one of: " + verbs()};
    std::optional<protocol::Priority> priority;  // none: the topic's own
    if (line.priority) {
      const auto parsed = protocol::parse_priority(line.priority->text);
      if (!parsed)
        return WordError{line.priority->index, detail::quoted(line.priority->text) + " is not a priority",
                         usage("--priority")};
      priority = *parsed;
    }
    const std::string_view verb = line.words[0].text;
    if (line.lasting && verb != "drive")
      return WordError{line.lasting->index, "--for goes with drive only", "leave it away"};
    if (verb == "publish") return publish(line, priority);
    if (verb == "once") return once(line, priority);
    if (verb == "stop") return stop(line, priority);
    if (verb == "drive") return drive(line, priority);
    if (verb == "led") return led(line, priority);
    if (verb == "set") return set(line, priority);
    if (verb == "send") return send(line);
    constexpr std::string_view known[] = {"publish", "once", "stop", "drive", "led", "set", "send"};
    return WordError{line.words[0].index, "unknown command " + detail::quoted(verb),
                     detail::suggestion(verb, known)};
  }

  /// Everything at rest: motors first, then every publisher.
  [[nodiscard]] Command stop_all(std::optional<protocol::Priority> priority) const {
    return client::stop_all(*catalogue_, priority);
  }

 private:
  struct Word {
    std::string_view text;
    std::size_t index;
  };
  struct Line {
    std::vector<Word> words;  // without options
    std::optional<Word> priority;
    std::optional<Word> lasting;
    [[nodiscard]] std::size_t size() const { return words.size(); }
    [[nodiscard]] const Word& operator[](std::size_t i) const { return words[i]; }
    /// Where something is missing: behind the last word.
    [[nodiscard]] std::size_t end() const { return words.back().index + 1; }
  };

  static std::string verbs() { return "publish, once, stop, drive, led, set, send"; }
  static std::string usage(std::string_view option) {
    return option == "--for" ? "a time such as --for 2s" : "--priority urgent, high, medium or low";
  }

  /// Too many words, or too few: said once for all verbs.
  static std::optional<WordError> check_count(const Line& line, std::size_t least, std::size_t most,
                                              std::string_view form) {
    if (line.size() < least)
      return WordError{line.end(), "something is missing", "write " + std::string{form}};
    if (line.size() > most)
      return WordError{line[most].index, detail::quoted(line[most].text) + " is too much",
                       "write " + std::string{form}};
    return {};
  }

  base::Result<const protocol::Topic*, WordError> topic(const Word& word,
                                                        std::optional<protocol::Kind> kind) const {
    const protocol::Topic* found = catalogue_->find(word.text);
    if (found != nullptr && (!kind || found->kind == *kind)) return found;
    if (found != nullptr) {
      const bool actuator = found->kind == protocol::Kind::actuator;
      return WordError{word.index,
                       detail::quoted(word.text) + (actuator ? " is an actuator" : " is a sensor"),
                       actuator ? "actuators are commanded with set, drive or led; sensors are asked"
                                : "sensors are asked with publish, once and stop"};
    }
    const auto words = topic_words(*catalogue_, kind);
    return WordError{word.index, "no topic " + detail::quoted(word.text),
                     detail::suggestion(word.text, words)};
  }

  detail::Parsed publish(const Line& line, std::optional<protocol::Priority> priority) const {
    if (auto error = check_count(line, 2, 3, "publish TOPIC [PERIOD]")) return *error;
    const auto sensor = topic(line[1], protocol::Kind::sensor);
    if (!sensor) return sensor.error;
    Command command;
    command.answers = *sensor;
    if (line.size() == 2) {
      command.frames = {
          protocol::encode_default_publish((*sensor)->id, priority.value_or((*sensor)->priority))};
      return command;
    }
    const Word& word = line[2];
    const auto period = parse_duration(word.text);
    if (period.error == base::Error::bad_unit)
      return WordError{word.index, detail::quoted(word.text) + " has no unit of time that the wire knows",
                       "write 500ms, 2s or 900us"};
    if (period.error == base::Error::bad_syntax)
      return WordError{word.index, detail::quoted(word.text) + " is not a period",
                       "write 500ms, 2s or 900us"};
    const auto wire =
        period ? protocol::Period::from(*period) : base::Result<protocol::Period>{base::Error::bad_period};
    if (!wire) {
      const bool fine =
          !period && !word.text.starts_with('-') && word.text.find('.') != std::string_view::npos;
      const base::Duration wanted = period ? *period : base::Duration{fine ? 1 : INT64_MAX};
      return WordError{word.index, "the wire cannot carry a period of " + std::string{word.text},
                       "nearest: " + to_text(protocol::Period::nearest(wanted))};
    }
    command.frames = {protocol::encode(
        {(*sensor)->id, protocol::Mode::publish, *wire, priority.value_or((*sensor)->priority)})};
    return command;
  }

  detail::Parsed once(const Line& line, std::optional<protocol::Priority> priority) const {
    if (auto error = check_count(line, 2, 2, "once TOPIC")) return *error;
    const auto sensor = topic(line[1], protocol::Kind::sensor);
    if (!sensor) return sensor.error;
    Command command;
    command.answers = *sensor;
    command.frames = {protocol::once((*sensor)->id, priority.value_or((*sensor)->priority))};
    return command;
  }

  detail::Parsed stop(const Line& line, std::optional<protocol::Priority> priority) const {
    if (auto error = check_count(line, 1, 2, "stop [TOPIC|all]")) return *error;
    if (line.size() == 1 || line[1].text == "all") return stop_all(priority);
    const auto any = topic(line[1], {});
    if (!any) return any.error;
    Command command;
    if ((*any)->kind == protocol::Kind::sensor) {
      command.frames = {protocol::stop((*any)->id, priority.value_or((*any)->priority))};
    } else {
      command.frames = {set_point(**any, {}, priority)};
      command.ends_hold = (*any)->role == protocol::Role::drive;
    }
    return command;
  }

  detail::Parsed drive(const Line& line, std::optional<protocol::Priority> priority) const {
    const protocol::Topic* motors = nullptr;
    for (const auto& candidate : catalogue_->topics)
      if (candidate.role == protocol::Role::drive) motors = &candidate;
    if (motors == nullptr || motors->frames[0].fields.size() < 2)
      return WordError{line[0].index, "robot " + detail::quoted(catalogue_->robot) + " has nothing to drive",
                       "its spec has no actuator with role drive; use set or send"};
    if (auto error = check_count(line, 2, 3, "drive X [Z] [--for T], or drive stop")) return *error;
    Command command;
    const can::Frame rest = set_point(*motors, {}, priority);
    if (line[1].text == "stop") {
      if (line.size() > 2 || line.lasting)
        return WordError{line[0].index, "drive stop stands alone", "write drive stop"};
      command.frames = {rest};
      command.ends_hold = true;
      return command;
    }
    const auto fields = motors->frames[0].fields;
    std::vector<std::int64_t> raw(fields.size());
    for (std::size_t i = 1; i < line.size(); ++i) {
      // Bare numbers are raw, um/s and urad/s, as the thesis's sender asks for them.
      const auto bare = base::parse_decimal(line[i].text);
      base::Result<std::int64_t, std::string> value;
      if (bare && bare->exponent >= 0) {
        const auto whole = base::detail::scaled(bare->digits, bare->exponent);
        if (whole && *whole >= fields[i - 1].raw_min && *whole <= fields[i - 1].raw_max)
          value = *whole;
        else
          value = detail::quoted(line[i].text) + " is out of range";
      } else if (bare) {
        value =
            detail::quoted(line[i].text) + " has no unit, and a bare number is a whole one of um/s or urad/s";
      } else {
        value = parse_value(fields[i - 1], line[i].text);
      }
      if (!value) return WordError{line[i].index, value.error, "write 0.05m/s, 5cm/s, 0.2rad/s or -30deg/s"};
      raw[i - 1] = *value;
    }
    command.hold = Hold{set_point(*motors, raw, priority), rest, {}};
    command.frames = {command.hold->frame};
    if (line.lasting) {
      const auto lasting = parse_duration(line.lasting->text);
      if (!lasting || lasting->count() <= 0)
        return WordError{line.lasting->index,
                         detail::quoted(line.lasting->text) + " is not a time above zero", usage("--for")};
      command.hold->lasting = *lasting;
    }
    return command;
  }

  detail::Parsed led(const Line& line, std::optional<protocol::Priority> priority) const {
    std::vector<const protocol::Topic*> lights;
    for (const auto& candidate : catalogue_->topics)
      if (candidate.role == protocol::Role::light && candidate.frames[0].fields.size() >= 3)
        lights.push_back(&candidate);
    if (lights.empty())
      return WordError{line[0].index, "robot " + detail::quoted(catalogue_->robot) + " has no lights",
                       "its spec has no actuator with role light; use set or send"};
    if (auto error = check_count(line, 3, 3, "led N|all COLOUR|off")) return *error;
    const Word& which = line[1];
    std::vector<const protocol::Topic*> chosen;
    if (which.text == "all") {
      chosen = lights;
    } else {
      const auto number = base::parse_unsigned(which.text);
      if (!number || *number < 1 || *number > lights.size())
        return WordError{which.index, "no LED " + detail::quoted(which.text),
                         "1 to " + std::to_string(lights.size()) + ", or all"};
      chosen = {lights[static_cast<std::size_t>(*number) - 1]};
    }
    const auto rgb = parse_colour(line[2].text);
    if (!rgb)
      return WordError{
          line[2].index,
          detail::quoted(line[2].text) +
              (rgb.error == base::Error::out_of_range ? " has a component over 255" : " is not a colour"),
          "write 100,50,120 or #643278 or a name such as red, white, off"};
    Command command;
    for (const auto* light : chosen)
      command.frames.push_back(
          set_point(*light, std::array<std::int64_t, 3>{(*rgb)[0], (*rgb)[1], (*rgb)[2]}, priority));
    return command;
  }

  detail::Parsed set(const Line& line, std::optional<protocol::Priority> priority) const {
    if (auto error = check_count(line, 3, SIZE_MAX - 1, "set ACTUATOR FIELD=VALUE ...")) return *error;
    const auto actuator = topic(line[1], protocol::Kind::actuator);
    if (!actuator) return actuator.error;
    const auto fields = (*actuator)->frames[0].fields;
    std::vector<std::int64_t> raw(fields.size());
    std::vector<bool> given(fields.size());
    for (std::size_t i = 2; i < line.size(); ++i) {
      const Word& word = line[i];
      const auto equals = word.text.find('=');
      const std::string_view name = word.text.substr(0, equals);
      std::size_t index = 0;
      while (index < fields.size() && fields[index].name != name) ++index;
      if (equals == std::string_view::npos || index == fields.size()) {
        std::vector<std::string_view> names;
        for (const auto& field : fields) names.push_back(field.name);
        return WordError{word.index,
                         equals == std::string_view::npos
                             ? detail::quoted(word.text) + " is not of the form FIELD=VALUE"
                             : std::string{(*actuator)->name} + " has no field " + detail::quoted(name),
                         detail::suggestion(name, names)};
      }
      if (given[index])
        return WordError{word.index, "field " + detail::quoted(name) + " is given twice", "give it once"};
      const auto value = parse_value(fields[index], word.text.substr(equals + 1));
      if (!value) return WordError{word.index, value.error, "for example " + std::string{name} + "=0"};
      raw[index] = *value;
      given[index] = true;
    }
    Command command;
    command.frames = {set_point(**actuator, raw, priority)};
    return command;
  }

  static detail::Parsed send(const Line& line) {
    if (auto error = check_count(line, 2, 2, "send FRAME")) return *error;
    if (line.priority)
      return WordError{line.priority->index, "a frame carries its priority in its identifier",
                       "leave --priority away"};
    const auto frame = can::parse_frame(line[1].text);
    if (!frame)
      return WordError{
          line[1].index, detail::quoted(line[1].text) + ": " + std::string{base::describe(frame.error)},
          "write 205#01840302 (three hex digits, or eight for an extended identifier), or 205#R"};
    if (frame->format == can::Format::error)
      return WordError{line[1].index,
                       detail::quoted(line[1].text) + " is an error frame, which only a controller makes",
                       "send a data or remote frame"};
    Command command;
    command.frames = {*frame};
    return command;
  }

  const protocol::Catalogue* catalogue_;
};

}  // namespace ocm::cli::words
