/// What the tool says, and where it ends, when there is no memory.
#pragma once

#include <new>

namespace ocm::cli {

/// The allocator keeps what it has: a process that lives for milliseconds, and begins by building a large
/// spec, would give memory back and fetch it again, page by page. 16 MiB of addresses; memory is taken when
/// it is used, up to 2 MiB more than that. First of all in main.
void keep_memory() noexcept;

/// The message, on stderr. Takes no memory itself.
void say_out_of_memory() noexcept;

/// As long as this lives, an allocation that fails ends the program with the message and exit_failure, and
/// throws nothing. For documents of JSON, which are read before anything is begun: nlohmann::json takes
/// memory while it is destroyed, and destroys what it has only half made, so that it survives no
/// std::bad_alloc.
class EndsWithoutMemory {
 public:
  EndsWithoutMemory() noexcept;
  EndsWithoutMemory(const EndsWithoutMemory&) = delete;
  EndsWithoutMemory& operator=(const EndsWithoutMemory&) = delete;
  ~EndsWithoutMemory() { std::set_new_handler(before_); }

 private:
  std::new_handler before_;
};

}  // namespace ocm::cli
