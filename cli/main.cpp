/// amiroctl: ask a robot's sensors, command its actuators and watch its bus.
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <new>
#include <string_view>
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
constexpr struct {
  std::string_view name;
  DeclareVerb declare;
  Program::About about = Program::About::itself;
} verbs[] = {
    {"list", declare_list},
    {"info", declare_info},
    {"analyse", declare_analyse},
    {"generate", declare_generate},
    {"publish", declare_publish},
    {"once", declare_once},
    {"stop", declare_stop},
    {"drive", declare_drive},
    {"travel", declare_travel},
    {"behave", declare_behave},
    {"led", declare_led},
    {"set", declare_set},
    {"send", declare_send},
    {"listen", declare_listen},
    {"doctor", declare_doctor},
    {"record", declare_record},
    {"replay", declare_replay},
    {"decode", declare_decode},
    {"encode", declare_encode},
    {"convert", declare_convert},
    {"stats", declare_stats},
    {"top", declare_top},
    {"serve", declare_serve},
    {"plot", declare_plot},
    {"run", declare_run},
    {"operate", declare_operate},
    {"operator", declare_operator},
    {"sim", declare_sim},
    {"central", declare_central},
    {"robots", declare_robots},
    {"goto", declare_goto},
    {"calibrate", declare_calibrate},
    {"pause", declare_pause},
    {"unpause", declare_unpause},
    {"map", declare_map},
    {"line", declare_line},
    {"completion", declare_completion, Program::About::all_verbs},
    {"man", declare_man, Program::About::all_verbs},
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
                  "  amiroctl once power\n"
                  "  amiroctl listen\n"
                  "`amiroctl --help` lists all verbs"};
  Session session;
  session.add_options(program.root());
  int exit_code = exit_success;
  for (const auto& [name, declare, about] : verbs)
    program.add_verb(name, about, [&session, &exit_code, declare = declare](Verb verb) {
      declare(verb, session, exit_code);
    });
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
