/// Runs what `amiroctl sim` asks for until a signal: on the virtual bus, or on the interface that --bus
/// names. What runs is in sim/serve.
#pragma once

#include <cstdint>
#include <string>

#include "cli/shared/session.hpp"
#include "sim/serve/amiro.hpp"
#include "sim/serve/mappers.hpp"
#include "sim/serve/messages.hpp"

namespace ocm::cli::simulate {

/// Whether --bus names a virtual bus, or nothing.
[[nodiscard]] bool on_virtual_bus(const Session& session);

/// Where what is simulated is shown, too.
struct ShowOptions {
  std::string kind;           ///< "text": on this terminal, "page": in a browser; empty: nowhere
  std::uint32_t port = 8484;  ///< of the page
  bool commands = false;      ///< who opens its address may drive
  bool opens = false;         ///< in this user's browser
};

/// Each returns the exit code after a signal; what kept it from running is printed, with its remedy, and ends
/// the program. A terminal on which it is shown ends it when the user quits: exit_success.
[[nodiscard]] int run_amiro(const sim::AmiroOptions& options, const ShowOptions& show, Session& session);
[[nodiscard]] int run_messages(const sim::MessagesOptions& options, Session& session);
[[nodiscard]] int run_mappers(const sim::MapperOptions& options, const ShowOptions& show, Session& session);

}  // namespace ocm::cli::simulate
