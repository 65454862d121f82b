/// The verbs, one file each. main.cpp lists them; this is all it knows of them. It alone includes this, so
/// that a new verb compiles no other one again.
#pragma once

#include "cli/verbs/verb.hpp"

namespace ocm::cli {

void add_list(Verb app, Session& session, int& exit_code);
void add_info(Verb app, Session& session, int& exit_code);
void add_publish(Verb app, Session& session, int& exit_code);
void add_once(Verb app, Session& session, int& exit_code);
void add_stop(Verb app, Session& session, int& exit_code);
void add_drive(Verb app, Session& session, int& exit_code);
void add_travel(Verb app, Session& session, int& exit_code);
void add_behave(Verb app, Session& session, int& exit_code);
void add_led(Verb app, Session& session, int& exit_code);
void add_set(Verb app, Session& session, int& exit_code);
void add_send(Verb app, Session& session, int& exit_code);
void add_listen(Verb app, Session& session, int& exit_code);
void add_record(Verb app, Session& session, int& exit_code);
void add_replay(Verb app, Session& session, int& exit_code);
void add_stats(Verb app, Session& session, int& exit_code);
void add_top(Verb app, Session& session, int& exit_code);
void add_serve(Verb app, Session& session, int& exit_code);
void add_plot(Verb app, Session& session, int& exit_code);
void add_doctor(Verb app, Session& session, int& exit_code);
void add_run(Verb app, Session& session, int& exit_code);
void add_operate(Verb app, Session& session, int& exit_code);
void add_operator(Verb app, Session& session, int& exit_code);
void add_sim(Verb app, Session& session, int& exit_code);
void add_analyse(Verb app, Session& session, int& exit_code);
void add_decode(Verb app, Session& session, int& exit_code);
void add_encode(Verb app, Session& session, int& exit_code);
void add_convert(Verb app, Session& session, int& exit_code);
void add_generate(Verb app, Session& session, int& exit_code);
void add_central(Verb app, Session& session, int& exit_code);
void add_robots(Verb app, Session& session, int& exit_code);
void add_goto(Verb app, Session& session, int& exit_code);
void add_calibrate(Verb app, Session& session, int& exit_code);
void add_pause(Verb app, Session& session, int& exit_code);
void add_unpause(Verb app, Session& session, int& exit_code);
void add_map(Verb app, Session& session, int& exit_code);
void add_line(Verb app, Session& session, int& exit_code);
void add_completion(Verb app, Session& session, int& exit_code);
void add_man(Verb app, Session& session, int& exit_code);

}  // namespace ocm::cli
