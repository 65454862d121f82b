/// The USART of the STM32F1, F2 and F4 as a line of text that never waits: characters received and to be sent
/// are in rings, between a context and the interrupt. Eight bits, no parity, one stop bit, no flow control.
///
/// Where a character of the other end was lost or broken, one `spoilt` is in its place: what a protocol has
/// before and behind it is never taken for one line. Each cause has a counter.
///
/// Not DMA: on DiWheelDrive the channels of USART1 are those of I2C2 [RM0008 table 78]. An interrupt a
/// character each way, at 115200 bit/s at most 11520 a second.
///
/// Not reentrant: lock around each call. O(1); `write` O(characters).
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/drivers/mapped_registers.hpp"

namespace ocm::firmware::drivers::usart {

/// Offset of a register from the base. [RM0008 27.6, RM0033 24.6, RM0090 30.6]
enum class Register : std::uint16_t { sr = 0x00, dr = 0x04, brr = 0x08, cr1 = 0x0C };

namespace sr {
inline constexpr std::uint32_t pe = 1U << 0;
inline constexpr std::uint32_t fe = 1U << 1;
inline constexpr std::uint32_t ne = 1U << 2;
inline constexpr std::uint32_t ore = 1U << 3;  ///< what came after the character in DR is lost
inline constexpr std::uint32_t rxne = 1U << 5;
inline constexpr std::uint32_t txe = 1U << 7;
}  // namespace sr

namespace cr1 {
inline constexpr std::uint32_t re = 1U << 2;
inline constexpr std::uint32_t te = 1U << 3;
inline constexpr std::uint32_t rxneie = 1U << 5;  ///< of RXNE and of ORE
inline constexpr std::uint32_t txeie = 1U << 7;
inline constexpr std::uint32_t ue = 1U << 13;
}  // namespace cr1

template <class R>
concept Registers = RegistersOf<R, Register>;
using MappedRegisters = drivers::MappedRegisters<Register>;
static_assert(Registers<MappedRegisters>);

/// In place of what was lost: no protocol of text has it.
inline constexpr char spoilt = '\0';

/// One number a cause; they wrap around.
struct Counters {
  std::uint32_t received = 0;
  std::uint32_t sent = 0;
  std::uint32_t full = 0;      ///< received while the ring was full
  std::uint32_t overruns = 0;  ///< times that the interrupt came too late for a character
  std::uint32_t broken = 0;    ///< with a framing or noise error
  std::uint32_t unsent = 0;    ///< characters that `write` had no room for
  friend constexpr bool operator==(const Counters&, const Counters&) = default;
};

/// What an interrupt has done that its context waits for.
struct News {
  bool received = false;  ///< a line is complete, or the ring half full
  bool room = false;      ///< half of what was to be sent is gone
};

template <Registers R, std::size_t In = 256, std::size_t Out = 128>
class Line {
 public:
  constexpr explicit Line(R registers) noexcept : registers_(registers) {}

  /// Sets the line up and listens. `clock_hz` of the USART's bus. [RM0008 27.3.4: 16 times oversampled, BRR
  /// is the divided clock]
  void start(std::uint32_t clock_hz, std::uint32_t bit_rate) noexcept {
    registers_.write(Register::brr, (clock_hz + bit_rate / 2) / bit_rate);
    registers_.write(Register::cr1, listening);
  }

  /// In the interrupt. `heed(byte)` is called for each byte, as it came.
  template <class F>
  News on_interrupt(F heed) noexcept {
    News news;
    const std::uint32_t status = registers_.read(Register::sr);
    if ((status & (sr::rxne | sr::ore)) != 0) {
      // After SR: this clears the flags. Only then: a byte that comes between the two is not read away.
      const auto byte = static_cast<std::uint8_t>(registers_.read(Register::dr));
      if ((status & sr::rxne) != 0) {
        heed(byte);
        news.received = receive(byte, (status & (sr::fe | sr::ne)) != 0);
      }
      if ((status & sr::ore) != 0) {
        ++counters_.overruns;
        torn_ = true;
      }
    }
    if (sending_ && (status & sr::txe) != 0) news.room = send_next();
    return news;
  }

  /// The oldest character; false: nothing there.
  bool read(char& character) noexcept {
    if (in_size_ == 0) return false;
    character = in_[in_begin_];
    in_begin_ = (in_begin_ + 1) % In;
    --in_size_;
    return true;
  }
  /// Characters that `write` takes.
  [[nodiscard]] std::size_t room() const noexcept { return Out - out_size_; }
  void write(std::string_view text) noexcept {
    for (const char character : text) {
      if (out_size_ == Out) {
        ++counters_.unsent;
        continue;
      }
      out_[(out_begin_ + out_size_++) % Out] = character;
    }
    if (sending_ || out_size_ == 0) return;
    sending_ = true;
    registers_.write(Register::cr1, listening | cr1::txeie);
  }

  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
  /// Characters of the other end that were lost or broken.
  [[nodiscard]] std::uint32_t lost() const noexcept {
    return counters_.full + counters_.overruns + counters_.broken;
  }

 private:
  static constexpr std::uint32_t listening = cr1::ue | cr1::te | cr1::re | cr1::rxneie;

  /// True: there is something to do.
  bool receive(std::uint8_t byte, bool broken) noexcept {
    ++counters_.received;
    if (broken) ++counters_.broken;
    if (in_size_ == In) {
      ++counters_.full;
      torn_ = true;
      return true;
    }
    const char character = broken || torn_ ? spoilt : static_cast<char>(byte);
    torn_ = false;
    in_[(in_begin_ + in_size_++) % In] = character;
    return byte == '\r' || in_size_ >= In / 2;
  }

  /// True: so much is sent that more can be written.
  bool send_next() noexcept {
    if (out_size_ == 0) {
      sending_ = false;
      registers_.write(Register::cr1, listening);
      return false;
    }
    registers_.write(Register::dr, static_cast<std::uint8_t>(out_[out_begin_]));
    out_begin_ = (out_begin_ + 1) % Out;
    --out_size_;
    ++counters_.sent;
    return out_size_ == Out / 2;  // passed once on the way down
  }

  R registers_;
  std::array<char, In> in_{};
  std::size_t in_begin_ = 0;
  std::size_t in_size_ = 0;
  std::array<char, Out> out_{};
  std::size_t out_begin_ = 0;
  std::size_t out_size_ = 0;
  bool sending_ = false;  ///< the transmit interrupt is on
  bool torn_ = false;     ///< something was lost behind the last character
  Counters counters_;
};

}  // namespace ocm::firmware::drivers::usart
