/// Commands in words, as a person types them on a command line or writes them into a script:
///
///     publish TOPIC [PERIOD]     once TOPIC     stop [TOPIC|all]
///     drive X [Z] [--for T] | drive stop        led N|all COLOUR|off
///     set ACTUATOR|MESSAGE [FIELD=VALUE ...] [--every T [--for T]] [--force]
///     send FRAME
///
/// each with `--priority P`. A script has the options among the words; the command line has read them already
/// and hands them over as values. A command becomes frames; an error names the word that is wrong. drive and
/// led exist where the catalogue has actuators of that role; set and send always.
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
#include "ocm/can/any_text.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/client/command.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/words/colour.hpp"
#include "cli/words/command_options.hpp"
#include "cli/words/form.hpp"
#include "cli/words/message.hpp"
#include "cli/words/quantity.hpp"
#include "cli/words/suggestion.hpp"
#include "cli/words/topics.hpp"
#include "cli/words/value.hpp"
#include "cli/words/word_error.hpp"

namespace ocm::cli::words {

using client::Command;
using client::Hold;
using client::set_point;

namespace detail {

using Parsed = base::Result<Command, WordError>;

/// Whether a frame in candump's notation begins with as many hex digits as an identifier has.
[[nodiscard]] constexpr bool has_identifier(std::string_view frame) noexcept {
  const std::string_view id = frame.substr(0, frame.find('#'));
  return (id.size() == 3 || id.size() == 8) &&
         id.find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
}

}  // namespace detail

/// Reads one command at a time against a catalogue.
class CommandParser {
 public:
  /// `program` is what precedes a command in its usage: "amiroctl " on a command line, nothing in a
  /// script.
  explicit CommandParser(const protocol::Catalogue& catalogue, std::string_view program = {})
      : catalogue_(&catalogue), program_(program) {}

  /// `words[0]` is the verb; no word is an option.
  [[nodiscard]] detail::Parsed parse(Line words, const CommandOptions& options) const {
    if (words.empty()) return no_command();
    const std::string_view verb = words[0];
    if (const auto error = check_count(words)) return *error;
    if (verb == "publish") return publish(words, options.priority);
    if (verb == "once") return once(words, options.priority);
    if (verb == "stop") return stop(words, options.priority);
    if (verb == "drive") return drive(words, options);
    if (verb == "led") return led(words, options.priority);
    if (verb == "set") return set(words, options);
    if (verb == "send") return send(words);
    return WordError{0, "unknown command " + detail::quoted(verb), suggest([&] {
                       const auto* const topic = find_topic(*catalogue_, verb);
                       const bool is_set = topic != nullptr && topic->kind == protocol::Kind::actuator;
                       return is_set ? "its set point: set " + std::string{verb} + " FIELD=VALUE ..."
                                     : suggestion(verb, verbs());
                     })};
  }

  /// As a line of a script has it: options stand anywhere among the words, as `--for 2s` or `--for=2s`.
  [[nodiscard]] detail::Parsed parse_line(Line line) const {
    const auto split = split_options(line, [this](auto find) { return suggest(find); });
    if (!split) return split.error;
    const auto& [words, places, options, at] = *split;
    if (words.empty()) return no_command();
    if (options.lasting && words[0] != "drive" && words[0] != "set")
      return WordError{at.lasting, "--for goes with drive, and with set --every, only", "drop --for"};
    if (!at.set_option.empty() && words[0] != "set")
      return WordError{at.set, std::string{at.set_option} + " goes with set only",
                       "drop " + std::string{at.set_option}};
    if (options.priority && words[0] == "send")
      return WordError{at.priority, "a frame carries its priority in its identifier", "drop --priority"};
    auto command = parse(words, options);
    std::size_t& word = command.error.word;
    if (!command) word = word < places.size() ? places[word] : places.back() + 1;
    return command;
  }

  /// Whether errors from now on name the known word that is near to a mistyped one, which takes ten times as
  /// long as to find the error.
  void set_suggesting(bool suggests) { suggests_ = suggests; }

  /// Everything at rest: motors first, then every publisher.
  [[nodiscard]] Command stop_all(std::optional<protocol::Priority> priority) const {
    return client::stop_all(*catalogue_, priority);
  }

