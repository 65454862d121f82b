#include "cli/output/json_text.hpp"

#include <algorithm>
#include <cstring>

#include "ocm/base/utf8.hpp"
#include "ocm/can/error_frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/client/counted.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

/// So many bytes of a piece are copied at once, beyond its end, too: few names are longer, and how long they
/// are is not guessed.
constexpr std::size_t block = 48;
constexpr std::string_view line_begin = R"({"time_ns":")";
/// More than it with the time behind it.
constexpr std::size_t begin_room = line_begin.size() + 32;

/// Whether it begins as a byte in words does: a backslash, x and two digits.
bool is_byte_text(std::string_view text) {
  return text.size() >= 4 && text[0] == '\\' && text[1] == 'x' && base::hex_digit(text[2]) >= 0 &&
         base::hex_digit(text[3]) >= 0;
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

/// `text` has a block behind its end, which is copied, too.
[[gnu::always_inline]] inline char* put_blocks(char* to, std::string_view text) noexcept {
  std::memcpy(to, text.data(), block);
  if (text.size() > block) std::memcpy(to + block, text.data() + block, text.size() - block);
  return to + text.size();
}

/// Eight upper-case digits, or three.
char* put_identifier(char* to, std::uint32_t id, bool wide) noexcept {
  if (wide) {
    to = base::swar::hex_byte(to, static_cast<std::uint8_t>(id >> 24));
    to = base::swar::hex_byte(to, static_cast<std::uint8_t>(id >> 16));
    to = base::swar::hex_byte(to, static_cast<std::uint8_t>(id >> 8));
  } else {
    *to++ = base::swar::upper_digits[id >> 8 & 0xF];
  }
  return base::swar::hex_byte(to, static_cast<std::uint8_t>(id));
}

/// More than put_data and put_end can write.
constexpr std::size_t end_room = 2 * log::max_fd_length + 128;

}  // namespace

std::string json_string(std::string_view text) {
  std::string out{'"'};
  append_json(out, text);
  return out += '"';
}

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

