/// The file that a recording goes into, or the files: a new one at a size or a time, the oldest deleted where
/// only the newest are kept, those of earlier recordings included. Every frame is in exactly one of them, in
/// order. No clock is read: the time is handed in.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/logs/format.hpp"
#include "cli/logs/log_file.hpp"
#include "cli/record/frame_clock.hpp"
#include "cli/record/names.hpp"

namespace ocm::cli::record {

/// When a file is full. Zero: never.
struct Split {
  std::uint64_t size = 0;  ///< bytes that were written to it
  base::Duration time{};   ///< from its first frame, by FrameClock
  [[nodiscard]] bool any() const noexcept { return size != 0 || time > base::Duration::zero(); }
};

struct FilesOptions {
  std::string path;  ///< "-": stdout; of a recording in several files the name that is numbered
  const logs::LogFormat* format = nullptr;
  Split split;
  std::uint64_t ring = 0;  ///< keep this many of the name, earlier recordings included; 0: all
  bool overwrite = false;
  bool numbers_free = false;  ///< the name was not chosen by the user: a free one near it may be taken
  bool sync = true;
};

class Files {
 public:
  Files(FilesOptions options, const protocol::Catalogue& catalogue);

  /// The first file. The failure names the file and says what to do.
  [[nodiscard]] transport::Outcome<void> open();

  /// Each: false when a file takes no more: `failure` says why. `now` is of a monotonic clock, when the
  /// entries were fetched.
  [[nodiscard]] bool write(std::span<const log::Entry> entries, const log::Interfaces& interfaces,
                           base::Duration now);
  /// What was taken so far goes to the kernel, and to the disk where that is asked for. Notices a file that
  /// was deleted meanwhile.
  [[nodiscard]] bool flush();
  /// Once, at the end, also after a failure.
  [[nodiscard]] bool finish() { return finish(Next::none); }

  /// Of every interface, by its number: frames that were on the bus and could not be written, so far.
  /// `interfaces` must outlive this, or its `finish`.
  void set_dropped(std::span<const std::uint64_t> dropped, const log::Interfaces& interfaces) {
    dropped_.assign(dropped.begin(), dropped.end());
    interfaces_ = &interfaces;
  }

  [[nodiscard]] const transport::Failure& failure() const noexcept { return failure_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return finished_size_ + (file_ ? file_->size() : 0); }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }     ///< files
  [[nodiscard]] const std::string& path() const noexcept { return path_; }  ///< of the newest
  [[nodiscard]] const std::string& first_path() const noexcept { return first_path_; }
  /// What the format could not hold, of all files that are finished.
  [[nodiscard]] const log::Losses& losses() const noexcept { return losses_; }
  [[nodiscard]] std::uint64_t deleted() const noexcept { return deleted_; }  ///< to make room in the ring
  /// Whether the newest file was deleted at the end, because a ring keeps none without a frame.
  [[nodiscard]] bool keeps_none() const noexcept { return keeps_none_; }

  /// After a failure: how many frames can be read back. Reads the last file once more.
  [[nodiscard]] std::uint64_t readable() const;

 private:
  [[nodiscard]] std::size_t entries_before_split(std::span<const log::Entry> entries);
  [[nodiscard]] transport::Outcome<void> join_ring();
  /// Whether a file is made with its name, and none overwritten. In a ring all that may be overwritten comes
  /// before the number.
  [[nodiscard]] bool claims() const { return !options_.overwrite || options_.ring != 0; }
  [[nodiscard]] transport::Outcome<std::string> claim_next();
  [[nodiscard]] transport::Outcome<void> open_next();
  [[nodiscard]] bool append(std::span<const log::Entry> entries, const log::Interfaces& interfaces);
  [[nodiscard]] bool failed(const transport::Failure& failure);
  [[nodiscard]] bool next_file();
  enum class Next : bool { file, none };
  [[nodiscard]] bool is_in_place();
  [[nodiscard]] bool finish(Next next);
  void delete_oldest();
  void delete_newest();

  FilesOptions options_;
  const protocol::Catalogue* catalogue_;
  FileName name_;
  std::unique_ptr<logs::LogFile> file_;
  transport::Failure failure_;
  std::string path_;
  std::string first_path_;
  std::deque<std::string> kept_;
  bool finished_ = true;
  std::uint64_t number_ = 0;  ///< of the newest file's name
  std::uint64_t count_ = 0;
  std::uint64_t deleted_ = 0;
  bool keeps_none_ = false;
  std::uint64_t finished_size_ = 0;
  std::uint64_t finished_entries_ = 0;
  std::uint64_t entries_ = 0;  ///< in the newest file
  FrameClock clock_;
  std::optional<base::Duration> begin_;  ///< of the newest file: when its first frame came
  bool elsewhere_ = false;               ///< the newest file has another name by now
  log::Losses losses_;
  std::vector<log::Recorded> recorded_;  ///< of the newest file
  std::vector<std::uint64_t> dropped_;
  const log::Interfaces* interfaces_ = nullptr;
  std::vector<std::uint64_t> told_dropped_;  ///< in the files before
};

}  // namespace ocm::cli::record
