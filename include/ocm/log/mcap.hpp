/// MCAP, the log format of Foxglove and of many robots: frames as JSON messages (mcap_frame.hpp), a channel
/// /can0/raw for each interface, in chunks (mcap_container.hpp). Nothing of an entry is lost, times before
/// 1970 included. What is not yet in a chunk comes out with `flush`, or after a second of the log.
///
/// Read are the frames of this library's channels, by any writer, packed with zstd or not; messages
/// of other channels are passed over. Chunks are believed up to Input::longest. Behind damage reading goes on
/// at the next chunk; one whose checksum is wrong is reported, and read unchecked. [mcap.dev/spec]
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/text.hpp"
#include "ocm/log/mcap_container.hpp"
#include "ocm/log/mcap_frame.hpp"
#include "ocm/log/packet.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"

namespace ocm::log {

namespace mcap {

/// The metadata record in which a file says what its recorder knows of a channel.
inline constexpr std::string_view recorded_name = "ocm.recorded";

/// The name of the channel that holds the frames of an interface: /can0/raw. Of one without a name: /raw.
[[nodiscard]] inline std::string raw_topic(std::string_view interface) {
  return (interface.empty() ? "" : "/" + escaped(interface)) + "/raw";
}
[[nodiscard]] inline std::string interface_of(std::string_view raw_topic) {
  if (raw_topic.ends_with("/raw")) raw_topic.remove_suffix(4);
  if (raw_topic.starts_with('/')) raw_topic.remove_prefix(1);
  return unescaped(raw_topic);
}

}  // namespace mcap

/// Unpacks zstd data into at most `into.size()` bytes: how many they are, 0 when it cannot be done. Handed
/// in, because this library brings no decompressor.
using Unzstd = std::size_t (*)(std::string_view packed, std::span<char> into);

class McapReader final : public Reader {
 public:
  /// Without `unzstd` packed chunks are complained of.
  explicit McapReader(Input& input, Unzstd unzstd = nullptr) : Reader(input), unzstd_(unzstd) {}

  [[nodiscard]] static bool recognises(std::string_view beginning) {
    return beginning.starts_with(mcap::magic_of_any_version);
  }

  [[nodiscard]] std::size_t read(std::span<Entry> into) override {
    std::size_t count = 0;
    while (count < into.size() && state_ != State::end) {
      if (!records_.empty()) {
        if (take_of_chunk(into[count])) ++count;
      } else if (in_chunk_ != 0) {
        input_->skip(std::exchange(in_chunk_, 0));
      } else if (state_ == State::begin) {
        open();
      } else {
        const Step step = next(into[count], count == 0 ? Input::Wait::yes : Input::Wait::no);
        if (step == Step::later) break;
        if (step == Step::entry) ++count;
      }
    }
    return count;
  }

 private:
  enum class State : std::uint8_t { begin, records, end };
  enum class Step : std::uint8_t { entry, nothing, later };
  enum class Kind : std::uint8_t { unknown, other, raw };
  struct Channel {
    Kind kind = Kind::unknown;
    std::uint16_t interface = 0;
  };

  void open() {
    const std::string_view head = input_->peek(mcap::magic.size());
    if (head == mcap::magic) {
      input_->skip(head.size());
      state_ = State::records;
      return;
    }
    if (recognises(head) && head.size() == mcap::magic.size())
      complain(Cause::unsupported, {}, "an MCAP file of another version");
    else
      complain(mcap::magic.starts_with(head) ? Cause::truncated : Cause::syntax, {},
               "the file's first bytes");
    state_ = State::end;
  }

  [[nodiscard]] Place here() const noexcept { return {input_->offset()}; }

