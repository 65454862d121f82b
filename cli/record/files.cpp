#include "cli/record/files.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "cli/logs/opened_log.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::record {
namespace {

/// Reading back more takes longer than anybody waits for a message.
constexpr std::uint64_t most_to_read_back = std::uint64_t{1} << 30;

transport::Failure exists_failure(const std::string& path) {
  return {fmt::format("{} is there already", path), "give another name, or --force to overwrite it"};
}

}  // namespace

std::size_t entries_before_split(std::span<const log::Entry> entries, base::Time begin,
                                 base::Duration split) noexcept {
  const auto later = std::find_if(entries.begin(), entries.end(),
                                  [&](const log::Entry& entry) { return entry.time - begin >= split; });
  return static_cast<std::size_t>(later - entries.begin());
}

Files::Files(FilesOptions options, const protocol::Catalogue& catalogue)
    : options_(std::move(options)),
      catalogue_(&catalogue),
      name_(split_name(options_.path, options_.format->ending)) {}

transport::Outcome<void> Files::open() {
  auto opened = open_next();
  if (opened) first_path_ = path_;
  return opened;
}

/// The name of the next file, with an empty file of ours in its place.
transport::Outcome<std::string> Files::claim_next() {
  if (options_.path == "-") return options_.path;
  for (;;) {
    ++number_;
    std::string path = options_.split.any() ? numbered(name_, number_)
                       : number_ == 1       ? options_.path
                                            : fmt::format("{}-{}{}", name_.stem, number_, name_.ending);
    switch (options_.overwrite ? Claimed::ours : claim(path)) {
      case Claimed::ours:
        return path;
      case Claimed::failed:
        return transport::Failure{fmt::format("cannot create {}: {}", path, std::strerror(errno)),
                                  "name a file in a folder that is there and that you may write to"};
      case Claimed::taken:
        // Of a name that the user gave only the later numbers may be chosen freely.
        if (count_ == 0 && !options_.numbers_free) return exists_failure(path);
        break;
    }
  }
}

transport::Outcome<void> Files::open_next() {
  auto path = claim_next();
  if (!path) return std::move(path.error);
  auto file = logs::LogFile::create(*path, *options_.format, *catalogue_);
  if (!file) return std::move(file.error);
  file_ = std::move(file.value);
  file_->without_signals();  // they are for the thread that receives
  path_ = *path;
  finished_ = false;
  kept_.push_back(path_);
  ++count_;
  entries_ = 0;
  begin_.reset();
  std::fill(recorded_.begin(), recorded_.end(), log::Recorded{});
  return {};
}

bool Files::write(std::span<const log::Entry> entries, const log::Interfaces& interfaces) {
  while (!entries.empty()) {
    std::size_t count = entries.size();
    if (options_.split.time > base::Duration::zero())
      count = begin_
                  ? entries_before_split(entries, *begin_, options_.split.time)
                  : 1 + entries_before_split(entries.subspan(1), entries.front().time, options_.split.time);
    if (count == 0) {
      if (!next_file()) return false;
      continue;
    }
    if (!append(entries.first(count), interfaces)) return false;
    entries = entries.subspan(count);
    if (options_.split.size == 0) continue;
    // What a buffer holds back has no size yet.
    if (!file_->flush()) return failed(file_->failure());
    if (file_->size() >= options_.split.size && !next_file()) return false;
  }
  return true;
}

bool Files::append(std::span<const log::Entry> entries, const log::Interfaces& interfaces) {
  if (!begin_) begin_ = entries.front().time;
  recorded_.resize(std::max(recorded_.size(), interfaces.size()));
  for (const auto& entry : entries) ++recorded_[entry.interface].received;
  entries_ += entries.size();
  if (file_->write(entries, interfaces)) return true;
  return failed(file_->failure());
}

bool Files::flush() {
  if (file_->flush(options_.sync)) return true;
  return failed(file_->failure());
}

bool Files::finish() {
  if (finished_) return failure_.what.empty();
  finished_ = true;
  recorded_.resize(std::max(recorded_.size(), dropped_.size()));
  told_dropped_.resize(recorded_.size());
  for (std::size_t i = 0; i < dropped_.size(); ++i)
    recorded_[i].dropped = dropped_[i] - std::exchange(told_dropped_[i], dropped_[i]);
  // finish whatever happens: it closes the file. What it writes then must be on the disk, too.
  const bool told = file_->recorded(recorded_) && file_->flush(options_.sync);
  const bool done = file_->finish() && told;
  for (std::size_t i = 0; i < log::losses; ++i) {
    const auto lost = static_cast<log::Lost>(i);
    losses_.add(lost, file_->lost().count(lost));
  }
  return done || failed(file_->failure());
}

bool Files::next_file() {
  if (!finish()) return false;
  finished_size_ += file_->size();
  finished_entries_ += entries_;
  if (const auto opened = open_next(); !opened) {
    entries_ = 0;
    return failed(opened.error);
  }
  delete_oldest();
  return true;
}

void Files::delete_oldest() {
  while (options_.ring != 0 && kept_.size() > options_.ring) {
    if (::unlink(kept_.front().c_str()) == 0)
      ++deleted_;
    else if (errno != ENOENT)  // somebody may have taken it away, which is what we want
      remark(fmt::format("cannot delete {}: {}", kept_.front(), std::strerror(errno)));
    kept_.pop_front();
  }
}

bool Files::failed(const transport::Failure& failure) {
  if (failure_.what.empty()) failure_ = failure;
  return false;
}

std::uint64_t Files::readable() const {
  std::error_code unreadable;
  // A device may have no end.
  if (path_ == "-" || !std::filesystem::is_regular_file(path_, unreadable)) return finished_entries_;
  if (entries_ == 0 || file_->size() > most_to_read_back) return finished_entries_;
  try {
    logs::OpenedLog log{path_, options_.format->name, *catalogue_};
    std::array<log::Entry, log::batch> entries;
    std::uint64_t count = 0;
    while (const std::size_t more = log.reader().read(entries)) count += more;
    return finished_entries_ + count;
  } catch (const Exit&) {  // it has said why
    return finished_entries_;
  }
}

}  // namespace ocm::cli::record
