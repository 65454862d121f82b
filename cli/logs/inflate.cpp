#include "cli/logs/inflate.hpp"

#if OCM_HAS_ZLIB
#include <zlib.h>
#endif

namespace ocm::cli::logs {

#if OCM_HAS_ZLIB
namespace {

/// Of damaged data what comes before the damage.
std::size_t unpack(std::string_view packed, std::span<char> into) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return 0;
  // zlib takes what it reads through a pointer to data that it does not change.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(into.data());
  stream.avail_out = static_cast<uInt>(into.size());
  inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  return into.size() - stream.avail_out;
}

}  // namespace

log::Inflate zlib_inflate() {
  return unpack;
}
#else
log::Inflate zlib_inflate() {
  return nullptr;
}
#endif

}  // namespace ocm::cli::logs
