/// amiroctl: ask a robot's sensors, command its actuators and watch its bus.
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <new>
#include <system_error>
#include <unistd.h>

#include "cli/shared/arguments.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/memory.hpp"
#include "cli/shared/session.hpp"
#include "cli/verbs/verbs.hpp"

namespace {

using namespace ocm::cli;

// In the order of --help.
// clang-format off
constexpr AddVerb verbs[] = {
    add_list,
    add_info,
    add_analyse,
    add_generate,
    add_publish,
    add_once,
    add_stop,
    add_drive,
    add_travel,
    add_behave,
    add_led,
    add_set,
    add_send,
    add_listen,
    add_doctor,
    add_record,
    add_replay,
    add_decode,
    add_encode,
    add_convert,
    add_stats,
    add_top,
    add_serve,
    add_plot,
    add_run,
    add_operate,
    add_operator,
    add_sim,
    add_central,
    add_robots,
    add_goto,
    add_calibrate,
    add_pause,
    add_unpause,
    add_map,
    add_line,
    add_completion,
    add_man,
};
// clang-format on

/// A standard stream that was closed (`amiroctl ... >&-`) is not given to a bus or a log: what is written to
/// it fails.
void occupy_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) == -1 && errno == EBADF)
      static_cast<void>(
          ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));  // the lowest that is free
}

int say_not_written(int error) {
  // Of a verb that catches the signal, the end is that of others: they are killed by it.
  if (error == EPIPE && interrupted() == SIGPIPE) return exit_code_after_interrupt(exit_failure);
  std::fprintf(stderr, "amiroctl: cannot write to the standard output: %s\n",
               error != 0 ? std::strerror(error) : "an earlier write failed");
  return exit_failure;
}

/// What was printed must have arrived: a full disk shows when the last of it is written.
int finish(int code) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return say_not_written(errno);
}

int run(int argc, char** argv) {
  Program program{"amiroctl", "Ask a robot's sensors, command its actuators, watch its CAN bus.",
                  "amiroctl " OCM_VERSION,
                  "Exit codes: 0 done, 1 error, 2 wrong usage, 128 + signal when interrupted.\n"
                  "`amiroctl VERB --help` shows a verb's options and examples.",
                  "begin with a simulated robot, and try the others in another terminal:\n"
                  "  amiroctl sim\n"
                  "  amiroctl once power --wait\n"
                  "  amiroctl listen\n"
                  "`amiroctl --help` lists all verbs"};
  Session session;
  session.add_options(program.root());
  int exit_code = exit_success;
  for (const AddVerb add : verbs) add(program.root(), session, exit_code);
  switch (program.run(argc, argv)) {
    case Program::Outcome::done:
      return finish(exit_code);
    case Program::Outcome::told:
      return finish(exit_success);
    case Program::Outcome::refused:
      break;
  }
  return finish(exit_usage);
}

}  // namespace

int main(int argc, char** argv) {
  occupy_standard_streams();
  keep_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is reported like a full disk
  try {
    return run(argc, argv);
  } catch (const Exit& exit) {
    return exit.code;
  } catch (const std::bad_alloc&) {
    say_out_of_memory();
    return exit_failure;
  } catch (const std::system_error& error) {  // as {fmt} reports what it could not print
    if (std::ferror(stdout) != 0) return say_not_written(error.code().value());
    std::fprintf(stderr, "amiroctl: %s\n", error.what());
    return exit_failure;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "amiroctl: %s\n", error.what());
    return exit_failure;
  }
}
