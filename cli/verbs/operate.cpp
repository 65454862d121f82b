#include <csignal>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/operate/control.hpp"
#include "cli/operate/runner.hpp"
#include "cli/operate/study.hpp"
#include "cli/shared/drawing_program.hpp"
#include "cli/shared/fitted.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/operator_link.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {
namespace {

struct OperateOptions {
  std::string file;
  bool check = false;
  std::string svg;
  bool json = false;
  std::optional<std::uint32_t> bit_rate;
  operate::BlackBoxOptions black_box;
};

/// On stderr, all of them.
void tell(std::span<const spec::Problem> problems) {
  for (const auto& problem : problems)
    complain({fmt::format("{}: {}", problem.place, problem.what), problem.remedy});
}

int check(const OperateOptions& options, const operate::OperatorFile& file, std::uint32_t bit_rate) {
  const auto study = operate::study(file, bit_rate);
  // First what is known without Graphviz.
  if (options.json)
    fmt::print("{}", operate::to_json(study));
  else if (options.svg != "-")
    print_fitted(operate::to_table(study), 4);
  tell(study.doubts);
  if (!options.svg.empty()) {
    refuse_same_file("operate", options.file, options.svg);
    const auto picture = drawn_by({"dot", "-Tsvg"}, operate::to_dot(study), "sudo apt install graphviz");
    if (!picture)
      fail({fmt::format("operate: {}: {}", options.svg, picture.error.what), picture.error.remedy});
    write_file(options.svg, *picture);
  }
  return study.passes() ? exit_success : exit_failure;
}

/// What can be run: no mistake, and in time.
std::unique_ptr<operate::OperatorFile> load_or_leave(const OperateOptions& options,
                                                     const protocol::Catalogue& catalogue,
                                                     std::uint32_t bit_rate) {
  auto loaded = operate::load(options.file, catalogue, bit_rate);
  tell(loaded.problems);
  if (!loaded.file) throw Exit{exit_failure};
  return std::move(loaded.file);
}

/// The operator of this bus: there is one.
std::unique_ptr<operate::Control> open_control(const transport::Bus& bus) {
  auto control = operate::Control::open(bus.name());
  if (control) {
    const auto elsewhere = connect_operator_elsewhere(bus.name(), "operate");
    if (elsewhere && *elsewhere == nullptr) return std::move(*control);
    fail({fmt::format("operate: {} has {} already, which was started in another environment",
                      elsewhere ? (*elsewhere)->who() : "an operator", bus.name()),
          elsewhere ? "`amiroctl operator status` says what it does" : elsewhere.error.what});
  }
  if (control.error.process == 0)
    fail({fmt::format("operate: {}", control.error.what), control.error.remedy});
  const auto other = connect_operator(bus.name(), "operate");
  fail({other && *other ? fmt::format("operate: {} has {} already", (*other)->who(), bus.name())
                        : fmt::format("operate: {}, and does not answer", control.error.what),
        fmt::format("`amiroctl operator status` says what it does; kill {} ends it", control.error.process)});
}

int run(const OperateOptions& options, Session& session, std::uint32_t bit_rate) {
  const auto& catalogue = session.catalogue();
  static_cast<void>(
      load_or_leave(options, catalogue, bit_rate));  // a mistake is said before a bus is missing
  catch_interrupts();
  catch_hangups();
  std::signal(SIGPIPE,
              SIG_IGN);  // a reader that leaves does not end what guards the robot: lines are counted
  const auto bus = session.open_bus();
  const auto control = open_control(*bus);
  if (!options.bit_rate && bus->bit_rate() != 0) bit_rate = bus->bit_rate();
  const auto file = load_or_leave(options, catalogue, bit_rate);
  const auto study = operate::study(*file, bit_rate);
  if (!study.passes()) {
    tell(study.doubts);
    fail({fmt::format("operate: {} may act too late on this bus, and is not run", options.file),
          "amiroctl operate FILE --check shows all of it"});
  }
  operate::RunOptions how;
  how.json = options.json;
  how.bit_rate = bit_rate;
  how.black_box = options.black_box;
  operate::Runner runner{*bus, *control, catalogue, *file, how};
  Over over = Over::enough;
  std::optional<Exit> left;
  try {
    over = runner.run();
    if (over == Over::signal) runner.rest();
  } catch (
      const Exit& exit) {  // it is said why; what was counted, and the black box's end, come all the same
    left = exit;
  }
  runner.sum_up();
  if (left) throw *left;
  if (over == Over::gone) fail(bus->failure());
  return exit_code_after_interrupt(exit_success);
}

int operate_file(const OperateOptions& options, Session& session) {
  // What the specs are for is what is operated.
  session.bus_name = session.narrow_to_bus("operate", session.bus_name);
  const auto& catalogue = session.catalogue();
  const std::uint32_t bit_rate = options.bit_rate.value_or(catalogue.bit_rate);
  if (bit_rate == 0)
    fail({"operate: the spec states no bit rate", "--bitrate RATE, such as --bitrate 500k"}, exit_usage);
  if (!options.check) return run(options, session, bit_rate);
  return check(options, *load_or_leave(options, catalogue, bit_rate), bit_rate);
}

}  // namespace

void declare_operate(Verb verb, Session& session, int& exit_code) {
  verb.describe("watch the robot and switch its configurations, within proved bounds", act_group,
                "  amiroctl operate guard.operator.json           until Ctrl-C, then all is at rest\n"
                "  amiroctl operate guard.operator.json --check   what is proved of it\n"
                "  amiroctl operate guard.operator.json --check --svg guard.svg\n"
                "  amiroctl operate guard.operator.json --black-box /var/log/ocm --json");
  const auto options = std::make_shared<OperateOptions>();
  verb.add_option("FILE", options->file, "an operator, JSON: configurations, monitors and transitions")
      .required();
  const auto check_flag =
      verb.add_flag("--check", options->check, "only say what is wrong with it, and by when it acts");
  verb.add_option("--svg", options->svg,
                  "draw the state machine into FILE, with Graphviz; - for standard output")
      .type_name("FILE")
      .needs(check_flag);
  verb.add_flag("--json", options->json, "for programs: one object with --check, else one an event");
  add_bit_rate(verb, "--bitrate", options->bit_rate,
               "of the bus, such as 500k; default: as it says, else the spec's");
  const auto box =
      verb.add_option("--black-box", options->black_box.folder,
                      "keep the last seconds before each fall-back in this folder, as candump logs")
          .type_name("FOLDER")
          .excludes(check_flag);
  add_lasting(verb, "--black-box-time", options->black_box.lasting, "how much of it").needs(box);
  verb.add_option("--black-box-files", options->black_box.files, "how many of them; the oldest are deleted")
      .type_name("N")
      .range(1U, 10'000U)
      .show_default()
      .needs(box);
  verb.callback([options, &session, &exit_code] { exit_code = operate_file(*options, session); });
}

}  // namespace ocm::cli
