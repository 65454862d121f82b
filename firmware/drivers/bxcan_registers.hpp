/// The registers of bxCAN, the CAN controller of the STM32F1 and F4, and how a driver reaches them: through
/// memory on a chip, through a model on a host. Both chips have the same block; the F405 has two that share
/// 28 filter banks, of which bank 14 is where CAN2's begin after reset. [RM0008 24.9, RM0090 32.9]
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "firmware/drivers/mapped_registers.hpp"

namespace ocm::firmware::drivers::bxcan {

inline constexpr std::size_t mailboxes = 3;
inline constexpr std::size_t receive_depth = 3;  ///< frames in a receive FIFO [RM0008 24.7.3]
inline constexpr std::size_t filter_banks = 14;  ///< of CAN1, on both chips [RM0008 24.9.5, RM0090 32.9.5]

/// Offset of a register from the controller's base. [RM0008 table 182]
enum class Register : std::uint16_t {
  mcr = 0x000,  ///< master control
  msr = 0x004,  ///< master status
  tsr = 0x008,  ///< transmit status
  rf0r = 0x00C,
  rf1r = 0x010,
  ier = 0x014,  ///< interrupt enable
  esr = 0x018,  ///< error status
  btr = 0x01C,  ///< bit timing
  tir = 0x180,  ///< mailbox 0: identifier; the next one is 0x10 further
  tdtr = 0x184,
  tdlr = 0x188,
  tdhr = 0x18C,
  rir = 0x1B0,  ///< receive FIFO 0; FIFO 1 is 0x10 further
  rdtr = 0x1B4,
  rdlr = 0x1B8,
  rdhr = 0x1BC,
  fmr = 0x200,   ///< filter master
  fm1r = 0x204,  ///< 1: list, 0: mask
  fs1r = 0x20C,  ///< 1: one of 32 bits, 0: two of 16 bits
  ffa1r = 0x214,
  fa1r = 0x21C,
  fr1 = 0x240,  ///< bank 0, first half; the next bank is 8 further
  fr2 = 0x244,
};

/// The register of mailbox `n`, from that of mailbox 0.
[[nodiscard]] constexpr Register of_mailbox(Register first, std::size_t n) noexcept {
  return static_cast<Register>(static_cast<std::size_t>(first) + 0x10 * n);
}
/// The register of receive FIFO `n`, from that of FIFO 0: RFR or those of its first frame.
[[nodiscard]] constexpr Register of_fifo(Register first, std::size_t n) noexcept {
  return static_cast<Register>(static_cast<std::size_t>(first) + (first == Register::rf0r ? 0x4 : 0x10) * n);
}
/// The register of filter bank `n`, from that of bank 0.
[[nodiscard]] constexpr Register of_bank(Register first, std::size_t n) noexcept {
  return static_cast<Register>(static_cast<std::size_t>(first) + 0x8 * n);
}

namespace mcr {                                 // [RM0008 24.9.2]
inline constexpr std::uint32_t inrq = 1U << 0;  ///< initialisation requested
inline constexpr std::uint32_t sleep = 1U << 1;
inline constexpr std::uint32_t txfp = 1U
                                      << 2;  ///< mailboxes in the order of the requests, not of identifiers
inline constexpr std::uint32_t rflm = 1U << 3;  ///< full FIFO: 1 refuses the newest, 0 overwrites the last
inline constexpr std::uint32_t nart = 1U << 4;  ///< no retransmission
inline constexpr std::uint32_t abom = 1U << 6;  ///< bus-off is left without software
inline constexpr std::uint32_t reset = 1U << 15;
inline constexpr std::uint32_t dbf = 1U << 16;  ///< frozen while a debugger halts the core
}  // namespace mcr

namespace msr {  // [RM0008 24.9.2]
inline constexpr std::uint32_t inak = 1U << 0;
inline constexpr std::uint32_t slak = 1U << 1;
inline constexpr std::uint32_t erri = 1U << 2;  ///< write 1 to clear
}  // namespace msr

namespace tsr {                                 // [RM0008 24.9.2]; mailbox n: shifted left by 8 * n, TME by n
inline constexpr std::uint32_t rqcp = 1U << 0;  ///< the last request is done; 1 clears it and the next three
inline constexpr std::uint32_t txok = 1U << 1;  ///< ... and the frame was sent
inline constexpr std::uint32_t alst = 1U << 2;
inline constexpr std::uint32_t terr = 1U << 3;
inline constexpr std::uint32_t abrq = 1U << 7;  ///< write 1 to abort; writing 0 does nothing
inline constexpr std::uint32_t tme = 1U << 26;  ///< mailbox empty
[[nodiscard]] constexpr std::uint32_t at(std::uint32_t bit, std::size_t mailbox) noexcept {
  return bit << (bit == tme ? mailbox : 8 * mailbox);
}
}  // namespace tsr

namespace rfr {                          // [RM0008 24.9.2]
inline constexpr std::uint32_t fmp = 3;  ///< frames pending
inline constexpr std::uint32_t full = 1U << 3;
inline constexpr std::uint32_t fovr = 1U << 4;  ///< overrun; write 1 to clear
inline constexpr std::uint32_t rfom = 1U << 5;  ///< write 1 to release; reads 1 until it is done
}  // namespace rfr

namespace ier {  // [RM0008 24.9.2]
inline constexpr std::uint32_t tmeie = 1U << 0;
inline constexpr std::uint32_t fmpie0 = 1U << 1;
inline constexpr std::uint32_t fmpie1 = 1U << 4;
inline constexpr std::uint32_t epvie = 1U << 9;
inline constexpr std::uint32_t bofie = 1U << 10;
inline constexpr std::uint32_t errie = 1U << 15;
}  // namespace ier

namespace esr {  // [RM0008 24.9.2]
inline constexpr std::uint32_t ewgf = 1U << 0;
inline constexpr std::uint32_t epvf = 1U << 1;
inline constexpr std::uint32_t boff = 1U << 2;
inline constexpr unsigned lec_shift = 4;
inline constexpr unsigned tec_shift = 16;
inline constexpr unsigned rec_shift = 24;
}  // namespace esr

namespace tir {  // [RM0008 24.9.3]; the same places in RIR
inline constexpr std::uint32_t txrq = 1U << 0;
inline constexpr std::uint32_t rtr = 1U << 1;
inline constexpr std::uint32_t ide = 1U << 2;
inline constexpr unsigned base_id_shift = 21;
inline constexpr unsigned extended_id_shift = 3;
}  // namespace tir

namespace fmr {  // [RM0008 24.9.4]
inline constexpr std::uint32_t finit = 1U << 0;
}  // namespace fmr

/// Reads and writes of 32 bits. The controller works on between any two of them.
template <class R>
concept Registers = RegistersOf<R, Register>;
using MappedRegisters = drivers::MappedRegisters<Register>;
static_assert(Registers<MappedRegisters>);

}  // namespace ocm::firmware::drivers::bxcan