JsonText::JsonText(const protocol::Catalogue& catalogue, const Selection& selection,
                   std::string_view interface)
    : catalogue_(&catalogue),
      index_(interface.empty() ? client::FrameIndex{catalogue} : client::FrameIndex{catalogue, interface}),
      messages_(catalogue.topics.size()),
      everything_(selection.everything()) {
  for (const auto& topic : catalogue.topics) {
    if (!interface.empty() && !topic.is_on(interface)) continue;
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

std::size_t JsonText::know_names(const protocol::Field& field, const std::string& label) {
  NamedField named{FieldText{field}, keep(label), static_cast<std::uint32_t>(value_names_.size()), 0};
  std::vector<protocol::NamedValue> values{field.values.begin(), field.values.end()};
  std::stable_sort(values.begin(), values.end(), [](const auto& a, const auto& b) { return a.raw < b.raw; });
  std::size_t size = 0;
  for (std::size_t i = 0; i < values.size(); ++named.names) {
    const std::int64_t raw = values[i].raw;
    std::string text;
    for (; i < values.size() && values[i].raw == raw; ++i) {  // a value may have two names, as in names_of
      if (!text.empty()) text += '|';
      append_json(text, values[i].name);
    }
    value_names_.push_back({raw, keep(field.flags ? text : '"' + text + '"')});
    size = field.flags ? size + text.size() + 1 : std::max(size, text.size() + 2);
  }
  tabulate(named);
  named_.push_back(named);
  return label.size() + size + 2 * block + 16;
}

/// Where the names are of small numbers, one beside the other, as most are.
void JsonText::tabulate(NamedField& named) {
  const protocol::Field& field = named.value.field();
  const std::span names = std::span{value_names_}.subspan(named.first_name, named.names);
  if (field.flags || !named.value.in_word() || names.empty() || names.front().raw < 0) return;
  const auto most = static_cast<std::int64_t>(std::min<std::size_t>(4 * names.size() + 16, 1023));
  // Of a signed field greater bits are negative numbers.
  const bool beyond = field.is_signed && names.back().raw > protocol::highest(field.position.width, true);
  if (names.back().raw > most || beyond) return;
  named.tabled = true;
  named.greatest = static_cast<std::uint16_t>(names.back().raw);
  named.first_tabled = static_cast<std::uint32_t>(tabled_names_.size());
  tabled_names_.resize(tabled_names_.size() + named.greatest + 2U);
  const std::string label = pieces_.substr(named.label.begin, named.label.size);
  for (const ValueName& name : names)
    tabled_names_[named.first_tabled + static_cast<std::size_t>(name.raw)] =
        keep(label + pieces_.substr(name.text.begin, name.text.size) + ',');
}

/// Numbers the choices that a frame makes among the fields: most messages have as many as pages.
void JsonText::know_choices(Known& known) {
  constexpr std::uint16_t looked_back = 16;  // messages may have thousands
  const auto field = [&](std::size_t i) -> const protocol::Field& {
    return fields_[known.first_field + i].value.field();
  };
  std::vector<std::size_t> first;  // field of each choice
  for (std::size_t i = 0; i < known.fields; ++i) {
    std::size_t choice = first.size();
    for (std::size_t back = 1; back <= std::min<std::size_t>(looked_back, first.size()); ++back)
      if (protocol::FrameLayout::choose_together(field(first[first.size() - back]), field(i)))
        choice = first.size() - back;
    if (choice == first.size()) first.push_back(i);
    labels_[known.first_field + i].choice = static_cast<std::uint16_t>(choice);
  }
  known.choices = static_cast<std::uint16_t>(first.size());
  chosen_.resize(std::max(chosen_.size(), first.size()));
}

void JsonText::know(protocol::FrameRef frame, const Selection& selection) {
  const auto& layout = frame.layout();
  Known known;
  known.kind = Kind::fields;
  known.selected = selection.has(layout);
  known.first_field = static_cast<std::uint32_t>(fields_.size());
  known.frame = frame;
  known.message = frame.topic->is_message();
  known.pgn = layout.address.by == protocol::Address::By::pgn;
  has_groups_ = has_groups_ || known.pgn;
  known.least = layout.any_length() ? 0 : layout.length;
  known.most = layout.accepts(layout.length + std::size_t{1}) ? UINT16_MAX : layout.length;
  std::vector<std::string> names;
  std::string units = R"(,"units":{)";
  std::vector<std::string> with_units;
  std::size_t size = 0;
  for (const auto& field : layout.values()) {
    if (!selection.has(layout, field)) continue;
    names.push_back(json_string(field.name) + ':');
    with_units.push_back(names.back() + json_string(field.unit));
    units += (names.size() == 1 ? "" : ",") + with_units.back();
    known.varies = known.varies || layout.may_lack(field);
    if (!field.values.empty()) {
      if (known.named++ == 0) known.first_named = static_cast<std::uint32_t>(named_.size());
      size += know_names(field, names.back());
    }
    fields_.push_back({FieldText{field}, {}});
    size += FieldText::room + names.back().size() + with_units.back().size() + 2 * block;
  }
  known.fields = static_cast<std::uint16_t>(names.size());
  present_.resize(std::max(present_.size(), names.size()));
  labels_.resize(fields_.size());
  units += '}';
  known.plain = !known.varies && known.named == 0;
  if (known.plain) units += R"(,"data":")";
  know_choices(known);
  const auto label = [&](std::size_t i) {
    Labels& labels = labels_[known.first_field + i];
    labels.name = keep(names[i]);
    labels.unit = keep(with_units[i]);
  };
  // In the order in which they are written, and nothing between them that is not: of thousands of fields they
  // are to stay in the processor's second cache.
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (known.varies)
      label(i);
    else
      fields_[known.first_field + i].after = keep(i + 1 < names.size() ? "," + names[i + 1] : "}" + units);
  }
  // A message of 29 bits may come by J1939's transport protocol, whatever its length.
  if (!known.varies && layout.address.extended)
    for (std::size_t i = 0; i < names.size(); ++i) label(i);
  const std::string first = known.varies ? "{" : names.empty() ? "{}" + units : "{" + names.front();

  const auto head = [&](std::string_view before) {
    const std::string text =
        fmt::format(R"({}"topic":{},"frame":{},"fields":{})", before, json_string(frame.topic->name),
                    json_string(frame_name(frame)), first);
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

inline char* JsonText::put(char* to, Piece piece) const noexcept {
  return put_blocks(to, {pieces_.data() + piece.begin, piece.size});
}

char* JsonText::put_begin(char* to, const BusText& bus, base::Time time) noexcept {
  constexpr std::uint64_t ns_a_second = 1'000'000'000;
  const std::int64_t signed_ns = time.time_since_epoch().count();
  const auto ns = static_cast<std::uint64_t>(signed_ns);
  if (signed_ns < 0 || ns < ns_a_second) {
    to = put_signed(std::copy(line_begin.begin(), line_begin.end(), to), signed_ns);
  } else {
    if (const std::uint64_t number = ns / ns_a_second; second_.number != number) {
      char* const begin = second_.text.data();
      second_.number = number;
      second_.size = static_cast<std::size_t>(
          put_unsigned(std::copy(line_begin.begin(), line_begin.end(), begin), number) - begin);
    }
    std::memcpy(to, second_.text.data(), second_.text.size());
    to += second_.size;
    const std::uint64_t rest = ns % ns_a_second;
    *to++ = static_cast<char>('0' + rest / ten_to_8);
    to = put_eight(to, rest % ten_to_8);
  }
  return put_blocks(to, {bus.text.data(), bus.size});
}

const JsonText::BusText& JsonText::bus_text(std::string_view bus, std::uint16_t number) {
  BusText& kept = buses_[number % buses_.size()];
  if (kept.name != bus || kept.text.empty()) {
    kept.name = bus;
    kept.text = R"(","bus":)" + json_string(bus) + R"(,"id":")";
    kept.size = kept.text.size();
    kept.text.append(block, '\0');
  }
  return kept;
}

namespace {

char* put_j1939(char* to, const j1939::Identifier& id) {
  const auto put_text = [&to](std::string_view text) { to = std::copy(text.begin(), text.end(), to); };
  put_text(R"("priority":)");
  to = put_unsigned(to, id.priority);
  put_text(R"(,"pgn":")");
  to = put_hex(to, id.pgn, 5);
  put_text(R"(","source":)");
  to = put_unsigned(to, id.source);
  put_text(R"(,"destination":)");
  return put_unsigned(to, id.destination);
}
constexpr std::size_t j1939_room = 80;

}  // namespace

/// The identifier of a message, and what it says by J1939.
char* JsonText::put_identity(char* to, const log::Entry& entry, const Known& known) const noexcept {
  to = put_identifier(to, entry.id, can::is_extended(entry.format));
  *to++ = '"';
  if (!known.pgn) return to;
  *to++ = ',';
  return put_j1939(to, j1939::Identifier::decode(entry.id));
}

/// Which of a message's fields are in its bytes: how many of `present_`.
std::size_t JsonText::find_present(const Known& known, std::span<const std::uint8_t> bytes) noexcept {
  const auto& layout = known.frame.layout();
  const FieldPiece* const fields = fields_.data() + known.first_field;
  const Labels* const labels = labels_.data() + known.first_field;
  std::fill_n(chosen_.begin(), known.choices, Chosen::unasked);
  std::size_t count = 0;
  for (std::uint16_t i = 0; i < known.fields; ++i) {
    const protocol::Field& field = fields[i].value.field();
    if (field.position.bytes() > bytes.size()) continue;
    Chosen& chosen = chosen_[labels[i].choice];
    if (chosen == Chosen::unasked) chosen = layout.chooses(field, bytes) ? Chosen::yes : Chosen::no;
    if (chosen == Chosen::yes) present_[count++] = i;
  }
  return count;
}

/// The first `count` of `present_`.
char* JsonText::put_fields(char* to, const Known& known, std::span<const std::uint8_t> bytes,
                           std::size_t count) const noexcept {
  const FieldPiece* const fields = fields_.data() + known.first_field;
  const Labels* const labels = labels_.data() + known.first_field;
  const auto put_text = [&to](std::string_view text) { to = std::copy(text.begin(), text.end(), to); };
  for (std::size_t i = 0; i < count; ++i) {
    if (i != 0) *to++ = ',';
    to = fields[present_[i]].value.print_json(put(to, labels[present_[i]].name), bytes.data());
  }
  put_text(R"(},"units":{)");
  for (std::size_t i = 0; i < count; ++i) {
    if (i != 0) *to++ = ',';
    to = put(to, labels[present_[i]].unit);
  }
  *to++ = '}';
  return to;
}

/// One name; of flags those of all that are set. Nothing where the value has none.
char* JsonText::put_name(char* to, const NamedField& field, std::int64_t raw) const noexcept {
  const ValueName* const first = value_names_.data() + field.first_name;
  const ValueName* const last = first + field.names;
  if (!field.value.field().flags) {
    const auto* const found = std::lower_bound(
        first, last, raw, [](const ValueName& name, std::int64_t value) { return name.raw < value; });
    return found != last && found->raw == raw ? put(put(to, field.label), found->text) : to;
  }
  char* const begin = to;
  for (const ValueName* name = first; name != last; ++name) {
    if ((raw >> name->raw & 1) == 0) continue;
    if (to == begin) {
      to = put(to, field.label);
      *to++ = '"';
    } else {
      *to++ = '|';
    }
    to = put(to, name->text);
  }
  if (to != begin) *to++ = '"';
  return to;
}

/// `,"names":{...}` of the values in a frame that have one, or nothing.
char* JsonText::put_names(char* to, const Known& known, std::span<const std::uint8_t> bytes) const noexcept {
  constexpr std::string_view begin = R"(,"names":{)";
  char* const from = to;
  std::memcpy(to, begin.data(), begin.size());
  char* const first = to + begin.size();
  to = first;
  for (const NamedField& field : std::span{named_}.subspan(known.first_named, known.named)) {
    if (known.varies && !known.frame.layout().has(field.value.field(), bytes)) continue;
    if (field.tabled) {
      // A value without a name adds nothing, and is not guessed.
      const auto place = static_cast<std::size_t>(
          std::min<std::uint64_t>(field.value.bits(bytes.data()), field.greatest + 1U));
      to = put(to, tabled_names_[field.first_tabled + place]);
      continue;
    }
    char* const end = put_name(to, field, field.value.raw(bytes.data()));
    if (end != to) *end = ',', to = end + 1;
  }
  if (to == first) return from;
  to[-1] = '}';
  return to;
}

/// What is not plain, from the first value to the data.
char* JsonText::put_content(char* to, const Known& known, std::span<const std::uint8_t> bytes,
                            std::size_t present) const noexcept {
  if (known.varies) {
    to = put_fields(to, known, bytes, present);
  } else {
    const FieldPiece* const field = fields_.data() + known.first_field;
    for (unsigned i = 0; i < known.fields; ++i)
      to = put(field[i].value.print_json(to, bytes.data()), field[i].after);
  }
  if (known.named != 0) to = put_names(to, known, bytes);
  constexpr std::string_view data = R"(,"data":")";
  return std::copy(data.begin(), data.end(), to);
}

bool JsonText::write(log::Bytes& out, std::string_view bus, const log::Entry& entry) {
  const Known& known = known_of(entry);
  const bool data = known.kind == Kind::fields && entry.length >= known.least && entry.length <= known.most &&
                    !can::is_remote(entry.format);
  if (!everything_ && !(data && known.selected)) return false;
  const std::size_t present = data && known.varies ? find_present(known, entry.bytes()) : 0;
  if (!everything_ && known.varies && present == 0) return false;
  const BusText& named = bus_text(bus, entry.interface);
  if (!data) {
    write_rest(out, named, known, entry);
    return true;
  }
  char* to = put_begin(out.room(room_ + begin_room + named.text.size()), named, entry.time);
  if (known.message) to = put_identity(to, entry, known);
  to = put(to, known.head);
  if (known.plain) {
    const FieldPiece* field = fields_.data() + known.first_field;
    for (unsigned i = 0; i < known.fields; ++i)
      to = put(field[i].value.print_json(to, entry.data.data()), field[i].after);
  } else {
    to = put_content(to, known, entry.bytes(), present);
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

bool JsonText::write_transport(log::Bytes& out, std::string_view bus, const log::Entry& entry,
                               const client::Reception& reception) {
  const j1939::Transported* const message = reception.transported;
  const Known* const known =
      message == nullptr || reception.topic == nullptr
          ? nullptr
          : &messages_[static_cast<std::size_t>(reception.topic - catalogue_->topics.data())];
  if (!everything_ && (known == nullptr || !known->selected || find_present(*known, message->data) == 0))
    return false;
  const BusText& named = bus_text(bus, entry.interface);
  char* to = put_begin(out.room(begin_room + 64 + named.text.size() + j1939_room), named, entry.time);
  to = put_hex(to, entry.id, 8);
  const auto put_text = [&to](std::string_view piece) { to = std::copy(piece.begin(), piece.end(), to); };
  put_text(R"(",)");
  const auto id = j1939::Identifier::decode(entry.id);
  to = put_j1939(to, id);
  put_text(id.pgn == j1939::transfer_group ? R"(,"transport":"packet")" : R"(,"transport":"control")");
  out.grow_to(to);
  if (message != nullptr) write_message(out, known, *message);
  out.append(R"(,"data":")");
  out.grow_to(put_end(put_data(out.room(end_room), entry), entry));
  return true;
}

/// `known`: none of a message that no spec has.
void JsonText::write_message(log::Bytes& out, const Known* known, const j1939::Transported& message) {
  out.append(R"(,"message":{)");
  out.grow_to(put_j1939(out.room(j1939_room), message.id));
  if (known != nullptr) {
    append_formatted(out, R"(,"topic":{},"fields":{{)", json_string(known->frame.topic->name));
    const std::size_t present = find_present(*known, message.data);
    char* to = put_fields(out.room(room_), *known, message.data, present);
    if (known->named != 0) to = put_names(to, *known, message.data);
    out.grow_to(to);
    out.append(R"(,"data":")");
  } else {
    out.append(R"(,"error":"unknown identifier","data":")");
  }
  out.grow_to(put_hex(out.room(2 * message.data.size() + block), message.data));
  out.append("\"}");
}

const protocol::Topic* JsonText::remote_topic(const log::Entry& entry) const noexcept {
  return index_.subject(entry.id, can::data_format(entry.format)).topic;
}

void JsonText::write_rest(log::Bytes& out, const BusText& bus, const Known& known, const log::Entry& entry) {
  char* to = put_begin(out.room(begin_room + 32 + bus.text.size() + j1939_room), bus, entry.time);
  const bool wide = can::is_extended(entry.format) || entry.format == can::Format::error;
  to = put_hex(to, entry.format == can::Format::error ? entry.id | can::error_frame_flag : entry.id,
               wide ? 8 : 3);
  *to++ = '"';
  if (has_groups_ && entry.format == can::Format::extended && !entry.is_fd() &&
      (known.kind == Kind::unknown || known.pgn)) {
    *to++ = ',';
    to = put_j1939(to, j1939::Identifier::decode(entry.id));
  }
  out.grow_to(to);
  const auto priority = protocol::Identifier::decode(entry.id).priority;
  if (known.kind == Kind::request)
    write_request(out, known, entry);
  else if (known.kind == Kind::fields && known.frame.topic->is_message())
    append_formatted(out, R"(,"topic":{},"frame":{},"error":"{}, fewer than {}")",
                     json_string(known.frame.topic->name), json_string(frame_name(known.frame)),
                     client::counted(entry.bytes().size(), "byte"), known.frame.layout().length);
  else if (known.kind == Kind::fields)
    append_formatted(out, R"(,"priority":"{}","topic":{},"frame":{},"error":"DLC {} instead of {}")",
                     name(priority), json_string(known.frame.topic->name),
                     json_string(frame_name(known.frame)), entry.length, known.frame.layout().length);
  else if (entry.format == can::Format::error)
    append_formatted(out, R"(,"error":"error frame: {}")", can::describe(*entry.classic()).view());
  else if (const auto* topic = can::is_remote(entry.format) ? remote_topic(entry) : nullptr)
    append_formatted(out, R"(,"topic":{},"error":"remote frame")", json_string(topic->name));
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
