/// The kernel and the time as a test plays them: a full queue, an interface that is pulled out and an hour of
/// silence come when the test says so, and take no time.
///
///     test::PlayedKernel kernel;
///     kernel.files = {file};                       // whose calls are played; all others go to the real
///     kernel kernel.send = [](int, const void*, std::size_t, int) { return test::failed(ENOBUFS); };
///     kernel.later(20ms, [&] { arrived = true; }); // while the program waits
///
/// This header defines the system calls themselves, which a program can do once. So one source of
/// unit_transport does, socketcan_send.cpp (tests/CMakeLists.txt), and the others have the macro
/// OCM_KERNEL_PLAYED_ELSEWHERE; a source that is a program of its own, as in scripts/mutate, defines them,
/// too. They are strong symbols: weak ones would lose against those of the address sanitizer. Not for tests
/// with threads.
#pragma once

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdarg>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <functional>
#include <map>
#include <poll.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"

namespace ocm::test {

/// What a system call returns that fails.
inline int failed(int error) {
  errno = error;
  return -1;
}

class PlayedKernel {
 public:
  PlayedKernel() { current() = this; }
  ~PlayedKernel() { current() = nullptr; }
  PlayedKernel(const PlayedKernel&) = delete;
  PlayedKernel& operator=(const PlayedKernel&) = delete;
  /// The one that answers now; none: the real kernel does.
  static PlayedKernel*& current() {
    static PlayedKernel* one = nullptr;
    return one;
  }

  /// The call, where it is played for this file.
  template <class Call>
  static const Call* played(int file, Call PlayedKernel::*call) {
    const PlayedKernel* const kernel = current();
    if (kernel == nullptr || !(kernel->*call)) return nullptr;
    if (std::find(kernel->files.begin(), kernel->files.end(), file) == kernel->files.end()) return nullptr;
    return &(kernel->*call);
  }
  /// The call, where it is played, of no file yet.
  template <class Call>
  static const Call* played(Call PlayedKernel::*call) {
    const PlayedKernel* const kernel = current();
    return kernel != nullptr && kernel->*call ? &(kernel->*call) : nullptr;
  }
  /// The kernel, where the wait for this file is played.
  static PlayedKernel* waiting(pollfd* entries, nfds_t count) {
    if (current() == nullptr || played(entries->fd, &PlayedKernel::ready) == nullptr) return nullptr;
    if (count != 1) std::abort();  // a transport has one file
    return current();
  }

  std::vector<int> files;
  std::function<int(int family, int type, int protocol)> socket;
  std::function<int(int file, const sockaddr* address)> connect;
  std::function<int(const char* path)> open;
  std::function<int(const char* path)> openat;  ///< what the C++ library opens folders with
  std::function<int()> posix_openpt;
  std::function<int(int file, int what)> flock;
  std::function<void(useconds_t time)> usleep;
  std::function<int()> symlink;

  std::function<int(int file, struct stat* status)> fstat;
  std::function<int(int file, const sockaddr* address)> bind;
  std::function<int(int file, int level, int name, const void* value, socklen_t size)> setsockopt;
  std::function<int(int file, int level, int name, void* value, socklen_t* size)> getsockopt;
  std::function<int(int file, unsigned long request, void* argument)> ioctl;
  std::function<ssize_t(int file, const void* bytes, std::size_t size, int flags)> send;
  std::function<ssize_t(int file, void* bytes, std::size_t size)> recv;
  std::function<int(int file, mmsghdr* messages, unsigned count)> recvmmsg;
  std::function<ssize_t(int file, void* bytes, std::size_t size)> read;
  std::function<ssize_t(int file, const void* bytes, std::size_t size)> write;
  std::function<int(int file, termios* settings)> tcgetattr;
  std::function<int(int file, const termios* settings)> tcsetattr;
  std::function<int(int file, int queue)> tcflush;

  // --- time, which passes while the program waits, and at no other time ---

