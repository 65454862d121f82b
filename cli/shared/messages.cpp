#include "cli/shared/messages.hpp"

#include <algorithm>
#include <cstdio>
#include <string>

#include <fmt/format.h>

#include "cli/shared/interrupt.hpp"
#include "cli/shared/remedies.hpp"

namespace ocm::cli {
namespace {

/// The verb that runs.
std::string& speaker() {
  static std::string verb;
  return verb;
}

void print(std::string_view before, std::string_view raw) {
  const std::string text = printable(raw);
  const WithoutBrokenPipe message;  // `stop 2>&1 | true` stops
  std::fprintf(stderr, "%.*s%.*s\n", static_cast<int>(before.size()), before.data(),
               static_cast<int>(text.size()), text.data());
}

}  // namespace

void speak_for(std::string_view verb) {
  speaker() = verb;
}

std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool second_set = byte == 0xC2 && i + 1 < text.size() &&
                            (static_cast<unsigned char>(text[i + 1]) & 0xE0) == 0x80;  // U+0080 to U+009F
    if ((byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7F)
      out += fmt::format("\\x{:02x}", byte);
    else if (second_set)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[++i]));
    else
      out += text[i];
  }
  return out;
}

void fail(const transport::Failure& failure, int code) {
  const std::string& verb = speaker();
  const bool has_verb = failure.what.starts_with(verb + ":") || failure.what.starts_with(verb + " ");
  const bool add_verb = code == exit_usage && !verb.empty() && !has_verb;
  complain({add_verb ? verb + ": " + failure.what : failure.what, remedy(failure)});
  throw Exit{code};
}

void complain(const transport::Failure& failure) {
  print("amiroctl: ", failure.what);
  const std::string what_to_do = remedy(failure);
  for (std::string_view rest = what_to_do; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    print(line.empty() ? "" : "          ", line);
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
}

void remark(std::string_view text) {
  print("", text);
}

void add_count(std::string& text, std::uint64_t count, std::string_view what) {
  if (count != 0) text += fmt::format(", {} {}", count, what);
}

}  // namespace ocm::cli
