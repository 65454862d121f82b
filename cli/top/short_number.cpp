#include "cli/top/short_number.hpp"

#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace ocm::cli::top {

std::string short_time(base::Duration duration) {
  const double ns = std::abs(static_cast<double>(duration.count()));
  const std::string_view sign = duration.count() < 0 ? "-" : "";
  const auto text = [&](double number, std::string_view unit) {
    return fmt::format("{}{:.{}f}{}", sign, number, number < 9.95 ? 1 : 0, unit);
  };
  if (ns < 999.5e3) return fmt::format("{}{:.0f}us", sign, ns / 1e3);
  if (ns < 999.5e6) return text(ns / 1e6, "ms");
  if (ns < 99.5e9) return fmt::format("{}{:.1f}s", sign, ns / 1e9);
  if (ns < 99.5 * 60e9) return fmt::format("{}{:.0f}m", sign, ns / 60e9);
  if (ns < 99.5 * 3600e9) return fmt::format("{}{:.0f}h", sign, ns / 3600e9);
  return fmt::format("{}{:.0f}d", sign, ns / 86400e9);
}

std::string short_number(double number) {
  if (number < 9.995) return fmt::format("{:.2f}", number);
  if (number < 999.95) return fmt::format("{:.1f}", number);
  return number < 999'999.5 ? fmt::format("{:.0f}", number) : fmt::format("{:.0f}k", number / 1000);
}

std::string percent(double share) {
  return share > 0 && share < 0.0005 ? "<0.1%" : fmt::format("{:.1f}%", 100 * share);
}

}  // namespace ocm::cli::top
