#include "cli/command/request.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/client/sample.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/command/bus_admission.hpp"
#include "cli/command/commanding.hpp"
#include "cli/command/refusal_watch.hpp"
#include "cli/output/printer.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/terminal.hpp"
#include "cli/shared/values.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

void send_all(transport::Bus& bus, RefusalWatch& refusals, const std::string& verb,
              const client::Command& command) {
  Outgoing outgoing{bus, verb};
  for (const auto& frame : command.frames) outgoing.send(frame);
  outgoing.expect_all_left();
  refusals.sent(command.frames);
}

/// Sends the command and shows the first sample of the topic it asks; fails if its board refuses, and after
/// `timeout`, and says what to check.
void send_and_await(Session& session, transport::Bus& open_bus, RefusalWatch& refusals,
                    const std::string& verb, const client::Command& command, base::Duration timeout) {
  catch_interrupts();
  const auto& catalogue = session.catalogue();
  auto* const bus = &open_bus;
  const auto& topic = *command.answers;
  refusals.prepare(*bus, command.frames, {&topic});
  send_all(*bus, refusals, verb, command);

  client::Receiver receiver{catalogue};
  Printer printer{make_output(isatty(STDOUT_FILENO) != 0 ? Format::pretty : Format::json, catalogue, {},
                              session.colour(), columns_of_output)};
  const Over over =
      Live{*bus}.receive_or_leave(Live::Clock::now() + timeout, [&](const can::Received& received) {
        if (refusals.take(received)) return false;
        const auto reception = receiver.take(received);
        if (reception.topic != &topic) return true;
        printer.write({bus->name(), log::Entry{received.time, received.frame}, reception});
        return reception.meaning != client::Meaning::sample;
      });
  if (over == Over::enough) {
    printer.flush();
    // The sample may be of a stream that ran before, and goes on although this one is refused.
    if (const auto request = protocol::decode_request(command.frames[0]);
        request && request->mode == protocol::Mode::publish)
      refusals.listen(*bus);
    return refusals.leave_if_refused();
  }
  const auto& counters = receiver.counters();
  fail({fmt::format("no {} within {}", topic.name, words::to_text(timeout)),
        counters.frames != 0
            ? fmt::format("{} came, {} of wrong length: does the robot run another protocol version?",
                          counted(counters.frames, "frame"), counters.wrong_dlc)
            : fmt::format("is board {} powered and on {}? Is the bit rate {} bit/s? See `amiroctl listen`",
                          catalogue.board_name(topic), bus->name(), catalogue.bit_rate)});
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
    if (dry_run && !options->admission.explain) return print_frames(command);
    const auto bus = session.open_bus();
    RefusalWatch refusals{session.catalogue(), options->commanding.verb(), options->commanding.confirm()};
    admit(session.catalogue(), *bus, command, options->admission, refusals);
    if (dry_run) return print_frames(command);
    if (wait.count() != 0)
      return send_and_await(session, *bus, refusals, options->commanding.verb(), command, options->wait);
    refusals.prepare(*bus, command.frames);
    send_all(*bus, refusals, options->commanding.verb(), command);
    refusals.listen(*bus);
    refusals.leave_if_refused();
  });
}

}  // namespace ocm::cli
