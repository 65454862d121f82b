/// A serial device (/dev/ttyACM0, a pty) taken for this program alone and set to bytes as they are: no echo,
/// no line editing, no flow control but RTS and CTS where that is asked for. When its owner goes it gets its
/// settings back. Host only.
///
///     auto port = SerialPort::open("/dev/ttyUSB0", 38'400);
///     if (!port) { /* port.error.what, port.error.remedy */ }
///     const auto size = port->read(buffer);     // 0: nothing has come
///
/// Never waits: `descriptor` is for poll. One system call a read or write. Not thread-safe.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <linux/tty.h>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <system_error>
#include <termios.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/host/failure.hpp"

namespace ocm::transport {

namespace detail {

inline constexpr std::array<std::pair<std::uint32_t, speed_t>, 18> serial_speeds{{{9600, B9600},
                                                                                  {19200, B19200},
                                                                                  {38400, B38400},
                                                                                  {57600, B57600},
                                                                                  {115200, B115200},
                                                                                  {230400, B230400},
                                                                                  {460800, B460800},
                                                                                  {500000, B500000},
                                                                                  {576000, B576000},
                                                                                  {921600, B921600},
                                                                                  {1000000, B1000000},
                                                                                  {1152000, B1152000},
                                                                                  {1500000, B1500000},
                                                                                  {2000000, B2000000},
                                                                                  {2500000, B2500000},
                                                                                  {3000000, B3000000},
                                                                                  {3500000, B3500000},
                                                                                  {4000000, B4000000}}};

/// Of those that there are; equal to `baud` when it is one of them.
[[nodiscard]] inline std::uint32_t nearest_serial_speed(std::uint32_t baud) noexcept {
  const auto distance = [baud](const auto& entry) {
    return std::max(entry.first, baud) - std::min(entry.first, baud);
  };
  return std::min_element(serial_speeds.begin(), serial_speeds.end(),
                          [&](const auto& a, const auto& b) { return distance(a) < distance(b); })
      ->first;
}

/// The serial devices of this machine, by the names that stay.
[[nodiscard]] inline std::string serial_devices() {
  std::vector<std::string> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator{"/dev/serial/by-id", error})
    found.push_back(entry.path().string());
  if (found.empty()) {
    for (const auto& entry : std::filesystem::directory_iterator{"/dev", error}) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with("ttyACM") || name.starts_with("ttyUSB")) found.push_back(entry.path().string());
    }
  }
  std::sort(found.begin(), found.end());
  std::string text;
  for (const std::string& name : found) text += (text.empty() ? "" : ", ") + name;
  return text;
}

[[nodiscard]] inline host::Failure open_failure(const std::string& path, int error) {
  const std::string reason = std::string(" (") + std::strerror(error) + ")";
  switch (error) {
    case ENOENT:
    case ENXIO:
    case ENODEV: {
      const std::string devices = serial_devices();
      return {"there is no serial device '" + path + "'" + reason,
              devices.empty() ? "plug the adapter in; `dmesg | tail` tells its name, mostly /dev/ttyACM0"
                              : "the serial devices here are: " + devices};
    }
    case EACCES:
    case EPERM:
      return {"not allowed to open '" + path + "'" + reason,
              "join the group that owns it and log in again: sudo usermod -aG dialout $USER (see ls -l " +
                  path + ")"};
    case EBUSY:
    case EWOULDBLOCK:
      return {"'" + path + "' is in use by another program",
              "end that one: `fuser -v " + path + "` names it"};
    case ECONNREFUSED:
      return {"no program listens on the socket '" + path + "'" + reason,
              "start the board or program behind it"};
    default:
      return {"cannot open '" + path + "'" + reason, "see the kernel's log: dmesg"};
  }
}

/// `other`: what it could have been instead of a serial device.
[[nodiscard]] inline host::Failure no_serial_device(const std::string& path, std::string_view other = {}) {
  const std::string devices = serial_devices();
  return {"'" + path + "' is " +
              (other.empty() ? "no serial device" : "neither a serial device nor " + std::string(other)),
          devices.empty() ? "name the adapter's, mostly /dev/ttyACM0 or /dev/ttyUSB0"
                          : "the serial devices here are: " + devices};
}

[[nodiscard]] inline host::Failure line_gone(const std::string& what, int error) {
  return {what + " is gone: unplugged, or its other end closed" +
              (error == 0 || error == EIO ? "" : " (" + std::string(std::strerror(error)) + ")"),
          "plug it in again and restart"};
}

}  // namespace detail

/// How each side holds the other back.
enum class SerialFlow : std::uint8_t { none, rts_cts };

class SerialPort {
 public:
  /// No port.
  SerialPort() = default;
  SerialPort(SerialPort&& other) noexcept
      : path_(std::move(other.path_)),
        line_(std::move(other.line_)),
        restore_(std::exchange(other.restore_, std::nullopt)),
        failure_(std::move(other.failure_)) {}
  SerialPort& operator=(SerialPort&& other) noexcept {
    if (this != &other) {
      close();
      path_ = std::move(other.path_);
      line_ = std::move(other.line_);
      restore_ = std::exchange(other.restore_, std::nullopt);
      failure_ = std::move(other.failure_);
    }
    return *this;
  }
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;
  ~SerialPort() { close(); }

