/// The container of MCAP: records, and what writes them. Messages of channels, gathered in chunks with a
/// checksum and an index; behind the last one a summary, by which tools find their way without reading all.
///
/// What is in a chunk is held back until the chunk is closed: after 256 KiB, after a second of the log, or
/// when the caller says so. A file that ends anywhere can be read up to its last whole chunk.
///
/// Memory: a chunk with its index, and about 150 bytes a chunk for the summary, up to 64 MiB: a file of more
/// chunks (100 GiB, or days) has no index, and tools read it from its beginning. No compression.
/// [mcap.dev/spec]
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/swar.hpp"
#include "ocm/base/text.hpp"
#include "ocm/log/bytes.hpp"
#include "ocm/log/crc32.hpp"
#include "ocm/log/packet.hpp"

namespace ocm::log::mcap {

inline constexpr std::string_view magic{"\x89MCAP0\r\n", 8};
inline constexpr std::string_view magic_of_any_version{"\x89MCAP", 5};

/// Kinds of records.
namespace opcode {
inline constexpr std::uint8_t header = 0x01;
inline constexpr std::uint8_t footer = 0x02;
inline constexpr std::uint8_t schema = 0x03;
inline constexpr std::uint8_t channel = 0x04;
inline constexpr std::uint8_t message = 0x05;
inline constexpr std::uint8_t chunk = 0x06;
inline constexpr std::uint8_t message_index = 0x07;
inline constexpr std::uint8_t chunk_index = 0x08;
inline constexpr std::uint8_t attachment = 0x09;
inline constexpr std::uint8_t statistics = 0x0B;
inline constexpr std::uint8_t metadata = 0x0C;
inline constexpr std::uint8_t metadata_index = 0x0D;
inline constexpr std::uint8_t summary_offset = 0x0E;
inline constexpr std::uint8_t data_end = 0x0F;
}  // namespace opcode

inline constexpr std::size_t record_head = 9;    ///< opcode, length of what follows
inline constexpr std::size_t message_head = 22;  ///< channel, sequence, log time, publish time
inline constexpr std::size_t chunk_head = 40;    ///< without the compression's name and the records
inline constexpr std::size_t footer_size = 20;

/// Key and value, both UTF-8.
struct Pair {
  std::string_view key;
  std::string_view value;
};

/// Any bytes as printable ASCII, as addresses of web pages do it: what is not goes in as % and two digits.
[[nodiscard]] inline std::string escaped(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c > ' ' && c <= '~' && c != '%') {
      out += c;
      continue;
    }
    char digits[2];
    base::swar::hex_byte(digits, static_cast<std::uint8_t>(c));
    out.append({'%', digits[0], digits[1]});
  }
  return out;
}
[[nodiscard]] inline std::string unescaped(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const int high = name[i] == '%' && i + 2 < name.size() ? base::hex_digit(name[i + 1]) : -1;
    const int low = high >= 0 ? base::hex_digit(name[i + 2]) : -1;
    out += low >= 0 ? static_cast<char>(high << 4 | low) : name[i];
    if (low >= 0) i += 2;
  }
  return out;
}

/// Takes the fields of a record one after the other. Beyond its end all are zero and empty, and `whole` says
/// so.
class Fields {
 public:
  explicit Fields(std::string_view content) noexcept : rest_(content) {}

  [[nodiscard]] std::uint16_t u16() noexcept { return number<std::uint16_t>(); }
  [[nodiscard]] std::uint32_t u32() noexcept { return number<std::uint32_t>(); }
  [[nodiscard]] std::uint64_t u64() noexcept { return number<std::uint64_t>(); }
  /// With its length of 32 bits in front.
  [[nodiscard]] std::string_view string() noexcept { return bytes(u32()); }
  [[nodiscard]] std::string_view bytes(std::uint64_t count) noexcept {
    if (count > rest_.size()) {
      whole_ = false;
      rest_ = {};
      return {};
    }
    const std::string_view taken = rest_.substr(0, static_cast<std::size_t>(count));
    rest_.remove_prefix(taken.size());
    return taken;
  }
  [[nodiscard]] std::string_view rest() const noexcept { return rest_; }
  [[nodiscard]] bool whole() const noexcept { return whole_; }

