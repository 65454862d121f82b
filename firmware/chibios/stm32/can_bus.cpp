#include "firmware/chibios/stm32/can_bus.hpp"

#include <chrono>
#include <hal.h>

namespace ocm::firmware::chibios::stm32 {
namespace {

// There is one controller. Nullptr until it has started.
constinit CanBus* bus = nullptr;

constexpr base::Duration watch_period = std::chrono::milliseconds{10};
constexpr std::uint32_t interrupt_priority = 11;  // below the kernel's timer, which is 8

}  // namespace

base::Status CanBus::start(Port& port, const can::BitTiming& timing,
                           const drivers::bxcan::FilterBanks& filters) noexcept {
  port_ = &port;
  rccEnableCAN1(FALSE);
  rccResetCAN1();  // the bootloader had it
  bus = this;
  {
    const Lock lock;
    if (const auto started = node_.start(timing, filters); !started.ok()) return started;
  }
  nvicEnableVector(STM32_CAN1_TX_NUMBER, interrupt_priority);
  nvicEnableVector(STM32_CAN1_RX0_NUMBER, interrupt_priority);
  nvicEnableVector(STM32_CAN1_SCE_NUMBER, interrupt_priority);
  return {};
}

base::Result<bool> CanBus::send(const can::Frame& frame) noexcept {
  const Lock lock;
  const auto taken = node_.send(frame, now_if_heard());
  if (taken.ok() && !*taken) refused_ = true;
  return taken;
}

BusEvent CanBus::wait(can::Frame& frame) noexcept {
  for (;;) {
    {
      const Lock lock;
      if (lost_) {
        lost_ = false;
        return BusEvent::lost;
      }
      if (const auto received = node_.next()) {
        frame = *received;
        return BusEvent::frame;
      }
      if (writable_) {
        writable_ = false;
        return BusEvent::writable;
      }
    }
    static_cast<void>(signal_.wait(watch_period));
    watch();
  }
}

drivers::bxcan::Counters CanBus::counters() noexcept {
  const Lock lock;
  return node_.controller().counters();
}

drivers::bxcan::BusErrors CanBus::errors() noexcept {
  const Lock lock;
  return node_.controller().errors();
}

std::uint32_t CanBus::missed() noexcept {
  const Lock lock;
  return node_.missed();
}

void CanBus::on_transmit() noexcept {
  const Lock lock;
  const std::size_t waiting = node_.controller().waiting();
  node_.controller().on_transmit();
  room_again(waiting);
}

// Frames that were given up make room too, and then no transmit interrupt says so.
void CanBus::room_again(std::size_t waited) noexcept {
  if (!refused_ || node_.controller().waiting() >= waited) return;
  refused_ = false;
  writable_ = true;
  signal_.raise_locked();
}

void CanBus::on_receive() noexcept {
  const Lock lock;
  node_.on_receive(now_if_heard());
  signal_.raise_locked();
}

// Between frames the lock is let go: what is more urgent waits for one frame only.
void CanBus::on_overhear() noexcept {
  const base::Time now = port_->now();
  for (std::size_t n = 0; n < drivers::bxcan::receive_depth; ++n) {
    const Lock lock;
    if (!node_.overhear(now)) return;
  }
}

void CanBus::listen(bool all) noexcept {
  const Lock lock;
  node_.listen(all);
}

void CanBus::deliver(const can::Frame& frame) noexcept {
  if (node_.deliver(frame)) signal_.raise_locked();
}

void CanBus::on_status_change() noexcept {
  watch();
}

void CanBus::watch() noexcept {
  const base::Time now = port_->now();
  const Lock lock;
  const std::size_t waiting = node_.controller().waiting();
  if (node_.controller().watch(now)) {
    lost_ = true;
    signal_.raise_locked();
  }
  room_again(waiting);
}

}  // namespace ocm::firmware::chibios::stm32

using ocm::firmware::chibios::stm32::bus;

// C++ would mangle the names, and the vectors would lead nowhere.
extern "C" {

OSAL_IRQ_HANDLER(STM32_CAN1_TX_HANDLER) {
  OSAL_IRQ_PROLOGUE();
  bus->on_transmit();
  OSAL_IRQ_EPILOGUE();
}

OSAL_IRQ_HANDLER(STM32_CAN1_RX0_HANDLER) {
  OSAL_IRQ_PROLOGUE();
  bus->on_receive();
  OSAL_IRQ_EPILOGUE();
}

OSAL_IRQ_HANDLER(STM32_CAN1_SCE_HANDLER) {
  OSAL_IRQ_PROLOGUE();
  bus->on_status_change();
  OSAL_IRQ_EPILOGUE();
}

}  // extern "C"
