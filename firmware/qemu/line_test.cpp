// DiWheelDrive with a host on its serial line, as on its own chip: the driver of the USART, the bridge and
// its thread below the levels. Played are what QEMU lacks: the CAN bus with its other boards, the pace of a
// line at 115200 bit/s and the USART's transmit interrupt. tests/firmware/qemu/test_line.py is the host.
//
// The other boards obey two frames of the host's: 7F0#nnnnuuuu, send n frames, one each u microseconds
// (little-endian), numbered from 0, with identifiers 6A0 and, each fourth, an extended one; 7F1#ssff, the
// bus's states are s, and it has been lost f times.
#include <algorithm>
#include <array>
#include <cstdint>

#include "ocm/analysis/board_admission.hpp"
#include "ocm/base/fixed_vector.hpp"
#include "ocm/can/length.hpp"
#include "ocm/can/slcan_bridge.hpp"
#include "ocm/controller/report.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/di_wheel_drive/board.hpp"
#include "firmware/boards/di_wheel_drive/costs.hpp"
#include "firmware/boards/di_wheel_drive/parts.hpp"
#include "firmware/chibios/load.hpp"
#include "firmware/chibios/port.hpp"
#include "firmware/chibios/slcan_line.hpp"
#include "firmware/chibios/stm32/bootloader.hpp"
#include "firmware/drivers/bxcan_filter.hpp"
#include "firmware/drivers/usart.hpp"
#include "firmware/qemu/machine.hpp"
#include "firmware/qemu/parts_link.hpp"

namespace {

namespace base = ocm::base;
namespace can = ocm::can;
namespace chibios = ocm::firmware::chibios;
namespace qemu = ocm::firmware::qemu;
namespace usart = ocm::firmware::drivers::usart;
namespace bxcan = ocm::firmware::drivers::bxcan;
namespace di_wheel_drive = ocm::firmware::boards::di_wheel_drive;
namespace wiring = di_wheel_drive::wiring;
using ocm::protocol::Identifier;

constexpr std::uint32_t bit_rate = 115'200;
constexpr std::uint32_t clock_hz = 15'000'000;  // QEMU does not look at it

/// USART1 with the pace of its line. It hands over up to `burst_us` of characters at a time, since a timer a
/// character is more than an emulator keeps up with. With the lock held.
class PacedUsart {
 public:
  std::uint32_t read(usart::Register which) noexcept {
    switch (which) {
      case usart::Register::sr:
        return (USART1->SR & ~(send_.open() ? 0 : usart::sr::txe) & ~(receive_.open() ? 0 : usart::sr::rxne));
      case usart::Register::dr: {
        const std::uint32_t byte = USART1->DR;
        receive_.pass();
        settle();
        return byte;
      }
      default:
        return 0;
    }
  }
  void write(usart::Register which, std::uint32_t value) noexcept {
    if (which == usart::Register::brr) USART1->BRR = value;
    if (which == usart::Register::cr1) cr1_ = value;
    if (which == usart::Register::dr) {
      USART1->DR = value;
      send_.pass();
    }
    settle();
  }

 private:
  static constexpr std::uint32_t burst_us = 1000;

  class Pace {
   public:
    [[nodiscard]] bool open() noexcept {
      const std::uint32_t now = TIM2->CNT;
      if (static_cast<std::int32_t>(now - free_) > 0) free_ = now;
      return free_ - now < burst_us;
    }
    void pass() noexcept { free_ += 10 * 1'000'000 / bit_rate; }

   private:
    std::uint32_t free_ = 0;  ///< when all that passed is over the line
  };

  /// The interrupts that are due, now or when the line has carried something.
  void settle() noexcept {
    const bool receives = receive_.open();  // once: time goes on meanwhile
    const bool sends = (cr1_ & usart::cr1::txeie) != 0;
    const bool may_send = send_.open();
    USART1->CR1 = cr1_ & ~usart::cr1::txeie & ~(receives ? 0 : usart::cr1::rxneie);
    if (sends && may_send) NVIC_SetPendingIRQ(USART1_IRQn);
    if ((sends && !may_send) || !receives) chVTSetI(&timer_, burst_us / 2, &again, this);
  }
  static void again(void* self) {
    const chibios::Lock lock;
    static_cast<PacedUsart*>(self)->settle();
  }

