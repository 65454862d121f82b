#include "cli/command/commanding.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {

void add_stop(Verb app, Session& session, int&) {
  add_command_verb(app, session, "stop", "stop a topic, or the whole robot: motors first, then every sensor",
                   ask_group, "topic; nothing or all: everything",
                   "  amiroctl stop                     motors to zero, then every sensor\n"
                   "  amiroctl stop gyro                the gyroscope only\n"
                   "  amiroctl stop motors --priority urgent");
}

}  // namespace ocm::cli
