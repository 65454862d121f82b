/// The AMiRo's three boards as the loop of a bus sees them, whatever runs them: this machine, or QEMU.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/topics/amiro.hpp"
#include "ocm/transport/bus.hpp"

#include "sim/amiro/world.hpp"
#include "sim/serve/shell.hpp"

namespace ocm::sim {

inline constexpr std::array<std::string_view, 3> board_names{
    amiro::DiWheelDrive::name, amiro::PowerManagement::name, amiro::LightRing::name};

/// A board's connection to whatever bus there is. A board that is switched off sends nothing, and hears
/// nothing.
struct Port {
  std::function<base::Result<bool>(const can::Frame&)> hand_over;
  bool on = true;
  base::Result<bool> send(const can::Frame& frame) {
    if (!on) return base::Error::closed;
    return hand_over(frame);
  }
};

/// One for each board, in the order of `board_names`.
using Ports = std::array<Port, board_names.size()>;
[[nodiscard]] inline std::array<bool, board_names.size()> switched_on(const Ports& ports) noexcept {
  return {ports[0].on, ports[1].on, ports[2].on};
}

class Boards {
 public:
  Boards() = default;
  Boards(const Boards&) = delete;
  Boards& operator=(const Boards&) = delete;
  virtual ~Boards() = default;

  virtual void receive(const can::Frame& frame, base::Time now) = 0;
  /// Error::closed: a board has ended, see `failure`.
  [[nodiscard]] virtual base::Status advance(base::Time now) = 0;
  /// When a board has something to do by itself.
  [[nodiscard]] virtual base::Time next_event() const = 0;
  /// Frames wait for the bus.
  [[nodiscard]] virtual bool waiting() const = 0;
  /// All boards listen.
  [[nodiscard]] virtual bool ready() const { return true; }
  /// Readable when a board has something to say.
  [[nodiscard]] virtual std::vector<int> descriptors() const { return {}; }
  [[nodiscard]] virtual transport::Failure failure() const { return {}; }
  /// What they are in.
  [[nodiscard]] virtual const World& world() const = 0;
  /// What each board received, a line each.
  virtual void summarise(const Shell& shell) const = 0;
};

/// The boards compiled for this machine. They keep a reference to the ports.
[[nodiscard]] std::unique_ptr<Boards> boards_of_the_host(const WorldOptions& world, Ports& ports);

/// The boards as images in QEMU, from this folder; empty: where `scripts/build firmware` and an installation
/// put them, seen from this program. They keep a reference to the ports.
[[nodiscard]] transport::Outcome<std::unique_ptr<Boards>> boards_in_qemu(const WorldOptions& world,
                                                                         Ports& ports,
                                                                         const std::string& images,
                                                                         std::function<base::Time()> clock);

}  // namespace ocm::sim
