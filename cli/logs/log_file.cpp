#include "cli/logs/log_file.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/host/descriptor.hpp"

#include "cli/logs/packing.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::logs {

struct LogFile::State {
  /// So much is gathered before it is written: large enough for the disk, small enough for the second cache.
  static constexpr std::size_t enough = std::size_t{1} << 18;

  std::string path;
  int descriptor = -1;
  bool regular = false;
  bool made_now = false;  ///< the name was free, or claimed
  bool emptied = false;   ///< what was in the file is gone; not before there is something in its place
  dev_t device = 0;
  ino_t inode = 0;
  bool finished = false;
  std::uint64_t size = 0;
  std::unique_ptr<log::Writer> writer;
  std::unique_ptr<Packer> packer;
  log::Bytes bytes;
  std::string packed;
  transport::Failure failure;

  Signals signals = Signals::reach;

  bool broken = false;  ///< the writer was cut off: it takes no more, and what came before can be written

  /// Whether the name is still of the file that was opened.
  [[nodiscard]] bool is_named() const noexcept {
    struct stat named {};
    return ::stat(path.c_str(), &named) == 0 && named.st_dev == device && named.st_ino == inode;
  }

  /// Deletes what was made for nothing.
  void delete_empty() const noexcept {
    if (regular && size == 0 && made_now && is_named()) ::unlink(path.c_str());
  }

  /// Runs `append`; where that has no memory, nothing of what it appended is written.
  template <class Append>
  void whole(Append append) {
    if (broken) throw std::bad_alloc{};
    const std::size_t before = bytes.size();
    try {
      append();
    } catch (const std::bad_alloc&) {
      bytes.cut(before);
      broken = true;
      throw;
    }
  }

  /// What is in the file: whole records, of which many are written at once.
  [[nodiscard]] std::string kept() const {
    return size == 0 ? "nothing of it was kept" : "what was written before can be read";
  }

  bool failed(std::string_view doing) {
    failure = {fmt::format("cannot {} {}: {}", doing, path == "-" ? "the standard output" : path,
                           std::strerror(errno)),
               errno == ENOSPC  ? "free some space; " + kept()
               : errno == EINTR ? "its reader takes no more, and a signal ended the wait"
                                : kept()};
    return false;
  }

  bool refuse(transport::Failure why) {
    failure = std::move(why);
    if (descriptor >= 0 && path != "-") ::close(descriptor);
    descriptor = -1;
    return false;
  }

