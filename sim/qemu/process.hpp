/// An image in QEMU: the process, and its serial lines as sockets. What goes over them is up to others.
///
///     auto qemu = QemuProcess::start({.name = "light_ring", .image = "light_ring_qemu_m3.elf", ...}, 2);
///     ::poll(qemu->line(0), ...)
///
/// Waits for nothing; its end ends QEMU. Host only.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/transport/bus.hpp"

#include "firmware/qemu/parts_frames.hpp"

namespace ocm::sim {

struct QemuOptions {
  std::string name;     ///< of the board, for messages
  std::string machine;  ///< QEMU's -M
  std::string image;    ///< ELF file
  std::string program = "qemu-system-arm";
};

class QemuProcess {
 public:
  /// With this many serial lines.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<QemuProcess>> start(QemuOptions options,
                                                                              std::size_t lines) {
    if (::access(options.image.c_str(), R_OK) != 0)
      return transport::Failure{
          "no image of " + options.name + ": " + options.image + ": " + std::strerror(errno),
          "build it: scripts/build firmware, or say where it is with --images"};
    std::unique_ptr<QemuProcess> qemu{new QemuProcess(std::move(options))};
    std::vector<host::Descriptor> theirs;
    for (std::size_t i = 0; i < lines; ++i) {
      int ends[2];
      if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) < 0)
        return transport::Failure{"no lines to " + qemu->name() + ": " + std::strerror(errno),
                                  "close other programs"};
      ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
      qemu->lines_.emplace_back(ends[0]);
      theirs.emplace_back(ends[1]);
    }
    if (auto problem = qemu->spawn(theirs)) return std::move(*problem);
    return qemu;
  }
  QemuProcess(const QemuProcess&) = delete;
  QemuProcess& operator=(const QemuProcess&) = delete;
  ~QemuProcess() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);  // it holds nothing that could be lost
    ::waitpid(process_, nullptr, 0);
  }

  [[nodiscard]] const std::string& name() const noexcept { return options_.name; }
  /// To poll, read and write; never blocks.
  [[nodiscard]] int line(std::size_t number) const noexcept { return lines_[number].get(); }
  /// Why QEMU has ended; empty while it runs.
  [[nodiscard]] std::string ended() {
    int status = 0;
    if (process_ > 0 && ::waitpid(process_, &status, WNOHANG) == process_) {
      process_ = -1;
      end_ = WIFSIGNALED(status) ? std::string{"QEMU was ended by signal "} + ::strsignal(WTERMSIG(status))
                                 : "QEMU ended with exit code " + std::to_string(WEXITSTATUS(status));
    }
    return end_;
  }

  /// What a line has, at most as much as `bytes` holds; empty when there is nothing.
  [[nodiscard]] std::span<char> read(std::size_t number, std::span<char> bytes) const {
    const ssize_t got = ::recv(line(number), bytes.data(), bytes.size(), MSG_DONTWAIT);
    return bytes.first(got > 0 ? static_cast<std::size_t>(got) : 0);
  }
  /// All or nothing, as far as the socket has it: texts and frames are far below what a socket takes at once.
  bool write(std::size_t number, std::string_view text) const {
    return ::send(line(number), text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }

 private:
  explicit QemuProcess(QemuOptions options) : options_(std::move(options)) {}

  std::optional<transport::Failure> spawn(std::span<const host::Descriptor> theirs) {
    // Their ends must survive exec, under numbers that are not in use.
    constexpr int first_number = 10;
    constexpr int out_of_the_way = 40;
    std::vector<std::string> words{options_.program,
                                   "-M",
                                   options_.machine,
                                   "-kernel",
                                   options_.image,
                                   "-display",
                                   "none",
                                   "-monitor",
                                   "none",
                                   "-nodefaults",
                                   "-semihosting-config",
                                   "enable=on,target=native"};
    for (std::size_t i = 0; i < theirs.size(); ++i) {
      const std::string line = "line" + std::to_string(i);
      words.insert(
          words.end(),
          {"-chardev", "socket,id=" + line + ",fd=" + std::to_string(first_number + static_cast<int>(i)),
           "-serial", "chardev:" + line});
    }
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    // The child tells why exec failed over a pipe that exec closes.
    int report[2];
    if (::pipe2(report, O_CLOEXEC) < 0)
      return transport::Failure{std::string{"no pipe: "} + std::strerror(errno), "close other programs"};
    host::Descriptor reading{report[0]};
    host::Descriptor writing{report[1]};
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() != parent) ::_exit(0);
      // A Ctrl-C at the terminal is for the simulator, which ends its boards.
      ::setpgid(0, 0);
      ::signal(SIGPIPE, SIG_DFL);
      const int report_copy = ::fcntl(writing.get(), F_DUPFD_CLOEXEC, out_of_the_way);
      std::array<int, 8> copies{};  // none may be in another's way
      for (std::size_t i = 0; i < theirs.size(); ++i)
        copies[i] = ::fcntl(theirs[i].get(), F_DUPFD_CLOEXEC, out_of_the_way);
      for (std::size_t i = 0; i < theirs.size(); ++i) ::dup2(copies[i], first_number + static_cast<int>(i));
      ::execvp(arguments[0], arguments.data());
      const int error = errno;
      [[maybe_unused]] const auto told = ::write(report_copy, &error, sizeof error);
      ::_exit(127);
    }
    if (process_ < 0)
      return transport::Failure{std::string{"cannot start a process: "} + std::strerror(errno),
                                "close other programs"};
    writing.reset();
    int error = 0;
    if (::read(reading.get(), &error, sizeof error) == sizeof error) {
      ::waitpid(process_, nullptr, 0);
      process_ = -1;
      return transport::Failure{"cannot start " + options_.program + ": " + std::strerror(error),
                                "install it: sudo apt-get install qemu-system-arm"};
    }
    return std::nullopt;
  }

  QemuOptions options_;
  pid_t process_ = -1;
  std::string end_;
  std::vector<host::Descriptor> lines_;
};

/// The host's end of a parts' line: requests in, answers out. (firmware/qemu/parts_frames.hpp)
class PartsServer {
 public:
  /// Answers what has come: `answer(const firmware::qemu::link::Request&, std::span<std::uint8_t>) ->
  /// base::Status` stands for the parts. How many exchanges there were.
  template <class Answer>
  std::uint64_t serve(const QemuProcess& qemu, std::size_t line, Answer& answer) {
    std::uint64_t exchanges = 0;
    std::array<char, 512> buffer;
    for (std::span<char> bytes = qemu.read(line, buffer); !bytes.empty(); bytes = qemu.read(line, buffer)) {
      for (const char byte : bytes) {
        if (!requests_.feed(static_cast<std::uint8_t>(byte))) continue;
        const firmware::qemu::link::Request request = requests_.request();
        std::array<std::uint8_t, firmware::qemu::link::answer_header + firmware::qemu::link::max_bytes> out{};
        const std::span<std::uint8_t> read =
            std::span{out}.subspan(firmware::qemu::link::answer_header, request.asked);
        const base::Status done = answer(request, read);
        const auto head = firmware::qemu::link::header(
            {request.sequence, done.error, done ? read : std::span<std::uint8_t>{}});
        std::copy(head.begin(), head.end(), out.begin());
        const std::size_t size = head.size() + (done ? read.size() : 0);
        ++exchanges;
        qemu.write(line, {reinterpret_cast<const char*>(out.data()), size});
      }
    }
    return exchanges;
  }

 private:
  firmware::qemu::link::RequestReader requests_;
};

}  // namespace ocm::sim
