/// What an operator of a file permits although it may not be meant: no mistake, and worth a look.
#pragma once

#include <vector>

#include "cli/operate/operator_file.hpp"

namespace ocm::cli::operate {

/// Limits of a drive do not hold for what a board does by itself, such as `travel`: it commands the motors on
/// its own board. One for each configuration that limits a drive and in which such a topic may be commanded,
/// or goes on from the configuration before.
[[nodiscard]] std::vector<spec::Problem> cautions(const OperatorFile& file);

}  // namespace ocm::cli::operate
