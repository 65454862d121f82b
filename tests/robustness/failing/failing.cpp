/// Loaded before a program (LD_PRELOAD), makes the N-th call of one kind fail, and tells how many there were.
///
///     OCM_FAIL=file:ENOSPC:3 LD_PRELOAD=libfailing.so amiroctl convert a.log b.csv
///
/// Kinds: `file` (what reaches a file or a folder for writing: open, write, fallocate, ftruncate, fdatasync,
/// fsync, rename, unlink, close, mkstemp), `sync` (fdatasync and fsync alone) and `memory` (malloc and what
/// is built on it; fails from the N-th call on when the number has a + after it). The total goes to the file
/// OCM_FAIL_CALLS at the end.
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
}

namespace {

enum class Kind : char { none, file, sync, memory };

struct Plan {
  Kind kind = Kind::none;
  int error = 0;
  long number = 0;
  bool from_then_on = false;
};

std::atomic<long> calls{0};
std::atomic<bool> ready{false};
Plan plan;

void read_plan() {
  const char* text = std::getenv("OCM_FAIL");
  if (text == nullptr) return;
  plan.kind = std::strncmp(text, "memory", 6) == 0 ? Kind::memory
              : std::strncmp(text, "sync", 4) == 0 ? Kind::sync
                                                   : Kind::file;
  const char* const error = std::strchr(text, ':');
  if (error == nullptr) return;
  plan.error = std::strncmp(error, ":ENOSPC", 7) == 0 ? ENOSPC
               : std::strncmp(error, ":EIO", 4) == 0  ? EIO
                                                      : ENOMEM;
  char* rest = nullptr;
  const char* const number = std::strchr(error + 1, ':');
  if (number == nullptr) return;
  plan.number = std::strtol(number + 1, &rest, 10);
  plan.from_then_on = *rest == '+';
  ready = true;
}

__attribute__((destructor)) void tell() {
  const char* const path = std::getenv("OCM_FAIL_CALLS");
  if (path == nullptr) return;
  const auto report = ::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  char text[32];
  const int length = std::snprintf(text, sizeof text, "%ld\n", calls.load());
  if (::syscall(SYS_write, report, text, length) < 0) return;
}

bool fails(Kind kind) {
  if (!ready || kind != plan.kind) return false;
  const long number = ++calls;
  if (number != plan.number && !(plan.from_then_on && number > plan.number)) return false;
  errno = plan.error;
  return true;
}

/// What a program says to people, and its sockets, are left alone.
bool is_file(int descriptor) {
  if (descriptor == STDERR_FILENO) return false;
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

bool for_writing(int flags) {
  return (flags & O_ACCMODE) != O_RDONLY;
}

using Main = int (*)(int, char**, char**);
Main real_main = nullptr;

/// What fails before main, in the initialisers of libraries, no program can say.
int main_by_plan(int argc, char** argv, char** environment) {
  read_plan();
  return real_main(argc, argv, environment);
}

}  // namespace

extern "C" {

int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(), void (*linker_fini)(),
                      void* stack_end) {
  using Start = int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
  real_main = main;
  return next<Start>("__libc_start_main")(main_by_plan, argc, argv, init, fini, linker_fini, stack_end);
}

void* malloc(std::size_t size) {
  return fails(Kind::memory) ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  return fails(Kind::memory) ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  return fails(Kind::memory) ? nullptr : __libc_realloc(old, size);
}

ssize_t write(int file, const void* bytes, std::size_t size) {
  if (!is_file(file) || !fails(Kind::file)) return ::syscall(SYS_write, file, bytes, size);
  // A full disk takes a part first.
  if (plan.error == ENOSPC && size > 1) {
    const auto taken = ::syscall(SYS_write, file, bytes, size / 2);
    plan.number = calls + 1;
    if (taken >= 0) return taken;
  }
  errno = plan.error;
  return -1;
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if (for_writing(flags) && fails(Kind::file)) return -1;
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return open(path, flags, mode);
}

int fallocate(int file, int how, off_t from, off_t size) {
  return fails(Kind::file) ? -1 : static_cast<int>(::syscall(SYS_fallocate, file, how, from, size));
}
int fallocate64(int file, int how, off64_t from, off64_t size) {
  return fallocate(file, how, from, size);
}
int ftruncate(int file, off_t size) __THROW {
  return fails(Kind::file) ? -1 : static_cast<int>(::syscall(SYS_ftruncate, file, size));
}
int ftruncate64(int file, off64_t size) __THROW {
  return ftruncate(file, size);
}
int fsync(int file) {
  return fails(Kind::file) || fails(Kind::sync) ? -1 : static_cast<int>(::syscall(SYS_fsync, file));
}
int fdatasync(int file) {
  return fails(Kind::file) || fails(Kind::sync) ? -1 : static_cast<int>(::syscall(SYS_fdatasync, file));
}
int rename(const char* from, const char* to) __THROW {
  return fails(Kind::file) ? -1 : static_cast<int>(::syscall(SYS_rename, from, to));
}
int unlink(const char* path) __THROW {
  return fails(Kind::file) ? -1 : static_cast<int>(::syscall(SYS_unlink, path));
}
int mkstemp(char* name) {
  static const auto real = next<int (*)(char*)>("mkstemp");
  return fails(Kind::file) ? -1 : real(name);
}
int close(int file) {
  struct stat status {};
  const bool counts = ready && plan.kind == Kind::file && ::fstat(file, &status) == 0 &&
                      S_ISREG(status.st_mode) && for_writing(::fcntl(file, F_GETFL));
  const auto result = static_cast<int>(::syscall(SYS_close, file));  // closed in any case, as Linux does
  return counts && fails(Kind::file) ? -1 : result;
}

}  // extern "C"
