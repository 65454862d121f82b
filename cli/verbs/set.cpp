#include "cli/command/commanding.hpp"
#include "cli/verbs/verbs.hpp"

namespace ocm::cli {

void add_set(Verb app, Session& session, int&) {
  add_command_verb(app, session, "set", "set any actuator, field by field, once", act_group,
                   "ACTUATOR FIELD=VALUE ...; a value has its field's unit, what is not given is zero",
                   "  amiroctl set motors x=0.05m/s z=-30deg/s\n"
                   "  amiroctl set led_3 red=255 blue=40");
}

}  // namespace ocm::cli
