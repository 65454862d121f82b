/// A pseudo terminal as a serial line to another program of this machine, which opens it like a device: by
/// its path, /dev/pts/7, or by a link that stays the same. Programs may come and go: what is written while
/// no program has it open is not taken, and a new one reads nothing of what its predecessor left. Host only.
///
///     auto line = Pty::open(central_line());
///     if (line->attached()) line->write("found 2\n");
///
/// Never waits. `descriptor` is for poll only while `attached`: without a program it is always ready. Not
/// thread-safe. The link and its lock, `LINK.lock`, go with their owner; what a killed one left is replaced.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <poll.h>
#include <span>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>
#include <utility>

#include "ocm/base/result.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/host/user_directory.hpp"

namespace ocm::transport {

/// Where a simulated or wired central has its line: beside the virtual bus, for this user alone.
[[nodiscard]] inline std::string central_line() {
  return host::user_directory() + "/central";
}
/// The folder of robots' own lines, by their names.
[[nodiscard]] inline std::string robot_lines() {
  return host::user_directory() + "/line";
}
/// What a robot's line is called there: as the robot, with `%2F` for what a file's name cannot have, a dot in
/// front, and the ending of lock files. No two robots have the same.
[[nodiscard]] inline std::string line_name(std::string_view robot) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string name;
  for (std::size_t i = 0; i < robot.size(); ++i) {
    const auto byte = static_cast<unsigned char>(robot[i]);
    const bool leads = robot[i] == '.' && (i == 0 || robot.substr(i) == ".lock");
    if (robot[i] != '/' && robot[i] != '%' && !leads)
      name += robot[i];
    else
      name.append({'%', digits[byte / 16], digits[byte % 16]});
  }
  return name;
}
/// The robot whose line is called so. What is no code stays as it is.
[[nodiscard]] inline std::string robot_of_line(std::string_view name) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string robot;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool coded =
        name[i] == '%' && i + 2 < name.size() && digit(name[i + 1]) >= 0 && digit(name[i + 2]) >= 0;
    robot += coded ? static_cast<char>(digit(name[i + 1]) * 16 + digit(name[i + 2])) : name[i];
    if (coded) i += 2;
  }
  return robot;
}
/// Makes the folder of this user in which both lie, and that of the lines; nothing when they can be trusted.
[[nodiscard]] inline std::optional<host::Failure> make_line_folders() {
  const std::string directory = host::user_directory();
  ::mkdir(directory.c_str(), 0700);  // whatever the answer, the check tells
  if (auto problem = host::check_private(directory)) return problem;
  ::mkdir(robot_lines().c_str(), 0700);
  return host::check_private(robot_lines());
}

/// Whether a Pty of some program has this link. One that a killed program has left may lead by now to a
/// terminal of another user: check before opening a link.
[[nodiscard]] inline bool is_served(const std::string& link) noexcept {
  const host::Descriptor lock{::open((link + ".lock").c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)};
  return lock && ::flock(lock.get(), LOCK_SH | LOCK_NB) < 0;
}

class Pty {
 public:
  Pty() = default;
  Pty(Pty&& other) noexcept
      : master_(std::move(other.master_)),
        lock_(std::move(other.lock_)),
        path_(std::move(other.path_)),
        link_(std::exchange(other.link_, {})),
        attached_(other.attached_) {}
  Pty& operator=(Pty&& other) noexcept {
    if (this != &other) {
      unlink();
      master_ = std::move(other.master_);
      lock_ = std::move(other.lock_);
      path_ = std::move(other.path_);
      link_ = std::exchange(other.link_, {});
      attached_ = other.attached_;
    }
    return *this;
  }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;
  ~Pty() { unlink(); }