  /// Plays time and waiting; what poll says of a played file when it is asked for these events.
  std::function<short(short events)> ready;
  base::Time steady{std::chrono::hours{1}};
  base::Time unix_time{std::chrono::hours{400'000}};  // before 2038

  struct Wait {
    short events = 0;
    base::Duration limit{};
    friend bool operator==(const Wait&, const Wait&) = default;
  };
  std::vector<Wait> waits;  ///< all that the program asked for

  /// Does this once so much time has passed.
  void later(base::Duration after, std::function<void()> what) {
    events_.emplace(steady + after, std::move(what));
  }
  /// The wait in which this happens ends with EINTR.
  void interrupt() { interrupted_ = true; }

  void pass(base::Duration time) {
    steady += time;
    unix_time += time;
  }
  int wait(pollfd* entry, base::Duration limit) {
    if (waits.size() == 100'000) std::abort();  // it would wait for ever
    waits.push_back({entry->events, limit});
    const base::Time end = steady + limit;
    for (;;) {
      while (!events_.empty() && events_.begin()->first <= steady) {
        const auto what = std::move(events_.begin()->second);
        events_.erase(events_.begin());
        what();
      }
      if (std::exchange(interrupted_, false)) return failed(EINTR);
      entry->revents = ready(entry->events);
      if (entry->revents != 0) return 1;
      if (events_.empty() || events_.begin()->first > end) {
        pass(end - steady);
        return 0;
      }
      pass(events_.begin()->first - steady);
    }
  }

 private:
  std::multimap<base::Time, std::function<void()>> events_;
  bool interrupted_ = false;
};

}  // namespace ocm::test

#ifndef OCM_KERNEL_PLAYED_ELSEWHERE

// What is not played is asked of the kernel directly: a program that is linked statically has no other way.
extern "C" {

int socket(int family, int type, int protocol) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(&ocm::test::PlayedKernel::socket))
    return (*call)(family, type, protocol);
  return static_cast<int>(::syscall(SYS_socket, family, type, protocol));
}

int connect(int file, const sockaddr* address, socklen_t size) {
  if (const auto* const call = ocm::test::PlayedKernel::played(&ocm::test::PlayedKernel::connect))
    return (*call)(file, address);
  return static_cast<int>(::syscall(SYS_connect, file, address, size));
}

int bind(int file, const sockaddr* address, socklen_t size) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::bind))
    return (*call)(file, address);
  return static_cast<int>(::syscall(SYS_bind, file, address, size));
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const unsigned mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, unsigned) : 0;
  va_end(rest);
  if (const auto* const call = ocm::test::PlayedKernel::played(&ocm::test::PlayedKernel::open))
    return (*call)(path);
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

int openat(int folder, const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const unsigned mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, unsigned) : 0;
  va_end(rest);
  if (const auto* const call = ocm::test::PlayedKernel::played(&ocm::test::PlayedKernel::openat))
    return (*call)(path);
  return static_cast<int>(::syscall(SYS_openat, folder, path, flags, mode));
}

int posix_openpt(int flags) {
  if (const auto* const call = ocm::test::PlayedKernel::played(&ocm::test::PlayedKernel::posix_openpt))
    return (*call)();
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, "/dev/ptmx", flags, 0));
}

int flock(int file, int what) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(&ocm::test::PlayedKernel::flock))
    return (*call)(file, what);
  return static_cast<int>(::syscall(SYS_flock, file, what));
}

int symlink(const char* target, const char* link) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(&ocm::test::PlayedKernel::symlink))
    return (*call)();
  return static_cast<int>(::syscall(SYS_symlinkat, target, AT_FDCWD, link));
}

int usleep(useconds_t time) {
  if (const auto* const call = ocm::test::PlayedKernel::played(&ocm::test::PlayedKernel::usleep)) {
    (*call)(time);
    return 0;
  }
  const timespec spec{static_cast<time_t>(time / 1'000'000), static_cast<long>(time % 1'000'000 * 1000)};
  return ::nanosleep(&spec, nullptr);
}

int fstat(int file, struct stat* status) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::fstat))
    return (*call)(file, status);
#ifdef SYS_fstat64
  return static_cast<int>(::syscall(SYS_fstat64, file, status));
#else
  return static_cast<int>(::syscall(SYS_fstat, file, status));
#endif
}

int setsockopt(int file, int level, int name, const void* value, socklen_t size) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::setsockopt))
    return (*call)(file, level, name, value, size);
  return static_cast<int>(::syscall(SYS_setsockopt, file, level, name, value, size));
}

int getsockopt(int file, int level, int name, void* value, socklen_t* size) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::getsockopt))
    return (*call)(file, level, name, value, size);
  return static_cast<int>(::syscall(SYS_getsockopt, file, level, name, value, size));
}

int ioctl(int file, unsigned long request, ...) noexcept {
  va_list rest;
  va_start(rest, request);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::ioctl))
    return (*call)(file, request, argument);
  return static_cast<int>(::syscall(SYS_ioctl, file, request, argument));
}

ssize_t send(int file, const void* bytes, std::size_t size, int flags) {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::send))
    return (*call)(file, bytes, size, flags);
  return ::syscall(SYS_sendto, file, bytes, size, flags, nullptr, 0);
}

