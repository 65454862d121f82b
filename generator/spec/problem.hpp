/// What is wrong with a spec.
#pragma once

#include <string>

namespace ocm::spec {

struct Problem {
  std::string place;   ///< "file:line:column" for syntax, else "file:line: /json/path"
  std::string what;    ///< what is wrong, naming the input
  std::string remedy;  ///< what would be right
  friend bool operator==(const Problem&, const Problem&) = default;
};

}  // namespace ocm::spec
