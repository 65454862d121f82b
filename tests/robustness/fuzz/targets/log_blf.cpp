// A binary log of Vector's: whatever it is, it is read to its end, around damage; what is read can exist.
// Packed containers repeat their content, at most ten times: enough to make more of it than the file has.
#include "ocm/log/blf.hpp"

#include "tests/robustness/fuzz/log_rewrite.hpp"

using namespace ocm;

namespace {

std::size_t repeat(std::string_view packed, std::span<char> into) {
  if (packed.empty()) return 0;
  const std::size_t times = static_cast<unsigned char>(packed.front()) % 10;
  packed.remove_prefix(1);
  std::size_t count = 0;
  for (std::size_t i = 0; i < times; ++i)
    for (const char c : packed)
      if (count < into.size()) into[count++] = c;
  return count;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  (void)log::BlfReader::recognises(bytes);
  log::Interfaces interfaces;
  std::uint64_t complaints = 0;
  const auto entries = fuzz::read_log<log::BlfReader>(bytes, interfaces, complaints, log::Inflate{repeat});
  fuzz::expect(entries.size() <= 10 * size, "no more is read than is there");
  return 0;
}
