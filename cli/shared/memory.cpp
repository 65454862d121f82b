#include "cli/shared/memory.hpp"

#include <cstdio>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "cli/shared/messages.hpp"

namespace ocm::cli {

void keep_memory() noexcept {
#ifdef __GLIBC__
  constexpr int mebibyte = 1024 * 1024;
  ::mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);
  ::mallopt(M_TRIM_THRESHOLD, 64 * mebibyte);
  ::mallopt(M_TOP_PAD, mebibyte);
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
