// A catalogue that nobody has seen before, from a DBC file of any bytes, and any frames on it: behind the
// file's first zero byte. A frame is found by the rule that frame_index.hpp states, a field is read bit by
// bit, and what is present is worked out by recursion: index, receiver, codec, text and JSON must say the
// same.
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ocm/client/sample.hpp"

#include "cli/output/field_text.hpp"
#include "cli/output/json_text.hpp"
#include "generator/dbc/encoding.hpp"
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

/// The bits of a field from its least significant to its most, as DBC numbers them.
std::vector<unsigned> bits_of(const protocol::Position& position) {
  std::vector<unsigned> bits;
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

void check_field(const FrameLayout& layout, const Field& field) {
  fuzz::expect(!field.name.empty(), "a field has a name");
  const auto& position = field.position;
  fuzz::expect(position.width >= 1 && position.width <= 64 && position.start < 512, "a field has bits");
  fuzz::expect(fits(position, position.bytes()) && !fits(position, position.bytes() - 1U),
               "bytes() holds it, and no less");
  fuzz::expect(dbc::is_utf8(field.name) && dbc::is_utf8(field.unit), "text is UTF-8");
  fuzz::expect(!field.is_float() || position.width == (field.number == protocol::Number::float32 ? 32 : 64),
               "a float has the width of one");
  std::size_t above = 0;
  for (const Field* at = &field; at->selector != protocol::no_selector; at = &layout.fields[at->selector])
    fuzz::expect(
        at->selector < layout.fields.size() && ++above <= layout.fields.size() && !at->selected.empty(),
        "selectors are fields, have values and go in no circle");
  for (const auto& value : field.values) fuzz::expect(dbc::is_utf8(value.name), "text is UTF-8");
}

void check_catalogue(const protocol::Catalogue& catalogue) {
  fuzz::expect(!catalogue.topics.empty(), "a catalogue has messages");
  for (const Topic& topic : catalogue.topics) {
    fuzz::expect(topic.is_message() && topic.frames.size() == 1 && !topic.name.empty(),
                 "a DBC file has messages");
    const FrameLayout& layout = topic.frames[0];
    const auto& address = layout.address;
    fuzz::expect(address.by != protocol::Address::By::topic &&
                     address.number <= (address.extended ? can::max_extended_id : can::max_base_id),
                 "a message has an identifier");
    fuzz::expect(topic.board == protocol::no_board || topic.board < catalogue.boards.size(),
                 "a sender is known");
    for (const Field& field : layout.fields) check_field(layout, field);
  }
}

/// By the rule: an exact identifier before a parameter group, and of two the first.
const Topic* find(const protocol::Catalogue& catalogue, std::uint32_t id, can::Format format) {
  if (format != can::Format::base && format != can::Format::extended) return nullptr;
  const bool extended = format == can::Format::extended;
  for (const Topic& topic : catalogue.topics) {
    const auto& address = topic.frames[0].address;
    if (address.by == protocol::Address::By::identifier && address.extended == extended &&
        address.number == id)
      return &topic;
  }
  // Of a group below 240 the byte behind it is the destination. [SAE J1939-21, 5.2]
  const auto group = [](std::uint32_t number) {
    return number >> 8 & ((number >> 16 & 0xFF) < 240 ? 0x3FF00U : 0x3FFFFU);
  };
  for (const Topic& topic : catalogue.topics) {
    const auto& address = topic.frames[0].address;
    if (extended && address.by == protocol::Address::By::pgn && group(address.number) == group(id))
      return &topic;
  }
  return nullptr;
}

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
  explicit Bus(const protocol::Catalogue& catalogue)
      : catalogue_(catalogue), receiver_(catalogue), json_(catalogue) {
    for (const Topic& topic : catalogue.topics) {
      const auto& address = topic.frames[0].address;
      const auto subject = index_of().subject(address.number, protocol::format_of(topic.frames[0]));
      fuzz::expect(subject.topic == find(catalogue, address.number, protocol::format_of(topic.frames[0])) &&
                       subject.frame,
                   "a message's own identifier is found");
    }
  }

  void take(fuzz::Input& input) {
    log::Entry entry;
    const std::uint8_t how = input.byte();
    const Topic& topic = catalogue_.topics[input.byte() % catalogue_.topics.size()];
    const FrameLayout& layout = topic.frames[0];
    entry.id = layout.address.number;
    entry.format = protocol::format_of(layout);
    if ((how & 1) != 0) {
      entry.id = input.number<std::uint32_t>() &
                 (can::is_extended(entry.format) ? can::max_extended_id : can::max_base_id);
    } else if ((how & 2) != 0) {  // of another sender, destination and priority
      entry.id ^= input.number<std::uint32_t>() & (can::is_extended(entry.format) ? 0x1C00'FFFFU : 0U);
    }
    if (how >> 2 == 1) entry.format = can::Format::base_remote;
    if (how >> 2 == 2) entry.format = can::Format::error;
    if (how >> 2 == 3) entry.format = can::Format::extended, entry.id |= 0x1000'0000;
    if (!can::is_extended(entry.format) && entry.format != can::Format::error) entry.id &= can::max_base_id;
    const std::size_t length =
        (how & 0x80) != 0 ? input.byte() : std::min<std::size_t>(layout.length, log::max_fd_length);
    entry.length = log::fd_length(log::fd_dlc(std::min<std::size_t>(length, log::max_fd_length)));
    if (entry.length > 8 || (how & 0x40) != 0) entry.flags = log::flag::fd;
    if (entry.is_fd() && (can::is_remote(entry.format) || entry.format == can::Format::error)) return;
    const auto data = input.bytes(can::is_remote(entry.format) ? 0 : entry.length);
    std::copy(data.begin(), data.end(), entry.data.begin());
    std::fill(entry.data.begin() + static_cast<std::ptrdiff_t>(data.size()), entry.data.end(),
              std::uint8_t{0});
    take(entry);
  }

  void finish() const {
    const auto& c = receiver_.counters();
    fuzz::expect(
        c.frames == taken_ && c.frames == c.samples + c.unknown + c.fd + c.wrong_dlc + c.errors + c.commands,
        "every frame is counted once");
  }

 private:
  [[nodiscard]] const client::FrameIndex& index_of() const { return index_; }

  void take(const log::Entry& entry) {
    using client::Meaning;
    const Data data{entry.bytes()};
    const bool error = entry.format == can::Format::error;
    const Topic* const topic = error ? nullptr : find(catalogue_, entry.id, entry.format);
    const auto subject = index_.subject(entry.id, entry.format);
    fuzz::expect(error || subject.topic == topic, "a frame is found by the rule");
    ++taken_;
    const auto reception =
        receiver_.take({entry.id, entry.format, entry.is_fd(), data.bytes()}, base::Time{base::Duration{1}});
    const bool long_enough = topic != nullptr && data.bytes().size() >= topic->frames[0].length;
    const Meaning meaning = error              ? Meaning::error
                            : topic == nullptr ? Meaning::unknown
                            : long_enough      ? Meaning::sample
                                               : Meaning::wrong_dlc;
    fuzz::expect(reception.meaning == meaning && (error || reception.topic == topic),
                 "a frame is what it is");
    if (meaning == Meaning::sample)
      fuzz::expect(std::equal(data.bytes().begin(), data.bytes().end(), reception.sample.bytes.begin(),
                              reception.sample.bytes.end()),
                   "a message is what came");
    if (topic != nullptr) check(topic->frames[0], data.bytes());

    log::Bytes line;
    fuzz::expect(json_.write(line, "can0", entry), "every frame is shown");
    const std::string_view text = line.view();
    fuzz::expect(text.ends_with('\n') && dbc::is_utf8(text) && Json{text.substr(0, text.size() - 1)}.whole(),
                 "a line is JSON");
    if (meaning != Meaning::sample) return;
    for (const Field& field : topic->frames[0].fields) {
      if (!is_there(topic->frames[0], field, data.bytes())) continue;
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
      protocol::put(std::span{again}, field.position, raw);
      for (const unsigned bit : bits_of(field.position))
        used[bit / 8] = static_cast<std::uint8_t>(used[bit / 8] | 1U << bit % 8);
      check_text(field, data, raw);
    }
    for (std::size_t i = 0; i < data.size(); ++i)
      fuzz::expect(again[i] == (data[i] & used[i]), "what is decoded is encoded to the same bits");
  }

  static void check_text(const Field& field, Bytes data, std::int64_t raw) {
    const cli::FieldText printer{field};
    fuzz::expect(printer.raw(data.data()) == raw, "the printer reads the same bits");
    const auto text = std::make_unique<char[]>(cli::FieldText::room);
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
  cli::JsonText json_;
  std::uint64_t taken_ = 0;
};

void check_problems(const std::vector<spec::Problem>& problems) {
  for (const auto& problem : problems)
    fuzz::expect(!problem.place.empty() && !problem.what.empty() && !problem.remedy.empty(),
                 "a problem has place, words and remedy");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto all = fuzz::text_of(data, size);
  const auto text = all.substr(0, all.find('\0'));
  const auto loaded = spec::parse(text, "x.dbc");
  fuzz::expect((loaded.spec == nullptr) != loaded.problems.empty(), "a file is a catalogue or has problems");
  check_problems(loaded.problems);
  check_problems(loaded.doubts);
  if (!loaded.spec) return 0;
  const protocol::Catalogue& catalogue = loaded.spec->catalogue();
  check_catalogue(catalogue);
  fuzz::Input input{data, size};
  (void)input.bytes(text.size() + 1);
  Bus bus{catalogue};
  for (int i = 0; i < 32 && !input.empty(); ++i) bus.take(input);
  bus.finish();
  return 0;
}