  /// The next record of the file.
  [[nodiscard]] Step next(Entry& entry, Input::Wait wait) {
    const auto missing = [&](std::uint64_t size) { return wait == Input::Wait::no && input_->here() < size; };
    if (missing(mcap::record_head)) return Step::later;
    const std::string_view head = input_->peek(mcap::record_head);
    if (head.size() < mcap::record_head) return end_early(head.size());
    const std::uint8_t kind = packet::load8(head.data());
    const std::uint64_t length = base::swar::load64(head.data() + 1);
    if (kind == mcap::opcode::footer && length == mcap::footer_size) return finish();
    if (kind == 0 || kind == mcap::opcode::footer) {
      complain(Cause::syntax, here(), "no record begins here");
      return find_chunk();
    }
    // Only attachments may be of any length.
    if (length > Input::longest - mcap::record_head && kind != mcap::opcode::attachment) {
      complain(Cause::too_long, here(), name_of(kind) + " of " + std::to_string(length) + " bytes");
      return find_chunk();
    }
    if (!is_wanted(kind)) {
      if (missing(length)) return Step::later;
      return pass_over(kind, length);
    }
    const std::uint64_t size = mcap::record_head + length;
    if (missing(size)) return Step::later;
    const std::string_view record = input_->peek(static_cast<std::size_t>(size));
    const bool whole = record.size() == size;
    if (!whole) end_within(here(), kind);
    const std::string_view content = record.substr(mcap::record_head);
    if (kind == mcap::opcode::chunk) {
      enter(content, whole);
      in_chunk_ = record.size();
      return Step::nothing;
    }
    const bool made = whole && take(kind, content, here(), entry);
    input_->skip(record.size());
    return made ? Step::entry : Step::nothing;
  }

  [[nodiscard]] bool is_wanted(std::uint8_t kind) const noexcept {
    return kind == mcap::opcode::metadata ||
           (!summary_ && (kind == mcap::opcode::schema || kind == mcap::opcode::channel ||
                          kind == mcap::opcode::message || kind == mcap::opcode::chunk));
  }
  [[nodiscard]] static std::string name_of(std::uint8_t kind) {
    switch (kind) {
      case mcap::opcode::schema:
        return "a schema";
      case mcap::opcode::channel:
        return "a channel";
      case mcap::opcode::message:
        return "a message";
      case mcap::opcode::chunk:
        return "a chunk";
      default:
        return "a record of kind " + std::to_string(kind);
    }
  }

  [[nodiscard]] Step pass_over(std::uint8_t kind, std::uint64_t length) {
    const Place place = here();
    summary_ = summary_ || kind == mcap::opcode::data_end;
    input_->skip(mcap::record_head);
    if (!input_->discard(length)) end_within(place, kind);
    return Step::nothing;
  }
  void end_within(Place place, std::uint8_t kind) {
    complain(Cause::truncated, place, name_of(kind));
    ended_ = true;
  }

  [[nodiscard]] Step end_early(std::size_t left) {
    if (!ended_)
      complain(Cause::truncated, here(), left == 0 ? "no end of the file" : "the beginning of a record");
    input_->skip(left);
    return end();
  }
  /// The footer, and the magic behind it.
  [[nodiscard]] Step finish() {
    const Place place = here();
    const bool whole = input_->discard(mcap::record_head + mcap::footer_size);
    const std::string_view last = input_->peek(mcap::magic.size() + 1);
    if (!whole || (last.size() < mcap::magic.size() && mcap::magic.starts_with(last)))
      complain(Cause::truncated, place, "the file's end");
    else if (last != mcap::magic)
      complain(Cause::syntax, place, "the file does not end behind its footer");
    return end();
  }
  [[nodiscard]] Step end() {
    if (!any_raw_ && passed_over_ != 0)
      complain(Cause::unsupported, {},
               std::to_string(passed_over_) + " messages, none on a channel of CAN frames");
    state_ = State::end;
    return Step::nothing;
  }

