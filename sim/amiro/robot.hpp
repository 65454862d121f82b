/// The whole robot on a host: its three boards, each a node of its own on the bus, in one world.
///
///     sim::SimulatedRobot robot{options, bottom_port, middle_port, top_port};
///     robot.receive(frame, now);  // whenever a frame was complete on the bus
///     robot.advance(now);         // at next_event(), and when a port has room again while waiting()
///
/// Time is handed in: a server passes the clock, a test whatever it likes. The boards do everything at the
/// time at which it is due, however seldom it is called: a simulated robot is never late because its host
/// is. The ports must outlive the robot.
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "ocm/analysis/board_admission.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/scheduling/cooperative.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/di_wheel_drive/board.hpp"
#include "firmware/boards/light_ring/board.hpp"
#include "firmware/boards/power_management/board.hpp"
#include "sim/amiro/world.hpp"

namespace ocm::sim {

template <can::Sender Bus>
class SimulatedRobot {
 public:
  SimulatedRobot(WorldOptions options, Bus& di_wheel_drive, Bus& power_management, Bus& light_ring)
      : world_(std::move(options)),
        di_wheel_drive_(world_, di_wheel_drive, world_.options().start_time),
        power_management_(world_, power_management, world_.options().start_time),
        light_ring_(world_, light_ring, world_.options().start_time) {
    const auto switched_on = [] { return controller::Health{.reset = 1}; };
    di_wheel_drive_.controller().report(switched_on);
    power_management_.controller().report(switched_on);
    light_ring_.controller().report(switched_on);
  }

  /// A frame that every board hears that is switched on, complete on the bus at `now`. Call `advance`
  /// afterwards.
  void receive(const can::Frame& frame, base::Time now,
               const std::array<bool, 3>& on = {true, true, true}) noexcept {
    pass_until(now);
    if (on[0]) di_wheel_drive_.receive(frame, now);
    if (on[1]) power_management_.receive(frame, now);
    if (on[2]) light_ring_.receive(frame, now);
  }

  /// Lets the world go on until `now`, and the boards do what is due.
  void advance(base::Time now) noexcept {
    pass_until(now);
    poll(now);
  }

  /// When a board has something to do next: at the latest, its odometry. The world needs no calls of its own.
  [[nodiscard]] base::Time next_event() const noexcept {
    return std::min({di_wheel_drive_.next_event(), power_management_.next_event(), light_ring_.next_event()});
  }
  /// Frames wait for a port: advance as soon as it has room.
  [[nodiscard]] bool waiting() const noexcept {
    return di_wheel_drive_.waiting() || power_management_.waiting() || light_ring_.waiting();
  }

  [[nodiscard]] World& world() noexcept { return world_; }
  [[nodiscard]] const World& world() const noexcept { return world_; }
  [[nodiscard]] const auto& di_wheel_drive() const noexcept { return di_wheel_drive_; }
  [[nodiscard]] const auto& power_management() const noexcept { return power_management_; }
  [[nodiscard]] const auto& light_ring() const noexcept { return light_ring_; }

 private:
  /// What was due before `now`, in its order; the world is at `now` then.
  void pass_until(base::Time now) noexcept {
    for (base::Time next = next_event(); next < now; next = next_event()) {
      world_.advance_to(next);
      poll(next);
    }
    world_.advance_to(now);
  }
  void poll(base::Time now) noexcept {
    di_wheel_drive_.poll(now);
    power_management_.poll(now);
    light_ring_.poll(now);
  }

  World world_;
  /// Simulated parts answer at once: the bus alone decides.
  template <class Board>
  using Admission = analysis::BoardAdmission<Board, amiro::bit_rate>;
  using Port = scheduling::Cooperative;

  firmware::boards::di_wheel_drive::Board<World, Bus, Port, Admission<amiro::DiWheelDrive>> di_wheel_drive_;
  firmware::boards::power_management::Board<World, Bus, Port, Admission<amiro::PowerManagement>>
      power_management_;
  firmware::boards::light_ring::Board<World, Bus, Port, Admission<amiro::LightRing>> light_ring_;
};

}  // namespace ocm::sim
