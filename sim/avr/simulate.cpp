/// Runs an AVR image in simavr and plays its dongle: USART0 is the line, PB2 the pin. In virtual time by a
/// script, or in real time behind a pseudo terminal.
///
///     ocm-avr IMAGE.elf             commands on stdin, a line each, answers on stdout
///     ocm-avr IMAGE.elf --pty       prints the terminal's name, and runs until SIGTERM, SIGINT or EOF
///
///     pin 0|1          level of the dongle's pin; 0: connected
///     send HEX...      bytes to the robot, one after the other at the line's speed
///     run MS           lets time pass; then what it said, `heard US HEX` for up to 20 bytes each, and `at
///     US` peek ADDRESS N   `memory HEX...`, N bytes of its data space
///
/// Deterministic with a script: the same commands give the same answers, to the microsecond. Exit code: 0, 1
/// the image crashed or cannot be loaded, 2 usage.
#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <deque>
#include <fcntl.h>
#include <iostream>
#include <sstream>
#include <string>
#include <termios.h>
#include <unistd.h>
#include <vector>

#include "ocm/base/text.hpp"

extern "C" {
#include <avr_ioport.h>
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_elf.h>
}

namespace {

constexpr std::uint32_t clock_hz = 20'000'000;
constexpr std::uint32_t baud = 38'400;
constexpr avr_cycle_count_t cycles_a_byte = avr_cycle_count_t{clock_hz} * 10 / baud;

volatile std::sig_atomic_t interrupted = 0;

class Robot {
 public:
  struct Heard {
    std::uint64_t us;
    std::uint8_t byte;
  };

  explicit Robot(const char* image) {
    avr_global_logger_set([](avr_t*, const int level, const char* format, va_list arguments) {
      if (level <= LOG_ERROR) std::vfprintf(stderr, format, arguments);
    });
    elf_firmware_t firmware{};
    if (::access(image, R_OK) != 0 || elf_read_firmware(image, &firmware) != 0)
      throw std::string{"cannot load "} + image + ": " + std::strerror(errno);
    avr_ = avr_make_mcu_by_name("atmega1284p");
    if (avr_ == nullptr) throw std::string{"this simavr has no atmega1284p"};
    avr_init(avr_);
    firmware.frequency = clock_hz;
    avr_load_firmware(avr_, &firmware);
    std::uint32_t flags = 0;
    avr_ioctl(avr_, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
    flags &= ~static_cast<std::uint32_t>(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
    avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
    in_ = avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_INPUT);
    avr_irq_register_notify(
        avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT),
        [](avr_irq_t*, std::uint32_t value, void* self) {
          auto& robot = *static_cast<Robot*>(self);
          robot.heard.push_back({robot.us(), static_cast<std::uint8_t>(value)});
        },
        this);
    pin_ = avr_io_getirq(avr_, AVR_IOCTL_IOPORT_GETIRQ('B'), 2);
    pin(true);
  }

  /// The dongle drives its pin: it overrules the pull-up.
  void pin(bool high) {
    constexpr unsigned mask = 1 << 2;
    avr_ioport_external_t wire{};
    wire.name = 'B';
    wire.mask = mask;
    wire.value = high ? mask : 0;
    avr_ioctl(avr_, AVR_IOCTL_IOPORT_SET_EXTERNAL('B'), &wire);
    avr_raise_irq(pin_, high ? 1 : 0);
  }
  void send(std::uint8_t byte) { waiting_.push_back(byte); }
  /// False: it crashed, or waits for ever with its interrupts off.
  bool run(std::uint64_t microseconds) {
    const avr_cycle_count_t end = avr_->cycle + microseconds * (clock_hz / 1'000'000);
    while (avr_->cycle < end) {
      if (!waiting_.empty() && avr_->cycle >= free_at_) {
        avr_raise_irq(in_, waiting_.front());
        waiting_.pop_front();
        free_at_ = avr_->cycle + cycles_a_byte;
      }
      const int state = avr_run(avr_);
      if (state == cpu_Done || state == cpu_Crashed) return false;
    }
    return true;
  }
  [[nodiscard]] std::uint64_t us() const { return avr_->cycle / (clock_hz / 1'000'000); }
  [[nodiscard]] std::uint8_t memory(std::size_t address) const {
    return address <= avr_->ramend ? avr_->data[address] : std::uint8_t{0};
  }

  std::vector<Heard> heard;

