/// An operator of a bus that a test plays, for programs that ask it what it does, several at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <thread>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"

#include "cli/shared/operator_link.hpp"
#include "unit/host/host_testing.hpp"

namespace ocm::test {

/// "end" it answers by hanging up.
class PlayedOperator {
 public:
  /// `answers`: to what begins so, others than those of one that runs.
  explicit PlayedOperator(std::string_view bus, std::map<std::string, std::string> answers = {})
      : answers_(std::move(answers)), listener_(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)) {
    answers_.merge(std::map<std::string, std::string>{{"hello ", "ok\nguard"},
                                                      {"status json", "ok\n{\"asked\":\"status\"}"},
                                                      {"why json", "ok\n{\"asked\":\"why\"}"}});
    REQUIRE(::mkdir(folder_.file("ocm").c_str(), 0700) == 0);
    const std::string path = cli::operator_path(bus);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    REQUIRE(path.size() < sizeof address.sun_path);
    std::copy(path.begin(), path.end(), std::begin(address.sun_path));
    REQUIRE(::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(::listen(listener_.get(), 4) == 0);
    accepts_ = std::thread{[this] { accept(); }};
  }
  ~PlayedOperator() { end(); }
  PlayedOperator(const PlayedOperator&) = delete;
  PlayedOperator& operator=(const PlayedOperator&) = delete;

  void end() {
    if (!accepts_.joinable()) return;
    ::shutdown(listener_.get(), SHUT_RDWR);  // no more are taken
    accepts_.join();
    for (const host::Descriptor& caller : callers_) ::shutdown(caller.get(), SHUT_RDWR);
    for (std::thread& each : serves_) each.join();
    listener_.reset();
  }

 private:
  void accept() {
    for (;;) {
      host::Descriptor caller{::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC)};
      if (!caller) return;
      serves_.emplace_back([this, descriptor = caller.get()] { serve(descriptor); });
      callers_.push_back(std::move(caller));
    }
  }
  void serve(int caller) const {
    std::string request(1000, '\0');
    for (ssize_t size = 0; (size = ::recv(caller, request.data(), request.size(), 0)) > 0;) {
      const std::string_view asked{request.data(), static_cast<std::size_t>(size)};
      if (asked == "end") break;
      const auto known = std::find_if(answers_.begin(), answers_.end(),
                                      [&](const auto& each) { return asked.starts_with(each.first); });
      const std::string said = known != answers_.end() ? known->second : "ok\n0";
      static_cast<void>(::send(caller, said.data(), said.size(), MSG_NOSIGNAL));
    }
    ::shutdown(caller, SHUT_RDWR);
  }

  TemporaryDirectory folder_;  ///< of its user
  Environment runtime_{"XDG_RUNTIME_DIR", folder_.path().c_str()};
  std::map<std::string, std::string> answers_;
  host::Descriptor listener_;
  std::vector<host::Descriptor> callers_;
  std::vector<std::thread> serves_;
  std::thread accepts_;
};

}  // namespace ocm::test
