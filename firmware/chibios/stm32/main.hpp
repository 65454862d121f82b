/// main() of a real board: the bus, the board on it, the threads. Each board has a file that names its pins
/// and its parts' buses and calls this. What is above the buses is the same as in the emulated images.
#pragma once

#include <cstdint>

#include "ocm/analysis/board_admission.hpp"
#include "ocm/base/time.hpp"
#include "ocm/controller/report.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/chibios/fault.hpp"
#include "firmware/chibios/load.hpp"
#include "firmware/chibios/port.hpp"
#include "firmware/chibios/stm32/board_signals.hpp"
#include "firmware/chibios/stm32/can_bus.hpp"
#include "firmware/chibios/stm32/chip.hpp"
#include "firmware/chibios/stm32/watchdog.hpp"
#include "firmware/drivers/bxcan_filter.hpp"

namespace ocm::firmware::chibios::stm32 {

/// What a board's status says of its chip.
class Vitals {
 public:
  Vitals(Port& port, CanBus& can) noexcept : load_(port), can_(&can), cause_(reset_cause()) {}

  /// To be called every 10 ms or so.
  void look(base::Time now) noexcept { load_.look(now); }

  [[nodiscard]] controller::Health health() const noexcept {
    const auto counters = can_->counters();
    controller::Health health;
    health.reset = static_cast<std::uint8_t>(cause_);
    health.load = load_.percent();
    health.bus = static_cast<std::uint8_t>(can_->errors().state);
    health.bus_errors =
        counters.passive + counters.bus_off + counters.dropped + counters.overruns + can_->missed();
    return health;
  }

 private:
  LoadMeter load_;
  CanBus* can_;
  ResetCause cause_;
};

/// Of a board whose serial line is for the flashing tool alone.
struct NoHostLine {
  template <class Type>
  static constexpr drivers::bxcan::FilterBanks filters = drivers::bxcan::filter_banks_of<Type>();
  NoHostLine(Port& /*port*/, CanBus& /*can*/) noexcept {}
  void start() noexcept {}
  [[nodiscard]] std::uint32_t lost() const noexcept { return 0; }
};

/// `Type` is the board in the generated header, `Board` its template, `Costs` what its admission reckons
/// with; `parts` have their buses started. `Line`: HostLine (host_line.hpp), or none.
template <class Type, template <class, class, class, class> class Board, class Costs, class Line = NoHostLine,
          class Parts>
[[noreturn]] void run(Parts& parts) noexcept {
  static Port port;
  static CanBus can;
  static Vitals vitals{port, can};
  parts.start(port.now());
  static constexpr auto filters = Line::template filters<Type>;
  // A controller that does not answer has no clock or is broken: nothing of this board would be heard of.
  if (!can.start(port, bit_timing<Type, amiro::catalogue.bit_rate>, filters).ok())
    rest_and_restart(ResetCause::software);
  using Admission = analysis::BoardAdmission<Type, amiro::bit_rate, Costs>;
  static Board<Parts, CanBus, Port, Admission> board{parts, can, port};
  static Line line{port, can};
  board.controller().report([] {
    controller::Health health = vitals.health();
    health.line_lost = line.lost();
    return health;
  });
  static Runtime runtime{port, board.controller(), can};
  line.start();
  say_ready();
  start_watchdog();
  runtime.run(
      [](base::Time now) {
        vitals.look(now);
        board.maintain(now);
      },
      feed_watchdog);
}

}  // namespace ocm::firmware::chibios::stm32
