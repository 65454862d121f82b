#include "cli/fleet/pausing.hpp"

#include <chrono>
#include <cstdint>

namespace ocm::cli::fleet {
namespace {

using namespace std::chrono_literals;

/// Grows with each update, and with each piece of one whose rest was lost: other sentences of a robot are one
/// packet.
std::uint32_t pieces(const CentralLine& line, unsigned index) {
  const mapper::link::Ear& ear = line.fleet().ear(index);
  return ear.text().faults().total() + ear.text().stray() + ear.packed().faults().total();
}

}  // namespace

bool pause_until_seen(CentralLine& line, unsigned index, bool paused) {
  constexpr base::Duration again = 500ms, longest = 10s, quiet_for = 1500ms;
  constexpr int least_words = 2;  // of a robot that is not just out of reach
  const auto& robot = line.fleet().robot(index);
  auto& fleet = line.server().fleet();
  base::Time say_at{}, quiet_since = CentralLine::now() + again, updated = robot.updated, heard = robot.heard;
  std::uint32_t before = pieces(line, index);
  int words = 0;
  const bool obeys = line.wait(longest, [&] {
    const base::Time now = CentralLine::now();
    if (now >= say_at) {
      say_at = now + again;
      (void)(paused ? fleet.pause(index, now) : fleet.unpause(index, now));
      if (paused) (void)fleet.ping(index);  // while it drives it says no idle
    }
    if (robot.updated != updated && !paused) return true;
    if (robot.updated != updated || pieces(line, index) != before) {
      updated = robot.updated;
      before = pieces(line, index);
      quiet_since = now;
      words = 0;
      heard = robot.heard;
    }
    if (robot.heard != heard) {
      heard = robot.heard;
      ++words;
    }
    return robot.lost || (paused && words >= least_words && now - quiet_since >= quiet_for);
  });
  return obeys && !robot.lost;
}

bool seems_paused(CentralLine& line, unsigned index) {
  const auto& robot = line.fleet().robot(index);
  const std::uint32_t before = pieces(line, index);
  const bool updates =
      line.wait(2500ms, [&] { return robot.update.has_value() || pieces(line, index) != before; });
  return !updates && (robot.last == mapper::link::Kind::idle || robot.last == mapper::link::Kind::pong);
}

}  // namespace ocm::cli::fleet