  Pace send_;
  Pace receive_;
  std::uint32_t cr1_ = 0;
  virtual_timer_t timer_{};
};

constinit PacedUsart paced_usart;

struct PacedRegisters {
  std::uint32_t read(usart::Register which) noexcept { return paced_usart.read(which); }
  void write(usart::Register which, std::uint32_t value) noexcept { paced_usart.write(which, value); }
};

/// The robot's bus: frames take their bits at 500 kbit/s, the most urgent is next, three places a level.
class PlayedBus {
 public:
  explicit PlayedBus(chibios::Port& port) noexcept : port_(&port) {}
  PlayedBus(const PlayedBus&) = delete;
  PlayedBus& operator=(const PlayedBus&) = delete;

  // the board's
  base::Result<bool> send(const can::Frame& frame) noexcept {
    const chibios::Lock lock;
    const auto taken = load(frame);
    if (taken.ok() && *taken) hear(frame);
    return taken;
  }
  chibios::BusEvent wait(can::Frame& frame) noexcept {
    for (;;) {
      {
        const chibios::Lock lock;
        if (!received_.empty()) {
          frame = received_[0];
          received_.erase(0);
          return chibios::BusEvent::frame;
        }
        if (writable_) {
          writable_ = false;
          return chibios::BusEvent::writable;
        }
      }
      signal_.wait();
    }
  }

  // the host's
  void attach(void (*ear)(const can::Frame&, base::Time)) noexcept { hear_ = ear; }
  [[nodiscard]] bool board_has_room(const can::Frame& frame) const noexcept {
    return !received_.full() || !filters.accepts(frame);
  }
  base::Result<bool> load_of_host(const can::Frame& frame) noexcept {
    const auto taken = load(frame);
    if (taken.ok() && *taken) obey(frame);
    return taken;
  }
  void deliver(const can::Frame& frame) noexcept {
    if (!filters.accepts(frame)) return;
    static_cast<void>(received_.push_back(frame));
    signal_.raise_locked();
  }
  [[nodiscard]] can::slcan::BusCondition condition() const noexcept { return condition_; }
  void listen(bool all) noexcept {
    const chibios::Lock lock;
    listening_ = all;
  }

 private:
  static constexpr auto filters = bxcan::wide_filter_banks_of<amiro::DiWheelDrive>();
  static constexpr std::uint32_t play_frames = 0x7F0;
  static constexpr std::uint32_t play_condition = 0x7F1;

  base::Result<bool> load(const can::Frame& frame) noexcept {
    if (const auto valid = can::validate(frame); !valid) return valid.error;
    if (frame.format != can::Format::base) return base::Error::bad_identifier;
    const auto level = [](const can::Frame& f) { return Identifier::decode(f.id).priority; };
    if (std::ranges::count_if(waiting_, [&](const can::Frame& f) { return level(f) == level(frame); }) >= 3)
      return false;
    static_cast<void>(waiting_.push_back(frame));
    begin_frame();
    return true;
  }
  void begin_frame() noexcept {
    if (busy_ || waiting_.empty()) return;
    const auto first = std::ranges::min_element(
        waiting_, {}, [](const can::Frame& frame) { return can::arbitration_key(frame); });
    const auto bits = static_cast<systime_t>(can::frame_bits(*first));
    waiting_.erase(static_cast<std::size_t>(first - waiting_.begin()));
    busy_ = true;
    writable_ = true;
    signal_.raise_locked();
    chVTSetI(
        &on_wire_, 2 * bits,
        [](void* self) {
          const chibios::Lock lock;
          auto& bus = *static_cast<PlayedBus*>(self);
          bus.busy_ = false;
          bus.begin_frame();
        },
        this);
  }
  void hear(const can::Frame& frame) noexcept {
    if (listening_) hear_(frame, port_->now());
  }

  // --- the other boards ---

  void obey(const can::Frame& frame) noexcept {
    const auto word = [&frame](std::size_t at) {
      return static_cast<std::uint32_t>(frame.data[at] | frame.data[at + 1] << 8);
    };
    if (frame.id == play_condition && frame.dlc == 2) {
      condition_.states = frame.data[0];
      condition_.faults += frame.data[1];
    }
    if (frame.id != play_frames || frame.dlc != 4) return;
    played_ = 0;
    to_play_ = word(0);
    gap_us_ = word(2);
    play_next();
  }
  void play_next() noexcept {
    if (played_ == to_play_) return;
    chVTSetI(
        &next_, std::max<systime_t>(static_cast<systime_t>(gap_us_), 20),
        [](void* self) {
          const chibios::Lock lock;
          auto& bus = *static_cast<PlayedBus*>(self);
          can::Frame frame{.id = 0x6A0, .dlc = 8, .data = {}, .format = can::Format::base};
          if (bus.played_ % 4 == 3) {
            frame.id = 0x1234'5678;
            frame.format = can::Format::extended;
          }
          for (std::size_t i = 0; i < 4; ++i) frame.data[i] = static_cast<std::uint8_t>(bus.played_ >> 8 * i);
          ++bus.played_;
          bus.hear(frame);
          bus.play_next();
        },
        this);
  }

