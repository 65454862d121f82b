#include "cli/command/pad_drive.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "cli/shared/messages.hpp"

namespace ocm::cli {
namespace {

using namespace std::chrono_literals;
using Wanted = PadSteering::Wanted;

/// So soon a button is noticed.
constexpr base::Duration pad_interval = 20ms;
constexpr std::array<std::string_view, 2> stop_by_pad{"drive", "stop"};

}  // namespace

double deflection(int value, AxisRange range) noexcept {
  constexpr double dead = 0.1;
  constexpr double steps = 20;
  const double half = (static_cast<double>(range.most) - range.least) / 2;
  if (!(half > 0)) return 0;
  const double part = std::clamp((value - range.least - half) / half, -1.0, 1.0);
  if (std::abs(part) <= dead) return 0;
  const double beyond = std::copysign((std::abs(part) - dead) / (1 - dead), part);
  return std::round(beyond * steps) / steps + 0.0;  // no -0
}

PadDrive::PadDrive(const protocol::Catalogue& catalogue, words::CommandOptions options,
                   words::KeySpeed forward, words::KeySpeed turning, Show show)
    : parser_(catalogue, "amiroctl "),
      options_(std::move(options)),
      forward_(std::move(forward)),
      turning_(std::move(turning)),
      show_(std::move(show)) {
  // What a person asks for is within the limits, or is refused before anything moves.
  for (const Wanted full : {Wanted{1, 0}, Wanted{-1, 0}, Wanted{0, 1}, Wanted{0, -1}})
    if (const auto command = command_to(full); !command)
      fail({"drive: --gamepad: " + command.error.what, command.error.remedy}, exit_usage);
}

base::Result<client::Command, words::WordError> PadDrive::command_to(Wanted wanted) const {
  const std::string x = forward_.text(wanted.forward);
  const std::string z = turning_.text(wanted.left);
  const std::array<std::string_view, 3> words{"drive", x, z};
  return parser_.parse(words, options_);
}

void PadDrive::tell(const PadState& state, Wanted wanted) {
  std::string text = steering_.waits_for_release(state) ? "rests: release the shoulder button first"
                     : !state.dead_man                  ? "rests: hold a shoulder button to drive"
                     : wanted.rests()                   ? "rests"
                                      : forward_.shown(wanted.forward) + ' ' + turning_.shown(wanted.left);
  if (text != told_) show_(told_ = std::move(text));
}

PadDrive::End PadDrive::run(Gamepad& pad, Timeline& timeline) {
  Wanted driven;
  for (;;) {
    const auto state = pad.read();
    if (!state || state->quit) {
      timeline.rest();
      return state ? End::quit : End::gone;
    }
    const Wanted wanted = steering_.take(*state);
    if (state->stop)
      timeline.carry_out(*parser_.parse(stop_by_pad, options_));  // another program's driving, too
    else if (wanted != driven && wanted.rests())
      timeline.rest();
    else if (wanted != driven)
      timeline.carry_out(*command_to(wanted));
    driven = wanted;
    tell(*state, wanted);
    if (!timeline.wait(Timeline::Clock::now() + pad_interval)) {
      timeline.rest();
      return End::signal;
    }
  }
}

}  // namespace ocm::cli
