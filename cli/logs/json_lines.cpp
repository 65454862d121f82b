#include "cli/logs/json_lines.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/text.hpp"
#include "ocm/can/text.hpp"
#include "ocm/client/counted.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/logs/json_scanner.hpp"
#include "cli/output/output.hpp"
#include "cli/words/command.hpp"
#include "cli/words/suggestion.hpp"

namespace ocm::cli::logs {
namespace {

/// Printed for people; other keys say the same.
constexpr std::string_view printed_keys[] = {"units",  "names",       "error",     "pgn",
                                             "source", "destination", "transport", "message"};
constexpr std::size_t most_unknown = 64;

std::string shown(std::string_view text) {
  return '"' + log::Complaints::printable(text) + '"';
}

/// Of pages that exclude each other, too.
bool has_common_bits(std::span<const protocol::Field> fields) {
  std::vector<std::uint8_t> taken;
  for (const auto& field : fields) {
    const unsigned end = field.position.bytes();
    if (taken.size() < end) taken.resize(end);
    for (unsigned byte = field.position.start / 8U; byte < end; ++byte) {
      const std::uint8_t bits = field.position.bits_in_byte(byte);
      if ((taken[byte] & bits) != 0) return true;
      taken[byte] = static_cast<std::uint8_t>(taken[byte] | bits);
    }
  }
  return false;
}

/// The shortest frame that holds the layout.
std::uint8_t length_of(const log::Entry& entry, const protocol::FrameLayout& layout) {
  return entry.is_fd() ? log::fd_length(log::fd_dlc(layout.length)) : layout.dlc();
}

}  // namespace

JsonLineParser::JsonLineParser(const protocol::Catalogue& catalogue, Values values)
    : catalogue_(&catalogue), values_(values), index_(catalogue) {
  for (const auto& topic : catalogue.topics)
    for (const auto& layout : topic.frames) {
      if (layout.fields.empty()) continue;
      auto& texts = texts_[&layout];
      for (const auto& field : layout.fields) {
        texts.fields.emplace_back(field);
        texts.multiplexed = texts.multiplexed || field.selector != protocol::no_selector;
      }
      texts.given_in.resize(texts.fields.size());
      texts.overlapping = has_common_bits(layout.fields);
    }
}

bool JsonLineParser::refuse(log::Cause cause, std::string what, std::string remedy) {
  problem_ = {cause, std::move(what), std::move(remedy)};
  return false;
}

bool JsonLineParser::refuse_twice(std::string_view what, std::string_view name) {
  return refuse(log::Cause::syntax, fmt::format("{} {} is given twice", what, shown(name)), "give it once");
}

bool JsonLineParser::parse(std::string_view line, log::Entry& entry, std::string_view& bus) {
  if (!scan(line)) return false;
  entry = log::Entry{};
  Meaning meaning;
  if (!take_time(entry) || !take_bus(bus)) return false;
  if (index_.has_buses()) index_.name(interface_ = interfaces_.number(bus), bus);
  if (!(record_.id ? take_id(entry, meaning) : take_topic(entry, meaning))) return false;
  if (!take_data(entry, meaning) || !take_extras(entry)) return false;
  if (record_.has_fields && !put_fields(entry, meaning)) return false;
  if (record_.time) last_ = entry.time;
  return true;
}

bool JsonLineParser::scan(std::string_view line) {
  ++lines_;
  problem_.what.clear();
  record_.time = record_.bus = record_.id = record_.priority = record_.topic = {};
  record_.frame = record_.data = record_.direction = record_.raw_dlc = {};
  record_.has_fd = record_.has_fields = false;
  record_.field_count = 0;
  const auto broken = [&] {
    return refuse(log::Cause::syntax, "no JSON object in one line: " + shown(line),
                  "expected one object a line, as decode --json prints it; jq needs -c");
  };
  JsonScanner scanner{line};
  if (!scanner.take('{')) return broken();
  if (!scanner.take('}')) {
    do {
      std::string_view key;
      if (!scanner.take_key(key)) return broken();
      if (key == "fields") {
        if (record_.has_fields) return refuse_twice("key", key);
        if (!scan_fields(scanner)) return problem_.what.empty() ? broken() : false;
        continue;
      }
      if (key == "fd") {
        if (record_.has_fd) return refuse_twice("key", key);
        if (!scan_fd(scanner)) return problem_.what.empty() ? broken() : false;
        continue;
      }
      JsonValue* const value = key == "time_ns"     ? &record_.time
                               : key == "bus"       ? &record_.bus
                               : key == "id"        ? &record_.id
                               : key == "priority"  ? &record_.priority
                               : key == "topic"     ? &record_.topic
                               : key == "frame"     ? &record_.frame
                               : key == "data"      ? &record_.data
                               : key == "direction" ? &record_.direction
                               : key == "raw_dlc"   ? &record_.raw_dlc
                                                    : nullptr;
      if (value == nullptr) pass_over(key);
      if (value != nullptr && value->is_there) return refuse_twice("key", key);
      if (!(value != nullptr ? scanner.take_value(*value) : scanner.skip_value())) return broken();
      if (value != nullptr) value->is_there = true;
    } while (scanner.take(','));
    if (!scanner.take('}')) return broken();
  }
  return scanner.at_end() || broken();
}

void JsonLineParser::pass_over(std::string_view key) {
  if (std::find(std::begin(printed_keys), std::end(printed_keys), key) != std::end(printed_keys)) return;
  for (UnknownKey& known : unknown_)
    if (known.name == key) {
      if (std::exchange(known.last, lines_) != lines_) ++known.lines;
      return;
    }
  if (unknown_.size() < most_unknown)
    unknown_.push_back({std::string{key}, 1, lines_});
  else
    ++more_unknown_;
}

std::string_view JsonLineParser::meant_by(std::string_view unknown) {
  // `scan` compares with each of them by itself: a loop over this list would cost encode 5 % of its time.
  constexpr std::string_view read[] = {"time_ns", "bus",       "id",      "priority", "topic", "frame",
                                       "data",    "direction", "raw_dlc", "fields",   "fd"};
  return words::nearest(unknown, read);
}

bool JsonLineParser::scan_fields(JsonScanner& scanner) {
  record_.has_fields = true;
  if (!scanner.take('{'))
    return refuse(log::Cause::syntax, "\"fields\" is no object",
                  R"(write "fields":{"x":0.1}, or leave it out)");
  if (scanner.take('}')) return true;
  do {
    if (record_.field_count == record_.fields.size())
      return refuse(log::Cause::syntax, fmt::format("more than {} fields", record_.fields.size()),
                    "a frame has at most 512 bits");
    auto& named = record_.fields[record_.field_count++];
    named.value = {};
    if (!scanner.take_key(named.name) || !scanner.take_value(named.value)) return false;
  } while (scanner.take(','));
  return scanner.take('}');
}

bool JsonLineParser::scan_fd(JsonScanner& scanner) {
  record_.has_fd = true;
  record_.fd_flags = log::flag::fd;
  bool has_brs = false, has_esi = false;
  const auto wrong = [this] {
    return refuse(log::Cause::syntax, R"("fd" has no flags)",
                  R"(write "fd":{"brs":true,"esi":false}, or leave it out for a classic frame)");
  };
  if (!scanner.take('{')) return wrong();
  if (scanner.take('}')) return true;
  do {
    std::string_view key;
    bool set = false;
    if (!scanner.take_key(key)) return false;
    if (!scanner.take_boolean(set)) return wrong();
    const bool brs = key == "brs";
    if (!brs && key != "esi") {
      pass_over(key);
      continue;
    }
    if (std::exchange(brs ? has_brs : has_esi, true)) return refuse_twice("key", key);
    if (set) record_.fd_flags |= brs ? log::flag::bit_rate_switch : log::flag::error_state;
  } while (scanner.take(','));
  return scanner.take('}');
}

bool JsonLineParser::take_time(log::Entry& entry) {
  entry.time = last_.value_or(base::Time{});
  if (!record_.time) return true;
  std::string_view text = record_.time.text;
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  const auto ns = base::parse_unsigned(text);
  const std::uint64_t most = static_cast<std::uint64_t>(INT64_MAX) + (negative ? 1 : 0);
  if (!ns || *ns > most)
    return refuse(log::Cause::time, "time_ns " + shown(record_.time.text) + " is not a time",
                  "expected whole nanoseconds of 64 bits");
  entry.time = base::Time{base::Duration{static_cast<std::int64_t>(negative ? 0 - *ns : *ns)}};
  return true;
}

bool JsonLineParser::take_bus(std::string_view& bus) {
  bus = record_.bus.text;
  if (!record_.bus.escaped) return true;
  if (!unescape(bus, bus_))
    return refuse(log::Cause::syntax, "bus " + shown(bus) + " is not a JSON string", "check its backslashes");
  bus = bus_;
  return true;
}

JsonLineParser::Meaning JsonLineParser::meaning_of(const log::Entry& entry) const {
  const client::Subject subject = index_.of(interface_).subject(entry.id, entry.format);
  if (!subject || (record_.has_fd && !subject.topic->is_message())) return {};
  if (subject.is_request()) return {subject.topic, {}};
  return {nullptr, subject.frame};
}

bool JsonLineParser::take_id(log::Entry& entry, Meaning& meaning) {
  const std::string_view text = record_.id.text;
  const auto id = base::parse_unsigned(text, 16);
  const bool wide = text.size() == 8;
  if (!id || (!wide && text.size() != 3) || !record_.id.is_string)
    return refuse(log::Cause::identifier, "id " + shown(text) + " is not an identifier",
                  "expected three hexadecimal digits, or eight for an extended identifier");
  entry.id = static_cast<std::uint32_t>(*id);
  entry.format = wide ? can::Format::extended : can::Format::base;
  if (wide && (entry.id & can::error_frame_flag) != 0) {
    entry.format = can::Format::error;
    entry.id &= ~can::error_frame_flag;
  }
  if (entry.id > (wide ? can::max_extended_id : can::max_base_id))
    return refuse(log::Cause::identifier, "id " + shown(text) + " is too large",
                  "7FF is the largest of three digits, 1FFFFFFF of eight");
  meaning = meaning_of(entry);
  return agrees(entry, meaning);
}

/// Whether topic, priority and frame say what the identifier says.
bool JsonLineParser::agrees(const log::Entry& entry, const Meaning& meaning) {
  const auto contradiction = [&](std::string_view key, std::string_view text) {
    return refuse(log::Cause::identifier,
                  fmt::format("id {} and {} {} contradict each other", record_.id.text, key, shown(text)),
                  "leave one of them out: jq 'del(.id)' makes the id from topic, frame and priority");
  };
  if (record_.topic) {
    const auto* const topic = meaning.requested != nullptr ? meaning.requested : meaning.frame.topic;
    const std::string_view name = record_.topic.text;
    if (topic == nullptr || (topic->name != name && catalogue_->find(name) != topic))
      return contradiction("topic", name);
  }
  const bool of_topic = meaning.requested != nullptr || meaning.frame;
  const bool of_message = meaning.frame && meaning.frame.topic->is_message();
  if (record_.priority && of_topic && !of_message &&
      record_.priority.text != name(protocol::Identifier::decode(entry.id).priority))
    return contradiction("priority", record_.priority.text);
  if (record_.frame && of_topic &&
      record_.frame.text != (meaning.requested != nullptr ? "request" : frame_name(meaning.frame)))
    return contradiction("frame", record_.frame.text);
  return true;
}

/// The identifier from the topic.
bool JsonLineParser::take_topic(log::Entry& entry, Meaning& meaning) {
  using protocol::Direction;
  if (!record_.topic) return refuse(log::Cause::identifier, "neither id nor topic", "give one of them");
  const auto* const topic = catalogue_->find(record_.topic.text);
  if (topic == nullptr) {
    const auto words = words::topic_words(*catalogue_);
    return refuse(log::Cause::identifier, "no topic " + shown(record_.topic.text),
                  words::suggestion(record_.topic.text, words));
  }
  if (topic->is_message()) return take_message(entry, meaning, *topic);
  auto priority = topic->priority;
  if (record_.priority) {
    const auto parsed = protocol::parse_priority(record_.priority.text);
    if (!parsed)
      return refuse(log::Cause::identifier, "no priority " + shown(record_.priority.text),
                    "one of: urgent, high, medium, low");
    priority = *parsed;
  }
  const bool sensor = topic->kind == protocol::Kind::sensor;
  if (sensor && record_.frame && record_.frame.text == "request") {
    meaning.requested = topic;
    entry.id = protocol::Identifier{Direction::command, priority, topic->id}.encode();
    return true;
  }
  std::string names;
  for (std::size_t i = 0; i < topic->frames.size(); ++i) {
    const protocol::FrameRef frame{topic, static_cast<std::uint8_t>(i)};
    names += (names.empty() ? "" : ", ") + std::string{frame_name(frame)};
    const bool meant = record_.frame ? record_.frame.text == frame_name(frame) : topic->frames.size() == 1;
    if (!meant) continue;
    meaning.frame = frame;
    entry.id = protocol::identifier_of(frame, priority);
    return true;
  }
  return refuse(log::Cause::identifier,
                record_.frame ? fmt::format("{} has no frame {}", topic->name, shown(record_.frame.text))
                              : fmt::format("{} has several frames", topic->name),
                "frame is one of: " + names);
}

/// The identifier of a message; one of J1939 is sent with any priority and by any source.
bool JsonLineParser::take_message(log::Entry& entry, Meaning& meaning, const protocol::Topic& message) {
  meaning.frame = {&message, 0};
  if (record_.frame && record_.frame.text != frame_name(meaning.frame))
    return refuse(log::Cause::identifier,
                  fmt::format("{} has no frame {}", message.name, shown(record_.frame.text)),
                  fmt::format("frame is {}", frame_name(meaning.frame)));
  const protocol::Address& address = meaning.frame.layout().address;
  if (address.by == protocol::Address::By::pgn)
    return refuse(log::Cause::identifier, fmt::format("{} without id", message.name),
                  "a J1939 message may have any priority and source: give the id that it was sent with");
  entry.id = address.number;
  entry.format = address.extended ? can::Format::extended : can::Format::base;
  if (meaning.frame.layout().fd) entry.flags |= can::fd_flags(meaning.frame.layout().bit_rate_switch);
  return true;
}

bool JsonLineParser::take_remote(log::Entry& entry) {
  std::string_view text = record_.data.text.substr(1);
  const auto length = text.empty() ? base::Result<std::uint64_t>{0} : base::parse_unsigned(text);
  if (!length || text.size() > 1 || *length > can::max_dlc || entry.format == can::Format::error ||
      record_.has_fd)
    return refuse(log::Cause::length, "data " + shown(record_.data.text) + " is no remote frame's",
                  "expected R or R0 to R8, with neither fd nor an error frame's id");
  entry.format = entry.format == can::Format::base ? can::Format::base_remote : can::Format::extended_remote;
  entry.length = static_cast<std::uint8_t>(*length);
  return true;
}

bool JsonLineParser::take_data(log::Entry& entry, const Meaning& meaning) {
  if (!record_.data) {
    if (record_.has_fd) entry.flags = record_.fd_flags;
    if (!record_.has_fields || (meaning.requested == nullptr && !meaning.frame))
      return refuse(log::Cause::length, "no data", "expected data, or fields of a topic");
    if (meaning.frame) entry.length = length_of(entry, meaning.frame.layout());
    std::fill_n(entry.data.begin(), entry.length, std::uint8_t{0});  // an Entry clears eight
    return true;
  }
  const std::string_view text = record_.data.text;
  if (text.starts_with('R')) return take_remote(entry);
  const std::size_t most = record_.has_fd ? log::max_fd_length : can::max_dlc;
  const std::size_t length = text.size() / 2;
  if (length > most || (record_.has_fd && !log::is_fd_length(length)))
    return refuse(log::Cause::length, "data of " + client::counted(length, "byte"),
                  record_.has_fd ? "CAN FD has 0 to 8, 12, 16, 20, 24, 32, 48 or 64"
                                 : "a frame has at most 8; with \"fd\":{} up to 64");
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const int high = base::hex_digit(text[i]);
    const int low = i + 1 < text.size() ? base::hex_digit(text[i + 1]) : -1;
    if (high < 0 || low < 0 || !record_.data.is_string)
      return refuse(log::Cause::syntax, "data " + shown(text) + " is not hexadecimal",
                    "expected two digits a byte");
    entry.data[i / 2] = static_cast<std::uint8_t>(high << 4 | low);
  }
  entry.length = static_cast<std::uint8_t>(length);
  return true;
}

