/// A page that shows bus and robot in a browser, live or from a log.
#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "cli/fleet/line_log_file.hpp"
#include "cli/logs/format.hpp"
#include "cli/serve/server.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/watching.hpp"
#include "cli/words/suggestion.hpp"

namespace ocm::cli {
namespace {

struct GivenToServe {
  std::vector<std::string> words;
  std::uint32_t port = 8484;
  serve::ServeOptions options;
  serve::FleetOptions fleet;
};

/// What is meant for robots behind a central.
constexpr std::array<const char*, 8> fleet_options{"--start", "--world",  "--central", "--baud",
                                                   "--flow",  "--dongle", "--scan",    "--call-back"};
/// Those of them that a log of a central's line has no use for.
constexpr std::span<const char* const> line_options{fleet_options.begin() + 2, fleet_options.end()};

bool is_loopback(const std::string& address) {
  return address == "::1" || address.starts_with("127.");
}

/// "https://app.example.org", "http://localhost:8080": what a browser sends has no path.
bool is_origin(std::string_view text) {
  const auto colon = text.find("://");
  return colon != std::string_view::npos && colon != 0 &&
         text.find_first_of("/?#*, ", colon + 3) == text.npos;
}

/// The word `robots`, --central, or a log of its line: robots behind a central; without `live` these alone.
void take_robots(Verb verb, GivenToServe& given) {
  const bool named = std::erase(given.words, "robots") != 0;
  const bool central = verb.count("--central") != 0;
  const bool logged = std::any_of(given.words.begin(), given.words.end(), fleet::is_line_log);
  if (!named && !central && !logged) {
    for (const char* option : fleet_options)
      if (verb.is_typed(option))
        fail({fmt::format("serve: {} without robots", option),
              "add the word robots, or --central PATH: amiroctl serve robots"},
             exit_usage);
    return;
  }
  given.options.bus = !given.words.empty();
  given.options.fleet = given.fleet;
}

void serve_given(Verb verb, Session& session, GivenToServe& given, int& exit_code) {
  serve::ServeOptions& options = given.options;
  serve::WebOptions& web = options.web;
  take_robots(verb, given);
  if (given.words.size() > 1)
    fail({fmt::format("serve: unexpected argument '{}'", given.words[1]), "one log at a time"}, exit_usage);
  const Words words = split_words("serve", given.words, [](std::string_view) { return false; });
  if (!words.others.empty()) {
    const auto near = words::nearest(words.others[0], std::vector<std::string_view>{"robots", "live"});
    fail({fmt::format("serve: {} is no log", words.others[0]),
          near.empty() ? "name a log, or nothing for the bus" : fmt::format("did you mean '{}'?", near)},
         exit_usage);
  }
  if (!words.files.empty()) options.log = words.files[0];
  if (options.log.empty() && !options.format.empty())
    fail({"--from " + options.format + " is the format of a log, and there is none",
          "name the log, or drop --from"},
         exit_usage);
  if (!options.log.empty() && options.fleet)
    for (const char* option : line_options)
      if (verb.is_typed(option))
        fail({fmt::format("serve: {} and a log", option), "a log has no line: drop one of them"}, exit_usage);
  if (options.opens && options.commands)
    fail({"serve: --open and --allow-commands: other users of this machine would see the token, among the "
          "words "
          "of the browser's process",
          "drop one of them, and open the address by hand"},
         exit_usage);
  if (!options.log.empty() && options.commands)
    fail({"serve: --allow-commands and a log: there is nothing to command", "drop one of them"}, exit_usage);
  if (web.certificate.empty() != web.key.empty())
    fail({fmt::format("serve: {} without {}", web.key.empty() ? "--certificate" : "--key",
                      web.key.empty() ? "--key" : "--certificate"),
          "give both, as PEM files"},
         exit_usage);
  for (const std::string& origin : web.origins)
    if (!is_origin(origin))
      fail({fmt::format("serve: --allow-origin {} is no origin of a page{}", origin,
                        origin == "null" ? ": that of every file and every sandboxed frame" : ""),
            "write what browsers send: scheme, host and port, nothing behind them, as in "
            "https://app.example.org"},
           exit_usage);
  if (!is_loopback(web.address)) {
    if (web.certificate.empty())
      fail(
          {fmt::format("serve: --address {} is open to other machines, and without TLS all that they see and "
                       "send is open, too",
                       web.address),
           "give --certificate and --key, or leave --address out: ssh -L 8484:localhost:8484 ROBOT brings "
           "the page "
           "to your machine"},
          exit_usage);
    web.token_to_view = true;
  }
  web.port = static_cast<std::uint16_t>(given.port);
  static_cast<void>(session.catalogue());  // what is wrong with the spec is said before a bus is missing
  exit_code = serve::run(session, std::move(options));
}

}  // namespace

void declare_serve(Verb verb, Session& session, int& exit_code) {
  verb.describe("bus and robot in a browser, live or from a log", watch_group,
                "  amiroctl serve                     prints the address to open\n"
                "  amiroctl serve --allow-commands    with buttons and keys to drive\n"
                "  amiroctl serve drive.log           played, with a bar to wind it\n"
                "  amiroctl serve robots              mappers behind a central, and their map\n"
                "  amiroctl serve robots room.line    a drive of mappers that --record has written\n"
                "  amiroctl serve live robots         both\n"
                "  amiroctl serve --spec car.dbc");
  const auto given = std::make_shared<GivenToServe>();
  serve::ServeOptions& options = given->options;
  verb.add_option("words", given->words,
                  "a log, any format; none, or live: the bus. robots: those behind a central")
      .type_name("[FILE|live] [robots]");
  verb.add_option("--from", options.format, "format of the log; default: what it begins with says it")
      .type_name("FORMAT")
      .takes(accepted_words(logs::readable_formats()));
  verb.add_option("--port", given->port, "of TCP; 0: any that is free")
      .type_name("N")
      .range(0U, 65535U)
      .show_default();
  verb.add_flag("--allow-commands", options.commands,
                "who opens the address that is printed may drive, and command all else");
  verb.add_option("--address", options.web.address, "an address of this machine; all but 127.0.0.1 need TLS")
      .type_name("ADDRESS")
      .show_default();
  verb.add_option("--name", options.web.names, "a name by which browsers reach this machine")
      .type_name("HOST")
      .one_a_mention();
  verb.add_option("--allow-origin", options.web.origins, "another page that may connect, such as Foxglove's")
      .type_name("URL")
      .one_a_mention();
  verb.add_option("--certificate", options.web.certificate, "TLS: the certificate, PEM").type_name("FILE");
  verb.add_option("--key", options.web.key, "TLS: its private key, PEM").type_name("FILE");
  add_bit_rate(verb, "--bitrate", options.bit_rate,
               "for the load, such as 500k; default: what the bus says, else the spec");
  add_data_bit_rate(verb, "--data-bitrate", options.data_bit_rate,
                    "of CAN FD behind its bit-rate switch, such as 2M; default: the spec's");
  verb.add_flag("--open", options.opens, "in your browser, too");
  serve::FleetOptions& fleet = given->fleet;
  fleet::add_line_options(verb, fleet.line);
  verb.add_option("--start", fleet.starts, "where a robot was switched on: metres, degrees")
      .type_name("NAME=X,Y,DEG")
      .one_a_mention();
  verb.add_option("--world", fleet.world,
                  "a simulated world, or its name: where its robots and its central are")
      .type_name("WORLD");
  verb.add_flag("--call-back", fleet.call_back, "a robot that drives with a bad link is called back");
  verb.callback([given, verb, &session, &exit_code] { serve_given(verb, session, *given, exit_code); });
}

}  // namespace ocm::cli
