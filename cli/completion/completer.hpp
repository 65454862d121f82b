/// What could come next on a command line: read off the options that the verbs declare, the robot's topics
/// and the buses of this machine, so that it stays right when they change.
#pragma once

#include <string>
#include <vector>

#include "cli/shared/arguments.hpp"
#include "cli/shared/session.hpp"

namespace ocm::cli {

struct Candidate {
  std::string word;
  std::string what;  ///< for shells that show it; may be empty
};

struct Completion {
  std::vector<Candidate> candidates;
  bool files = false;  ///< names of files would do, too
};

/// `words` are those behind the program's name; the last is the one that is being typed, and may be empty.
/// Candidates begin with it. A `--spec` or `--bus` among the words is heeded; a spec that cannot be read
/// gives no topics.
[[nodiscard]] Completion complete(Verb program, Session& session, const std::vector<std::string>& words);

}  // namespace ocm::cli