  /// `link`: a path by which programs find it; none when empty. Refused when another program serves it, or
  /// when it is something else than a link.
  [[nodiscard]] static host::Outcome<Pty> open(const std::string& link = {}) {
    Pty pty;
    pty.master_ = host::Descriptor{::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
    char name[64] = {};
    if (!pty.master_ || ::grantpt(pty.master_.get()) < 0 || ::unlockpt(pty.master_.get()) < 0 ||
        ::ptsname_r(pty.master_.get(), name, sizeof name) != 0)
      return host::Failure{std::string("cannot make a pseudo terminal: ") + std::strerror(errno),
                           "is /dev/pts mounted, and are there any left? See /proc/sys/kernel/pty/max"};
    pty.path_ = name;
    pty.renew();
    if (link.empty()) return pty;
    if (auto problem = pty.make_link(link)) return std::move(*problem);
    return pty;
  }

  /// The device.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// The path that other programs open.
  [[nodiscard]] const std::string& name() const noexcept { return link_.empty() ? path_ : link_; }
  [[nodiscard]] int descriptor() const noexcept { return master_.get(); }

  /// Whether a program has it open, or has left something to be read. One system call. Between a program that
  /// goes and the next that comes this is to be asked once, or `read`, so that the next begins afresh.
  [[nodiscard]] bool attached() {
    const short events = look();
    if ((events & POLLHUP) == 0) return attached_ = true;
    if ((events & POLLIN) != 0) return true;
    leave();
    return false;
  }
  /// How many bytes have come, the first of `room`; 0: none now, or no program has it open.
  std::size_t read(std::span<char> room) {
    for (;;) {
      const ssize_t size = ::read(master_.get(), room.data(), room.size());
      if (size > 0) {
        attached_ = true;
        return static_cast<std::size_t>(size);
      }
      if (size < 0 && errno == EINTR) continue;
      if (size < 0 && errno == EIO) leave();
      return 0;
    }
  }
  /// How many bytes were taken, the first ones; fewer: the program does not read, or none has it open. Two
  /// system calls: the kernel itself takes also what is never read.
  std::size_t write(std::string_view text) {
    std::size_t taken = 0;
    if ((look() & POLLHUP) != 0) return taken;
    while (taken < text.size()) {
      const ssize_t size = ::write(master_.get(), text.data() + taken, text.size() - taken);
      if (size > 0) {
        taken += static_cast<std::size_t>(size);
        continue;
      }
      if (size < 0 && errno == EINTR) continue;
      break;
    }
    return taken;
  }

 private:
  [[nodiscard]] short look() const noexcept {
    pollfd line{master_.get(), POLLIN, 0};
    return ::poll(&line, 1, 0) < 0 ? short{0} : line.revents;
  }
  /// The program has gone.
  void leave() {
    if (attached_) renew();
    attached_ = false;
  }
  /// Bytes as they are, and none of before. Opened and closed once, the line tells whether any program has it
  /// open.
  void renew() const {
    const host::Descriptor line{::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
    termios settings{};
    if (!line || ::tcgetattr(line.get(), &settings) < 0) return;
    ::cfmakeraw(&settings);
    ::tcsetattr(line.get(), TCSANOW, &settings);
    ::tcflush(line.get(), TCIFLUSH);  // what another program may have said meanwhile is not of before
  }

  [[nodiscard]] std::optional<host::Failure> make_link(const std::string& link) {
    const std::string lock = link + ".lock";
    struct stat named {};
    for (struct stat locked{}; named.st_ino == 0 || named.st_ino != locked.st_ino;) {
      lock_ = host::Descriptor{::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600)};
      if (!lock_)
        return host::Failure{"cannot write '" + lock + "': " + std::strerror(errno),
                             "create its folder (mkdir -p), or choose another path"};
      // Another program may just be checking whether it is served.
      for (int tries = 0; ::flock(lock_.get(), LOCK_EX | LOCK_NB) < 0; ++tries) {
        if (tries == 5)
          return host::Failure{"another program serves '" + link + "'",
                               "end it (`fuser -v " + lock + "` names it), or choose another path"};
        ::usleep(1000);
      }
      // One that has just ended may have taken the lock's name away meanwhile.
      if (::fstat(lock_.get(), &locked) < 0 || ::stat(lock.c_str(), &named) < 0) named = {};
    }
    struct stat status {};
    const bool there = ::lstat(link.c_str(), &status) == 0;
    if (there && !S_ISLNK(status.st_mode)) {
      ::unlink(lock.c_str());
      return host::Failure{"'" + link + "' is there, and no link", "remove it, or choose another path"};
    }
    if (there) ::unlink(link.c_str());
    if (::symlink(path_.c_str(), link.c_str()) < 0) {
      const int error = errno;
      ::unlink(lock.c_str());
      return host::Failure{"cannot make the link '" + link + "': " + std::strerror(error),
                           "choose another path"};
    }
    link_ = link;
    return std::nullopt;
  }
  void unlink() noexcept {
    if (link_.empty()) return;
    ::unlink(link_.c_str());
    ::unlink((link_ + ".lock").c_str());
    link_.clear();
  }

  host::Descriptor master_;
  host::Descriptor lock_;
  std::string path_;
  std::string link_;
  bool attached_ = false;
};

}  // namespace ocm::transport
