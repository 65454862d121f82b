#include "cli/output/json_text.hpp"

#include <algorithm>
#include <cstring>

#include "ocm/base/utf8.hpp"
#include "ocm/can/error_frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

/// Pieces are copied in blocks of this many bytes, beyond their end, too.
constexpr std::size_t block = 32;
constexpr std::string_view line_begin = R"({"time_ns":")";

/// Whether it begins as a byte in words does: a backslash, x and two digits.
bool is_byte_text(std::string_view text) {
  return text.size() >= 4 && text[0] == '\\' && text[1] == 'x' && base::hex_digit(text[2]) >= 0 &&
         base::hex_digit(text[3]) >= 0;
}

std::string json_string(std::string_view text) {
  std::string out{'"'};
  append_json(out, text);
  return out += '"';
}

/// The bytes as hexadecimal digits, or R and the length that a remote frame asks for, as candump has them.
char* put_data(char* to, const log::Entry& entry) {
  if (!can::is_remote(entry.format)) return put_hex(to, entry.bytes());
  *to++ = 'R';
  return entry.length == 0 ? to : put_unsigned(to, entry.length);
}

/// The keys behind `data`, and the end of the line.
char* put_end(char* to, const log::Entry& entry) {
  const auto put_text = [&to](std::string_view text) { to = std::copy(text.begin(), text.end(), to); };
  put_text("\"");
  if (entry.direction == log::Direction::received) put_text(R"(,"direction":"received")");
  if (entry.direction == log::Direction::sent) put_text(R"(,"direction":"sent")");
  if (entry.is_fd()) {
    const auto said = [&](std::uint8_t flag) {
      return (entry.flags & flag) != 0 ? std::string_view{"true"} : std::string_view{"false"};
    };
    put_text(R"(,"fd":{"brs":)");
    put_text(said(log::flag::bit_rate_switch));
    put_text(R"(,"esi":)");
    put_text(said(log::flag::error_state));
    put_text("}");
  }
  if (entry.raw_dlc != 0) {
    put_text(R"(,"raw_dlc":)");
    to = put_unsigned(to, entry.raw_dlc);
  }
  put_text("}\n");
  return to;
}

/// More than put_data and put_end can write.
constexpr std::size_t end_room = 2 * log::max_fd_length + 128;

}  // namespace

