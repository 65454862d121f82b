// Which frames of a log count, and what of it cannot be read, and where.
#include "cli/analyse/arrivals.hpp"

#include <array>
#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "cli/logs/format.hpp"
#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/unit/log/log_testing.hpp"
#include "unit/host/host_testing.hpp"

namespace tool_analyse_arrivals_test {

using namespace ocm;
using cli::analyse::read_arrivals;

std::string put(const test::TemporaryDirectory& folder, const std::string& name, std::string_view text) {
  std::ofstream{folder.file(name), std::ios::binary} << text;
  return folder.file(name);
}
/// What is said as the log is refused.
std::string refused(const std::string& file) {
  const auto left = test::leaving([&] { static_cast<void>(read_arrivals(file, amiro::catalogue)); });
  CHECK(left.code == cli::exit_usage);
  return left.text;
}

TEST_CASE("arrivals: a place of a text is a line, and one of a binary log a byte", "[shared]") {
  const test::TemporaryDirectory folder;
  const std::string text =
      put(folder, "a.log", "(1000000000.000000) can0 123#00\n(1000000000.100000) words\n");
  CHECK_THAT(refused(text), Catch::Contains(text + ":2: no frame of a log: "));

  log::Interfaces interfaces;
  interfaces.add("can0");
  const std::array entries{log::Entry{base::Time{base::Duration{1'000'000'000}}, can::Frame{0x123, 1, {}}}};
  const auto writer = cli::logs::find_format("pcap")->writer(amiro::catalogue);
  const std::string whole = log::testing::write_all(*writer, entries, interfaces);
  constexpr std::size_t head = 24;  // of the file; that of a record has 16
  REQUIRE(whole.size() > head + 16);
  CHECK(read_arrivals(put(folder, "whole.pcap", whole), amiro::catalogue).all.size() == 1);
  const std::string cut = put(folder, "cut.pcap", whole.substr(0, head + 15));
  CHECK_THAT(
      refused(cut),
      Catch::Contains(cut + ":byte 24: no frame of a log: ends in the middle: the beginning of a record\n"));
}

TEST_CASE("arrivals: what comes first says whose frames count, and they are put in the order of their times",
          "[shared]") {
  const test::TemporaryDirectory folder;
  const auto log = read_arrivals(put(folder, "two.log",
                                     "(1000000000.200000) can1 123#00\n"
                                     "(1000000000.100000) can1 123#0102\n"
                                     "(1000000000.100000) can1 124#02\n"  // not older than the one before
                                     "(1000000000.150000) can0 123#03\n"
                                     "(1000000000.160000) can1 20000004#0000000000000000\n"
                                     "(1000000000.170000) can0 20000004#0000000000000000\n"),
                                 amiro::catalogue);
  REQUIRE(log.all.size() == 3);
  CHECK(log.all[0].frame.data[0] == 1);
  CHECK(log.all[0].length == 2);
  CHECK(log.all[1].frame.id == 0x124);
  CHECK(log.all[2].time - log.all[1].time == 100'000'000);
  CHECK(log.errors == 1);
  CHECK(log.remarks ==
        std::vector<std::string>{"Only the frames of can1: 2 of other interfaces were passed over.",
                                 "1 frame is older than the one before: sorted by time."});
}

}  // namespace tool_analyse_arrivals_test
