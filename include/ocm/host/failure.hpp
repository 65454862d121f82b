/// What a program on Linux says when the system or a device does not do what it asked for. Host only.
#pragma once

#include <string>

#include "ocm/base/result.hpp"

namespace ocm::host {

/// What went wrong, said to a person: what and where, and what to do about it.
struct Failure {
  std::string what;
  std::string remedy;
  friend bool operator==(const Failure&, const Failure&) = default;
};

template <class T>
using Outcome = base::Result<T, Failure>;

}  // namespace ocm::host
