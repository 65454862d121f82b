#include "cli/command/commanding.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {

void declare_stop(Verb verb, Session& session, int&) {
  declare_command_verb(verb, session, "stop a topic, or the whole robot: motors first, then every sensor",
                       ask_group, "topic; nothing or all: everything",
                       "  amiroctl stop                     motors to zero, then every sensor\n"
                       "  amiroctl stop gyro                the gyroscope only\n"
                       "  amiroctl stop motors --priority urgent");
}

}  // namespace ocm::cli
