#include "cli/shared/output_file.hpp"

#include <fmt/format.h>

#include "cli/shared/messages.hpp"
#include "generator/text/output_file.hpp"

namespace ocm::cli {

std::optional<transport::Failure> try_to_write(const std::string& path, std::string_view text) {
  if (const auto problem = generate::write_file(path, text))
    return transport::Failure{fmt::format("{}: {}", problem->place, problem->what), problem->remedy};
  return std::nullopt;
}

void write_file(const std::string& path, std::string_view text) {
  if (const auto failure = try_to_write(path, text)) fail(*failure);
}

}  // namespace ocm::cli
