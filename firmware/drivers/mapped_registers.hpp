/// Registers of 32 bits of a chip. Tests have models in their place.
#pragma once

#include <cstdint>

#include "firmware/drivers/registers.hpp"

namespace ocm::firmware::drivers {

/// The registers of a chip, mapped at `base`.
template <class Register>
class MappedRegisters {
 public:
  constexpr explicit MappedRegisters(std::uintptr_t base) noexcept : base_(base) {}
  [[nodiscard]] std::uint32_t read(Register which) const noexcept { return *at(which); }
  void write(Register which, std::uint32_t value) const noexcept { *at(which) = value; }

 private:
  [[nodiscard]] volatile std::uint32_t* at(Register which) const noexcept {
    return reinterpret_cast<volatile std::uint32_t*>(base_ + static_cast<std::uintptr_t>(which));
  }
  std::uintptr_t base_;
};

}  // namespace ocm::firmware::drivers
