#include "cli/logs/mcap.hpp"

#include <fmt/format.h>

#include "ocm/protocol/wire_hash.hpp"

#include "cli/logs/mcap_samples.hpp"

#if OCM_HAS_ZSTD
#include <zstd.h>
#endif

namespace ocm::cli::logs {
namespace {

#if OCM_HAS_ZSTD
std::size_t unzstd(std::string_view packed, std::span<char> into) {
  const std::size_t size = ZSTD_decompress(into.data(), into.size(), packed.data(), packed.size());
  return ZSTD_isError(size) != 0 ? 0 : size;
}
#else
constexpr log::Unzstd unzstd = nullptr;
#endif

constexpr auto library = "amiroctl " OCM_VERSION;

log::McapWriter::About about(const protocol::Catalogue& catalogue) {
  return {{"robot", std::string{catalogue.robot}},
          {"wire_hash", fmt::format("0x{:08X}", protocol::wire_hash(catalogue))},
          {"tool", library}};
}

/// Each frame, and what it completes.
class Writer final : public log::McapWriter {
 public:
  explicit Writer(const protocol::Catalogue& catalogue)
      : McapWriter(library, about(catalogue)), samples_(catalogue) {}

  void write(log::Bytes& out, std::span<const log::Entry> entries,
             const log::Interfaces& interfaces) override {
    for (const log::Entry& entry : entries) {
      put(out, entry, interfaces);
      samples_.put(out, container(), entry, time_of(entry), interfaces);
    }
  }

 private:
  McapSamples samples_;
};

}  // namespace

std::unique_ptr<log::Reader> make_mcap_reader(log::Input& input, const protocol::Catalogue&) {
  return std::make_unique<log::McapReader>(input, unzstd);
}

std::unique_ptr<log::Writer> make_mcap_writer(const protocol::Catalogue& catalogue) {
  return std::make_unique<Writer>(catalogue);
}

std::unique_ptr<log::Writer> make_mcap_raw_writer(const protocol::Catalogue& catalogue) {
  return std::make_unique<log::McapWriter>(library, about(catalogue));
}

}  // namespace ocm::cli::logs
