// Packed logs: any bytes behind a mark of gzip or zstd are unpacked, or are a failure in words; the same
// comes out however small the pieces are in which they come; what is packed here comes out as it went in.
#include <algorithm>
#include <memory>
#include <string>

#include "cli/logs/packing.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using cli::logs::Packing;

namespace {

constexpr std::size_t enough = 1 << 20;  ///< a small input may unpack to gigabytes

class Pieces final : public log::Source {
 public:
  Pieces(std::string_view bytes, std::size_t size) : rest_(bytes), size_(size) {}
  std::size_t read(std::span<char> room) override {
    const std::size_t count = std::min({room.size(), rest_.size(), size_});
    std::copy_n(rest_.begin(), count, room.begin());
    rest_.remove_prefix(count);
    return count;
  }
  [[nodiscard]] const std::string& failure() const override { return failure_; }

 private:
  std::string_view rest_;
  std::size_t size_;
  std::string failure_;
};

struct Unpacked {
  std::string bytes;
  std::string failure;
};

Unpacked unpacked(Packing packing, std::string_view bytes, std::size_t piece) {
  Pieces packed{bytes, piece};
  auto source = cli::logs::unpack(packing, packed);
  fuzz::expect(source.ok(), "this build can unpack");
  Unpacked all;
  std::array<char, 4096> room;
  while (all.bytes.size() < enough) {
    const std::size_t count = (*source)->read(room);
    fuzz::expect(count <= room.size(), "no more comes than there is room for");
    if (count == 0) {
      all.failure = (*source)->failure();
      break;
    }
    all.bytes.append(room.data(), count);
  }
  return all;
}

/// Of damaged bytes as much may come as the library has understood, which depends on the pieces.
void compare(const Unpacked& whole, const Unpacked& in_pieces) {
  fuzz::expect(whole.failure.empty() == in_pieces.failure.empty(), "the size of a piece damages nothing");
  const std::size_t both = std::min(whole.bytes.size(), in_pieces.bytes.size());
  fuzz::expect(whole.bytes.substr(0, both) == in_pieces.bytes.substr(0, both), "what comes is the same");
  if (whole.failure.empty())
    fuzz::expect(whole.bytes.size() == in_pieces.bytes.size() || both >= enough, "and it is all there");
}

std::string packed(Packing packing, std::string_view bytes) {
  auto packer = cli::logs::make_packer(packing);
  fuzz::expect(packer.ok(), "this build can pack");
  std::string out;
  const std::size_t half = bytes.size() / 2;
  (*packer)->pack(bytes.substr(0, half), out, cli::logs::Packer::Until::here);
  fuzz::expect(unpacked(packing, out, out.size()).bytes == bytes.substr(0, half),
               "what was handed on can be read");
  (*packer)->pack(bytes.substr(half), out, cli::logs::Packer::Until::ended);
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::text_of(data, size);
  for (const Packing packing : {Packing::gzip, Packing::zstd}) {
    if (cli::logs::packing_of(text) == packing)
      compare(unpacked(packing, text, text.size()), unpacked(packing, text, 7));
    const auto again = unpacked(packing, packed(packing, text), 1000);
    fuzz::expect(again.failure.empty() && again.bytes == text, "what is packed comes out as it went in");
  }
  return 0;
}
