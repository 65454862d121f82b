// ocm-generate SPEC -o HEADER: a robot's C++ header from its spec; --to TARGET: another file from it.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include "generator/spec/file.hpp"
#include "generator/spec/sentences.hpp"
#include "generator/spec/spec.hpp"
#include "generator/targets/sentences.hpp"
#include "generator/targets/target.hpp"
#include "generator/targets/tasks.hpp"
#include "generator/text/man.hpp"
#include "generator/text/output_file.hpp"

namespace {

using namespace ocm;

constexpr int success = 0;
constexpr int failure = 1;
constexpr int usage_error = 2;

constexpr const char* synopsis =
    "ocm-generate SPEC -o HEADER\n"
    "ocm-generate SPEC --to TARGET [--priority P] -o FILE\n"
    "ocm-generate SPEC --check\n"
    "ocm-generate --tasks SETS -o HEADER\n"
    "ocm-generate --sentences SENTENCES -o HEADER\n";

constexpr const char* description =
    "Writes the C++ header of a robot from its spec: a struct with encode and decode for each frame,\n"
    "and the catalogue of all topics; or another file of the same facts. The same spec gives the same\n"
    "bytes.\n";

constexpr const char* options_help =
    "  -o, --output FILE  the file; - is the standard output. It is replaced in one step, and only when\n"
    "                     the spec is good.\n"
    "      --to TARGET    what to write, see below; without it cpp\n"
    "      --priority P   dbc: frames at this priority only (urgent, high, medium or low), and their\n"
    "                     names without it\n"
    "      --check        only say what is wrong with the spec, and all that is doubtful in it\n"
    "      --tasks        the file has task sets of processors (spec/tasks.json), not a robot's topics\n"
    "      --sentences    the file has the sentences of a robot's text link (spec/sentences.json)\n"
    "      --schema       print the JSON schema of specs, for an editor, and end\n"
    "      --man          print this page in the form of man(1), and end\n"
    "      --help, --version\n";

constexpr const char* exit_status =
    "0 done, 1 the spec is wrong or the file cannot be written, 2 wrong usage.\n";

constexpr const char* examples =
    "ocm-generate spec/topics.json -o include/ocm/topics/amiro.hpp\n"
    "ocm-generate spec/topics.json --to dbc -o amiro.dbc\n";

std::string targets_help() {
  std::string text;
  for (const generate::Target& target : generate::targets()) {
    text += "  " + std::string{target.name} + std::string(13 - target.name.size(), ' ');
    text += std::string{target.description} + "\n";
  }
  return text;
}

std::string help() {
  return "Usage:\n" + std::string{synopsis} + "\n" + description + "\n" + options_help + "\nTargets:\n" +
         targets_help() + "\nExit status: " + exit_status + "\nExamples:\n" + examples;
}

std::string man_page() {
  return generate::ManPage{"ocm-generate", "make a robot's header, and other files, from its spec",
                           OCM_VERSION}
      .literal("SYNOPSIS", synopsis)
      .text("DESCRIPTION", description)
      .literal("OPTIONS", options_help)
      .literal("TARGETS", targets_help())
      .text("EXIT STATUS", exit_status)
      .literal("EXAMPLES", examples)
      .text("SEE ALSO", "amiroctl(1)")
      .make();
}

int complain_usage(const std::string& what) {
  std::fprintf(stderr, "ocm-generate: %s\nocm-generate SPEC -o HEADER; --help says more\n", what.c_str());
  return usage_error;
}

/// A spec may hold anything; a terminal must not obey it.
std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) {
      out += c;
    } else {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\x%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
      out += escaped;
    }
  }
  return out;
}

int complain(const spec::Problem& problem) {
  std::fprintf(stderr, "%s: %s; %s\n", printable(problem.place).c_str(), printable(problem.what).c_str(),
               printable(problem.remedy).c_str());
  return failure;
}

int complain(const std::vector<spec::Problem>& problems) {
  for (const auto& problem : problems) complain(problem);
  return failure;
}

/// What is doubtful, and read as other programs read it. All of it, or the first places: a DBC file may have
/// hundreds.
void tell(const std::vector<spec::Problem>& doubts, const std::string& file, bool all) {
  constexpr std::size_t most = 3;
  const std::size_t told = all ? doubts.size() : std::min(doubts.size(), most);
  for (std::size_t i = 0; i < told; ++i) complain(doubts[i]);
  if (told < doubts.size())
    std::fprintf(stderr, "%s: %zu more doubtful %s; --check shows all\n", file.c_str(), doubts.size() - told,
                 doubts.size() - told == 1 ? "place" : "places");
}

int print(const std::string& text) {
  const auto problem = generate::write_file("-", text);
  return problem ? complain(*problem) : success;
}

struct Arguments {
  std::string file;  ///< the spec, or the task sets
  std::optional<std::string> output;
  const generate::Target* target = nullptr;
  std::optional<protocol::Priority> priority;
  bool check = false;
  bool tasks = false;
  bool sentences = false;
};

/// What is wrong with them; empty: nothing.
std::string wrong_usage(const Arguments& arguments) {
  if (arguments.file.empty()) return "no spec";
  if (!arguments.output && !arguments.check) return "no header: -o HEADER, or --check";
  if (arguments.output && arguments.check) return "--check writes no header";
  if (arguments.output && arguments.output->empty()) return "the header has no name";
  if (arguments.tasks && arguments.sentences) return "--tasks or --sentences, not both";
  if (arguments.tasks && arguments.target != nullptr)
    return "--tasks makes a C++ header, and no other target";
  if (arguments.sentences && arguments.target != nullptr)
    return "--sentences makes a C++ header, and no other target";
  if (arguments.priority && (arguments.target == nullptr || arguments.target->name != "dbc"))
    return "--priority is for --to dbc";
  return {};
}

