/// A log to read, whatever it is: a file, a pipe or `-`; plain, gzip or zstd; its format known by what it
/// begins with (and by its name where that says nothing).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "ocm/log/reader.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/logs/file_source.hpp"
#include "cli/logs/format.hpp"

namespace ocm::cli::logs {

class OpenedLog {
 public:
  /// Opens `path` ("-": stdin), as `format` (empty: find out). Leaves through cli::fail, in words, when it
  /// cannot be read, is a directory, is empty (0 bytes), or is of no known format.
  OpenedLog(std::string path, std::string_view format, const protocol::Catalogue& catalogue,
            Reading reading = Reading::until_a_signal);
  ~OpenedLog();

  [[nodiscard]] log::Reader& reader() noexcept { return *reader_; }
  [[nodiscard]] const LogFormat& format() const noexcept { return *format_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Size of the file in bytes, 0 for a pipe.
  [[nodiscard]] std::uint64_t size() const noexcept;

  /// Whether the file could not be read to its end: damaged packing, an error of the disk, a signal.
  [[nodiscard]] bool ended_early() const;

  /// Once at the end: what could not be read, on stderr, by cause and with the first places; whether there
  /// was anything.
  bool complain() const;

 private:
  std::string path_;
  const LogFormat* format_ = nullptr;
  std::unique_ptr<log::Source> file_;
  std::unique_ptr<log::Source> unpacked_;
  std::unique_ptr<log::Input> input_;
  std::unique_ptr<log::Reader> reader_;
};

}  // namespace ocm::cli::logs
