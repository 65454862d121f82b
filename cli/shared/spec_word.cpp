#include "cli/shared/spec_word.hpp"

#include <filesystem>
#include <net/if.h>
#include <system_error>

#include <fmt/format.h>

#include "cli/shared/buses.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli {

bool can_be_interface(std::string_view name) {
  const BusName bus = parse_bus_name(name);
  if (bus.kind == BusName::Kind::serial) return !bus.address.empty();
  if (bus.kind == BusName::Kind::simulated) return true;
  constexpr std::string_view never = "/: \t\n\v\f\r";
  return !name.empty() && name.size() < IFNAMSIZ && name != "." && name != ".." &&
         name.find_first_of(never) == std::string_view::npos;
}

std::string interface_of(std::string_view bus) {
  if (parse_bus_name(bus).kind == BusName::Kind::serial) bus = bus.substr(0, bus.rfind('@'));
  return std::string{bus};
}

SpecWord parse_spec_word(const std::string& word) {
  const auto equals = word.find('=');
  std::error_code error;
  if (equals == std::string::npos || std::filesystem::exists(word, error)) return {"", word};
  const SpecWord parts{word.substr(0, equals), word.substr(equals + 1)};
  if (parts.interface.empty())
    fail({fmt::format("--spec {}: no interface before the '='", word),
          fmt::format("--spec can0={0}, or --spec {0} for all interfaces", parts.file)},
         exit_usage);
  if (parts.file.empty())
    fail({fmt::format("--spec {}: no file behind the '='", word), fmt::format("--spec {}FILE", word)},
         exit_usage);
  if (!can_be_interface(parts.interface))
    fail({fmt::format("--spec {}: there is no such file, and '{}' cannot be an interface", word,
                      parts.interface),
          fmt::format("a name of 1 to {} characters, without blanks and '/', such as --spec can0={}",
                      IFNAMSIZ - 1, parts.file)},
         exit_usage);
  return {interface_of(parts.interface), parts.file, parts.interface};
}

}  // namespace ocm::cli
