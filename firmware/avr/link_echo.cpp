// The line protocol on the AVR robot's processor: ATmega1284P at 20 MHz, the dongle on USART0 at 38400 baud,
// its pin 19 on PB2, low: connected. [Thesis 2, pinout; ATmega1284P data sheet 8272E]
#include "firmware/avr/link_echo.hpp"

#include <array>
#include <avr/interrupt.h>
#include <avr/io.h>
#include <cstddef>
#include <cstdint>

#ifndef F_CPU
#error "F_CPU: the clock in Hz"
#endif

namespace {

constexpr std::uint32_t baud = 38'400;
constexpr std::uint16_t baud_divisor = (F_CPU + 4 * baud) / (8 * baud) - 1;  // at double speed [20.11, U2X]
constexpr std::uint16_t ms_counts = F_CPU / 8 / 1000;
constexpr std::uint8_t dongle_pin = 1 << PB2;

/// Bytes between the interrupt and main(): one writes, one reads, indices of one byte each.
class Ring {
 public:
  void put(std::uint8_t byte) {
    const auto next = static_cast<std::uint8_t>((end_ + 1) % bytes_.size());
    if (next == begin_) {
      lost_ = static_cast<std::uint16_t>(lost_ + 1);
      return;
    }
    bytes_[end_] = byte;
    end_ = next;
  }
  bool take(std::uint8_t& byte) {
    if (begin_ == end_) return false;
    byte = bytes_[begin_];
    begin_ = static_cast<std::uint8_t>((begin_ + 1) % bytes_.size());
    return true;
  }

 private:
  std::array<volatile std::uint8_t, 128> bytes_{};
  volatile std::uint8_t begin_ = 0;
  volatile std::uint8_t end_ = 0;
  volatile std::uint16_t lost_ = 0;
};

volatile std::uint32_t ms = 0;

std::uint32_t now_ms() {
  const std::uint8_t status = SREG;
  cli();
  const std::uint32_t now = ms;
  SREG = status;
  return now;
}

void start() {
  UCSR0A = 1 << U2X0;  // before the divisor: simavr looks at it only then
  UBRR0 = baud_divisor;
  UCSR0C = 1 << UCSZ01 | 1 << UCSZ00;  // 8 data bits, no parity, one stop bit
  UCSR0B = 1 << RXCIE0 | 1 << RXEN0 | 1 << TXEN0;
  TCCR1B = 1 << WGM12;  // clear on compare
  OCR1A = ms_counts - 1;
  TCCR1B = 1 << WGM12 | 1 << CS11;  // clock / 8
  TIMSK1 = 1 << OCIE1A;
  PORTB = dongle_pin;  // pulled up: no dongle is not connected
  sei();
}

}  // namespace

// What a debugger, or the simulator, looks at.
ocm::firmware::avr::LinkEcho echo;
Ring received;

// avr/interrupt.h's ISR() has an attribute that clang does not know; and without a hosted implementation
// clang gives main() a C++ name.
extern "C" {

[[gnu::signal, gnu::used]] void USART0_RX_vect() {
  received.put(UDR0);
}
[[gnu::signal, gnu::used]] void TIMER1_COMPA_vect() {
  ms = ms + 1;
}

int main() {
  start();
  ocm::mapper::link::Packet packet;
  std::uint8_t sent = 0;
  for (;;) {
    std::uint8_t byte = 0;
    if (received.take(byte)) echo.receive(byte);
    echo.tick(now_ms(), (PINB & dongle_pin) == 0);
    if ((UCSR0A & 1 << UDRE0) == 0) continue;
    if (sent == packet.size) {
      const auto next = echo.take();
      if (!next) continue;
      packet = *next;
      sent = 0;
    }
    UDR0 = packet.data[sent++];
  }
}
}
