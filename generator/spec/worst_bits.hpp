/// How long the frames of a spec can become, exactly: what `worst_bits` says beside each frame.
#pragma once

#include <cstdint>

#include "ocm/protocol/topic.hpp"

namespace ocm::spec {

/// By priority. The first call takes 2.25 MiB and some 15 ms, once; from one thread at a time.
[[nodiscard]] protocol::BitsByPriority worst_bits(protocol::Kind kind, unsigned id, std::uint8_t dlc);

}  // namespace ocm::spec
