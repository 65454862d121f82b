/// What the virtual bus's server and clients say to each other on their socket, and where that socket is.
/// docs/virtual-bus.md tells the whole; both sides are on one machine, so numbers are in its byte order. Host
/// only.
///
/// A message of the SOCK_SEQPACKET socket is 1 to 128 records of 32 bytes. The client opens with `hello`, the
/// server answers with its own or with `goodbye`. Hello and goodbye keep their layout in every version.
///
/// CAN FD came later, within version 1: who knows it says so in its hello, where others say zero. A CAN FD
/// frame is a record `fd_frame` with up to 16 bytes of its data and as many records `fd_data` as the rest
/// needs. They follow each other, but for credit and overrun between them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "ocm/base/text.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/host/user_directory.hpp"

namespace ocm::transport::virtual_bus {

inline constexpr std::uint32_t version = 1;
inline constexpr std::uint32_t magic = 0x6D63'6F62;
inline constexpr std::size_t record_size = 32;
inline constexpr std::size_t max_records = 128;  ///< in one message
inline constexpr std::size_t max_message = record_size * max_records;
inline constexpr std::size_t max_filters = 512;

using Record = std::array<std::byte, record_size>;

enum class Type : std::uint8_t {
  hello = 1,  ///< both ways, first
  frame,      ///< client: send this; server: this was on the bus
  credit,     ///< server: so many frames left the transmit queue, which has room for them again
  overrun,    ///< server: so many frames were lost to you since the last overrun: you read too slowly
  filters,    ///< client: so many filters follow, and replace those of before once all are there
  filter,     ///< client
  goodbye,    ///< server: why you are disconnected; client: send what waits, I leave
  fd_frame,   ///< as frame, of CAN FD
  fd_data,    ///< the rest of its data, in order
};

/// Why the server disconnects a client.
enum class Reason : std::uint8_t {
  leaving,         ///< said by a client
  ended,           ///< the server was ended
  full,            ///< no file descriptors left
  other_user,      ///< detail: the client's user id
  bad_version,     ///< detail: the client's version
  no_hello,        ///< detail: the type of record that came instead
  bad_size,        ///< detail: bytes of the message
  unknown_record,  ///< detail: its type
  bad_format,      ///< of a frame; detail: format
  bad_dlc,         ///< detail: DLC
  bad_identifier,  ///< detail: identifier
  no_credit,       ///< more frames than the transmit queue has room for
  bad_filters,     ///< detail: how many; too many, or filters that were not announced
  bad_fd_length,   ///< of a CAN FD frame; detail: length
  bad_fd_flags,    ///< detail: flags
  torn_fd_frame,   ///< detail: the type of record that came instead of the rest of a CAN FD frame
};

struct Hello {
  Type type = Type::hello;
  /// 0: it does not know CAN FD. From a client 1; from a server how many times faster than the others the
  /// bits of the data are.
  std::uint8_t fd = 0;
  std::array<std::uint8_t, 2> unused{};
  std::uint32_t magic = virtual_bus::magic;
  std::uint32_t version = virtual_bus::version;
  std::uint32_t bit_rate = 0;   ///< of the bus, bit/s; 0 from a client
  std::uint32_t credit = 0;     ///< frames that the client's transmit queue takes; 0 from a client
  std::array<char, 12> name{};  ///< of the bus, filled up with zeros
};

struct FrameRecord {
  Type type = Type::frame;
  std::uint8_t format = 0;  ///< can::Format
  std::uint8_t dlc = 0;
  std::uint8_t unused = 0;
  std::uint32_t id = 0;
  std::int64_t time_ns = 0;  ///< Unix time of the end of the frame; 0 from a client
  std::array<std::uint8_t, 8> data{};
  std::array<std::uint8_t, 8> unused_too{};
};

struct FdFrameRecord {
  static constexpr std::size_t room = 16;
  Type type = Type::fd_frame;
  std::uint8_t format = 0;  ///< can::Format, base or extended
  std::uint8_t length = 0;
  std::uint8_t flags = 0;  ///< can::frame_flag
  std::uint32_t id = 0;
  std::int64_t time_ns = 0;  ///< as of a FrameRecord
  std::array<std::uint8_t, room> data{};
};

struct FdDataRecord {
  static constexpr std::size_t room = 24;
  Type type = Type::fd_data;
  std::array<std::uint8_t, 7> unused{};
  std::array<std::uint8_t, room> data{};
};

/// credit, overrun, filters
struct Count {
  Type type{};
  std::array<std::uint8_t, 7> unused{};
  std::uint64_t count = 0;
  std::array<std::uint8_t, 16> unused_too{};
};

struct FilterRecord {
  Type type = Type::filter;
  std::array<std::uint8_t, 3> unused{};
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  std::array<std::uint8_t, 20> unused_too{};
};

struct Goodbye {
  Type type = Type::goodbye;
  Reason reason = Reason::leaving;
  std::array<std::uint8_t, 2> unused{};
  std::uint32_t version = virtual_bus::version;  ///< of who says it
  std::uint64_t detail = 0;
  std::array<std::uint8_t, 16> unused_too{};
  friend constexpr bool operator==(const Goodbye&, const Goodbye&) = default;
};

template <class T>
[[nodiscard]] constexpr Record to_record(const T& content) noexcept {
  return std::bit_cast<Record>(content);
}
template <class T>
[[nodiscard]] constexpr T from_record(const Record& record) noexcept {
  return std::bit_cast<T>(record);
}
[[nodiscard]] constexpr Type type_of(const Record& record) noexcept {
  return static_cast<Type>(record[0]);
}

[[nodiscard]] constexpr Record to_record(const can::Frame& frame, base::Time time = {}) noexcept {
  return to_record(FrameRecord{.format = static_cast<std::uint8_t>(frame.format),
                               .dlc = frame.dlc,
                               .id = frame.id,
                               .time_ns = time.time_since_epoch().count(),
                               .data = frame.data});
}

/// The frame, or what is wrong with it. What lies behind its data is zero, whatever the record says.
[[nodiscard]] constexpr base::Result<can::Frame, Goodbye> decode(const FrameRecord& record) noexcept {
  const auto refuse = [](Reason reason, std::uint64_t detail) {
    return Goodbye{.reason = reason, .detail = detail};
  };
  if (record.format > static_cast<std::uint8_t>(can::Format::error))
    return refuse(Reason::bad_format, record.format);
  can::Frame frame{.id = record.id, .dlc = record.dlc, .format = static_cast<can::Format>(record.format)};
  if (frame.dlc > can::max_dlc) return refuse(Reason::bad_dlc, frame.dlc);
  if (!can::validate(frame)) return refuse(Reason::bad_identifier, frame.id);
  const std::size_t size = frame.bytes().size();
  std::copy_n(record.data.begin(), size, frame.data.begin());
  return frame;
}

inline constexpr std::size_t max_fd_records = 3;

/// A CAN FD frame as records.
struct FdRecords {
  std::array<Record, max_fd_records> records{};
  std::size_t count = 0;
  [[nodiscard]] std::span<const Record> all() const noexcept { return std::span{records}.first(count); }
};

[[nodiscard]] constexpr FdRecords to_fd_records(const can::AnyFrame& frame, base::Time time = {}) noexcept {
  FdFrameRecord first{.format = static_cast<std::uint8_t>(frame.format),
                      .length = frame.length,
                      .flags = frame.flags,
                      .id = frame.id,
                      .time_ns = time.time_since_epoch().count()};
  std::copy_n(frame.data.begin(), first.room, first.data.begin());
  FdRecords out;
  out.records[out.count++] = to_record(first);
  for (std::size_t at = first.room; at < frame.length; at += FdDataRecord::room) {
    FdDataRecord more;
    std::copy_n(frame.data.begin() + static_cast<std::ptrdiff_t>(at), more.room, more.data.begin());
    out.records[out.count++] = to_record(more);
  }
  return out;
}

/// Puts CAN FD frames together from their records.
class FdAssembly {
 public:
  /// Whether the rest of a frame is still to come.
  [[nodiscard]] constexpr bool waits() const noexcept { return missing_ != 0; }
  /// Takes `fd_frame`, or `fd_data` where one is waited for. true: the frame is whole.
  [[nodiscard]] constexpr base::Result<bool, Goodbye> take(const Record& record) noexcept {
    const auto refuse = [](Reason reason, std::uint64_t detail) {
      return Goodbye{.reason = reason, .detail = detail};
    };
    if (type_of(record) == Type::fd_data && waits()) {
      const auto more = from_record<FdDataRecord>(record);
      const std::size_t size = std::min(missing_, more.room);
      std::copy_n(more.data.begin(), size,
                  frame_.data.begin() + static_cast<std::ptrdiff_t>(frame_.length - missing_));
      missing_ -= size;
      return !waits();
    }
    if (type_of(record) != Type::fd_frame || waits())
      return refuse(Reason::torn_fd_frame, static_cast<std::uint64_t>(type_of(record)));
    const auto first = from_record<FdFrameRecord>(record);
    if (first.format > static_cast<std::uint8_t>(can::Format::extended))
      return refuse(Reason::bad_format, first.format);
    if (!can::is_fd_length(first.length)) return refuse(Reason::bad_fd_length, first.length);
    frame_ = {};
    frame_.id = first.id;
    frame_.format = static_cast<can::Format>(first.format);
    frame_.length = first.length;
    frame_.flags = first.flags;
    if ((first.flags & can::frame_flag::fd) == 0 || (first.flags & ~can::frame_flag::all) != 0)
      return refuse(Reason::bad_fd_flags, first.flags);
    if (!can::validate(frame_)) return refuse(Reason::bad_identifier, first.id);
    time_ = base::Time{base::Duration{first.time_ns}};
    const std::size_t size = std::min<std::size_t>(first.length, first.room);
    std::copy_n(first.data.begin(), size, frame_.data.begin());
    missing_ = first.length - size;
    return !waits();
  }
  /// The last one, if it is whole.
  [[nodiscard]] constexpr const can::AnyFrame& frame() const noexcept { return frame_; }
  [[nodiscard]] constexpr base::Time time() const noexcept { return time_; }

