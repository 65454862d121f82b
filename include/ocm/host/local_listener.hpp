/// The socket that something is served on to programs of the same user: in a directory that others cannot
/// reach, under a name that only one server has. Host only; waits for nothing but another server that starts
/// at the same moment.
#pragma once

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

#include "ocm/base/time.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/host/local_socket.hpp"
#include "ocm/host/user_directory.hpp"

namespace ocm::host {

/// What is served, in the words of messages.
struct LocalService {
  std::string_view what;    ///< "a virtual bus"
  std::string_view server;  ///< "a simulator"
  Cause running = Cause::other;
  bool any_path = true;  ///< another path would do
};

/// Listens while it lives, and removes its name at the end.
class LocalListener {
 public:
  /// Replaces the socket of a server that has died; refuses when one is running, or when others could reach
  /// the socket. A path in user_directory(): that is created. Waits at most `patience` for another server
  /// that starts just now.
  [[nodiscard]] static Outcome<LocalListener> open(std::string path, base::Duration patience,
                                                   const LocalService& service) {
    const std::size_t slash = path.rfind('/');
    const std::string directory = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
    if (directory == user_directory()) {
      ::mkdir(directory.c_str(), 0700);  // whatever the answer, the check below tells
      if (auto problem = check_private(directory)) return std::move(*problem);
    }
    const auto address = to_address(path);
    if (!address) return address.error;

    // Two servers that start together must not both find the socket stale: one at a time.
    const Descriptor lock{::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (!lock)
      return Failure{"cannot open the directory '" + directory + "': " + std::strerror(errno),
                     "create it (mkdir -p -m 700 '" + directory + "')" + otherwise(service, ", or ")};
    if (!lock_in_time(lock.get(), patience))
      return Failure{"another program holds the lock of the directory '" + directory + "'",
                     "end it (`fuser " + directory + "` names it)" + otherwise(service, ", or ")};
    if (auto problem = make_room(*address, path, service)) return std::move(*problem);

    LocalListener made;
    made.listener_ = Descriptor{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
    const int listener = made.listener_.get();
    struct stat status {};
    // The mode of the socket before it has a name is that of the name: at no moment is it open to others.
    if (listener < 0 || ::fchmod(listener, 0600) < 0 ||
        ::bind(listener, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) < 0 ||
        ::listen(listener, SOMAXCONN) < 0 || ::stat(path.c_str(), &status) < 0)
      return failure(path, errno, service);
    made.path_ = std::move(path);
    made.inode_ = status.st_ino;
    made.device_ = status.st_dev;
    return made;
  }

  LocalListener() = default;
  LocalListener(LocalListener&&) = default;
  LocalListener& operator=(LocalListener&& other) noexcept {
    if (this != &other) {
      remove();
      listener_ = std::move(other.listener_);
      path_ = std::move(other.path_);
      inode_ = other.inode_;
      device_ = other.device_;
    }
    return *this;
  }
  ~LocalListener() { remove(); }

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] int descriptor() const noexcept { return listener_.get(); }
  /// Whether its name leads to it: a file can be removed, with the directory of a user who logs out. One
  /// stat.
  [[nodiscard]] bool is_found() const noexcept {
    struct stat status {};
    return ::lstat(path_.c_str(), &status) == 0 && is_ours(status);
  }

  /// Why nothing can be served there, from an errno.
  [[nodiscard]] static Failure failure(const std::string& path, int error, const LocalService& service) {
    return {"cannot serve " + std::string(service.what) + " on '" + path + "': " + std::strerror(error),
            error == EMFILE || error == ENFILE
                ? "close other programs, or raise the limit: ulimit -n"
                : "is its directory yours and writable?" + otherwise(service, " or ")};
  }

 private:
  [[nodiscard]] static std::string otherwise(const LocalService& service, std::string_view joint) {
    return service.any_path ? std::string(joint) + "choose another path" : std::string{};
  }

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
  [[nodiscard]] static std::optional<Failure> make_room(const sockaddr_un& address, const std::string& path,
                                                        const LocalService& service) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) < 0) {
      if (errno == ENOENT) return std::nullopt;
      return failure(path, errno, service);
    }
    if (!S_ISSOCK(status.st_mode))
      return Failure{"'" + path + "' exists and is not a socket", "remove it" + otherwise(service, ", or ")};
    if (status.st_uid != ::geteuid())
      return Failure{
          "the socket '" + path + "' belongs to another user (uid " + std::to_string(status.st_uid) + ")",
          "ask for its removal" + otherwise(service, ", or ")};
    const Descriptor probe{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
    if (!probe) return failure(path, errno, service);
    if (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
        errno == EAGAIN) {
      const auto peer = peer_of(probe.get());
      return Failure{std::string(service.server) + " already runs on '" + path + "'" + process_text(peer),
                     "use it" + end_text(peer) + otherwise(service, ", or "), service.running,
                     peer ? peer->pid : 0};
    }
    if (errno == EPROTOTYPE)
      return Failure{"another program listens on '" + path + "'", "end it" + otherwise(service, ", or ")};
    if (errno != ECONNREFUSED || ::unlink(path.c_str()) < 0) return failure(path, errno, service);
    return std::nullopt;
  }

  [[nodiscard]] bool is_ours(const struct stat& status) const noexcept {
    return status.st_ino == inode_ && status.st_dev == device_;
  }
  /// Only what is still ours: another server may have the name by now.
  void remove() noexcept {
    struct stat status {};
    if (listener_ && ::lstat(path_.c_str(), &status) == 0 && is_ours(status)) ::unlink(path_.c_str());
    listener_.reset();
  }

  Descriptor listener_;
  std::string path_;
  ino_t inode_ = 0;
  dev_t device_ = 0;
};

}  // namespace ocm::host
