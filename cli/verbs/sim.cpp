/// A simulated robot: the AMiRo on a virtual bus or on a CAN interface, mappers, or the messages of a spec.
/// What the options mean together; cli/simulate runs it.
#include <array>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "cli/shared/session.hpp"
#include "cli/shared/values.hpp"
#include "cli/simulate/cast.hpp"
#include "cli/simulate/run.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/command.hpp"

namespace ocm::cli {
namespace {

using simulate::Cast;

// --- the AMiRo ---

void add_boards(Verb verb, sim::AmiroOptions& options, std::string& boards) {
  verb.add_flag("--frozen", options.world.frozen, "freeze the world's time: nothing moves, no noise");
  verb.add_option("--without", options.without, "switch a board, or a node of a DBC file, off")
      .type_name("BOARD")
      .delimiter(',');
  verb.add_option("--speed", options.speed, "how many times faster than real time")
      .range(0.001, 1000.0)
      .type_name("N");
  add_simulated_bit_rate(verb, "--bitrate", options.bit_rate,
                         "of the virtual bus, such as 500k or 125000; default: the spec's");
  add_simulated_bit_rate(verb, "--data-bitrate", options.data_bit_rate,
                         "of the data of CAN FD frames, such as 2M: a multiple of --bitrate; default: the "
                         "spec's, or four times as fast");
  verb.add_option("--bus-errors", options.bus_errors,
                  "on the virtual bus: bits a second that interference breaks, on average")
      .range(0.0, 100'000.0)
      .type_name("N");
  verb.add_option(
          "--boards", boards,
          "host: the boards' code compiled for this machine, where nothing preempts; qemu: their images, "
          "emulated, which preempt as real ones do")
      .one_of({"host", "qemu"})
      .type_name("host|qemu");
  verb.add_option("--images", options.images,
                  "folder of the images for QEMU (that of scripts/build firmware)")
      .type_name("FOLDER");
}

// --- the messages of a spec ---

/// What is meant for the AMiRo's boards.
void refuse_boards_of_messages(Verb verb) {
  for (const char* option : {"--boards", "--images", "--frozen"})
    if (verb.count(option) != 0)
      fail({fmt::format("sim: {} with the messages of a spec", option), "they have no boards: leave one out"},
           exit_usage);
}

/// Their places in the catalogue; leaves where there is no such node.
std::vector<std::uint8_t> nodes_of(const std::vector<std::string>& names,
                                   const protocol::Catalogue& catalogue) {
  std::vector<std::uint8_t> nodes;
  for (const auto& name : names) {
    const auto found = std::find_if(catalogue.boards.begin(), catalogue.boards.end(),
                                    [&name](const protocol::Board& board) { return board.name == name; });
    if (found == catalogue.boards.end()) {
      std::vector<std::string_view> known;
      for (const auto& board : catalogue.boards) known.push_back(board.name);
      fail({fmt::format("sim: no node '{}'", name), words::suggestion(name, known)}, exit_usage);
    }
    nodes.push_back(static_cast<std::uint8_t>(found - catalogue.boards.begin()));
  }
  return nodes;
}

/// As the options say, or the spec.
simulate::BitRates bit_rates(Verb verb, const sim::AmiroOptions& options, Session& session, bool played) {
  const auto typed = [verb](const char* option, std::uint32_t value) {
    return verb.count(option) != 0 ? std::optional{value} : std::nullopt;
  };
  return simulate::bit_rates(typed("--bitrate", options.bit_rate),
                             typed("--data-bitrate", options.data_bit_rate), options.bit_rate, session,
                             played);
}

/// What is meant for the virtual bus.
void refuse_bus_options(Verb verb, const Session& session) {
  for (const char* option : {"--bus-errors", "--bitrate", "--data-bitrate", "--speed"})
    if (verb.is_typed(option))
      fail({fmt::format("sim: {} with --bus {}", option, session.bus_name),
            "leave one out: it is for the virtual bus"},
           exit_usage);
}

sim::MessagesOptions messages_options(Verb verb, const sim::AmiroOptions& options, Session& session) {
  refuse_boards_of_messages(verb);
  const auto rates = bit_rates(verb, options, session, true);
  if (!simulate::on_virtual_bus(session)) refuse_bus_options(verb, session);
  return {.play = {.seed = options.world.seed,
                   .sporadic = options.sporadic,
                   .without = nodes_of(options.without, session.catalogue())},
          .bit_rate = rates.nominal,
          .data_bit_rate = rates.data,
          .bus_errors = options.bus_errors,
          .speed = options.speed};
}

// --- mappers ---

constexpr std::array<const char*, 6> mapper_options{"--lines",         "--radio-loss", "--radio-range",
                                                    "--radio-repeats", "--links",      "--uncalibrated"};

void add_mappers(Verb verb, sim::MapperOptions& options) {
  verb.add_option("--robots", options.robots, "N mappers instead of the AMiRo, and their central")
      .range(1U, 128U)
      .type_name("N");
  verb.add_option("--world", options.world,
                  "where the mappers are: a file, or square (default), labyrinth, range")
      .type_name("WORLD");
  verb.add_flag("--lines", options.lines, "no central: each mapper on a serial line of its own");
  verb.add_option("--radio-loss", options.radio_loss, "share of packets lost wherever a robot is")
      .range(0.0, 1.0)
      .type_name("SHARE");
  verb.add_option("--radio-range", options.radio_range,
                  "how far the central's radio reaches; default: the world's")
      .range(0.01, 10'000.0)
      .type_name("METRES");
  verb.add_flag("--radio-repeats", options.repeats, "the radio repeats what was lost, as Bluetooth does");
  verb.add_flag("--uncalibrated", options.uncalibrated, "mappers whose compass was never calibrated");
  verb.add_option("--links", options.links, "robots that the central can have a link with; default: all")
      .range(1U, 128U)
      .type_name("N");
}

bool wants_mappers(Verb verb) {
  if (verb.count("--robots") != 0 || verb.count("--world") != 0) return true;
  for (const char* option : mapper_options)
    if (verb.is_typed(option))
      fail({fmt::format("sim: {} without --robots", option), "add --robots N, or leave it out"}, exit_usage);
  return false;
}

/// What is meant for the AMiRo's boards and their bus.
void refuse_boards_options(Verb verb, const Session& session) {
  for (const char* option : {"--bus-errors", "--boards", "--images", "--without", "--frozen", "--bitrate",
                             "--data-bitrate", "--sporadic"})
    if (verb.is_typed(option))
      fail({fmt::format("sim: {} with mappers", option), "they have no bus and no boards: leave one out"},
           exit_usage);
  const char* environment = std::getenv("AMIROCTL_BUS");
  if (verb.parent().is_typed("--bus") && session.bus_name != (environment != nullptr ? environment : ""))
    fail({"sim: --bus with mappers", "they have no bus: leave one out"}, exit_usage);
  const char* specs = std::getenv("AMIROCTL_SPEC");
  if (verb.parent().is_typed("--spec") &&
      session.spec_files != std::vector<std::string>{specs != nullptr ? specs : ""})
    fail({"sim: --spec with mappers", "they say sentences, of one spec that is built in: leave it out"},
         exit_usage);
  if (verb.count("--lines") != 0)
    for (const char* option : {"--radio-loss", "--radio-range", "--radio-repeats", "--links"})
      if (verb.is_typed(option))
        fail({fmt::format("sim: {} with --lines", option),
              "without a central there is no radio: leave one out"},
             exit_usage);
}

/// What is meant for the page.
void refuse_page_options(Verb verb, const simulate::ShowOptions& show, bool lines) {
  for (const char* option : {"--port", "--allow-commands", "--open"})
    if (verb.is_typed(option) && show.kind != "page")
      fail({fmt::format("sim: {} is of the page", option), "add --show, or leave it out"}, exit_usage);
  if (show.kind == "page" && lines)
    fail({"sim: --show with --lines",
          "the page shows robots behind a central: leave --lines out, or --show=text"},
         exit_usage);
  if (show.opens && show.commands)
    fail({"sim: --open and --allow-commands: other users of this machine would see the token, among the "
          "words of "
          "the browser's process",
          "drop one of them, and open the address by hand"},
         exit_usage);
}

}  // namespace

void declare_sim(Verb verb, Session& session, int& exit_code) {
  verb.describe("a simulated robot, or a spec's messages, on a virtual bus or a CAN interface", play_group,
                "  amiroctl sim                       a virtual bus for this user, as --bus sim\n"
                "  amiroctl sim --bus vcan0           the three boards on a CAN interface\n"
                "  amiroctl sim --seed 7 --speed 10\n"
                "  amiroctl sim --without light_ring  a board that is switched off\n"
                "  amiroctl sim --bus-errors 20       interference: 20 broken bits a second\n"
                "  amiroctl sim --boards qemu         the boards' firmware, emulated\n"
                "  amiroctl sim --spec car.dbc        a bus with the messages of a DBC file\n"
                "  amiroctl sim --robots 2            mappers in a room, and their central\n"
                "  amiroctl sim --world labyrinth --radio-loss 0.1\n"
                "  amiroctl sim --show                in a browser, too; prints the address\n"
                "  amiroctl sim --show=text           drawn on this terminal while it runs");
  const auto options = std::make_shared<sim::AmiroOptions>();
  verb.add_option("--seed", options->world.seed, "of all noise; equal seeds give equal robots")
      .type_name("N");
  const auto boards = std::make_shared<std::string>("host");
  add_boards(verb, *options, *boards);
  verb.add_value("--sporadic", take_into(options->sporadic, words::read_every),
                 "also send messages without a period, about T apart; default: they are not sent")
      .type_name("T")
      .takes(accepted_duration());
  const auto show = std::make_shared<simulate::ShowOptions>();
  verb.add_option(
          "--show", show->kind,
          "page (default): in a browser, prints the address; text: in characters, on this terminal; q "
          "ends it")
      .expected(0, 1)
      .one_of({"page", "text"})
      .type_name("[page|text]");
  verb.add_option("--port", show->port, "of that page").type_name("N").range(0U, 65535U).show_default();
  verb.add_flag("--allow-commands", show->commands, "who opens the address that is printed may drive");
  verb.add_flag("--open", show->opens, "in your browser, too");
  const auto mappers = std::make_shared<sim::MapperOptions>();
  add_mappers(verb, *mappers);
  verb.callback([options, boards, show, mappers, verb, &session, &exit_code] {
    options->qemu = *boards == "qemu";
    mappers->seed = options->world.seed;
    mappers->speed = options->speed;
    if (verb.count("--show") != 0 && show->kind.empty()) show->kind = "page";
    refuse_page_options(verb, *show, mappers->lines);
    if (wants_mappers(verb)) {
      refuse_boards_options(verb, session);
      exit_code = simulate::run_mappers(*mappers, *show, session);
      return;
    }
    const Cast cast = simulate::cast_of(session);
    if (cast == Cast::amiro && verb.count("--sporadic") != 0)
      fail({"sim: --sporadic without messages", "add --spec FILE with messages, or leave it out"},
           exit_usage);
    if (cast == Cast::both) options->messages = &session.catalogue();
    if (cast == Cast::messages) {
      if (!show->kind.empty())
        fail({"sim: --show with the messages of a spec",
              "they have no room and no robot: leave --show out; amiroctl top shows a bus"},
             exit_usage);
      exit_code = simulate::run_messages(messages_options(verb, *options, session), session);
      return;
    }
    const auto rates = bit_rates(verb, *options, session, cast == Cast::both);
    if (!simulate::on_virtual_bus(session)) refuse_bus_options(verb, session);
    options->bit_rate = rates.nominal;
    options->data_bit_rate = rates.data;
    exit_code = simulate::run_amiro(*options, *show, session);
  });
}

}  // namespace ocm::cli
