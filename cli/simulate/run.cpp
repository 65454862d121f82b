#include "cli/simulate/run.hpp"

#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "ocm/transport/pty.hpp"
#include "ocm/transport/virtual_bus.hpp"

#include "cli/serve/beside.hpp"
#include "cli/shared/buses.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/memory.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/remedies.hpp"
#include "cli/simulate/text_show.hpp"

namespace ocm::cli::simulate {
namespace {

/// Prints what kept a simulation from running, and leaves; the exit code when it ran until a signal.
int exit_code_of(const sim::Ending& ending) {
  if (ending.well()) return exit_code_after_interrupt(exit_success);
  for (const auto& failure : ending.failures) complain(failure);
  throw Exit{ending.misuse ? exit_usage : exit_failure};
}

BusName bus_name_of(const Session& session) {
  return parse_bus_name(session.bus_name.empty() ? "sim" : session.bus_name);
}

bool is_over() {
  return interrupted() != 0;
}

/// The page of serve, once there is something to join: the simulated bus, or the mappers' central.
class Page {
 public:
  Page(const ShowOptions& show, Session& session, serve::ServeOptions options, std::function<bool()> ready)
      : session_(&session), options_(std::move(options)), ready_(std::move(ready)) {
    options_.web.port = static_cast<std::uint16_t>(show.port);
    options_.commands = show.commands;
    options_.opens = show.opens;
  }
  void look() {
    if (!page_ && ready_()) page_.emplace(*session_, std::move(options_));
  }
  /// Whether it has ended, which it is asked to.
  [[nodiscard]] bool end() { return !page_ || page_->end(); }

 private:
  Session* session_;
  serve::ServeOptions options_;
  std::function<bool()> ready_;
  std::optional<serve::PageBeside> page_;
};

/// What the page joins, and when that is there.
struct Joined {
  serve::ServeOptions options;
  std::function<bool()> ready;
};

/// Runs it until `stop`; where it is shown, until the user quits, too. The terminal is as it was before
/// anything is printed.
using Run = std::function<sim::Ending(const sim::Shell& shell)>;
int run_shown(const ShowOptions& show, TextShowOptions shown, Joined joined, Session& session,
              std::function<bool()> stop, const Run& run) {
  sim::Shell shell{std::move(stop), remark};
  std::optional<TextShow> screen;
  std::optional<Page> page;
  if (show.kind == "page") {
    serve::check_has_page("sim --show");
    page.emplace(show, session, std::move(joined.options), std::move(joined.ready));
    shell.stop = [&page, before = shell.stop] {
      page->look();
      return before() && page->end();  // it rests its robot, and leaves
    };
  }
  if (show.kind == "text") {
    catch_hangups();
    screen.emplace(session, std::move(shown));
    shell.stop = [&screen, before = shell.stop] { return screen->over() || before(); };
    shell.watch = [&screen](const std::function<sim::SeenWorld()>& look) { screen->watch(look); };
  }
  const sim::Ending ending = run(shell);
  screen.reset();
  return exit_code_of(ending);
}

/// Opens the interface that --bus names, and calls `serve` with it and a shell that tells of its states, too.
template <typename Serve>
int serve_on_interface(const ShowOptions& show, Session& session, Serve&& serve) {
  const auto bus = session.open_bus();
  StateWatch watch;
  const auto stop = [&bus, &watch] {
    watch.look(*bus);
    return is_over();
  };
  session.bus_name = bus->name();
  return run_shown(show, {.bus = std::string{bus->name()}}, {{}, [] { return true; }}, session, stop,
                   [&](const sim::Shell& shell) { return serve(*bus, shell); });
}

}  // namespace

bool on_virtual_bus(const Session& session) {
  return bus_name_of(session).kind == BusName::Kind::simulated;
}

int run_amiro(const sim::AmiroOptions& options, const ShowOptions& show, Session& session) {
  if (options.qemu && options.speed != 1)
    fail({"sim: --speed with --boards qemu", "leave one out: emulated boards run in real time"}, exit_usage);
  if (!options.qemu && !options.images.empty())
    fail({"sim: --images without --boards qemu", "add --boards qemu, or leave --images out"}, exit_usage);
  catch_interrupts();
  catch_hangups();  // a closed terminal is no crash
  if (!session.spec_files.empty() && options.messages == nullptr)
    remark(
        "the simulated robot is the AMiRo, whatever --spec says; --without "
        "di_wheel_drive,power_management,light_ring leaves the bus to boards of your own");
  const BusName bus_name = bus_name_of(session);
  if (bus_name.kind == BusName::Kind::simulated) {
    (void)session.catalogue();  // read here: the page has a thread of its own
    session.bus_name = bus_name.address.empty() ? "sim" : "sim:" + bus_name.address;
    const std::string path =
        bus_name.address.empty() ? transport::virtual_bus::default_path() : bus_name.address;
    return run_shown(
        show, {options.speed, session.bus_name},
        {{}, [path] { return transport::VirtualBus::running(path); }}, session, is_over,
        [&](const sim::Shell& shell) { return sim::serve_amiro(bus_name.address, options, shell); });
  }
  if (options.messages != nullptr)
    fail({"sim: a robot and messages with --bus " + session.bus_name,
          "both play on a virtual bus only: leave --bus out, or one of the specs"},
         exit_usage);
  return serve_on_interface(show, session, [&](transport::Bus& bus, const sim::Shell& shell) {
    return sim::serve_amiro(bus, options, shell);
  });
}

int run_messages(const sim::MessagesOptions& options, Session& session) {
  catch_interrupts();
  catch_hangups();
  const auto& catalogue = session.catalogue();
  const BusName bus_name = bus_name_of(session);
  if (bus_name.kind == BusName::Kind::simulated)
    return exit_code_of(sim::serve_messages(bus_name.address, catalogue, options, {is_over, remark}));
  return serve_on_interface({}, session, [&](transport::Bus& bus, const sim::Shell& shell) {
    return sim::serve_messages(bus, catalogue, options, shell);
  });
}

int run_mappers(const sim::MapperOptions& options, const ShowOptions& show, Session& session) {
  const EndsWithoutMemory ends;  // a world is a document of JSON
  catch_interrupts();
  catch_hangups();  // the lines' links must go with it
  Joined joined{{}, [] { return transport::is_served(transport::central_line()); }};
  joined.options.bus = false;
  joined.options.shows = "map";
  joined.options.fleet.emplace().world = options.world.empty() ? "square" : options.world;
  return run_shown(show, {options.speed, {}}, std::move(joined), session, is_over,
                   [&](const sim::Shell& shell) { return sim::serve_mappers(options, shell); });
}

}  // namespace ocm::cli::simulate
