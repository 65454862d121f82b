/// Programs of others that make a picture from a script: gnuplot, Graphviz's dot. Found when they are needed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ocm/transport/bus.hpp"

namespace ocm::cli {

/// What the program, the first of the words, writes to its standard output when it reads the script. The
/// failure says what it says, or that there is none, and how to `install` it.
[[nodiscard]] transport::Outcome<std::string> drawn_by(std::vector<std::string> words_of_call,
                                                       std::string_view script, std::string_view install);

}  // namespace ocm::cli
