#include "cli/plot/gnuplot.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

namespace ocm::cli::plot {
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
std::string words(const std::string& text) {
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

std::optional<Kind> kind_of_file(std::string_view name) {
  if (name.ends_with(".svg")) return Kind::svg;
  if (name.ends_with(".png")) return Kind::png;
  if (name.ends_with(".pdf")) return Kind::pdf;
  return std::nullopt;
}

std::string terminal(Kind kind, unsigned width, unsigned height) {
  const auto set = [](std::string_view what, std::string_view size, int font) {
    return fmt::format(
        "set terminal {} size {} font 'DejaVu Sans,{}' background '#ffffff'\nset encoding utf8\n", what, size,
        font);
  };
  const std::string pixels = fmt::format("{},{}", width, height);
  if (kind == Kind::svg) return set("svg", pixels, 12);
  if (kind == Kind::png) return set("pngcairo", pixels, 10);
  return set("pdfcairo", fmt::format("{:.2f}in,{:.2f}in", width / 100.0, height / 100.0), 9);
}

std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'')
      out += "''";
    else
      out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  }
  return out + "'";
}

transport::Outcome<std::string> draw(std::string_view script) {
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
  // -d: as it comes, whatever ~/.gnuplot says.
  char name[] = "gnuplot", defaults[] = "-d";
  char* const arguments[] = {name, defaults, nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, name, &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT)
    return transport::Failure{"gnuplot is missing, which draws the pictures",
                              "install it: sudo apt install gnuplot-nox"};
  if (error != 0)
    return transport::Failure{fmt::format("gnuplot cannot be started: {}", std::strerror(error)), ""};
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  std::string picture = contents(out.get());
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || picture.empty())
    return transport::Failure{WIFSIGNALED(status)
                                  ? fmt::format("gnuplot was ended by signal {}", WTERMSIG(status))
                                  : fmt::format("gnuplot draws nothing: {}", words(contents(said.get()))),
                              ""};
  return picture;
}

}  // namespace ocm::cli::plot
