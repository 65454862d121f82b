#include "cli/logs/packing.hpp"

#include <array>
#include <cstddef>
#include <new>

#if OCM_HAS_ZLIB
#include <zlib.h>
#endif
#if OCM_HAS_ZSTD
#include <zstd.h>
#endif

namespace ocm::cli::logs {

Packing packing_of(std::string_view beginning) {
  if (beginning.starts_with("\x1F\x8B")) return Packing::gzip;          // [RFC 1952, 2.3.1]
  if (beginning.starts_with("\x28\xB5\x2F\xFD")) return Packing::zstd;  // [RFC 8878, 3.1.1]
  return Packing::none;
}

Packing packing_of_name(std::string_view file) {
  if (file.ends_with(".gz")) return Packing::gzip;
  if (file.ends_with(".zst")) return Packing::zstd;
  return Packing::none;
}

namespace {

/// Packed bytes as they come, in pieces.
class Pieces {
 public:
  explicit Pieces(log::Source& source) : source_(source) {}
  /// false: the source is at its end.
  bool more() {
    end_ = source_.read(bytes_);
    begin_ = 0;
    return end_ != 0;
  }
  [[nodiscard]] bool empty() const { return begin_ == end_; }
  [[nodiscard]] std::span<char> rest() { return std::span{bytes_}.subspan(begin_, end_ - begin_); }
  void take(std::size_t count) { begin_ += count; }
  [[nodiscard]] const std::string& failure() const { return source_.failure(); }

 private:
  log::Source& source_;
  std::array<char, 1 << 16> bytes_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

#if OCM_HAS_ZLIB
constexpr int gzip_window = 15 + 16;  // the largest window, in the frame of gzip [zlib.h]

class GzipSource final : public log::Source {
 public:
  explicit GzipSource(log::Source& packed) : pieces_(packed) {
    if (inflateInit2(&stream_, gzip_window) != Z_OK) throw std::bad_alloc{};
  }
  ~GzipSource() override { inflateEnd(&stream_); }

  std::size_t read(std::span<char> into) override {
    stream_.next_out = reinterpret_cast<Bytef*>(into.data());
    stream_.avail_out = static_cast<uInt>(into.size());
    while (stream_.avail_out == into.size() && failure_.empty() && !ended_) step();
    return into.size() - stream_.avail_out;
  }
  [[nodiscard]] const std::string& failure() const override { return failure_; }

 private:
  void step() {
    if (pieces_.empty() && !pieces_.more()) {
      ended_ = true;
      failure_ = pieces_.failure();
      if (failure_.empty() && within_) failure_ = "the gzip data ends in the middle";
      return;
    }
    if (!within_) {  // members follow each other; tapes and tools pad with zeros
      if (pieces_.rest().front() == '\0' && members_ > 0) return pieces_.take(1);
      inflateReset(&stream_);
      within_ = true;
    }
    const auto rest = pieces_.rest();
    stream_.next_in = reinterpret_cast<Bytef*>(rest.data());
    stream_.avail_in = static_cast<uInt>(rest.size());
    const int result = inflate(&stream_, Z_NO_FLUSH);
    pieces_.take(rest.size() - stream_.avail_in);
    if (result == Z_STREAM_END) {
      within_ = false;
      ++members_;
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
      failure_ = std::string{"the gzip data is damaged: "} + (stream_.msg != nullptr ? stream_.msg : "zlib");
    }
  }

  Pieces pieces_;
  z_stream stream_{};
  bool within_ = true;
  bool ended_ = false;
  std::size_t members_ = 0;
  std::string failure_;
};

class GzipPacker final : public Packer {
 public:
  GzipPacker() {
    constexpr int memory = 8;  // zlib's default
    if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, gzip_window, memory, Z_DEFAULT_STRATEGY) !=
        Z_OK)
      throw std::bad_alloc{};
  }
  ~GzipPacker() override { deflateEnd(&stream_); }

  void pack(std::string_view bytes, std::string& out, Until until) override {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib does not write there
    stream_.avail_in = static_cast<uInt>(bytes.size());
    const int flush = until == Until::more ? Z_NO_FLUSH : until == Until::here ? Z_SYNC_FLUSH : Z_FINISH;
    do {
      stream_.next_out = reinterpret_cast<Bytef*>(piece_.data());
      stream_.avail_out = static_cast<uInt>(piece_.size());
      deflate(&stream_, flush);
      out.append(piece_.data(), piece_.size() - stream_.avail_out);
    } while (stream_.avail_out == 0);
  }

