/// What a configuration's streams cost the processors of their boards, where that is known: the AMiRo's
/// boards, whose task sets are measured (spec/tasks.json). Response times of fixed priorities with
/// preemption.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ocm/analysis/verdict.hpp"
#include "ocm/reflective/operator.hpp"

namespace ocm::cli::operate {

/// Of one stream: until its sample has been taken and handed to the bus, from its release on, at worst.
struct ProcessorBound {
  std::uint16_t topic = reflective::none;
  std::size_t stream = 0;  ///< of the configuration `to`, unless it is `old`
  bool old = false;        ///< it ends with the change
  analysis::Explained time;
};

/// Whether what a sample of the topic takes on its board is known.
[[nodiscard]] bool is_measured(const reflective::Operator& tables, std::uint16_t topic);

/// Each stream of which the board's tasks are known, with all that its board does beside it: its own tasks,
/// refusals, the other streams at their shortest period, and one sample more each time an adaptation begins a
/// stream's grid again. Asking again adds none: a stream that has been silent for so long has no sample under
/// way. Of a change, `from` not none: old and new streams
/// together, as on the bus (ocm/reflective/proof.hpp).
[[nodiscard]] std::vector<ProcessorBound> on_processors(const reflective::Operator& tables,
                                                        std::uint16_t from, std::uint16_t to);

}  // namespace ocm::cli::operate
