/// Functions that C headers need whatever the spec: those of them that one calls are written into it.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "generator/spec/model.hpp"

namespace ocm::generate {

/// C code that is the same for every robot but for its name: @ becomes amiro, $ AMIRO.
[[nodiscard]] std::string named(std::string_view text, const std::string& robot);

/// The names in such code that begin with the robot's.
[[nodiscard]] std::set<std::string> names_in(std::string_view text, const std::string& robot);

/// Those of all helpers.
[[nodiscard]] std::set<std::string> names_of_helpers(const std::string& robot);

/// The helpers that `body` calls, and those that they call, in an order that compiles.
[[nodiscard]] std::string helpers_of(std::string_view body, const std::string& robot);

/// An expression for the number, of the field's type, that is nearest to `number` of those that the width
/// holds.
[[nodiscard]] std::string held(const spec::FieldModel& field, const std::string& number,
                               const std::string& robot);

}  // namespace ocm::generate
