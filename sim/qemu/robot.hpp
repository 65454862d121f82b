/// The whole robot with its boards as images in QEMU: real firmware and drivers, and behind them the register
/// models of the parts in one world. What sim::SimulatedRobot is with the boards compiled for the host.
///
///     auto robot = QemuRobot::start(options, images, clock);
///     robot->advance(now, send);     // whenever one of descriptors() is readable, and when a bus has room
///     again robot->receive(frame, now);    // whenever a frame was complete on the bus
///
/// Time is real: the emulated boards run by the host's clock. Host only.
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
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/topics/amiro.hpp"
#include "ocm/transport/bus.hpp"

#include "firmware/drivers/bxcan_filter.hpp"
#include "firmware/qemu/parts_frames.hpp"
#include "sim/amiro/world.hpp"
#include "sim/parts/board_parts.hpp"
#include "sim/parts/di_wheel_drive.hpp"
#include "sim/parts/light_ring.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/parts/power_management.hpp"
#include "sim/parts/transfers.hpp"
#include "sim/qemu/board.hpp"

namespace ocm::sim {

/// What an emulated board asks its host, done by the models of its parts. Error::bad_mode: no such question.
[[nodiscard]] inline base::Status answer(BoardParts& models, const firmware::qemu::link::Request& request,
                                         std::span<std::uint8_t> read) {
  using firmware::qemu::link::Kind;
  const auto in = request.written;
  switch (request.kind) {
    case Kind::i2c:
      return transfer(models.i2c(request.unit), request, read);
    case Kind::spi:
      return transfer(models.spi(request.unit), request, read);
    case Kind::set_duty:
      if (in.size() != 4) return base::Error::bad_length;
      models.motors().set_duty(static_cast<std::int16_t>(word_at(in, 0)),
                               static_cast<std::int16_t>(word_at(in, 2)));
      return {};
    case Kind::encoders: {
      if (read.size() != 4) return base::Error::bad_length;
      const auto counts = models.motors().encoders();
      for (std::size_t i = 0; i < 4; ++i) read[i] = static_cast<std::uint8_t>(counts[i / 2] >> (i % 2 * 8));
      return {};
    }
    case Kind::inputs:
      if (read.size() != 1) return base::Error::bad_length;
      read[0] = models.inputs().read();
      return {};
    case Kind::outputs:
      if (in.size() != 1) return base::Error::bad_length;
      models.outputs().write(in[0]);
      return {};
    case Kind::convert:
    case Kind::set_pulse:
      break;  // none of these boards has a converter or a servo
  }
  return base::Error::bad_mode;
}

class QemuRobot {
 public:
  static constexpr std::size_t boards = 3;

  /// `images`: the folder with the boards' images. `clock` says the time for the parts' own timing.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<QemuRobot>> start(WorldOptions options,
                                                                            const std::string& images,
                                                                            PartClock clock) {
    std::unique_ptr<QemuRobot> robot{new QemuRobot(std::move(options), std::move(clock))};
    for (std::size_t i = 0; i < boards; ++i) {
      const Kind& kind = kinds[i];
      auto board = QemuBoard::start(
          {.name = std::string{kind.name},
           .machine = std::string{kind.machine},
           .image = images + "/" + std::string{kind.name} + "_" + std::string{kind.chip} + ".elf"});
      if (!board) return board.error;
      robot->qemu_[i] = std::move(*board);
    }
    return robot;
  }

  /// A frame that every board hears that is switched on, and whose CAN controller lets it through.
  void receive(const can::Frame& frame, base::Time now, const std::array<bool, boards>& on) {
    world_.advance_to(now);
    if (frame.format != can::Format::base) return;
    for (std::size_t i = 0; i < boards; ++i)
      if (on[i] && kinds[i].accepts(frame.id)) qemu_[i]->hear(frame);
  }

  /// Serves the boards' parts and takes what they send: `send(board, frame) -> bool`, false when there is no
  /// room. Error::closed: one of them has ended, see `failure`.
  template <class Send>
  base::Status advance(base::Time now, Send&& send) {
    world_.advance_to(now);
    for (std::size_t i = 0; i < boards; ++i) {
      qemu_[i]->read([&](const can::Frame& frame) { return send(i, frame); },
                     [&](const firmware::qemu::link::Request& request, std::span<std::uint8_t> read) {
                       return answer(*parts_[i], request, read);
                     });
      if (const std::string why = qemu_[i]->ended(); !why.empty()) {
        failure_ = {qemu_[i]->name() + ": " + why, "what it said is above; see docs/verbs/sim.md"};
        return base::Error::closed;
      }
    }
    return {};
  }

  [[nodiscard]] std::array<int, 2 * boards> descriptors() const noexcept {
    std::array<int, 2 * boards> all{};
    for (std::size_t i = 0; i < boards; ++i) {
      const auto two = qemu_[i]->descriptors();
      all[2 * i] = two[0];
      all[2 * i + 1] = two[1];
    }
    return all;
  }
  /// All boards listen.
  [[nodiscard]] bool ready() const noexcept {
    return qemu_[0]->ready() && qemu_[1]->ready() && qemu_[2]->ready();
  }
  /// Frames of this board wait for the bus.
  [[nodiscard]] bool waiting(std::size_t board) const noexcept { return qemu_[board]->waiting(); }
  [[nodiscard]] const transport::Failure& failure() const noexcept { return failure_; }
  [[nodiscard]] static std::string_view name(std::size_t board) noexcept { return kinds[board].name; }
  [[nodiscard]] const QemuCounters& counters(std::size_t board) const noexcept {
    return qemu_[board]->counters();
  }
  /// What the board's drivers did that data sheets forbid.
  [[nodiscard]] const Violations& violations(std::size_t board) const { return parts_[board]->violations(); }
  [[nodiscard]] World& world() noexcept { return world_; }
  [[nodiscard]] const World& world() const noexcept { return world_; }

 private:
  struct Kind {
    std::string_view name;
    std::string_view machine;  ///< QEMU's
    std::string_view chip;     ///< firmware/CMakeLists.txt's
    bool (*accepts)(std::uint32_t identifier);
  };
  template <class Board>
  static bool accepts(std::uint32_t identifier) {
    constexpr auto set = firmware::drivers::bxcan::command_filters<Board>();
    for (std::size_t i = 0; i < set.size; ++i)
      if (set.filters[i].accepts(identifier)) return true;
    return false;
  }
  // QEMU has a Cortex-M3 and a Cortex-M4 board of the same family with enough memory; LightRing and
  // DiWheelDrive have an M3. [decided]
  static constexpr std::array<Kind, boards> kinds{{
      {amiro::DiWheelDrive::name, "netduino2", "qemu_m3", &accepts<amiro::DiWheelDrive>},
      {amiro::PowerManagement::name, "netduinoplus2", "qemu_m4", &accepts<amiro::PowerManagement>},
      {amiro::LightRing::name, "netduino2", "qemu_m3", &accepts<amiro::LightRing>},
  }};

  QemuRobot(WorldOptions options, PartClock clock)
      : world_(std::move(options)),
        parts_{std::make_unique<DiWheelDriveParts>(world_, clock),
               std::make_unique<PowerManagementParts>(world_, clock),
               std::make_unique<LightRingParts>(world_)} {}

  World world_;
  std::array<std::unique_ptr<BoardParts>, boards> parts_;
  std::array<std::unique_ptr<QemuBoard>, boards> qemu_;
  transport::Failure failure_;
};

}  // namespace ocm::sim
