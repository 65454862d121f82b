/// Fields as a picture: over time, or one against another; of a log, or of the bus for a while.
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "ocm/base/text.hpp"
#include "ocm/log/complaints.hpp"

#include "cli/output/printer.hpp"
#include "cli/plot/curves.hpp"
#include "cli/plot/gnuplot.hpp"
#include "cli/serve/server.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/chosen_topics.hpp"
#include "cli/watch/watching.hpp"

namespace ocm::cli {
namespace {

constexpr std::size_t most_curves = 64;

struct PlotOptions {
  std::vector<std::string> words;
  WatchOptions watch;
  std::string output;
  std::string size;
  std::string title;
  bool script = false;
  bool live = false;
  bool opens = false;
  std::uint32_t port = 8484;
};

/// By the ending of the file; a pipe gets SVG.
plot::Kind kind_of(const std::string& output) {
  if (output == "-") return plot::Kind::svg;
  if (const auto kind = plot::kind_of_file(output)) return *kind;
  fail({fmt::format("plot: {}: no kind of picture", output), "end it in .svg, .png or .pdf"}, exit_usage);
}

constexpr std::uint64_t least_side = 200, most_side = 16'384;

struct Size {
  std::uint64_t width = 0, height = 0;
};

std::optional<Size> parse_size(std::string_view text) {
  const std::size_t times = text.find('x');
  if (times == std::string_view::npos) return std::nullopt;
  const auto width = base::parse_unsigned(text.substr(0, times));
  const auto height = base::parse_unsigned(text.substr(times + 1));
  const auto fits = [](const auto& side) { return side && *side >= least_side && *side <= most_side; };
  if (!fits(width) || !fits(height)) return std::nullopt;
  return Size{*width, *height};
}

std::string a_size() {
  return fmt::format("WIDTHxHEIGHT in pixels, {} to {} each, such as 1200x600", least_side, most_side);
}

Accepted accepted_size() {
  return {ValueKind::text, false, a_size(), {}, [](const std::string& text) {
            return parse_size(text).has_value();
          }};
}

void read_size(const std::string& text, plot::Picture& picture) {
  if (text.empty()) return;
  const auto size = parse_size(text);
  if (!size) fail({fmt::format("--size {}: no size", text), "write " + a_size()}, exit_usage);
  picture.width = static_cast<unsigned>(size->width);
  picture.height = static_cast<unsigned>(size->height);
}

std::vector<plot::Wanted> read_fields(const std::vector<std::string>& words,
                                      const protocol::Catalogue& catalogue) {
  std::vector<plot::Wanted> wanted;
  for (const auto& word : words) {
    const auto parsed = plot::parse_fields(catalogue, word);
    if (!parsed) fail({"plot: " + parsed.error.what, parsed.error.remedy}, exit_usage);
    wanted.insert(wanted.end(), parsed->begin(), parsed->end());
  }
  if (wanted.empty())
    fail({"plot: no field to draw",
          "name some: plot drive.log gyroscope.z; `amiroctl info gyro` lists fields"},
         exit_usage);
  if (wanted.size() > most_curves)
    fail({fmt::format("plot: {} curves are too many for a picture", wanted.size()),
          fmt::format("name {} fields at most", most_curves)},
         exit_usage);
  const auto units = [](const plot::Wanted& path) {
    return std::pair{path.x->field->unit, path.y.field->unit};
  };
  for (const auto& each : wanted) {
    if (each.x.has_value() != wanted[0].x.has_value())
      fail({"plot: a path and curves over time do not fit into one picture", "draw them one by one"},
           exit_usage);
    if (each.x && units(each) != units(wanted[0]))
      fail({"plot: paths of other units do not fit into one picture", "draw them one by one"}, exit_usage);
  }
  return wanted;
}

/// "2015-07-10 06:55:52 UTC, 12.3 s", as far as the log knows the day.
std::string when(const plot::Curves& curves) {
  const base::Time begin = curves.begin().value_or(base::Time{});
  const auto seconds = std::chrono::floor<std::chrono::seconds>(begin.time_since_epoch());
  std::string text;
  constexpr std::chrono::hours year{24 * 365};
  if (seconds > year)
    text = fmt::format("{:%Y-%m-%d %H:%M:%S} UTC, ", fmt::gmtime(static_cast<std::time_t>(seconds.count())));
  return text + fmt::format("{:.6g} s", static_cast<double>((curves.end() - begin).count()) / 1e9);
}

void tell_missing(const plot::Curves& curves) {
  for (const auto& curve : curves.all()) {
    if (curve.envelope.count() != 0) continue;
    const auto& wanted = curve.wanted;
    remark(fmt::format("no {} came", wanted.x ? wanted.x->name + " with " + wanted.y.name : wanted.y.name));
  }
}

/// As an address may have it behind its #.
std::string in_address(std::string_view name) {
  std::string text;
  for (const char c : name) {
    const bool plain =
        (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '.';
    text += plain ? std::string{c} : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return text;
}

/// The page of serve with these fields, on the live bus.
int show_live(Verb verb, Session& session, const PlotOptions& options, const Words& words,
              const std::vector<plot::Wanted>& wanted) {
  for (const char* option : {"--output", "--size", "--title", "--script", "--from", "--count"})
    if (verb.is_typed(option))
      fail({fmt::format("plot: {} with --live", option), "the page has no such thing: drop one of them"},
           exit_usage);
  if (!words.files.empty())
    fail({fmt::format("plot: --live is of the bus, and {} is a log", words.files[0]),
          fmt::format("amiroctl serve {} shows a log, with a time bar", words.files[0])},
         exit_usage);
  if (wanted[0].x) fail({"plot: --live draws over time, and no path", "drop --live"}, exit_usage);
  std::string shows = "plot=";
  for (const plot::Wanted& each : wanted) {
    if (shows.back() != '=') shows += ',';
    shows += "/" + in_address(each.y.name);
  }
  serve::ServeOptions shown;
  shown.web.port = static_cast<std::uint16_t>(options.port);
  shown.opens = options.opens;
  shown.shows = std::move(shows);
  const auto end = time_after(Clock::now(), options.watch.duration.value_or(base::Duration{}));
  if (options.watch.duration) shown.over = [end] { return Clock::now() >= end; };
  return serve::run(session, std::move(shown));
}

void run(Verb verb, Session& session, const PlotOptions& options, int& exit_code) {
  const auto& catalogue = session.catalogue();
  Words words = split_words("plot", options.words, [&catalogue](std::string_view word) {
    return static_cast<bool>(plot::parse_fields(catalogue, word));
  });
  const auto wanted = read_fields(words.others, catalogue);
  if (options.live) {
    exit_code = show_live(verb, session, options, words, wanted);
    return;
  }
  for (const char* option : {"--port", "--open"})
    if (verb.is_typed(option))
      fail({fmt::format("plot: {} is of the page", option), "add --live, or drop it"}, exit_usage);
  const bool terminal = isatty(STDOUT_FILENO) != 0;
  const std::string output = !options.output.empty() ? options.output : terminal ? "plot.svg" : "-";
  plot::Picture picture;
  picture.kind = kind_of(output);
  for (const std::string& file : words.files) refuse_same_file("plot", file, output);
  read_size(options.size, picture);

  plot::Curves curves{catalogue, wanted};
  Watching watching{session, options.watch, std::move(words.files)};
  watching.run([&](auto entries, const auto& interfaces) { curves.take(entries, interfaces); }, {});
  tell_missing(curves);
  if (const auto lost = curves.lost_messages(); lost != 0)
    remark(fmt::format(
        "{} of J1939 {} not put together, so the curves may lack values; `amiroctl decode` says why",
        counted(lost, "message"), lost == 1 ? "was" : "were"));
  if (curves.points() == 0) {
    if (interrupted() == 0)
      remark(fmt::format("amiroctl: plot: nothing to draw came from {}", watching.source()));
    std::vector<const protocol::Topic*> topics;
    for (const plot::Wanted& each : wanted) topics.push_back(each.y.topic);
    if (watching.live() && interrupted() == 0) tell_to_ask(catalogue, topics);
    exit_code = exit_code_after_interrupt(watching.ending(exit_failure));
    return;
  }
  picture.title =
      !options.title.empty() ? options.title : fmt::format("{}: {}", catalogue.robot, watching.source());
  picture.subtitle = when(curves);
  std::string text = plot::to_script(curves, picture);
  if (!options.script) {
    auto drawn = plot::draw(text);
    if (!drawn)
      fail({drawn.error.what, drawn.error.remedy + (drawn.error.remedy.empty() ? "" : "; or ") +
                                  "--script prints what it would draw"});
    text = std::move(*drawn);
  }
  if (output == "-")
    write_out(text);
  else
    write_file(output, text);
  if (output != "-")
    remark(fmt::format("{}: {} of {}", output, counted(curves.points(), "point"),
                       counted(wanted.size(), "curve")));
  exit_code = exit_code_after_interrupt(watching.ending(exit_code));
}

}  // namespace

void declare_plot(Verb verb, Session& session, int& exit_code) {
  verb.describe("draw fields over time, or one against another", log_group,
                "  amiroctl plot drive.log gyroscope.z -o turn.png\n"
                "  amiroctl plot drive.log 'gyro.*' odometry.velocity   a panel for each unit\n"
                "  amiroctl plot drive.log odometry.x:odometry.y       where it drove\n"
                "  amiroctl plot live gyro.z --duration 10s\n"
                "  amiroctl plot --live gyro.z                         in a browser");
  const auto options = std::make_shared<PlotOptions>();
  verb.add_option("words", options->words,
                  "logs, any format; none, or live: the bus. Fields: gyroscope.z, 'gyro.*', "
                  "odometry.x:odometry.y")
      .type_name("[FILE ...|live] FIELD ...");
  verb.add_option("-o,--output", options->output,
                  ".svg, .png or .pdf; - is SVG on stdout. Default: plot.svg on a terminal, otherwise -")
      .type_name("FILE");
  verb.add_option("--size", options->size, "in pixels; default: as is right for what is drawn")
      .type_name("WIDTHxHEIGHT")
      .takes(accepted_size());
  verb.add_option("--title", options->title, "default: the robot and the log").type_name("TEXT");
  verb.add_flag("--script", options->script, "print gnuplot's commands, and draw nothing");
  verb.add_flag("--live", options->live, "in a browser, while they come; prints the address");
  verb.add_option("--port", options->port, "of that page").type_name("N").range(0U, 65535U).show_default();
  verb.add_flag("--open", options->opens, "in your browser, too");
  add_watch_options(verb, options->watch);
  verb.callback([options, verb, &session, &exit_code] { run(verb, session, *options, exit_code); });
}

}  // namespace ocm::cli
