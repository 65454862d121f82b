/// Sockets of programs on one machine: their addresses, and who is at the other end. Host only.
#pragma once

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>

#include "ocm/host/failure.hpp"

namespace ocm::host {

/// Paths are limited to 107 bytes by the kernel.
[[nodiscard]] inline Outcome<sockaddr_un> to_address(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path || path.find('\0') != std::string::npos)
    return Failure{
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
/// ", end it (kill 1234)", or nothing when it is not known.
[[nodiscard]] inline std::string end_text(const std::optional<ucred>& peer) {
  return peer && peer->pid > 0 ? ", end it (kill " + std::to_string(peer->pid) + ")" : "";
}

}  // namespace ocm::host
