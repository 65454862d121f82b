// What one decision of DiWheelDrive's admission costs on a Cortex-M3, in instructions: on QEMU's mps2-an385
// with -icount shift=0, where an instruction takes a nanosecond of the timer's time.
#include <cstdint>
#include <cstdio>

#include "ocm/analysis/board_admission.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/boards/di_wheel_drive/costs.hpp"

using namespace ocm;
using scheduling::Level;
using Admission =
    analysis::BoardAdmission<amiro::DiWheelDrive, amiro::bit_rate, firmware::boards::di_wheel_drive::Costs>;
constexpr std::size_t sensors = amiro::DiWheelDrive::sensors::size;

namespace {

/// CMSDK timer 0 of the board: counts down at 25 MHz, that is once in 40 instructions. [Arm DAI 0385, table
/// 4]
struct Timer {
  volatile std::uint32_t control, value, reload, interrupt;
};
Timer& timer = *reinterpret_cast<Timer*>(0x4000'0000);

struct Answer {
  base::Error error;
  std::uint32_t instructions;
};
[[gnu::noinline]] Answer ask(Admission& admission, std::size_t sensor, std::int64_t us, Level level) {
  const std::uint32_t begin = timer.value;
  const base::Error error = admission.admit(sensor, base::Duration{us * 1000}, level);
  return {error, (begin - timer.value) * 40};
}

std::uint32_t seed = 1;
std::uint32_t random(std::uint32_t below) {
  seed = seed * 1'664'525 + 1'013'904'223;
  return (seed >> 8) % below;
}

}  // namespace

int main() {
  timer.reload = 0xFFFF'FFFF;
  timer.value = 0xFFFF'FFFF;
  timer.control = 1;

  std::printf("| question | answer | instructions |\n|---|---|---|\n");
  const auto row = [](const char* text, Answer answer) {
    std::printf("| %s | %s | %lu |\n", text, answer.error == base::Error::none ? "yes" : "no",
                static_cast<unsigned long>(answer.instructions));
  };
  Admission admission;
  row("the first stream", ask(admission, 0, 50'000, Level::medium));
  for (std::size_t sensor = 1; sensor + 1 < sensors; ++sensor)
    static_cast<void>(ask(admission, sensor, 50'000, Level::medium));
  row("seven, every 50 ms, one level", ask(admission, sensors - 1, 50'000, Level::medium));
  row("then the gyroscope every millisecond, urgent", ask(admission, 3, 1'000, Level::urgent));
  row("then the compass every millisecond, low", ask(admission, 2, 1'000, Level::low));

  // The longest of many, near what is possible: random sets that are filled until nothing fits.
  Answer worst[2]{};
  for (int round = 0; round < 3'000; ++round) {
    Admission set;
    for (int request = 0; request < 24; ++request) {
      const Answer answer = ask(set, random(sensors), 300 + random(random(2) == 0 ? 4'000 : 30'000),
                                static_cast<Level>(random(4)));
      Answer& one = worst[answer.error == base::Error::none ? 0 : 1];
      if (answer.instructions > one.instructions) one = answer;
    }
  }
  row("the longest of 72'000 random ones", worst[0]);
  row("the same", worst[1]);
  std::printf("%u bytes of RAM\n", static_cast<unsigned>(sizeof(Admission)));
}
