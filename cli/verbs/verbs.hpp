/// The verbs, one file each. main.cpp lists them; this is all it knows of them. It alone includes this, so
/// that a new verb compiles no other one again.
#pragma once

#include "cli/verbs/verb.hpp"

namespace ocm::cli {

void declare_list(Verb verb, Session& session, int& exit_code);
void declare_info(Verb verb, Session& session, int& exit_code);
void declare_publish(Verb verb, Session& session, int& exit_code);
void declare_once(Verb verb, Session& session, int& exit_code);
void declare_stop(Verb verb, Session& session, int& exit_code);
void declare_drive(Verb verb, Session& session, int& exit_code);
void declare_travel(Verb verb, Session& session, int& exit_code);
void declare_behave(Verb verb, Session& session, int& exit_code);
void declare_led(Verb verb, Session& session, int& exit_code);
void declare_set(Verb verb, Session& session, int& exit_code);
void declare_send(Verb verb, Session& session, int& exit_code);
void declare_listen(Verb verb, Session& session, int& exit_code);
void declare_record(Verb verb, Session& session, int& exit_code);
void declare_replay(Verb verb, Session& session, int& exit_code);
void declare_stats(Verb verb, Session& session, int& exit_code);
void declare_top(Verb verb, Session& session, int& exit_code);
void declare_serve(Verb verb, Session& session, int& exit_code);
void declare_plot(Verb verb, Session& session, int& exit_code);
void declare_doctor(Verb verb, Session& session, int& exit_code);
void declare_run(Verb verb, Session& session, int& exit_code);
void declare_operate(Verb verb, Session& session, int& exit_code);
void declare_operator(Verb verb, Session& session, int& exit_code);
void declare_sim(Verb verb, Session& session, int& exit_code);
void declare_analyse(Verb verb, Session& session, int& exit_code);
void declare_decode(Verb verb, Session& session, int& exit_code);
void declare_encode(Verb verb, Session& session, int& exit_code);
void declare_convert(Verb verb, Session& session, int& exit_code);
void declare_generate(Verb verb, Session& session, int& exit_code);
void declare_central(Verb verb, Session& session, int& exit_code);
void declare_robots(Verb verb, Session& session, int& exit_code);
void declare_goto(Verb verb, Session& session, int& exit_code);
void declare_calibrate(Verb verb, Session& session, int& exit_code);
void declare_pause(Verb verb, Session& session, int& exit_code);
void declare_unpause(Verb verb, Session& session, int& exit_code);
void declare_map(Verb verb, Session& session, int& exit_code);
void declare_line(Verb verb, Session& session, int& exit_code);
void declare_completion(Verb verb, Session& session, int& exit_code);
void declare_man(Verb verb, Session& session, int& exit_code);

}  // namespace ocm::cli