void append_json(std::string& out, std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = base::utf8_length(text);
    const auto byte = static_cast<unsigned char>(text.front());
    if (length == 0 || is_byte_text(text))
      out += fmt::format("\\\\x{:02x}", byte);
    else if (byte < 0x20)
      out += fmt::format("\\u{:04x}", byte);
    else {
      if (byte == '"' || byte == '\\') out += '\\';
      out += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
}

JsonText::JsonText(const protocol::Catalogue& catalogue, const Selection& selection)
    : catalogue_(&catalogue),
      index_(catalogue),
      messages_(catalogue.topics.size()),
      everything_(selection.everything()) {
  for (const auto& topic : catalogue.topics) {
    for (std::size_t i = 0; i < topic.frames.size(); ++i)
      know({&topic, static_cast<std::uint8_t>(i)}, selection);
    if (topic.kind != protocol::Kind::sensor) continue;
    for (std::size_t level = 0; level < protocol::priority_levels; ++level) {
      const protocol::Identifier id{protocol::Direction::command, static_cast<protocol::Priority>(level),
                                    topic.id};
      auto& known = known_[id.encode()];
      known.kind = Kind::request;
      known.frame = {&topic, 0};
      known.selected = everything_;
    }
  }
  pieces_.append(block, '\0');  // copied with the last piece
  room_ += end_room + block;
}

JsonText::Piece JsonText::keep(std::string_view text) {
  const Piece piece{static_cast<std::uint32_t>(pieces_.size()), static_cast<std::uint32_t>(text.size())};
  pieces_ += text;
  return piece;
}

void JsonText::know(protocol::FrameRef frame, const Selection& selection) {
  const auto& layout = frame.layout();
  Known known;
  known.kind = Kind::fields;
  known.selected = selection.has(layout);
  known.first_field = static_cast<std::uint32_t>(fields_.size());
  known.frame = frame;
  std::string names = "{";  // up to the first value
  std::string units = R"(,"units":{)";
  std::size_t size = 0;
  for (const auto& field : layout.fields) {
    if (!selection.has(layout, field)) continue;
    const std::string name = json_string(field.name) + ':';
    const std::string unit = name + json_string(field.unit);
    if (fields_.size() == known.first_field) {
      names += name;
    } else {
      fields_.back().after = keep("," + name);
      units += ',';
    }
    units += unit;
    known.varies = known.varies || layout.may_lack(field);
    fields_.push_back({FieldText{field}, {}, {}, {}});
    if (frame.topic->is_message()) {
      fields_.back().name = keep(name);
      fields_.back().unit = keep(unit);
    }
    size += FieldText::room + name.size() + unit.size() + 2 * block;
  }
  known.fields = static_cast<std::uint16_t>(fields_.size() - known.first_field);
  units += R"(},"data":")";
  if (known.varies)
    names = "{";
  else if (known.fields == 0)
    names += "}" + units;
  else
    fields_.back().after = keep("}" + units);

  const auto head = [&](std::string_view before) {
    const std::string text =
        fmt::format(R"({}"topic":{},"frame":{},"fields":{})", before, json_string(frame.topic->name),
                    json_string(frame_name(frame)), names);
    known.head = keep(text);
    room_ = std::max(room_, text.size() + size + units.size() + 128 + 2 * block);
  };
  if (frame.topic->is_message()) {
    head(",");
    messages_[static_cast<std::size_t>(frame.topic - catalogue_->topics.data())] = known;
    if (layout.address.by == protocol::Address::By::identifier && !layout.address.extended)
      if (Known& place = known_[layout.address.number]; place.kind == Kind::unknown) place = known;
    return;
  }
  for (std::size_t level = 0; level < protocol::priority_levels; ++level) {
    const auto priority = static_cast<protocol::Priority>(level);
    const std::uint32_t id = protocol::identifier_of(frame, priority);
    head(fmt::format(R"({:03X}","priority":"{}",)", id, name(priority)));
    known_[id] = known;
  }
}

const JsonText::Known& JsonText::known_of(const log::Entry& entry) const noexcept {
  static constexpr Known nothing{};
  if (entry.format == can::Format::base && !entry.is_fd()) return known_[entry.id & can::max_base_id];
  const client::Subject subject = index_.subject(entry.id, entry.format);
  if (!subject || !subject.topic->is_message()) return nothing;
  return messages_[static_cast<std::size_t>(subject.topic - catalogue_->topics.data())];
}

char* JsonText::put(char* to, Piece piece) const noexcept {
  const char* const from = pieces_.data() + piece.begin;
  std::size_t i = 0;
  do {
    std::memcpy(to + i, from + i, block);
    i += block;
  } while (i < piece.size);
  return to + piece.size;
}

char* JsonText::put_begin(char* to, std::string_view bus_text, const log::Entry& entry) const noexcept {
  std::memcpy(to, line_begin.data(), line_begin.size());
  to = put_signed(to + line_begin.size(), entry.time.time_since_epoch().count());
  std::memcpy(to, bus_text.data(), bus_text.size());
  return to + bus_text.size();
}

const std::string& JsonText::bus_text(std::string_view bus, std::uint16_t number) {
  BusText& kept = buses_[number % buses_.size()];
  if (kept.name != bus || kept.text.empty()) {
    kept.name = bus;
    kept.text = R"(","bus":)" + json_string(bus) + R"(,"id":")";
  }
  return kept.text;
}

/// The identifier of a message, and what it says by J1939.
char* JsonText::put_identity(char* to, const log::Entry& entry, const Known& known) const noexcept {
  to = put_hex(to, entry.id, can::is_extended(entry.format) ? 8 : 3);
  *to++ = '"';
  if (known.frame.layout().address.by != protocol::Address::By::pgn) return to;
  const auto id = j1939::Identifier::decode(entry.id);
  const auto put_text = [&to](std::string_view text) { to = std::copy(text.begin(), text.end(), to); };
  put_text(R"(,"priority":)");
  to = put_unsigned(to, id.priority);
  put_text(R"(,"pgn":")");
  to = put_hex(to, id.pgn, 5);
  put_text(R"(","source":)");
  to = put_unsigned(to, id.source);
  put_text(R"(,"destination":)");
  return put_unsigned(to, id.destination);
}

/// Of a message, those that are in the frame.
char* JsonText::put_fields(char* to, const Known& known, const log::Entry& entry) const noexcept {
  const auto& layout = known.frame.layout();
  const FieldPiece* const begin = fields_.data() + known.first_field;
  const auto each = [&](auto put_one) {
    bool first = true;
    for (const FieldPiece* piece = begin; piece != begin + known.fields; ++piece) {
      if (!layout.has(piece->value.field(), entry.bytes())) continue;
      if (!first) *to++ = ',';
      first = false;
      put_one(*piece);
    }
  };
  const auto put_text = [&to](std::string_view text) { to = std::copy(text.begin(), text.end(), to); };
  each([&](const FieldPiece& piece) { to = piece.value.print_json(put(to, piece.name), entry.data.data()); });
  put_text(R"(},"units":{)");
  each([&](const FieldPiece& piece) { to = put(to, piece.unit); });
  put_text(R"(},"data":")");
  return to;
}

bool JsonText::write(log::Bytes& out, std::string_view bus, const log::Entry& entry) {
  const Known& known = known_of(entry);
  const bool data = known.kind == Kind::fields && known.frame.layout().accepts(entry.length) &&
                    !can::is_remote(entry.format);
  if (!everything_ && !(data && known.selected)) return false;
  const std::string& text = bus_text(bus, entry.interface);
  if (!data) {
    write_rest(out, text, known, entry);
    return true;
  }
  char* to = out.room(room_ + line_begin.size() + 32 + text.size());
  to = put_begin(to, text, entry);
  if (known.frame.topic->is_message()) to = put_identity(to, entry, known);
  to = put(to, known.head);
  if (known.varies) {
    to = put_fields(to, known, entry);
  } else {
    const FieldPiece* field = fields_.data() + known.first_field;
    for (unsigned i = 0; i < known.fields; ++i)
      to = put(field[i].value.print_json(to, entry.data.data()), field[i].after);
  }
  if (entry.length <= can::max_dlc) {
    can::Payload payload;
    std::memcpy(payload.data(), entry.data.data(), payload.size());
    put_hex(to, payload);  // all eight: of how many is not guessed
    to += 2 * entry.length;
  } else {
    to = put_hex(to, entry.bytes());
  }
  if (entry.direction == log::Direction::unknown && entry.raw_dlc == 0 && !entry.is_fd()) {
    std::memcpy(to, "\"}\n", 3);
    to += 3;
  } else {
    to = put_end(to, entry);
  }
  out.grow_to(to);
  return true;
}

void JsonText::write_rest(log::Bytes& out, std::string_view bus_text, const Known& known,
                          const log::Entry& entry) const {
  char* to = put_begin(out.room(line_begin.size() + 32 + bus_text.size() + 16), bus_text, entry);
  const bool wide = can::is_extended(entry.format) || entry.format == can::Format::error;
  to = put_hex(to, entry.format == can::Format::error ? entry.id | can::error_frame_flag : entry.id,
               wide ? 8 : 3);
  *to++ = '"';
  out.grow_to(to);
  const auto priority = protocol::Identifier::decode(entry.id).priority;
  if (known.kind == Kind::request)
    write_request(out, known, entry);
  else if (known.kind == Kind::fields && known.frame.topic->is_message())
    append_formatted(out, R"(,"topic":{},"frame":{},"error":"{} bytes, fewer than {}")",
                     json_string(known.frame.topic->name), json_string(frame_name(known.frame)),
                     entry.bytes().size(), known.frame.layout().length);
  else if (known.kind == Kind::fields)
    append_formatted(out, R"(,"priority":"{}","topic":{},"frame":{},"error":"DLC {} instead of {}")",
                     name(priority), json_string(known.frame.topic->name),
                     json_string(frame_name(known.frame)), entry.length, known.frame.layout().length);
  else if (entry.format == can::Format::error)
    append_formatted(out, R"(,"error":"error frame: {}")", can::describe(*entry.classic()).view());
  else
    out.append(entry.is_fd() ? std::string_view{R"(,"error":"CAN FD frame")"}
                             : std::string_view{R"(,"error":"unknown identifier")"});
  out.append(R"(,"data":")");
  out.grow_to(put_end(put_data(out.room(end_room), entry), entry));
}

void JsonText::write_request(log::Bytes& out, const Known& known, const log::Entry& entry) const {
  const auto& topic = *known.frame.topic;
  append_formatted(out, R"(,"priority":"{}","topic":{},"frame":"request")",
                   name(protocol::Identifier::decode(entry.id).priority), json_string(topic.name));
  const auto frame = *entry.classic();
  const auto request = protocol::decode_request(frame);
  if (!request) return append_formatted(out, R"(,"error":"{}")", base::describe(request.error));
  constexpr std::string_view modes[] = {"stop", "publish", "once"};
  append_formatted(out, R"(,"fields":{{"mode":"{}")", modes[static_cast<std::size_t>(request->mode)]);
  if (request->mode == protocol::Mode::publish) {
    const auto period = frame.dlc == 1 ? topic.period : request->period;
    append_formatted(out, R"(,"period":{})",
                     base::to_text(base::normalised(period.duration().count(), -9)).view());
  }
  out.append(R"(},"units":{"period":"s"})");
}

}  // namespace ocm::cli
