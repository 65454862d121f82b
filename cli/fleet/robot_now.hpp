/// A robot behind a central as a program sees it now: by its own server, or by what the program that has the
/// central's line says of it, a row of text a robot.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "ocm/cognitive/fleet.hpp"
#include "ocm/mapper/server/central_client.hpp"

#include "cli/shared/json.hpp"

namespace ocm::cli::fleet {

struct RobotNow : cognitive::Robot {
  unsigned index = 0;
  std::string address;
  std::uint32_t quality_per_mille = 0;
  /// Grows with each update, and with each piece of one whose rest was lost: other sentences of a robot are
  /// one packet.
  std::uint32_t pieces = 0;
  /// Sentences of which a part was lost.
  std::uint32_t torn = 0;

  mapper::server::Progress progress = mapper::server::Progress::none;
  unsigned times_said = 0;
  bool standing = false;
  bool blocked = false;
  float off_cm = 0;
  float off_deg = 0;

  mapper::server::Calibrator::Phase compass = mapper::server::Calibrator::Phase::none;
  unsigned compass_asked = 0;
  mapper::link::Calibration calibration{};

  std::uint64_t order = 0;  ///< which drive, stop or calibration was the last, of any program; 0: none
  std::string by;           ///< whose: "goto (process 1234)"
  bool held = false;        ///< by hand: a map that is drawn meanwhile does not send it on

  [[nodiscard]] bool may_turn() const noexcept {
    using Phase = mapper::server::Calibrator::Phase;
    return compass == Phase::ordering || compass == Phase::turning;
  }
  /// What was asked of it is not over.
  [[nodiscard]] bool busy() const noexcept {
    using Phase = mapper::server::Calibrator::Phase;
    return !is_final(progress) || (compass != Phase::none && compass != Phase::done);
  }
};

/// The robot of that index on the list of a central; `order`, `by` and `held` are the owner's.
[[nodiscard]] RobotNow robot_now(const cognitive::Fleet& fleet, const mapper::server::Peer& peer);

/// "no link", "silent", "held", "paused", "connected", "idle" or "moving".
[[nodiscard]] std::string_view state_of(const RobotNow& robot);
/// For other programs, as `robots --json` prints it.
[[nodiscard]] Json to_json(const RobotNow& robot);

/// One line without its end: KEY=VALUE, tabs between them.
[[nodiscard]] std::string to_row(const RobotNow& robot);
/// Nothing: no such row. A key that is not known is of a newer program, and is passed over.
[[nodiscard]] std::optional<RobotNow> parse_row(std::string_view row);

}  // namespace ocm::cli::fleet
