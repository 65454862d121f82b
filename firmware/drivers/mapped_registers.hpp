/// Registers of 32 bits: what drivers ask of them, and those of a chip. Tests have models in their place.
#pragma once

#include <concepts>
#include <cstdint>

namespace ocm::firmware::drivers {

/// `Register`: an enum of the registers' offsets. What is behind them works on between any two accesses.
template <class R, class Register>
concept RegistersOf = requires(R& registers, Register which, std::uint32_t value) {
  { registers.read(which) } -> std::same_as<std::uint32_t>;
  registers.write(which, value);
};

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
