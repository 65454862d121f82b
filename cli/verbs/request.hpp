/// publish and once: a request, and with --wait the first sample that answers it.
#pragma once

#include <string_view>

#include <CLI/CLI.hpp>

#include "cli/session.hpp"

namespace ocm::cli {

/// The words, --priority, --dry-run and --wait, and what the verb does with them.
void add_request_options(CLI::App& verb, Session& session, std::string_view words_help);

}  // namespace ocm::cli
