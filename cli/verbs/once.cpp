#include "cli/command/request.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {

void declare_once(Verb verb, Session& session, int&) {
  verb.describe("ask a sensor for one sample; a running publisher of it stops", ask_group,
                "  amiroctl once power\n"
                "  amiroctl once floor --wait 10s           a slow one\n"
                "  amiroctl once power --json | jq .fields\n"
                "  amiroctl once floor --dry-run            prints 204#02");
  add_request_options(verb, session, "name, alias or id");
}

}  // namespace ocm::cli
