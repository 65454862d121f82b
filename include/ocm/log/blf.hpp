/// BLF, the binary log of Vector's tools: read only. Nanoseconds or tens of microseconds since a local time
/// of milliseconds; channels in place of names. Objects stand in containers, most of them compressed with
/// zlib, and go over from one container to the next.
///
/// Sizes that the file claims are believed up to Input::longest, which bounds the memory. Behind damage
/// reading goes on at the next object's signature. There is no public specification; the layout is that of
/// python-can and of the Vector BLF library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/log/calendar.hpp"
#include "ocm/log/channels.hpp"
#include "ocm/log/packet.hpp"
#include "ocm/log/reader.hpp"

namespace ocm::log {

/// Unpacks zlib data into at most `into.size()` bytes: how many they are, 0 when it cannot be done. Handed
/// in, because this library brings no decompressor.
using Inflate = std::size_t (*)(std::string_view packed, std::span<char> into);

namespace blf {

inline constexpr std::string_view file_signature = "LOGG";
inline constexpr std::string_view object_signature = "LOBJ";
inline constexpr std::size_t file_header = 72;    ///< of it that is looked at; files have 144
inline constexpr std::size_t start_time = 40;     ///< in the file's header
inline constexpr std::size_t object_base = 16;    ///< signature, header's size, version, size, type
inline constexpr std::size_t object_header = 32;  ///< the shortest one
inline constexpr std::size_t container_header = 32;

/// Bytes between objects; tools do not agree on how many. As long as a signature without its last byte, which
/// is why as many are kept when one is looked for.
inline constexpr std::size_t most_filling = 3;

/// Types of objects.
namespace object {
inline constexpr std::uint32_t message = 1;
inline constexpr std::uint32_t error = 2;
inline constexpr std::uint32_t container = 10;
inline constexpr std::uint32_t error_ext = 73;
inline constexpr std::uint32_t message2 = 86;
inline constexpr std::uint32_t fd_message = 100;
inline constexpr std::uint32_t fd_message64 = 101;
inline constexpr std::uint32_t fd_error64 = 104;
}  // namespace object

[[nodiscard]] constexpr bool holds_frame(std::uint32_t type) noexcept {
  return type == object::message || type == object::message2 || type == object::fd_message ||
         type == object::fd_message64 || type == object::error || type == object::error_ext ||
         type == object::fd_error64;
}

/// Bits in front of an identifier, and of the flags of frames.
inline constexpr std::uint32_t extended_flag = 0x8000'0000;
inline constexpr std::uint8_t remote_flag = 0x80;  ///< below it the direction: 0 received, 1 sent
inline constexpr std::uint32_t remote_flag64 = 0x10, fd_flag64 = 0x1000, switch_flag64 = 0x2000,
                               state_flag64 = 0x4000;

/// What the kinds of messages have in common.
struct Message {
  std::uint32_t channel = 0;
  std::uint32_t id = 0;
  std::uint8_t direction = 0;
  std::uint8_t dlc = 0;
  std::uint8_t flags = 0;  ///< of namespace flag
  bool remote = false;
  std::string_view data;  ///< what there is of it
};

}  // namespace blf

class BlfReader final : public Reader {
 public:
  BlfReader(Input& input, Inflate inflate) : Reader(input), inflate_(inflate) {}

  [[nodiscard]] static bool recognises(std::string_view beginning) {
    return beginning.starts_with(blf::file_signature);
  }

  [[nodiscard]] std::size_t read(std::span<Entry> into) override {
    if (state_ == State::begin) state_ = open() ? State::objects : State::end;
    std::size_t count = 0;
    while (count < into.size() && state_ == State::objects) {
      const std::optional<std::string_view> object = next_object();
      if (object) {
        if (take(*object, into[count])) ++count;
      } else if (count != 0) {
        break;  // the next container is the next call's: it may take a while to come
      } else if (!load_container()) {
        if (stream_.size() - begin_ > blf::most_filling) complain(Cause::truncated, place_, "an object");
        state_ = State::end;
      }
    }
    return count;
  }