  /// Locks an ordinary file: another program may be writing to it.
  bool open(Existing existing) {
    constexpr int how = O_WRONLY | O_CREAT | O_CLOEXEC;
    constexpr ::mode_t all_users = 0666;  // less the umask
    if (path == "-") {
      descriptor = STDOUT_FILENO;
    } else {
      descriptor = ::open(path.c_str(), how | O_EXCL, all_users);
      made_now = descriptor >= 0;
      // A link to no file is one that is there: nothing is made behind it that was not asked for.
      const int again = existing == Existing::refuse ? how & ~O_CREAT : how;
      if (!made_now && errno == EEXIST) descriptor = open_again(again, all_users);
    }
    struct stat status {};
    if (descriptor < 0 || ::fstat(descriptor, &status) != 0) {
      if (errno == EINTR && interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
      failed("write");
      return refuse({failure.what, "name a folder that exists and can be written to"});
    }
    regular = S_ISREG(status.st_mode) && path != "-";  // stdout may be appended to by others
    if (!regular) return true;
    device = status.st_dev;
    inode = status.st_ino;
    // A file system without locks is written to without one.
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      return refuse({fmt::format("another program writes {} now", path), "end it, or give another name"});
    if (!made_now && existing == Existing::refuse) return refuse(exists_failure(path));
    made_now = made_now || existing == Existing::claimed;
    return true;
  }

  /// What is there. A FIFO is open once it has a reader, which is waited for, in words.
  [[nodiscard]] int open_again(int how, ::mode_t all_users) const {
    const int opened = ::open(path.c_str(), how | O_NONBLOCK, all_users);
    if (opened >= 0) {
      ::fcntl(opened, F_SETFL, ::fcntl(opened, F_GETFL) & ~O_NONBLOCK);
      return opened;
    }
    struct stat status {};
    if (errno != ENXIO || ::stat(path.c_str(), &status) != 0) return opened;
    if (S_ISFIFO(status.st_mode))
      remark(fmt::format("{} is a pipe without a reader: one is waited for", path));
    return ::open(path.c_str(), how, all_users);
  }

  /// Whether the disk has room for so much beside what is in the file, or cannot say: takes it for a moment.
  [[nodiscard]] bool has_room(std::size_t more) const noexcept {
    struct stat now {};
    if (!regular || more == 0 || ::fstat(descriptor, &now) != 0) return true;
    const auto length = static_cast<off_t>(more);
    if (::fallocate(descriptor, FALLOC_FL_KEEP_SIZE, now.st_size, length) != 0)
      return errno != ENOSPC && errno != EDQUOT;
    static_cast<void>(!::ftruncate(descriptor, now.st_size));
    return true;
  }

  /// Whether a file may have so much.
  [[nodiscard]] static bool is_allowed(std::size_t size) noexcept {
    rlimit limit{};
    if (::getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur >= size) return true;
    errno = EFBIG;
    return false;
  }

  /// The first time: what was in the file before goes, where `more` bytes can take its place.
  bool empty(std::size_t more) {
    if (!regular || emptied) return true;
    if (!made_now && (!is_allowed(more) || !has_room(more))) return failed("write");
    emptied = true;
    return ::ftruncate(descriptor, 0) == 0 || failed("empty");
  }

  /// A file that takes no more ends where the last call ended, so that it ends with a whole record.
  bool hand_out(std::string_view text) {
    if (!empty(text.size())) return false;
    const Written written = write_all(descriptor, text, signals);
    if (written.error != 0) {
      errno = written.error;
      failed("write");
      // Where that fails, too, the reader of the file finds its last record cut.
      if (regular && written.bytes > 0) static_cast<void>(!::ftruncate(descriptor, static_cast<off_t>(size)));
      return false;
    }
    size += text.size();
    return true;
  }

  bool empty_out(Packer::Until until) {
    if (!failure.what.empty()) return false;
    bool done = true;
    if (packer != nullptr) {
      packed.clear();
      packer->pack(bytes.view(), packed, until);
      done = hand_out(packed);
    } else {
      done = hand_out(bytes.view());
    }
    bytes.clear();
    return done;
  }

  bool empty_when_full() {
    if (!failure.what.empty()) return false;
    return bytes.size() < enough || empty_out(Packer::Until::more);
  }
};

transport::Outcome<std::unique_ptr<LogFile>> LogFile::create(const std::string& path, const LogFormat& format,
                                                             const protocol::Catalogue& catalogue,
                                                             Existing existing) {
  transport::Outcome<std::unique_ptr<LogFile>> made;
  auto state = std::make_unique<State>();
  state->path = path;
  if (format.writer == nullptr) {
    made.error = {fmt::format("{} is read only", format.name), "--to names another format"};
    return made;
  }
  if (const Packing packing = packing_of_name(path); packing != Packing::none) {
    auto packer = make_packer(packing);
    if (!packer) {
      made.error = packer.error;
      return made;
    }
    state->packer = std::move(*packer);
  }
  // Takes what memory it takes before a file is made.
  state->writer = format.writer(catalogue);
  state->writer->begin(state->bytes);
  std::unique_ptr<LogFile> file{new LogFile};
  if (!state->open(existing)) {
    made.error = state->failure;
    return made;
  }
  file->state_ = std::move(state);
  made.value = std::move(file);
  return made;
}

void LogFile::without_signals() noexcept {
  if (!state_->regular) state_->signals = Signals::blocked;
}

LogFile::~LogFile() {
  if (state_ == nullptr) return;
  try {
    finish();
  } catch (const std::bad_alloc&) {
    // As documented: what fails here is lost.
  }
}

bool LogFile::write(std::span<const log::Entry> entries, const log::Interfaces& interfaces) {
  state_->whole([&] { state_->writer->write(state_->bytes, entries, interfaces); });
  return state_->empty_when_full();
}

bool LogFile::recorded(std::span<const log::Recorded> recorded) {
  state_->whole([&] { state_->writer->recorded(state_->bytes, recorded); });
  return state_->empty_when_full();
}

bool LogFile::flush(bool to_disk) {
  state_->whole([&] { state_->writer->flush(state_->bytes); });
  if (!state_->empty_out(Packer::Until::here)) return false;
  if (to_disk && state_->regular && ::fdatasync(state_->descriptor) != 0) return state_->failed("write");
  return true;
}

bool LogFile::finish() {
  if (state_->finished) return state_->failure.what.empty();
  if (!state_->broken) state_->whole([&] { state_->writer->finish(state_->bytes); });
  state_->finished = true;  // without memory for its end it is not: what came before is written next time
  bool done = false;
  try {
    done = state_->empty_out(Packer::Until::ended);
  } catch (const std::bad_alloc&) {  // of what packs
    if (state_->path != "-") ::close(state_->descriptor);
    state_->delete_empty();
    throw;
  }
  if (state_->path != "-" && ::close(state_->descriptor) != 0 && done) done = state_->failed("write");
  if (!done) state_->delete_empty();
  return done;
}

bool LogFile::discard() {
  if (!state_->regular || state_->size != 0) return finish();
  state_->delete_empty();
  if (!std::exchange(state_->finished, true)) ::close(state_->descriptor);
  return state_->failure.what.empty();
}

bool LogFile::has_room() const noexcept {
  return state_->has_room(State::enough);
}

const transport::Failure& LogFile::failure() const noexcept {
  return state_->failure;
}

const log::Losses& LogFile::lost() const noexcept {
  return state_->writer->lost();
}

std::uint64_t LogFile::size() const noexcept {
  return state_->size;
}

const std::string& LogFile::path() const noexcept {
  return state_->path;
}

Place LogFile::place() const noexcept {
  struct stat ours {};
  if (!state_->regular || state_->finished || ::fstat(state_->descriptor, &ours) != 0) return Place::as_named;
  if (ours.st_nlink == 0) return Place::deleted;
  if (ours.st_size >= 0 && static_cast<std::uint64_t>(ours.st_size) < state_->size) return Place::emptied;
  return state_->is_named() ? Place::as_named : Place::elsewhere;
}

transport::Failure exists_failure(const std::string& path) {
  return {fmt::format("{} is there already", path), "give another name, or --force to overwrite it"};
}

bool is_being_written(const std::string& path) {
  const host::Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  return file && ::flock(file.get(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

void tell_losses(const log::Losses& losses, const LogFormat& format) {
  if (!losses.any()) return;
  std::string text;
  for (std::size_t i = 0; i < log::losses; ++i) {
    const auto lost = static_cast<log::Lost>(i);
    if (losses.count(lost) == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", log::describe(lost),
                        counted(losses.count(lost), "frame"));
  }
  remark(fmt::format("{} has no room for {}", format.name, text));
  const LogFormat* const finer = find_format(fmt::format("{}-ns", format.name));
  if (losses.count(log::Lost::time_digits) != 0 && finer != nullptr)
    remark(fmt::format("{} keeps all digits: {}", finer->name, finer->description));
}

}  // namespace ocm::cli::logs
