/// The dongle at a serial line: opened, and of which kind it is.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "ocm/mapper/server/dialect.hpp"
#include "ocm/transport/serial_port.hpp"

#include "cli/shared/arguments.hpp"

namespace ocm::cli::fleet {

struct DongleOptions {
  std::uint32_t baud = 0;     ///< 0: those that dongles have, one after the other
  std::string flow = "none";  ///< or rtscts
  std::string kind = "auto";  ///< or ours, at, thesis
};

/// --baud, --flow and --dongle.
void add_dongle_options(Verb verb, DongleOptions& options);
/// --flow and --dongle.
std::array<Option, 2> add_dongle_kind(Verb verb, DongleOptions& options);

struct Dongle {
  transport::SerialPort port;
  mapper::server::Dialect dialect{};
  std::string heard;  ///< while its kind was found out
};

/// Asks the dongle what it is, unless that is given: as our central, with `*` and `stop`, then as the base
/// firmware, with `AT?.`; one that says anything else that can be read is the thesis's. Leaves it in command
/// mode. Ends the command where nothing answers. Up to four seconds.
[[nodiscard]] Dongle open_dongle(std::string_view verb, const std::string& path,
                                 const DongleOptions& options);

}  // namespace ocm::cli::fleet