 private:
  enum class State : std::uint8_t { begin, objects, end };

  bool open() {
    const std::string_view head = input_->peek(blf::file_header);
    if (head.empty()) return false;
    if (!head.starts_with(blf::file_signature) || head.size() < blf::file_header) {
      complain(head.starts_with(blf::file_signature) ? Cause::truncated : Cause::syntax, {},
               "the file's head");
      return false;
    }
    const char* const time = head.data() + blf::start_time;
    const CalendarTime local{load16(time),     load16(time + 2),  load16(time + 6),
                             load16(time + 8), load16(time + 10), load16(time + 12)};
    if (const auto seconds = seconds_of(local))
      start_ns_ = *seconds * 1'000'000'000 + std::int64_t{load16(time + 14)} * 1'000'000;
    else if (load16(time) != 0)  // all zeros: unknown
      complain(Cause::time, {blf::start_time}, "the file's start time");
    const std::uint32_t size = packet::load32(head.data() + 4);
    if (input_->discard(std::max<std::uint64_t>(size, blf::file_header))) return true;
    complain(Cause::truncated, {}, "the file's head");
    return false;
  }

  [[nodiscard]] static std::uint16_t load16(const char* from) noexcept { return base::swar::load16(from); }

  /// The next object in what is unpacked, taken; nothing where it is not whole.
  [[nodiscard]] std::optional<std::string_view> next_object() {
    for (;;) {
      const std::string_view rest = std::string_view{stream_}.substr(begin_);
      if (rest.size() < blf::object_base) return std::nullopt;
      if (!rest.starts_with(blf::object_signature)) {
        const std::size_t found = rest.find(blf::object_signature);
        const std::size_t end = found == std::string_view::npos ? rest.size() - blf::most_filling : found;
        if (end > blf::most_filling && !lost_)
          complain(Cause::syntax, place_, "no object begins in the container");
        lost_ = found == std::string_view::npos;  // told of once
        begin_ += end;
        continue;
      }
      lost_ = false;
      const std::uint32_t size = packet::load32(rest.data() + 8);
      if (size < blf::object_base || size > Input::longest) {
        complain(size < blf::object_base ? Cause::syntax : Cause::too_long, place_,
                 "an object of " + std::to_string(size) + " bytes");
        begin_ += blf::object_signature.size();
        lost_ = true;
        continue;
      }
      if (rest.size() < size) return std::nullopt;
      begin_ += size;
      return rest.substr(0, size);
    }
  }

  /// Appends what the next object of the file holds to what is unpacked. false: the file is at its end.
  [[nodiscard]] bool load_container() {
    stream_.erase(0, begin_);
    begin_ = 0;
    std::string_view head = input_->peek(blf::object_base);
    for (bool told = false; head.size() >= blf::object_base && !head.starts_with(blf::object_signature);) {
      const auto found = input_->peek(Input::padding).find(blf::object_signature);
      const std::size_t step = found == std::string_view::npos ? head.size() - blf::most_filling : found;
      if (step > blf::most_filling && !told)
        complain(Cause::syntax, here(), "no object begins here"), told = true;
      input_->skip(step);
      head = input_->peek(blf::object_base);
    }
    if (head.size() < blf::object_base) {
      const bool filling =
          head.size() <= blf::most_filling && head.find_first_not_of('\0') == std::string_view::npos;
      if (!filling) complain(Cause::truncated, here(), "the beginning of an object");
      input_->skip(head.size());
      return false;
    }
    place_ = here();
    const std::uint32_t size = packet::load32(head.data() + 8);
    const std::uint32_t type = packet::load32(head.data() + 12);
    if (size < blf::object_base || size > Input::longest) {
      complain(size < blf::object_base ? Cause::syntax : Cause::too_long, place_,
               "an object of " + std::to_string(size) + " bytes");
      input_->skip(blf::object_signature.size());
      return true;
    }
    const std::string_view object = input_->peek(size);
    if (object.size() < size) {
      complain(Cause::truncated, place_,
               "an object, " + std::to_string(object.size()) + " of " + std::to_string(size) + " bytes");
      if (type == blf::object::container) unpack(object);  // as far as it goes
      input_->skip(object.size());
      return true;
    }
    if (type == blf::object::container)
      unpack(object);
    else if (blf::holds_frame(type))  // older files have objects without a container
      stream_.append(object);
    input_->skip(size);
    return true;
  }

