/// What each verb is made of, and nothing of the others.
#pragma once

#include "cli/shared/arguments.hpp"
#include "cli/shared/headings.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli {

/// Says what the verb is, what it takes and what it does. `exit_code` is what it leaves behind when it ran to
/// its end.
using DeclareVerb = void (*)(Verb verb, Session& session, int& exit_code);

}  // namespace ocm::cli
