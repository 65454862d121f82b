/// Instructions that a call takes, on QEMU's netduino2 with -icount shift=0, where an instruction takes a
/// nanosecond and TIM2 counts nanoseconds.
#pragma once

#include <cstdint>

namespace {

// [RM0033, 15.4: TIM2 of the STM32F205]
volatile std::uint32_t& tim2_cr1 = *reinterpret_cast<volatile std::uint32_t*>(0x40000000);
volatile std::uint32_t& tim2_cnt = *reinterpret_cast<volatile std::uint32_t*>(0x40000024);

std::uint32_t empty = 0;  // what reading the counter twice costs

template <class F>
[[gnu::noinline]] std::uint32_t cost(F call) {
  const std::uint32_t begin = tim2_cnt;
  asm volatile("" ::: "memory");
  call();
  asm volatile("" ::: "memory");
  return tim2_cnt - begin - empty;
}

}  // namespace