bool JsonLineParser::take_extras(log::Entry& entry) {
  if (record_.has_fd) {
    if (entry.format == can::Format::error)
      return refuse(log::Cause::syntax, "an error frame with fd", "leave fd out");
    entry.flags = record_.fd_flags;
  }
  if (record_.direction) {
    const std::string_view text = record_.direction.text;
    if (text != "received" && text != "sent")
      return refuse(log::Cause::syntax, "direction " + shown(text), "expected received or sent");
    entry.direction = text == "sent" ? log::Direction::sent : log::Direction::received;
  }
  if (record_.raw_dlc) {
    const auto code = base::parse_unsigned(record_.raw_dlc.text);
    if (!code || *code <= can::max_dlc || *code > 15 || entry.length != can::max_dlc || record_.has_fd ||
        entry.format == can::Format::error)
      return refuse(log::Cause::length, "raw_dlc " + shown(record_.raw_dlc.text),
                    "expected 9 to 15, with a classic frame of 8 bytes");
    entry.raw_dlc = static_cast<std::uint8_t>(*code);
  }
  return true;
}

bool JsonLineParser::put_fields(log::Entry& entry, const Meaning& meaning) {
  if (can::is_remote(entry.format) || (meaning.requested == nullptr && !meaning.frame))
    return record_.field_count == 0 ||
           refuse(log::Cause::syntax, fmt::format("fields, but id {} is of no topic", record_.id.text),
                  "leave them out, or name the robot's topics with --spec");
  if (meaning.requested != nullptr) return put_request(entry, *meaning.requested);
  const auto& layout = meaning.frame.layout();
  if (!layout.accepts(entry.length))
    return refuse(log::Cause::length,
                  fmt::format("data of {} with fields of {}", client::counted(entry.length, "byte"),
                              meaning.frame.topic->name),
                  fmt::format("it has {}; leave data or fields out", client::counted(layout.length, "byte")));
  const std::span data{entry.data.data(), entry.length};
  Texts& texts = texts_[&layout];  // none for a frame without fields
  if (texts.overlapping) return put_overlapping(data, layout);
  // Selectors first: they say which fields there are.
  if (texts.multiplexed)
    for (std::size_t i = 0; i < record_.field_count; ++i)
      if (!put_field(data, data, layout, record_.fields[i], texts, i, Part::selectors)) return false;
  const Part rest = texts.multiplexed ? Part::others : Part::all;
  std::array<std::uint8_t, can::max_dlc> before{};  // only frames of topics have derived fields
  std::copy_n(data.begin(), std::min(data.size(), before.size()), before.begin());
  for (std::size_t i = 0; i < record_.field_count; ++i)
    if (!put_field(data, data, layout, record_.fields[i], texts, i, rest)) return false;
  for (std::size_t i = 0; i < record_.field_count; ++i)
    if (const auto* const field = derived_field(layout, record_.fields[i].name))
      if (!agrees(*field, layout, record_.fields[i].value.text, before, data)) return false;
  return true;
}

