/// Before a sensor is asked for a stream: does the bus carry it, with what runs on it already? What runs is
/// listened to for a moment, no request is sent; docs/admission.md says what is assumed.
#pragma once

#include <chrono>

#include "ocm/base/time.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/command/refusal_watch.hpp"
#include "cli/shared/arguments.hpp"
#include "cli/words/command.hpp"

namespace ocm::cli {

struct AdmissionOptions {
  bool force = false;
  bool explain = false;
  base::Duration listen = std::chrono::milliseconds{100};
};

/// --force, --explain and --listen.
void add_admission_options(Verb verb, AdmissionOptions& options);

/// Listens, and fails with the reason if a stream would be late; --explain prints the table to stdout. A
/// command that starts no stream passes at once, and so does all with --force alone.
void admit(const protocol::Catalogue& catalogue, transport::Bus& bus, const client::Command& command,
           const AdmissionOptions& options, RefusalWatch& refusals);

}  // namespace ocm::cli
