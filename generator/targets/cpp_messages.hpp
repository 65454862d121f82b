/// The plain messages of a spec in its C++ header.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "generator/spec/model.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {

/// A name as C++ has it: each run of other characters than letters and digits is one underscore, a digit in
/// front gets an `n` before it, a word of C++ an underscore behind it. The same name gives the same; two may
/// give one.
[[nodiscard]] std::string cpp_name(std::string_view name);

/// A text of a DBC file as a comment: on one line, and without a backslash, which at its end would continue
/// it.
[[nodiscard]] std::string comment_text(std::string text);

/// A struct a message.
void write_messages(Writer& out, const spec::Model& model);

}  // namespace ocm::generate