/// What the data says already was not edited, even where an edited field lies over it. Of what was edited
/// each must be there at the end as the line has it.
bool JsonLineParser::put_overlapping(std::span<std::uint8_t> data, const protocol::FrameLayout& layout) {
  Texts& texts = texts_[&layout];
  std::array<std::uint8_t, log::max_fd_length> as_read{};
  std::copy(data.begin(), data.end(), as_read.begin());
  const std::span before = std::span{as_read}.first(data.size());
  given_.clear();
  for (const Part part : {Part::selectors, Part::others})
    for (std::size_t i = 0; i < record_.field_count; ++i)
      if (!put_field(data, before, layout, record_.fields[i], texts, i, part)) return false;
  for (const auto& [field, raw] : given_) {
    if (field->raw(data) == raw) continue;
    const auto other = std::find_if(given_.begin(), given_.end(), [field = field](const Given& each) {
      return each.field != field && each.field->position.overlaps(field->position);
    });
    return refuse(log::Cause::syntax,
                  fmt::format("fields {} and {} have bits in common, and cannot be what both are given",
                              shown(field->name), shown(other->field->name)),
                  "leave one of them out");
  }
  return true;
}

const protocol::Field* JsonLineParser::derived_field(const protocol::FrameLayout& layout,
                                                     std::string_view name) noexcept {
  for (const auto& field : layout.values().subspan(layout.fields.size()))
    if (field.name == name) return &field;
  return nullptr;
}