ssize_t recv(int file, void* bytes, std::size_t size, int flags) {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::recv))
    return (*call)(file, bytes, size);
  return ::syscall(SYS_recvfrom, file, bytes, size, flags, nullptr, nullptr);
}

int recvmmsg(int file, mmsghdr* messages, unsigned count, int flags, timespec* timeout) {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::recvmmsg))
    return (*call)(file, messages, count);
  return static_cast<int>(::syscall(SYS_recvmmsg, file, messages, count, flags, timeout));
}

ssize_t read(int file, void* bytes, std::size_t size) {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::read))
    return (*call)(file, bytes, size);
  return ::syscall(SYS_read, file, bytes, size);
}

ssize_t write(int file, const void* bytes, std::size_t size) {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::write))
    return (*call)(file, bytes, size);
  return ::syscall(SYS_write, file, bytes, size);
}

int poll(pollfd* entries, nfds_t count, int timeout_ms) {
  if (ocm::test::PlayedKernel* const kernel = ocm::test::PlayedKernel::waiting(entries, count))
    return kernel->wait(entries, std::chrono::milliseconds{timeout_ms});
  const timespec limit{timeout_ms / 1000, timeout_ms % 1000 * 1'000'000L};
  timespec left = limit;  // the kernel writes what is left
  return static_cast<int>(
      ::syscall(SYS_ppoll, entries, count, timeout_ms < 0 ? nullptr : &left, nullptr, _NSIG / 8));
}

int ppoll(pollfd* entries, nfds_t count, const timespec* limit, const sigset_t* mask) {
  if (ocm::test::PlayedKernel* const kernel = ocm::test::PlayedKernel::waiting(entries, count))
    return kernel->wait(entries,
                        std::chrono::seconds{limit->tv_sec} + std::chrono::nanoseconds{limit->tv_nsec});
  timespec left{};
  if (limit != nullptr) left = *limit;
  return static_cast<int>(
      ::syscall(SYS_ppoll, entries, count, limit == nullptr ? nullptr : &left, mask, _NSIG / 8));
}

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  if (ocm::test::PlayedKernel::played(&ocm::test::PlayedKernel::ready) == nullptr)
    return static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
  const auto* const kernel = ocm::test::PlayedKernel::current();
  const auto ns = (clock == CLOCK_REALTIME ? kernel->unix_time : kernel->steady).time_since_epoch().count();
  time->tv_sec = static_cast<time_t>(ns / 1'000'000'000);
  time->tv_nsec = static_cast<long>(ns % 1'000'000'000);
  return 0;
}

namespace ocm::test {
/// As the kernel has them; the C library's have more places for characters, and the speeds.
struct KernelSettings {
  tcflag_t iflag = 0;
  tcflag_t oflag = 0;
  tcflag_t cflag = 0;
  tcflag_t lflag = 0;
  cc_t line = 0;
  cc_t characters[19] = {};
};
}  // namespace ocm::test

int tcgetattr(int file, termios* settings) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::tcgetattr))
    return (*call)(file, settings);
  ocm::test::KernelSettings own;
  if (::syscall(SYS_ioctl, file, TCGETS, &own) < 0) return -1;
  *settings = {};
  settings->c_iflag = own.iflag;
  settings->c_oflag = own.oflag;
  settings->c_cflag = own.cflag;
  settings->c_lflag = own.lflag;
  settings->c_line = own.line;
  std::copy(std::begin(own.characters), std::end(own.characters), std::begin(settings->c_cc));
  settings->c_ispeed = settings->c_ospeed = own.cflag & CBAUD;
  return 0;
}

int tcsetattr(int file, int when, const termios* settings) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::tcsetattr))
    return (*call)(file, settings);
  ocm::test::KernelSettings own{settings->c_iflag, settings->c_oflag, settings->c_cflag,
                                settings->c_lflag, settings->c_line,  {}};
  std::copy_n(std::begin(settings->c_cc), std::size(own.characters), std::begin(own.characters));
  return static_cast<int>(
      ::syscall(SYS_ioctl, file, TCSETS + static_cast<unsigned long>(when - TCSANOW), &own));
}

int tcflush(int file, int queue) noexcept {
  if (const auto* const call = ocm::test::PlayedKernel::played(file, &ocm::test::PlayedKernel::tcflush))
    return (*call)(file, queue);
  return static_cast<int>(::syscall(SYS_ioctl, file, TCFLSH, queue));
}

}  // extern "C"

#endif
