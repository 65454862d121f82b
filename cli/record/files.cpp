#include "cli/record/files.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/host/descriptor.hpp"

#include "cli/logs/opened_log.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::record {
namespace {

/// Reading back more would delay a message too long.
constexpr std::uint64_t most_to_read_back = std::uint64_t{1} << 30;

/// Whether it did.
bool remove(const std::string& path) {
  if (::unlink(path.c_str()) == 0) return true;
  if (errno != ENOENT)  // another program may have removed it, which is the aim
    remark(fmt::format("cannot delete {}: {}", path, std::strerror(errno)));
  return false;
}

/// Two recordings that begin at once join a ring one after the other: the second sees the file of the first.
/// As long as what is returned is there; a file system without locks has none.
transport::Outcome<host::Descriptor> take_turn(const std::string& stem) {
  const std::string parent = std::filesystem::path{stem}.parent_path().string();
  const std::string folder = parent.empty() ? "." : parent;
  host::Descriptor lock{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  constexpr int most_looks = 200;
  for (int looks = 0; lock && ::flock(lock.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; ++looks) {
    if (looks == most_looks)
      return transport::Failure{
          fmt::format("another program begins a recording in {}, and has not come to its first file", folder),
          "is it stopped? Let it go on, or end it"};
    sleep_for(std::chrono::milliseconds{10});
    if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
  }
  return lock;
}

}  // namespace

Files::Files(FilesOptions options, const protocol::Catalogue& catalogue)
    : options_(std::move(options)),
      catalogue_(&catalogue),
      name_(split_name(options_.path, options_.format->ending)) {}

transport::Outcome<void> Files::open() {
  transport::Outcome<host::Descriptor> turn;
  if (options_.ring != 0) turn = take_turn(name_.stem);
  if (!turn) return std::move(turn.error);
  if (auto joined = join_ring(); !joined) return joined;
  auto opened = open_next();
  if (!opened) return opened;
  first_path_ = path_;
  return opened;
}

/// A ring is a budget of the folder: what recordings of the same name have left counts, and goes first.
transport::Outcome<void> Files::join_ring() {
  if (options_.ring == 0) return {};
  auto there = numbered_files(name_);
  const std::string all = fmt::format("{}_*{}", name_.stem, name_.ending);
  for (const auto& file : there) {
    if (logs::is_being_written(file.path))
      return transport::Failure{fmt::format("another program records to {} now", file.path),
                                "end it, or give another name"};
    if (::access(file.path.c_str(), R_OK) != 0)  // it may be written all the same
      return transport::Failure{fmt::format("cannot look whether another program records to {}: {}",
                                            file.path, std::strerror(errno)),
                                "give another name, or record as the user that has recorded it"};
  }
  if (there.empty()) return {};
  number_ = there.back().number;
  // What a recording leaves that was killed before its first frame takes the place of none, and goes first.
  const auto full = std::stable_partition(there.begin(), there.end(), [](const auto& file) {
    std::error_code unreadable;
    return std::filesystem::file_size(file.path, unreadable) == 0 && !unreadable;
  });
  const auto holds = static_cast<std::size_t>(there.end() - full);
  // One more than the ring has is what a recording leaves that was cut off while it changed files.
  if (holds != 0 && holds - 1 > options_.ring && !options_.overwrite)
    return transport::Failure{fmt::format("{} files {} are there, and --ring {} would delete {} of them now",
                                          holds, all, options_.ring, holds + 1 - options_.ring),
                              "give another name, or --force to delete them"};
  for (const auto& file : there) kept_.push_back(file.path);
  if (holds != 0)
    remark(fmt::format("the ring holds {} of earlier recordings, {}; the oldest go first",
                       counted(holds, "file"), all));
  return {};
}

/// The name of the next file, with an empty file of ours in its place.
transport::Outcome<std::string> Files::claim_next() {
  if (options_.path == "-") return options_.path;
  for (;;) {
    ++number_;
    std::string path = options_.split.any() ? numbered(name_, number_)
                       : number_ == 1       ? options_.path
                                            : fmt::format("{}-{}{}", name_.stem, number_, name_.ending);
    const auto devices = path == options_.path ? Devices::ours : Devices::taken;
    switch (claims() ? claim(path, devices) : Claimed::ours) {
      case Claimed::ours:
        return path;
      case Claimed::failed:
        return transport::Failure{fmt::format("cannot create {}: {}", path, std::strerror(errno)),
                                  "name a file in a folder that is there and that you may write to"};
      case Claimed::taken:
        // Of a name that the user gave only the later numbers may be chosen freely.
        if (count_ == 0 && !options_.numbers_free && options_.ring == 0) return logs::exists_failure(path);
        break;
    }
  }
}

transport::Outcome<void> Files::open_next() {
  auto path = claim_next();
  if (!path) return std::move(path.error);
  const auto existing = claims() ? logs::Existing::claimed : logs::Existing::overwrite;
  auto file = logs::LogFile::create(*path, *options_.format, *catalogue_, existing);
  if (!file) return std::move(file.error);
  file_ = std::move(file.value);
  file_->without_signals();  // they are for the thread that receives
  path_ = *path;
  finished_ = false;
  kept_.push_back(path_);
  ++count_;
  entries_ = 0;
  begin_.reset();
  elsewhere_ = false;
  std::fill(recorded_.begin(), recorded_.end(), log::Recorded{});
  if (options_.ring != 0 && !file_->has_room()) delete_oldest();
  return {};
}

/// How many of the entries still belong into the newest file.
std::size_t Files::entries_before_split(std::span<const log::Entry> entries) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const base::Duration came = clock_.at(entries[i]);
    if (!begin_) begin_ = came;
    if (came - *begin_ >= options_.split.time) return i;
  }
  return entries.size();
}

