/// publish and once: a request, and the first sample that answers it, which once shows, and publish --wait.
#pragma once

#include <string_view>

#include "cli/shared/arguments.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli {

/// What a verb's request starts: one sample, or a stream, which the bus must be able to carry.
enum class Starts : bool { sample, stream };

/// The words, --priority, --dry-run and --wait, of a stream those of its admission, and what the verb does
/// with them.
void add_request_options(Verb verb, Session& session, std::string_view words_help,
                         Starts starts = Starts::sample);

}  // namespace ocm::cli
