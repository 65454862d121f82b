/// What an operator of a file permits although it may not be meant: no mistake, and worth a look.
#pragma once

#include <vector>

#include "cli/operate/operator_file.hpp"

namespace ocm::cli::operate {

/// Limits of a drive do not hold for what a board does by itself, such as `travel`: it commands the motors on
/// its own board. One for each configuration that limits a drive and in which such a topic may be commanded,
/// or goes on from the configuration before.
///
/// One, too, for each configuration that goes to the fall-back by values, and by no age, gap or rate of any
/// stream: when the stream falls silent, or its board was never there, nothing guards the robot.
[[nodiscard]] std::vector<spec::Problem> cautions(const OperatorFile& file);

}  // namespace ocm::cli::operate
