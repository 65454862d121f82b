/// A mapper of the world with its link: all that ocm::mapper::app::RobotParts asks for.
///
///     WorldParts parts{world.robot(0), [&] { return dongle.connected(); },
///                      [&](std::span<const std::uint8_t> bytes) { return dongle.write(bytes); }};
///     ocm::mapper::app::Robot robot{parts, port, model};
///
/// Neither owns nor copies the robot, which must outlive it.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "ocm/base/result.hpp"
#include "ocm/mapper/app/parts.hpp"

#include "sim/mapper/robot.hpp"

namespace ocm::sim::mapper {

/// `Linked`: whether there is a connection. `Send`: takes bytes, tells how many found room.
template <std::invocable Linked, std::invocable<std::span<const std::uint8_t>> Send>
class WorldParts {
 public:
  WorldParts(Robot& robot, Linked linked, Send send)
      : robot_(robot), linked_(std::move(linked)), send_(std::move(send)) {}

  [[nodiscard]] ocm::mapper::app::WheelTicks ticks() const noexcept { return robot_.ticks(); }
  [[nodiscard]] base::Result<float> gyro() const noexcept { return robot_.gyro(); }
  [[nodiscard]] base::Result<sensing::Field> field() const noexcept { return robot_.field(); }
  [[nodiscard]] base::Result<float> infrared(std::size_t sensor) const noexcept {
    return robot_.infrared(sensor);
  }
  void drive(motion::Efforts efforts) noexcept { robot_.drive(efforts); }
  void turn_tower(std::int32_t degrees) noexcept { robot_.turn_tower(degrees); }
  void show(ocm::mapper::app::Lights lights) noexcept { robot_.show(lights); }
  void store(const sensing::CompassFit& fit) { robot_.store(fit); }
  [[nodiscard]] base::Result<sensing::CompassFit> stored() const { return robot_.stored(); }
  [[nodiscard]] bool linked() { return linked_(); }
  [[nodiscard]] std::size_t send(std::span<const std::uint8_t> bytes) { return send_(bytes); }

 private:
  Robot& robot_;
  Linked linked_;
  Send send_;
};

namespace detail {

struct NoLink {
  [[nodiscard]] bool operator()() const noexcept { return false; }
  [[nodiscard]] std::size_t operator()(std::span<const std::uint8_t>) const noexcept { return 0; }
};
static_assert(ocm::mapper::app::RobotParts<WorldParts<NoLink, NoLink>>);

}  // namespace detail

}  // namespace ocm::sim::mapper