  [[nodiscard]] Place here() const noexcept { return {input_->offset()}; }

  void unpack(std::string_view object) {
    if (object.size() < blf::container_header) return complain(Cause::length, place_, "a container");
    const std::uint16_t method = load16(object.data() + 16);
    const std::uint32_t claimed = packet::load32(object.data() + 24);
    const std::string_view packed = object.substr(blf::container_header);
    if (method == 0) {
      stream_.append(packed);
      return;
    }
    if (method != 2 || inflate_ == nullptr)
      return complain(Cause::compressed, place_, "a container of method " + std::to_string(method));
    if (claimed > Input::longest || stream_.size() > Input::longest)
      return complain(Cause::too_long, place_, "a container of " + std::to_string(claimed) + " bytes");
    const std::size_t before = stream_.size();
    stream_.resize(before + claimed);
    const std::size_t got = inflate_(packed, std::span{stream_}.subspan(before));
    stream_.resize(before + std::min<std::size_t>(got, claimed));
    if (got != claimed)
      complain(Cause::compressed, place_,
               "a container, " + std::to_string(got) + " of " + std::to_string(claimed) + " bytes");
  }

  bool refuse(Cause cause, std::string_view detail) {
    complain(cause, place_, detail);
    return false;
  }

  /// Whether the object made an entry.
  [[nodiscard]] bool take(std::string_view object, Entry& entry) {
    const char* const at = object.data();
    const std::uint32_t type = packet::load32(at + 12);
    if (!blf::holds_frame(type)) return false;
    const std::size_t head = load16(at + 4);
    if (head < blf::object_header || head > object.size())
      return refuse(Cause::syntax, "the head of an object");
    if (!time_of(base::swar::load64(at + 24), packet::load32(at + 16), entry))
      return refuse(Cause::time, "beyond nanoseconds");
    const std::string_view body = object.substr(head);
    switch (type) {
      case blf::object::message:
      case blf::object::message2:
        return message(body, entry);
      case blf::object::fd_message:
        return fd_message(body, entry);
      case blf::object::fd_message64:
        return fd_message64(body, entry);
      default:
        return error(body, type == blf::object::fd_error64, entry);
    }
  }

  [[nodiscard]] bool time_of(std::uint64_t ticks, std::uint32_t flags, Entry& entry) const noexcept {
    constexpr std::uint32_t ten_microseconds = 1;
    const std::uint64_t scale = flags == ten_microseconds ? 10'000 : 1;
    std::uint64_t ns = 0;
    std::int64_t sum = 0;
    if (__builtin_mul_overflow(ticks, scale, &ns) || __builtin_add_overflow(start_ns_, ns, &sum))
      return false;
    entry.time = base::Time{base::Duration{sum}};
    return true;
  }

  [[nodiscard]] bool message(std::string_view body, Entry& entry) {
    if (body.size() < 8) return refuse(Cause::length, "a message");
    const char* const at = body.data();
    const std::uint8_t flags = packet::load8(at + 2);
    return fill({.channel = load16(at),
                 .id = packet::load32(at + 4),
                 .direction = static_cast<std::uint8_t>(flags & 0xF),
                 .dlc = packet::load8(at + 3),
                 .remote = (flags & blf::remote_flag) != 0,
                 .data = body.substr(8, can::max_dlc)},
                entry);
  }

  [[nodiscard]] bool fd_message(std::string_view body, Entry& entry) {
    if (body.size() < 20) return refuse(Cause::length, "a message");
    const char* const at = body.data();
    const std::uint8_t flags = packet::load8(at + 2), fd = packet::load8(at + 13);
    return fill({.channel = load16(at),
                 .id = packet::load32(at + 4),
                 .direction = static_cast<std::uint8_t>(flags & 0xF),
                 .dlc = packet::load8(at + 3),
                 .flags = fd_flags((fd & 1) != 0, (fd & 2) != 0, (fd & 4) != 0),
                 .remote = (flags & blf::remote_flag) != 0,
                 .data = body.substr(20, packet::load8(at + 14))},
                entry);
  }

