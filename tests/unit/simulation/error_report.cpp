#include "ocm/simulation/error_report.hpp"

#include <catch2/catch.hpp>

namespace simulation_error_report_test {

using namespace ocm;
using simulation::error_report;
using simulation::FaultConfinement;

TEST_CASE("who sends sees a bit error, who listens a stuff error, each with its counters") {
  FaultConfinement sender;
  sender.failed_to_send();
  CHECK(can::describe(error_report(sender, true)).view() ==
        "bit error while sending, error counters: sending 8, receiving 0");
  FaultConfinement listener;
  listener.failed_to_receive();
  CHECK(can::describe(error_report(listener, false)).view() ==
        "stuff error, error counters: sending 0, receiving 1");
}

TEST_CASE("error passive and bus-off are in the report") {
  FaultConfinement sender;
  while (sender.state() == simulation::FaultState::error_active) sender.failed_to_send();
  const can::Frame passive = error_report(sender, true);
  CHECK(passive.dlc == 8);
  CHECK((passive.id & can::error_class::controller) != 0);
  CHECK(passive.data[1] == can::controller_error::tx_passive);
  while (sender.state() != simulation::FaultState::bus_off) sender.failed_to_send();
  const can::Frame off = error_report(sender, true);
  CHECK((off.id & can::error_class::bus_off) != 0);
  CHECK(off.data[6] == 255);
  FaultConfinement listener;
  while (listener.state() == simulation::FaultState::error_active) listener.failed_to_receive();
  CHECK(error_report(listener, false).data[1] == can::controller_error::rx_passive);
}

}  // namespace simulation_error_report_test
