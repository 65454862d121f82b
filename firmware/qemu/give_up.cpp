// What an image does that is no board of the robot's (the mapper, tests) and cannot go on: it says why and
// ends QEMU. The boards restart instead: restart.cpp.
#include <ch.h>

#include "firmware/qemu/machine.hpp"

namespace ocm::firmware::qemu {
namespace {

constinit void (*last_words)(const char*) = nullptr;

// Locked for good, so that last words may call what locks.
[[noreturn]] void give_up(const char* reason, int code) noexcept {
  __set_BASEPRI(CORTEX_BASEPRI_KERNEL);
  void (*const words)(const char*) = last_words;
  last_words = nullptr;  // a fault in them is the end
  if (words != nullptr) words(reason);
  leave(reason, code);
}

}  // namespace

void before_giving_up(void (*words)(const char* reason)) noexcept {
  last_words = words;
}

}  // namespace ocm::firmware::qemu

extern "C" {
void HardFault_Handler() {
  ocm::firmware::qemu::give_up("hard fault", 3);
}
void ocm_halted(const char* reason) {
  ocm::firmware::qemu::give_up(reason != nullptr ? reason : "the kernel halted", 2);
}
void abort() {
  ocm::firmware::qemu::give_up("abort", 4);
}
}
