#include "cli/shared/output_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

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

void refuse_same_file(std::string_view verb, const std::string& in, const std::string& out) {
  const auto look = [](const std::string& path, int descriptor, struct stat& status) {
    const int result = path == "-" ? fstat(descriptor, &status) : stat(path.c_str(), &status);
    return result == 0 && S_ISREG(status.st_mode);
  };
  struct stat from {};
  struct stat to {};
  if (!look(in, STDIN_FILENO, from) || !look(out, STDOUT_FILENO, to)) return;
  if (from.st_dev != to.st_dev || from.st_ino != to.st_ino) return;
  fail({fmt::format("{}: {} and {} are the same file", verb, in, out), "write to another file and rename it"},
       exit_usage);
}

}  // namespace ocm::cli