 private:
  static std::array<std::string_view, std::size(forms)> verbs() {
    std::array<std::string_view, std::size(forms)> names{};
    std::transform(std::begin(forms), std::end(forms), names.begin(), [](const Form& f) { return f.verb; });
    return names;
  }

  static WordError no_command() { return {0, "no command", one_of(verbs())}; }

  /// Too many words, or too few, by the form of the verb.
  [[nodiscard]] std::optional<WordError> check_count(Line line) const {
    const std::string_view form = form_of(line[0]);
    std::size_t count = 1;
    for (std::string_view rest = form; !rest.empty(); ++count) {
      const std::string_view word = rest.substr(0, rest.find(' '));
      rest.remove_prefix(std::min(word.size() + 1, rest.size()));
      if (word == "..." || word == "...]") return {};
      if (line.size() <= count && !word.starts_with('['))
        return WordError{line.size(), "missing " + std::string{word}, usage(line[0])};
    }
    if (form.empty() || line.size() <= count) return {};
    if (form.find("TOPIC") != std::string_view::npos && find_topic(*catalogue_, line[2]) != nullptr)
      return WordError{2, detail::quoted(line[2]) + " is a second topic",
                       "one topic a command: give one for each"};
    const std::string whole = any_apart(line.first(count + 1), time_or_speed_apart);
    return WordError{count, "unexpected argument " + detail::quoted(line[count]),
                     whole.empty() ? usage(line[0]) : "write it as one word, " + whole};
  }

  [[nodiscard]] std::string usage(std::string_view verb) const {
    return "usage: " + program_ + std::string{verb} + " " + std::string{form_of(verb)};
  }

  base::Result<const protocol::Topic*, WordError> topic(Line line, std::size_t at,
                                                        std::optional<protocol::Kind> kind) const {
    const std::string_view word = line[at];
    const protocol::Topic* found = find_topic(*catalogue_, word);
    if (found != nullptr && (!kind || found->kind == *kind)) return found;
    if (found != nullptr) {
      constexpr std::string_view kinds[] = {" is a sensor", " is an actuator", " is a message"};
      constexpr std::string_view remedies[] = {
          "sensors are asked with publish, once and stop",
          "actuators are commanded with set, drive or led; sensors are asked",
          "messages are sent with set, and come when their sender likes: see listen"};
      const auto kind_of_found = static_cast<std::size_t>(found->kind);
      return WordError{at, detail::quoted(word) + std::string{kinds[kind_of_found]},
                       std::string{remedies[kind_of_found]}};
    }
    return WordError{at, "no topic " + detail::quoted(word),
                     suggest([&] { return topic_suggestion(*catalogue_, word, kind); })};
  }

  detail::Parsed publish(Line line, std::optional<protocol::Priority> priority) const {
    const auto sensor = topic(line, 1, protocol::Kind::sensor);
    if (!sensor) return sensor.error;
    Command command;
    command.answers = *sensor;
    if (line.size() == 2) {
      command.frames = {
          protocol::encode_default_publish((*sensor)->id, priority.value_or((*sensor)->priority))};
      return command;
    }
    const std::string_view word = line[2];
    const auto period = parse_duration(word);
    if (period.error == base::Error::bad_unit) {
      if (const auto of_rate = period_of_rate(word))
        return WordError{2, detail::quoted(word) + " is a rate",
                         "write its period, " + to_text(protocol::Period::nearest(*of_rate))};
      return WordError{
          2, detail::quoted(word) + (lacks_unit(word) ? " needs a unit: us, ms or s" : " is in another unit"),
          "write 500ms, 2s or 900us"};
    }
    if (period.error == base::Error::bad_syntax)
      return WordError{2, detail::quoted(word) + " is not a period", "write 500ms, 2s or 900us"};
    const auto wire =
        period ? protocol::Period::from(*period) : base::Result<protocol::Period>{base::Error::bad_period};
    if (!wire) {
      const base::Duration too_long{word.starts_with('-') ? INT64_MIN : INT64_MAX};
      const auto rounded = nearest_duration(word);
      return WordError{2, "the wire cannot carry a period of " + std::string{word},
                       "nearest: " + to_text(protocol::Period::nearest(rounded ? *rounded : too_long))};
    }
    command.frames = {protocol::encode(
        {(*sensor)->id, protocol::Mode::publish, *wire, priority.value_or((*sensor)->priority)})};
    return command;
  }