 private:
  template <class T>
  T number() noexcept {
    T value{};
    const std::string_view taken = bytes(sizeof value);
    if (!taken.empty()) std::memcpy(&value, taken.data(), sizeof value);
    return value;
  }

  std::string_view rest_;
  bool whole_ = true;
};

class Container {
 public:
  static constexpr std::size_t chunk_size = std::size_t{1} << 18;
  static constexpr std::uint64_t chunk_duration_ns = 1'000'000'000;
  static constexpr std::size_t most_index = std::size_t{1} << 26;

  /// Bytes of index for the summary, beyond which there is none.
  explicit Container(std::size_t index_limit = most_index) noexcept : index_limit_(index_limit) {}

  void begin(Bytes& out, std::string_view library) {
    out.append(magic);
    offset_ = magic.size();
    const std::size_t start = open(out, opcode::header);
    add(out, "");  // of no profile
    add(out, library);
    close(out, start);
  }

  /// A schema in JSON Schema; returns its number. At most 65535 in a file.
  [[nodiscard]] std::uint16_t add_schema(Bytes& out, std::string_view name, std::string_view text) {
    const std::size_t start = open(out, opcode::schema);
    out.little(++schema_count_);
    add(out, name);
    add(out, "jsonschema");
    add(out, text);
    close(out, start);
    schemas_.append(out.view().substr(start));
    return schema_count_;
  }
  /// A channel of messages in JSON; returns its number, from 1. At most 65535 in a file.
  [[nodiscard]] std::uint16_t add_channel(Bytes& out, std::uint16_t schema, std::string_view topic,
                                          std::span<const Pair> metadata = {}) {
    channels_.emplace_back();
    const auto number = static_cast<std::uint16_t>(channels_.size());
    const std::size_t start = open(out, opcode::channel);
    out.little(number);
    out.little(schema);
    add(out, topic);
    add(out, "json");
    add(out, metadata);
    close(out, start);
    channel_records_.append(out.view().substr(start));
    return number;
  }
  void add_metadata(Bytes& out, std::string_view name, std::span<const Pair> pairs) {
    const std::uint64_t where = offset_;
    const std::size_t start = open(out, opcode::metadata);
    add(out, name);
    add(out, pairs);
    close(out, start);
    ++metadata_count_;
    const std::size_t index = begin_record(metadata_indexes_, opcode::metadata_index);
    metadata_indexes_.little(where);
    metadata_indexes_.little(offset_ - where);
    add(metadata_indexes_, name);
    end_record(metadata_indexes_, index);
  }

  /// Begins a message and returns where its data go, at most `most` bytes; `end_message` with the end of them
  /// is the next call.
  [[nodiscard]] char* begin_message(Bytes& out, std::uint16_t channel, std::uint64_t time_ns,
                                    std::size_t most) {
    if (chunk_.size() != 0 && is_full(time_ns)) close_chunk(out);
    if (chunk_.size() == 0) first_ = chunk_times_.first = chunk_times_.last = time_ns;
    chunk_times_.add(time_ns);
    Channel& to = channels_[channel - std::size_t{1}];
    if (to.index.empty()) used_.push_back(channel);
    to.index.push_back({time_ns, chunk_.size()});
    char* at = chunk_.room(record_head + message_head + most);
    *at = static_cast<char>(opcode::message);
    at += record_head;
    std::memcpy(at, &channel, 2);
    packet::store32(at + 2, to.sequence++);
    std::memcpy(at + 6, &time_ns, 8);
    std::memcpy(at + 14, &time_ns, 8);
    return at + message_head;
  }
  void end_message(const char* end) {
    const std::size_t start = chunk_.size();
    chunk_.grow_to(end);
    chunk_.little_at(start + 1, std::uint64_t{chunk_.size() - start - record_head});
  }

