/// zlib for the reader of BLF, which brings no decompressor of its own.
#pragma once

#include "ocm/log/blf.hpp"

namespace ocm::cli::logs {

/// nullptr in a build without zlib: packed containers are then complained of.
[[nodiscard]] log::Inflate zlib_inflate();

}  // namespace ocm::cli::logs
