#include "cli/verbs/commanding.hpp"
#include "cli/verbs/verbs.hpp"

namespace ocm::cli {

void add_send(CLI::App& app, Session& session, int&) {
  add_command_verb(app, session, "send", "send a frame as it is", act_group, "frame in candump notation",
                   "  amiroctl send 205#01840302        magnetometer every 900us, as in the thesis\n"
                   "  amiroctl send 1F334455#DEADBEEF   extended identifier\n"
                   "  amiroctl send 123#R               remote frame",
                   false);
}

}  // namespace ocm::cli
