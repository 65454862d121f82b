/// Of a log that is played: where it is.
#pragma once

#include "ocm/base/time.hpp"

namespace ocm::cli::bus_model {

struct Playing {
  base::Duration at{};
  base::Duration length{};
  double speed = 1;
  bool ended = false;
};

}  // namespace ocm::cli::bus_model
