#include "firmware/stm32/fixture.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <sys/mman.h>

#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/port.hpp"

NVIC_Type played_nvic;
SCB_Type played_scb;
SysTick_Type played_systick;
DBGMCU_TypeDef played_dbgmcu;

// Where the program begins, for the linker; its address means nothing here.
extern "C" {
extern const std::uint32_t _vectors[1];
const std::uint32_t _vectors[1] = {0};
}

namespace ocm::stm32_tests {

Chip* chip = nullptr;
std::jmp_buf the_end;

namespace {

/// Memory at that address, zeros.
void map(std::uintptr_t address, std::size_t size) {
  void* const wanted = reinterpret_cast<void*>(address);
  static std::vector<void*> mapped;
  if (std::find(mapped.begin(), mapped.end(), wanted) == mapped.end()) {
    if (mmap(wanted, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1,
             0) != wanted) {
      std::perror("the chip's registers");
      std::exit(1);
    }
    mapped.push_back(wanted);
  }
  std::memset(wanted, 0, size);
}

}  // namespace

Chip::Chip() {
  map(PERIPH_BASE, 0x4'0000);  // all that the boards use: APB1 first, then APB2, RCC and the ports
  map(FLASH_BASE, 0x1000);     // the bootloader's table, without its magic number
  std::memset(const_cast<std::uint32_t*>(NVIC->ISER), 0, sizeof played_nvic);
  SCB->ICSR = 0;
  SysTick->CTRL = 7;
  std::memset(&played_dbgmcu, 0, sizeof played_dbgmcu);
  chip = this;
}
std::size_t Chip::count(const std::string& call) const {
  return static_cast<std::size_t>(std::count(calls.begin(), calls.end(), call));
}

namespace {

void say(std::string call) {
  chip->calls.push_back(std::move(call));
}
/// Jumps over no object that has something to do at its end: what is said is said before.
[[noreturn]] void end() {
  std::longjmp(the_end, 1);
}
std::string name(ioportid_t port, std::uint8_t pad) {
  const auto number = (reinterpret_cast<std::uintptr_t>(port) - GPIOA_BASE) / (GPIOB_BASE - GPIOA_BASE);
  return static_cast<char>('A' + number) + std::to_string(pad);
}
/// The next answer of the bus.
msg_t answer() {
  if (chip->answers.empty()) return MSG_OK;
  const msg_t first = chip->answers.front();
  chip->answers.erase(chip->answers.begin());
  return first;
}
void receive(std::uint8_t* in, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) in[i] = i < chip->received.size() ? chip->received[i] : 0;
}

}  // namespace
}  // namespace ocm::stm32_tests

using namespace ocm::stm32_tests;

namespace ocm::firmware::chibios {
void bring_to_rest() noexcept {
  say("rest");
}
void rest_and_restart(ResetCause cause, std::uint32_t /*where*/) noexcept {
  say("rest and restart " + std::to_string(static_cast<int>(cause)));
  end();
}
base::Time Port::now() noexcept {
  return chip->now;
}
bool Signal::wait(base::Duration timeout) noexcept {
  if (std::exchange(raised_, false)) return true;
  if (chip->waits_left-- == 0) end();
  chip->now += timeout;
  return false;
}
ResetCause take_noted_cause() noexcept {
  return std::exchange(chip->noted, ResetCause::unknown);
}
}  // namespace ocm::firmware::chibios

void __disable_irq() {
  say("interrupts off");
}
void __enable_irq() {
  say("interrupts on");
}
void NVIC_SystemReset() {
  say("reset");
  end();
}
void nvicEnableVector(std::uint32_t number, std::uint32_t priority) {
  NVIC->ISER[number / 32] |= 1U << number % 32;
  chip->priorities.at(number) = priority;
}
void rccResetCAN1() {
  ++chip->resets;
}
void chSysInit() {
  say("kernel");
}
void chThdSleepMicroseconds(std::uint32_t us) {
  say("sleep " + std::to_string(us));
}
void palInit(const PALConfig* /*config*/) {
  say("pins");
}
void dmaInit() {
  say("dma");
}
void i2cInit() {
  say("i2c");
}
void spiInit() {
  say("spi");
}
void stInit() {
  say("timer");
}
extern "C" void stm32_clock_init() {
  say("clock");
}

void palWritePad(ioportid_t port, std::uint8_t pad, std::uint8_t level) {
  say(name(port, pad) + (level != 0 ? " high" : " low"));
}
std::uint8_t palReadPad(ioportid_t port, std::uint8_t pad) {
  return (port->IDR & 1U << pad) != 0 ? 1 : 0;
}
void palSetPadMode(ioportid_t port, std::uint8_t pad, iomode_t mode) {
  say(name(port, pad) + " mode " + std::to_string(mode));
}

void i2cStart(I2CDriver* driver, const I2CConfig* config) {
  say("start");
  driver->config = config;
}
void i2cStop(I2CDriver* driver) {
  say("stop");
  driver->config = nullptr;
}
i2cflags_t i2cGetErrors(I2CDriver* /*driver*/) {
  return chip->errors;
}
msg_t i2cMasterTransmitTimeout(I2CDriver* /*driver*/, std::uint8_t address, const std::uint8_t* out,
                               std::size_t out_size, std::uint8_t* in, std::size_t in_size,
                               systime_t timeout) {
  std::string call = "to " + std::to_string(address) + " write";
  for (std::size_t i = 0; i < out_size; ++i) call += " " + std::to_string(out[i]);
  say(call + ", read " + std::to_string(in_size) + " within " + std::to_string(timeout));
  receive(in, in_size);
  return answer();
}
msg_t i2cMasterReceiveTimeout(I2CDriver* /*driver*/, std::uint8_t address, std::uint8_t* in,
                              std::size_t in_size, systime_t timeout) {
  say("to " + std::to_string(address) + " read " + std::to_string(in_size) + " within " +
      std::to_string(timeout));
  receive(in, in_size);
  return answer();
}

void spiStart(SPIDriver* driver, const SPIConfig* config) {
  say("start");
  driver->config = config;
  driver->last = *config;
}
void spiStop(SPIDriver* driver) {
  say("stop");
  driver->config = nullptr;
}
void spiSelect(SPIDriver* driver) {
  say(name(driver->config->port, driver->config->pad) + " low");
}
void spiUnselect(SPIDriver* driver) {
  say(name(driver->config->port, driver->config->pad) + " high");
}
void spiExchange(SPIDriver* /*driver*/, std::size_t size, const void* out, void* in) {
  std::string call = "exchange";
  for (std::size_t i = 0; i < size; ++i)
    call += " " + std::to_string(static_cast<const std::uint8_t*>(out)[i]);
  say(std::move(call));
  receive(static_cast<std::uint8_t*>(in), size);
}