/// A derived field is what `before` says, and so was not edited, or what the frame says now.
bool JsonLineParser::agrees(const protocol::Field& field, const protocol::FrameLayout& layout,
                            std::string_view text, std::span<const std::uint8_t> before,
                            std::span<const std::uint8_t> now) {
  const auto number = base::parse_decimal(text);
  for (const auto data : {record_.data ? before.first(now.size()) : now, now})
    if (layout.has(field, data))
      if (const auto value = field.physical(field.raw(data)); value && number && *value == *number)
        return true;
  const std::string of{layout.fields[field.derived_from].name};
  return refuse(log::Cause::syntax,
                shown(field.name) + " is not what " + of + " says, of which it is derived",
                "edit " + of + ", and leave " + std::string{field.name} + " out");
}

/// `before`: what counts as not edited. `hint`: where the field is if the line has all of them, in their
/// order.
bool JsonLineParser::put_field(std::span<std::uint8_t> data, std::span<const std::uint8_t> before,
                               const protocol::FrameLayout& layout, const NamedText& named, Texts& texts,
                               std::size_t hint, Part part) {
  const auto& fields = texts.fields;
  std::size_t i = hint < fields.size() && fields[hint].field().name == named.name ? hint : 0;
  while (i < fields.size() && fields[i].field().name != named.name) ++i;
  if (i == fields.size() && derived_field(layout, named.name) != nullptr) return true;  // looked at later
  if (i == fields.size()) {
    std::vector<std::string_view> names;
    for (const auto& field : fields) names.push_back(field.field().name);
    return refuse(log::Cause::syntax, "no field " + shown(named.name),
                  names.empty() ? "the frame has none" : words::suggestion(named.name, names));
  }
  const auto& field = fields[i].field();
  if (part != Part::all && layout.selects(i) != (part == Part::selectors)) return true;
  if (std::exchange(texts.given_in[i], lines_) == lines_) return refuse_twice("field", named.name);
  const std::string_view text = named.value.text;
  if (part != Part::selectors && !layout.has(field, data))
    return refuse(log::Cause::syntax, "field " + shown(named.name) + " is not in this frame",
                  "its selector says so, or the frame is too short; leave one of them out");
  if (record_.data) {
    char present[FieldText::room];
    const auto size = static_cast<std::size_t>(fields[i].print(present, before.data()) - present);
    if (text == std::string_view{present, size}) return true;
  }
  if (const auto number = base::parse_decimal(text); number && !field.is_float()) {
    const auto present_number = field.physical(field.raw(before));
    if (record_.data && present_number && *number == *present_number) return true;  // 2.50, 1e-06
    if (!named.value.is_string && !words::detail::is_fraction(field, *number))
      if (const auto raw = field.raw_from(*number)) return give(data, before, field, text, *raw);
  }
  const auto raw = words::parse_value(field, text);
  if (!raw && !named.value)
    return refuse(log::Cause::syntax,
                  fmt::format("field {} has no value; {}", shown(named.name), words::detail::takes(field)),
                  "write a number or a string");
  if (!raw)
    return refuse(log::Cause::syntax, raw.error,
                  record_.data ? "leave the field out, and data counts" : "write a value in its range");
  return give(data, before, field, text, *raw);
}

