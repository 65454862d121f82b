// A catalogue from a DBC file or a JSON spec of any bytes, and any frames on it:
// behind the file's first zero byte. A frame is found by the rule that frame_index.hpp states, a field is
// read bit by bit, what is present is worked out by recursion, and a topic's sample is a list of what came:
// index, receiver, codec, text and JSON must say the same.
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ocm/base/utf8.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/j1939/transport.hpp"

#include "cli/output/field_text.hpp"
#include "cli/output/json_text.hpp"
#include "generator/dbc/encoding.hpp"
#include "generator/spec/from_dbc.hpp"
#include "generator/spec/spec.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using protocol::Field;
using protocol::FrameLayout;
using protocol::Topic;

namespace {

using Bytes = std::span<const std::uint8_t>;

/// A strict reader of JSON (RFC 8259) that keeps nothing.
class Json {
 public:
  explicit Json(std::string_view text) : rest_(text) {}
  [[nodiscard]] bool whole() { return value() && rest_.empty(); }

 private:
  bool take(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool take(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  bool digits() {
    const std::size_t before = rest_.size();
    while (!rest_.empty() && std::isdigit(static_cast<unsigned char>(rest_.front())) != 0)
      rest_.remove_prefix(1);
    return rest_.size() != before;
  }
  bool number() {
    take('-');
    if (!take('0') && !digits()) return false;
    if (take('.') && !digits()) return false;
    if (take('e') || take('E')) {
      if (!take('+')) take('-');
      return digits();
    }
    return true;
  }
  bool string() {
    if (!take('"')) return false;
    while (!rest_.empty() && rest_.front() != '"') {
      const auto c = static_cast<unsigned char>(rest_.front());
      rest_.remove_prefix(1);
      if (c < 0x20) return false;
      if (c != '\\') continue;
      if (take('u')) {
        for (int i = 0; i < 4; ++i, rest_.remove_prefix(1))
          if (rest_.empty() || std::isxdigit(static_cast<unsigned char>(rest_.front())) == 0) return false;
      } else if (rest_.empty() ||
                 std::string_view{"\"\\/bfnrt"}.find(rest_.front()) == std::string_view::npos) {
        return false;
      } else {
        rest_.remove_prefix(1);
      }
    }
    return take('"');
  }
  template <class Item>
  bool list(char begin, char end, Item item) {
    if (!take(begin)) return false;
    if (take(end)) return true;
    do
      if (!item()) return false;
    while (take(','));
    return take(end);
  }
  bool value() {
    if (rest_.empty() || ++depth_ > 100) return false;
    bool good = false;
    switch (rest_.front()) {
      case '{':
        good = list('{', '}', [this] { return string() && take(':') && value(); });
        break;
      case '[':
        good = list('[', ']', [this] { return value(); });
        break;
      case '"':
        good = string();
        break;
      case 't':
        good = take(std::string_view{"true"});
        break;
      case 'f':
        good = take(std::string_view{"false"});
        break;
      case 'n':
        good = take(std::string_view{"null"});
        break;
      default:
        good = number();
    }
    --depth_;
    return good;
  }

  std::string_view rest_;
  int depth_ = 0;
};

// --- bits, by counting them ---

/// Numbers of bits. No heap: they are asked for a hundred times a frame.
class Bits {
 public:
  void push_back(unsigned bit) { bits_.at(size_++) = bit; }
  [[nodiscard]] unsigned* begin() { return bits_.data(); }
  [[nodiscard]] unsigned* end() { return bits_.data() + size_; }

 private:
  std::array<unsigned, 64> bits_;
  std::size_t size_ = 0;
};

/// The bits of a field from its least significant to its most, as DBC numbers them.
Bits bits_of(const protocol::Position& position) {
  Bits bits;
  unsigned bit = position.start;
  for (unsigned i = 0; i < position.width; ++i) {
    bits.push_back(bit);
    bit = position.order == protocol::ByteOrder::little ? bit + 1 : bit % 8 != 0 ? bit - 1 : bit + 15;
  }
  if (position.order == protocol::ByteOrder::big) std::reverse(bits.begin(), bits.end());
  return bits;
}
bool fits(const protocol::Position& position, std::size_t size) {
  for (const unsigned bit : bits_of(position))
    if (bit / 8 >= size) return false;
  return true;
}
std::uint64_t read_bits(const protocol::Position& position, Bytes data) {
  std::uint64_t value = 0;
  unsigned weight = 0;
  for (const unsigned bit : bits_of(position))
    value |= std::uint64_t{(data[bit / 8] >> bit % 8 & 1U) != 0} << weight++;
  return value;
}
bool is_there(const FrameLayout& layout, const Field& field, Bytes data) {
  if (!fits(field.position, data.size())) return false;
  if (field.selector == protocol::no_selector) return true;
  const Field& selector = layout.fields[field.selector];
  if (!is_there(layout, selector, data)) return false;
  const std::uint64_t bits = read_bits(selector.position, data);
  return std::any_of(field.selected.begin(), field.selected.end(),
                     [bits](const auto& range) { return range.first <= bits && bits <= range.last; });
}

// --- the catalogue ---

/// A raw number's physical value, from the field's own words; nothing where it has more digits than a number
/// of the language.
std::optional<long double> value_of(const Field& field, std::int64_t raw) {
  long double plain = static_cast<long double>(raw);
  if (field.number == protocol::Number::float32)
    plain = std::bit_cast<float>(static_cast<std::uint32_t>(raw));
  else if (field.number == protocol::Number::float64)
    plain = std::bit_cast<double>(raw);
  else if (!field.is_signed)
    plain = static_cast<long double>(static_cast<std::uint64_t>(raw));
  const auto number = [](const base::Decimal& decimal) {
    return static_cast<long double>(decimal.digits) * std::pow(10.0L, decimal.exponent);
  };
  const long double value = plain * number(field.scale) + number(field.offset);
  return std::isfinite(value) && std::abs(value) < 1e300L ? std::optional{value} : std::nullopt;
}

/// What is asked of a field with one of its raw numbers.
void check_values(const Field& field, std::int64_t raw) {
  if (const auto value = value_of(field, raw)) {
    // Scale and offset are rounded to doubles, and so are product and sum.
    const long double scaled =
        std::abs(*value) + 2 * std::abs(static_cast<long double>(field.offset.as_double()));
    fuzz::expect(std::abs(static_cast<long double>(field.value(raw)) - *value) <= scaled * 1e-12L + 1e-300L,
                 "a value is raw * scale + offset");
  }
  const bool plain = field.scale == base::Decimal{1, 0} && field.offset.digits == 0;
  if (field.is_float()) {
    const double value = field.value(raw);
    const auto again = field.float_from(value);
    if (plain && !std::isnan(value))
      fuzz::expect(again.ok() && *again == raw, "a float that is encoded again has the same bits");
    if (again && !std::isnan(value) && field.scale.digits != 0)
      fuzz::expect(field.number == protocol::Number::float64 || *again >> 32 == 0, "a float32 has 32 bits");
    return;
  }
  const auto physical = field.physical(raw);
  if (!physical || field.scale.digits == 0) return;
  const auto again = field.raw_from(*physical);
  const bool in_range = field.raw_min <= raw && raw <= field.raw_max;
  if (again)
    fuzz::expect(in_range && *again == raw, "a value that is encoded again has the same bits");
  else
    fuzz::expect(!in_range || again.error != base::Error::bad_syntax, "out of range, or too many digits");
}

void check_field(const FrameLayout& layout, const Field& field) {
  fuzz::expect(!field.name.empty(), "a field has a name");
  const auto& position = field.position;
  fuzz::expect(position.width >= 1 && position.width <= 64 && position.start < 8 * 1785, "a field has bits");
  fuzz::expect(fits(position, position.bytes()) && !fits(position, position.bytes() - 1U),
               "bytes() holds it, and no less");
  fuzz::expect(ocm::base::is_utf8(field.name) && ocm::base::is_utf8(field.unit), "text is UTF-8");
  fuzz::expect(!field.is_float() || position.width == (field.number == protocol::Number::float32 ? 32 : 64),
               "a float has the width of one");
  std::size_t above = 0;
  for (const Field* at = &field; at->selector != protocol::no_selector; at = &layout.fields[at->selector])
    fuzz::expect(
        at->selector < layout.fields.size() && ++above <= layout.fields.size() && !at->selected.empty(),
        "selectors are fields, have values and go in no circle");
  for (const auto& value : field.values) fuzz::expect(ocm::base::is_utf8(value.name), "text is UTF-8");
  fuzz::expect(layout.may_lack(field) == (field.selector != protocol::no_selector ||
                                          !fits(position, layout.length) || layout.any_length()),
               "a field that may lack is selected, or beyond the length");
  const std::size_t index = static_cast<std::size_t>(&field - layout.fields.data());
  fuzz::expect(
      layout.selects(index) == std::any_of(layout.fields.begin(), layout.fields.end(),
                                           [&](const Field& other) { return other.selector == index; }),
      "a selector is one that another field names");
  check_values(field, field.start);
}

void check_topic(const protocol::Catalogue& catalogue, const Topic& topic) {
  fuzz::expect(topic.board < catalogue.boards.size() && !topic.frames.empty(),
               "a topic has a board and frames");
  fuzz::expect(catalogue.find(topic.id) == &topic, "a topic is found by its number");
  const bool sensor = topic.kind == protocol::Kind::sensor;
  fuzz::expect(topic.usual_period() == (sensor ? topic.period.duration() : base::Duration{}),
               "a sensor has a period");
  fuzz::expect(protocol::name(topic.kind) == (sensor ? "sensor" : "actuator"), "a topic has a kind");
  fuzz::expect(!protocol::name(topic.role).empty(), "a topic has a role");
  for (std::size_t i = 0; i < topic.frames.size(); ++i) {
    const protocol::FrameRef frame{&topic, static_cast<std::uint8_t>(i)};
    const FrameLayout& layout = frame.layout();
    fuzz::expect(layout.length <= can::max_dlc && layout.dlc() == layout.length && !layout.fd &&
                     layout.address.by == protocol::Address::By::topic &&
                     protocol::format_of(layout) == can::Format::base,
                 "a topic's frame is a classic one of 11 bits");
    for (unsigned level = 0; level < protocol::priority_levels; ++level) {
      const std::uint32_t id = (sensor ? 0x400U : 0U) | level << 8 | layout.id.value;
      const auto priority = static_cast<protocol::Priority>(level);
      fuzz::expect(protocol::identifier_of(frame, priority) == id,
                   "an identifier is direction, priority, number");
      // Zeros and ones in turn of four are among the longest contents.
      can::Frame longest{.id = id, .dlc = layout.dlc()};
      std::fill_n(longest.data.begin(), layout.dlc(), std::uint8_t{0x0F});
      const unsigned worst = protocol::worst_bits(layout, priority);
      fuzz::expect(can::frame_bits(longest) + can::intermission_bits <= worst &&
                       worst <= can::worst_frame_bits(can::Format::base, layout.length),
                   "no frame is longer than the longest");
    }
    fuzz::expect(layout.accepts(layout.length) && !layout.accepts(layout.length + 1U),
                 "a topic's frame has its length");
    for (const Field& field : layout.fields) check_field(layout, field);
  }
}

void check_message(const Topic& message) {
  fuzz::expect(message.frames.size() == 1, "a message is one frame");
  const FrameLayout& layout = message.frames[0];
  const auto& address = layout.address;
  fuzz::expect(address.by != protocol::Address::By::topic &&
                   address.number <= (address.extended ? can::max_extended_id : can::max_base_id),
               "a message has an identifier");
  fuzz::expect(protocol::identifier_of({&message, 0}, protocol::Priority::urgent) == address.number,
               "a message's identifier has no priority of ours");
  fuzz::expect(layout.accepts(layout.length) && layout.accepts(layout.length + 1U) &&
                   (layout.length == 0 || layout.any_length() || !layout.accepts(layout.length - 1U)),
               "a message may be longer");
  fuzz::expect(layout.dlc() == std::min<unsigned>(layout.length, can::max_dlc), "a length code");
  fuzz::expect(protocol::worst_bits(layout, protocol::Priority::low) ==
                   can::worst_frame_bits(protocol::format_of(layout), layout.length),
               "a message has the closed bound");
  fuzz::expect(message.usual_period() == message.cycle && protocol::name(message.kind) == "message",
               "a message has a cycle");
  for (const Field& field : layout.fields) check_field(layout, field);
}

void check_catalogue(const protocol::Catalogue& catalogue) {
  fuzz::expect(catalogue.find(std::string_view{}) == nullptr, "nothing has no name");
  fuzz::expect(catalogue.find(": no name") == nullptr, "no name has a colon");
  const auto by_name = [&](std::string_view name) -> const Topic* {
    for (const Topic& topic : catalogue.topics)
      if (topic.name == name ||
          std::find(topic.aliases.begin(), topic.aliases.end(), name) != topic.aliases.end())
        return &topic;
    return nullptr;
  };
  bool messages = false;
  for (const Topic& topic : catalogue.topics) {
    fuzz::expect(!topic.name.empty() && catalogue.find(topic.name) == by_name(topic.name), "a name is found");
    for (const auto alias : topic.aliases)
      fuzz::expect(catalogue.find(alias) == (alias.empty() ? nullptr : by_name(alias)), "an alias is found");
    fuzz::expect(topic.board == protocol::no_board || topic.board < catalogue.boards.size(),
                 "a sender is known");
    fuzz::expect(catalogue.board_name(topic) ==
                     (topic.board < catalogue.boards.size() ? catalogue.boards[topic.board].name : ""),
                 "a sender has a name");
    messages = messages || topic.is_message();
    fuzz::expect(topic.is_message() || !messages, "topics come before messages");
    topic.is_message() ? check_message(topic) : check_topic(catalogue, topic);
  }
  for (unsigned id = 0; id <= 0xFF; ++id) {
    const Topic* const found = catalogue.find(protocol::TopicId{static_cast<std::uint8_t>(id)});
    fuzz::expect(found == nullptr || (!found->is_message() && found->id.value == id),
                 "a number is a topic's");
  }
}

/// What a frame is of: a topic that is asked, or a frame of a topic or message.
struct Found {
  const Topic* topic = nullptr;
  std::optional<std::size_t> frame;
};

/// By the rule: topics before messages; an exact identifier before a parameter group, and of two the first.
Found find(const protocol::Catalogue& catalogue, std::uint32_t id, can::Format format) {
  if (format != can::Format::base && format != can::Format::extended) return {};
  const bool extended = format == can::Format::extended;
  for (const Topic& topic : catalogue.topics) {
    if (topic.is_message() || extended) continue;
    const bool sensor = topic.kind == protocol::Kind::sensor;
    const bool from_board = (id & 0x400) != 0;
    if (sensor && !from_board && topic.id.value == (id & 0xFF)) return {&topic, std::nullopt};
    for (std::size_t i = 0; i < topic.frames.size(); ++i)
      if (sensor == from_board && topic.frames[i].id.value == (id & 0xFF)) return {&topic, i};
  }
  for (const Topic& topic : catalogue.topics) {
    const auto& address = topic.frames[0].address;
    if (address.by == protocol::Address::By::identifier && address.extended == extended &&
        address.number == id)
      return {&topic, 0};
  }
  // Of a group below 240 the byte behind it is the destination. [SAE J1939-21, 5.2]
  const auto group = [](std::uint32_t number) {
    return number >> 8 & ((number >> 16 & 0xFF) < 240 ? 0x3FF00U : 0x3FFFFU);
  };
  for (const Topic& topic : catalogue.topics) {
    const auto& address = topic.frames[0].address;
    if (extended && address.by == protocol::Address::By::pgn && group(address.number) == group(id))
      return {&topic, 0};
  }
  return {};
}

/// What came of a topic's sample, as a list.
struct Sequence {
  std::vector<std::pair<std::size_t, std::vector<std::uint8_t>>> frames;
  bool synchronised = false;
};

/// What a frame carries, with exactly the room behind it that can::FrameView promises.
class Data {
 public:
  explicit Data(Bytes bytes)
      : size_(bytes.size()), room_(std::make_unique<std::uint8_t[]>(size_ <= 8 ? 8 : 64)) {
    std::copy(bytes.begin(), bytes.end(), room_.get());
  }
  [[nodiscard]] Bytes bytes() const { return {room_.get(), size_}; }

 private:
  std::size_t size_;
  std::unique_ptr<std::uint8_t[]> room_;
};

class Bus {
 public:
  /// So many topics and messages are looked up one by one: the rule takes the square of their number.
  static constexpr std::size_t most_looked_up = 64;

  explicit Bus(const protocol::Catalogue& catalogue)
      : catalogue_(catalogue), receiver_(catalogue), json_(catalogue), sequences_(catalogue.topics.size()) {
    for (const Topic& topic : catalogue.topics.first(std::min(catalogue.topics.size(), most_looked_up)))
      for (std::size_t i = 0; i < topic.frames.size(); ++i) {
        const std::uint32_t id =
            protocol::identifier_of({&topic, static_cast<std::uint8_t>(i)}, topic.priority);
        const auto found = check_index(id, protocol::format_of(topic.frames[i]));
        fuzz::expect(found.frame.has_value(), "a frame's own identifier is found");
        // Its neighbours, its other priorities, and the other direction.
        for (const std::uint32_t other : {0x001U, 0x100U, 0x200U, 0x400U})
          check_index((id ^ other) & can::max_base_id, can::Format::base);
      }
  }

  void take(fuzz::Input& input) {
    log::Entry entry;
    const std::uint8_t how = input.byte();
    const Topic& topic = catalogue_.topics[input.byte() % catalogue_.topics.size()];
    // Mostly the frame that comes next, so that there are whole samples.
    const std::size_t place = static_cast<std::size_t>(&topic - catalogue_.topics.data());
    const std::size_t next = sequences_[place].frames.empty() ? 0 : sequences_[place].frames.back().first + 1;
    const std::size_t frame = ((how & 0x20) != 0 ? input.byte() : next) % topic.frames.size();
    const FrameLayout& layout = topic.frames[frame];
    const auto priority = static_cast<protocol::Priority>(topic.is_message() ? 0 : input.byte() & 3);
    entry.id = protocol::identifier_of({&topic, static_cast<std::uint8_t>(frame)}, priority);
    entry.format = protocol::format_of(layout);
    if ((how & 1) != 0) {
      entry.id = input.number<std::uint32_t>() &
                 (can::is_extended(entry.format) ? can::max_extended_id : can::max_base_id);
    } else if ((how & 2) != 0) {  // of another sender, destination and priority; a topic's request
      entry.id ^= can::is_extended(entry.format) ? input.number<std::uint32_t>() & 0x1C00'FFFFU
                  : topic.is_message()           ? 0U
                                                 : 0x400U;
    }
    const unsigned kind = how >> 2 & 7;
    if (kind == 1) entry.format = can::Format::base_remote;
    if (kind == 2) entry.format = can::Format::error;
    if (kind == 3) entry.format = can::Format::extended, entry.id |= 0x1000'0000;
    if (!can::is_extended(entry.format) && entry.format != can::Format::error) entry.id &= can::max_base_id;
    const std::size_t length =
        (how & 0x80) != 0 ? input.byte() : std::min<std::size_t>(layout.length, log::max_fd_length);
    entry.length = log::fd_length(log::fd_dlc(std::min<std::size_t>(length, log::max_fd_length)));
    if (entry.length > 8 || (how & 0x40) != 0) entry.flags = log::flag::fd;
    if (entry.is_fd() && (can::is_remote(entry.format) || entry.format == can::Format::error)) return;
    // As logs have it: who sent it, and a length code above 8.
    if (kind == 4) entry.direction = static_cast<log::Direction>(input.byte() % 3);
    if (kind == 5 && entry.length == 8 && !entry.is_fd() && entry.format != can::Format::error)
      entry.raw_dlc = static_cast<std::uint8_t>(9 + input.byte() % 7);
    const auto data = input.bytes(can::is_remote(entry.format) ? 0 : entry.length);
    std::copy(data.begin(), data.end(), entry.data.begin());
    std::fill(entry.data.begin() + static_cast<std::ptrdiff_t>(data.size()), entry.data.end(),
              std::uint8_t{0});
    take(entry);
  }

  /// A message of J1939 in several frames, broadcast; some of its packets may be left out.
  void broadcast(fuzz::Input& input) {
    const Topic& topic = catalogue_.topics[input.byte() % catalogue_.topics.size()];
    const auto& address = topic.frames[0].address;
    if (address.by != protocol::Address::By::pgn) return;
    const std::size_t size = j1939::least_transported + input.number<std::uint16_t>() % 80U;
    const std::uint32_t packets = j1939::packets_of(size);
    const std::uint8_t unknown = input.byte();  // mostly its own group
    const std::uint32_t group = j1939::pgn_of(address.number) ^ (unknown > 0xF0 ? 0x100U : 0U);
    const std::uint64_t left_out = input.byte() > 0xE0 ? input.number<std::uint32_t>() : 0U;
    std::vector<std::uint8_t> data(size);
    const auto given = input.bytes(size);
    std::copy(given.begin(), given.end(), data.begin());
    const auto byte = [](std::uint32_t number) { return static_cast<std::uint8_t>(number); };
    const auto send = [&](std::uint32_t of, std::array<std::uint8_t, 8> bytes) {
      log::Entry entry;
      entry.format = can::Format::extended;
      entry.id = j1939::Identifier{7, of, j1939::global_address, 0x17}.encode();
      entry.length = 8;
      std::copy(bytes.begin(), bytes.end(), entry.data.begin());
      return take_part(entry, data);
    };
    send(j1939::connection_group,
         {32, byte(static_cast<std::uint32_t>(size)), byte(static_cast<std::uint32_t>(size >> 8)),
          byte(packets), 0xFF, byte(group), byte(group >> 8), byte(group >> 16)});
    bool whole = false;
    for (std::uint32_t i = 0; i < packets; ++i) {
      if ((left_out >> i & 1) != 0) continue;
      std::array<std::uint8_t, 8> bytes{byte(i + 1), 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};
      const std::size_t from = i * j1939::bytes_a_packet;
      std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(from),
                  std::min(j1939::bytes_a_packet, size - from), bytes.begin() + 1);
      whole = send(j1939::transfer_group, bytes);
    }
    const std::uint64_t all = (std::uint64_t{1} << packets) - 1;
    fuzz::expect(whole == ((left_out & all) == 0), "a message comes out when all of it came, and not before");
  }

  void finish() const {
    const auto& c = receiver_.counters();
    fuzz::expect(c.frames == taken_ && c.frames == c.samples + c.unknown + c.remote + c.fd + c.wrong_dlc +
                                                       c.errors + c.commands + parts_,
                 "every frame is counted once");
    fuzz::expect(c.incomplete == incomplete_, "every sample that lacks a frame is counted");
  }

 private:
  /// Whether this frame completes the message, which is then `data`.
  bool take_part(const log::Entry& entry, const std::vector<std::uint8_t>& data) {
    const auto reception =
        together_.take({entry.id, entry.format, false, entry.bytes()}, base::Time{base::Duration{1}});
    log::Bytes line;
    fuzz::expect(json_.write_transport(line, "can0", entry, reception), "every frame is shown");
    const std::string_view text = line.view();
    fuzz::expect(
        text.ends_with('\n') && ocm::base::is_utf8(text) && Json{text.substr(0, text.size() - 1)}.whole(),
        "a line is JSON");
    if (reception.transported == nullptr) return false;
    const auto came = reception.transported->data;
    fuzz::expect(std::equal(came.begin(), came.end(), data.begin(), data.end()), "a message is its packets");
    const auto found = find(catalogue_, reception.transported->id.encode(), can::Format::extended);
    fuzz::expect(reception.topic == found.topic, "a message of several frames is found by the rule");
    if (found.topic != nullptr && found.topic->is_message())
      for (const Field& field : found.topic->frames[0].fields)
        fuzz::expect(found.topic->frames[0].has(field, came) == is_there(found.topic->frames[0], field, came),
                     "a field is there by its selectors");
    return true;
  }

  Found check_index(std::uint32_t id, can::Format format) const {
    const Found rule = find(catalogue_, id, format);
    const auto subject = index_.subject(id, format);
    fuzz::expect(subject.topic == rule.topic && static_cast<bool>(subject) == (rule.topic != nullptr),
                 "a frame is found by the rule");
    fuzz::expect(subject.is_request() == (rule.topic != nullptr && !rule.frame),
                 "a request is found by the rule");
    if (rule.frame)
      fuzz::expect(subject.frame.topic == rule.topic && subject.frame.frame == *rule.frame,
                   "and which frame it is");
    if (format != can::Format::base) return rule;
    const bool of_topic = rule.topic != nullptr && !rule.topic->is_message();
    const auto number = protocol::Identifier::decode(id);
    fuzz::expect(index_.subject(number).topic == (of_topic ? rule.topic : nullptr),
                 "a topic's is no message's");
    fuzz::expect(index_.requested(number) == (of_topic && !rule.frame ? rule.topic : nullptr),
                 "who is asked");
    fuzz::expect(static_cast<bool>(index_.find(number)) == (of_topic && rule.frame.has_value()),
                 "whose data it is");
    return rule;
  }

  /// What a topic's frame makes of its sample; `bytes` of a whole one.
  client::Meaning assemble(const Topic& topic, std::size_t frame, Bytes data,
                           std::vector<std::uint8_t>& bytes) {
    Sequence& sequence = sequences_[static_cast<std::size_t>(&topic - catalogue_.topics.data())];
    const auto give_up = [&] {
      incomplete_ += sequence.synchronised ? 1 : 0;
      sequence.synchronised = true;
      sequence.frames.clear();
    };
    if (!sequence.frames.empty() && sequence.frames.back().first >= frame) give_up();
    sequence.frames.emplace_back(frame, std::vector<std::uint8_t>(data.begin(), data.end()));
    sequence.frames.back().second.resize(8);
    if (frame + 1 == topic.frames.size() && sequence.frames.size() == topic.frames.size()) {
      for (const auto& [number, part] : sequence.frames) bytes.insert(bytes.end(), part.begin(), part.end());
      sequence.synchronised = true;
      sequence.frames.clear();
      return client::Meaning::sample;
    }
    if (frame + 1 == topic.frames.size()) give_up();
    ++parts_;
    return client::Meaning::part;
  }

  void take(const log::Entry& entry) {
    using client::Meaning;
    const Data data{entry.bytes()};
    const bool error = entry.format == can::Format::error;
    Found found = error ? Found{} : check_index(entry.id, entry.format);
    if (found.topic != nullptr && entry.is_fd() && !found.topic->is_message()) found = {};
    const bool remote = can::is_remote(entry.format);
    if (remote) found.topic = find(catalogue_, entry.id, can::data_format(entry.format)).topic;
    const Topic* const topic = found.topic;
    const bool message = topic != nullptr && topic->is_message();
    const bool fits_length = found.frame && topic->frames[*found.frame].accepts(data.bytes().size());
    ++taken_;
    std::vector<std::uint8_t> bytes;
    const Meaning meaning = error              ? Meaning::error
                            : topic == nullptr ? Meaning::unknown
                            : remote           ? Meaning::remote
                            : !found.frame     ? Meaning::request
                            : !fits_length     ? Meaning::wrong_dlc
                            : message          ? Meaning::sample
                            : topic->kind == protocol::Kind::actuator
                                ? Meaning::set_point
                                : assemble(*topic, *found.frame, data.bytes(), bytes);
    const auto reception =
        receiver_.take({entry.id, entry.format, entry.is_fd(), data.bytes()}, base::Time{base::Duration{1}});
    fuzz::expect(reception.meaning == meaning && (error || reception.topic == topic),
                 "a frame is what it is");
    if (meaning == Meaning::sample && message) bytes.assign(data.bytes().begin(), data.bytes().end());
    if (meaning == Meaning::sample)
      fuzz::expect(std::equal(bytes.begin(), bytes.end(), reception.sample.bytes.begin(),
                              reception.sample.bytes.end()) &&
                       reception.sample.topic == topic,
                   "a sample is what came");
    if (meaning == Meaning::sample)
      for (std::size_t i = 0; i < topic->frames.size(); ++i) {
        const auto part = reception.sample.data(i);
        fuzz::expect(message || (part.size() == topic->frames[i].length &&
                                 part.data() == &reception.sample.bytes[8 * i]),
                     "a frame of a sample has its length");
      }
    const bool readable = fits_length && !can::is_remote(entry.format);
    if (found.frame) check(topic->frames[*found.frame], data.bytes());

    log::Bytes line;
    fuzz::expect(json_.write(line, "can0", entry), "every frame is shown");
    const std::string_view text = line.view();
    fuzz::expect(
        text.ends_with('\n') && ocm::base::is_utf8(text) && Json{text.substr(0, text.size() - 1)}.whole(),
        "a line is JSON");
    if (!readable) return;
    for (const Field& field : topic->frames[*found.frame].fields) {
      if (!is_there(topic->frames[*found.frame], field, data.bytes())) continue;
      std::string key = "\"";
      cli::append_json(key, field.name);
      fuzz::expect(text.find(key + "\":") != std::string_view::npos, "every field that is there is shown");
    }
  }

  /// Decoding and encoding.
  static void check(const FrameLayout& layout, Bytes data) {
    std::vector<std::uint8_t> used(data.size()), again(data.size());
    for (const Field& field : layout.fields) {
      const bool there = is_there(layout, field, data);
      fuzz::expect(layout.has(field, data) == there, "a field is there by its selectors");
      if (!there) continue;
      const std::uint64_t bits = read_bits(field.position, data);
      const std::int64_t raw = field.raw(data);
      const unsigned width = field.position.width;
      const bool negative = field.is_signed && (bits >> (width - 1) & 1U) != 0;
      const std::uint64_t extended = negative && width < 64 ? bits | ~std::uint64_t{0} << width : bits;
      fuzz::expect(static_cast<std::uint64_t>(raw) == extended, "a field is its bits");
      if (field.position.bytes() <= can::max_dlc) {
        can::Payload payload{};
        std::copy_n(data.begin(), std::min(data.size(), payload.size()), payload.begin());
        fuzz::expect(field.raw(payload) == raw, "of eight bytes as of any");
      }
      protocol::put(std::span{again}, field.position, raw);
      for (const unsigned bit : bits_of(field.position))
        used[bit / 8] = static_cast<std::uint8_t>(used[bit / 8] | 1U << bit % 8);
      check_values(field, raw);
      check_text(field, data, raw);
    }
    for (std::size_t i = 0; i < data.size(); ++i)
      fuzz::expect(again[i] == (data[i] & used[i]), "what is decoded is encoded to the same bits");
  }

  static void check_text(const Field& field, Bytes data, std::int64_t raw) {
    const cli::FieldText printer{field};
    fuzz::expect(printer.raw(data.data()) == raw, "the printer reads the same bits");
    // Exactly the room that it asks for, once.
    static const auto text = std::make_unique<char[]>(cli::FieldText::room);
    const std::string_view plain{
        text.get(), static_cast<std::size_t>(printer.print(text.get(), data.data()) - text.get())};
    fuzz::expect(!plain.empty(), "a value has a text");
    // Beyond the decimals that the library has, a printer has more bits.
    const auto value = field.physical(raw);
    if (value && !field.is_float() && (field.is_signed || field.position.width < 64)) {
      const auto again = base::parse_decimal(plain);
      const bool rounded = plain.find('e') != std::string_view::npos;  // of more than 40 places
      const double least = std::abs(value->as_double()) * 1e-14;
      fuzz::expect(
          rounded ? std::abs(std::strtod(std::string{plain}.c_str(), nullptr) - value->as_double()) <= least
                  : again.ok() && *again == *value,
          "the text of a value is the value");
    }
    const std::string json{text.get(), printer.print_json(text.get(), data.data())};
    fuzz::expect(Json{json}.whole(), "a value is JSON");
  }

  const protocol::Catalogue& catalogue_;
  client::FrameIndex index_{catalogue_};
  client::Receiver receiver_;
  client::Receiver together_{catalogue_, client::Transport::together};
  cli::JsonText json_;
  std::vector<Sequence> sequences_;  // a topic
  std::uint64_t taken_ = 0;
  std::uint64_t parts_ = 0;
  std::uint64_t incomplete_ = 0;
};

/// The same catalogue on one interface only.
void check_interface(spec::Model model) {
  model.put_on("can0");
  const spec::Spec named{std::move(model)};
  const protocol::Catalogue& catalogue = named.catalogue();
  client::InterfaceIndexes indexes{catalogue};
  fuzz::expect(indexes.has_buses() != catalogue.topics.empty(), "names of interfaces matter");
  indexes.name(0, "can0");
  indexes.name(1, "can1");
  for (const Topic& topic : catalogue.topics.first(std::min<std::size_t>(catalogue.topics.size(), 16))) {
    const std::uint32_t id = protocol::identifier_of({&topic, 0}, topic.priority);
    const auto format = protocol::format_of(topic.frames[0]);
    fuzz::expect(indexes.of(0).subject(id, format).topic == find(catalogue, id, format).topic,
                 "on its interface all is found");
    fuzz::expect(!indexes.of(1).subject(id, format), "on another one nothing is");
    fuzz::expect(indexes.of(2).subject(id, format).topic == indexes.of(0).subject(id, format).topic,
                 "on one without a name all is");
  }
}

void check_problems(const std::vector<spec::Problem>& problems) {
  for (const auto& problem : problems)
    fuzz::expect(!problem.place.empty() && !problem.what.empty() && !problem.remedy.empty(),
                 "a problem has place, words and remedy");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto all = fuzz::text_of(data, size);
  const auto text = all.substr(0, all.find('\0'));
  const auto loaded = spec::parse(text, text.starts_with('{') ? "x.json" : "x.dbc");
  fuzz::expect(!spec::is_dbc(text, "x") || !text.starts_with('{'), "JSON is no DBC");
  fuzz::expect((loaded.spec == nullptr) != loaded.problems.empty(), "a file is a catalogue or has problems");
  check_problems(loaded.problems);
  check_problems(loaded.doubts);
  if (!loaded.spec) return 0;
  const protocol::Catalogue& catalogue = loaded.spec->catalogue();
  check_catalogue(catalogue);
  if (catalogue.topics.empty()) {  // nodes alone: no frame means anything
    fuzz::expect(!loaded.doubts.empty(), "a file without messages is doubtful");
    return 0;
  }
  fuzz::Input input{data, size};
  (void)input.bytes(text.size() + 1);
  Bus bus{catalogue};
  for (int i = 0; i < 16 && !input.empty(); ++i) bus.take(input);
  bus.finish();
  if (text.size() % 4 == 0) {
    fuzz::Input other{data, size};
    (void)other.bytes(text.size() + 1);
    bus.broadcast(other);
    check_interface(loaded.spec->take_model());
  }
  return 0;
}