 private:
  can::AnyFrame frame_;
  base::Time time_{};
  std::size_t missing_ = 0;  ///< bytes
};

/// What a disconnected client did, or what happened to it: "it sent a frame with DLC 200".
[[nodiscard]] inline std::string describe(const Goodbye& goodbye) {
  const std::string detail = std::to_string(goodbye.detail);
  switch (goodbye.reason) {
    case Reason::leaving:
      return "it left";
    case Reason::ended:
      return "the simulator was ended";
    case Reason::full:
      return "the simulator has no file descriptor left for it";
    case Reason::other_user:
      return "it belongs to another user (uid " + detail + ")";
    case Reason::bad_version:
      return "it speaks another version (" + detail + ") of the virtual bus's protocol";
    case Reason::no_hello:
      return "it began with a record of type " + detail + " and not with a greeting";
    case Reason::bad_size:
      return "it sent a message of " + detail + " bytes; records have 32, and at most 128 go together";
    case Reason::unknown_record:
      return "it sent a record of unknown type " + detail;
    case Reason::bad_format:
      return "it sent a frame of format " + detail + ", which is none for the wire";
    case Reason::bad_dlc:
      return "it sent a frame with DLC " + detail + "; at most 8";
    case Reason::bad_identifier: {
      base::Text<16> id;
      id.hex(static_cast<std::uint32_t>(goodbye.detail), 8);
      return "it sent a frame with identifier 0x" + std::string(id.view()) + ", too wide for its format";
    }
    case Reason::no_credit:
      return "it sent more frames than its transmit queue has room for";
    case Reason::bad_filters:
      return "it sent filters that it had not announced, or more than 512 (" + detail + ")";
    case Reason::bad_fd_length:
      return "it sent a CAN FD frame of " + detail + " bytes, a length that such frames do not have";
    case Reason::bad_fd_flags:
      return "it sent a CAN FD frame with flags " + detail;
    case Reason::torn_fd_frame:
      return "it sent a part of a CAN FD frame alone (a record of type " + detail + ")";
  }
  return "reason " + std::to_string(static_cast<unsigned>(goodbye.reason));
}

// --- where the socket is ---

[[nodiscard]] inline std::string default_path() {
  return host::user_directory() + "/sim.sock";
}

}  // namespace ocm::transport::virtual_bus
