#include "cli/command/commanding.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {

void declare_led(Verb verb, Session& session, int&) {
  declare_command_verb(verb, session, "light an LED, or all of them", act_group,
                       "a colour is 100,50,120 or #643278 or a name",
                       "  amiroctl led 1 red\n"
                       "  amiroctl led 5 100,50,120\n"
                       "  amiroctl led all off");
}

}  // namespace ocm::cli
