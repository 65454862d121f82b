// Instructions of what a host on DiWheelDrive's serial line costs: its interrupts, and a turn of the line's
// thread. On QEMU's netduino2 with -icount shift=0, where an instruction takes a nanosecond, and TIM2 counts
// nanoseconds. Registers are memory; the kernel's share (entry and exit of an interrupt, switches of threads,
// locks) is not in it. bench/firmware/run line
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string_view>

#include "ocm/can/slcan_bridge.hpp"
#include "ocm/topics/amiro.hpp"

#include "bench/firmware/counter.hpp"
#include "firmware/drivers/bxcan_filter.hpp"
#include "firmware/drivers/bxcan_node.hpp"
#include "firmware/drivers/usart.hpp"

using namespace ocm;
namespace bxcan = firmware::drivers::bxcan;
namespace usart = firmware::drivers::usart;

namespace {

void print(const char* what, std::uint32_t instructions) {
  std::printf("%s: %lu\n", what, static_cast<unsigned long>(instructions));
}

/// A controller in which a frame of eight bytes always waits in each FIFO, and mailboxes are always free.
volatile std::uint32_t can_memory[0x100];
volatile std::uint32_t usart_memory[4];
struct CanRegisters {
  std::uint32_t read(bxcan::Register which) const noexcept {
    return can_memory[static_cast<std::size_t>(which) / 4];
  }
  void write(bxcan::Register which, std::uint32_t value) const noexcept {
    if (which != bxcan::Register::rf0r && which != bxcan::Register::rf1r && which != bxcan::Register::tsr)
      can_memory[static_cast<std::size_t>(which) / 4] = value;
  }
};
struct UsartRegisters {
  std::uint32_t read(usart::Register which) const noexcept {
    return usart_memory[static_cast<std::size_t>(which) / 4];
  }
  void write(usart::Register which, std::uint32_t value) const noexcept {
    if (which != usart::Register::dr) usart_memory[static_cast<std::size_t>(which) / 4] = value;
  }
};

constexpr auto filters = bxcan::wide_filter_banks_of<amiro::DiWheelDrive>();
bxcan::Node<CanRegisters> node{CanRegisters{}};
usart::Line<UsartRegisters> line{UsartRegisters{}};
can::slcan::Bridge<> bridge;

struct NoPort {
  struct Guard {
    ~Guard() {}
  };
  Guard lock() noexcept { return {}; }
} port;

struct BusOfHost {
  bool board_has_room(const can::Frame& frame) noexcept { return node.board_has_room(frame); }
  base::Result<bool> send(const can::Frame& frame) noexcept { return node.send_of_host(frame); }
  void deliver(const can::Frame& frame) noexcept { node.deliver(frame); }
  can::slcan::BusCondition condition() noexcept { return node.condition(); }
  void listen(bool all) noexcept { node.listen(all); }
} bus;

void in_can(bxcan::Register which, std::uint32_t value) {
  can_memory[static_cast<std::size_t>(which) / 4] = value;
}
std::uint32_t interrupt() {
  return cost([] { static_cast<void>(line.on_interrupt([](std::uint8_t) {})); });
}
void say(std::string_view text) {
  usart_memory[0] = usart::sr::rxne;
  for (const char character : text) {
    usart_memory[1] = static_cast<std::uint8_t>(character);
    static_cast<void>(interrupt());
  }
}
std::uint32_t turn() {
  return cost([] { static_cast<void>(bridge.turn(line, bus, port)); });
}
void drain() {
  usart_memory[0] = usart::sr::txe;
  while (line.room() < 128) static_cast<void>(interrupt());
  static_cast<void>(interrupt());
}

}  // namespace

int main() {
  tim2_cr1 = 1;
  empty = cost([] {});
  in_can(bxcan::Register::msr, bxcan::msr::inak);
  if (!node.start({}, filters).ok()) return 1;
  in_can(bxcan::Register::msr, 0);
  in_can(bxcan::Register::rdtr, 8);
  in_can(bxcan::of_fifo(bxcan::Register::rdtr, 1), 8);
  in_can(bxcan::of_fifo(bxcan::Register::rir, 1), 0x61FU << 21);
  in_can(bxcan::Register::rir, 0x208U << 21);
  node.attach(
      {[](void*, const can::Frame& frame, base::Time now) noexcept { bridge.hear(frame, now); }, nullptr});
  line.start(72'000'000, 115'200);

  in_can(bxcan::Register::rf0r, 1);
  print("a frame for the board, no host", cost([] { static_cast<void>(node.controller().receive()); }));
  say("S6\rZ1\rO\r");
  static_cast<void>(turn());
  if (!bridge.open()) return 2;
  drain();
  in_can(bxcan::of_fifo(bxcan::Register::rf0r, 1), 1);
  print("a frame that is not for the board, heard",
        cost([] { static_cast<void>(node.overhear(base::Time{})); }));
  print("a turn with one frame of eight bytes and a time stamp", turn());
  usart_memory[0] = usart::sr::txe;
  print("a character to the host, interrupt", interrupt());
  drain();
  print("a turn with nothing to do", turn());
  const can::Frame sample{.id = 0x608, .dlc = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
  const std::uint32_t alone = cost([&] { bridge.hear(sample, base::Time{}); });
  print("a frame of the board's own, heard", alone);
  static_cast<void>(turn());
  drain();
  in_can(bxcan::Register::tsr, 0x1C00'0000);
  usart_memory[0] = usart::sr::rxne;
  usart_memory[1] = 't';
  print("a character of the host, interrupt", interrupt());
  say("20881122334455667788\r");
  print("a turn with a frame of the host, for the board and the bus", turn());
  return node.next() && bridge.counters().from_host == 1 && bridge.counters().written == 2 ? 0 : 3;
}
