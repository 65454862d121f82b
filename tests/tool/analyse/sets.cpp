// Sets of `analyse` from files, and the rates that change a robot's.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/analyse/set.hpp"
#include "cli/analyse/study.hpp"
#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "unit/host/host_testing.hpp"

namespace tool_analyse_sets_test {

using namespace ocm;
using namespace ocm::cli::analyse;
using test::leaving;

struct Folder : test::TemporaryDirectory {
  [[nodiscard]] std::string put(const std::string& name, std::string_view text) const {
    std::ofstream{file(name), std::ios::binary} << text;
    return file(name);
  }
};

/// Rates as "name period", with the number of a priority behind an @.
std::string told(const std::vector<std::string>& words) {
  std::string all;
  for (const Rate& rate : read_rates(words)) {
    all += rate.name + " " + (rate.off ? std::string{"off"} : time_text(rate.period.count()));
    if (rate.has_priority) all += "@" + std::to_string(static_cast<unsigned>(rate.priority));
    all += '\n';
  }
  return all;
}

TEST_CASE("rates: a word with a period is a rate, and what is or can only be a file is one", "[shared]") {
  const Folder folder;
  CHECK(told({"gyro=20ms"}) == "gyro 20ms\n");
  CHECK(told({"gyro=20ms@low", folder.put("rates", "ring=off\n")}) == "gyro 20ms@3\nring off\n");
  CHECK(told({folder.put("ring=5ms", "gyro=30ms")}) == "gyro 30ms\n");
  CHECK(told({"a=b=5ms"}) == "a=b 5ms\n");  // a table may have such a name
  const auto left = leaving([&folder] { static_cast<void>(read_rates({folder.file("none")})); });
  CHECK(left.code == cli::exit_failure);
  CHECK_THAT(left.text, Catch::Contains("cannot read " + folder.file("none") + ": "));
}

TEST_CASE("rates: of a line of a file the blanks around it and a remark are no part", "[shared]") {
  const Folder folder;
  const std::string file = folder.put("rates",
                                      "# all of them\n"
                                      "\n"
                                      " \t gyro=10ms \t \r\n"
                                      "\tring=off  # for now\n"
                                      "   \n"
                                      "   accel=2s@low   # at last\r\n"
                                      "mag=1ms");
  CHECK(told({file}) == "gyro 10ms\nring off\naccel 2s@3\nmag 1ms\n");
  const auto rates = read_rates({file});
  REQUIRE(rates.size() == 4);
  CHECK(rates[0].place == file + ":3");
  CHECK(rates[2].place == file + ":6");
  CHECK(rates[3].place == file + ":7");
}

TEST_CASE("rates: the shortest period is a nanosecond", "[shared]") {
  CHECK(told({"gyro=1ns"}) == "gyro 1ns\n");
  const auto left = leaving([] { static_cast<void>(read_rates({"gyro=0ns"})); });
  CHECK(left.code == cli::exit_usage);
  CHECK_THAT(left.text, Catch::Contains("--rates gyro=0ns: no period '0ns'\n"));
}

TEST_CASE("rates: of several for a topic the last one counts", "[shared]") {
  const auto set = robot_bus(amiro::catalogue, nullptr,
                             read_rates({"gyro=10ms@high", "gyroscope=20ms@low", "ring=off", "ring=30ms",
                                         "accel=5ms", "accel=off"}));
  std::set<std::int64_t> of_the_ring;
  std::size_t gyroscopes = 0;
  for (const BusEntry& entry : set.entries) {
    CAPTURE(entry.name);
    CHECK_FALSE(entry.name.starts_with("accelerometer"));
    if (entry.name.starts_with("proximity_ring.")) of_the_ring.insert(entry.period);
    if (entry.name != "gyroscope") continue;
    ++gyroscopes;
    CHECK(entry.period == 20'000'000);
    CHECK(entry.head.id == 0x708);
  }
  CHECK(gyroscopes == 1);
  CHECK(of_the_ring == std::set<std::int64_t>{30'000'000});
}

TEST_CASE("rates: of a table one message at least is left on", "[shared]") {
  BusSet set;
  set.entries.resize(2);
  set.entries[0].name = "a";
  set.entries[1].name = "b";
  std::vector<Rate> rates(2);
  rates[0].name = "a";
  rates[0].off = true;
  rates[1].name = "b";
  rates[1].off = true;
  BusSet one = set;
  apply_rates(one, {rates[0]});
  CHECK(one.entries.size() == 1);
  const auto left = test::leaving([&] { apply_rates(set, rates); });
  CHECK(left.code != cli::exit_success);
  CHECK_THAT(left.text, Catch::Contains("every message is off") && Catch::Contains("leave one on"));
}

TEST_CASE("sets: a number of a table has 63 bits, and a sign", "[shared]") {
  const Folder folder;
  const auto bus = [&folder](const std::string& period) {
    return folder.put("bus.csv", "name,id,dlc,period_ns\na,1,8," + period + "\n");
  };
  const auto tasks = [&folder](const std::string& priority) {
    return folder.put("tasks.csv", "name,priority,C_ns,T_ns\na," + priority + ",1,10\n");
  };
  const auto set = read_bus(bus("9223372036854775807"));
  REQUIRE(set.entries.size() == 1);
  CHECK(set.entries[0].period == INT64_MAX);
  const auto late = leaving([&] { static_cast<void>(read_bus(bus("9223372036854775808"))); });
  CHECK(late.code == cli::exit_usage);
  CHECK_THAT(late.text,
             Catch::Contains("bus.csv:2: period_ns '9223372036854775808' has more than 63 bits\n"));
  const auto least = read_tasks(tasks("-9223372036854775807"));
  REQUIRE(least.entries.size() == 1);
  CHECK(least.entries[0].priority == -INT64_MAX);
  const auto low = leaving([&] { static_cast<void>(read_tasks(tasks("-9223372036854775808"))); });
  CHECK(low.code == cli::exit_usage);
  CHECK_THAT(low.text,
             Catch::Contains("tasks.csv:2: priority '-9223372036854775808' has more than 63 bits\n"));
}

}  // namespace tool_analyse_sets_test
