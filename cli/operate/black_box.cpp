#include "cli/operate/black_box.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <iterator>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "cli/logs/format.hpp"
#include "cli/logs/log_file.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::operate {
namespace {

constexpr std::string_view ending = ".black-box.log";

/// 20260131T235959.123: in the order of time, and no colon.
std::string stamp(base::Time wall) {
  const auto seconds = static_cast<std::time_t>(wall.time_since_epoch().count() / 1'000'000'000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  const auto length = std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%S", &parts);
  return fmt::format("{}.{:03}", std::string_view{text.data(), length},
                     wall.time_since_epoch().count() / 1'000'000 % 1000);
}

}  // namespace

BlackBox::BlackBox(BlackBoxOptions options, std::string name, std::string bus,
                   const protocol::Catalogue& catalogue)
    : options_(std::move(options)),
      name_(std::move(name)),
      catalogue_(&catalogue),
      spool_(options_.folder, name_, options_.lasting, catalogue) {
  static_cast<void>(interfaces_.number(bus));
  if (!keeps()) return;
  std::error_code error;
  std::error_code no_folder;
  std::filesystem::create_directories(options_.folder, error);
  if (!std::filesystem::is_directory(options_.folder, no_folder))
    fail({fmt::format("operate: --black-box {}: {}", options_.folder,
                      error ? error.message() : std::string{"it is no folder"}),
          "a folder that you may write to"});
}

void BlackBox::add(const log::Entry& entry, Clock::time_point now) {
  if (!keeps()) return;
  forget(now);
  if (kept_.size() == most_entries) {
    kept_.pop_front();
    ++dropped_;
  }
  const auto later = [&entry](const log::Entry& other) {
    return other.time > entry.time && other.time - entry.time <= settling;
  };
  auto place = kept_.end();
  while (place != kept_.begin() && later(std::prev(place)->entry)) --place;
  kept_.insert(place, {now, entry});
  auto fresh = fresh_.end();
  while (fresh != fresh_.begin() && later(*std::prev(fresh))) --fresh;
  fresh_.insert(fresh, entry);
}

Spool::Recovered BlackBox::recover(base::Time wall) {
  if (!keeps()) return {};
  auto left = spool_.recover(path(wall, "killed"), path(wall, "killed-2"));
  if (!left) fail({fmt::format("operate: --black-box: {}", left.error.what), left.error.remedy});
  of_this_run_ = left->files;
  if (!left->files.empty()) delete_oldest();
  return std::move(*left);
}

std::vector<log::Entry> BlackBox::take_fresh(base::Time wall) {
  // A clock that was set back does not keep anything here: what is later than now is settled, too.
  const auto settled = [wall](const log::Entry& entry) {
    return entry.time > wall || wall - entry.time > settling;
  };
  auto last = fresh_.end();
  while (last != fresh_.begin() && !settled(*std::prev(last))) --last;
  std::vector<log::Entry> taken{fresh_.begin(), last};
  fresh_.erase(fresh_.begin(), last);
  return taken;
}

void BlackBox::end() {
  if (keeps()) spool_.end();
}

std::string BlackBox::path(base::Time wall, std::string_view what) const {
  const std::string name =
      fmt::format("{}-{}{}{}{}", name_, stamp(wall), what.empty() ? "" : "-", what, ending);
  return (std::filesystem::path{options_.folder} / name).string();
}

void BlackBox::forget(Clock::time_point now) {
  while (!kept_.empty() && now - kept_.front().at > options_.lasting) kept_.pop_front();
}

BlackBox::Recording BlackBox::take(Clock::time_point now, base::Time wall) {
  forget(now);
  Recording recording;
  recording.path = path(wall);
  for (const Kept& kept : kept_) recording.entries.push_back(kept.entry);
  kept_.clear();
  return recording;
}

transport::Outcome<void> BlackBox::write(const Recording& recording) {
  auto file = logs::LogFile::create(recording.path, *logs::find_format("candump"), *catalogue_,
                                    logs::Existing::refuse);
  if (!file) return std::move(file.error);
  (*file)->without_signals();
  const std::vector<log::Entry> entries{recording.entries.begin(), recording.entries.end()};
  if (!(*file)->write(entries, interfaces_) || !(*file)->flush(true) || !(*file)->finish()) {
    // What the disk took can be read; of nothing there is no file, which would count.
    return (*file)->failure();
  }
  of_this_run_.push_back(recording.path);
  delete_oldest();
  return {};
}

void BlackBox::delete_oldest() {
  std::vector<std::string> kept;
  std::error_code error;
  // A disk that can no longer be read ends the list, and no more.
  for (std::filesystem::directory_iterator each{options_.folder, error}, end; each != end;
       each.increment(error)) {
    const std::string name = each->path().filename().string();
    if (!name.starts_with(name_ + "-") || !name.ends_with(ending)) continue;
    const bool is_ours =
        std::find(of_this_run_.begin(), of_this_run_.end(), each->path()) != of_this_run_.end();
    if (!is_ours) kept.push_back(each->path().string());
  }
  std::sort(kept.begin(), kept.end());
  kept.insert(kept.end(), of_this_run_.begin(), of_this_run_.end());
  for (std::size_t i = 0; i + options_.files < kept.size(); ++i) {
    std::filesystem::remove(kept[i], error);
    std::erase(of_this_run_, kept[i]);
  }
}

}  // namespace ocm::cli::operate
