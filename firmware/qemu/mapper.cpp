// The mapper on a machine of QEMU: the application of ocm/mapper/app/robot.hpp on the kernel's
// threads, its parts by their drivers over the parts' line, its dongle on two lines more.
#include <cstddef>
#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/app/robot.hpp"

#include "firmware/boards/mapper/parts.hpp"
#include "firmware/chibios/load.hpp"
#include "firmware/chibios/port.hpp"
#include "firmware/qemu/dongle_line.hpp"
#include "firmware/qemu/machine.hpp"
#include "firmware/qemu/parts_link.hpp"

namespace chibios = ocm::firmware::chibios;
namespace qemu = ocm::firmware::qemu;
namespace mapper = ocm::firmware::boards::mapper;
namespace wiring = mapper::wiring;

using Parts = mapper::Parts<qemu::LinkI2c, qemu::LinkSpi, qemu::LinkConverter, qemu::LinkMotorTimers,
                            qemu::LinkPulseTimer, qemu::LinkOutputs, qemu::DongleLine, chibios::Mutex>;
using Robot = ocm::mapper::app::Robot<Parts, chibios::Port, chibios::Mutex>;

namespace {

constexpr std::size_t level_stack = 1280;

constinit Parts* stopping = nullptr;

/// A robot that gives up stands, and both lamps are dim: on for a tenth of the time. [Thesis 2, 6.3: "stack
/// overflow hook"] A real one would go on so until it is switched off; here QEMU ends after a second, so that
/// the host hears of it.
void stop_and_dim(const char*) {
  constexpr std::uint32_t turn_us = 10'000;
  stopping->drive({});
  for (int turn = 0; turn < 100; ++turn) {
    stopping->show({true, true});
    qemu::busy_wait(turn_us / 10);
    stopping->show({});
    qemu::busy_wait(turn_us - turn_us / 10);
  }
}

}  // namespace

int main() {
  qemu::start_machine();
  static chibios::Port port;
  static qemu::Uart parts_line{2};
  static qemu::PartsLink link{parts_line};
  static qemu::DongleLine dongle{1, 3};
  static qemu::LinkI2c compass{link, wiring::compass_i2c};
  static qemu::LinkSpi gyroscope{link, wiring::gyroscope_spi};
  static qemu::LinkConverter infrared{link};
  static qemu::LinkMotorTimers motors{link};
  static qemu::LinkPulseTimer servo{link, wiring::servo_channel};
  static qemu::LinkOutputs pins{link, 0};
  static Parts parts{compass, gyroscope, infrared, motors, servo, pins, dongle};
  link.start();
  stopping = &parts;
  qemu::before_giving_up(&stop_and_dim);
  parts.start(port.now());

  static Robot robot{parts, port, ocm::mapper::app::OCM_MAPPER};
  static chibios::LoadMeter load{port};
  static chibios::Levels<Robot, level_stack> levels{port, robot};
  robot.start();
  dongle.start(robot);
  levels.run([](ocm::base::Time now) {
    load.look(now);
    parts.maintain(now);
#ifdef OCM_OVERFLOW_TEST
    // Deeper than main()'s stack is, as soon as a server is connected; and another thread's turn there.
    struct Deeper {
      static int call(int depth) {
        volatile char room[64] = {};
        if (depth == 0) chThdSleepMilliseconds(1);
        return depth == 0 ? 0 : call(depth - 1) + room[depth % 64];
      }
    };
    if (dongle.linked()) Deeper::call(22);
#endif
  });
}