/// A number that is not the text of what is there; it may be the same, as of a float with other digits.
bool JsonLineParser::give(std::span<std::uint8_t> data, std::span<const std::uint8_t> before,
                          const protocol::Field& field, std::string_view text, std::int64_t raw) {
  const bool edited = !record_.data || raw != field.raw(before);
  if (values_ == Values::as_stated && edited && !words::is_in_stated_range(field, raw))
    return refuse(log::Cause::syntax, words::beyond_stated_range(field, text), words::force_beyond_range);
  if (edited || before.data() == data.data()) protocol::put(data, field.position, raw);
  if (edited && before.data() != data.data()) given_.push_back({&field, raw});
  return true;
}

bool JsonLineParser::put_request(log::Entry& entry, const protocol::Topic& topic) {
  using protocol::Mode;
  JsonValue mode_text;
  JsonValue period_text;
  for (std::size_t i = 0; i < record_.field_count; ++i) {
    const auto& named = record_.fields[i];
    if (named.name != "mode" && named.name != "period")
      return refuse(log::Cause::syntax, "no field " + shown(named.name), "a request has mode and period");
    JsonValue& value = named.name == "mode" ? mode_text : period_text;
    if (value) return refuse_twice("field", named.name);
    if (!named.value)
      return refuse(log::Cause::syntax, fmt::format("field {} has no value", shown(named.name)),
                    named.name == "mode" ? "one of: stop, publish, once"
                                         : R"(write seconds, or a time such as "500ms")");
    value = named.value;
  }
  constexpr std::string_view modes[] = {"stop", "publish", "once"};
  const auto* const found = std::find(std::begin(modes), std::end(modes), mode_text.text);
  if (found == std::end(modes))
    return refuse(log::Cause::syntax, "mode " + shown(mode_text.text), "one of: stop, publish, once");
  const auto mode = static_cast<Mode>(found - std::begin(modes));
  std::optional<base::Duration> period;
  if (period_text) {
    if (const auto seconds = base::parse_decimal(period_text.text)) {
      if (const auto ns = base::divide_rounded(*seconds, {1, -9})) period = base::Duration{*ns};
    } else if (const auto time = words::parse_duration(period_text.text)) {
      period = *time;
    }
    if (!period || !protocol::Period::from(*period))
      return refuse(
          log::Cause::syntax, "period " + shown(period_text.text) + " is none that a request has",
          R"(write seconds or a time with its unit, such as 0.5 or "500ms": 1 to 65535 us, ms or s)");
  }
  // What the data says already, as JsonText shows it, stays as it is.
  if (record_.data) {
    const auto present = protocol::decode_request(*entry.classic());
    if (present && present->mode == mode &&
        (mode != Mode::publish || !period ||
         *period == (entry.length == 1 ? topic.period : present->period).duration()))
      return true;
  }
  if (period && mode != Mode::publish && !record_.data)  // else it may be that of the data
    return refuse(log::Cause::syntax, fmt::format("a period with mode {}", mode_text.text),
                  "only publish has one; leave it out");
  const auto priority = protocol::Identifier::decode(entry.id).priority;
  const auto frame =
      mode != Mode::publish ? protocol::encode(protocol::Request{topic.id, mode, {}, priority})
      : period
          ? protocol::encode(protocol::Request{topic.id, mode, *protocol::Period::from(*period), priority})
          : protocol::encode_default_publish(topic.id, priority);
  entry.length = frame.dlc;
  std::memcpy(entry.data.data(), frame.data.data(), frame.data.size());
  return true;
}