  /// Behind damage: goes to what looks like a chunk, whose lengths agree with each other.
  [[nodiscard]] Step find_chunk() {
    constexpr std::size_t head = mcap::record_head + mcap::chunk_head;
    constexpr std::size_t name = 4;  // of a compression, at most
    for (std::size_t step = 1;;) {
      input_->skip(step);
      const std::string_view rest = input_->peek(head + name);
      if (rest.size() < head) {
        input_->skip(rest.size());
        ended_ = true;  // that there was damage is said
        return Step::nothing;
      }
      const char* const at = rest.data();
      const std::uint32_t compression = packet::load32(at + 37);
      if (*at == mcap::opcode::chunk && compression <= name && rest.size() >= head + compression) {
        const std::uint64_t records = base::swar::load64(at + 41 + compression);
        if (records < Input::longest &&
            base::swar::load64(at + 1) == records + compression + mcap::chunk_head)
          return Step::nothing;
      }
      const std::size_t next = rest.find(static_cast<char>(mcap::opcode::chunk), 1);
      step = next == std::string_view::npos ? rest.size() : next;
    }
  }

  /// Goes on with the records of a chunk. Of one that is cut off, with those that are there.
  void enter(std::string_view content, bool whole) {
    const Place place = here();
    mcap::Fields fields{content};
    static_cast<void>(fields.bytes(16));  // times of the first and the last message
    const std::uint64_t size = fields.u64();
    const std::uint32_t checksum = fields.u32();
    const std::string_view compression = fields.string();
    const std::uint64_t packed_size = fields.u64();
    if (!fields.whole()) {
      if (whole) complain(Cause::syntax, place, "the head of a chunk");
      return;
    }
    const std::string_view packed = fields.rest().substr(
        0, static_cast<std::size_t>(std::min<std::uint64_t>(packed_size, fields.rest().size())));
    chunk_whole_ = whole && packed.size() == packed_size;
    if (whole && !chunk_whole_) complain(Cause::length, place, "records beyond their chunk");
    if (compression.empty())
      records_ = packed;
    else if (!unpack(compression, packed, size))
      return;
    chunk_place_ = place;
    chunk_place_.number += compression.empty()
                               ? static_cast<std::size_t>(packed.data() - content.data()) + mcap::record_head
                               : 0;
    chunk_begin_ = records_.data();
    is_packed_ = !compression.empty();
    if (chunk_whole_ && checksum != 0 && crc32(records_) != checksum)
      complain(Cause::checksum, place, "a chunk, which is read unchecked");
  }

  [[nodiscard]] bool unpack(std::string_view compression, std::string_view packed, std::uint64_t size) {
    const Place place = here();
    if (compression != "zstd" || unzstd_ == nullptr) {
      complain(Cause::compressed, place,
               "a chunk in " + std::string{compression} + (unzstd_ == nullptr ? "" : "; zstd is read"));
      return false;
    }
    if (size > Input::longest) {
      complain(Cause::too_long, place, "a chunk of " + std::to_string(size) + " bytes");
      return false;
    }
    if (unpacked_size_ < size) {
      unpacked_size_ = static_cast<std::size_t>(size);
      unpacked_ = std::make_unique<char[]>(unpacked_size_);
    }
    const std::size_t got = unzstd_(packed, {unpacked_.get(), static_cast<std::size_t>(size)});
    if (got != size && chunk_whole_)
      complain(Cause::compressed, place,
               "a chunk, " + std::to_string(got) + " of " + std::to_string(size) + " bytes");
    chunk_whole_ = chunk_whole_ && got == size;
    records_ = {unpacked_.get(), std::min(got, static_cast<std::size_t>(size))};
    return true;
  }

  /// The next record of the chunk. Whether it made an entry.
  [[nodiscard]] bool take_of_chunk(Entry& entry) {
    const std::uint64_t length =
        records_.size() < mcap::record_head ? UINT64_MAX : base::swar::load64(records_.data() + 1);
    if (length > records_.size() - mcap::record_head || records_.size() < mcap::record_head) {
      if (chunk_whole_) complain(Cause::syntax, place_in_chunk(), "a record beyond its chunk");
      records_ = {};
      return false;
    }
    const std::uint8_t kind = packet::load8(records_.data());
    const std::string_view content = records_.substr(mcap::record_head, static_cast<std::size_t>(length));
    const bool made = take(kind, content, place_in_chunk(), entry);
    records_.remove_prefix(mcap::record_head + content.size());
    return made;
  }
  [[nodiscard]] Place place_in_chunk() const noexcept {
    return {chunk_place_.number +
            (is_packed_ ? 0 : static_cast<std::size_t>(records_.data() - chunk_begin_))};
  }

