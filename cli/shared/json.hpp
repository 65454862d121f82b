/// JSON for other programs to read, as the generator prints it.
#pragma once

#include "generator/text/json.hpp"

namespace ocm::cli {

using generate::Json;

}  // namespace ocm::cli
