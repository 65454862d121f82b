// The guest kernel sets the floating-point registers of its processes through 2,696 bytes, which hold all up
// to AVX-512 and protection keys. A processor with AMX has more, and there Linux refuses to set a part of
// them (xstateregs_set() in arch/x86/kernel/fpu/regset.c: EFAULT). scripts/guest loads this before the guest
// kernel: the part that it gives is laid over all that the process has. Beyond it are AMX's tiles, for which
// a program must ask the kernel; the guest's has no such call.
#include <array>
#include <cstdint>
#include <cstring>
#include <dlfcn.h>
#include <elf.h>
#include <linux/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

extern "C" long ptrace(int request, pid_t process, void* address, void* data) {
  static auto* const of_libc = reinterpret_cast<decltype(&ptrace)>(dlsym(RTLD_NEXT, "ptrace"));
  if (request == PTRACE_SETREGSET && reinterpret_cast<std::uintptr_t>(address) == NT_X86_XSTATE) {
    const auto& given = *static_cast<const iovec*>(data);
    static std::array<char, 1 << 16> bytes;
    iovec whole{bytes.data(), bytes.size()};
    if (of_libc(PTRACE_GETREGSET, process, address, &whole) < 0) return -1;
    if (given.iov_len < whole.iov_len) {
      std::memcpy(bytes.data(), given.iov_base, given.iov_len);
      return of_libc(request, process, address, &whole);
    }
  }
  return of_libc(request, process, address, data);
}
