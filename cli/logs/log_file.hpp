/// A log that is written to a file, to a pipe or to stdout (`-`): collects what the writer appends and writes
/// it in large pieces; tells a full disk.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "ocm/base/result.hpp"
#include "ocm/log/writer.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/logs/format.hpp"

namespace ocm::cli::logs {

/// What happens to an ordinary file that has the name already. Pipes and devices are written to in any case.
enum class Existing : std::uint8_t {
  refuse,
  overwrite,
  claimed,  ///< it is empty, and the caller has just made it
};

/// Where an ordinary file is, some time after it was created.
enum class Place : std::uint8_t {
  as_named,   ///< also what is no ordinary file
  deleted,    ///< nothing names it any more: what is written to it is lost
  emptied,    ///< it is shorter than what was written to it
  elsewhere,  ///< its name is of no file, or of another
};

class LogFile {
 public:
  /// Creates `path`; a name that ends in .gz or .zst is compressed. The failure says what and what to do. A
  /// file that another program of ocm writes to is refused: theirs holds a lock (flock) while it is open.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<LogFile>> create(
      const std::string& path, const LogFormat& format, const protocol::Catalogue& catalogue,
      Existing existing);
  /// Finishes, if that was not done; what fails then is lost: call `finish`.
  ~LogFile();

  /// For a thread that no signal reaches: a pipe is then written so that a signal is seen all the same.
  void without_signals() noexcept;

  /// Each: false when the file takes no more (a full disk): `failure` says it; what was written before can be
  /// read.
  bool write(std::span<const log::Entry> entries, const log::Interfaces& interfaces);
  bool recorded(std::span<const log::Recorded> recorded);
  /// Hands all that was taken so far to the kernel; with `to_disk` waits until the disk has it (fdatasync).
  bool flush(bool to_disk = false);
  /// Writes the end of the format, flushes and closes. Where the file took nothing of all that, an ordinary
  /// one that was made for it is deleted, so that the next try finds the name free.
  bool finish();
  /// In place of `finish`, where no frame could be read: deletes such a file; one that was there before is as
  /// it was. Where something was written, or is read as it comes, it finishes.
  bool discard();

  /// Whether the disk has room for what is written at once, or cannot say. Three system calls. Before
  /// `finish`.
  [[nodiscard]] bool has_room() const noexcept;
  [[nodiscard]] const transport::Failure& failure() const noexcept;
  [[nodiscard]] const log::Losses& lost() const noexcept;
  [[nodiscard]] std::uint64_t size() const noexcept;  ///< bytes written to the file
  [[nodiscard]] const std::string& path() const noexcept;
  /// Two system calls. Before `finish`.
  [[nodiscard]] Place place() const noexcept;

  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

 private:
  LogFile() = default;
  struct State;
  std::unique_ptr<State> state_;
};

/// Of a file that is there and may not be overwritten.
[[nodiscard]] transport::Failure exists_failure(const std::string& path);
/// Whether a program of ocm has the file open as a LogFile.
[[nodiscard]] bool is_being_written(const std::string& path);

/// What the format could not hold, on stderr, one line; nothing when that is nothing.
void tell_losses(const log::Losses& losses, const LogFormat& format);

}  // namespace ocm::cli::logs
