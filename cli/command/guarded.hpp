/// A bus whose set points go through an operator, which may command an actuator itself.
#pragma once

#include <string>

#include "ocm/can/frame.hpp"

namespace ocm::cli {

class Guarded {
 public:
  virtual ~Guarded() = default;

  struct Own {
    std::string who;            ///< "operator guard (process 1234)"; empty: it does not command the actuator
    std::string configuration;  ///< in which it is
    bool again_and_again = false;
  };
  /// Whether the operator itself commands the actuator of this frame where it is now. Asks it: 300 ms at
  /// most.
  [[nodiscard]] virtual Own commands_itself(const can::Frame& frame) = 0;
};

}  // namespace ocm::cli
