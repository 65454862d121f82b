/// Foxglove's WebSocket protocol, version 1, as text and bytes: what a server says, and what a client asks.
/// Pure: it knows no socket. [github.com/foxglove/ws-protocol, docs/spec.md]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/result.hpp"

namespace ocm::cli::serve::foxglove {

/// What a client offers of the handshake's Sec-WebSocket-Protocol; the second is the same protocol under the
/// name that Foxglove's newer SDK has for it.
inline constexpr std::array<const char*, 2> subprotocols{"foxglove.websocket.v1", "foxglove.sdk.v1"};

/// The longest message of a client that is read; a schema that it advertises is in one. [decided]
inline constexpr std::size_t longest_message = 64 * 1024;
/// Of a client's topic, and of a request's id, which the server keeps or sends back. [decided]
inline constexpr std::size_t longest_name = 256;
/// Bytes of a status; the rest is cut off: what a client has sent does not come back whole, and what waits
/// for it is bounded. [decided]
inline constexpr std::size_t longest_status = 1000;

/// What a server has beyond channels that one subscribes to.
struct ServerInfo {
  std::string name;
  std::string session;          ///< another one makes a client forget what it has
  bool takes_commands = false;  ///< clients may publish, and write parameters
  bool has_parameters = false;  ///< and they may read them
};

struct Channel {
  std::uint32_t id = 0;
  std::string topic;  ///< "/gyroscope"
  std::string schema_name;
  std::string schema;  ///< JSON Schema
};

/// A number by name; none: not known.
struct Parameter {
  std::string name;
  std::optional<double> value;
};

enum class Level : std::uint8_t { info = 0, warning = 1, error = 2 };

[[nodiscard]] std::string server_info(const ServerInfo& info);
[[nodiscard]] std::string advertise(std::span<const Channel> channels);
/// One with the id of an earlier one takes its place; empty: it has none.
[[nodiscard]] std::string status(Level level, std::string_view message, std::string_view id = {});
/// `request` is that of what is answered; empty: nothing asked for it.
[[nodiscard]] std::string parameter_values(std::span<const Parameter> parameters, std::string_view request);

/// What precedes the payload of a message: 0x01, the subscription, the time in ns since 1970, little endian.
using MessageHead = std::array<std::uint8_t, 13>;
[[nodiscard]] MessageHead message_head(std::uint32_t subscription, std::uint64_t time_ns) noexcept;

struct Subscription {
  std::uint32_t id = 0;
  std::uint32_t channel = 0;
};

/// A channel on which the client publishes.
struct ClientChannel {
  std::uint32_t id = 0;
  std::string topic;
  std::string encoding;
};

/// A client's text message.
struct Request {
  enum class Op : std::uint8_t {
    subscribe,               ///< subscriptions
    unsubscribe,             ///< ids
    advertise,               ///< channels
    unadvertise,             ///< ids
    get_parameters,          ///< names, request
    set_parameters,          ///< parameters, request
    subscribe_parameters,    ///< names
    unsubscribe_parameters,  ///< names
  };
  Op op = Op::subscribe;
  std::vector<Subscription> subscriptions;
  std::vector<std::uint32_t> ids;
  std::vector<ClientChannel> channels;
  std::vector<Parameter> parameters;
  std::vector<std::string> names;
  std::string request;
};

/// The error says what is wrong with it. O(text), at most 32 levels of JSON deep.
[[nodiscard]] base::Result<Request, std::string> parse(std::string_view text);

/// A client's binary message: something published on one of its channels.
struct Published {
  std::uint32_t channel = 0;
  std::string_view payload;  ///< within the message
};
[[nodiscard]] base::Result<Published, std::string> parse_binary(std::string_view message);

}  // namespace ocm::cli::serve::foxglove