  detail::Parsed once(Line line, std::optional<protocol::Priority> priority) const {
    const auto sensor = topic(line, 1, protocol::Kind::sensor);
    if (!sensor) return sensor.error;
    Command command;
    command.answers = *sensor;
    command.frames = {protocol::once((*sensor)->id, priority.value_or((*sensor)->priority))};
    return command;
  }

  detail::Parsed stop(Line line, std::optional<protocol::Priority> priority) const {
    if (line.size() == 1 || line[1] == "all") {
      auto all = stop_all(priority);
      if (all.frames.empty())
        return WordError{
            0, "robot " + detail::quoted(catalogue_->robot) + " has nothing to stop",
            "its spec has neither sensors nor motors: what holds until another comes is ended by "
            "set, with zeros; what sends a message again and again is ended where it runs"};
      return all;
    }
    const auto any = topic(line, 1, {});
    if (!any) return any.error;
    Command command;
    if ((*any)->kind == protocol::Kind::sensor) {
      command.frames = {protocol::stop((*any)->id, priority.value_or((*any)->priority))};
    } else if ((*any)->is_message()) {
      return topic(line, 1, protocol::Kind::sensor).error;
    } else {
      command.frames = {set_point(**any, {}, priority)};
      command.ends_hold = (*any)->role == protocol::Role::drive;
    }
    return command;
  }

  /// Of the only frame of an actuator; nullptr if there is no such field, or no actuator.
  static const protocol::Field* field_of(const protocol::Topic* actuator, std::string_view name) {
    if (actuator != nullptr)
      for (const auto& field : actuator->frames[0].fields)
        if (field.name == name) return &field;
    return nullptr;
  }

  detail::Parsed drive(Line line, const CommandOptions& options) const {
    const auto priority = options.priority;
    const protocol::Topic* motors = nullptr;
    for (const auto& candidate : catalogue_->topics)
      if (candidate.role == protocol::Role::drive) motors = &candidate;
    const std::array velocities = {field_of(motors, "x"), field_of(motors, "z")};
    if (velocities[0] == nullptr || velocities[1] == nullptr)
      return WordError{0, "robot " + detail::quoted(catalogue_->robot) + " has nothing to drive",
                       "its spec has no actuator with role drive; use set or send"};
    Command command;
    const can::Frame rest = set_point(*motors, {}, priority);
    if (line[1] == "stop") {
      if (line.size() > 2 || options.lasting)
        return WordError{0, "drive stop takes no velocity and no --for", "usage: " + program_ + "drive stop"};
      command.frames = {rest};
      command.ends_hold = true;
      return command;
    }
    const auto fields = motors->frames[0].fields;
    std::vector<std::int64_t> raw(fields.size());
    constexpr std::string_view remedies[] = {"write 0.05m/s, 5cm/s or 50000um/s",
                                             "write 0.2rad/s or 30deg/s"};
    for (std::size_t i = 1; i < line.size(); ++i) {
      const auto value = parse_typed_value(*velocities[i - 1], line[i]);
      if (!value) {
        const std::string whole =
            i + 1 < line.size() ? written_apart(*velocities[i - 1], line[i], line[i + 1]) : std::string{};
        return WordError{i, value.error,
                         whole.empty() ? std::string{remedies[i - 1]} : "write it as one word, " + whole};
      }
      raw[static_cast<std::size_t>(velocities[i - 1] - fields.data())] = *value;
    }
    command.hold = Hold{set_point(*motors, raw, priority), rest, {}};
    command.frames = {command.hold->frame};
    command.hold->lasting = options.lasting.value_or(base::Duration{});
    return command;
  }

