// Figures of a bus in all their forms.
#include "cli/stats/report.hpp"

#include <array>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/log/candump.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/shared/folding.hpp"
#include "tests/tool/golden.hpp"

namespace stats_report_test {

using namespace ocm;
using namespace ocm::cli;
using test::is_as_in;

/// A request every 100 ms, of which samples come late, once not at all, once with a time before the last;
/// half of a sample, a frame of a wrong length, two bad requests and one that is refused; strangers of six
/// kinds.
std::string log_text() {
  std::string text;
  const auto add = [&text](int ms, const std::string& frame, const std::string& bus = "can0") {
    text += "(" + std::to_string(1'700'000'000 + ms / 1000) + "." +
            std::to_string(1'000'000 + ms % 1000 * 1000).substr(1) + ") " + bus + " " + frame + "\n";
  };
  add(0, "208#01640000");
  for (int i = 1; i < 12; ++i)
    if (i != 5) add(100 * i + (i % 4 == 0 ? 7 : 1), i == 9 ? "508#010203040506" : "608#010203040506");
  add(1150, "605#00D20000");
  add(1151, "606#F0FFFFFF");
  add(1152, "607#01000000");
  add(1250, "605#00D20000");
  add(1350, "605#00D20000");
  add(1360, "605#0000");
  add(1370, "208#03");
  add(1371, "208#01000000");
  add(1372, "71D#0806010000000000");
  add(1380, "201#50C3000000000000");
  for (int i = 0; i < 6; ++i)
    for (int n = 0; n <= i; ++n) add(1400 + i, "7F" + std::to_string(i) + "#00");
  add(1410, "605#R");
  add(1411, "123##1AABB");
  add(1412, "18FF0001#01");
  add(1420, "20000004#0001000000000000");
  add(1000, "608#010203040506", "can1");
  add(1900, "608#010203040506", "can1");
  add(1500, "608#010203040506", "can1");
  return text;
}

stats::Report report_of(const protocol::Catalogue& catalogue, const std::string& text,
                        measure::BitRates rates) {
  stats::Collector collector{catalogue, [rates](std::string_view) { return rates; }};
  log::MemorySource source{text};
  log::Input input{source};
  log::CandumpReader reader{input};
  std::array<log::Entry, 16> entries;
  while (const std::size_t count = reader.read(entries))
    collector.take(std::span{entries}.first(count), reader.interfaces());
  collector.lost("can1", 3);
  stats::Report report{catalogue.robot, "drive.log", collector.buses()};
  report.never_came = collector.never_came(report.buses);
  return report;
}

TEST_CASE("stats report: a table for terminals of all widths") {
  const stats::Report report = report_of(amiro::catalogue, log_text(), {500'000, 0});
  std::string all;
  for (const std::size_t columns : {SIZE_MAX, std::size_t{130}, std::size_t{110}, std::size_t{90},
                                    std::size_t{70}, std::size_t{50}, std::size_t{30}}) {
    all += std::to_string(columns) + "\n";
    for (const std::string& line : stats::to_table(report, {}, false, columns)) all += "|" + line + "|\n";
  }
  is_as_in("tests/tool/stats/golden/tables.txt", all);
}

TEST_CASE("stats report: a table's widest line is what decides what it has room for") {
  const stats::Report report = report_of(amiro::catalogue, log_text(), {500'000, 0});
  std::size_t lines = 0;
  for (std::size_t columns = 200; columns > 40; --columns)
    for (const std::string& line : stats::to_table(report, {}, false, columns)) {
      CAPTURE(columns, line);
      CHECK((extent(line).words <= columns ||
             line.find(' ', line.find_first_not_of(' ')) == std::string::npos));
      ++lines;
    }
  CHECK(lines > 1000);
}

TEST_CASE("stats report: a table that just fits is as it is on a wider screen") {
  stats::Report report = report_of(amiro::catalogue, log_text(), {500'000, 0});
  report.buses.resize(1);
  const std::size_t rows = report.buses[0].figures.topics.size() + 1;
  std::size_t narrower = 0;
  for (std::size_t columns = 200; columns > 90; --columns) {
    const auto table = [&](std::size_t width) {
      auto lines = stats::to_table(report, {}, false, width);
      lines.resize(rows);
      return lines;
    };
    const auto lines = table(columns);
    std::size_t widest = 0;
    for (const std::string& line : lines) widest = std::max(widest, extent(line).words);
    CAPTURE(columns, widest);
    REQUIRE(widest <= columns);
    CHECK(table(widest) == lines);
    narrower += widest < columns ? 1U : 0U;
  }
  CHECK(narrower > 10);
}

TEST_CASE("stats report: a row with any fault has a colour, and one without has none") {
  stats::Report report;
  report.buses.resize(1);
  for (const unsigned missing : {0U, 1U})
    for (const unsigned incomplete : {0U, 1U})
      for (const unsigned wrong : {0U, 1U, 2U}) {
        CAPTURE(missing, incomplete, wrong);
        measure::TopicFigures topic;
        topic.topic = amiro::catalogue.find("gyroscope");
        topic.timing.missing = missing;
        topic.incomplete = incomplete;
        topic.wrong_dlc = wrong;
        report.buses[0].figures.topics.assign(1, topic);
        const auto lines = stats::to_table(report, {}, true, SIZE_MAX);
        REQUIRE(lines.size() >= 2);
        CHECK(lines[1].starts_with("\x1b[33m") == (missing + incomplete + wrong > 0));
        CHECK_FALSE(lines[0].starts_with("\x1b"));
      }
}

TEST_CASE("stats report: a bus without a name is called so") {
  stats::Report report = report_of(amiro::catalogue, log_text(), {500'000, 0});
  REQUIRE_FALSE(report.buses.empty());
  for (auto& bus : report.buses) bus.name.clear();
  std::string all;
  for (const std::string& line : stats::to_table(report, {}, false, SIZE_MAX)) all += line + "\n";
  CHECK_THAT(all, Catch::Contains("a bus without a name: "));
  CHECK_THAT(all, !Catch::Contains("\n: "));
}

TEST_CASE("stats report: colours, and the topics that are asked for") {
  const stats::Report report = report_of(amiro::catalogue, log_text(), {500'000, 0});
  const stats::Shown shown{amiro::catalogue.find("magnetometer"), amiro::catalogue.find("power_status")};
  std::string all;
  for (const std::string& line : stats::to_table(report, {}, true)) all += "|" + line + "|\n";
  for (const std::string& line : stats::to_table(report, shown, true, 60)) all += "|" + line + "|\n";
  all += stats::to_json(report, shown, {}) + stats::to_csv(report, shown) +
         stats::never_came_text(report, shown) + "\n";
  is_as_in("tests/tool/stats/golden/shown.txt", all);
}

TEST_CASE("stats report: of many messages that never came ten are named, and those that are asked for") {
  const auto* const message = amiro::catalogue.find("gyroscope");
  const auto* const other = amiro::catalogue.find("motors");
  const auto text = [&](std::size_t count, const stats::Shown& shown) {
    stats::Report report;
    report.never_came.assign(count, message);
    report.never_came.push_back(other);
    return stats::never_came_text(report, shown);
  };
  const auto named = [](std::size_t count) {
    std::string names = "never came: gyroscope (0 ns)";
    for (std::size_t i = 1; i < count; ++i) names += ", gyroscope (0 ns)";
    return names;
  };
  CHECK(text(9, {}) == named(9) + ", motors (0 ns)");
  CHECK(text(10, {}) == named(10) + " and 1 more");
  CHECK(text(14, {}) == named(10) + " and 5 more");
  CHECK(text(14, {message}) == named(14));
  CHECK(text(0, {message}).empty());
}

TEST_CASE("stats report: one object, and lines, without a bit rate and with two") {
  std::string all;
  for (const measure::BitRates rates : {measure::BitRates{0, 0}, measure::BitRates{250'000, 2'000'000}}) {
    const stats::Report report = report_of(amiro::catalogue, log_text(), rates);
    for (const std::string& line : stats::to_table(report, {}, false)) all += "|" + line + "|\n";
    all += stats::to_json(report, {}, {}) + stats::to_csv(report, {});
  }
  is_as_in("tests/tool/stats/golden/rates.txt", all);
}

TEST_CASE("stats report: five strangers are named, those that come most first, and others in their order") {
  stats::Report report;
  report.buses.resize(1);
  auto& figures = report.buses[0].figures;
  for (std::uint32_t i = 0; i < 5; ++i)
    figures.strangers.push_back({0x700 + i, can::Format::base, i == 3 ? 2U : 1U});
  figures.counters.unknown = 6;
  const auto text = [&] {
    std::string all;
    for (const std::string& line : stats::to_table(report, {}, false)) all += line + "\n";
    return all;
  };
  CHECK_THAT(text(), Catch::Contains("has (703 2, 700 1, 701 1, 702 1, 704 1)\n"));
  figures.strangers.push_back({0x705, can::Format::base, 1});
  CHECK_THAT(text(), Catch::Contains("has (703 2, 700 1, 701 1, 702 1, 704 1, ...)\n"));
}

TEST_CASE("stats report: what J1939's transport protocol has lost") {
  stats::Report report;
  report.buses.resize(1);
  auto& transport = report.buses[0].figures.transport;
  const auto text = [&] {
    std::string all;
    for (const std::string& line : stats::to_table(report, {}, false)) all += line + "\n";
    return all + stats::to_json(report, {}, {});
  };
  transport.lost_packet = 1;
  CHECK_THAT(text(), Catch::Contains("  1 message of it that was not put together\n"));
  transport.stray = 2;
  transport.malformed = 1;
  transport.timed_out = 1;
  CHECK_THAT(text(), Catch::Contains(
                         "  2 messages of it that were not put together, 3 frames of it of no message\n"));
  CHECK_THAT(text(), Catch::Contains(R"("transport_lost":2,"transport_stray":3,)"));
}

TEST_CASE(
    "stats: a message has not come where a bus was looked at for its period, and not where none is stated") {
  protocol::FrameLayout layout;
  layout.length = 8;
  layout.address = {protocol::Address::By::identifier, false, 0x123};
  std::array<protocol::Topic, 2> topics;
  for (protocol::Topic& topic : topics) {
    topic.kind = protocol::Kind::message;
    topic.board = protocol::no_board;
    topic.frames = {&layout, 1};
  }
  topics[0].name = "Periodic", topics[1].name = "Any";
  topics[0].cycle = base::Duration{100'000'000};
  const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
  const stats::Collector collector{catalogue, [](std::string_view) { return measure::BitRates{500'000, 0}; }};
  std::vector<stats::Bus> buses(2);
  buses[1].figures.first = base::Time{base::Duration{5}};
  buses[1].figures.last = buses[1].figures.first + topics[0].cycle;
  CHECK(collector.never_came(buses) == std::vector<const protocol::Topic*>{&catalogue.topics[0]});
  buses[1].figures.last -= base::Duration{1};
  CHECK(collector.never_came(buses).empty());
}

}  // namespace stats_report_test
