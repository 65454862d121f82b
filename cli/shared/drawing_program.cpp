#include "cli/shared/drawing_program.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

namespace ocm::cli {
namespace {

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Closer>;

std::string contents(std::FILE* file) {
  std::string text;
  char block[1 << 16];
  std::rewind(file);
  while (const std::size_t count = std::fread(block, 1, sizeof block, file)) text.append(block, count);
  return text;
}

/// The first lines of what gnuplot says, without the ones that are empty.
std::string first_lines(const std::string& text) {
  std::string out;
  std::size_t begin = 0;
  while (begin < text.size() && out.size() < 300) {
    std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) end = text.size();
    const auto line = text.substr(begin, end - begin);
    if (line.find_first_not_of(" \t^") != std::string::npos) out += (out.empty() ? "" : "; ") + line;
    begin = end + 1;
  }
  return out;
}

}  // namespace

transport::Outcome<std::string> drawn_by(std::vector<std::string> words_of_call, std::string_view script,
                                         std::string_view install) {
  const std::string& name = words_of_call.front();
  // Files and not pipes: neither side waits for the other, and half a picture is not taken for one.
  const File in{std::tmpfile()}, out{std::tmpfile()}, said{std::tmpfile()};
  if (!in || !out || !said || std::fwrite(script.data(), 1, script.size(), in.get()) != script.size() ||
      std::fflush(in.get()) != 0)
    return transport::Failure{fmt::format("no temporary file: {}", std::strerror(errno)),
                              "is the disk full?"};
  std::rewind(in.get());

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(in.get()), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(out.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(said.get()), STDERR_FILENO);
  std::vector<char*> arguments;
  for (std::string& word : words_of_call) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments.front(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT)
    return transport::Failure{fmt::format("{} is missing, which draws the pictures", name),
                              fmt::format("install it: {}", install)};
  if (error != 0)
    return transport::Failure{fmt::format("{} cannot be started: {}", name, std::strerror(error)), ""};
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  std::string picture = contents(out.get());
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || picture.empty())
    return transport::Failure{
        WIFSIGNALED(status) ? fmt::format("{} was ended by signal {}", name, WTERMSIG(status))
                            : fmt::format("{} draws nothing: {}", name, first_lines(contents(said.get()))),
        ""};
  return picture;
}

}  // namespace ocm::cli
