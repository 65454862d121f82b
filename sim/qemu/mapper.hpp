/// A mapper whose application runs as an image in QEMU, real firmware and drivers, in a robot of
/// the simulated world: behind the image's parts' line are register models, behind those the robot's wheels
/// and sensors. The other end of its dongle is the owner of this object.
///
///     auto robot = QemuMapper::start(world.robot(0), {.name = "AVR", .image = ...}, clock);
///     robot->set_linked(true);
///     robot->write("{S,CON}\n");
///     robot->advance([&](std::string_view said) { ... });   // whenever one of descriptors() is readable
///
/// Time is real: the emulated processor runs by the host's clock. The world's owner lets it pass. Host
/// only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "ocm/base/result.hpp"
#include "ocm/transport/bus.hpp"

#include "firmware/qemu/parts_frames.hpp"
#include "sim/mapper/parts.hpp"
#include "sim/mapper/robot.hpp"
#include "sim/parts/mapper.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/qemu/process.hpp"

namespace ocm::sim {

class QemuMapper {
 public:
  /// The robot must outlive this. `clock` says the time for the parts' own timing.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<QemuMapper>> start(sim::mapper::Robot& robot,
                                                                             QemuOptions options,
                                                                             PartClock clock) {
    auto qemu = QemuProcess::start(std::move(options), 3);
    if (!qemu) return qemu.error;
    return std::unique_ptr<QemuMapper>{new QemuMapper(robot, std::move(*qemu), std::move(clock))};
  }
  QemuMapper(const QemuMapper&) = delete;
  QemuMapper& operator=(const QemuMapper&) = delete;

  /// To poll for input.
  [[nodiscard]] std::array<int, 3> descriptors() const noexcept {
    return {qemu_->line(dongle_line), qemu_->line(parts_line), qemu_->line(pin_line)};
  }
  /// It listens to its dongle. Before that what is written is lost, and a change of the pin waits.
  [[nodiscard]] bool ready() const noexcept { return ready_; }
  /// Why QEMU has ended; empty while it runs.
  [[nodiscard]] std::string ended() { return qemu_->ended(); }

  /// The dongle has a connection, or not.
  void set_linked(bool linked) {
    linked_ = linked;
    if (ready_) tell_pin();
  }
  /// To the robot. False: the line had no room, and it is lost.
  bool write(std::string_view bytes) { return qemu_->write(dongle_line, bytes); }

  /// Serves its parts, and hands on what it says: `hear(std::string_view)`.
  template <class Hear>
  void advance(Hear&& hear) {
    auto answer = [this](const firmware::qemu::link::Request& request, std::span<std::uint8_t> read) {
      return models_.answer(request, read);
    };
    exchanges_ += server_.serve(*qemu_, parts_line, answer);
    std::array<char, 512> buffer;
    if (const auto bytes = qemu_->read(pin_line, buffer); !bytes.empty() && !ready_) {
      ready_ = true;
      tell_pin();
    }
    if (const auto bytes = qemu_->read(dongle_line, buffer); !bytes.empty())
      hear(std::string_view{bytes.data(), bytes.size()});
  }

  /// With its parts.
  [[nodiscard]] std::uint64_t exchanges() const noexcept { return exchanges_; }
  /// What its drivers did that data sheets forbid.
  [[nodiscard]] const Violations& violations() noexcept { return models_.violations(); }

 private:
  static constexpr std::size_t dongle_line = 0;
  static constexpr std::size_t parts_line = 1;
  static constexpr std::size_t pin_line = 2;

  /// Its link is not the parts' affair here.
  struct NoLink {
    bool operator()() const noexcept { return false; }
    std::size_t operator()(std::span<const std::uint8_t>) const noexcept { return 0; }
  };
  using Parts = sim::mapper::WorldParts<NoLink, NoLink>;

  QemuMapper(sim::mapper::Robot& robot, std::unique_ptr<QemuProcess> qemu, PartClock clock)
      : qemu_(std::move(qemu)), parts_(robot, NoLink{}, NoLink{}), models_(parts_, clock) {}

  void tell_pin() { qemu_->write(pin_line, linked_ ? "0" : "1"); }  // firmware/qemu/dongle_line.hpp

  std::unique_ptr<QemuProcess> qemu_;
  Parts parts_;
  RobotModels<Parts> models_;
  PartsServer server_;
  std::uint64_t exchanges_ = 0;
  bool linked_ = false;
  bool ready_ = false;
};

}  // namespace ocm::sim
