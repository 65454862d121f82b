/// In place of the chip's: the registers at an address are what a test has attached there.
#pragma once

#include <cstdint>
#include <map>

#include "firmware/drivers/registers.hpp"

namespace ocm::stm32_tests {

/// The registers of one part, by their offsets.
struct PlayedRegisters {
  virtual ~PlayedRegisters() = default;
  virtual std::uint32_t read(std::uint32_t offset) = 0;
  virtual void write(std::uint32_t offset, std::uint32_t value) = 0;
};
inline std::map<std::uintptr_t, PlayedRegisters*> played_registers;

/// Registers at an address, for as long as it lives.
class Attached {
 public:
  Attached(std::uintptr_t address, PlayedRegisters& registers) : address_(address) {
    played_registers[address] = &registers;
  }
  ~Attached() { played_registers.erase(address_); }
  Attached(const Attached&) = delete;
  Attached& operator=(const Attached&) = delete;

 private:
  std::uintptr_t address_;
};

}  // namespace ocm::stm32_tests

namespace ocm::firmware::drivers {

template <class Register>
class MappedRegisters {
 public:
  constexpr explicit MappedRegisters(std::uintptr_t base) noexcept : base_(base) {}
  [[nodiscard]] std::uint32_t read(Register which) const noexcept {
    return stm32_tests::played_registers.at(base_)->read(static_cast<std::uint32_t>(which));
  }
  void write(Register which, std::uint32_t value) const noexcept {
    stm32_tests::played_registers.at(base_)->write(static_cast<std::uint32_t>(which), value);
  }

 private:
  std::uintptr_t base_;
};

}  // namespace ocm::firmware::drivers
