/// Which signals the threads of this program take.
#pragma once

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>

namespace ocm::test {

/// What each thread of this program keeps away, by its number: bit 0 is signal 1.
inline std::map<std::string, std::uint64_t> kept_away() {
  constexpr std::string_view what = "SigBlk:";
  std::map<std::string, std::uint64_t> threads;
  for (const auto& thread : std::filesystem::directory_iterator{"/proc/self/task"}) {
    std::ifstream status{thread.path() / "status"};
    for (std::string line; std::getline(status, line);)
      if (line.starts_with(what))
        threads[thread.path().filename().string()] = std::stoull(line.substr(what.size()), nullptr, 16);
  }
  return threads;
}

/// Whether such a thread keeps away the signals that end a program, and those of its windows and children.
inline bool keeps_all_away(std::uint64_t signals) {
  const auto ends = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP, SIGCONT, SIGWINCH, SIGCHLD, SIGUSR1};
  return std::all_of(ends.begin(), ends.end(), [&](int each) { return (signals >> (each - 1) & 1) == 1; });
}

}  // namespace ocm::test
