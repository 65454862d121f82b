// ocm-generate SPEC -o HEADER: a robot's C++ header from its spec.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include "cli/generate/header.hpp"
#include "cli/generate/tasks.hpp"
#include "cli/spec/spec.hpp"

namespace {

constexpr int success = 0;
constexpr int failure = 1;
constexpr int usage_error = 2;

constexpr const char* help =
    "Usage: ocm-generate SPEC -o HEADER\n"
    "       ocm-generate SPEC --check\n"
    "       ocm-generate --tasks SETS -o HEADER\n"
    "\n"
    "Writes the C++ header of a robot from its spec: a struct with encode and decode for each frame,\n"
    "and the catalogue of all topics. The same spec gives the same bytes.\n"
    "\n"
    "  -o, --output HEADER  the header; - is the standard output. It is replaced in one step, and only\n"
    "                       when the spec is good.\n"
    "      --check          only say what is wrong with the spec\n"
    "      --tasks          the file has task sets of processors (spec/tasks.json), not a robot's topics\n"
    "      --schema         print the JSON schema of specs, for an editor, and end\n"
    "      --help, --version\n"
    "\n"
    "Exit status: 0 done, 1 the spec is wrong or the header cannot be written, 2 wrong usage.\n"
    "\n"
    "Example: ocm-generate spec/topics.json -o include/ocm/topics/amiro.hpp\n";

int complain_usage(const std::string& what) {
  std::fprintf(stderr, "ocm-generate: %s\nocm-generate SPEC -o HEADER; --help says more\n", what.c_str());
  return usage_error;
}

int complain(const std::string& place, const std::string& what, const std::string& remedy) {
  std::fprintf(stderr, "%s: %s; %s\n", place.c_str(), what.c_str(), remedy.c_str());
  return failure;
}

/// A spec may hold anything; a terminal must not obey it.
std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) {
      out += c;
    } else {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\x%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
      out += escaped;
    }
  }
  return out;
}

bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(file, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

/// In one step: a reader sees the old header or the new one, and a full disk leaves the old one.
int replace(const std::filesystem::path& header, std::string_view text) {
  std::error_code error;
  // Through a link, so that the link stays one.
  std::filesystem::path target = header;
  if (std::filesystem::is_symlink(header, error)) target = std::filesystem::weakly_canonical(header, error);
  if (std::filesystem::is_directory(target, error))
    return complain(header.string(), "it is a folder", "the path of the header within it");
  struct ::stat old {};
  const bool exists = ::stat(target.c_str(), &old) == 0;
  if (exists && !S_ISREG(old.st_mode)) {  // /dev/stdout, a pipe: nothing to replace
    const int file = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
    const bool written = file >= 0 && write_all(file, text);
    const int cause = errno;
    if (file >= 0) ::close(file);
    return written ? success : complain(header.string(), std::strerror(cause), "a file that you may write");
  }
  std::string temporary = target.string() + ".XXXXXX";
  const int file = ::mkstemp(temporary.data());
  if (file < 0)
    return complain(header.string(), std::string{"no file can be made beside it: "} + std::strerror(errno),
                    "a folder that exists and that you may write to");
  ::mode_t mask = ::umask(0);
  ::umask(mask);
  const ::mode_t mode = exists ? old.st_mode & 07777U : 0666U & ~mask;
  const bool written = write_all(file, text) && ::fchmod(file, mode) == 0 && ::fsync(file) == 0;
  int cause = errno;
  const bool closed = ::close(file) == 0;
  if (written && closed && std::rename(temporary.c_str(), target.c_str()) == 0) return success;
  if (written) cause = errno;
  ::unlink(temporary.c_str());
  return complain(header.string(), std::string{"it cannot be written: "} + std::strerror(cause),
                  "the old one, if there was one, is as it was");
}

}  // namespace

int main(int argc, char** argv) {
  std::string spec;
  std::string output;
  bool has_output = false;
  bool check = false;
  bool only_names = false;
  bool tasks = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (!only_names && argument == "--") {
      only_names = true;
    } else if (!only_names && (argument == "-h" || argument == "--help")) {
      std::fputs(help, stdout);
      return success;
    } else if (!only_names && argument == "--version") {
      std::puts("ocm-generate " OCM_VERSION);
      return success;
    } else if (!only_names && argument == "--schema") {
      return write_all(STDOUT_FILENO, ocm::spec::schema_text())
                 ? success
                 : complain("the standard output", std::strerror(errno), "somewhere that takes the schema");
    } else if (!only_names && argument == "--check") {
      check = true;
    } else if (!only_names && argument == "--tasks") {
      tasks = true;
    } else if (!only_names && (argument == "-o" || argument == "--output")) {
      if (++i == argc) return complain_usage(std::string{argument} + " without a header");
      if (has_output) return complain_usage("two headers: " + output + " and " + argv[i]);
      output = argv[i];
      has_output = true;
    } else if (!only_names && argument.size() > 1 && argument.front() == '-') {
      return complain_usage("unknown option " + std::string{argument});
    } else if (spec.empty() && !argument.empty()) {
      spec = argument;
    } else {
      return complain_usage("two specs: " + spec + " and " + std::string{argument});
    }
  }
  if (spec.empty()) return complain_usage("no spec");
  if (!has_output && !check) return complain_usage("no header: -o HEADER, or --check");
  if (has_output && check) return complain_usage("--check writes no header");
  if (has_output && output.empty()) return complain_usage("the header has no name");

  const auto put = [&](const std::string& text) {
    if (check) return success;
    if (output != "-") return replace(output, text);
    if (write_all(STDOUT_FILENO, text)) return success;
    return complain("the standard output", std::strerror(errno), "somewhere that takes the header");
  };
  const std::string name = std::filesystem::path{spec}.filename().string();
  if (tasks) {
    std::ifstream in{spec, std::ios::binary};
    const std::string json{std::istreambuf_iterator<char>{in}, {}};
    if (!in) return complain(spec, "cannot be read", "a file with task sets");
    std::vector<ocm::spec::Problem> problems;
    const std::string text = ocm::generate::tasks_header(json, name, problems);
    for (const auto& problem : problems)
      complain(printable(problem.place), printable(problem.what), printable(problem.remedy));
    return problems.empty() ? put(text) : failure;
  }
  const auto loaded = ocm::spec::load(spec);
  for (const auto& problem : loaded.problems)
    complain(printable(problem.place), printable(problem.what), printable(problem.remedy));
  if (!loaded.spec) return failure;
  return put(ocm::generate::header(loaded.spec->model(), name));
}
