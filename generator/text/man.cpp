#include "generator/text/man.hpp"

#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

/// What roff would read as its own: a backslash anywhere, a hyphen (which it might make a dash, so that an
/// option could not be copied), a dot or a quote that begins a line.
std::string escaped(std::string_view line) {
  std::string out = line.starts_with('.') || line.starts_with('\'') ? "\\&" : "";
  for (const char c : line) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

/// Line by line, without the last break.
template <class F>
void for_each_line(std::string_view text, F&& f) {
  while (text.ends_with('\n')) text.remove_suffix(1);
  for (;;) {
    const std::size_t end = text.find('\n');
    f(text.substr(0, end));
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
  }
}

std::string upper(std::string_view name) {
  std::string out{name};
  for (char& c : out)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return out;
}

}  // namespace

ManPage::ManPage(std::string_view name, std::string_view what, std::string_view version) {
  // Without a date: the same release gives the same bytes.
  page_ = ".TH " + escaped(upper(name)) + " 1 \"\" \"ocm " + std::string{version} + "\" \"ocm\"\n";
  section("NAME");
  page_ += escaped(name) + " \\- " + escaped(what) + "\n";
}

void ManPage::section(std::string_view heading) {
  page_ += ".SH " + quoted(heading) + "\n";
}

ManPage& ManPage::text(std::string_view heading, std::string_view text) {
  section(heading);
  for_each_line(text,
                [this](std::string_view line) { page_ += (line.empty() ? ".PP" : escaped(line)) + "\n"; });
  return *this;
}

ManPage& ManPage::literal(std::string_view heading, std::string_view text) {
  section(heading);
  page_ += ".nf\n";
  for_each_line(text, [this](std::string_view line) { page_ += escaped(line) + "\n"; });
  page_ += ".fi\n";
  return *this;
}

}  // namespace ocm::generate
