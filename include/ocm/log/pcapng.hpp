/// pcapng, the file format of Wireshark: nanoseconds, any number of named interfaces, direction, and what the
/// recorder lost. Nothing of an entry is lost but a time before 1970. Blocks of a few dozen bytes, one a
/// frame: a file without its end can be read up to its last whole block.
///
/// Read are both byte orders, several sections, any resolution and offset of time. Blocks that hold no frame
/// are passed over; behind a damaged one reading goes on at the next that looks whole.
/// [draft-ietf-opsawg-pcapng]
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/log/packet.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"

namespace ocm::log {

namespace pcapng {

/// Types of blocks.
namespace block {
inline constexpr std::uint32_t section = 0x0A0D0D0A;  ///< the same in both byte orders
inline constexpr std::uint32_t interface = 1;
inline constexpr std::uint32_t old_packet = 2;  ///< no longer written
inline constexpr std::uint32_t simple_packet = 3;
inline constexpr std::uint32_t statistics = 5;
inline constexpr std::uint32_t packet = 6;
}  // namespace block

inline constexpr std::uint32_t byte_order_magic = 0x1A2B3C4D;
inline constexpr std::uint32_t smallest_block = 12;  ///< type, length, and length again

/// Codes of options, each of one type of block.
namespace option {
inline constexpr std::uint16_t end = 0;
inline constexpr std::uint16_t application = 4;    ///< shb_userappl
inline constexpr std::uint16_t name = 2;           ///< if_name
inline constexpr std::uint16_t resolution = 9;     ///< if_tsresol
inline constexpr std::uint16_t offset = 14;        ///< if_tsoffset
inline constexpr std::uint16_t packet_flags = 2;   ///< epb_flags
inline constexpr std::uint16_t received = 4;       ///< isb_ifrecv
inline constexpr std::uint16_t dropped = 5;        ///< isb_ifdrop
inline constexpr std::uint16_t dropped_by_os = 7;  ///< isb_osdrop
}  // namespace option

/// What stands before the four bytes of epb_flags: code and length.
inline constexpr std::uint32_t flags_option = option::packet_flags | std::uint32_t{4} << 16;

[[nodiscard]] constexpr std::uint32_t padded(std::uint32_t size) noexcept {
  return (size + 3) & ~std::uint32_t{3};
}

/// number * factor >> shift, for a factor below 2^31 and a number below 2^shift: no 128-bit type is on every
/// host.
[[nodiscard]] constexpr std::uint64_t scaled_right(std::uint64_t number, std::uint32_t factor,
                                                   unsigned shift) noexcept {
  const std::uint64_t low = (number & 0xFFFF'FFFF) * factor;
  if (shift <= 32) return low >> shift;  // then all of the number is in its low half
  const std::uint64_t high = (number >> 32) * factor + (low >> 32);
  return shift - 32 < 64 ? high >> (shift - 32) : 0;
}

/// What a tick of an interface is: nanoseconds = ticks * multiply / divide / 2^shift + offset, where only one
/// of the three is not 1.
struct Clock {
  std::uint64_t multiply = 1000;  // microseconds, where a file says nothing
  std::uint64_t divide = 1;
  std::uint8_t shift = 0;
  std::int64_t offset_s = 0;

  /// The byte of if_tsresol: 10^-n, or 2^-n where its highest bit is set.
  void set_resolution(std::uint8_t code) noexcept {
    multiply = divide = 1;
    shift = 0;
    if ((code & 0x80) != 0) {
      multiply = 1'000'000'000;
      shift = code & 0x7F;
      return;
    }
    for (int n = code; n < 9; ++n) multiply *= 10;
    for (int n = 9; n < std::min<int>(code, 28); ++n) divide *= 10;
    if (code > 28) multiply = 0;  // 2^64 ticks of 10^-28 s are 2 ns
  }

  /// Nothing where 64 bits do not hold it.
  [[nodiscard]] std::optional<base::Time> time(std::uint64_t ticks) const noexcept {
    std::uint64_t whole = 0;
    std::int64_t offset = 0;
    std::int64_t ns = 0;
    const std::uint64_t above = shift == 0 ? ticks : shift < 64 ? ticks >> shift : 0;
    if (__builtin_mul_overflow(above, multiply, &whole) ||
        __builtin_mul_overflow(offset_s, 1'000'000'000, &offset))
      return std::nullopt;
    whole /= divide;
    if (shift != 0) {
      const std::uint64_t below = shift < 64 ? ticks & ((std::uint64_t{1} << shift) - 1) : ticks;
      whole += scaled_right(below, 1'000'000'000, shift);
    }
    if (__builtin_add_overflow(offset, whole, &ns)) return std::nullopt;
    return base::Time{base::Duration{ns}};
  }
};

}  // namespace pcapng

class PcapngReader final : public Reader {
 public:
  using Reader::Reader;

  [[nodiscard]] static bool recognises(std::string_view beginning) {
    return beginning.size() >= 12 && packet::load32(beginning.data()) == pcapng::block::section &&
           (packet::load32(beginning.data() + 8) == pcapng::byte_order_magic ||
            packet::load32_big(beginning.data() + 8) == pcapng::byte_order_magic);
  }

  [[nodiscard]] std::size_t read(std::span<Entry> into) override {
    std::size_t count = 0;
    while (count < into.size()) {
      if (const std::uint32_t size = usual(into[count]); size != 0) [[likely]] {
        input_->skip(size);
        ++count;
        continue;
      }
      const std::optional<std::string_view> block = next(count != 0);
      if (!block) break;
      if (take(*block, into[count])) ++count;
      input_->skip(block->size());
    }
    return count;
  }

 private:
  /// An interface of the present section.
  struct Described {
    LinkType type = LinkType::can_socketcan;
    std::uint16_t number = 0;
    bool usual = false;  // link type and clock are what `usual` is for
    pcapng::Clock clock;
    Recorded recorded;
  };

  [[nodiscard]] std::uint32_t load32(const char* from) const noexcept {
    const std::uint32_t word = packet::load32(from);
    return swapped_ ? base::swar::big_endian(word) : word;
  }
  [[nodiscard]] std::uint16_t load16(const char* from) const noexcept {
    const std::uint16_t word = base::swar::load16(from);
    return swapped_ ? static_cast<std::uint16_t>(word << 8 | word >> 8) : word;
  }
  [[nodiscard]] std::uint64_t load64(const char* from) const noexcept {
    const std::uint64_t first = load32(from), second = load32(from + 4);
    return swapped_ ? first << 32 | second : second << 32 | first;
  }
  [[nodiscard]] Place here() const noexcept { return {input_->offset()}; }

  /// The packet that comes next, if it is here, in our byte order, in order, and with no option or the one
  /// that nearly all have: how long its block is. 0 for every other block, which then is not of interest
  /// here.
  [[nodiscard]] std::uint32_t usual(Entry& entry) const noexcept {
    constexpr std::uint32_t shortest = 28 + packet::classic_size + 4, flags_size = 12;
    const std::size_t have = input_->here();
    if (have < shortest || swapped_) return 0;
    const char* const at = input_->peek(0).data();
    const std::uint32_t size = packet::load32(at + 4), interface = packet::load32(at + 8);
    if (packet::load32(at) != pcapng::block::packet || size < shortest || size > have ||
        packet::load32(at + size - 4) != size || interface >= described_.size())
      return 0;
    const Described& source = described_[interface];
    const std::uint64_t ticks = std::uint64_t{packet::load32(at + 12)} << 32 | packet::load32(at + 16);
    std::int64_t ns = 0;
    if (!source.usual || __builtin_mul_overflow(ticks, source.clock.multiply, &ns)) return 0;
    const std::uint32_t bytes = packet::load32(at + 20);
    if (bytes < packet::classic_size || bytes > size - 32) return 0;
    entry.direction = Direction::unknown;
    const char* const options = at + 28 + pcapng::padded(bytes);
    if (const auto left = static_cast<std::size_t>(at + size - 4 - options); left != 0) {
      if (left != flags_size || packet::load32(options) != pcapng::flags_option) return 0;
      entry.direction = direction_of(packet::load32(options + 4));
    }
    entry.time = base::Time{base::Duration{ns}};
    entry.interface = source.number;
    const bool wrong =
        packet::load_frame({at + 28, bytes}, packet::load32_big(at + 28), false, entry).has_value();
    return wrong ? 0 : size;
  }

  /// The next block, whole and not taken yet. Nothing at the end; and with `have_some` nothing where that
  /// would wait or recover from damage, which then is the next call's.
  [[nodiscard]] std::optional<std::string_view> next(bool have_some) {
    for (;;) {
      if (have_some && input_->here() < pcapng::smallest_block) return std::nullopt;
      const std::string_view head = input_->peek(pcapng::smallest_block);
      if (head.size() < pcapng::smallest_block) {
        if (!head.empty()) complain(Cause::truncated, here(), "the beginning of a block");
        input_->skip(head.size());
        return std::nullopt;
      }
      if (packet::load32(head.data()) == pcapng::block::section) learn_byte_order(head);
      const std::uint32_t size = load32(head.data() + 4);
      if (any_section_ && is_size(size)) [[likely]] {
        if (have_some && input_->here() < size) return std::nullopt;
        const std::string_view block = input_->peek(size);
        if (block.size() == size && load32(block.data() + size - 4) == size) [[likely]]
          return block;
      }
      if (have_some || !recover()) return std::nullopt;
    }
  }

  [[nodiscard]] static constexpr bool is_size(std::uint32_t size) noexcept {
    return size >= pcapng::smallest_block && size <= Input::longest && size % 4 == 0;
  }

  /// From a section's first 12 bytes; unchanged by what is none.
  void learn_byte_order(std::string_view head) noexcept {
    const bool ours = packet::load32(head.data() + 8) == pcapng::byte_order_magic;
    if (!ours && packet::load32_big(head.data() + 8) != pcapng::byte_order_magic) return;
    swapped_ = !ours;
    any_section_ = true;
  }

  void complain_of_block() {
    if (!any_section_) return complain(Cause::syntax, here(), "no section begins here");
    const std::uint32_t size = load32(input_->peek(pcapng::smallest_block).data() + 4);
    const std::string bytes = std::to_string(size) + " bytes";
    if (!is_size(size))
      return complain(size > Input::longest ? Cause::too_long : Cause::syntax, here(), "a block of " + bytes);
    const std::size_t have = input_->peek(size).size();
    if (have < size)
      return complain(Cause::truncated, here(), "a block, " + std::to_string(have) + " of " + bytes);
    complain(Cause::syntax, here(), "a block of " + bytes + ", by its end of another length");
  }

  /// Complains of the block that begins here and goes on to the next that looks whole. false: none left.
  bool recover() {
    complain_of_block();
    // A likely block is short: looking for the ends of long ones would take a square of the file's size.
    constexpr std::uint32_t likely = std::uint32_t{1} << 16;
    for (;;) {
      input_->skip(4);
      const std::string_view head = input_->peek(pcapng::smallest_block);
      if (head.size() < pcapng::smallest_block) {
        input_->skip(head.size());
        return false;
      }
      const bool was_swapped = swapped_, had_section = any_section_;
      const std::uint32_t type = packet::load32(head.data());
      if (type == pcapng::block::section) learn_byte_order(head);
      const bool known = type == pcapng::block::section || load32(head.data()) <= pcapng::block::packet;
      const std::uint32_t size = load32(head.data() + 4);
      if (any_section_ && known && is_size(size) && size <= likely) {
        const std::string_view block = input_->peek(size);
        if (block.size() == size && load32(block.data() + size - 4) == size) return true;
      }
      swapped_ = was_swapped;
      any_section_ = had_section;
    }
  }

  /// Whether the block made an entry.
  [[nodiscard]] bool take(std::string_view block, Entry& entry) {
    const char* const at = block.data();
    switch (load32(at)) {
      case pcapng::block::packet:
        if (block.size() < 32) return refuse(Cause::syntax, "a packet without its head");
        return packet_of(block, load32(at + 8), block.substr(28, block.size() - 32), entry);
      case pcapng::block::old_packet:
        if (block.size() < 32) return refuse(Cause::syntax, "a packet without its head");
        return packet_of(block, load16(at + 8), block.substr(28, block.size() - 32), entry);
      case pcapng::block::simple_packet:
        return refuse(Cause::time, "a simple packet, which has none");
      case pcapng::block::section:
        described_.clear();
        return false;
      case pcapng::block::interface:
        interface_of(block);
        return false;
      case pcapng::block::statistics:
        statistics_of(block);
        return false;
      default:
        return false;
    }
  }

  bool refuse(Cause cause, std::string_view detail) {
    complain(cause, here(), detail);
    return false;
  }

  /// `rest`: the packet, its padding and the options.
  [[nodiscard]] bool packet_of(std::string_view block, std::uint32_t interface, std::string_view rest,
                               Entry& entry) {
    if (interface >= described_.size())
      return refuse(Cause::syntax, "a packet of interface " + std::to_string(interface) + ", not described");
    const Described& source = described_[interface];
    const char* const at = block.data();
    const std::uint32_t size = load32(at + 20);
    if (size > rest.size()) return refuse(Cause::length, "a packet longer than its block");
    if (!holds_can(source.type))
      return refuse(Cause::unsupported,
                    "link type " + std::to_string(static_cast<std::uint32_t>(source.type)));
    const auto time = source.clock.time(std::uint64_t{load32(at + 12)} << 32 | load32(at + 16));
    if (!time) return refuse(Cause::time, "beyond 64 bits of nanoseconds");
    entry.time = *time;
    entry.interface = source.number;
    entry.direction = Direction::unknown;
    if (const auto wrong = packet::load(rest.substr(0, size), source.type, swapped_, entry))
      return refuse(*wrong, "a packet of " + std::to_string(size) + " bytes");
    if (const std::uint32_t after = pcapng::padded(size); rest.size() > after)
      read_options(rest.substr(after), entry);
    return true;
  }

  void read_options(std::string_view options, Entry& entry) const noexcept {
    each_option(options, [&](std::uint16_t code, std::string_view value) {
      if (code != pcapng::option::packet_flags || value.size() != 4) return;
      entry.direction = direction_of(load32(value.data()));
    });
  }
  [[nodiscard]] static constexpr Direction direction_of(std::uint32_t flags) noexcept {
    constexpr Direction directions[] = {Direction::unknown, Direction::received, Direction::sent,
                                        Direction::unknown};
    return directions[flags & 3];
  }

  /// Up to the end, or to an option that is longer than what is left.
  template <class Use>
  void each_option(std::string_view options, Use use) const {
    while (options.size() >= 4) {
      const std::uint16_t code = load16(options.data());
      const std::uint16_t size = load16(options.data() + 2);
      options.remove_prefix(4);
      if (code == pcapng::option::end || size > options.size()) return;
      use(code, options.substr(0, size));
      options.remove_prefix(std::min<std::size_t>(pcapng::padded(size), options.size()));
    }
  }

  void interface_of(std::string_view block) {
    if (block.size() < 20) {
      refuse(Cause::syntax, "an interface without its head");
      return;
    }
    if (described_.size() == Interfaces::most) {
      refuse(Cause::unsupported, "more interfaces than any log has");
      return;
    }
    Described source;
    source.type = static_cast<LinkType>(load16(block.data() + 8));
    std::string name;
    each_option(block.substr(16, block.size() - 20), [&](std::uint16_t code, std::string_view value) {
      if (code == pcapng::option::name) name = value;
      if (code == pcapng::option::resolution && value.size() == 1)
        source.clock.set_resolution(packet::load8(value.data()));
      if (code == pcapng::option::offset && value.size() == 8)
        source.clock.offset_s = static_cast<std::int64_t>(load64(value.data()));
    });
    if (const auto end = name.find('\0'); end != std::string::npos) name.resize(end);
    // Only what carries CAN is an interface of ours; the rest is complained of packet by packet.
    if (holds_can(source.type)) {
      if (name.empty()) name = "can" + std::to_string(described_.size());
      source.number = interfaces_.number(name);
      if (interfaces_.name(source.number) != name) {
        refuse(Cause::unsupported, "more interfaces than any log has");
        source.type = LinkType::none;
      }
    }
    const pcapng::Clock& clock = source.clock;
    source.usual = source.type == LinkType::can_socketcan && clock.divide == 1 && clock.shift == 0 &&
                   clock.offset_s == 0;
    described_.push_back(source);
  }

  void statistics_of(std::string_view block) {
    const std::uint32_t interface = block.size() < 24 ? 0xFFFF'FFFF : load32(block.data() + 8);
    if (interface >= described_.size()) {
      refuse(Cause::syntax, "statistics of an interface that is not described");
      return;
    }
    Described& source = described_[interface];
    if (!holds_can(source.type)) return;
    Recorded now;
    each_option(block.substr(20, block.size() - 24), [&](std::uint16_t code, std::string_view value) {
      if (value.size() != 8) return;
      if (code == pcapng::option::received) now.received = load64(value.data());
      if (code == pcapng::option::dropped || code == pcapng::option::dropped_by_os)
        now.dropped += load64(value.data());
    });
    // Counted from the section's beginning: the last block of an interface tells all of it.
    if (recorded_.size() <= source.number) recorded_.resize(source.number + std::size_t{1});
    Recorded& sum = recorded_[source.number];
    sum.received += now.received - source.recorded.received;
    sum.dropped += now.dropped - source.recorded.dropped;
    source.recorded = now;
  }

  std::vector<Described> described_;
  bool swapped_ = false;
  bool any_section_ = false;
};

class PcapngWriter final : public Writer {
 public:
  void begin(Bytes& out) override {
    const std::size_t start = open(out, pcapng::block::section);
    out.little(pcapng::byte_order_magic);
    out.little(std::uint16_t{1});  // version 1.0
    out.little(std::uint16_t{0});
    out.little(std::int64_t{-1});  // the section's length is not known yet
    add_option(out, pcapng::option::application, "ocm");
    out.little(std::uint32_t{0});  // the end of the options
    close(out, start);
  }

  void write(Bytes& out, std::span<const Entry> entries, const Interfaces& interfaces) override {
    while (described_ < interfaces.size()) describe(out, interfaces);
    for (const Entry& entry : entries) {
      while (entry.interface >= described_) describe(out, interfaces);
      append(out, entry);
    }
  }

  void recorded(Bytes& out, std::span<const Recorded> recorded) override {
    const std::size_t count = std::min(recorded.size(), described_);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t start = open(out, pcapng::block::statistics);
      out.little(static_cast<std::uint32_t>(i));
      add_time(out, last_);
      add_option(out, pcapng::option::received, recorded[i].received);
      add_option(out, pcapng::option::dropped, recorded[i].dropped);
      out.little(std::uint32_t{0});  // the end of the options
      close(out, start);
    }
  }

 private:
  /// A block whose length is not known yet; returns where it begins.
  static std::size_t open(Bytes& out, std::uint32_t type) {
    const std::size_t start = out.size();
    out.little(type);
    out.little(std::uint32_t{0});
    return start;
  }
  static void close(Bytes& out, std::size_t start) {
    const auto size = static_cast<std::uint32_t>(out.size() - start + 4);
    out.little(size);
    out.little_at(start + 4, size);
  }

  static void add_option(Bytes& out, std::uint16_t code, std::string_view value) {
    value = value.substr(0, 0xFFFF);
    const auto size = static_cast<std::uint16_t>(value.size());
    out.little(code);
    out.little(size);
    out.append(value);
    out.zeros(pcapng::padded(size) - size);
  }
  static void add_option(Bytes& out, std::uint16_t code, std::uint64_t value) {
    out.little(code);
    out.little(std::uint16_t{8});
    out.little(value);
  }
  static void add_time(Bytes& out, std::uint64_t ns) {
    out.little(static_cast<std::uint32_t>(ns >> 32));
    out.little(static_cast<std::uint32_t>(ns));
  }

  /// Interfaces have the numbers that they have in the log.
  void describe(Bytes& out, const Interfaces& interfaces) {
    const std::string_view name = interfaces.name(static_cast<std::uint16_t>(described_));
    ++described_;
    const std::size_t start = open(out, pcapng::block::interface);
    out.little(static_cast<std::uint16_t>(LinkType::can_socketcan));
    out.little(std::uint16_t{0});
    out.little(std::uint32_t{0});  // packets of any length
    if (!name.empty()) add_option(out, pcapng::option::name, name);
    add_option(out, pcapng::option::resolution, "\x09");  // 10^-9 s
    out.little(std::uint32_t{0});
    close(out, start);
  }

  void append(Bytes& out, const Entry& entry) {
    constexpr std::size_t head = 28, flags = 12;
    const std::int64_t signed_ns = entry.time.time_since_epoch().count();
    if (signed_ns < 0) losses_.add(Lost::time);  // before 1970: the format has no sign
    const std::uint64_t ns = signed_ns < 0 ? 0 : static_cast<std::uint64_t>(signed_ns);
    last_ = std::max(last_, ns);
    const auto size = static_cast<std::uint32_t>(packet::size_of(entry));
    const bool directed = entry.direction != Direction::unknown;
    const auto total = static_cast<std::uint32_t>(head + size + (directed ? flags : 0) + 4);
    char* const at = out.room(total);
    packet::store32(at, pcapng::block::packet);
    packet::store32(at + 4, total);
    packet::store32(at + 8, entry.interface);
    packet::store32(at + 12, static_cast<std::uint32_t>(ns >> 32));
    packet::store32(at + 16, static_cast<std::uint32_t>(ns));
    packet::store32(at + 20, size);  // of it recorded
    packet::store32(at + 24, size);  // of it on the wire
    packet::store(at + head, entry);
    char* behind = at + head + size;
    if (directed) {
      packet::store32(behind, pcapng::flags_option);
      packet::store32(behind + 4, entry.direction == Direction::received ? 1 : 2);
      packet::store32(behind + 8, pcapng::option::end);
      behind += flags;
    }
    packet::store32(behind, total);
    out.grow(total);
  }

  std::size_t described_ = 0;
  std::uint64_t last_ = 0;  // the latest time, ns
};

}  // namespace ocm::log
