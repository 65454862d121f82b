#include "cli/shared/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
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

std::optional<transport::Failure> cannot_write(const std::string& path) {
  struct stat status {};
  if (path == "-") return std::nullopt;
  if (stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode))
    return transport::Failure{path + ": it is a folder", "give the path of the file within it"};
  std::filesystem::path folder = std::filesystem::path{path}.parent_path();
  if (folder.empty()) folder = ".";
  if (access(folder.c_str(), W_OK | X_OK) == 0) return std::nullopt;
  return transport::Failure{fmt::format("{}: it cannot be written: {}", path, std::strerror(errno)),
                            "name a file in a folder that exists and that you may write to"};
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
  fail({fmt::format("{}: {} and {} are the same file", verb, in == "-" ? "the standard input" : in,
                    out == "-" ? "the standard output" : out),
        "write to another file and rename it"},
       exit_usage);
}

}  // namespace ocm::cli
