/// Reads the monitors of an operator file: conditions on values, times, rates and the bus, and how they are
/// joined.
#pragma once

#include "cli/operate/value_reader.hpp"

namespace ocm::cli::operate {

void read_monitors(const spec::At& at, const Reading& reading);

}  // namespace ocm::cli::operate
