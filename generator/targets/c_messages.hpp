/// The plain messages of a spec in its C header.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "generator/spec/model.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {

/// What they are, in the header's first comment.
inline constexpr std::string_view c_messages_say =
    "A struct of a message holds its bytes. _decode() takes those of a frame, if they are enough. _x() is "
    "the physical value of field x, and _set_x() puts the nearest that the width holds; _x_raw() and "
    "_set_x_raw() are the number as it travels, where it is another. Where _has_x() is 0 a multiplexed field "
    "is not there: _x() and _set_x() are 0 then, and change nothing. _init() puts start values.";

/// A struct a message, and functions for it. `taken`: names of the file, each given out once.
void write_c_messages(Writer& out, const spec::Model& model, std::set<std::string>& taken);

}  // namespace ocm::generate
