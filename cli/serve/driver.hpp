/// Who drives by the page, and for how long: a set point of motors is repeated as long as the viewer goes on
/// giving one, and is at rest when it has given none for half a second, says rest, or has gone. A viewer
/// whose drive was ended by anything else than itself must say rest before it may drive again: a page that
/// was frozen goes on saying what was held before. Of a viewer that has never said rest, as panels of other
/// programs that are just silent when a button is released, silence for so long is taken for it. Pure: the
/// time is handed in, and frames come out.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/client/command.hpp"

#include "cli/serve/viewers.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli::serve {

/// Why a viewer may not drive.
inline constexpr const char* viewer_drives = "another viewer drives; stop it first, or wait";

class Driver {
 public:
  using Frames = std::vector<can::Frame>;
  /// Without a word of its viewer for so long, the motors rest. [decided: as long as the watchdog of motors
  /// waits, spec/topics.json]
  static constexpr base::Duration patience = client::longest_without_set_point;

  /// The viewer drives with this from now on; the first set point is appended to `out`. One drives at a
  /// time: the error says that another one does, or that this one must say rest first; the second once,
  /// behind which its set points are dropped until it does. Rest is always taken.
  [[nodiscard]] std::string drive(ViewerId viewer, const client::Hold& hold, Clock::time_point now,
                                  Frames& out);
  /// The viewer has gone.
  void gone(ViewerId viewer, Frames& out);
  /// Whether its drive of these motors was ended for it, and it has not said rest since.
  [[nodiscard]] bool must_rest(ViewerId viewer, std::uint32_t id) const noexcept;
  /// A drive that was about to begin was ended by another: as one that was held.
  void end_early(ViewerId viewer, std::uint32_t id, Clock::time_point now) {
    ended_.push_back({viewer, id, now});
  }
  /// All motors rest, also where another drives. Who drove must say rest first.
  void rest(Frames& out);
  /// The same where viewers were not listened to for long: what they have said meanwhile, which comes now, is
  /// no silence of a viewer that says no rest.
  void end_all(Clock::time_point now, Frames& out);
  /// What is due by now: set points again, or rest where a viewer was silent. True: it was.
  bool advance(Clock::time_point now, Frames& out);
  /// When `advance` has something to do next.
  [[nodiscard]] std::optional<Clock::time_point> next() const;
  [[nodiscard]] bool drives() const noexcept { return !held_.empty(); }
  /// Whether this viewer does.
  [[nodiscard]] bool drives(ViewerId viewer) const noexcept;
  /// Whether the frame is a set point of motors that are held.
  [[nodiscard]] bool holds(std::uint32_t id) const noexcept;

 private:
  struct Held {
    ViewerId viewer = 0;
    client::Hold hold;
    Clock::time_point heard;  ///< the viewer's newest word
    Clock::time_point next;   ///< when it is repeated
  };
  struct Ended {
    ViewerId viewer = 0;
    std::uint32_t id = 0;
    Clock::time_point heard;  ///< the viewer's newest set point
    bool told = false;
  };
  void end(const Held& held);
  [[nodiscard]] bool says_rest(ViewerId viewer) const noexcept;

  std::vector<Held> held_;    ///< one a drive
  std::vector<Ended> ended_;  ///< by others than their viewers
  std::vector<ViewerId> say_rest_;
};

}  // namespace ocm::cli::serve
