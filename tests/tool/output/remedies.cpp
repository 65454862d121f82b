#include "cli/shared/remedies.hpp"

#include <cerrno>
#include <string>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"
#include "ocm/transport/interfaces.hpp"

namespace tool_output_remedies_test {

using namespace ocm;
using cli::remedy;
using host::Cause;
using host::Failure;

TEST_CASE("remedies: what can be done with this tool is said with its words") {
  CHECK(remedy(transport::can_socket_failure(EAFNOSUPPORT)) ==
        "sudo modprobe can_raw, or use the simulated robot: --bus sim");
  CHECK(remedy(transport::detail::interfaces_failure(EACCES)) ==
        "name the bus with --bus; if a sandbox forbids netlink sockets, run outside of it");
  CHECK(remedy(Failure{"x", "y", Cause::simulator_missing}) == "start one with `amiroctl sim`");
  CHECK(remedy(Failure{"x", "y", Cause::simulator_gone}) ==
        "start one with `amiroctl sim`; if it crashed, please report what it said last");
  CHECK(remedy(Failure{"x", "y", Cause::simulator_private}) ==
        "a simulator serves its own user only: start one of your own (amiroctl sim)");
  CHECK(remedy(Failure{"x", "y", Cause::simulator_foreign}) == "start one of your own: amiroctl sim");
  CHECK(remedy(Failure{"x", "y", Cause::no_simulator}) ==
        "name another path, or none: `amiroctl sim`, `--bus sim`");
  CHECK(remedy(Failure{"x", "y", Cause::simulator_running, 1234}) ==
        "use it (--bus sim), end it (kill 1234), or serve another one: amiroctl sim --bus sim:PATH");
  CHECK(remedy(Failure{"x", "y", Cause::simulator_running}) ==
        "use it (--bus sim), or serve another one: amiroctl sim --bus sim:PATH");
}

TEST_CASE("remedies: all other failures keep their own") {
  CHECK(remedy(Failure{"x", "close other programs"}) == "close other programs");
  CHECK(remedy(transport::can_socket_failure(EPERM)) == transport::can_socket_failure(EPERM).remedy);
}

TEST_CASE("remedies: findings") {
  using client::Ailment;
  using client::Finding;
  using client::Severity;
  CHECK(remedy(Finding{Severity::problem, "a", "b", "c", Ailment::foreign_spec}) ==
        "flash it from this spec, or give this tool the board's with --spec");
  CHECK(remedy(Finding{Severity::note, "a", "b", "c", Ailment::refusals, "gyroscope"}) ==
        "`amiroctl info gyroscope` says what it takes");
  CHECK(remedy(Finding{Severity::note, "a", "b", "c", Ailment::refusals}) ==
        "`amiroctl info ?` says what it takes");
  CHECK(
      remedy(Finding{Severity::note, "a", "b", "c", Ailment::not_schedulable, "gyroscope"}) ==
      "`amiroctl publish gyroscope --dry-run --explain --listen 2s` shows what runs, and the shortest period "
      "that passes");
  CHECK(remedy(Finding{Severity::warning, "", "b", "c"}) == "c");
}

TEST_CASE("remedies: of each reason for which a board refuses") {
  const auto& gyroscope = *amiro::catalogue.find("gyroscope");
  const auto of = [&](std::string_view reason) {
    return remedy(client::Refused{&gyroscope, "di_wheel_drive", reason});
  };
  CHECK(of("not_schedulable") ==
        "ask for a longer period or stop another stream: `amiroctl publish gyroscope --dry-run --explain "
        "--listen 2s` shows what runs, and the shortest period that passes");
  CHECK(of("not_served") ==
        "di_wheel_drive accepts what its firmware serves: flash one that serves gyroscope");
  CHECK(of("bad_period") == "it accepts 1us to 65535s: `amiroctl publish gyroscope 50ms`");
  for (const char* const reason : {"bad_length", "bad_mode", "bad_unit"})
    CHECK(of(reason) ==
          "`amiroctl info gyroscope` says what this tool's spec accepts; `amiroctl doctor` says whether the "
          "board was built from another one");
  CHECK(of("out_of_range") ==
        "it accepts less than the range that `amiroctl info gyroscope` shows: the comments of the "
        "fields say what");
  for (const char* const reason : {"no_sample", "no_answer", "bus_fault", ""})
    CHECK(of(reason) ==
          "`amiroctl doctor` says which parts do not answer; when they do, it accepts the same again");
  // What goes by the ring needs to know what each of its sensors says of nothing.
  for (const char* const name : {"avoid", "home", "travel"}) {
    const auto* const topic = amiro::catalogue.find(name);
    REQUIRE(topic != nullptr);
    const bool by_ring = topic->name != "travel";
    CHECK((remedy(client::Refused{topic, "power_management", "no_sample"}) == cli::ring_without_offsets) ==
          by_ring);
    CHECK(remedy(client::Refused{topic, "power_management", "no_answer"}) != cli::ring_without_offsets);
  }
}

TEST_CASE("remedies: each counter is a finding of its own, and zero is none") {
  CHECK(cli::findings_of({.sent = 1, .received = 2, .refused = 3}, {.frames = 4, .samples = 5, .commands = 6})
            .empty());
  const auto all = cli::findings_of({.lost = 1, .error_frames = 2},
                                    {.unknown = 1, .remote = 3, .wrong_dlc = 4, .incomplete = 5});
  REQUIRE(all.size() == 6);
  for (const auto& finding : all) {
    CHECK(finding.severity == client::Severity::warning);
    CHECK(finding.board.empty());
  }
  CHECK(all[0].what == "2 error frames from the CAN controller of this machine");
  CHECK(all[0].remedy == "check cable, termination and bit rate; `amiroctl listen` shows what they say");
  CHECK(all[1].what == "1 frame lost on the way to this program");
  CHECK(all[1].remedy == "this machine is too busy");
  CHECK(all[2].what == "1 frame that the spec does not know");
  CHECK(all[2].remedy ==
        "another program or robot on the bus, or another spec: `amiroctl listen` shows them");
  CHECK(all[3].what == "3 remote frames");
  CHECK(all[3].remedy == "the protocol has none: another program or robot on the bus");
  CHECK(all[4].what == "4 frames of a wrong length");
  CHECK(all[4].remedy == "a board or a program with another spec");
  CHECK(all[5].what == "5 incomplete samples");
  CHECK(all[5].remedy ==
        "frames are lost, or a stream is so fast that its samples mix: `amiroctl stats` shows which");
}

TEST_CASE("remedies: every reason of a refusal has words, and says what would be accepted") {
  const auto* const refusal = amiro::catalogue.find("di_wheel_drive_refusal");
  const auto* const gyroscope = amiro::catalogue.find("gyroscope");
  const auto& reason = refusal->frames[0].fields[1];
  REQUIRE(reason.name == "reason");
  for (const auto& value : reason.values) {
    if (value.name == "nothing") continue;
    CAPTURE(value.name);
    const client::Refused refused{gyroscope, "di_wheel_drive", value.name};
    CHECK(cli::describe(refused).starts_with(std::string{value.name} + " ("));
    CHECK((remedy(refused).find("accept") != std::string::npos) !=
          (remedy(refused).find("longer period") != std::string::npos));
  }
  CHECK(cli::describe(client::Refused{gyroscope, "a", ""}) == "for a reason that the spec does not name");
  CHECK(cli::describe(client::Refused{gyroscope, "a", "moody"}) == "moody");
  CHECK(remedy(client::Refused{gyroscope, "di_wheel_drive", "not_served"}) ==
        "di_wheel_drive accepts what its firmware serves: flash one that serves gyroscope");
}

}  // namespace tool_output_remedies_test
