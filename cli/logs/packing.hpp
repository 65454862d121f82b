/// gzip and zstd around a log: unpacks what is read and packs what is written, in constant memory. A build
/// without zlib or libzstd says so when it meets such a file.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "ocm/log/input.hpp"
#include "ocm/transport/bus.hpp"

namespace ocm::cli::logs {

enum class Packing { none, gzip, zstd };

/// By the first bytes of a file (four are enough).
[[nodiscard]] Packing packing_of(std::string_view beginning);
/// By the ending of a file's name.
[[nodiscard]] Packing packing_of_name(std::string_view file);

/// `packed` outlives what is made. A packed file that ends in the middle is a `failure` of the source, as is
/// one that is damaged.
[[nodiscard]] transport::Outcome<std::unique_ptr<log::Source>> unpack(Packing packing, log::Source& packed);

/// Takes bytes and hands on packed ones.
class Packer {
 public:
  /// What the reader can do with what was handed on.
  enum class Until {
    more,   ///< nothing yet: pack well
    here,   ///< can read all that was taken so far
    ended,  ///< the file ends here
  };
  Packer() = default;
  Packer(const Packer&) = delete;
  Packer& operator=(const Packer&) = delete;
  virtual ~Packer() = default;
  virtual void pack(std::string_view bytes, std::string& out, Until until) = 0;
};

[[nodiscard]] transport::Outcome<std::unique_ptr<Packer>> make_packer(Packing packing);

}  // namespace ocm::cli::logs