  chibios::Port* port_;
  void (*hear_)(const can::Frame&, base::Time) = nullptr;
  base::FixedVector<can::Frame, 12> waiting_;
  base::FixedVector<can::Frame, 16> received_;
  bool busy_ = false;
  bool writable_ = false;
  bool listening_ = false;
  chibios::Signal signal_;
  virtual_timer_t on_wire_{};
  can::slcan::BusCondition condition_;
  std::uint32_t played_ = 0;
  std::uint32_t to_play_ = 0;
  std::uint32_t gap_us_ = 0;
  virtual_timer_t next_{};
};

/// can::slcan::BridgedBus
class BusOfHost {
 public:
  explicit BusOfHost(PlayedBus& bus) noexcept : bus_(&bus) {}
  [[nodiscard]] bool board_has_room(const can::Frame& frame) const noexcept {
    return bus_->board_has_room(frame);
  }
  base::Result<bool> send(const can::Frame& frame) noexcept { return bus_->load_of_host(frame); }
  void deliver(const can::Frame& frame) noexcept { bus_->deliver(frame); }
  [[nodiscard]] can::slcan::BusCondition condition() const noexcept { return bus_->condition(); }
  void listen(bool all) noexcept { bus_->listen(all); }

 private:
  PlayedBus* bus_;
};

using Line = chibios::SlcanLine<PacedRegisters, BusOfHost>;
constinit Line* host_line = nullptr;
constinit chibios::stm32::ConnectDetector connect;

void on_interrupt(void* /*object*/) {
  host_line->on_interrupt([](std::uint8_t byte) {
    if (connect.feed(byte)) qemu::leave("into the bootloader", 0);
  });
}

}  // namespace

int main() {
  qemu::start_machine();
  static qemu::Uart parts_line{qemu::PartsLink::uart_number};
  static chibios::Port port;
  static PlayedBus bus{port};
  static qemu::PartsLink link{parts_line};
  link.start();
  static qemu::LinkI2c compass{link, wiring::compass_i2c};
  static qemu::LinkI2c floor{link, wiring::floor_i2c};
  static qemu::LinkSpi gyroscope{link, wiring::gyroscope_spi};
  static qemu::LinkSpi accelerometer{link, wiring::accelerometer_spi};
  static qemu::LinkMotorTimers motors{link};
  static qemu::LinkOutputs pins{link, 0};
  using Parts = di_wheel_drive::Parts<qemu::LinkI2c, qemu::LinkI2c, qemu::LinkSpi, qemu::LinkSpi,
                                      qemu::LinkMotorTimers, qemu::LinkOutputs, chibios::Mutex>;
  static Parts parts{compass, floor, gyroscope, accelerometer, motors, pins};

  static Line line{
      PacedRegisters{},
      BusOfHost{bus},
      port,
      {.hardware = 0x11, .software = 0x10, .serial = {'D', 'I', 'W', 'D'}, .bit_rates = 1U << 6}};
  host_line = &line;
  bus.attach([](const can::Frame& frame, base::Time now) { host_line->hear(frame, now); });
  static qemu::UartRegisters registers{1};
  registers.start(&on_interrupt, nullptr);
  line.start(clock_hz, bit_rate);
  registers.write(std::array<std::uint8_t, 1>{'\r'});  // for the test: from now on it listens
  parts.start(port.now());

  using Admission =
      ocm::analysis::BoardAdmission<amiro::DiWheelDrive, amiro::bit_rate, di_wheel_drive::Costs>;
  static di_wheel_drive::Board<Parts, PlayedBus, chibios::Port, Admission> board{parts, bus, port};
  static chibios::LoadMeter load{port};
  board.controller().report([] {
    ocm::controller::Health health;
    health.load = load.percent();
    health.line_lost = line.lost();
    return health;
  });
  static chibios::Runtime runtime{port, board.controller(), bus};
  runtime.run([](base::Time now) {
    load.look(now);
    board.maintain(now);
  });
}