bool JsonLinesReader::recognises(std::string_view beginning) {
  const auto first = beginning.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || beginning[first] != '{') return false;
  const auto line = beginning.substr(first, beginning.find('\n', first) - first);
  for (const std::string_view key : {R"("data")", R"("id")", R"("fields")"})
    if (line.find(key) != std::string_view::npos) return true;
  return false;
}

std::size_t JsonLinesReader::read(std::span<log::Entry> into) {
  using log::Input;
  std::size_t count = 0;
  while (count < into.size()) {
    std::string_view line;
    const auto taken = input_->take_line(line, count == 0 ? Input::Wait::yes : Input::Wait::no);
    if (taken == Input::Line::none || taken == Input::Line::later) break;
    const log::Place place{input_->line_number(), true};
    if (taken == Input::Line::too_long) {
      complain(log::Cause::too_long, place, line);
      continue;
    }
    if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
    std::string_view bus;
    if (!parser_.parse(line, into[count], bus)) {
      const log::Cause cause = parser_.problem().cause;
      const bool whole =
          std::count(line.begin(), line.end(), '{') == std::count(line.begin(), line.end(), '}');
      complain(whole ? cause : cause_of_line(cause, taken), place, parser_.problem().what);
      continue;
    }
    into[count].interface = interfaces_.number(bus);
    ++count;
  }
  return count;
}

}  // namespace ocm::cli::logs