  [[nodiscard]] bool fd_message64(std::string_view body, Entry& entry) {
    if (body.size() < 40) return refuse(Cause::length, "a message");
    const char* const at = body.data();
    const std::uint32_t flags = packet::load32(at + 12);
    return fill({.channel = packet::load8(at),
                 .id = packet::load32(at + 4),
                 .direction = packet::load8(at + 34),
                 .dlc = packet::load8(at + 1),
                 .flags = fd_flags((flags & blf::fd_flag64) != 0, (flags & blf::switch_flag64) != 0,
                                   (flags & blf::state_flag64) != 0),
                 .remote = (flags & blf::remote_flag64) != 0,
                 .data = body.substr(40, packet::load8(at + 2))},
                entry);
  }

  [[nodiscard]] static std::uint8_t fd_flags(bool fd, bool bit_rate_switch, bool error_state) noexcept {
    if (!fd) return 0;
    return static_cast<std::uint8_t>(flag::fd | (bit_rate_switch ? flag::bit_rate_switch : 0) |
                                     (error_state ? flag::error_state : 0));
  }

  /// That there was an error, and where. What kind is said in codes of the recording hardware.
  [[nodiscard]] bool error(std::string_view body, bool channel_is_short, Entry& entry) {
    if (body.size() < 4) return refuse(Cause::length, "an error");
    const std::uint32_t channel = channel_is_short ? packet::load8(body.data()) : load16(body.data());
    if (channel > ChannelsRead::most) return refuse(Cause::unsupported, "channel " + std::to_string(channel));
    set_bus_error(entry);
    entry.interface = channels_.interface(channel, interfaces_);
    return true;
  }

  [[nodiscard]] bool fill(const blf::Message& from, Entry& entry) {
    if (from.channel > ChannelsRead::most)
      return refuse(Cause::unsupported, "channel " + std::to_string(from.channel));
    if (from.direction > 1) return false;  // a request to send; the frame itself comes later
    const bool extended = (from.id & blf::extended_flag) != 0;
    entry.id = from.id & ~blf::extended_flag;
    if (entry.id > (extended ? can::max_extended_id : can::max_base_id))
      return refuse(Cause::identifier, std::to_string(entry.id));
    entry.flags = from.flags;
    if (from.remote && entry.is_fd()) return refuse(Cause::syntax, "a remote frame of CAN FD");
    if (from.dlc > 15) return refuse(Cause::length, "length code " + std::to_string(from.dlc));
    entry.format = from.remote ? extended ? can::Format::extended_remote : can::Format::base_remote
                   : extended  ? can::Format::extended
                               : can::Format::base;
    entry.length = entry.is_fd() ? fd_length(from.dlc) : std::min(from.dlc, can::max_dlc);
    entry.raw_dlc = !entry.is_fd() && from.dlc > can::max_dlc ? from.dlc : std::uint8_t{0};
    const std::size_t count = from.remote ? 0 : entry.length;
    if (from.data.size() < count)
      return refuse(Cause::length,
                    std::to_string(from.data.size()) + " of " + std::to_string(count) + " bytes of data");
    std::memset(entry.data.data(), 0, can::max_dlc);
    std::memcpy(entry.data.data(), from.data.data(), count);
    entry.direction = from.direction == 0 ? Direction::received : Direction::sent;
    entry.interface = channels_.interface(from.channel, interfaces_);
    return true;
  }

  Inflate inflate_;
  State state_ = State::begin;
  std::int64_t start_ns_ = 0;
  ChannelsRead channels_;
  std::string stream_;  // what containers held and is not read yet, from begin_ on
  std::size_t begin_ = 0;
  Place place_;  // of the container that was unpacked last
  bool lost_ = false;
};

}  // namespace ocm::log
