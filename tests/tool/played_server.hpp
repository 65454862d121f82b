/// A server on a local socket that a test plays, for programs that ask one (cli/shared/local_link.hpp).
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <thread>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

namespace ocm::test {

/// Answers each request in turn as its list says; "" is silence, and at the end of the list it closes. With
/// an empty list it takes none. What it heard is known once it has ended.
class PlayedServer {
 public:
  /// When it answers: `ahead`, all of it behind the first request, so that a program that asks never waits
  /// for it, and no patience is too short on a busy machine; `late`, 100 ms behind each request.
  enum class Says : std::uint8_t { in_turn, ahead, late };

  PlayedServer(const std::string& path, std::vector<std::string> answers, Says says = Says::in_turn)
      : says_(says), listener_(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof address.sun_path);
    std::copy(path.begin(), path.end(), std::begin(address.sun_path));
    REQUIRE(::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(::listen(listener_.get(), 1) == 0);
    if (!answers.empty()) plays_ = std::thread{[this, list = std::move(answers)] { play(list); }};
  }
  ~PlayedServer() { end(); }
  PlayedServer(const PlayedServer&) = delete;
  PlayedServer& operator=(const PlayedServer&) = delete;

  const std::vector<std::string>& end() {
    if (plays_.joinable()) plays_.join();
    return heard_;
  }

 private:
  void play(const std::vector<std::string>& answers) {
    const host::Descriptor socket{::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC)};
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if ((i == 0 || says_ != Says::ahead) && !take(socket)) return;
      if (says_ == Says::late)
        std::this_thread::sleep_for(std::chrono::milliseconds{100});  // late is what it plays
      if (answers[i].empty())
        while (take(socket)) {
        }
      static_cast<void>(::send(socket.get(), answers[i].data(), answers[i].size(), MSG_NOSIGNAL));
    }
    for (std::size_t i = 1; i < answers.size() && says_ == Says::ahead && take(socket); ++i) {
    }
  }
  bool take(const host::Descriptor& socket) {
    std::string text(1000, '\0');
    const auto size = ::recv(socket.get(), text.data(), text.size(), 0);
    if (size <= 0) return false;
    heard_.push_back(text.substr(0, static_cast<std::size_t>(size)));
    return true;
  }

  Says says_;
  host::Descriptor listener_;
  std::thread plays_;
  std::vector<std::string> heard_;
};

}  // namespace ocm::test
