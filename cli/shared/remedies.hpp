/// What to do about a failure or a finding with this tool: where the library's sentence can be bettered by
/// one that names a verb or an option. Otherwise the library's own.
#pragma once

#include <string>

#include "ocm/client/diagnosis.hpp"
#include "ocm/host/failure.hpp"

namespace ocm::cli {

[[nodiscard]] std::string remedy(const host::Failure& failure);
[[nodiscard]] std::string remedy(const client::Finding& finding);

}  // namespace ocm::cli
