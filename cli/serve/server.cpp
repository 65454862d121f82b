#include "cli/serve/server.hpp"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "cli/bus_model/feed.hpp"
#include "cli/command/operated_bus.hpp"
#include "cli/fleet/known.hpp"
#include "cli/fleet/line_log_file.hpp"
#include "cli/fleet/line_replay.hpp"
#include "cli/serve/live_bus.hpp"
#include "cli/serve/page_server.hpp"
#include "cli/serve/played_log.hpp"
#include "cli/serve/robots_alone.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "generator/spec/model.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli::serve {
namespace {

using bus_model::LogFeed;

/// Of robots alone, without a bus.
const protocol::Catalogue no_topics{.robot = "mappers", .bit_rate = 0, .boards = {}, .topics = {}};

int run_fleet_log(ServeOptions options, Source source) {
  const fleet::Known known = fleet::known_of("serve", options.fleet->world, options.fleet->starts);
  fleet::ReadLineLog log = fleet::read_line_log("serve", options.log);
  if (log.damaged != 0)
    remark(fmt::format("serve: {}: {} could not be read, the first is line {}", options.log,
                       counted(log.damaged, "line"), log.first_damaged));
  if (log.said.empty())
    fail({fmt::format("serve: {}: nothing that a central has said is in it", options.log),
          "was it recorded while robots had links?"});
  static const spec::Model no_model;
  PageServer server{no_topics, no_model, std::move(options), std::move(source), {}, 0};
  server.open();
  return serve_robots_of_log(server, fleet::LineReplay{std::move(log), known});
}

}  // namespace

void check_has_page(std::string_view verb) {
  if (has_websockets && has_page()) return;
  fail({fmt::format("{} needs libwebsockets and dygraphs, which were missing when this amiroctl was built",
                    verb),
        "install libwebsockets-dev and libjs-dygraphs, then build it again: scripts/build"});
}

int run(Session& session, ServeOptions options) {
  check_has_page("serve");
  catch_interrupts();
  catch_hangups();
  Source source{{}, options.log.empty(), options.commands};
  if (!options.log.empty()) {
    source.name = std::filesystem::path{options.log}.filename().string();
    if (options.fleet) return run_fleet_log(std::move(options), std::move(source));
    LogFeed log{options.log, options.format, session.catalogue()};
    if (interrupted() != 0) return exit_code_after_interrupt(exit_success);
    PageServer server{session.catalogue(), session.spec().model(), std::move(options),
                      std::move(source),   log.interfaces(),       0};
    server.open();
    return serve_log(server, log);
  }
  if (!options.bus) {
    static const spec::Model no_model;
    const std::string& path = options.fleet->line.path;
    source.name = path.empty() ? "central" : path;
    PageServer server{no_topics, no_model, std::move(options), std::move(source), {}, 0};
    server.open();
    return serve_robots(server);
  }
  auto bus = options.commands ? open_to_command(session, "serve") : session.open_bus();
  source.name = std::string{bus->name()};
  PageServer server{session.catalogue(), session.spec().model(), std::move(options), source,
                    {source.name},       bus->bit_rate()};
  server.open();
  return serve_bus(server, session, std::move(bus));
}

}  // namespace ocm::cli::serve