  detail::Parsed led(Line line, std::optional<protocol::Priority> priority) const {
    std::vector<const protocol::Topic*> lights;
    for (const auto& candidate : catalogue_->topics)
      if (candidate.role == protocol::Role::light && candidate.frames[0].fields.size() >= 3)
        lights.push_back(&candidate);
    if (lights.empty())
      return WordError{0, "robot " + detail::quoted(catalogue_->robot) + " has no lights",
                       "its spec has no actuator with role light; use set or send"};
    const std::string_view which = line[1];
    std::vector<const protocol::Topic*> chosen;
    if (which == "all") {
      chosen = lights;
    } else {
      const auto number = base::parse_unsigned(which);
      if (!number || *number < 1 || *number > lights.size())
        return WordError{1, "no LED " + detail::quoted(which),
                         "1 to " + std::to_string(lights.size()) + ", or all"};
      chosen = {lights[static_cast<std::size_t>(*number) - 1]};
    }
    const auto rgb = parse_colour(line[2]);
    if (!rgb)
      return WordError{
          2,
          detail::quoted(line[2]) +
              (rgb.error == base::Error::out_of_range ? " has a component over 255" : " is not a colour"),
          colour_remedy(line[2])};
    Command command;
    for (const auto* light : chosen)
      command.frames.push_back(
          set_point(*light, std::array<std::int64_t, 3>{(*rgb)[0], (*rgb)[1], (*rgb)[2]}, priority));
    return command;
  }

  /// What was written with the field's unit, where only that was missing.
  static std::string example_of(const protocol::Field& field, std::string_view text) {
    const std::string unit{field.unit};
    const std::string with_unit = std::string{text} + unit;
    if (lacks_unit(text) && parse_typed_value(field, with_unit)) return with_unit;
    for (const char* const number : {"0.1", "1", "10", "100"}) {
      const auto value = parse_typed_value(field, number + unit);
      if (value && *value != 0 && is_in_stated_range(field, *value)) return number + unit;
    }
    return "0" + unit;
  }

  static std::string colour_remedy(std::string_view word) {
    std::vector<std::string_view> names;
    for (const auto& named : named_colours) names.push_back(named.name);
    const std::string_view near = nearest(word, names);
    return near.empty() ? "write 100,50,120 or #643278 or a name such as red, white, off"
                        : "did you mean " + detail::quoted(near) + "?";
  }

  detail::Parsed set(Line line, const CommandOptions& options) const {
    const auto found = settable(line);
    if (!found) return found.error;
    const protocol::Topic& target = **found;
    // A message may have no fields, or all at their start values; set points of zero are said.
    if (!target.is_message() && line.size() == 2) return WordError{2, "missing FIELD=VALUE", usage(line[0])};
    const auto given = given_fields(line, target, options.force);
    if (!given) return given.error;
    if (options.lasting && !options.every)
      return WordError{0, "--for without --every", "write how often it is sent, such as --every 100ms"};
    Command command;
    if (target.is_message()) {
      if (options.priority)
        return WordError{0, "a message carries its priority in its identifier", "drop --priority"};
      const auto& layout = target.frames[0];
      auto bytes = compose(target, *given);
      if (!bytes) return bytes.error;
      if (!layout.any_length()) {
        put(command, frame_of(layout, *bytes));
      } else {
        command.broadcast = client::Broadcast{&target, std::move(*bytes)};
        if (const auto lasts = j1939::broadcast_time(layout.length); options.every && *options.every < lasts)
          return WordError{0,
                           "--every " + to_text(*options.every) + " is shorter than a broadcast of " +
                               std::string{target.name} + " takes",
                           "it has " + std::to_string(command.broadcast->frames()) + " frames, " +
                               to_text(j1939::broadcast_distance) + " apart: --every " + to_text(lasts) +
                               " or longer"};
      }
    } else {
      if (options.every && target.role == protocol::Role::drive)
        return WordError{0, std::string{target.name} + " is not set again and again",
                         "use drive, which ends with a set point of zero"};
      if (options.every && target.timeout > client::longest_watchdog)
        return WordError{0, std::string{target.name} + " is not set again and again",
                         "each set point begins it again, and it goes on without this program: set it once"};
      std::vector<std::int64_t> raw(given->size());
      for (std::size_t i = 0; i < raw.size(); ++i)
        if ((*given)[i]) raw[i] = (*given)[i]->raw;
      command.frames = {set_point(target, raw, options.priority)};
    }
    if (options.every)
      command.repeat = client::Repeat{*options.every, options.lasting.value_or(base::Duration{})};
    return command;
  }

