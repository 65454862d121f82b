#include "cli/operate/spool.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "cli/logs/format.hpp"

namespace ocm::cli::operate {

namespace fs = std::filesystem;

namespace {

/// Appends one file to another, and removes it; false: both are as they were.
bool join(const fs::path& newer, const fs::path& older) {
  std::error_code error;
  const auto size = fs::file_size(older, error);
  if (error) return false;
  {
    std::ofstream to{older, std::ios::binary | std::ios::app};
    const std::ifstream from{newer, std::ios::binary};
    if (fs::file_size(newer, error) != 0) to << from.rdbuf();
    to.close();
    if (to && !error) {
      fs::remove(newer, error);
      return true;
    }
  }
  fs::resize_file(older, size, error);
  return false;
}

}  // namespace

Spool::Spool(std::string folder, std::string name, base::Duration lasting,
             const protocol::Catalogue& catalogue)
    : folder_(std::move(folder)), name_(std::move(name)), lasting_(lasting), catalogue_(&catalogue) {}

std::string Spool::path(int number) const {
  return (fs::path{folder_} / fmt::format("{}.running-{}.log", name_, number)).string();
}

transport::Outcome<Spool::Recovered> Spool::recover(const std::string& path, const std::string& beside) {
  std::error_code error;
  std::vector<fs::path> left;
  for (const int number : {0, 1}) {
    const fs::path file{this->path(number)};
    if (!fs::exists(file, error)) continue;
    if (logs::is_being_written(file.string()))
      return transport::Failure{
          fmt::format("an operator with the name {} keeps its black box in {}", name_, folder_),
          "another --black-box, or another name in the operator file"};
    left.push_back(file);
  }
  const auto written = [&](const fs::path& file) { return fs::last_write_time(file, error); };
  if (left.size() == 2 && written(left[1]) < written(left[0])) std::swap(left[0], left[1]);
  if (left.size() == 2 && join(left[1], left[0])) left.pop_back();
  Recovered recovered;
  for (const fs::path& file : left) {
    // A name takes no room on a full disk.
    const std::string& kept = recovered.files.empty() ? path : beside;
    fs::rename(file, kept, error);
    if (error)
      recovered.lost = {fmt::format("{} cannot become {}: {}", file.string(), kept, error.message()),
                        "a folder in which files can be renamed"};
    else
      recovered.files.push_back(kept);
  }
  return recovered;
}

transport::Outcome<void> Spool::append(std::span<const log::Entry> entries,
                                       const log::Interfaces& interfaces) {
  if (entries.empty()) return {};
  const base::Time first = entries.front().time;
  // A clock that was set begins a new file, too.
  if (!file_ || first < begin_ || first - begin_ >= lasting_) {
    file_.reset();
    const int other = 1 - number_;
    auto file = logs::LogFile::create(path(other), *logs::find_format("candump"), *catalogue_,
                                      logs::Existing::overwrite);
    if (!file) return std::move(file.error);  // the newer one stays as it is, and this is tried again
    number_ = other;
    file_ = std::move(*file);
    file_->without_signals();
    begin_ = first;
  }
  if (file_->write(entries, interfaces) && file_->flush()) return {};
  transport::Failure failure = file_->failure();
  file_.reset();
  return failure;
}

void Spool::end() {
  file_.reset();
  std::error_code error;
  for (const int number : {0, 1}) fs::remove(path(number), error);
}

}  // namespace ocm::cli::operate
