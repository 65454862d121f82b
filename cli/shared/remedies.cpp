#include "cli/shared/remedies.hpp"

namespace ocm::cli {

std::string remedy(const host::Failure& failure) {
  switch (failure.cause) {
    case host::Cause::can_missing:
      return failure.remedy + ", or use the simulated robot: --bus sim";
    case host::Cause::interfaces_unknown:
      return "name the bus with --bus; " + failure.remedy;
    case host::Cause::simulator_missing:
      return "start one with `amiroctl sim`";
    case host::Cause::simulator_gone:
      return "start one with `amiroctl sim`; if it crashed, please report what it said last";
    case host::Cause::simulator_private:
      return "a simulator serves its own user only: start one of your own (amiroctl sim)";
    case host::Cause::simulator_foreign:
      return "start one of your own: amiroctl sim";
    case host::Cause::no_simulator:
      return "name another path, or none: `amiroctl sim`, `--bus sim`";
    case host::Cause::simulator_running:
      return "use it (--bus sim)" +
             (failure.process > 0 ? ", end it (kill " + std::to_string(failure.process) + ")"
                                  : std::string{}) +
             ", or serve another one: amiroctl sim --bus sim:PATH";
    case host::Cause::other:
      break;
  }
  return failure.remedy;
}

std::string remedy(const client::Finding& finding) {
  using client::Ailment;
  if (finding.ailment == Ailment::foreign_spec)
    return "flash it from this spec, or give this tool the board's with --spec";
  if (finding.ailment == Ailment::refusals)
    return "`amiroctl info " + std::string{finding.topic.empty() ? "?" : finding.topic} +
           "` says what it takes";
  return finding.remedy;
}

}  // namespace ocm::cli
