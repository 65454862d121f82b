#include "cli/shared/messages.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/base/utf8.hpp"

#include "cli/shared/folding.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/remedies.hpp"
#include "cli/shared/terminal.hpp"

namespace ocm::cli {
namespace {

constexpr std::string_view before_errors = "amiroctl: ";

/// The verb that runs.
std::string& speaker() {
  static std::string verb;
  return verb;
}

/// Messages that are kept for later, where they are.
struct Kept {
  bool keeps = false;
  std::vector<std::string> lines;
};
Kept& kept() {
  static Kept messages;
  return messages;
}

/// Of any thread: a verb may have a page, and robots behind a central, in threads of their own.
void print(std::string_view before, std::string_view raw) {
  static std::mutex one_at_a_time;
  const std::string line = std::string{before} + printable(raw);
  const std::lock_guard lock{one_at_a_time};
  if (kept().keeps) {
    kept().lines.push_back(line);
    return;
  }
  const WithoutBrokenPipe message;  // `stop 2>&1 | true` stops
  static bool echo_erased = false;
  if (!echo_erased && interrupted() == SIGINT && can_redraw(STDERR_FILENO)) {
    std::fputs("\r\x1b[K", stderr);  // the terminal has shown ^C
    echo_erased = true;
  }
  std::fprintf(stderr, "%s\n", folded_message(line, columns_of(STDERR_FILENO)).c_str());
}

}  // namespace

void speak_for(std::string_view verb) {
  speaker() = verb;
}

std::string printable(std::string_view text) {
  const auto escaped = [](char byte) { return fmt::format("\\x{:02x}", static_cast<unsigned char>(byte)); };
  std::string out;
  while (!text.empty()) {
    const std::size_t length = base::utf8_length(text);
    const auto first = static_cast<unsigned char>(text[0]);
    const bool control = (first < 0x20 && first != '\n' && first != '\t') || first == 0x7F;
    // U+0080 to U+009F, of which a terminal takes some for the beginning of a sequence
    const bool second_set = length == 2 && first == 0xC2 && static_cast<unsigned char>(text[1]) < 0xA0;
    if (second_set)
      out += escaped(text[1]);
    else if (length == 0 || control)  // a byte that is no UTF-8 may be such a control in eight bits
      out += escaped(text[0]);
    else
      out += text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

std::string folded_message(std::string_view text, std::size_t columns) {
  std::string out;
  for (;;) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    const std::size_t lead = std::min(line.find_first_not_of(' '), line.size());
    // What goes on is below the text of an error and of its remedy, and moved in below all else.
    const bool of_error = line.starts_with(before_errors) || lead == before_errors.size();
    out += folded(line, columns, of_error ? before_errors.size() : lead + 4);
    if (end == std::string_view::npos) return out;
    out += '\n';
    text.remove_prefix(end + 1);
  }
}

void fail(const transport::Failure& failure, int code) {
  const std::string& verb = speaker();
  const bool has_verb = failure.what.starts_with(verb + ":") || failure.what.starts_with(verb + " ");
  const bool add_verb = code == exit_usage && !verb.empty() && !has_verb;
  complain({add_verb ? verb + ": " + failure.what : failure.what, remedy(failure)});
  throw Exit{code};
}

void complain(const transport::Failure& failure) {
  print(before_errors, failure.what);
  const std::string what_to_do = remedy(failure);
  for (std::string_view rest = what_to_do; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    print(line.empty() ? "" : std::string(before_errors.size(), ' '), line);
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
}

void remark(std::string_view text) {
  print("", text);
}

HeldMessages::HeldMessages() {
  kept().keeps = true;
}

HeldMessages::~HeldMessages() {
  kept().keeps = false;
  const WithoutBrokenPipe message;
  for (const std::string& line : std::exchange(kept().lines, {}))
    std::fprintf(stderr, "%s\n", folded_message(line, columns_of(STDERR_FILENO)).c_str());
}

std::size_t HeldMessages::count() {
  return kept().lines.size();
}

std::string_view HeldMessages::newest() {
  return kept().lines.empty() ? std::string_view{} : kept().lines.back();
}

std::string counted(std::uint64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void add_count(std::string& text, std::uint64_t count, std::string_view what) {
  if (count != 0) text += fmt::format(", {} {}", count, what);
}

void add_count(std::string& text, std::uint64_t count, std::string_view noun, std::string_view what) {
  if (count != 0) text += fmt::format(", {}{}{}", counted(count, noun), what.empty() ? "" : " ", what);
}

}  // namespace ocm::cli
