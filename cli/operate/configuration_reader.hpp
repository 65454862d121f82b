/// Reads the configurations of an operator file, and what is on the bus in each of them.
#pragma once

#include "cli/operate/value_reader.hpp"

namespace ocm::cli::operate {

/// What other programs send and ask for all the time.
void read_others(const spec::At& at, const Reading& reading);
void read_configurations(const spec::At& at, const Reading& reading);
/// What is on the bus in each configuration though the file does not say it: the spec's messages that come by
/// themselves, and the set points that programs may hold there, which boards may refuse. What "others" states
/// is left to it; so it comes after both.
void count_others(const Reading& reading);

}  // namespace ocm::cli::operate