bool written = false;  ///< the file is in its place, and all that is left is to end

int run(const Arguments& arguments) {
  const auto put = [&](const std::string& text) {
    if (arguments.check) return success;
    const auto problem = generate::write_file(*arguments.output, text);
    if (problem) return complain(*problem);
    written = true;
    return success;
  };
  const std::string name = std::filesystem::path{arguments.file}.filename().string();
  if (arguments.tasks) {
    std::vector<spec::Problem> problems;
    const auto json = spec::read_document(arguments.file, "a file of task sets", "spec/tasks.json", problems);
    if (!json) return complain(problems);
    const std::string text = generate::tasks_header(*json, name, problems);
    return problems.empty() ? put(text) : complain(problems);
  }
  if (arguments.sentences) {
    std::vector<spec::Problem> problems;
    const auto json =
        spec::read_document(arguments.file, "a file of sentences", "spec/sentences.json", problems);
    if (!json) return complain(problems);
    const auto loaded = spec::parse_sentences(*json, arguments.file);
    return loaded.model ? put(generate::sentences_header(*loaded.model, name)) : complain(loaded.problems);
  }
  const auto loaded = spec::load(arguments.file);
  if (!loaded.spec) return complain(loaded.problems);
  tell(loaded.doubts, arguments.file, arguments.check);
  const auto& target = arguments.target != nullptr ? *arguments.target : generate::targets().front();
  const spec::Model& model = loaded.spec->model();
  if (!arguments.check && model.topics.empty() && model.messages.empty())
    return complain({arguments.file, "it has neither topics nor messages", "a file that has some"});
  if (!arguments.check && !generate::has_any(target, model))
    return complain({arguments.file,
                     "it has only " + std::string{target.of_topics ? "messages" : "topics"} +
                         ", which --to " + std::string{target.name} + " has no place for",
                     target.of_topics ? "messages become " + generate::message_target_names()
                                      : "topics are in the spec already"});
  if (!arguments.check)
    for (const std::string& what : generate::left_out(target, model))
      std::fprintf(stderr, "%s: --to %s leaves out: %s\n", arguments.file.c_str(),
                   std::string{target.name}.c_str(), printable(what).c_str());
  return put(target.make(model, {name, arguments.priority}));
}

int run(int argc, char** argv) {
  Arguments arguments;
  bool only_names = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const bool option = !only_names && argument.size() > 1 && argument.front() == '-';
    const auto value = [&] { return i + 1 < argc ? argv[++i] : nullptr; };
    if (!option) {
      if (argument.empty()) return complain_usage("the spec has no name");
      if (!arguments.file.empty())
        return complain_usage("two specs: " + arguments.file + " and " + std::string{argument});
      arguments.file = argument;
    } else if (argument == "--") {
      only_names = true;
    } else if (argument == "-h" || argument == "--help") {
      return print(help());
    } else if (argument == "--version") {
      return print("ocm-generate " OCM_VERSION "\n");
    } else if (argument == "--schema") {
      if (argc != 2) return complain_usage("--schema prints it, and takes nothing else: --schema > FILE");
      return print(std::string{spec::schema_text()});
    } else if (argument == "--man") {
      return print(man_page());
    } else if (argument == "--check") {
      arguments.check = true;
    } else if (argument == "--tasks") {
      arguments.tasks = true;
    } else if (argument == "--sentences") {
      arguments.sentences = true;
    } else if (argument == "-o" || argument == "--output") {
      const char* output = value();
      if (output == nullptr) return complain_usage(std::string{argument} + " without a header");
      if (arguments.output) return complain_usage("two headers: " + *arguments.output + " and " + output);
      arguments.output = output;
    } else if (argument == "--to") {
      const char* target = value();
      if (target == nullptr)
        return complain_usage("--to without a target: one of " + generate::target_names());
      arguments.target = generate::find_target(target);
      if (arguments.target == nullptr)
        return complain_usage("unknown target " + printable(target) + ": one of " + generate::target_names());
    } else if (argument == "--priority") {
      const char* priority = value();
      const auto parsed = protocol::parse_priority(priority == nullptr ? "" : priority);
      if (!parsed) return complain_usage("--priority is urgent, high, medium or low");
      arguments.priority = *parsed;
    } else {
      return complain_usage("unknown option " + printable(argument));
    }
  }
  if (const std::string wrong = wrong_usage(arguments); !wrong.empty()) return complain_usage(wrong);
  return run(arguments);
}

/// In the words of amiroctl. It ends here, and not where an exception is caught: nlohmann::json takes memory
/// while it is destroyed, and destroys what it has only half made, so that it survives no std::bad_alloc. No
/// file is half written: between its beginning and its end nothing is allocated.
[[noreturn]] void end_without_memory() {
  if (written) ::_exit(success);
  std::fputs(
      "ocm-generate: out of memory; what it was doing is not complete\n"
      "              end other programs, or raise the limit (ulimit -v), and try again\n",
      stderr);
  ::_exit(failure);
}

}  // namespace

int main(int argc, char** argv) {
  std::set_new_handler(end_without_memory);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is said like a full disk
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ocm-generate: %s\n", error.what());
    return failure;
  }
}
