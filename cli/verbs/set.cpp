#include <memory>

#include "cli/command/commanding.hpp"
#include "cli/command/operated_bus.hpp"
#include "cli/command/timeline.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {

void declare_set(Verb verb, Session& session, int& exit_code) {
  verb.describe("set an actuator, or send a message, field by field", act_group,
                "  amiroctl set motors x=0.05m/s z=-30deg/s\n"
                "  amiroctl set led_3 red=255 blue=40\n"
                "  amiroctl --spec car.dbc set Engine rpm=2500 gear=third --every 10ms --for 5s");
  const auto commanding = std::make_shared<Commanding>(verb, session,
                                                       "an actuator's field is zero where it is not given, a "
                                                       "message's at its start value; units as in the spec");
  auto& options = commanding->options();
  const auto every = verb.add_value("--every", take_into(options.every, words::read_every),
                                    "send it again and again until Ctrl-C or --for")
                         .type_name("T")
                         .takes(accepted_every());
  add_lasting(verb, "--for", options.lasting, "how long to send it").needs(every);
  verb.add_flag("--force", options.force, "also values beyond the range that the spec states");
  verb.callback([commanding, &session, &exit_code] {
    const auto command = commanding->parse();
    if (commanding->dry_run() || !(command.repeat || command.broadcast))
      return carry_out(session, *commanding, command);
    catch_interrupts();
    catch_hangups();
    catch_broken_pipe();
    const auto bus = open_to_command(session, "set");
    Timeline timeline{*bus, commanding->catalogue(), "set", Timeline::Others::allowed, commanding->confirm(),
                      {}};
    timeline.carry_out(command);
    static_cast<void>(timeline.wait_for_end());
    if (!timeline.finish()) exit_code = exit_failure;
    exit_code = exit_code_after_interrupt(exit_code);  // also of a signal behind the end
  });
}

}  // namespace ocm::cli