 private:
  z_stream stream_{};
  std::array<char, 1 << 16> piece_;
};
#endif

#if OCM_HAS_ZSTD
class ZstdSource final : public log::Source {
 public:
  explicit ZstdSource(log::Source& packed) : pieces_(packed), stream_(ZSTD_createDStream()) {
    if (stream_ == nullptr) throw std::bad_alloc{};
  }
  ~ZstdSource() override { ZSTD_freeDStream(stream_); }

  std::size_t read(std::span<char> into) override {
    ZSTD_outBuffer out{into.data(), into.size(), 0};
    while (out.pos == 0 && failure_.empty() && !ended_) step(out);
    return out.pos;
  }
  [[nodiscard]] const std::string& failure() const override { return failure_; }

 private:
  void step(ZSTD_outBuffer& out) {
    // What the decoder still holds comes out without more input.
    if (pieces_.empty() && !held_ && !pieces_.more()) {
      ended_ = true;
      failure_ = pieces_.failure();
      if (failure_.empty() && within_) failure_ = "the zstd data ends in the middle";
      return;
    }
    const auto rest = pieces_.rest();
    ZSTD_inBuffer in{rest.data(), rest.size(), 0};
    const std::size_t left = ZSTD_decompressStream(stream_, &out, &in);
    pieces_.take(in.pos);
    if (ZSTD_isError(left) != 0)
      failure_ = std::string{"the zstd data is damaged: "} + ZSTD_getErrorName(left);
    else
      within_ = left != 0;
    held_ = within_ && out.pos == out.size;
  }

  Pieces pieces_;
  ZSTD_DStream* stream_;
  bool within_ = false;
  bool held_ = false;
  bool ended_ = false;
  std::string failure_;
};

class ZstdPacker final : public Packer {
 public:
  ZstdPacker() : stream_(ZSTD_createCStream()) {
    if (stream_ == nullptr) throw std::bad_alloc{};
    ZSTD_CCtx_setParameter(stream_, ZSTD_c_checksumFlag, 1);
  }
  ~ZstdPacker() override { ZSTD_freeCStream(stream_); }

  void pack(std::string_view bytes, std::string& out, Until until) override {
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    const ZSTD_EndDirective end = until == Until::more   ? ZSTD_e_continue
                                  : until == Until::here ? ZSTD_e_flush
                                                         : ZSTD_e_end;
    for (;;) {
      ZSTD_outBuffer piece{piece_.data(), piece_.size(), 0};
      const std::size_t left = ZSTD_compressStream2(stream_, &piece, &in, end);
      if (ZSTD_isError(left) != 0) throw std::bad_alloc{};  // nothing else can fail here
      out.append(piece_.data(), piece.pos);
      if (end == ZSTD_e_continue ? in.pos == in.size : left == 0) return;
    }
  }

 private:
  ZSTD_CStream* stream_;
  std::array<char, 1 << 16> piece_;
};
#endif

[[maybe_unused]] transport::Failure left_out(std::string_view what, std::string_view missing,
                                             std::string_view program) {
  return {std::string{"this amiroctl was built without "} + std::string{missing} + " and cannot do " +
              std::string{what},
          std::string{"unpack or pack the file with "} + std::string{program}};
}

}  // namespace

transport::Outcome<std::unique_ptr<log::Source>> unpack(Packing packing,
                                                        [[maybe_unused]] log::Source& packed) {
  transport::Outcome<std::unique_ptr<log::Source>> made;
  if (packing == Packing::gzip) {
#if OCM_HAS_ZLIB
    made.value = std::make_unique<GzipSource>(packed);
#else
    made.error = left_out("gzip", "zlib", "gzip");
#endif
  }
  if (packing == Packing::zstd) {
#if OCM_HAS_ZSTD
    made.value = std::make_unique<ZstdSource>(packed);
#else
    made.error = left_out("zstd", "libzstd", "zstd");
#endif
  }
  return made;
}

transport::Outcome<std::unique_ptr<Packer>> make_packer(Packing packing) {
  transport::Outcome<std::unique_ptr<Packer>> made;
  if (packing == Packing::gzip) {
#if OCM_HAS_ZLIB
    made.value = std::make_unique<GzipPacker>();
#else
    made.error = left_out("gzip", "zlib", "gzip");
#endif
  }
  if (packing == Packing::zstd) {
#if OCM_HAS_ZSTD
    made.value = std::make_unique<ZstdPacker>();
#else
    made.error = left_out("zstd", "libzstd", "zstd");
#endif
  }
  return made;
}

}  // namespace ocm::cli::logs
