/// A gamepad as a drive needs it: where its stick is, and what is pressed. The real one is libevdev's, seen
/// by evdev_gamepad.cpp alone; a test plays another.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "ocm/transport/bus.hpp"

namespace ocm::cli {

/// As it is now.
struct PadState {
  double forward = 0;     ///< of the left stick, -1 to 1
  double left = 0;        ///< likewise, to the left
  bool dead_man = false;  ///< a shoulder button is held
  bool stop = false;      ///< the right one of the four round buttons was pressed, if only for a moment
  bool quit = false;      ///< likewise Start
};

class Gamepad {
 public:
  Gamepad() = default;
  Gamepad(const Gamepad&) = delete;
  Gamepad& operator=(const Gamepad&) = delete;
  virtual ~Gamepad() = default;
  /// Without waiting; nothing: it is gone, for good.
  [[nodiscard]] virtual std::optional<PadState> read() = 0;
  /// As it calls itself: "Xbox Wireless Controller".
  [[nodiscard]] virtual std::string name() const = 0;
};

/// Where an axis may be, as the device says.
struct AxisRange {
  int least = 0;
  int most = 0;
};

/// -1 to 1, in steps of a twentieth; 0 within a tenth of the middle: a stick that is let go does not come
/// back to the same place each time. [decided] An axis without a range is in its middle.
[[nodiscard]] double deflection(int value, AxisRange range) noexcept;

/// "/dev/input/event5". The failure says what it is if it is no gamepad, and which ones there are; or that it
/// was built without libevdev.
[[nodiscard]] transport::Outcome<std::unique_ptr<Gamepad>> open_gamepad(const std::string& device);

}  // namespace ocm::cli
