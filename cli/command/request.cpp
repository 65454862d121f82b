#include "cli/command/request.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "ocm/client/sample.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/command/bus_admission.hpp"
#include "cli/command/commanding.hpp"
#include "cli/command/refusal_watch.hpp"
#include "cli/output/format_options.hpp"
#include "cli/output/printer.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/unhurried_messages.hpp"
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

/// Sends the command and waits for the first sample of the topic that it asks, which `shown` takes, if there
/// is one: a board sends it at once. Fails if the board refuses, and after `timeout`, and says what to check.
void send_and_await(const protocol::Catalogue& catalogue, transport::Bus& bus, RefusalWatch& refusals,
                    const std::string& verb, const client::Command& command, base::Duration timeout,
                    Printer* shown) {
  catch_interrupts();
  const auto& topic = *command.answers;
  refusals.prepare(bus, command.frames, {&topic});
  send_all(bus, refusals, verb, command);

  client::Receiver receiver{catalogue};
  std::uint64_t parts = 0, wrong = 0;  // of the topic
  bool has_values = shown == nullptr;
  const Over over =
      Live{bus}.receive_or_leave(time_after(Live::Clock::now(), timeout), [&](const can::Received& received) {
        if (refusals.take(received)) return false;
        const auto reception = receiver.take(received);
        if (reception.topic != &topic) return true;
        ++(reception.meaning == client::Meaning::wrong_dlc ? wrong : parts);
        if (shown != nullptr)
          has_values |= shown->write({bus.name(), log::Entry{received.time, received.frame}, reception});
        return reception.meaning != client::Meaning::sample;
      });
  if (over == Over::enough) {
    if (shown != nullptr) shown->flush();
    // The sample may be of a stream that ran before, and goes on although this one is refused.
    if (const auto request = protocol::decode_request(command.frames[0]);
        request && request->mode == protocol::Mode::publish)
      refusals.listen(bus);
    refusals.leave_if_refused();
    if (!has_values)
      fail({fmt::format("{}: {} came, and no field that was chosen has a value", verb, topic.name),
            fmt::format("what is derived has none beyond its range: see `amiroctl info {}`", topic.name)});
    return;
  }
  const std::string what = fmt::format("{}: no {} within {}", verb, topic.name, words::to_text(timeout));
  if (wrong != 0)
    fail({what, fmt::format("{} of it came in another length: does the robot run another protocol version?",
                            counted(wrong, "frame"))});
  if (parts != 0)
    fail({what, fmt::format("{} of it came, and never all of a sample: does the bus lose frames? See "
                            "`amiroctl doctor`",
                            counted(parts, "frame"))});
  fail({what, fmt::format("is board {} powered and on {}? Is the bit rate {} bit/s? See `amiroctl doctor`",
                          catalogue.board_name(topic), bus.name(), catalogue.bit_rate)});
}

/// Leaves through cli::fail where a field of another topic is chosen. All fields exist.
void expect_fields_of(const protocol::Topic& topic, const std::string& verb,
                      const protocol::Catalogue& catalogue, const FormatOptions& format) {
  const auto selection = Selection::of(catalogue, format.fields);
  for (const ChosenField& chosen : selection->fields())
    if (chosen.topic != &topic)
      fail({fmt::format("{}: --field {}, and what is asked is {}", verb, chosen.name, topic.name),
            fmt::format("`amiroctl info {}` shows its fields", topic.name)},
           exit_usage);
}

}  // namespace

void add_request_options(Verb verb, Session& session, std::string_view words_help, Starts starts) {
  struct Options {
    Options(Verb app, Session& s, std::string_view help)
        : commanding(app, s, help, Commanding::Sends::requests) {}
    Commanding commanding;
    AdmissionOptions admission;
    FormatOptions format;  ///< of `once`
    base::Duration wait = std::chrono::seconds{2};
  };
  const auto options = std::make_shared<Options>(verb, session, words_help);
  const auto wait =
      verb.add_value("--wait", take_into(options->wait, words::read_lasting),
                     starts == Starts::stream ? "show the first sample; T: how long to wait for it"
                                              : "how long to wait for the sample, with --no-confirm, too");
  wait.expected(0, 1).type_name("[T]").takes(accepted_lasting()).default_text(words::to_text(options->wait));
  if (starts == Starts::stream)
    add_admission_options(verb, options->admission);
  else
    add_format_options(verb, options->format);
  verb.callback([options, wait, starts, &session] {
    protocol::Catalogue catalogue = options->commanding.catalogue();
    const auto command = options->commanding.parse();
    const auto& verb_name = options->commanding.verb();
    std::optional<Printer> printer;
    if (starts == Starts::sample || wait.count() != 0)
      printer.emplace(chosen_output(verb_name, catalogue, session.colour(), options->format));
    expect_fields_of(*command.answers, verb_name, catalogue, options->format);
    const bool dry_run = options->commanding.dry_run();
    if (dry_run && !options->admission.explain) return print_frames(command);
    never_wait_for_messages();
    const auto bus = session.open_bus();
    if (const std::uint32_t rate = bus->bit_rate(); rate != 0) catalogue.bit_rate = rate;
    RefusalWatch refusals{catalogue, verb_name, options->commanding.confirm()};
    admit(catalogue, *bus, command, options->admission, refusals);
    if (dry_run) return print_frames(command);
    if (options->commanding.confirm() == Confirm::no && wait.count() == 0)
      return send_all(*bus, refusals, verb_name, command);
    send_and_await(catalogue, *bus, refusals, verb_name, command, options->wait,
                   printer ? &*printer : nullptr);
  });
}

}  // namespace ocm::cli
