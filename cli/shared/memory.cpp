#include "cli/shared/memory.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#endif

#include "cli/shared/messages.hpp"

namespace ocm::cli {

void keep_memory() noexcept {
#ifdef __GLIBC__
  constexpr int mebibyte = 1024 * 1024;
  ::mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);
  ::mallopt(M_TRIM_THRESHOLD, 64 * mebibyte);
  ::mallopt(M_TOP_PAD, mebibyte);
  // Taken and given back, so that the allocator has it in one piece, which the kernel may make of pages of
  // 2 MiB: else each page of 4 KiB costs an interrupt, half of the time in which a large spec is loaded.
  constexpr std::size_t usual = std::size_t{16} * mebibyte;
  void* const heap = std::malloc(usual);
  if (heap == nullptr) return;
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  ::madvise(reinterpret_cast<void*>(reinterpret_cast<std::uintptr_t>(heap) / page * page), usual,
            MADV_HUGEPAGE);  // a kernel without them refuses, and nothing is lost
  std::free(heap);
#endif
}

void say_out_of_memory() noexcept {
  // Without fmt, which would need memory.
  std::fputs(
      "amiroctl: out of memory; what it was doing is not complete\n"
      "          end other programs, or raise the limit (ulimit -v), and try again\n",
      stderr);
}

EndsWithoutMemory::EndsWithoutMemory() noexcept
    : before_(std::set_new_handler([] {
        say_out_of_memory();
        ::_exit(exit_failure);
      })) {}

}  // namespace ocm::cli