bool Files::write(std::span<const log::Entry> entries, const log::Interfaces& interfaces,
                  base::Duration now) {
  clock_.fetched(entries, now);
  while (!entries.empty()) {
    // Only now that a frame follows: the recording would leave an empty file at its end.
    if (options_.split.size != 0 && file_->size() >= options_.split.size && !next_file()) return false;
    std::size_t count = entries.size();
    if (options_.split.time > base::Duration::zero()) count = entries_before_split(entries);
    if (count == 0) {
      if (!next_file()) return false;
      continue;
    }
    if (!append(entries.first(count), interfaces)) return false;
    entries = entries.subspan(count);
    if (options_.split.size == 0) continue;
    // What a buffer holds back has no size yet.
    if (!file_->flush()) return failed(file_->failure());
    delete_oldest();
  }
  return true;
}

bool Files::append(std::span<const log::Entry> entries, const log::Interfaces& interfaces) {
  recorded_.resize(std::max(recorded_.size(), interfaces.size()));
  for (const auto& entry : entries) ++recorded_[entry.interface].received;
  entries_ += entries.size();
  // What is written to a file that was emptied makes it as long as it should be.
  if (!is_in_place()) return false;
  if (file_->write(entries, interfaces)) return true;
  return failed(file_->failure());
}

bool Files::flush() {
  // A file of a ring is empty up to its first frame, whatever its format begins with.
  if (options_.ring != 0 && entries_ == 0) return is_in_place();
  if (!is_in_place()) return false;
  if (!file_->flush(options_.sync)) return failed(file_->failure());
  delete_oldest();
  return is_in_place();
}

/// What cannot be read any more is not recorded: that ends the recording. What has another name by now is
/// said at the end, so that all of it is there.
bool Files::is_in_place() {
  using logs::Place;
  switch (file_->place()) {
    case Place::as_named:
      return true;
    case Place::deleted:
      return failed({fmt::format("{} was deleted while it was recorded, and its frames with it", path_),
                     "record again; --split keeps what was recorded before in files of its own"});
    case Place::emptied:
      return failed({fmt::format("{} was emptied by another program while it was recorded", path_),
                     "record again, to a name that no other program uses"});
    case Place::elsewhere:
      elsewhere_ = true;
      break;
  }
  return true;
}

bool Files::finish(Next next) {
  if (finished_) return failure_.what.empty();
  finished_ = true;
  recorded_.resize(std::max(recorded_.size(), dropped_.size()));
  told_dropped_.resize(recorded_.size());
  for (std::size_t i = 0; i < dropped_.size(); ++i)
    recorded_[i].dropped = dropped_[i] - std::exchange(told_dropped_[i], dropped_[i]);
  // A file without a frame does not have the names of the interfaces yet.
  const bool any_dropped = std::any_of(recorded_.begin(), recorded_.end(),
                                       [](const log::Recorded& recorded) { return recorded.dropped != 0; });
  if (entries_ == 0 && any_dropped) static_cast<void>(file_->write({}, *interfaces_));
  // finish whatever happens: it closes the file. What it writes then must be on the disk, too.
  const bool told =
      is_in_place() && file_->recorded(recorded_) && file_->flush(options_.sync) && is_in_place();
  const bool done = file_->finish() && told;
  if (done && (entries_ != 0 || any_dropped))
    delete_oldest();
  else if (done && next == Next::none && !elsewhere_)
    delete_newest();
  for (std::size_t i = 0; i < log::losses; ++i) {
    const auto lost = static_cast<log::Lost>(i);
    // No format has less than microseconds, and no bus of at most 1 Mbit/s says more: a bit takes that long.
    if (lost != log::Lost::time_digits) losses_.add(lost, file_->lost().count(lost));
  }
  if (done && elsewhere_ && next == Next::none)
    return failed(
        {fmt::format("{} was moved while it was recorded: its frames are where it was moved to", path_),
         "look for it there; another file may have its name now"});
  return done || failed(file_->failure());
}

bool Files::next_file() {
  if (!finish(Next::file)) return false;
  finished_size_ += file_->size();
  finished_entries_ += entries_;
  if (const auto opened = open_next(); !opened) {
    entries_ = 0;
    return failed(opened.error);
  }
  return true;
}

/// Once the newest file has a frame in it, or to make room for one.
void Files::delete_oldest() {
  while (options_.ring != 0 && kept_.size() > options_.ring) {
    if (remove(kept_.front())) ++deleted_;
    kept_.pop_front();
  }
}

/// A file without a frame must not take the place of one that has some.
void Files::delete_newest() {
  if (options_.ring != 0) keeps_none_ = remove(path_);
}

bool Files::failed(const transport::Failure& failure) {
  if (failure_.what.empty()) failure_ = failure;
  return false;
}

std::uint64_t Files::readable() const {
  std::error_code unreadable;
  if (elsewhere_) return finished_entries_ + entries_;
  // A device may have no end.
  if (path_ == "-" || !std::filesystem::is_regular_file(path_, unreadable)) return finished_entries_;
  if (entries_ == 0 || file_->size() == 0 || file_->size() > most_to_read_back) return finished_entries_;
  try {
    logs::OpenedLog log{path_, options_.format->name, *catalogue_,
                        logs::Reading::to_the_end};  // Ctrl-C may have ended the recording
    std::array<log::Entry, log::batch> entries;
    std::uint64_t count = 0;
    while (const std::size_t more = log.reader().read(entries)) count += more;
    return finished_entries_ + count;
  } catch (const Exit&) {  // it has said why
    return finished_entries_;
  }
}

}  // namespace ocm::cli::record
