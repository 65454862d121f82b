/// Mappers draw a map of where they are, together; and how well it agrees with walls that are known.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/fleet/map_run.hpp"
#include "cli/fleet/map_view.hpp"
#include "cli/serve/beside.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {
namespace {

using cognitive::Agreement;
using fleet::End;
using fleet::MapRun;

constexpr std::uint32_t default_port = 8484;

/// --live, and what belongs to it.
struct MapPage {
  bool live = false;
  bool commands = false;
  bool opens = false;
  std::uint32_t port = default_port;
};

/// A file of every kind that is asked for, before any robot moves.
void check_files(const std::vector<std::string>& files) {
  for (const std::string& file : files)
    if (!fleet::is_map_file(file))
      fail({fmt::format("map: {}: no kind of map", file), "end it in .svg, .png, .pdf or .pgm"}, exit_usage);
  for (const std::string& file : files) {
    auto failure = fleet::cannot_draw(file);
    if (!failure) failure = cannot_write(file);
    if (!failure) continue;
    failure->what = "map: " + failure->what;
    fail(*failure);
  }
}

/// Writes all that can be written, and reports each file that cannot.
bool write_files(const std::vector<std::string>& files, const MapRun& run,
                 const std::optional<Agreement>& result) {
  bool all = true;
  for (const std::string& file : files) {
    const auto failure = fleet::write_map(file, run.map(), run.picture(result));
    remark(fmt::format("map: {}", failure ? failure->what + "; " + failure->remedy : file));
    all = all && !failure;
  }
  return all;
}

/// The page with the map, which joins this program's own line.
std::unique_ptr<serve::PageBeside> show(Session& session, const MapPage& page,
                                        const fleet::MapOptions& options, MapRun& run) {
  if (!page.live) return nullptr;
  serve::ServeOptions shown;
  shown.bus = false;
  shown.web.port = static_cast<std::uint16_t>(page.port);
  shown.opens = page.opens;
  shown.shows = "map";
  shown.commands = page.commands;
  shown.fleet =
      serve::FleetOptions{.line = options.line, .starts = {}, .world = {}, .call_back = false, .waits = true};
  shown.fleet->line.record.clear();  // it joins the line that the map records
  auto beside = std::make_unique<serve::PageBeside>(session, std::move(shown));
  run.on_end([page = beside.get()] { return page->end(); });
  return beside;
}

void run(Session& session, const fleet::MapOptions& options, const MapPage& page, int& exit_code) {
  if (page.live) serve::check_has_page("map --live");
  if (!page.live && (page.opens || page.commands || page.port != default_port))
    fail({"map: --port, --open and --allow-commands are of the page", "add --live, or drop them"},
         exit_usage);
  if (page.opens && page.commands)
    fail(
        {"map: --open and --allow-commands: other users of this machine would see the token, among the words "
         "of the browser's process",
         "drop one of them, and open the address by hand"},
        exit_usage);
  if (page.live && options.watch)
    fail({"map: --live with --watch", "amiroctl serve robots shows what another program draws"}, exit_usage);
  check_files(options.files);
  if (!(options.resolution_cm >= 0.5 && options.resolution_cm <= 50))
    fail({fmt::format("map: --resolution {}: no size of a cell", options.resolution_cm),
          "write centimetres, 0.5 to 50"},
         exit_usage);
  if (options.watch)
    if (const auto other = fleet::join_line("map", options.line)) {
      catch_interrupts();
      catch_hangups();
      exit_code = fleet::view_map(options, *other);
      return;
    }
  const fleet::Known known = fleet::known_of("map", options.world, options.starts);
  MapRun run{options, known};
  const auto beside = show(session, page, options, run);
  const End end = run.explore(options.duration);
  if (!run.any()) {
    if (interrupted() == 0) remark("map: no update came that could be drawn");
    exit_code = exit_code_after_interrupt(exit_failure);
    return;
  }
  const auto result = run.result();
  const bool written = write_files(options.files, run, result);
  run.report(result);
  exit_code = written && run.is_recorded()
                  ? exit_code_after_interrupt(is_success(end) ? exit_success : exit_failure)
                  : exit_failure;
}

}  // namespace

void declare_map(Verb verb, Session& session, int& exit_code) {
  verb.describe("let mappers explore, and draw a map of what they see", mapper_group,
                "  amiroctl map room.svg\n"
                "  amiroctl map room.png room.pgm --robots AVR --duration 5min\n"
                "  amiroctl map room.svg --start AVR=0.4,0.4,0 --start Arduino=2,1.4,180\n"
                "  amiroctl map room.svg --live               in a browser, too, while it grows\n"
                "  amiroctl map room.svg --world labyrinth    drawn over the true walls, and compared");
  const auto options = std::make_shared<fleet::MapOptions>();
  verb.add_option("file", options->files, ".svg, .png, .pdf; .pgm with a .yaml beside it for ROS")
      .required()
      .type_name("FILE ...");
  verb.add_option("--robots", options->robots, "names, addresses or indexes; default: all")
      .type_name("ROBOT ...");
  add_lasting(verb, "--duration", options->duration, "at most this long; default: until all is known");
  verb.add_option("--start", options->starts, "where a robot was switched on: metres, degrees")
      .type_name("NAME=X,Y,DEG");
  verb.add_option("--world", options->world,
                  "a simulated world, or its name: starts, central, true walls to compare with")
      .type_name("WORLD");
  verb.add_option("--resolution", options->resolution_cm, "side of a cell in cm")
      .type_name("CM")
      .show_default();
  verb.add_option("--range", options->range_m, "range of the central's radio in m: no robot is sent farther")
      .type_name("M")
      .range(0.1, 10'000.0);
  verb.add_option("--title", options->title, "default: the robots").type_name("TEXT");
  verb.add_flag("--watch", options->watch,
                "draw only: what another `amiroctl map` draws, or while a server elsewhere drives");
  verb.add_flag("--json", options->json, "figures as an object");
  const auto page = std::make_shared<MapPage>();
  verb.add_flag("--live", page->live, "show the map in a browser while it grows; prints the address");
  verb.add_option("--port", page->port, "of that page").type_name("N").range(0U, 65535U).show_default();
  verb.add_flag("--allow-commands", page->commands, "who opens the address that is printed may send robots");
  verb.add_flag("--open", page->opens, "in your browser, too");
  fleet::add_line_options(verb, options->line);
  fleet::add_record_option(verb, options->line);
  verb.callback([options, page, &session, &exit_code] { run(session, *options, *page, exit_code); });
}

}  // namespace ocm::cli
