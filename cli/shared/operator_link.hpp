/// The operator that runs on a bus of this machine, as other programs of the same user see it. To "commands
/// FRAME" it answers whether it commands that actuator itself: nothing, or "repeats" or "once", and where it
/// is; to "ways" in lines where it is, and where a request leads from there.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "ocm/transport/bus.hpp"

#include "cli/shared/local_link.hpp"

namespace ocm::cli {

inline constexpr std::string_view operator_commands = "commands ";
inline constexpr std::string_view operator_repeats = "repeats";
inline constexpr std::string_view operator_ways = "ways";

/// Where the operator of a bus listens: by the name that the bus has for itself.
[[nodiscard]] std::string operator_path(std::string_view bus);

using OperatorLink = LocalLink;
using OperatorAnswer = LocalAnswer;

/// Null: no operator runs on that bus, or none of this user; looked for wherever a program of this user may
/// listen, with whatever environment it runs. A failure: one does, and does not answer. `verb` is who asks.
[[nodiscard]] transport::Outcome<std::unique_ptr<OperatorLink>> connect_operator(std::string_view bus,
                                                                                 std::string_view verb);

/// One whose environment is another (XDG_RUNTIME_DIR), so that it listens elsewhere.
[[nodiscard]] transport::Outcome<std::unique_ptr<OperatorLink>> connect_operator_elsewhere(
    std::string_view bus, std::string_view verb);

}  // namespace ocm::cli
