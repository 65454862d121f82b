/// What the virtual bus's server and clients say to each other on their socket, and where that socket is.
/// docs/virtual-bus.md tells the whole; both sides are on one machine, so numbers are in its byte order. Host
/// only.
///
/// A message of the SOCK_SEQPACKET socket is 1 to 128 records of 32 bytes. The client opens with `hello`, the
/// server answers with its own or with `goodbye`. Hello and goodbye keep their layout in every version.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/un.h>

#include "ocm/base/text.hpp"
#include "ocm/base/time.hpp"
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
};

struct Hello {
  Type type = Type::hello;
  std::array<std::uint8_t, 3> unused{};
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
  }
  return "reason " + std::to_string(static_cast<unsigned>(goodbye.reason));
}

// --- where the socket is ---

[[nodiscard]] inline std::string default_path() {
  return host::user_directory() + "/sim.sock";
}

/// Paths are limited to 107 bytes by the kernel.
[[nodiscard]] inline host::Outcome<sockaddr_un> to_address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path || path.find('\0') != std::string::npos)
    return host::Failure{
        "'" + path + "' cannot be the path of a socket: it has " + std::to_string(path.size()) + " bytes",
        "use a path of 1 to " + std::to_string(sizeof address.sun_path - 1) + " bytes"};
  std::copy(path.begin(), path.end(), std::begin(address.sun_path));
  return address;
}

/// Who is at the other end of a connected socket: process and user as of connect or listen.
[[nodiscard]] inline std::optional<ucred> peer_of(int socket) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) < 0) return std::nullopt;
  return peer;
}

/// " (process 1234)", or nothing when it is not known.
[[nodiscard]] inline std::string process_text(const std::optional<ucred>& peer) {
  return peer && peer->pid > 0 ? " (process " + std::to_string(peer->pid) + ")" : "";
}

}  // namespace ocm::transport::virtual_bus
