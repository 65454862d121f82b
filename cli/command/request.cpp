#include "cli/command/request.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/client/sample.hpp"

#include "cli/command/bus_admission.hpp"
#include "cli/command/commanding.hpp"
#include "cli/output/printer.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/values.hpp"
#include "cli/watch/subscription.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

void send_all(transport::Bus& bus, const std::string& verb, const client::Command& command) {
  Outgoing outgoing{bus, verb};
  for (const auto& frame : command.frames) outgoing.send(frame);
  outgoing.expect_all_left();
}

/// Sends the command and shows the first sample of the topic it asks; fails after `timeout` and says what to
/// check.
void send_and_await(Session& session, transport::Bus& open_bus, const std::string& verb,
                    const client::Command& command, base::Duration timeout) {
  catch_interrupts();
  const auto& catalogue = session.catalogue();
  auto* const bus = &open_bus;
  const auto& topic = *command.answers;
  const auto filters = filters_for({&topic}, false);
  if (const auto subscribed = bus->subscribe(filters); !subscribed) fail(subscribed.error);
  send_all(*bus, verb, command);

  client::Receiver receiver{catalogue};
  Printer printer{make_output(isatty(STDOUT_FILENO) != 0 ? Format::pretty : Format::json, catalogue, {},
                              session.colour())};
  const Over over =
      Live{*bus}.receive_or_leave(Live::Clock::now() + timeout, [&](const can::Received& received) {
        const auto reception = receiver.take(received);
        if (reception.topic != &topic) return true;
        printer.write({bus->name(), log::Entry{received.time, received.frame}, reception});
        return reception.meaning != client::Meaning::sample;
      });
  if (over == Over::enough) return printer.flush();
  const auto& counters = receiver.counters();
  fail({fmt::format("no {} within {}", topic.name, words::to_text(timeout)),
        counters.frames != 0
            ? fmt::format("{} frames came, {} of wrong length: does the robot run another protocol version?",
                          counters.frames, counters.wrong_dlc)
            : fmt::format("is board {} powered and on {}? Is the bit rate {} bit/s? See `amiroctl listen`",
                          catalogue.boards[topic.board].name, bus->name(), catalogue.bit_rate)});
}

}  // namespace

void add_request_options(Verb verb, Session& session, std::string_view words_help, Starts starts) {
  struct Options {
    Options(Verb app, Session& s, std::string_view help) : commanding(app, s, help) {}
    Commanding commanding;
    AdmissionOptions admission;
    base::Duration wait = std::chrono::seconds{2};
  };
  const auto options = std::make_shared<Options>(verb, session, words_help);
  const auto wait =
      add_duration(verb, "--wait", options->wait, "wait for the first sample and show it, at most T");
  wait.expected(0, 1).type_name("[T]");
  if (starts == Starts::stream) add_admission_options(verb, options->admission);
  verb.callback([options, wait, &session] {
    const auto command = options->commanding.parse();
    const bool dry_run = options->commanding.dry_run();
    if (dry_run && !options->admission.explain) return print_frames(command.frames);
    const auto bus = session.open_bus();
    admit(session, *bus, command, options->admission);
    if (dry_run) return print_frames(command.frames);
    if (wait.count() != 0)
      return send_and_await(session, *bus, options->commanding.verb(), command, options->wait);
    send_all(*bus, options->commanding.verb(), command);
  });
}

}  // namespace ocm::cli
