#include "cli/record/names.hpp"

#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"
#include "ocm/host/descriptor.hpp"

#include "cli/words/quantity.hpp"

namespace ocm::cli::record {

std::string default_stem(std::string_view robot, std::time_t now) {
  std::string stem;
  for (const char c : robot) {
    const bool letter = (c >= 'a' && c <= 'z') || base::is_digit(c);
    if (letter) stem += c;
    if (c >= 'A' && c <= 'Z') stem += static_cast<char>(c - 'A' + 'a');
  }
  if (stem.empty()) stem = "robot";
  std::tm local{};
  ::localtime_r(&now, &local);
  char moment[32];
  const std::size_t size = std::strftime(moment, sizeof moment, "-%Y-%m-%d_%H%M%S", &local);
  return stem + std::string{moment, size};
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

Claimed claim(const std::string& path) {
  const host::Descriptor file{::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)};
  if (file) return Claimed::ours;
  if (errno != EEXIST) return Claimed::failed;
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
