/// amiroctl: ask a robot's sensors, command its actuators and watch its bus.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/session.hpp"
#include "cli/verbs/verbs.hpp"

namespace {

using namespace ocm::cli;

constexpr AddVerb verbs[] = {
    add_list,   add_info,    add_analyse, add_generate, add_publish, add_once,       add_stop,    add_drive,
    add_led,    add_set,     add_send,    add_listen,   add_doctor,  add_record,     add_replay,  add_decode,
    add_encode, add_convert, add_stats,   add_plot,     add_run,     add_sim,        add_central, add_robots,
    add_goto,   add_pause,   add_unpause, add_map,      add_line,    add_completion, add_man};

/// "-.1m/s" is a number and not an option: "-0.1m/s" is what the parser of options takes for one.
std::vector<std::string> arguments(int argc, char** argv) {
  std::vector<std::string> result;
  for (int i = argc - 1; i > 0; --i) {  // CLI11 takes them from the back
    std::string argument = argv[i];
    if (argument.size() > 2 && argument.starts_with("-.") && argument[2] >= '0' && argument[2] <= '9')
      argument.insert(1, "0");
    result.push_back(std::move(argument));
  }
  return result;
}

/// What was printed must have arrived: a full disk shows when the last of it is written.
int finish(int code) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  std::fprintf(stderr, "amiroctl: cannot write to the standard output: %s\n",
               errno != 0 ? std::strerror(errno) : "an earlier write failed");
  return exit_failure;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Ask a robot's sensors, command its actuators, watch its CAN bus.", "amiroctl"};
  app.set_version_flag("--version", "amiroctl " OCM_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 error, 2 wrong usage, 128 + signal when interrupted.\n"
      "`amiroctl VERB --help` shows a verb's options and examples.");
  Session session;
  session.add_options(app);
  int exit_code = exit_success;
  for (const AddVerb add : verbs) add(app, session, exit_code);
  try {
    app.parse(arguments(argc, argv));
    return finish(exit_code);
  } catch (const CLI::ParseError& error) {
    return finish(app.exit(error) == 0 ? exit_success : exit_usage);
  } catch (const Exit& exit) {
    return exit.code;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "amiroctl: %s\n", error.what());
    return exit_failure;
  }
}
