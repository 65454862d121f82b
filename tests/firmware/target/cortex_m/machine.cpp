/// The machines of QEMU that run the tests, as far as they matter: a core, flash, RAM, and semihosting as the
/// way out. Vectors, start-up, what newlib asks of a system, and the test runner.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sys/types.h>

#include <catch2/catch.hpp>

// From the linker script.
extern "C" {
extern std::uint32_t ocm_bss_begin[], ocm_bss_end[], ocm_stack_top[];
extern char ocm_heap_begin[], ocm_heap_end[];
extern void (*__init_array_start[])();
extern void (*__init_array_end[])();
}

namespace {

/// [Semihosting for AArch32 and AArch64, 2.1: the operation in r0, its argument in r1]
std::uint32_t semihosting(std::uint32_t operation, const void* argument) noexcept {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

[[noreturn]] void leave(int code) noexcept {
  constexpr std::uint32_t exit_extended = 0x20;
  constexpr std::uint32_t application_exit = 0x20026;
  const std::uint32_t block[] = {application_exit, static_cast<std::uint32_t>(code)};
  semihosting(exit_extended, block);
  for (;;) {
  }
}

[[noreturn]] void give_up(std::string_view why) noexcept {
  ocm::target::Out{} << "given up: " << why << '\n';
  leave(2);
}

int failed_checks = 0;
int checks = 0;

/// One stack for all: the processor's main one.
extern "C" [[noreturn]] void ocm_start() {
#if defined(__ARM_FP)
  *reinterpret_cast<volatile std::uint32_t*>(0xE000'ED88) |= 0xFU
                                                             << 20;  // CPACR: FPU on [ARMv7-M ARM, B3.2.20]
  asm volatile("dsb\n isb");
#endif
  for (std::uint32_t* word = ocm_bss_begin; word != ocm_bss_end; ++word) *word = 0;
  for (auto init = __init_array_start; init != __init_array_end; ++init) (*init)();
  leave(ocm::target::TestCase::run_all());
}
extern "C" void ocm_fault() {
  give_up("hard fault");
}

/// QEMU loads initial values to where they belong: nothing to copy.
[[gnu::section(".vectors"), gnu::used]] const struct {
  const void* stack;
  void (*handlers[15])();
} vectors{ocm_stack_top,
          {ocm_start, ocm_fault, ocm_fault, ocm_fault, ocm_fault, ocm_fault, ocm_fault, ocm_fault, ocm_fault,
           ocm_fault, ocm_fault, ocm_fault, ocm_fault, ocm_fault, ocm_fault}};

}  // namespace

namespace ocm::target {

Out& Out::operator<<(std::string_view text) noexcept {
  constexpr std::uint32_t write_character = 0x03;
  for (const char c : text) semihosting(write_character, &c);
  return *this;
}

void check(bool holds, Severity severity, std::string_view expression, std::string_view file, int line) {
  ++checks;
  if (holds) return;
  ++failed_checks;
  Out out;
  out << file << ':' << line << ": " << expression << '\n';
  Note::tell_all(out);
  if (severity == Severity::require) give_up("a REQUIRE does not hold");
}

int TestCase::run_all() {
  int cases = 0;
  int failed = 0;
  Out out;
  for (const TestCase* one = last_; one != nullptr; one = one->before_) {
    const int before = failed_checks;
    Section::run_each(one->body_);
    ++cases;
    if (failed_checks == before) continue;
    ++failed;
    out << "failed: " << one->name_ << '\n';
  }
  out << cases << " test cases, " << checks << " checks, " << failed << " failed\n";
  return cases == 0 ? 2 : failed == 0 ? 0 : 1;  // a program without tests has not passed them
}

}  // namespace ocm::target

// --- what the libraries ask of a system --------------------------------------------------------------------
extern "C" {

void* _sbrk(std::ptrdiff_t more) {
  static char* end = ocm_heap_begin;
  if (more > ocm_heap_end - end) return reinterpret_cast<void*>(-1);
  char* begin = end;
  end += more;
  return begin;
}
void abort() {
  give_up("abort");
}
void _exit(int code) {
  leave(code);
}
[[noreturn]] void __cxa_pure_virtual() {
  give_up("a pure virtual function was called");
}

// A Cortex-M0 has no atomic read-modify-write, and GCC calls these. There is one context here.
#if !defined(__ARM_FEATURE_LDREX)
unsigned __atomic_fetch_add_4(volatile void* at, unsigned n, int) {
  auto* number = static_cast<volatile unsigned*>(at);
  const unsigned before = *number;
  *number = before + n;
  return before;
}
#endif
std::uint64_t __atomic_load_8(const volatile void* at, int) {
  return *static_cast<const volatile std::uint64_t*>(at);
}
void __atomic_store_8(volatile void* at, std::uint64_t value, int) {
  *static_cast<volatile std::uint64_t*>(at) = value;
}
}

void* operator new(std::size_t size) {
  if (void* p = std::malloc(size)) return p;
  give_up("no memory");
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