  /// What is held back comes out.
  void close_chunk(Bytes& out) {
    if (chunk_.size() == 0) return;
    const std::uint64_t where = offset_;
    const std::string_view records = chunk_.view();
    const std::size_t start = open(out, opcode::chunk);
    out.little(chunk_times_.first);
    out.little(chunk_times_.last);
    out.little(std::uint64_t{records.size()});
    out.little(crc32(records));
    add(out, "");  // no compression
    out.little(std::uint64_t{records.size()});
    out.append(records);
    close(out, start);
    add_indexes(out, where, records.size());

    if (chunk_count_++ == 0) times_ = chunk_times_;
    times_.add(chunk_times_.first);
    times_.add(chunk_times_.last);
    chunk_.clear();
    used_.clear();
  }

  /// The summary. Nothing may follow.
  void finish(Bytes& out) {
    close_chunk(out);
    const std::size_t end = open(out, opcode::data_end);
    out.little(std::uint32_t{0});  // no checksum of all: each chunk has its own
    close(out, end);

    const std::size_t summary = out.size();
    const std::uint64_t summary_start = offset_;
    add_group(out, opcode::schema, schemas_);
    add_group(out, opcode::channel, channel_records_);
    add_group(out, opcode::chunk_index, chunk_indexes_);
    add_group(out, opcode::metadata_index, metadata_indexes_);
    Bytes statistics;
    add_statistics(statistics);
    add_group(out, opcode::statistics, statistics);
    const std::uint64_t offsets_start = offset_;
    out.append(summary_offsets_.view());

    const std::size_t footer = open(out, opcode::footer);
    out.little(summary_start);
    out.little(offsets_start);
    out.little_at(footer + 1, std::uint64_t{footer_size});  // the checksum is of this, too
    out.little(crc32(out.view().substr(summary)));
    close(out, footer);
    out.append(magic);
  }

 private:
  struct Times {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
    void add(std::uint64_t time) noexcept {
      first = std::min(first, time);
      last = std::max(last, time);
    }
  };
  struct IndexEntry {
    std::uint64_t time;
    std::uint64_t offset;  // in the chunk's records
  };
  struct Channel {
    std::uint32_t sequence = 0;
    std::uint64_t count = 0;
    std::vector<IndexEntry> index;  // of the present chunk
  };

  [[nodiscard]] bool is_full(std::uint64_t time) const noexcept {
    return chunk_.size() >= chunk_size ||
           (time > first_ ? time - first_ : first_ - time) >= chunk_duration_ns;
  }

  static std::size_t begin_record(Bytes& out, std::uint8_t kind) {
    const std::size_t start = out.size();
    out.append(static_cast<char>(kind));
    out.little(std::uint64_t{0});
    return start;
  }
  static void end_record(Bytes& out, std::size_t start) {
    out.little_at(start + 1, std::uint64_t{out.size() - start - record_head});
  }
  /// Of the file itself, whose offsets count.
  static std::size_t open(Bytes& out, std::uint8_t kind) { return begin_record(out, kind); }
  void close(Bytes& out, std::size_t start) {
    end_record(out, start);
    offset_ += out.size() - start;
  }

  static void add(Bytes& out, std::string_view text) {
    out.little(static_cast<std::uint32_t>(text.size()));
    out.append(text);
  }
  static void add(Bytes& out, std::span<const Pair> pairs) {
    const std::size_t start = out.size();
    out.little(std::uint32_t{0});
    for (const Pair& pair : pairs) {
      add(out, pair.key);
      add(out, pair.value);
    }
    out.little_at(start, static_cast<std::uint32_t>(out.size() - start - 4));
  }

