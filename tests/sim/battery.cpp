#include "sim/amiro/battery.hpp"

#include <catch2/catch.hpp>

namespace sim_battery_test {

using namespace ocm::sim;

/// Whole seconds of a constant load, with the gauge looking at each.
void run(Battery& battery, std::int64_t load_mw, int seconds) {
  for (int i = 0; i < seconds; ++i) {
    battery.step(load_mw, 1000);
    battery.gauge();
  }
}

TEST_CASE("the thesis's reading: 52 %, 137 minutes, -930 mW") {
  Battery battery{{}, 0.52, false};
  const GaugeReading expected{false, false, 52, 137, -930};
  CHECK(battery.reading() == expected);
  run(battery, 930, 10);
  CHECK(battery.reading() == expected);
}

TEST_CASE("each battery by itself: half of the power, half of the charge") {
  const Battery battery{{}, 0.52, false};
  const auto both = battery.readings();
  // 3.3 V + 0.52 * 0.8 V; 465 mW; 1.0608 Wh at a mean of 3.508 V; 25 degrees
  CHECK(both[0] == ocm::firmware::boards::BatteryReading{3716, -125, 302, 2982});
  CHECK(both[1] == both[0]);
  CHECK(Battery{{}, 0, false}.readings()[1] == ocm::firmware::boards::BatteryReading{3300, 0, 0, 2982});
  CHECK(Battery{{}, 0.5, true}.readings()[0].current_ma > 0);
}

TEST_CASE("a load drains what it says") {
  Battery battery{{}, 1, false};
  CHECK(battery.reading().state_of_charge_percent == 100);
  run(battery, 4080, 3600);  // 4.08 W for an hour are the 4.08 Wh
  CHECK(battery.empty());
  CHECK(battery.reading().state_of_charge_percent == 0);
  CHECK(battery.reading().minutes == 0);
  run(battery, 930, 10);  // nothing is left to give
  CHECK(battery.energy_uj() == 0);
  CHECK(battery.reading().power_mw == 0);
}

TEST_CASE("a short load does not halve the time that is left") {
  Battery battery{{}, 0.5, false};
  const auto before = battery.reading().minutes;
  run(battery, 2930, 2);
  CHECK(battery.reading().power_mw == -2930);
  CHECK(battery.reading().minutes > before * 9 / 10);
  run(battery, 2930, 300);
  CHECK(battery.reading().minutes < before * 2 / 5);
}

TEST_CASE("the charger fills the batteries, then carries the load") {
  Battery battery{{}, 0.5, true};
  CHECK(battery.charging());
  CHECK(battery.reading().plugged);
  CHECK(battery.reading().power_mw == 4070);
  CHECK(battery.reading().minutes == 30);  // 2.04 Wh at 4.07 W
  run(battery, 930, 29 * 60);
  CHECK(battery.charging());
  run(battery, 930, 3 * 60);
  CHECK(battery.reading() == GaugeReading{true, false, 100, 65535, 0});

  battery.set_plugged(false);
  run(battery, 930, 1);
  CHECK(battery.reading() == GaugeReading{false, false, 100, 263, -930});
}

TEST_CASE("a charger that is too weak does not charge") {
  Battery battery{{}, 0.5, true};
  run(battery, 6000, 60);
  CHECK(battery.reading().power_mw == -1000);
  CHECK(battery.reading().minutes == 65535);  // to full: never
}

TEST_CASE("a thousand small steps and one large one are the same to the bit") {
  Battery small{{}, 0.5, false};
  Battery large{{}, 0.5, false};
  for (int i = 0; i < 1000; ++i) small.step(1234, 1);
  large.step(1234, 1000);
  CHECK(small.energy_uj() == large.energy_uj());
}

TEST_CASE("what a battery says before anything has flowed: the boards' power, or none where none can flow") {
  CHECK(Battery{{}, 0.5, false}.reading().power_mw == -930);
  CHECK(Battery{{}, 0.5, true}.reading().power_mw == 4070);
  CHECK(Battery{{}, 1, true}.reading() == GaugeReading{true, false, 100, 65535, 0});
  CHECK(Battery{{}, 1, false}.reading().power_mw == -930);
  CHECK(Battery{{}, 0, false}.reading().power_mw == 0);
  CHECK(Battery{{}, 0, true}.reading().power_mw == 4070);
  CHECK(Battery{{}, 7, false}.reading().state_of_charge_percent == 100);
  CHECK(Battery{{}, -7, false}.empty());
}

TEST_CASE("percent are rounded, and minutes beyond 16 bits are unknown") {
  CHECK(Battery{{}, 0.5049, false}.reading().state_of_charge_percent == 50);
  CHECK(Battery{{}, 0.5051, false}.reading().state_of_charge_percent == 51);
  const auto minutes = [](std::int64_t capacity_uj) {
    PowerModel model;
    model.capacity_uj = capacity_uj;
    return Battery{model, 1, false}.reading().minutes;
  };
  CHECK(minutes(65'534 * std::int64_t{930 * 60'000}) == 65534);
  CHECK(minutes(65'535 * std::int64_t{930 * 60'000}) == 65535);
  CHECK(minutes(70'000 * std::int64_t{930 * 60'000}) == 65535);
}

TEST_CASE("the time that is left follows a new load within a minute or so, and a plug at once") {
  Battery battery{{}, 0.5, false};
  run(battery, 930, 100);
  const double rest = battery.reading().minutes;
  // The mean goes 1/60 of the way in a second: after 60 s 1 - (59/60)^60 = 63.5 % of it.
  run(battery, 1860, 60);
  CHECK(battery.reading().minutes == Approx(rest / 1.635).margin(2));
  run(battery, 1860, 600);
  CHECK(battery.reading().minutes ==
        Approx((static_cast<double>(battery.energy_uj()) / 1860.0 / 60'000)).margin(1));
  battery.set_plugged(true);
  run(battery, 930, 1);
  CHECK(battery.reading().minutes ==
        Approx(static_cast<double>(14'688'000'000 - battery.energy_uj()) / 4070.0 / 60'000).margin(1));
  battery.set_plugged(false);
  run(battery, 1860, 1);
  CHECK(battery.reading().minutes ==
        Approx(static_cast<double>(battery.energy_uj()) / 1860.0 / 60'000).margin(1));
}

TEST_CASE("what cannot be halved is the front battery's, and each current is that of its own power") {
  Battery battery{{}, 0.5, false};
  run(battery, 100'001 / 10, 1);  // 10000 mW
  battery.step(999, 1000), battery.gauge();
  const auto both = battery.readings();
  CHECK(both[0].current_ma == std::lround(-500 / 3.7));
  CHECK(both[1].current_ma == std::lround(-499 / 3.7));
  // Half of the energy each, at the mean of what comes out until it is empty.
  CHECK(both[0].remaining_mah ==
        Approx(static_cast<double>(battery.energy_uj()) / 2e6 / 3.6 / ((3.3 + 3.7) / 2)).margin(2));
  CHECK(both[0].voltage_mv == Approx(3700).margin(2));
}

TEST_CASE("power beyond 16 bits saturates") {
  PowerModel strong;
  strong.charger_mw = 100'000;
  CHECK(Battery{strong, 0.5, true}.reading().power_mw == 32767);
  Battery battery{{}, 1, false};
  run(battery, 100'000, 1);
  CHECK(battery.reading().power_mw == -32768);
}

}  // namespace sim_battery_test
