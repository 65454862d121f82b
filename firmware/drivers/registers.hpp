/// What drivers ask of registers of 32 bits: a chip's (mapped_registers.hpp), or a test's model of them.
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

}  // namespace ocm::firmware::drivers
