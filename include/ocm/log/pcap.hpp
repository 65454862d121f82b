/// pcap, the older file format of tcpdump and Wireshark: one interface without a name, microseconds or
/// nanoseconds, no direction (but in cooked captures, which have it). Written in nanoseconds.
///
/// Read are both byte orders and both resolutions. A record has no mark that tells where it begins: behind an
/// impossible length nothing more can be read. A file without its end can be read up to its last whole
/// record. [draft-ietf-opsawg-pcap]
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "ocm/log/packet.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"

namespace ocm::log {

namespace pcap {

inline constexpr std::uint32_t magic_us = 0xA1B2C3D4;
inline constexpr std::uint32_t magic_ns = 0xA1B23C4D;
inline constexpr std::size_t file_header = 24;
inline constexpr std::size_t record_header = 16;
inline constexpr std::string_view only_interface = "can0";  ///< the format has no names

/// What the first four bytes say.
struct Form {
  bool swapped = false;
  bool nanoseconds = false;
};
[[nodiscard]] inline std::optional<Form> form_of(const char* magic) noexcept {
  for (const bool swapped : {false, true}) {
    const std::uint32_t word = swapped ? packet::load32_big(magic) : packet::load32(magic);
    if (word == magic_us || word == magic_ns) return Form{swapped, word == magic_ns};
  }
  return std::nullopt;
}

}  // namespace pcap

class PcapReader final : public Reader {
 public:
  using Reader::Reader;

  [[nodiscard]] static bool recognises(std::string_view beginning) {
    return beginning.size() >= pcap::file_header && pcap::form_of(beginning.data());
  }

  [[nodiscard]] std::size_t read(std::span<Entry> into) override {
    if (state_ == State::begin) state_ = open() ? State::records : State::end;
    std::size_t count = 0;
    while (count < into.size() && state_ == State::records) {
      const std::optional<std::string_view> record = next(count != 0);
      if (!record) break;
      if (take(*record, into[count])) ++count;
      input_->skip(record->size());
    }
    return count;
  }

 private:
  enum class State : std::uint8_t { begin, records, end };

  [[nodiscard]] std::uint32_t load32(const char* from) const noexcept {
    const std::uint32_t word = packet::load32(from);
    return form_.swapped ? base::swar::big_endian(word) : word;
  }
  [[nodiscard]] Place here() const noexcept { return {input_->offset()}; }