  /// Behind a chunk where each message of each channel is, and for the summary where that stands.
  void add_indexes(Bytes& out, std::uint64_t chunk_start, std::size_t size) {
    const std::uint64_t indexes_start = offset_;
    const std::size_t record = begin_record(chunk_indexes_, opcode::chunk_index);
    chunk_indexes_.little(chunk_times_.first);
    chunk_indexes_.little(chunk_times_.last);
    chunk_indexes_.little(chunk_start);
    chunk_indexes_.little(indexes_start - chunk_start);
    chunk_indexes_.little(static_cast<std::uint32_t>(used_.size() * (2 + 8)));
    for (const std::uint16_t number : used_) {
      chunk_indexes_.little(number);
      chunk_indexes_.little(offset_);
      add_message_index(out, number);
    }
    chunk_indexes_.little(offset_ - indexes_start);
    add(chunk_indexes_, "");  // no compression
    chunk_indexes_.little(std::uint64_t{size});
    chunk_indexes_.little(std::uint64_t{size});
    end_record(chunk_indexes_, record);
    // All chunks or none: tools take what is not in an index for not there.
    has_index_ = has_index_ && chunk_indexes_.size() <= index_limit_;
    if (!has_index_) chunk_indexes_.clear();
  }
  void add_message_index(Bytes& out, std::uint16_t number) {
    Channel& channel = channels_[number - std::size_t{1}];
    static_assert(sizeof(IndexEntry) == 16);
    const std::size_t size = channel.index.size() * sizeof(IndexEntry);
    const std::size_t start = open(out, opcode::message_index);
    out.little(number);
    out.little(static_cast<std::uint32_t>(size));
    std::memcpy(out.room(size), channel.index.data(), size);
    out.grow(size);
    close(out, start);
    channel.count += channel.index.size();
    channel.index.clear();
  }

  void add_statistics(Bytes& out) const {
    std::uint64_t messages = 0;
    for (const Channel& channel : channels_) messages += channel.count;
    const std::size_t start = begin_record(out, opcode::statistics);
    out.little(messages);
    out.little(schema_count_);
    out.little(static_cast<std::uint32_t>(channels_.size()));
    out.little(std::uint32_t{0});  // attachments
    out.little(metadata_count_);
    out.little(chunk_count_);
    out.little(times_.first);
    out.little(times_.last);
    out.little(static_cast<std::uint32_t>(channels_.size() * (2 + 8)));
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      out.little(static_cast<std::uint16_t>(i + 1));
      out.little(channels_[i].count);
    }
    end_record(out, start);
  }

  /// Records of one kind, into the summary.
  void add_group(Bytes& out, std::uint8_t kind, const Bytes& records) {
    if (records.size() == 0) return;
    const std::size_t start = begin_record(summary_offsets_, opcode::summary_offset);
    summary_offsets_.append(static_cast<char>(kind));
    summary_offsets_.little(offset_);
    summary_offsets_.little(std::uint64_t{records.size()});
    end_record(summary_offsets_, start);
    out.append(records.view());
    offset_ += records.size();
  }

  std::size_t index_limit_;
  std::uint64_t offset_ = 0;  // of what is written next, from the file's beginning
  std::uint64_t first_ = 0;   // time of the chunk's first message
  Times chunk_times_;
  Times times_;
  Bytes chunk_;  // the records of the present chunk
  std::vector<Channel> channels_;
  std::vector<std::uint16_t> used_;  // channels that have messages in the present chunk
  std::uint16_t schema_count_ = 0;
  std::uint32_t metadata_count_ = 0;
  std::uint32_t chunk_count_ = 0;
  bool has_index_ = true;
  // Records of the summary, as they will stand there.
  Bytes schemas_;
  Bytes channel_records_;
  Bytes chunk_indexes_;
  Bytes metadata_indexes_;
  Bytes summary_offsets_;
};

}  // namespace ocm::log::mcap
