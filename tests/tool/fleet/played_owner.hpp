/// The program that has a central's line, as a test has it answer, for programs that join it.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/fleet/joined_line.hpp"
#include "tests/tool/played_server.hpp"

namespace ocm::test {

/// With a socket that goes with it. It answers as its list says, ahead of what is asked, and then has ended.
class PlayedOwner {
 public:
  explicit PlayedOwner(std::vector<std::string> answers, PlayedServer::Says says = PlayedServer::Says::ahead)
      : server_(free_path(), std::move(answers), says) {}
  ~PlayedOwner() { std::filesystem::remove(path()); }
  PlayedOwner(const PlayedOwner&) = delete;
  PlayedOwner& operator=(const PlayedOwner&) = delete;

  /// Who joins knows it as "the owner (process 1234)".
  [[nodiscard]] static cli::fleet::JoinedLine joined(std::string_view verb = "goto") {
    auto link = cli::LocalLink::connect(path(), "the owner", verb, std::chrono::seconds{30});
    REQUIRE(link);
    REQUIRE(*link);
    return cli::fleet::JoinedLine{verb, std::move(*link)};
  }
  const std::vector<std::string>& heard() { return server_.end(); }

 private:
  static std::string path() {
    return (std::filesystem::temp_directory_path() / fmt::format("ocm-joined-{}.sock", ::getpid())).string();
  }

  /// Where a run that was killed has left its own.
  static std::string free_path() {
    std::filesystem::remove(path());
    return path();
  }

  PlayedServer server_;
};

}  // namespace ocm::test
