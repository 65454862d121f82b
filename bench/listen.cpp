/// How long `amiroctl listen` takes for a million frames of the virtual bus, in each format, beside its own
/// CPU time and what it lost: a server and a sender here, the tool as a process that writes to /dev/null.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <spawn.h>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>

#include "ocm/protocol/message.hpp"
#include "ocm/simulation/virtual_bus_server.hpp"
#include "ocm/topics/amiro.hpp"
#include "ocm/transport/virtual_bus.hpp"

extern char** environ;  // NOLINT: POSIX names it so

using namespace ocm;
using SteadyClock = std::chrono::steady_clock;

namespace {

/// Serves a bus that is much faster than a socket, until told to end.
class Server {
 public:
  explicit Server(const std::string& path)
      : server_(simulation::VirtualBusServer::open({.path = path, .bit_rate = 1'000'000'000})) {
    if (server_) thread_ = std::thread{[this] { serve(); }};
  }
  ~Server() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] bool running() const { return server_.ok(); }

 private:
  void serve() {
    const auto start = SteadyClock::now();
    while (!over_) {
      server_.value->poll(base::Time{SteadyClock::now() - start});
      pollfd input{server_.value->descriptor(), POLLIN, 0};
      const bool busy = server_.value->next_event() != base::never;
      ::poll(&input, 1, busy ? 0 : 1);
    }
  }
  transport::Outcome<std::unique_ptr<simulation::VirtualBusServer>> server_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

/// Starts `amiroctl --bus sim:PATH listen FORMAT -n FRAMES`, writing to /dev/null.
pid_t start_listening(const std::string& tool, const std::string& path, const char* format,
                      const std::string& count) {
  std::string bus = "sim:" + path;
  std::string program = tool;
  std::string form = format;
  std::string number = count;
  std::string words[] = {"--bus", "listen", "-n", "--timeout", "100s"};
  char* arguments[] = {program.data(),  words[0].data(), bus.data(),      words[1].data(), form.data(),
                       words[2].data(), number.data(),   words[3].data(), words[4].data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = -1;
  if (::posix_spawn(&process, program.c_str(), &actions, nullptr, arguments, environ) != 0) process = -1;
  posix_spawn_file_actions_destroy(&actions);
  return process;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string frames = argc > 1 ? argv[1] : "1000000";
  const char* build = std::getenv("OCM_BUILD");
  const std::string tool = std::string{build != nullptr ? build : "build"} + "/amiroctl";
  std::string folder = (std::filesystem::temp_directory_path() / "ocm-bench-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return 1;
  const std::string path = folder + "/sim.sock";
  bool failed = false;
  for (const char* format : {"--raw", "--json", "--csv", "--pretty"}) {
    const Server server{path};
    auto sender =
        server.running()
            ? transport::VirtualBus::open(path)
            : transport::Outcome<std::unique_ptr<transport::VirtualBus>>{transport::Failure{"no server", ""}};
    const pid_t listener = sender ? start_listening(tool, path, format, frames) : -1;
    if (listener < 0) {
      std::fprintf(stderr, "listen: cannot start %s\n", tool.c_str());
      failed = true;
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{300});  // it connects
    const auto start = SteadyClock::now();
    int status = 0;
    rusage used{};
    amiro::Gyroscope sample;
    std::uint64_t sent = 0;
    while (::wait4(listener, &status, WNOHANG, &used) == 0) {
      for (int i = 0; i < 1000; ++i) {  // until it has what it waits for; a sender without room tries again
        ++sample.x;
        const auto taken = (*sender)->send(protocol::sample_frame(sample));
        if (taken && *taken) ++sent;
      }
    }
    const double seconds = std::chrono::duration<double>(SteadyClock::now() - start).count();
    const auto cpu = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) / 1e6;
    };
    const double frame_count = std::strtod(frames.c_str(), nullptr);
    std::printf("listen %-8s %s frames in %.2f s, %.0f frames/s; its CPU %.2f us a frame; %llu sent\n",
                format, frames.c_str(), seconds, frame_count / seconds,
                (cpu(used.ru_utime) + cpu(used.ru_stime)) / frame_count * 1e6,
                static_cast<unsigned long long>(sent));
    failed |= status != 0;
  }
  std::filesystem::remove_all(folder);
  return failed ? 1 : 0;
}
