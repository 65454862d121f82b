/// The command to measure a board's offsets, or to forget them: what is the same of the floor's and the
/// ring's.
///
/// `apply` in the context that brings set points; `look` in one low level. No heap; 2 bytes.
#pragma once

#include <concepts>

#include "ocm/base/result.hpp"

namespace ocm::firmware::boards {

/// `Topic`: a generated actuator with an `action` of none, measure, forget.
template <class Topic>
class Calibration {
 public:
  /// `start(bool forget)` -> base::Status begins it. What cannot be done is reported as a refusal.
  template <class Controller, std::invocable<bool> Start>
  void apply(const Topic& command, Controller& controller, Start start) noexcept {
    using Action = typename Topic::Action;
    if (command.action == Action::none) return;
    const bool known = command.action == Action::measure || command.action == Action::forget;
    const base::Status begun =
        known ? start(command.action == Action::forget) : base::Status{base::Error::out_of_range};
    if (!begun) return controller.refuse(Topic::id, begun.error);
    [[maybe_unused]] const auto guard = controller.port().lock();
    under_way_ = true;
  }

  /// Once it is over, a failure is reported. `busy()` and `error()` ask the parts.
  template <class Controller, class Busy, class LastError>
  void look(Controller& controller, Busy busy, LastError error) noexcept {
    {
      [[maybe_unused]] const auto guard = controller.port().lock();
      if (!under_way_ || busy()) return;
      under_way_ = false;
    }
    if (const base::Error last = error(); last != base::Error::none) controller.refuse(Topic::id, last);
  }

 private:
  bool under_way_ = false;
};

}  // namespace ocm::firmware::boards
