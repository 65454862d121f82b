#include "cli/fleet/line_request.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "ocm/cognitive/fleet.hpp"

namespace ocm::cli::fleet {
namespace {

using Ask = LineRequest::Kind;

/// A word, and what follows it: r a robot, a an angle, d a distance, t milliseconds, o an offset, f a form.
struct Form {
  std::string_view word;
  Ask kind;
  std::string_view arguments;
};
constexpr std::array<Form, 17> forms{{{"robots", Ask::robots, ""},
                                      {"robots", Ask::robots, "r"},
                                      {"json", Ask::json, ""},
                                      {"json", Ask::json, "r"},
                                      {"scan", Ask::scan, "t"},
                                      {"connect", Ask::connect, "r"},
                                      {"go", Ask::go, "rad"},
                                      {"stop", Ask::stop, "r"},
                                      {"leave", Ask::leave, "r"},
                                      {"pause", Ask::pause, "r"},
                                      {"unpause", Ask::unpause, "r"},
                                      {"ping", Ask::ping, "r"},
                                      {"who", Ask::who, "r"},
                                      {"calibrate", Ask::calibrate, "r"},
                                      {"compass", Ask::compass, "r"},
                                      {"map", Ask::map, "f"},
                                      {"more", Ask::more, "o"}}};
constexpr std::array<std::string_view, 6> map_forms{"svg", "png", "pdf", "pgm", "yaml", "grid"};

template <class Number>
bool read(std::string_view text, Number& value, std::int64_t least, std::int64_t most) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number < least || number > most)
    return false;
  value = static_cast<Number>(number);
  return true;
}

bool read(char what, std::string_view text, LineRequest& request) {
  const auto& fields = mapper::link::SetPoint::fields;
  std::int64_t milliseconds = 0;
  switch (what) {
    case 'r':
      return read(text, request.robot, 0, static_cast<std::int64_t>(cognitive::Fleet::most_robots) - 1);
    case 'a':
      return read(text, request.set_point.angle, fields[0].min, fields[0].max);
    case 'd':
      return read(text, request.set_point.distance, fields[1].min, fields[1].max);
    case 't':
      if (!read(text, milliseconds, 0, std::chrono::milliseconds{longest_scan}.count())) return false;
      request.time = std::chrono::milliseconds{milliseconds};
      return true;
    case 'o':
      return read(text, request.offset, 0, INT64_MAX);
    default:
      request.form = text;
      return std::find(map_forms.begin(), map_forms.end(), text) != map_forms.end();
  }
}

}  // namespace

std::optional<LineRequest> parse_line_request(std::string_view text) {
  constexpr std::size_t most_words = 4;
  std::array<std::string_view, most_words> words;
  std::size_t count = 0;
  for (bool more = true; more; ++count) {
    if (count == most_words) return std::nullopt;
    const std::size_t blank = text.find(' ');
    words[count] = text.substr(0, blank);
    more = blank != std::string_view::npos;
    text.remove_prefix(more ? blank + 1 : text.size());
  }
  for (const Form& form : forms) {
    if (form.word != words[0] || form.arguments.size() + 1 != count) continue;
    LineRequest request{.kind = form.kind};
    for (std::size_t i = 0; i < form.arguments.size(); ++i)
      if (!read(form.arguments[i], words[i + 1], request)) return std::nullopt;
    return request;
  }
  return std::nullopt;
}

}  // namespace ocm::cli::fleet
