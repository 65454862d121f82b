/// A chain from a sensor to a motor over tasks and frames, bounded by ocm/analysis/chain.hpp.
#pragma once

#include <string>
#include <vector>

#include "ocm/analysis/chain.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/analyse/set.hpp"
#include "cli/analyse/study.hpp"

namespace ocm::cli::analyse {

struct ChainStudy {
  std::vector<HopEntry> entries;
  std::vector<analysis::Hop> hops;
  analysis::ChainBound bound;
  std::int64_t deadline = analysis::unbounded;  ///< unbounded: none given
};

/// The file's hops, in the sets that they name. `options.lengths` is for sets of files; the robot's are
/// exact.
[[nodiscard]] ChainStudy study_chain(const std::string& file, std::int64_t deadline,
                                     const BusOptions& options, const protocol::Catalogue& catalogue,
                                     const spec::Model* model, const std::vector<Rate>& rates);

[[nodiscard]] std::string to_json(const ChainStudy& study);
[[nodiscard]] std::string to_csv(const ChainStudy& study);
[[nodiscard]] std::string to_table(const ChainStudy& study);

}  // namespace ocm::cli::analyse
