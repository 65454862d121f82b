/// A central, its radio and simple robots in virtual time, for tests of the server's side:
/// mapper::link::Central itself, links that take time to come, and can be cut, robots that shake hands and
/// send updates, and answers that get lost on the serial line.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/mapper/link/central.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"

namespace ocm::test {

class VirtualCentral {
 public:
  struct Robot {
    std::string name;
    mapper::link::Address address{};
    bool reachable = true;  ///< whether an attempt to connect succeeds
    bool advertises = true;
    bool linked = false;
    bool confirmed = false;
    unsigned updates = 0;
    std::vector<std::string> heard{};  ///< whole lines
    mapper::link::Update update{};
    base::Time spoke{};                 ///< its last sentence
    std::string line{};                 ///< from the central, so far
    std::optional<base::Time> comes{};  ///< when the link will be there
    std::optional<base::Time> goes{};   ///< or gone
  };
  std::vector<Robot> robots;
  std::string to_server;  ///< what the central said since the server last looked
  mapper::link::Central<8, 3, 8> central;
  base::Duration connecting = std::chrono::milliseconds{400};

  std::size_t add(std::string name) {
    const auto number = static_cast<std::uint8_t>(robots.size() + 1);
    robots.push_back({.name = std::move(name), .address = {0xC0, 0, 0, 0, 0, number}});
    return robots.size() - 1;
  }
  /// Bytes of the server.
  void write(std::string_view bytes) {
    for (const char c : bytes) central.feed(c, *this);
  }
  void cut(std::size_t i) {
    if (!robots[i].linked) return;
    end(robots[i]);
    central.closed(robots[i].address, *this);
  }

  void advance(base::Time time) {
    using namespace std::chrono_literals;
    now = time;
    for (Robot& robot : robots) {
      if (central.scanning() && robot.advertises && !robot.linked)
        central.found(robot.address, robot.name, *this);
      if (robot.goes && now >= *robot.goes) {
        end(robot);
        central.closed(robot.address, *this);
      }
      if (robot.comes && now >= *robot.comes) {
        robot.comes.reset();
        robot.linked = robot.reachable;
        robot.reachable ? central.connected(robot.address, *this) : central.closed(robot.address, *this);
      }
      if (!robot.linked) continue;
      while (const auto packet = central.take(robot.address)) listen(robot, packet->bytes());
      const bool due = now - robot.spoke >= (robot.confirmed ? 200ms : 1000ms);
      if (!due) continue;
      robot.spoke = now;
      if (!robot.confirmed) {
        speak(robot, "{H,15,20,0,3,0,90,180,270,2000,0}\n");
      } else {
        speak(robot, mapper::link::write(robot.update)->view());
        if (++robot.updates % 5 == 0) speak(robot, "{S,IDL}\n");  // it is at once where it should be
      }
    }
  }

  // --- what the central asks of its radio ---
  void say(std::string_view text) { to_server += text; }
  void start_scan() {}
  void stop_scan() {}
  void connect(const mapper::link::Address& address) { of(address).comes = now + connecting; }
  void disconnect(const mapper::link::Address& address) {
    of(address).comes.reset();
    of(address).goes = now + std::chrono::milliseconds{50};
  }
  void restart() {
    for (Robot& robot : robots) end(robot);
  }

  base::Time now{};

 private:
  Robot& of(const mapper::link::Address& address) {
    return *std::find_if(robots.begin(), robots.end(),
                         [&](const Robot& robot) { return robot.address == address; });
  }
  static void end(Robot& robot) {
    robot.linked = robot.confirmed = false;
    robot.line.clear();
    robot.comes.reset();
    robot.goes.reset();
  }
  void speak(const Robot& robot, std::string_view text) {
    while (!text.empty()) {
      const auto packet = mapper::link::take_packet(text);
      central.heard(robot.address, packet.bytes(), *this);
    }
  }
  /// It is at once where it should be.
  static void move(Robot& robot) {
    mapper::link::Reader reader{mapper::link::Direction::to_robot};
    for (const char c : robot.line)
      if (reader.feed(c) == mapper::link::Kind::set_point) {
        const auto by = reader.sentence().as<mapper::link::SetPoint>().value;
        const double heading = (robot.update.heading + by.angle) * 3.14159265358979 / 180;
        robot.update.heading = static_cast<std::int16_t>((robot.update.heading + by.angle) % 360);
        robot.update.x =
            static_cast<std::int16_t>(robot.update.x + std::lround(by.distance * std::cos(heading)));
        robot.update.y =
            static_cast<std::int16_t>(robot.update.y + std::lround(by.distance * std::sin(heading)));
      }
  }
  static void listen(Robot& robot, std::span<const std::uint8_t> bytes) {
    for (const std::uint8_t byte : bytes) {
      robot.line += static_cast<char>(byte);
      if (byte != '\n') continue;
      if (robot.line == "{S,CON}\n") robot.confirmed = true;
      move(robot);
      robot.heard.push_back(robot.line);
      robot.line.clear();
    }
  }
};

}  // namespace ocm::test
