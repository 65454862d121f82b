#include "cli/serve/address.hpp"

#include <array>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

#include "cli/shared/messages.hpp"

extern char** environ;  // NOLINT: POSIX has it so

namespace ocm::cli::serve {

void open_in_browser(const std::string& address) {
  const auto has = [](const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  if (!has("DISPLAY") && !has("WAYLAND_DISPLAY"))
    return remark("serve: there is no display: open the address in a browser elsewhere");
  std::string program = "xdg-open", argument = address;
  std::array<char*, 3> arguments{program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  pid_t process = 0;
  const int error = ::posix_spawnp(&process, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    return remark(
        fmt::format("serve: xdg-open cannot be started: {}; open the address by hand", std::strerror(error)));
  std::thread{[process] { ::waitpid(process, nullptr, 0); }}.detach();
}

}  // namespace ocm::cli::serve
