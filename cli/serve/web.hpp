/// HTTP, WebSocket and TLS: libwebsockets, seen by web.cpp alone, in a thread of its own. It gives out the
/// built-in files by their exact names and nothing else, and connects viewers, whose Host, Origin and token
/// it checks first.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/transport/bus.hpp"

#include "cli/serve/viewers.hpp"

namespace ocm::cli::serve {

/// What viewers say. Called by the thread of Web only.
class Listener {
 public:
  Listener() = default;
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  virtual ~Listener() = default;
  /// `commands`: it has shown the token.
  virtual void opened(ViewerId viewer, bool commands) = 0;
  virtual void gone(ViewerId viewer) = 0;
  virtual void text(ViewerId viewer, std::string_view message) = 0;
  virtual void binary(ViewerId viewer, std::string_view message) = 0;
};

struct WebOptions {
  std::string address = "127.0.0.1";  ///< of IPv4 or IPv6
  std::uint16_t port = 0;             ///< 0: any that is free
  std::vector<std::string> names;     ///< that Host may have besides the address and localhost
  std::vector<std::string> origins;   ///< of other pages that may connect: "https://app.example.org"
  std::string token;                  ///< without it no command is taken; empty: none is
  bool token_to_view = false;         ///< looking needs it, too
  std::string certificate, key;       ///< PEM files; empty: no TLS
};

/// Whether it was built with libwebsockets; where not, a program needs nothing of what only serves.
#ifdef OCM_HAS_WEBSOCKETS
inline constexpr bool has_websockets = true;
#else
inline constexpr bool has_websockets = false;
#endif

/// Connections at a time; more are refused. [decided]
inline constexpr std::size_t most_viewers = 256;

class Web {
 public:
  /// Listens. All must outlive it. The failure says what is missing or wrong: no libwebsockets, a port that
  /// is taken, a certificate that cannot be read.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<Web>> open(const WebOptions& options,
                                                                     Viewers& viewers, Listener& listener);
  /// Sends what waits, to viewers that take it, and closes all connections; the thread has ended then.
  ~Web();
  Web(const Web&) = delete;
  Web& operator=(const Web&) = delete;

  /// "http://127.0.0.1:8484/"
  [[nodiscard]] std::string url() const;
  /// There is something for viewers; from any thread. Cheap where it is known already.
  void wake() noexcept;
  /// Connections and requests that were refused: Host, Origin, token, too many.
  [[nodiscard]] std::uint64_t refused() const noexcept;

 private:
  struct State;
  explicit Web(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Whether the page's parts are in this program: graphs are drawn by dygraphs, which may have been missing
/// where it was built.
[[nodiscard]] bool has_page() noexcept;

}  // namespace ocm::cli::serve
