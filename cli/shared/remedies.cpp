#include "cli/shared/remedies.hpp"

#include <string_view>

#include <fmt/format.h>

namespace ocm::cli {
namespace {

/// Where a person sees what a sensor's board could carry.
std::string where_room_is_shown(std::string_view topic) {
  return fmt::format(
      "`amiroctl publish {} --dry-run --explain --listen 2s` shows what runs, and the shortest period that "
      "passes",
      topic);
}

/// The reasons of a refusal topic [spec/topics.json] in words.
std::string_view in_words(std::string_view reason) {
  struct Words {
    std::string_view reason, words;
  };
  constexpr Words all[] = {{"bad_length", "the board expects another number of bytes"},
                           {"bad_mode", "a mode that the board does not know"},
                           {"bad_unit", "a unit of time that the board does not know"},
                           {"bad_period", "a period that the board cannot keep"},
                           {"out_of_range", "a value that the board does not take"},
                           {"not_served", "nothing on the board serves it"},
                           {"no_sample", "the part delivered no sample"},
                           {"no_room", "the board has no room for it"},
                           {"no_answer", "the part behind it does not answer"},
                           {"bus_fault", "the bus of the part behind it failed"},
                           {"not_schedulable", "a stream of the board could miss its deadline"}};
  for (const auto& each : all)
    if (each.reason == reason) return each.words;
  return {};
}

}  // namespace

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
  if (finding.ailment == Ailment::not_schedulable) return where_room_is_shown(finding.topic);
  return finding.remedy;
}

std::vector<client::Finding> findings_of(const transport::BusCounters& bus,
                                         const client::ReceiverCounters& seen) {
  std::vector<client::Finding> all;
  const auto add = [&all](std::uint64_t number, std::string_view what, std::string_view remedy) {
    if (number != 0)
      all.push_back({client::Severity::warning, "", client::counted(number, what), std::string{remedy}});
  };
  add(bus.error_frames, "error frame* from the CAN controller of this machine",
      "check cable, termination and bit rate; `amiroctl listen` shows what they say");
  add(bus.lost, "frame* lost on the way to this program", "this machine is too busy");
  add(seen.unknown, "frame* that the spec does not know",
      "another program or robot on the bus, or another spec: `amiroctl listen` shows them");
  add(seen.remote, "remote frame", "the protocol has none: another program or robot on the bus");
  add(seen.wrong_dlc, "frame* of a wrong length", "a board or a program with another spec");
  add(seen.incomplete, "incomplete sample",
      "frames are lost, or a stream is so fast that its samples mix: `amiroctl stats` shows which");
  return all;
}

std::string remedy(const client::Refused& refused) {
  const auto& topic = *refused.topic;
  const std::string_view reason = refused.reason;
  if (reason == "not_schedulable")
    return fmt::format("ask for a longer period or stop another stream: {}", where_room_is_shown(topic.name));
  if (reason == "not_served")
    return fmt::format("{} accepts what its firmware serves: flash one that serves {}", refused.board,
                       topic.name);
  if (reason == "bad_period")
    return fmt::format("it accepts 1us to 65535s: `amiroctl publish {} 50ms`", topic.name);
  if (reason == "bad_length" || reason == "bad_mode" || reason == "bad_unit")
    return fmt::format(
        "`amiroctl info {}` says what this tool's spec accepts; `amiroctl doctor` says whether the "
        "board was built from another one",
        topic.name);
  if (reason == "out_of_range")
    return fmt::format(
        "it accepts less than the range that `amiroctl info {}` shows: the comments of the fields say what",
        topic.name);
  if (reason == "no_sample" && (topic.name == "avoid" || topic.name == "home"))
    return std::string{ring_without_offsets};
  return "`amiroctl doctor` says which parts do not answer; when they do, it accepts the same again";
}

std::string describe(const client::Refused& refused) {
  if (refused.reason.empty()) return "for a reason that the spec does not name";
  const auto words = in_words(refused.reason);
  return words.empty() ? std::string{refused.reason} : fmt::format("{} ({})", refused.reason, words);
}

}  // namespace ocm::cli
