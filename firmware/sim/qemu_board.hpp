/// A board that runs as an image in QEMU: the process and its two lines. On one of them the board is an SLCAN
/// adapter with what it sends and hears, on the other it asks for its parts.
///
///     auto board = QemuBoard::start({.name = "light_ring", .image = "light_ring_qemu_m3.elf", ...});
///     board->read([&](const can::Frame& frame) { return arbiter.send(node, frame); }, answer_parts);
///     board->hear(frame);
///
/// Waits for nothing; `descriptors()` are readable when there is something to do. Host only.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <optional>
#include <poll.h>
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
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/slcan.hpp"
#include "ocm/transport/bus.hpp"
#include "ocm/transport/descriptor.hpp"

#include "firmware/qemu/link.hpp"

namespace ocm::firmware::sim {

struct QemuOptions {
  std::string name;     ///< of the board, for messages
  std::string machine;  ///< QEMU's -M
  std::string image;    ///< ELF file
  std::string program = "qemu-system-arm";
};

struct QemuCounters {
  std::uint64_t sent = 0;       ///< frames of the board that the bus took
  std::uint64_t heard = 0;      ///< frames handed to the board
  std::uint64_t deaf = 0;       ///< frames that the board's line had no room for: lost to it
  std::uint64_t garbage = 0;    ///< lines of the board that were no SLCAN
  std::uint64_t exchanges = 0;  ///< with its parts
};

class QemuBoard {
 public:
  [[nodiscard]] static transport::Outcome<std::unique_ptr<QemuBoard>> start(QemuOptions options) {
    if (::access(options.image.c_str(), R_OK) != 0)
      return transport::Failure{
          "no image of " + options.name + ": " + options.image + ": " + std::strerror(errno),
          "build it: scripts/build firmware, or say where it is with --images"};
    auto can = line();
    auto link = line();
    if (!can || !link)
      return transport::Failure{std::string{"no lines to "} + options.name + ": " + std::strerror(errno),
                                "close other programs"};
    std::unique_ptr<QemuBoard> board{new QemuBoard(std::move(options))};
    if (auto problem = board->spawn(can->second.get(), link->second.get())) return std::move(*problem);
    board->can_ = std::move(can->first);
    board->link_ = std::move(link->first);
    return board;
  }
  QemuBoard(const QemuBoard&) = delete;
  QemuBoard& operator=(const QemuBoard&) = delete;
  ~QemuBoard() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);  // it holds nothing that could be lost
    ::waitpid(process_, nullptr, 0);
  }

  [[nodiscard]] const std::string& name() const noexcept { return options_.name; }
  [[nodiscard]] const QemuCounters& counters() const noexcept { return counters_; }
  /// To poll for input.
  [[nodiscard]] std::array<int, 2> descriptors() const noexcept { return {can_.get(), link_.get()}; }
  /// The bus had no room for a frame of the board: `read` again when it has.
  [[nodiscard]] bool waiting() const noexcept { return held_.has_value(); }
  /// The board has said that it listens. What it should hear before that is lost to it, as to any board that
  /// starts.
  [[nodiscard]] bool ready() const noexcept { return ready_; }
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

  /// Takes what the board has sent. `send(const can::Frame&) -> bool`: false when the bus has no room, then
  /// the board's line waits. `answer(const qemu::link::Request&, std::span<std::uint8_t>) -> base::Status`
  /// stands for the board's parts.
  template <class Send, class Answer>
  void read(Send&& send, Answer&& answer) {
    read_parts(answer);
    read_can(send);
  }

  /// The board hears a frame. What its line has no room for is lost to it, and counted.
  void hear(const can::Frame& frame) {
    const auto text = can::slcan::encode(frame);
    if (!text) return;
    ++(write(can_.get(), text->view()) ? counters_.heard : counters_.deaf);
  }

 private:
  explicit QemuBoard(QemuOptions options) : options_(std::move(options)) {}

  using Ends = std::pair<transport::Descriptor, transport::Descriptor>;  // ours, QEMU's
  static std::optional<Ends> line() {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) < 0) return std::nullopt;
    ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
    return Ends{transport::Descriptor{ends[0]}, transport::Descriptor{ends[1]}};
  }

  std::optional<transport::Failure> spawn(int can, int link) {
    // Both ends must survive exec, under numbers that nobody else has.
    constexpr int can_number = 10;
    constexpr int link_number = 11;
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
                                   "-chardev",
                                   "socket,id=can,fd=" + std::to_string(can_number),
                                   "-serial",
                                   "chardev:can",
                                   "-chardev",
                                   "socket,id=link,fd=" + std::to_string(link_number),
                                   "-serial",
                                   "chardev:link",
                                   "-semihosting-config",
                                   "enable=on,target=native"};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    // The child tells why exec failed over a pipe that exec closes.
    int report[2];
    if (::pipe2(report, O_CLOEXEC) < 0)
      return transport::Failure{std::string{"no pipe: "} + std::strerror(errno), "close other programs"};
    transport::Descriptor reading{report[0]};
    transport::Descriptor writing{report[1]};
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() != parent) ::_exit(0);
      // A Ctrl-C at the terminal is for the simulator, which ends its boards.
      ::setpgid(0, 0);
      ::signal(SIGPIPE, SIG_DFL);
      const int can_copy = ::fcntl(can, F_DUPFD, 20);  // neither may be in the other's way
      const int link_copy = ::fcntl(link, F_DUPFD, 20);
      const int report_copy = ::fcntl(writing.get(), F_DUPFD_CLOEXEC, 20);
      ::dup2(can_copy, can_number);
      ::dup2(link_copy, link_number);
      ::close(can_copy);
      ::close(link_copy);
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

  /// All or nothing, as far as the socket has it: these texts are far below what a socket takes at once.
  static bool write(int descriptor, std::string_view text) {
    return ::send(descriptor, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }

  template <class Send>
  void read_can(Send& send) {
    for (;;) {
      if (held_) {
        if (!send(*held_)) return;
        held_.reset();
        ++counters_.sent;
      }
      if (at_ == size_) {
        const ssize_t got = ::recv(can_.get(), buffer_.data(), buffer_.size(), MSG_DONTWAIT);
        if (got <= 0) return;
        at_ = 0;
        size_ = static_cast<std::size_t>(got);
      }
      using Kind = can::slcan::Answer::Kind;
      const auto answer = lines_.feed(buffer_[at_++]);
      if (answer.kind == Kind::frame) held_ = answer.frame;
      if (answer.kind == Kind::done) ready_ = true;
      counters_.garbage = lines_.faults().total();
    }
  }

  template <class Answer>
  void read_parts(Answer& answer) {
    std::array<std::uint8_t, 512> bytes;
    for (;;) {
      const ssize_t got = ::recv(link_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (got <= 0) return;
      for (const std::uint8_t byte : std::span{bytes}.first(static_cast<std::size_t>(got))) {
        if (!requests_.feed(byte)) continue;
        const qemu::link::Request request = requests_.request();
        std::array<std::uint8_t, qemu::link::answer_header + qemu::link::max_bytes> out{};
        const std::span<std::uint8_t> read = std::span{out}.subspan(qemu::link::answer_header, request.asked);
        const base::Status done = answer(request, read);
        const auto head =
            qemu::link::header({request.sequence, done.error, done ? read : std::span<std::uint8_t>{}});
        std::copy(head.begin(), head.end(), out.begin());
        const std::size_t size = head.size() + (done ? read.size() : 0);
        ++counters_.exchanges;
        write(link_.get(), {reinterpret_cast<const char*>(out.data()), size});
      }
    }
  }

  QemuOptions options_;
  pid_t process_ = -1;
  std::string end_;
  transport::Descriptor can_;
  transport::Descriptor link_;
  can::slcan::AnswerReader lines_;
  qemu::link::RequestReader requests_;
  std::array<char, 4096> buffer_{};
  std::size_t at_ = 0;
  std::size_t size_ = 0;
  std::optional<can::Frame> held_;
  bool ready_ = false;
  QemuCounters counters_;
};

}  // namespace ocm::firmware::sim