  bool open() {
    const std::string_view head = input_->peek(pcap::file_header);
    if (head.empty()) return false;
    if (head.size() < pcap::file_header) {
      complain(Cause::truncated, here(), "the beginning of the file");
      return false;
    }
    const auto form = pcap::form_of(head.data());
    if (!form) {
      complain(Cause::syntax, here(), "not the beginning of a pcap file");
      return false;
    }
    form_ = *form;
    type_ = static_cast<LinkType>(load32(head.data() + 20) & 0x0FFF'FFFF);  // above: about check sequences
    input_->skip(head.size());
    return true;
  }

  /// The next record, whole and not taken yet. Nothing at the end, and where it is not here and `have_some`.
  [[nodiscard]] std::optional<std::string_view> next(bool have_some) {
    if (have_some && input_->here() < pcap::record_header) return std::nullopt;
    const std::string_view head = input_->peek(pcap::record_header);
    if (head.size() < pcap::record_header) {
      if (!head.empty()) return end(Cause::truncated, "the beginning of a record");
      return std::nullopt;
    }
    const std::uint32_t size = load32(head.data() + 8);
    if (size > Input::longest - pcap::record_header)
      return end(Cause::too_long, "a packet of " + std::to_string(size) + " bytes");
    const std::size_t total = pcap::record_header + size;
    if (have_some && input_->here() < total) return std::nullopt;
    const std::string_view record = input_->peek(total);
    if (record.size() == total) return record;
    return end(Cause::truncated,
               "a record, " + std::to_string(record.size()) + " of " + std::to_string(total) + " bytes");
  }

  std::nullopt_t end(Cause cause, std::string_view detail) {
    complain(cause, here(), detail);
    state_ = State::end;
    return std::nullopt;
  }

  bool refuse(Cause cause, std::string_view detail) {
    complain(cause, here(), detail);
    return false;
  }

  [[nodiscard]] bool take(std::string_view record, Entry& entry) {
    if (!holds_can(type_))
      return refuse(Cause::unsupported, "link type " + std::to_string(static_cast<std::uint32_t>(type_)));
    const std::uint32_t seconds = load32(record.data());
    const std::uint32_t fraction = load32(record.data() + 4);
    if (fraction >= (form_.nanoseconds ? 1'000'000'000U : 1'000'000U))
      return refuse(Cause::time, std::to_string(fraction) + " as fraction of a second");
    entry.time = base::Time{base::Duration{std::int64_t{seconds} * 1'000'000'000 +
                                           std::int64_t{fraction} * (form_.nanoseconds ? 1 : 1000)}};
    entry.direction = Direction::unknown;
    const std::string_view bytes = record.substr(pcap::record_header);
    if (const auto wrong = packet::load(bytes, type_, form_.swapped, entry))
      return refuse(*wrong, "a packet of " + std::to_string(bytes.size()) + " bytes");
    if (type_ == LinkType::linux_cooked2) {
      const std::string name = "if" + std::to_string(packet::load32_big(bytes.data() + 4));
      entry.interface = interfaces_.number(name);
      if (interfaces_.name(entry.interface) != name)
        return refuse(Cause::unsupported, "more interfaces than any log has");
    } else {
      if (interfaces_.size() == 0) interfaces_.add(pcap::only_interface);
      entry.interface = 0;
    }
    return true;
  }

  State state_ = State::begin;
  pcap::Form form_;
  LinkType type_ = LinkType::can_socketcan;
};

class PcapWriter final : public Writer {
 public:
  void begin(Bytes& out) override {
    out.little(pcap::magic_ns);
    out.little(std::uint16_t{2});  // version 2.4
    out.little(std::uint16_t{4});
    out.little(std::uint64_t{0});         // time zone and accuracy, unused
    out.little(std::uint32_t{0x4'0000});  // packets are not longer
    out.little(static_cast<std::uint32_t>(LinkType::can_socketcan));
  }

  void write(Bytes& out, std::span<const Entry> entries, const Interfaces& interfaces) override {
    for (const Entry& entry : entries) {
      if (entry.direction != Direction::unknown) losses_.add(Lost::direction);
      const std::string_view name = interfaces.name(entry.interface);
      if (!name.empty() && name != pcap::only_interface) losses_.add(Lost::interface);
      append(out, entry);
    }
  }

 private:
  void append(Bytes& out, const Entry& entry) {
    const std::uint64_t ns = time_of(entry);
    const auto size = static_cast<std::uint32_t>(packet::size_of(entry));
    char* const at = out.room(pcap::record_header + size);
    packet::store32(at, static_cast<std::uint32_t>(ns / 1'000'000'000));
    packet::store32(at + 4, static_cast<std::uint32_t>(ns % 1'000'000'000));
    packet::store32(at + 8, size);   // of it recorded
    packet::store32(at + 12, size);  // of it on the wire
    packet::store(at + pcap::record_header, entry);
    out.grow(pcap::record_header + size);
  }

  /// Nanoseconds within 1970..2106, all that 32 bits of seconds hold.
  std::uint64_t time_of(const Entry& entry) noexcept {
    constexpr std::int64_t latest = std::int64_t{0xFFFF'FFFF} * 1'000'000'000 + 999'999'999;
    const std::int64_t ns = entry.time.time_since_epoch().count();
    if (ns >= 0 && ns <= latest) return static_cast<std::uint64_t>(ns);
    losses_.add(Lost::time);
    return ns < 0 ? 0 : static_cast<std::uint64_t>(latest);
  }
};

}  // namespace ocm::log
