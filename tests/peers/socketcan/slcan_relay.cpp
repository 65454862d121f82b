// Two serial CAN adapters, joined like two machines by a null modem cable: what the host of one sends, the
// other hears. At one hangs the kernel's slcan driver, at the other the program that opens the pty.
//   slcan_relay            prints "INTERFACE PTY", and relays until its stdin ends; then prints counts
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <linux/sockios.h>
#include <linux/tty.h>
#include <poll.h>
#include <pty.h>
#include <string>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "ocm/can/slcan_adapter.hpp"
#include "ocm/host/descriptor.hpp"

using namespace ocm;

namespace {

[[noreturn]] void give_up(const char* what) {
  std::fprintf(stderr, "slcan_relay: %s: %s\n", what, std::strerror(errno));
  std::exit(1);
}

base::Time now() {
  return base::Time{
      std::chrono::duration_cast<base::Duration>(std::chrono::steady_clock::now().time_since_epoch())};
}

/// One adapter: its pty, what waits to go to its host, and how many frames its host has sent.
struct End {
  End() {
    int numbers[2] = {-1, -1};
    char path[64] = {};
    if (::openpty(&numbers[0], &numbers[1], path, nullptr, nullptr) < 0) give_up("openpty");
    line = host::Descriptor{numbers[0]};
    slave = host::Descriptor{numbers[1]};
    name = path;
    termios raw{};
    if (::tcgetattr(slave.get(), &raw) < 0) give_up("tcgetattr");
    ::cfmakeraw(&raw);
    if (::tcsetattr(slave.get(), TCSANOW, &raw) < 0) give_up("tcsetattr");
    ::fcntl(line.get(), F_SETFL, O_NONBLOCK);
  }

  static constexpr std::size_t limit = 8192;
  [[nodiscard]] bool full() const { return out.size() >= limit; }

  /// As the bus of the other end: it hears the frame.
  base::Result<bool> send(const can::Frame& frame) {
    out += adapter.hear(frame, now()).view();
    ++heard;
    return true;
  }

  host::Descriptor line;
  host::Descriptor slave;
  std::string name;
  can::slcan::Adapter adapter;
  std::string out;
  unsigned long heard = 0;
};

/// What has come from the host of `from`, a little at a time: the kernel's driver takes no BEL, so that a
/// full relay must stop to read rather than refuse.
void relay(End& from, End& to) {
  std::array<char, 256> text;
  const ssize_t size = ::read(from.line.get(), text.data(), text.size());
  if (size < 0 && errno == EAGAIN) return;
  if (size <= 0) give_up("read");
  for (ssize_t i = 0; i < size; ++i)
    from.out += from.adapter.feed(text[static_cast<std::size_t>(i)], to).view();
}

void flush(End& end) {
  if (end.out.empty()) return;
  const ssize_t size = ::write(end.line.get(), end.out.data(), end.out.size());
  if (size > 0) end.out.erase(0, static_cast<std::size_t>(size));
  if (size < 0 && errno != EAGAIN) give_up("write");
}

}  // namespace

int main() {
  End kernel;
  End other;
  const int discipline = N_SLCAN;
  if (::ioctl(kernel.slave.get(), TIOCSETD, &discipline) < 0) give_up("TIOCSETD");
  char interface[64] = {};
  if (::ioctl(kernel.slave.get(), SIOCGIFNAME, interface) < 0) give_up("SIOCGIFNAME");
  std::printf("%s %s\n", interface, other.name.c_str());
  std::fflush(stdout);

  for (;;) {
    const auto wanted = [](const End& end, const End& to) {
      const int in = to.full() || end.full() ? 0 : POLLIN;
      return static_cast<short>(in | (end.out.empty() ? 0 : POLLOUT));
    };
    std::array<pollfd, 3> polls{{{kernel.line.get(), wanted(kernel, other), 0},
                                 {other.line.get(), wanted(other, kernel), 0},
                                 {STDIN_FILENO, POLLIN, 0}}};
    if (::poll(polls.data(), polls.size(), -1) < 0) give_up("poll");
    if ((polls[0].revents & POLLIN) != 0) relay(kernel, other);
    if ((polls[1].revents & POLLIN) != 0) relay(other, kernel);
    flush(kernel);
    flush(other);
    if (polls[2].revents != 0) break;
  }
  std::printf("kernel sent %lu, faults %llu; other sent %lu, faults %llu\n", other.heard,
              static_cast<unsigned long long>(kernel.adapter.faults().total()), kernel.heard,
              static_cast<unsigned long long>(other.adapter.faults().total()));
  return 0;
}
