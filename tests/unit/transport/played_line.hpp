/// A serial line, or a socket in its place, on a kernel that is played, and what is at its far end.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/base/time.hpp"
#include "ocm/host/descriptor.hpp"

#include "unit/host/host_testing.hpp"
#include "unit/transport/played_kernel.hpp"

namespace ocm::test {

class PlayedLine {
 public:
  PlayedLine() {
    REQUIRE(::mknod(path.c_str(), S_IFSOCK | 0600, 0) == 0);
    kernel.connect = [this](int asked, const sockaddr*) {
      if (connect_error != 0) return failed(connect_error);
      play(asked);
      return 0;
    };
    kernel.open = [this](const char* asked) {
      if (asked != device) return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, asked, O_RDONLY, 0));
      if (open_error != 0) return failed(open_error);
      const int opened = ::eventfd(0, EFD_CLOEXEC);
      play(opened);
      return opened;
    };
    kernel.send = [this](int, const void* bytes, std::size_t size, int) { return take(bytes, size); };
    kernel.write = [this](int, const void* bytes, std::size_t size) { return take(bytes, size); };
    kernel.read = [this](int, void* bytes, std::size_t size) -> ssize_t {
      if (!read_errors.empty()) {
        const int error = read_errors.front();
        read_errors.pop_front();
        return failed(error);
      }
      asked_for = size;
      if (input.empty()) {
        errno = stale_error;  // the end of a file leaves it as it was
        return hung_up ? 0 : failed(EAGAIN);
      }
      const std::size_t count = std::min(size, input.size());
      std::copy_n(input.begin(), count, static_cast<char*>(bytes));
      input.erase(0, count);
      return static_cast<ssize_t>(count);
    };
    kernel.ready = [this](short events) {
      short found = 0;
      if (!input.empty() || hung_up) found = static_cast<short>(found | (events & POLLIN));
      if (room != 0) found = static_cast<short>(found | (events & POLLOUT));
      return found;
    };
    kernel.fstat = [this](int, struct stat* status) {
      *status = {};
      status->st_rdev = number;
      return 0;
    };
    kernel.flock = [this](int, int) { return lock_error == 0 ? 0 : failed(lock_error); };
    kernel.tcgetattr = [this](int, termios* now) {
      if (settings_error != 0) return failed(settings_error);
      *now = settings;
      return 0;
    };
    kernel.tcsetattr = [this](int, const termios* wanted) {
      if (set_error != 0) return failed(set_error);
      settings = *wanted;
      return 0;
    };
    kernel.tcflush = [this](int, int queue) {
      flushed.push_back(queue);
      return 0;
    };
    kernel.ioctl = [this](int, unsigned long request, void* argument) {
      requests.push_back(request);
      if (request == TIOCGETD) {
        *static_cast<int*>(argument) = discipline;
        return discipline < 0 ? failed(ENOTTY) : 0;
      }
      if (request == TIOCOUTQ) {
        *static_cast<int*>(argument) = unsent;
        return unsent < 0 ? failed(ENOTTY) : 0;
      }
      return 0;
    };
  }
  PlayedLine(const PlayedLine&) = delete;
  PlayedLine& operator=(const PlayedLine&) = delete;

  /// What comes from the far end.
  void say(std::string_view text) { input += text; }
  void say_later(base::Duration after, std::string text) {
    kernel.later(after, [this, text = std::move(text)] { say(text); });
  }
  /// What has passed since the line was opened.
  [[nodiscard]] base::Duration passed() const { return kernel.steady - begin; }

  PlayedKernel kernel;
  TemporaryDirectory folder;
  std::string path = folder.path() + "/uart";  ///< of the socket
  std::string device = "/dev/null";            ///< a character device: its name is all that is taken of it
  int file = -1;
  base::Time begin = kernel.steady;

  int connect_error = 0;
  int open_error = 0;
  int lock_error = 0;
  int settings_error = 0;
  int set_error = 0;
  termios settings{};
  std::vector<int> flushed;
  std::vector<unsigned long> requests;  ///< of ioctl
  int discipline = 0;                   ///< negative: it cannot be asked
  int unsent = 0;                       ///< the same

  std::string input;            ///< that the program has not read
  std::deque<int> read_errors;  ///< of the next reads
  std::deque<int> send_errors;
  bool hung_up = false;
  int stale_error = EAGAIN;   ///< in errno when the line has hung up
  std::size_t asked_for = 0;  ///< bytes, by the last read
  int writes = 0;
  dev_t number = 0;             ///< of the device
  std::size_t room = SIZE_MAX;  ///< bytes that the line takes

  /// Of each line, by its first letter ('-': an empty one): what the far end answers. The others it does not.
  std::map<char, std::string> answers;
  struct Line {
    base::Duration at{};
    std::string text;
    friend bool operator==(const Line&, const Line&) = default;
  };
  std::string heard;        ///< at the far end
  std::vector<Line> lines;  ///< the same, by their ends
  /// When each line with this beginning was there.
  [[nodiscard]] std::vector<base::Duration> times_of(std::string_view text) const {
    std::vector<base::Duration> times;
    for (const Line& line : lines)
      if (line.text.starts_with(text)) times.push_back(line.at);
    return times;
  }

 private:
  void play(int opened) {
    file = opened;
    kernel.files.push_back(opened);
  }
  ssize_t take(const void* bytes, std::size_t size) {
    ++writes;
    if (!send_errors.empty()) {
      const int error = send_errors.front();
      send_errors.pop_front();
      return failed(error);
    }
    const std::size_t count = std::min(size, room);
    if (count == 0) return failed(EAGAIN);
    if (room != SIZE_MAX) room -= count;
    for (const char c : std::string_view{static_cast<const char*>(bytes), count}) {
      heard += c;
      if (c != '\r') {
        line_ += c;
        continue;
      }
      lines.push_back({passed(), line_});
      const auto answer = answers.find(line_.empty() ? '-' : line_[0]);
      if (answer != answers.end()) say(answer->second);
      line_.clear();
    }
    return static_cast<ssize_t>(count);
  }
  std::string line_;
};

}  // namespace ocm::test
