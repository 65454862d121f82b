/// How a verb shows frames, as its options say: --pretty, --json, --csv or --raw, and --field.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/protocol/topic.hpp"

#include "cli/output/output.hpp"
#include "cli/shared/arguments.hpp"

namespace ocm::cli {

struct FormatOptions {
  bool pretty = false, json = false, csv = false, raw = false;
  std::vector<std::string> fields;
};

void add_format_options(Verb verb, FormatOptions& options);

/// What writes in this format; without one for a person where stdout is a terminal, and JSON lines otherwise.
/// `verb` is for messages. Leaves through cli::fail where a field does not exist, or the format has none. The
/// catalogue outlives it.
[[nodiscard]] std::unique_ptr<Output> chosen_output(std::string_view verb,
                                                    const protocol::Catalogue& catalogue, bool colour,
                                                    const FormatOptions& options);

}  // namespace ocm::cli