  /// An actuator or a message.
  base::Result<const protocol::Topic*, WordError> settable(Line line) const {
    const auto found = topic(line, 1, {});
    if (found && (*found)->kind != protocol::Kind::sensor) return *found;
    // Without messages, what is no topic, or a sensor, is reported as before there were any.
    for (const auto& each : catalogue_->topics)
      if (each.is_message() && !found) return found.error;
    return topic(line, 1, protocol::Kind::actuator);
  }

  /// The words FIELD=VALUE, from the third word on.
  base::Result<GivenFields, WordError> given_fields(Line line, const protocol::Topic& target,
                                                    bool force) const {
    const auto fields = target.frames[0].fields;
    GivenFields given(fields.size());
    for (std::size_t i = 2; i < line.size(); ++i) {
      const std::string_view word = line[i];
      const auto equals = word.find('=');
      const std::string_view name = word.substr(0, equals);
      std::size_t index = 0;
      while (index < fields.size() && fields[index].name != name) ++index;
      if (equals == std::string_view::npos || index == fields.size()) {
        std::vector<std::string_view> names;
        for (const auto& field : fields) names.push_back(field.name);
        if (index < fields.size())
          return WordError{
              i, detail::quoted(word) + " is not of the form FIELD=VALUE",
              "write a value behind it: " + std::string{name} + "=0" +
                  (target.role == protocol::Role::light ? "; `amiroctl led` takes colours" : "")};
        return WordError{i, std::string{target.name} + " has no field " + detail::quoted(name),
                         suggest([&] { return suggestion(name, names); })};
      }
      if (given[index])
        return WordError{i, "field " + detail::quoted(name) + " is given twice", "give it once"};
      protocol::Field field = fields[index];
      // Of a message, whose range is advice, what counts is what the bits hold.
      if (force && target.is_message()) field.min = field.max = {};
      const std::string_view text = word.substr(equals + 1);
      // The number of a message is physical wherever messages are known; it needs no unit.
      // [docs/decisions/0027]
      const auto value = target.is_message() ? parse_value(field, text) : parse_typed_value(field, text);
      if (!value) {
        const std::string whole =
            i + 1 < line.size() ? written_apart(field, text, line[i + 1]) : std::string{};
        return WordError{i, value.error,
                         (whole.empty() ? "for example " : "write it as one word, ") + std::string{name} +
                             "=" + (whole.empty() ? example_of(field, text) : whole)};
      }
      if (!is_in_stated_range(field, *value))
        return WordError{i, beyond_stated_range(field, text),
                         target.is_message() ? force_beyond_range : "a value within it"};
      given[index] = Given{*value, i};
    }
    return given;
  }

  static detail::Parsed send(Line line) {
    const auto frame = can::parse_any_frame(line[1]);
    const auto error = frame ? can::validate(*frame).error : frame.error;
    if (error == base::Error::bad_length && line[1].find("##") != std::string_view::npos)
      return WordError{1, detail::quoted(line[1]) + ": " + std::string{base::describe(error)},
                       "CAN FD has frames of 0 to 8, 12, 16, 20, 24, 32, 48 and 64 bytes"};
    if (error != base::Error::none)
      return WordError{
          1,
          detail::quoted(line[1]) + ": " +
              std::string{error == base::Error::bad_identifier && !detail::has_identifier(line[1])
                              ? "the identifier is not three hex digits, or eight"
                              : base::describe(error)},
          "write 205#01840302 (three hex digits, or eight for an extended identifier), 205#R, or "
          "205##101840302 for CAN FD"};
    if (frame->format == can::Format::error)
      return WordError{1, detail::quoted(line[1]) + " is an error frame, which only a controller makes",
                       "send a data or remote frame"};
    Command command;
    put(command, *frame);
    return command;
  }

  static void put(Command& command, const can::AnyFrame& frame) {
    if (const auto classic = frame.classic())
      command.frames = {*classic};
    else
      command.fd_frames = {frame};
  }

  /// The known word that is near to a mistyped one is looked for only where it is shown.
  template <class Find>
  [[nodiscard]] std::string suggest(Find find) const {
    return suggests_ ? find() : std::string{"correct the errors before this one first"};
  }

  const protocol::Catalogue* catalogue_;
  std::string program_;
  bool suggests_ = true;
};

}  // namespace ocm::cli::words
