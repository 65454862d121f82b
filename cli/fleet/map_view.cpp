#include "cli/fleet/map_view.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "cli/fleet/line_time.hpp"
#include "cli/plot/gnuplot.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/output_file.hpp"

namespace ocm::cli::fleet {
namespace {

using namespace std::chrono_literals;

enum class Drawn : std::uint8_t { yes, nothing_yet, refused };

/// A text of the other program's map. Leaves where it draws none.
std::optional<std::string> text_of(JoinedLine& line, std::string_view form) {
  transport::Failure failure;
  auto text = line.map(form, failure);
  if (!text && !line.over()) fail({fmt::format("map: {}", failure.what), failure.remedy});
  if (!text) remark(fmt::format("map: {}", failure.what));
  return text;
}

/// Beside the others: what cannot be written is reported, and does not end the view.
Drawn write(const std::string& file, std::string_view form, const std::string& text, JoinedLine& line) {
  if (text.empty()) return Drawn::nothing_yet;
  std::optional<transport::Failure> failure;
  if (form == "pgm") {
    failure = try_to_write(file, text);
    auto yaml = std::filesystem::path{file};
    const auto about = failure ? std::nullopt : text_of(line, "yaml");
    if (about)  // its first line names the other program's image
      failure = try_to_write(yaml.replace_extension(".yaml").string(),
                             fmt::format("image: {}{}", std::filesystem::path{file}.filename().string(),
                                         about->substr(std::min(about->size(), about->find('\n')))));
  } else {
    const auto drawn = plot::draw(text);
    if (!drawn)
      failure = drawn.error;
    else
      failure = try_to_write(file, *drawn);
  }
  if (!failure) return Drawn::yes;
  remark(fmt::format("map: {}: {}; {}", file, failure->what, failure->remedy));
  return Drawn::refused;
}

}  // namespace

int view_map(const MapOptions& options, JoinedLine& line) {
  constexpr base::Duration between = 2s;
  const base::Time begin = line_time();
  const std::string who = line.path();
  unsigned times = 0;
  bool whole = true;
  remark(fmt::format("map: draws what {} draws, each 2 s; Ctrl-C ends that", who));
  const auto over = [&] {
    return interrupted() != 0 || line.over() ||
           (options.duration && line_time() - begin >= *options.duration);
  };
  while (!over()) {
    const base::Time next = line_time() + between;
    bool any = false;
    whole = true;
    for (const std::string& file : options.files) {
      const std::string form = file.substr(file.rfind('.') + 1);  // as is_map_file: of `.svg`, too
      const auto text = text_of(line, form);
      if (!text) break;  // it has ended
      const Drawn drawn = write(file, form, *text, line);
      any = any || drawn == Drawn::yes;
      whole = whole && drawn != Drawn::refused;
    }
    if (any) ++times;
    while (!over() && line_time() < next) sleep_for(50ms);
  }
  const double seconds = static_cast<double>((line_time() - begin).count()) / 1e9;
  if (options.json)
    fmt::print("{}\n", Json{{"watched", who}, {"seconds", seconds}, {"drawn", times}}.line());
  else
    fmt::print("what {} drew in {:.0f} s, drawn {}\n", who, seconds, counted(times, "time"));
  return exit_code_after_interrupt(times != 0 && whole ? exit_success : exit_failure);
}

}  // namespace ocm::cli::fleet
