/// What a viewer publishes, as a command: an object of fields on the channel of an actuator or a message, or
/// a line on the channel of lines. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/client/command.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli::serve {

/// The channel of lines: {"line":"led all red"}, as a script has them.
inline constexpr std::string_view line_topic = "/ocm/command";
/// The channel of a log's time bar.
inline constexpr std::string_view playback_topic = "/ocm/playback";

/// Of something that is published on `topic`. A set point of motors is a hold, whose end is the server's
/// business; a line that holds or repeats is refused. The error says what is wrong, and what would be right.
[[nodiscard]] base::Result<client::Command, std::string> command_of(const protocol::Catalogue& catalogue,
                                                                    std::string_view topic,
                                                                    std::string_view payload);
/// Publishing a sensor with this period; 0 stops it.
[[nodiscard]] base::Result<client::Command, std::string> period_command(const protocol::Catalogue& catalogue,
                                                                        std::string_view sensor,
                                                                        double milliseconds);

/// What a time bar asks: {"at_s":12.5}, {"speed":2}, {"paused":true}, or several of them.
struct PlaybackRequest {
  std::optional<base::Duration>
      at;            ///< from the log's beginning, to the nearest ns; absent: it stays where it is
  double speed = 0;  ///< 0: as it is
  int paused = -1;   ///< 1: pause, 0: go on, -1: as it is
};
[[nodiscard]] base::Result<PlaybackRequest, std::string> playback_of(std::string_view payload);

}  // namespace ocm::cli::serve
