/// A fleet of mappers in virtual time: the world with their bodies, their applications, their dongles,
/// the radio and the central. A server at the other end of the central's line is all that is missing.
///
///     World world{model, {.seed = 7}};
///     Fleet fleet{world, Fleet::options_for(world, 7)};
///     fleet.write("start\n");
///     fleet.advance_to(now);                    // at next_event(), or when it pleases
///     const std::string text = fleet.read();    // "scanning\n"
///
/// Time is handed in; equal calls give equal fleets. Host only. A robot that drives and sends takes some 0.15
/// ms of a processor a second (`scripts/bench fleet`).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/link/central.hpp"
#include "ocm/simulation/dongle.hpp"
#include "ocm/simulation/radio.hpp"

#include "sim/mapper/running_robot.hpp"
#include "sim/mapper/world.hpp"

namespace ocm::sim::mapper {

struct FleetOptions {
  simulation::RadioModel radio;
  simulation::DongleModel dongle;
  bool calibrated = true;  ///< the robots' memories keep a calibration of their compasses
};

class Fleet {
 public:
  static constexpr std::size_t max_robots = 128;
  using Central = ocm::mapper::link::Central<max_robots, max_robots, 8>;
  using Dongle = simulation::Dongle<>;
  using Member = RunningRobot<Dongle>;

  /// The radio as the world has it, with a link for each robot.
  [[nodiscard]] static FleetOptions options_for(const World& world, std::uint64_t seed) {
    FleetOptions options;
    options.radio.range_m = world.model().central.range_m;
    options.radio.loss_at_range = world.model().central.loss_at_range;
    options.radio.links = world.size();
    options.radio.seed = seed;
    return options;
  }

  /// All robots of the world, of which there are at most `max_robots`: the rest has no application. They
  /// advertise at once.
  Fleet(World& world, const FleetOptions& options)
      : world_(world), now_(world.time()), radio_(options.radio) {
    radio_.place_central(place(world.model().central.place));
    const std::size_t robots = std::min(world.size(), max_robots);
    for (std::size_t i = 0; i < robots; ++i) {
      dongles_.push_back(std::make_unique<Dongle>(options.dongle));
      if (options.calibrated) calibrate(world.robot(i));
      members_.push_back(std::make_unique<Member>(world.robot(i), *dongles_.back(), now_));
      radio_.add(place(world.robot(i).pose().position()));
      radio_.advertise(i, true, now_);
    }
  }
  Fleet(const Fleet&) = delete;
  Fleet& operator=(const Fleet&) = delete;

  // --- the server's line ---

  /// From the server to the central, now.
  void write(std::string_view text) {
    for (const char c : text) central_.feed(c, *this);
  }
  /// From the central to the server: all that it has said since the last time.
  [[nodiscard]] std::string read() { return std::exchange(said_, {}); }

  // --- time ---

  /// All that happens until `now`; a time before the last is ignored.
  void advance_to(base::Time now) {
    for (base::Time next = next_event(); next <= now; next = next_event()) happen(std::max(next, now_));
    if (now > now_) happen(now);
  }
  /// When a robot or the central has something to do. Between two events the robots drive on as they did.
  [[nodiscard]] base::Time next_event() const noexcept {
    base::Time next = radio_.next_event();
    for (const auto& member : members_) next = std::min(next, member->next_event());
    return next;
  }
  [[nodiscard]] base::Time now() const noexcept { return now_; }

  // --- onlookers ---

  [[nodiscard]] std::size_t size() const noexcept { return members_.size(); }
  [[nodiscard]] Member& robot(std::size_t number) noexcept { return *members_[number]; }
  [[nodiscard]] const Dongle& dongle(std::size_t number) const noexcept { return *dongles_[number]; }
  [[nodiscard]] const simulation::Radio& radio() const noexcept { return radio_; }
  [[nodiscard]] const Central& central() const noexcept { return central_; }
  [[nodiscard]] const World& world() const noexcept { return world_; }

  // --- as the central's port (ocm::mapper::link::CentralPort); not for others ---

  void say(std::string_view text) { said_ += text; }
  void start_scan() { radio_.start_scan(now_); }
  void stop_scan() { radio_.stop_scan(); }
  void connect(const ocm::mapper::link::Address& address) { radio_.connect(number_of(address), now_); }
  void disconnect(const ocm::mapper::link::Address& address) { radio_.disconnect(number_of(address), now_); }
  void restart() { radio_.restart(); }

  // --- as the radio's user (simulation::RadioUser); not for others ---

  [[nodiscard]] base::Result<ocm::mapper::link::Packet> next_for_robot(std::size_t number) {
    return central_.take(address_of(number));
  }
  [[nodiscard]] base::Result<ocm::mapper::link::Packet> next_for_central(std::size_t number) {
    return dongles_[number]->take(now_);
  }
  void at_robot(std::size_t number, const ocm::mapper::link::Packet& packet) {
    members_[number]->receive(packet.bytes(), now_);
  }
  void at_central(std::size_t number, const ocm::mapper::link::Packet& packet) {
    central_.heard(address_of(number), packet.bytes(), *this);
  }
  void found(std::size_t number) { central_.found(address_of(number), world_.robot(number).name(), *this); }
  void connected(std::size_t number) { central_.connected(address_of(number), *this); }
  void closed(std::size_t number) { central_.closed(address_of(number), *this); }
  void linked(std::size_t number, bool on) {
    dongles_[number]->link(on, now_);
    members_[number]->link_changed(now_);
  }

 private:
  /// A random static address. [Bluetooth core specification 4.0, volume 6, part B, 1.3.2.1: 11 on top]
  [[nodiscard]] static constexpr ocm::mapper::link::Address address_of(std::size_t number) noexcept {
    return {0xC0, 0, 0, 0, 0, static_cast<std::uint8_t>(number)};
  }
  [[nodiscard]] static constexpr std::size_t number_of(const ocm::mapper::link::Address& address) noexcept {
    return address[5];
  }
  [[nodiscard]] static simulation::Place place(Vector where) noexcept { return {where.x, where.y}; }

  /// What is due at `now`: the world first, so that all read the same state.
  void happen(base::Time now) {
    now_ = now;
    world_.advance_to(now);
    if (radio_.next_event() <= now) {
      for (std::size_t i = 0; i < members_.size(); ++i) radio_.move(i, place(members_[i]->pose().position()));
      radio_.advance(now, *this);
    }
    for (const auto& member : members_)
      if (member->next_event() <= now) member->advance_to(now);
  }

  World& world_;
  base::Time now_;
  simulation::Radio radio_;
  Central central_;
  std::vector<std::unique_ptr<Dongle>> dongles_;
  std::vector<std::unique_ptr<Member>> members_;
  std::string said_;
};

}  // namespace ocm::sim::mapper