  [[nodiscard]] bool take(std::uint8_t kind, std::string_view content, Place place, Entry& entry) {
    if (kind == mcap::opcode::message) [[likely]]
      return message(content, place, entry);
    if (kind == mcap::opcode::schema)
      schema(content, place);
    else if (kind == mcap::opcode::channel)
      channel(content, place);
    else if (kind == mcap::opcode::metadata)
      metadata(content);
    else
      complain(Cause::syntax, place, name_of(kind) + " within a chunk");
    return false;
  }

  void schema(std::string_view content, Place place) {
    mcap::Fields fields{content};
    const std::uint16_t number = fields.u16();
    const std::string_view name = fields.string();
    if (!fields.whole()) return complain(Cause::syntax, place, "a schema");
    if (schemas_.size() <= number) schemas_.resize(number + std::size_t{1});
    schemas_[number] = name == mcap::frame_schema_name ? Kind::raw : Kind::other;
  }

  void channel(std::string_view content, Place place) {
    mcap::Fields fields{content};
    const std::uint16_t number = fields.u16(), schema = fields.u16();
    const std::string_view topic = fields.string(), encoding = fields.string();
    if (!fields.whole()) return complain(Cause::syntax, place, "a channel");
    if (channels_.size() <= number) channels_.resize(number + std::size_t{1});
    Channel& channel = channels_[number];
    const Kind kind = schema == 0 ? Kind::other : schema < schemas_.size() ? schemas_[schema] : Kind::unknown;
    if (kind == Kind::unknown)
      return complain(Cause::syntax, place, "a channel of a schema of which nothing is said");
    if (kind == Kind::raw && encoding != "json")
      return complain(Cause::unsupported, place, "CAN frames in another encoding than JSON");
    if (kind == Kind::other) {
      channel.kind = Kind::other;
      return;
    }
    any_raw_ = true;
    const std::string name = mcap::interface_of(topic);
    if (channel.kind == Kind::raw && interfaces_.name(channel.interface) == name) return;  // said again
    channel = {Kind::raw, interfaces_.add(name)};
  }

  [[nodiscard]] bool message(std::string_view content, Place place, Entry& entry) {
    if (content.size() < mcap::message_head) return refuse(Cause::length, place, "a message");
    const std::uint16_t number = base::swar::load16(content.data());
    const Channel channel = number < channels_.size() ? channels_[number] : Channel{};
    if (channel.kind != Kind::raw) {
      if (channel.kind == Kind::unknown)
        return refuse(Cause::syntax, place,
                      "a message of channel " + std::to_string(number) + ", of which nothing is said");
      ++passed_over_;
      return false;
    }
    const std::uint64_t ns = base::swar::load64(content.data() + 6);
    if (ns > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
      return refuse(Cause::time, place, "a message");
    entry.time = base::Time{base::Duration{static_cast<std::int64_t>(ns)}};
    entry.interface = channel.interface;
    const std::string_view text = content.substr(mcap::message_head);
    if (mcap::parse_usual(text, entry)) return true;
    if (const auto cause = mcap::FrameParser{text}.parse(entry)) return refuse(*cause, place, text);
    return true;
  }
  bool refuse(Cause cause, Place place, std::string_view detail) {
    complain(cause, place, detail);
    return false;
  }

  /// What the recorder said of a channel; metadata of others is ignored.
  void metadata(std::string_view content) {
    mcap::Fields fields{content};
    if (fields.string() != mcap::recorded_name) return;
    mcap::Fields pairs{fields.string()};
    std::size_t number = 0;
    Recorded sum;
    while (!pairs.rest().empty()) {
      const std::string_view key = pairs.string();
      const auto value = base::parse_unsigned(pairs.string());
      if (!value) return;
      if (key == "channel") number = static_cast<std::size_t>(std::min<std::uint64_t>(*value, SIZE_MAX));
      if (key == "received") sum.received = *value;
      if (key == "dropped") sum.dropped = *value;
    }
    if (number >= channels_.size() || channels_[number].kind != Kind::raw) return;
    const std::size_t interface = channels_[number].interface;
    if (recorded_.size() <= interface) recorded_.resize(interface + 1);
    recorded_[interface].received += sum.received;
    recorded_[interface].dropped += sum.dropped;
  }

  Unzstd unzstd_;
  State state_ = State::begin;
  bool summary_ = false;  // what comes now was said before
  bool ended_ = false;    // and how is said
  bool any_raw_ = false;
  bool is_packed_ = false;
  bool chunk_whole_ = false;
  std::uint64_t passed_over_ = 0;
  std::vector<Kind> schemas_;  // by number
  std::vector<Channel> channels_;
  std::string_view records_;  // what is left of the present chunk: in the input, or in `unpacked_`
  const char* chunk_begin_ = nullptr;
  Place chunk_place_;         // of its first record, of a packed one its own
  std::size_t in_chunk_ = 0;  // its size in the input, which is skipped behind it
  std::unique_ptr<char[]> unpacked_;
  std::size_t unpacked_size_ = 0;
};

class McapWriter : public Writer {
 public:
  /// Key and value, in UTF-8, of what the file says about itself in a metadata record "ocm".
  using About = std::vector<std::pair<std::string, std::string>>;

