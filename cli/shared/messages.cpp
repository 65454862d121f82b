#include "cli/shared/messages.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <deque>
#include <fcntl.h>
#include <mutex>
#include <new>
#include <poll.h>
#include <string>
#include <sys/uio.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/utf8.hpp"

#include "cli/shared/folding.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/remedies.hpp"
#include "cli/shared/terminal.hpp"
#include "cli/shared/unhurried_messages.hpp"

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
  bool holds = false;      ///< a screen is where they would be written
  unsigned unhurried = 0;  ///< parts of the program that must not wait for stderr
  std::deque<std::string> lines;
  std::size_t written = 0;  ///< of the first line and its line feed
  std::uint64_t lost = 0;   ///< there was no room for
  /// Of any thread: a verb may have a page, and robots behind a central, in threads of their own.
  std::mutex mutex;
};
Kept& kept() {
  static Kept messages;
  return messages;
}

constexpr std::size_t most_kept = 1000;  // of those that stderr does not take

/// Whether it takes something within so long: a pipe takes a page then, a terminal may take one byte.
bool takes(int descriptor, std::chrono::milliseconds patience) {
  pollfd entry{descriptor, POLLOUT, 0};
  return ::poll(&entry, 1, static_cast<int>(patience.count())) > 0;
}
constexpr std::size_t most_at_once = 256;

/// A terminal is opened a second time, without blocking: other programs share the first descriptor, and its
/// flags. The descriptor itself where it is no terminal, or the terminal cannot be opened.
int non_blocking(int descriptor) {
  static std::array<int, STDERR_FILENO + 1> opened{-1, -1, -1};
  if (isatty(descriptor) == 0) return descriptor;
  int& again = opened.at(static_cast<std::size_t>(descriptor));
  if (again < 0) {
    const std::string path = fmt::format("/proc/self/fd/{}", descriptor);
    again = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (again < 0) again = descriptor;
  }
  return again;
}

/// Writes what is kept, in pieces that do not wait, as long as stderr takes one within `patience`.
void write_kept(Kept& messages, std::chrono::milliseconds patience) {
  using std::chrono::steady_clock;
  if (messages.lines.empty() && messages.lost == 0) return;
  const WithoutBrokenPipe message;
  const auto end = steady_clock::now() + patience;
  for (;;) {
    if (messages.lines.empty() && messages.lost != 0)
      messages.lines.push_back(counted(std::exchange(messages.lost, 0), "message") +
                               " lost: stderr took none");
    if (messages.lines.empty()) return;
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - steady_clock::now());
    if (!takes(STDERR_FILENO, std::max(left, std::chrono::milliseconds{0}))) return;
    std::string& line = messages.lines.front();
    const std::size_t left_of_it = line.size() - messages.written;
    // Takes no memory: the message may be that there is none.
    char line_feed[] = "\n";
    const std::array<iovec, 2> pieces{{{line.data() + messages.written, std::min(left_of_it, most_at_once)},
                                       {line_feed, left_of_it < most_at_once ? 1U : 0U}}};
    const int out = non_blocking(STDERR_FILENO);
    const ssize_t size = ::writev(out, pieces.data(), static_cast<int>(pieces.size()));
    if (size < 0 && (errno == EINTR || errno == EAGAIN)) return;
    // Where it fails there is no reader, or a full disk.
    messages.written += size < 0 ? left_of_it + 1 : static_cast<std::size_t>(size);
    if (messages.written <= messages.lines.front().size()) continue;
    messages.lines.pop_front();
    messages.written = 0;
  }
}

/// Once: what takes the ^C off the line, which the terminal has shown.
std::string_view erased_echo() {
  static bool erased = false;
  if (erased || interrupted() != SIGINT || !can_redraw(STDERR_FILENO)) return {};
  erased = true;
  return "\r\x1b[K";
}

void print(std::string_view before, std::string_view raw) {
  const std::string text = std::string{before} + printable(raw);
  Kept& messages = kept();
  const std::lock_guard lock{messages.mutex};
  if (messages.holds) {
    messages.lines.push_back(text);
  } else if (messages.unhurried == 0) {
    const WithoutBrokenPipe message;  // `stop 2>&1 | true` stops
    std::fprintf(stderr, "%s%s\n", std::string{erased_echo()}.c_str(),
                 folded_message(text, columns_of(STDERR_FILENO)).c_str());
  } else {
    if (messages.lines.size() < most_kept)
      messages.lines.push_back(std::string{erased_echo()} + folded_message(text, columns_of(STDERR_FILENO)));
    else
      ++messages.lost;
    write_kept(messages, std::chrono::milliseconds{0});
  }
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
  const std::lock_guard lock{kept().mutex};
  kept().holds = true;
}

HeldMessages::~HeldMessages() {
  const std::lock_guard lock{kept().mutex};
  kept().holds = false;
  const WithoutBrokenPipe message;
  for (const std::string& line : std::exchange(kept().lines, {}))
    std::fprintf(stderr, "%s\n", folded_message(line, columns_of(STDERR_FILENO)).c_str());
}

std::size_t HeldMessages::count() {
  const std::lock_guard lock{kept().mutex};
  return kept().lines.size();
}

std::string_view HeldMessages::newest() {
  const std::lock_guard lock{kept().mutex};
  return kept().lines.empty() ? std::string_view{} : kept().lines.back();
}

UnhurriedMessages::UnhurriedMessages() {
  const std::lock_guard lock{kept().mutex};
  ++kept().unhurried;
}

UnhurriedMessages::~UnhurriedMessages() {
  const std::lock_guard lock{kept().mutex};
  if (--kept().unhurried != 0 || kept().holds) return;
  try {
    write_kept(kept(), std::chrono::seconds{1});
  } catch (const std::bad_alloc&) {  // the number of lost messages is not said: that needs memory
  }
  kept().lines.clear();
}

void UnhurriedMessages::write() {
  const std::lock_guard lock{kept().mutex};
  if (!kept().holds) write_kept(kept(), std::chrono::milliseconds{0});
}

void never_wait_for_messages() {
  static const UnhurriedMessages messages;
}

Written write_now(int descriptor, std::string_view text) {
  Written written;
  while (written.bytes < text.size() && takes(descriptor, std::chrono::milliseconds{0})) {
    const std::string_view piece = text.substr(written.bytes, most_at_once);
    const ssize_t size = ::write(non_blocking(descriptor), piece.data(), piece.size());
    if (size < 0 && (errno == EINTR || errno == EAGAIN)) break;
    if (size < 0) {
      written.error = errno;
      break;
    }
    written.bytes += static_cast<std::size_t>(size);
  }
  return written;
}

void add_count(std::string& text, std::uint64_t count, std::string_view what) {
  if (count != 0) text += fmt::format(", {} {}", count, what);
}

void add_count(std::string& text, std::uint64_t count, std::string_view noun, std::string_view what) {
  if (count != 0) text += fmt::format(", {}{}{}", counted(count, noun), what.empty() ? "" : " ", what);
}

}  // namespace ocm::cli
