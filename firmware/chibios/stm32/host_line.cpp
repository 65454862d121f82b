#include "firmware/chibios/stm32/host_line.hpp"

#include "ocm/can/slcan_codec.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/chibios/stm32/board_signals.hpp"

namespace ocm::firmware::chibios::stm32 {
namespace {

// There is one line, and one bus behind it. Nullptr until they have started.
constinit HostLine* host_line = nullptr;
constinit CanBus* bus = nullptr;

// Behind the CAN controller's others (can_bus.cpp): what is for the board comes first.
constexpr std::uint32_t interrupt_priority = 12;

/// Of the bus's bit rate and no other: the robot has one.
constexpr can::slcan::AdapterInfo info{
    .hardware = 0x11,  // [AMiRo-OS boards/DiWheelDrive, version 1.1]
    .software = 0x10,
    .serial = {'D', 'I', 'W', 'D'},
    .bit_rates = 1U << *can::slcan::bit_rate_code(amiro::catalogue.bit_rate),
};

}  // namespace

HostLine::HostLine(Port& port, CanBus& can) noexcept
    : can_(&can), line_(drivers::usart::MappedRegisters{USART1_BASE}, BusOfHost{can}, port, info) {}

void HostLine::start() noexcept {
  can_->attach({[](void* self, const can::Frame& frame, base::Time now) noexcept {
                  static_cast<HostLine*>(self)->line_.hear(frame, now);
                },
                this});
  host_line = this;
  bus = can_;
  line_.start(prog_clock_hz, prog_bit_rate);
  share_programming_uart([] { host_line->on_interrupt(); });
  nvicEnableVector(STM32_CAN1_RX1_NUMBER, interrupt_priority);
}

void HostLine::on_interrupt() noexcept {
  line_.on_interrupt([](std::uint8_t byte) { heed(byte); });
}

}  // namespace ocm::firmware::chibios::stm32

// C++ would mangle the names, and the vectors would lead nowhere.
extern "C" {

OSAL_IRQ_HANDLER(STM32_CAN1_RX1_HANDLER) {
  OSAL_IRQ_PROLOGUE();
  ocm::firmware::chibios::stm32::bus->on_overhear();
  OSAL_IRQ_EPILOGUE();
}

}  // extern "C"
