/// Mappers draw a map of where they are, together; and how well it agrees with walls that are known.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/fleet/map_run.hpp"
#include "cli/fleet/map_view.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verbs.hpp"

namespace ocm::cli {
namespace {

using cognitive::Agreement;
using fleet::End;
using fleet::MapRun;

/// A file of every kind that is asked for, before any robot moves.
void check_files(const std::vector<std::string>& files) {
  for (const std::string& file : files)
    if (!fleet::is_map_file(file))
      fail({fmt::format("map: {}: no kind of map", file), "end it in .svg, .png, .pdf or .pgm"}, exit_usage);
  for (const std::string& file : files)
    if (auto failure = fleet::cannot_draw(file)) {
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

void run(const fleet::MapOptions& options, int& exit_code) {
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
  const End end = run.explore(options.duration);
  if (!run.any()) {
    if (interrupted() == 0) remark("map: no update came that could be drawn");
    exit_code = exit_code_after_interrupt(exit_failure);
    return;
  }
  const auto result = run.result();
  const bool written = write_files(options.files, run, result);
  run.report(result);
  exit_code =
      written ? exit_code_after_interrupt(is_success(end) ? exit_success : exit_failure) : exit_failure;
}

}  // namespace

void add_map(Verb app, Session&, int& exit_code) {
  auto verb =
      app.add_verb("map", "let mappers explore, and draw a map of what they see", mapper_group,
                   "  amiroctl map room.svg\n"
                   "  amiroctl map room.png room.pgm --robots AVR --duration 5min\n"
                   "  amiroctl map room.svg --start AVR=0.4,0.4,0 --start Arduino=2,1.4,180\n"
                   "  amiroctl map room.svg --world labyrinth    drawn over the true walls, and compared");
  const auto options = std::make_shared<fleet::MapOptions>();
  verb.add_option("file", options->files, ".svg, .png, .pdf; .pgm with a .yaml beside it for ROS")
      .required()
      .type_name("FILE ...");
  verb.add_option("--robots", options->robots, "names, addresses or indexes; default: all")
      .type_name("ROBOT ...");
  add_duration(verb, "--duration", options->duration, "at most this long; default: until all is known");
  verb.add_option("--start", options->starts, "where a robot was switched on: metres, degrees")
      .type_name("NAME=X,Y,DEG");
  verb.add_option("--world", options->world,
                  "a simulated world, or its name: starts, central, true walls to compare with")
      .type_name("FILE");
  verb.add_option("--resolution", options->resolution_cm, "side of a cell in cm")
      .type_name("CM")
      .show_default();
  verb.add_option("--range", options->range_m, "range of the central's radio in m: no robot is sent farther")
      .type_name("M");
  verb.add_option("--title", options->title, "default: the robots").type_name("TEXT");
  verb.add_flag("--watch", options->watch,
                "draw only: what another `amiroctl map` draws, or while a server elsewhere drives");
  verb.add_flag("--json", options->json, "figures as an object");
  fleet::add_line_options(verb, options->line);
  verb.callback([options, &exit_code] { run(*options, exit_code); });
}

}  // namespace ocm::cli
