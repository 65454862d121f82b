#include "cli/record/names.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"
#include "ocm/host/descriptor.hpp"

#include "cli/words/quantity.hpp"

namespace ocm::cli::record {

namespace {

std::string robot_stem(std::string_view robot) {
  std::string stem;
  for (const char c : robot) {
    const bool letter = (c >= 'a' && c <= 'z') || base::is_digit(c);
    if (letter) stem += c;
    if (c >= 'A' && c <= 'Z') stem += static_cast<char>(c - 'A' + 'a');
  }
  return stem.empty() ? "robot" : stem;
}

}  // namespace

std::string default_stem(std::string_view robot, std::time_t now) {
  std::tm local{};
  ::localtime_r(&now, &local);
  char moment[32];
  const std::size_t size = std::strftime(moment, sizeof moment, "-%Y-%m-%d_%H%M%S", &local);
  return robot_stem(robot) + std::string{moment, size};
}

std::string ring_stem(std::string_view robot) {
  return robot_stem(robot) + "-ring";
}

FileName split_name(const std::string& path, std::string_view ending) {
  for (const std::string_view packed : {"", ".gz", ".zst"}) {
    const std::string whole = std::string{ending} + std::string{packed};
    const std::size_t stem = path.size() - whole.size();
    if (!whole.empty() && path.size() > whole.size() && path.compare(stem, whole.size(), whole) == 0)
      return {path.substr(0, stem), whole};
  }
  return {path, ""};
}

std::string numbered(const FileName& name, std::uint64_t number) {
  return fmt::format("{}_{:03}{}", name.stem, number, name.ending);
}

std::vector<NumberedFile> numbered_files(const FileName& name) {
  const std::filesystem::path beginning{name.stem + "_"};
  const std::string prefix = beginning.filename();
  std::vector<NumberedFile> files;
  std::error_code error;
  const auto folder = beginning.has_parent_path() ? beginning.parent_path() : std::filesystem::path{"."};
  for (std::filesystem::directory_iterator entry{folder, error}, end; !error && entry != end;
       entry.increment(error)) {
    const std::string own = entry->path().filename();
    if (own.size() <= prefix.size() + name.ending.size() || !own.starts_with(prefix) ||
        !own.ends_with(name.ending))
      continue;
    const char* const last = own.data() + own.size() - name.ending.size();
    NumberedFile file;
    const auto [stopped, bad] = std::from_chars(own.data() + prefix.size(), last, file.number);
    file.path = numbered(name, file.number);
    // Only numbers written as here: drive_7.log in place of drive_007.log is no file of a ring.
    std::error_code unknown;
    if (bad == std::errc{} && stopped == last && std::filesystem::path{file.path}.filename() == own &&
        entry->is_regular_file(unknown))
      files.push_back(std::move(file));
  }
  std::sort(files.begin(), files.end(),
            [](const NumberedFile& a, const NumberedFile& b) { return a.number < b.number; });
  return files;
}

Claimed claim(const std::string& path, Devices devices) {
  const host::Descriptor file{::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)};
  if (file) return Claimed::ours;
  if (errno != EEXIST) return Claimed::failed;
  if (devices == Devices::taken) return Claimed::taken;
  struct stat what {};
  if (::stat(path.c_str(), &what) < 0) return Claimed::failed;
  return S_ISREG(what.st_mode) || S_ISDIR(what.st_mode) ? Claimed::taken : Claimed::ours;
}

std::uint64_t parse_size(std::string_view text) {
  const auto quantity = words::parse_quantity(text);
  if (!quantity || quantity->number.digits <= 0) return 0;
  std::string_view unit = quantity->unit;
  if (unit.ends_with('B')) unit.remove_suffix(1);
  struct Unit {
    std::string_view name;
    double bytes;
  };
  constexpr Unit units[] = {{"", 1},         {"k", 1e3},      {"K", 1e3},      {"M", 1e6},      {"G", 1e9},
                            {"ki", 1 << 10}, {"Ki", 1 << 10}, {"Mi", 1 << 20}, {"Gi", 1 << 30}, {"T", 1e12}};
  for (const auto& known : units) {
    if (known.name != unit) continue;
    const double bytes = quantity->number.as_double() * known.bytes;
    return bytes >= 1 && bytes < 9e18 ? static_cast<std::uint64_t>(bytes) : 0;
  }
  return 0;
}

std::string size_text(std::uint64_t bytes) {
  double number = static_cast<double>(bytes);
  std::string_view unit = "bytes";
  for (const std::string_view larger : {"kB", "MB", "GB", "TB"}) {
    if (number < 1000) break;
    number /= 1000;
    unit = larger;
  }
  return unit == "bytes" ? fmt::format("{} bytes", bytes) : fmt::format("{:.1f} {}", number, unit);
}

}  // namespace ocm::cli::record
