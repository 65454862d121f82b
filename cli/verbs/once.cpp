#include "cli/verbs/request.hpp"
#include "cli/verbs/verbs.hpp"

namespace ocm::cli {

void add_once(CLI::App& app, Session& session, int&) {
  auto* verb =
      add_verb(app, "once", "ask a sensor for one sample; a running publisher of it stops", ask_group,
               "  amiroctl once power --wait\n"
               "  amiroctl once floor --dry-run            prints 204#02");
  add_request_options(*verb, session, "TOPIC");
}

}  // namespace ocm::cli