  explicit McapWriter(std::string library = "ocm", About about = {})
      : library_(std::move(library)), about_(std::move(about)) {}

  void begin(Bytes& out) override {
    container_.begin(out, library_);
    std::vector<mcap::Pair> pairs;
    for (const auto& [key, value] : about_) pairs.push_back({key, value});
    if (!pairs.empty()) container_.add_metadata(out, "ocm", pairs);
    schema_ = container_.add_schema(out, mcap::frame_schema_name, mcap::frame_schema);
  }

  void write(Bytes& out, std::span<const Entry> entries, const Interfaces& interfaces) override {
    describe(out, interfaces.size(), interfaces);
    for (const Entry& entry : entries) put(out, entry, interfaces);
  }

  void flush(Bytes& out) override { container_.close_chunk(out); }

  void recorded(Bytes& out, std::span<const Recorded> recorded) override {
    const std::size_t count = std::min(recorded.size(), channels_.size());
    for (std::size_t i = 0; i < count; ++i) {
      const std::string channel = std::to_string(channels_[i]),
                        received = std::to_string(recorded[i].received),
                        dropped = std::to_string(recorded[i].dropped);
      const mcap::Pair pairs[] = {{"channel", channel}, {"received", received}, {"dropped", dropped}};
      container_.add_metadata(out, mcap::recorded_name, pairs);
    }
  }

  void finish(Bytes& out) override { container_.finish(out); }

 protected:
  [[nodiscard]] mcap::Container& container() noexcept { return container_; }

  /// The time of a message; that of a frame before 1970 is in its text.
  [[nodiscard]] static std::uint64_t time_of(const Entry& entry) noexcept {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(entry.time.time_since_epoch().count(), 0));
  }

  void put(Bytes& out, const Entry& entry, const Interfaces& interfaces) {
    if (entry.interface >= channels_.size()) describe(out, entry.interface + std::size_t{1}, interfaces);
    char* const at =
        container_.begin_message(out, channels_[entry.interface], time_of(entry), mcap::frame_room);
    container_.end_message(mcap::put_frame(at, entry));
  }

 private:
  /// Channels of the first `count` interfaces, in their order, so that a reader numbers them alike.
  void describe(Bytes& out, std::size_t count, const Interfaces& interfaces) {
    while (channels_.size() < count) {
      const auto number = static_cast<std::uint16_t>(channels_.size());
      channels_.push_back(container_.add_channel(out, schema_, mcap::raw_topic(interfaces.name(number))));
    }
  }

  std::string library_;
  About about_;
  mcap::Container container_;
  std::uint16_t schema_ = 0;
  std::vector<std::uint16_t> channels_;  // by number of the interface
};

}  // namespace ocm::log
