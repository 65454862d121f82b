/// What each verb is made of, and nothing of the others.
#pragma once

#include "cli/shared/arguments.hpp"
#include "cli/shared/headings.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli {

/// `exit_code` is what the verb leaves behind when it ran to its end.
using AddVerb = void (*)(Verb app, Session& session, int& exit_code);

}  // namespace ocm::cli