 private:
  avr_t* avr_ = nullptr;
  avr_irq_t* in_ = nullptr;
  avr_irq_t* pin_ = nullptr;
  std::deque<std::uint8_t> waiting_;
  avr_cycle_count_t free_at_ = 0;
};

/// One command; false: not one, or the robot is dead.
bool obey(Robot& robot, const std::string& line) {
  std::istringstream words{line};
  std::string command, hex;
  words >> command;
  if (command == "pin") {
    int level = -1;
    words >> level;
    if (level != 0 && level != 1) return false;
    robot.pin(level == 1);
    return true;
  }
  if (command == "send") {
    while (words >> hex) {
      if (hex.size() % 2 != 0) return false;
      for (std::size_t i = 0; i < hex.size(); i += 2) {
        const int high = ocm::base::hex_digit(hex[i]), low = ocm::base::hex_digit(hex[i + 1]);
        if (high < 0 || low < 0) return false;
        robot.send(static_cast<std::uint8_t>(high << 4 | low));
      }
    }
    return true;
  }
  if (command == "run") {
    std::uint64_t ms = 0;
    if (!(words >> ms)) return false;
    if (!robot.run(ms * 1000)) {
      std::cerr << "ocm-avr: the image has stopped\n";
      return false;
    }
    for (std::size_t i = 0; i < robot.heard.size();) {
      std::printf("heard %llu ", static_cast<unsigned long long>(robot.heard[i].us));
      for (const std::size_t end = std::min(i + 20, robot.heard.size()); i < end; ++i)
        std::printf("%02x", robot.heard[i].byte);
      std::printf("\n");
    }
    robot.heard.clear();
    std::printf("at %llu\n", static_cast<unsigned long long>(robot.us()));
    std::fflush(stdout);
    return true;
  }
  if (command == "peek") {
    std::size_t address = 0, count = 0;
    if (!(words >> address >> count)) return false;
    std::printf("memory ");
    for (std::size_t i = 0; i < count; ++i) std::printf("%02x", robot.memory(address + i));
    std::printf("\n");
    std::fflush(stdout);
    return true;
  }
  return command.empty();
}

int by_script(Robot& robot) {
  for (std::string line; std::getline(std::cin, line);) {
    if (obey(robot, line)) continue;
    std::cerr << "ocm-avr: not done: " << line << "\n";
    return 1;
  }
  return 0;
}

/// The line is a terminal, the robot connected; a millisecond at a time, and never ahead of the clock.
int behind_terminal(Robot& robot) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (terminal < 0 || ::grantpt(terminal) != 0 || ::unlockpt(terminal) != 0) {
    std::cerr << "ocm-avr: no pseudo terminal: " << std::strerror(errno) << "\n";
    return 1;
  }
  const int kept = ::open(::ptsname(terminal), O_RDWR | O_NOCTTY);  // no hang-up while no program has it open
  termios raw{};
  ::tcgetattr(kept, &raw);
  ::cfmakeraw(&raw);  // a serial line echoes nothing
  ::tcsetattr(kept, TCSANOW, &raw);
  std::printf("%s\n", ::ptsname(terminal));
  std::fflush(stdout);
  robot.pin(false);
  timespec next{};
  ::clock_gettime(CLOCK_MONOTONIC, &next);
  while (interrupted == 0) {
    std::array<std::uint8_t, 256> bytes{};
    const ssize_t got = ::read(terminal, bytes.data(), bytes.size());
    for (ssize_t i = 0; i < got; ++i) robot.send(bytes[static_cast<std::size_t>(i)]);
    if (!robot.run(1000)) return 1;
    for (const auto& heard : robot.heard)
      if (::write(terminal, &heard.byte, 1) != 1) std::cerr << "ocm-avr: no program reads\n";
    robot.heard.clear();
    next.tv_nsec += 1'000'000;
    if (next.tv_nsec >= 1'000'000'000) {
      next.tv_nsec -= 1'000'000'000;
      ++next.tv_sec;
    }
    ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, nullptr);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty() || words.size() > 2 || (words.size() == 2 && words[1] != "--pty")) {
    std::cerr << "usage: ocm-avr IMAGE.elf [--pty]\n";
    return 2;
  }
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = 1; });
  try {
    Robot robot{words[0].c_str()};
    return words.size() == 2 ? behind_terminal(robot) : by_script(robot);
  } catch (const std::string& problem) {
    std::cerr << "ocm-avr: " << problem << "\n";
    return 1;
  }
}
