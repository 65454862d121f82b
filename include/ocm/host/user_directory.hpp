/// Where programs of one user meet: a directory that belongs to this user alone, for sockets and links. Host
/// only.
#pragma once

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

#include "ocm/host/failure.hpp"

namespace ocm::host {

/// A directory of this user alone, below the first of these: $XDG_RUNTIME_DIR, when it is absolute and ours,
/// as its specification requires; else /tmp. It may not exist yet.
[[nodiscard]] inline std::string user_directory() {
  const char* const runtime = std::getenv("XDG_RUNTIME_DIR");
  struct stat status {};
  if (runtime != nullptr && runtime[0] == '/' && ::stat(runtime, &status) == 0 && S_ISDIR(status.st_mode) &&
      status.st_uid == ::geteuid())
    return std::string(runtime) + "/ocm";
  return "/tmp/ocm-" + std::to_string(::geteuid());
}

/// Why a directory cannot be trusted, or does not exist; nothing when it is fine: ours, no link, closed to
/// every other user.
[[nodiscard]] inline std::optional<Failure> check_private(const std::string& directory) {
  struct stat status {};
  if (::lstat(directory.c_str(), &status) < 0)
    return Failure{
        "cannot use the directory '" + directory + "': " + std::strerror(errno),
        "create it (mkdir -m 700 " + directory + "), or set XDG_RUNTIME_DIR to a directory of yours"};
  if (!S_ISDIR(status.st_mode))
    return Failure{"'" + directory + "' is not a directory",
                   "remove it, or set XDG_RUNTIME_DIR to a directory of yours"};
  if (status.st_uid != ::geteuid())
    return Failure{"the directory '" + directory + "' belongs to another user (uid " +
                       std::to_string(status.st_uid) + ")",
                   "ask for its removal, or set XDG_RUNTIME_DIR to a directory of yours"};
  if ((status.st_mode & 077) != 0)
    return Failure{"the directory '" + directory + "' is open to other users", "chmod 700 " + directory};
  return std::nullopt;
}

}  // namespace ocm::host