  /// What was in the line before is thrown away. The failure says what is wrong and what to do: no such
  /// device, none at all, not allowed, in use, taken by the kernel, a speed that it does not have.
  [[nodiscard]] static host::Outcome<SerialPort> open(const std::string& path, std::uint32_t baud = 115'200,
                                                      SerialFlow flow = SerialFlow::none) {
    SerialPort port;
    port.path_ = path;
    // Looked at first: opening a FIFO or a tape has effects of its own.
    struct stat status {};
    if (::stat(path.c_str(), &status) < 0) return detail::open_failure(path, errno);
    if (!S_ISCHR(status.st_mode)) return detail::no_serial_device(path);
    port.line_ = host::Descriptor{::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
    if (!port.line_) return detail::open_failure(path, errno);
    if (auto problem = port.take(baud, flow)) return std::move(*problem);
    return port;
  }

  [[nodiscard]] explicit operator bool() const noexcept { return static_cast<bool>(line_); }
  [[nodiscard]] int descriptor() const noexcept { return line_.get(); }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// How many bytes have come, the first of `room`; 0: none now. Error::closed: the device is gone, and
  /// `failure` says so in words; what had come before has been read.
  base::Result<std::size_t> read(std::span<char> room) {
    for (;;) {
      const ssize_t size = ::read(line_.get(), room.data(), room.size());
      if (size > 0) return static_cast<std::size_t>(size);
      if (size < 0 && errno == EINTR) continue;
      if ((size < 0 && errno == EAGAIN) || room.empty()) return std::size_t{0};
      return lose(size < 0 ? errno : 0);
    }
  }
  /// How many bytes the line took, the first ones; 0: no room now. Error::closed as in `read`.
  base::Result<std::size_t> write(std::string_view text) {
    std::size_t taken = 0;
    while (taken < text.size()) {
      const ssize_t size = ::write(line_.get(), text.data() + taken, text.size() - taken);
      if (size > 0) {
        taken += static_cast<std::size_t>(size);
        continue;
      }
      if (size < 0 && errno == EINTR) continue;
      if (size < 0 && errno != EAGAIN) return lose(errno);
      break;
    }
    return taken;
  }
  /// Bytes that the kernel has not yet sent.
  [[nodiscard]] std::size_t unsent() const noexcept {
    int waits = 0;
    return ::ioctl(line_.get(), TIOCOUTQ, &waits) == 0 && waits > 0 ? static_cast<std::size_t>(waits) : 0;
  }
  /// Why `read` or `write` answered Error::closed.
  [[nodiscard]] const host::Failure& failure() const noexcept { return failure_; }

  /// Throws away what the kernel has not yet sent: it must not make the end wait. What a pseudo terminal took
  /// is sent, though perhaps not yet where its reader finds it: there a flush would take the last words away.
  void close() noexcept {
    if (restore_) {
      if (!is_pseudo_terminal()) ::tcflush(line_.get(), TCOFLUSH);
      ::tcsetattr(line_.get(), TCSANOW, &*restore_);
      ::ioctl(line_.get(), TIOCNXCL);
    }
    restore_.reset();
    line_.reset();
  }

 private:
  [[nodiscard]] std::optional<host::Failure> take(std::uint32_t baud, SerialFlow flow) {
    termios settings{};
    if (::tcgetattr(line_.get(), &settings) < 0) return detail::no_serial_device(path_);
    int discipline = 0;
    if (::ioctl(line_.get(), TIOCGETD, &discipline) == 0 && discipline == N_SLCAN)
      return host::Failure{"'" + path_ + "' is taken by the kernel's slcan driver",
                           "use the interface that it has made (`ip link show type can`), or end slcand"};
    // Both: the lock also keeps root out, the other also programs that do not look for locks. A pseudo
    // terminal would stay exclusive when its program is killed, until its other end goes.
    if (::flock(line_.get(), LOCK_EX | LOCK_NB) < 0 && errno == EWOULDBLOCK)
      return detail::open_failure(path_, EBUSY);
    if (!is_pseudo_terminal()) ::ioctl(line_.get(), TIOCEXCL);
    restore_ = settings;
    ::cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
    if (flow == SerialFlow::rts_cts) settings.c_cflag |= CRTSCTS;
    settings.c_iflag &= ~static_cast<tcflag_t>(IXOFF);
    settings.c_cc[VMIN] = 1;
    settings.c_cc[VTIME] = 0;
    const std::uint32_t nearest = detail::nearest_serial_speed(baud);
    if (nearest != baud)
      return host::Failure{"a serial line has no speed " + std::to_string(baud) + " here",
                           "the nearest is " + std::to_string(nearest)};
    for (const auto& [number, speed] : detail::serial_speeds) {
      if (number == baud) {
        ::cfsetispeed(&settings, speed);
        ::cfsetospeed(&settings, speed);
      }
    }
    if (::tcsetattr(line_.get(), TCSANOW, &settings) < 0)
      return host::Failure{
          "cannot set '" + path_ + "' to " + std::to_string(baud) + " baud: " + std::strerror(errno),
          "try another speed, such as 115200"};
    ::tcflush(line_.get(), is_pseudo_terminal() ? TCIFLUSH : TCIOFLUSH);
    return std::nullopt;
  }
  /// [Linux, Documentation/admin-guide/devices.txt: 136 to 143, Unix98 PTY slaves]
  [[nodiscard]] bool is_pseudo_terminal() const noexcept {
    struct stat status {};
    return ::fstat(line_.get(), &status) == 0 && major(status.st_rdev) >= 136 && major(status.st_rdev) <= 143;
  }
  base::Error lose(int error) {
    failure_ = detail::line_gone("'" + path_ + "'", error);
    return base::Error::closed;
  }

  std::string path_;
  host::Descriptor line_;
  std::optional<termios> restore_;
  host::Failure failure_;
};

}  // namespace ocm::transport
