/// A server behind one central: its commands (central_client.hpp) and its robots (fleet.hpp) on one line.
/// Bytes in, bytes out, time handed in; what the fleet has to say goes through the client.
///
/// O(1) a byte. Host only.
#pragma once

#include <algorithm>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "ocm/cognitive/fleet.hpp"
#include "ocm/mapper/server/central_client.hpp"

namespace ocm::cognitive {

class Server {
 public:
  explicit Server(const FleetOptions& fleet = {}, const mapper::server::CentralClientOptions& client = {})
      : client_(within(client)), fleet_(fleet) {}

  /// Bytes from the central. `heard(robot, kind)` after each whole sentence of a robot.
  template <class Heard>
  void feed(std::string_view bytes, base::Time now, Heard&& heard) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {  // byte by byte: words of a link come before its end
      client_.feed(bytes.substr(i, 1), now);
      take_events(now);
      fleet_.feed(client_.take_robots(), now, heard);
    }
    expire(now);
  }
  void feed(std::string_view bytes, base::Time now) {
    feed(bytes, now, [](std::size_t, mapper::link::Kind) {});
  }
  /// Time-outs, and what is to be said, once or again. At `deadline()`, after each request, and each 50 ms.
  void expire(base::Time now) {
    fleet_.expire(now);
    while (auto saying = fleet_.take())
      if (!client_.say(static_cast<unsigned>(saying->robot), std::move(saying->words))) {
        ++unsaid_;
        fleet_.out(saying->robot, now);  // as if the air had lost it
      }
    client_.expire(now);
    take_events(now);
  }
  [[nodiscard]] base::Time deadline() const noexcept { return client_.deadline(); }
  /// What goes to the central.
  [[nodiscard]] std::string take() { return client_.take(); }
  /// What became of requests and links; the fleet knows already.
  [[nodiscard]] std::optional<mapper::server::CentralEvent> next_event() {
    if (events_.empty()) return std::nullopt;
    mapper::server::CentralEvent event = std::move(events_.front());
    events_.pop_front();
    return event;
  }

  [[nodiscard]] mapper::server::CentralClient& client() noexcept { return client_; }
  [[nodiscard]] const mapper::server::CentralClient& client() const noexcept { return client_; }
  [[nodiscard]] Fleet& fleet() noexcept { return fleet_; }
  [[nodiscard]] const Fleet& fleet() const noexcept { return fleet_; }
  /// Words for which the queue had no room.
  [[nodiscard]] std::uint32_t unsaid() const noexcept { return unsaid_; }

 private:
  /// Of more robots than it has room for the fleet would not know.
  static mapper::server::CentralClientOptions within(mapper::server::CentralClientOptions options) {
    options.most_robots = std::min(options.most_robots, static_cast<unsigned>(Fleet::most_robots));
    return options;
  }
  void take_events(base::Time now) {
    while (auto event = client_.next_event()) {
      const mapper::server::Peer* const peer = client_.peer(event->index);
      if (event->kind == mapper::server::CentralEvent::Kind::connected)
        fleet_.linked(event->index, peer != nullptr ? std::string_view{peer->name} : std::string_view{"?"},
                      now);
      if (event->kind == mapper::server::CentralEvent::Kind::lost) fleet_.unlinked(event->index);
      const bool said = event->kind == mapper::server::CentralEvent::Kind::said;
      if (said || event->saying) fleet_.out(event->index, now);
      if (!said) events_.push_back(std::move(*event));
    }
  }

  mapper::server::CentralClient client_;
  Fleet fleet_;
  std::deque<mapper::server::CentralEvent> events_;
  std::uint32_t unsaid_ = 0;
};

}  // namespace ocm::cognitive
