/// The socket that a virtual bus is served on: in a directory that others cannot reach, under a name that
/// only one server has. Host only; waits for nothing but another server that starts at the same moment.
#pragma once

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <string>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

#include "ocm/base/time.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/host/user_directory.hpp"
#include "ocm/transport/virtual_bus_protocol.hpp"

namespace ocm::simulation {

namespace virtual_bus = transport::virtual_bus;

/// Listens while it lives, and removes its name at the end.
class VirtualBusSocket {
 public:
  /// Replaces the socket of a server that has died; refuses when one is running, or when others could reach
  /// the socket. An empty path: virtual_bus::default_path(), whose directory is created. Waits at most
  /// `patience` for another server that starts just now.
  [[nodiscard]] static host::Outcome<VirtualBusSocket> open(std::string path, base::Duration patience) {
    std::string directory;
    if (path.empty()) {
      directory = host::user_directory();
      path = virtual_bus::default_path();
      ::mkdir(directory.c_str(), 0700);  // whatever the answer, the check below tells
      if (auto problem = host::check_private(directory)) return std::move(*problem);
    } else {
      const std::size_t slash = path.rfind('/');
      directory = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
    }
    const auto address = virtual_bus::to_address(path);
    if (!address) return address.error;

    // Two servers that start together must not both find the socket stale: one at a time.
    const host::Descriptor lock{::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (!lock)
      return host::Failure{"cannot open the directory '" + directory + "': " + std::strerror(errno),
                           "create it (mkdir -p -m 700 '" + directory + "'), or choose another path"};
    if (!lock_in_time(lock.get(), patience))
      return host::Failure{"another program holds the lock of the directory '" + directory + "'",
                           "end it (`fuser " + directory + "` names it), or choose another path"};
    if (auto problem = make_room(*address, path)) return std::move(*problem);

    VirtualBusSocket made;
    made.listener_ = host::Descriptor{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
    const int listener = made.listener_.get();
    struct stat status {};
    // The mode of the socket before it has a name is that of the name: at no moment is it open to others.
    if (listener < 0 || ::fchmod(listener, 0600) < 0 ||
        ::bind(listener, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) < 0 ||
        ::listen(listener, SOMAXCONN) < 0 || ::stat(path.c_str(), &status) < 0)
      return failure(path, errno);
    made.path_ = std::move(path);
    made.inode_ = status.st_ino;
    made.device_ = status.st_dev;
    return made;
  }

  VirtualBusSocket() = default;
  VirtualBusSocket(VirtualBusSocket&&) = default;
  VirtualBusSocket& operator=(VirtualBusSocket&& other) noexcept {
    if (this != &other) {
      remove();
      listener_ = std::move(other.listener_);
      path_ = std::move(other.path_);
      inode_ = other.inode_;
      device_ = other.device_;
    }
    return *this;
  }
  ~VirtualBusSocket() { remove(); }

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] int descriptor() const noexcept { return listener_.get(); }

  /// Why a bus cannot be served there, from an errno.
  [[nodiscard]] static host::Failure failure(const std::string& path, int error) {
    return {"cannot serve a virtual bus on '" + path + "': " + std::strerror(error),
            error == EMFILE || error == ENFILE
                ? "close other programs, or raise the limit: ulimit -n"
                : "is its directory yours and writable? or choose another path"};
  }

 private:
  [[nodiscard]] static bool lock_in_time(int directory, base::Duration patience) noexcept {
    constexpr base::Duration pause = std::chrono::milliseconds{10};
    for (;; patience -= pause) {
      if (::flock(directory, LOCK_EX | LOCK_NB) == 0) return true;
      if (errno != EWOULDBLOCK && errno != EINTR) return true;  // a file system without locks
      if (patience <= base::Duration::zero()) return false;
      ::usleep(static_cast<useconds_t>(pause.count() / 1000));
    }
  }

  /// Removes the socket of a dead server; says why when something else is there.
  [[nodiscard]] static std::optional<host::Failure> make_room(const sockaddr_un& address,
                                                              const std::string& path) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) < 0) {
      if (errno == ENOENT) return std::nullopt;
      return failure(path, errno);
    }
    if (!S_ISSOCK(status.st_mode))
      return host::Failure{"'" + path + "' exists and is not a socket", "remove it, or choose another path"};
    if (status.st_uid != ::geteuid())
      return host::Failure{
          "the socket '" + path + "' belongs to another user (uid " + std::to_string(status.st_uid) + ")",
          "choose another path"};
    const host::Descriptor probe{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
    if (!probe) return failure(path, errno);
    if (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
        errno == EAGAIN) {
      const auto peer = virtual_bus::peer_of(probe.get());
      const std::int64_t process = peer ? peer->pid : 0;
      const std::string end = process > 0 ? ", end it (kill " + std::to_string(process) + ")" : "";
      return host::Failure{"a simulator already runs on '" + path + "'" + virtual_bus::process_text(peer),
                           "use it" + end + ", or choose another path", host::Cause::simulator_running,
                           process};
    }
    if (errno == EPROTOTYPE)
      return host::Failure{"another program listens on '" + path + "'", "end it, or choose another path"};
    if (errno != ECONNREFUSED || ::unlink(path.c_str()) < 0) return failure(path, errno);
    return std::nullopt;
  }

  /// Only what is still ours: another server may have the name by now.
  void remove() noexcept {
    struct stat status {};
    if (listener_ && ::lstat(path_.c_str(), &status) == 0 && status.st_ino == inode_ &&
        status.st_dev == device_)
      ::unlink(path_.c_str());
    listener_.reset();
  }

  host::Descriptor listener_;
  std::string path_;
  ino_t inode_ = 0;
  dev_t device_ = 0;
};

}  // namespace ocm::simulation
