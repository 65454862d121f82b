/// Writes a robot's C++ header from its spec.
#pragma once

#include <string>
#include <string_view>

#include "generator/spec/model.hpp"

namespace ocm::generate {

/// The same model gives the same bytes. `spec_name` is named in the first line. The model must come from a
/// spec without problems.
[[nodiscard]] std::string header(const spec::Model& model, std::string_view spec_name);

}  // namespace ocm::generate
