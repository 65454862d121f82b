/// MCAP with what amiroctl knows: chunks packed with zstd are read; written is, beside the frames, which
/// robot and which spec the file is of.
#pragma once

#include <memory>

#include "ocm/log/mcap.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli::logs {

[[nodiscard]] std::unique_ptr<log::Reader> make_mcap_reader(log::Input& input,
                                                            const protocol::Catalogue& catalogue);

/// Frames, and behind each that completes a sample, or is a set point, its physical values.
[[nodiscard]] std::unique_ptr<log::Writer> make_mcap_writer(const protocol::Catalogue& catalogue);
/// Frames only.
[[nodiscard]] std::unique_ptr<log::Writer> make_mcap_raw_writer(const protocol::Catalogue& catalogue);

}  // namespace ocm::cli::logs
