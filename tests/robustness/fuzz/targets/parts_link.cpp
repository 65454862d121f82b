// What an emulated board may ask its host, and what noise on that line may make of it: every request has one
// answer, which the board's reader knows; the models of the parts survive all that drivers would never do.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "firmware/qemu/parts_frames.hpp"
#include "sim/qemu/robot.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
namespace parts_link = firmware::qemu::link;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sim::WorldOptions options;
  options.frozen = true;
  sim::World world{options};
  base::Time now{};
  const sim::PartClock clock = [&now] { return now; };
  sim::DiWheelDriveParts bottom{world, clock};
  sim::PowerManagementParts middle{world, clock};
  sim::LightRingParts top{world};
  const std::array<sim::BoardParts*, 3> boards{&bottom, &middle, &top};
  if (size == 0) return 0;
  auto& board = *boards[data[0] % boards.size()];

  parts_link::RequestReader requests;
  for (const std::uint8_t byte : std::span{data + 1, size - 1}) {
    now += base::Duration{100'000};
    if (!requests.feed(byte)) continue;
    const parts_link::Request request = requests.request();
    std::array<std::uint8_t, parts_link::max_bytes> bytes{};
    const auto read = std::span{bytes}.first(request.asked);
    const base::Status done = sim::answer(board, request, read);
    const auto head =
        parts_link::header({request.sequence, done.error, done ? read : std::span<std::uint8_t>{}});
    parts_link::AnswerReader answers;
    bool complete = false;
    for (const std::uint8_t part : head) {
      fuzz::expect(!complete, "an answer ends where it says");
      complete = answers.feed(part);
    }
    if (done)
      for (const std::uint8_t part : read) {
        fuzz::expect(!complete, "an answer ends where it says");
        complete = answers.feed(part);
      }
    fuzz::expect(complete, "an answer is whole");
    fuzz::expect(answers.answer().sequence == request.sequence && answers.answer().status == done.error,
                 "and it is that request's");
    fuzz::expect(!done || std::ranges::equal(answers.answer().bytes, read), "with its bytes");
  }
  return 0;
}
