/// Driving by a gamepad: while a shoulder button is held the robot goes where the stick says, and it rests
/// when the button is released, the stick is let go, or the pad is gone.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/client/command.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/command/gamepad.hpp"
#include "cli/command/timeline.hpp"
#include "cli/words/command.hpp"
#include "cli/words/steering.hpp"

namespace ocm::cli {

/// What a pad asks for, of its state at one time after the other. Pure.
class PadSteering {
 public:
  struct Wanted {
    double forward = 0;  ///< -1 to 1
    double left = 0;
    [[nodiscard]] bool rests() const noexcept { return forward == 0 && left == 0; }
    friend bool operator==(const Wanted&, const Wanted&) = default;
  };
  /// Nothing is driven until the dead man's button was released once: at the beginning, and after a stop.
  [[nodiscard]] Wanted take(const PadState& state) noexcept {
    if (state.stop)
      armed_ = false;
    else if (!state.dead_man)
      armed_ = true;
    return armed_ && state.dead_man ? Wanted{state.forward, state.left} : Wanted{};
  }
  /// The button is held, and has to be released first.
  [[nodiscard]] bool waits_for_release(const PadState& state) const noexcept {
    return state.dead_man && !armed_;
  }

 private:
  bool armed_ = false;
};

class PadDrive {
 public:
  enum class End { quit, signal, gone };
  /// What a person reads: one line, whenever it changes.
  using Show = std::function<void(std::string_view)>;

  /// Speeds of a stick that is fully deflected. Leaves through `fail` where they are beyond the spec's
  /// limits.
  PadDrive(const protocol::Catalogue& catalogue, words::CommandOptions options, words::KeySpeed forward,
           words::KeySpeed turning, Show show);
  /// Looks at the pad fifty times a second. The motors rest at each end.
  [[nodiscard]] End run(Gamepad& pad, Timeline& timeline);

 private:
  [[nodiscard]] base::Result<client::Command, words::WordError> command_to(PadSteering::Wanted wanted) const;
  void tell(const PadState& state, PadSteering::Wanted wanted);

  words::CommandParser parser_;
  words::CommandOptions options_;
  words::KeySpeed forward_, turning_;
  Show show_;
  PadSteering steering_;
  std::string told_;
};

}  // namespace ocm::cli
