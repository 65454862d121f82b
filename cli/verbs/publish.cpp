#include "cli/command/request.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {

void declare_publish(Verb verb, Session& session, int&) {
  verb.describe(
      "ask a sensor for samples at a period", ask_group,
      "  amiroctl publish gyro 500ms\n"
      "  amiroctl publish ring 1s --priority low\n"
      "  amiroctl publish mag 900us --dry-run     prints 205#01840302\n"
      "  amiroctl publish odom --wait             the board's own period; shows the first sample\n"
      "  amiroctl publish ring 4ms --explain      what is on the bus, and how late each frame can be");
  add_request_options(verb, session,
                      "TOPIC: a sensor; PERIOD: 1us to 65535s, default: the topic's own period",
                      Starts::stream);
}

}  // namespace ocm::cli
