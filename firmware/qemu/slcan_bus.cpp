#include "firmware/qemu/slcan_bus.hpp"

#include <algorithm>

#include "ocm/can/length.hpp"

namespace ocm::firmware::qemu {

namespace {

[[nodiscard]] systime_t ticks_on_wire(const can::Frame& frame) noexcept {
  constexpr std::uint32_t ticks_a_bit = CH_CFG_ST_FREQUENCY / SlcanBus::bit_rate;
  static_assert(ticks_a_bit * SlcanBus::bit_rate == CH_CFG_ST_FREQUENCY);
  return static_cast<systime_t>(can::frame_bits(frame) * ticks_a_bit);
}

}  // namespace

void SlcanBus::start() noexcept {
  for (const char character : std::string_view{"S6\rO\r"})
    static_cast<void>(adapter_.feed(character, inbox_));
  uart_->start(signal_);
  write("\r");
}

base::Result<bool> SlcanBus::send(const can::Frame& frame) noexcept {
  if (const auto valid = can::validate(frame); !valid) return valid.error;
  const auto level = [](const can::Frame& f) { return protocol::Identifier::decode(f.id).priority; };
  const auto same =
      std::ranges::count_if(waiting_, [&](const can::Frame& f) { return level(f) == level(frame); });
  if (same >= static_cast<std::ptrdiff_t>(places_a_level)) return false;
  static_cast<void>(waiting_.push_back(frame));
  begin_frame();
  return true;
}

// With the lock held.
void SlcanBus::begin_frame() noexcept {
  if (busy_ || waiting_.empty() || adapter_.channel() == can::slcan::Adapter::Channel::closed) return;
  const auto first = std::ranges::min_element(waiting_, {}, can::arbitration_key);  // the oldest of equals
  sending_ = *first;
  waiting_.erase(static_cast<std::size_t>(first - waiting_.begin()));
  busy_ = true;
  writable_ = true;
  signal_.raise_locked();
  chVTSetI(&timer_, ticks_on_wire(sending_), &frame_sent, this);
}

void SlcanBus::frame_sent(void* self) {
  auto& bus = *static_cast<SlcanBus*>(self);
  const chibios::Lock lock;
  bus.write(bus.adapter_.hear(bus.sending_, bus.port_->now()).view());
  bus.busy_ = false;
  bus.begin_frame();
}

void SlcanBus::write(std::string_view text) noexcept {
  uart_->write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

// True: a frame is in the inbox.
bool SlcanBus::take(std::uint8_t character) noexcept {
  const chibios::Lock lock;  // against frame_sent: neither adapter nor line is for two
  using Channel = can::slcan::Adapter::Channel;
  const bool was_open = adapter_.channel() != Channel::closed;
  write(adapter_.feed(static_cast<char>(character), inbox_).view());
  const bool is_open = adapter_.channel() != Channel::closed;
  if (was_open && !is_open) lost_ = true;
  if (!was_open && is_open) begin_frame();
  return inbox_.full;
}

chibios::BusEvent SlcanBus::wait(can::Frame& frame) noexcept {
  for (;;) {
    {
      const chibios::Lock lock;
      if (lost_) {
        lost_ = false;
        return chibios::BusEvent::lost;
      }
      if (writable_) {
        writable_ = false;
        return chibios::BusEvent::writable;
      }
    }
    std::uint8_t character = 0;
    if (!uart_->read(character)) {
      signal_.wait();
    } else if (take(character)) {
      frame = inbox_.frame;
      inbox_.full = false;
      return chibios::BusEvent::frame;
    }
  }
}

}  // namespace ocm::firmware::qemu
