#include <array>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/output/output.hpp"
#include "cli/shared/folding.hpp"
#include "tests/tool/output/rooms.hpp"

namespace tool_output_formats_test {

using namespace ocm;

/// What an output makes of frames that come this far apart.
std::string shown(std::unique_ptr<cli::Output> output, const std::vector<std::string>& frames,
                  base::Duration step = std::chrono::milliseconds{1},
                  const protocol::Catalogue& catalogue = amiro::catalogue) {
  client::Receiver receiver{catalogue};
  log::Bytes out;
  output->begin(out);
  base::Time time{base::Duration{1'436'509'052'249'713'000}};
  for (const auto& text : frames) {
    const log::Entry entry{time, *can::parse_frame(text)};
    const auto reception = cli::understand(receiver, entry);
    output->write(out, {"can0", entry, reception});
    if (&text != &frames.back()) time += step;
  }
  return std::string{out.view()};
}

const std::vector<std::string> frames{
    "608#0300FFFF0000", "602#50C30000400D0300", "603#0000000001000000", "208#01F40100", "4FF#00",
    "21E#02",           "61E#036400FF0A00"};

cli::Selection selection(const std::vector<std::string>& words) {
  return *cli::Selection::of(amiro::catalogue, words);
}

TEST_CASE("CSV has a line a field", "[output]") {
  CHECK(shown(cli::make_csv(amiro::catalogue, {}), {frames[0], frames[1], frames[4]}) ==
        "time,topic,field,value,unit\n"
        "1436509052.249713000,gyroscope,x,0.0525,deg/s\n"
        "1436509052.249713000,gyroscope,y,-0.0175,deg/s\n"
        "1436509052.249713000,gyroscope,z,0,deg/s\n"
        "1436509052.250713000,odometry,velocity.x,0.05,m/s\n"
        "1436509052.250713000,odometry,velocity.z,0.2,rad/s\n");
}

TEST_CASE("CSV of chosen fields has a column each", "[output]") {
  CHECK(shown(cli::make_csv(amiro::catalogue, selection({"odometry.velocity.z", "gyro.x", "gyro.z"})),
              frames) ==
        "time,odometry.velocity.z,gyroscope.x,gyroscope.z\n"
        "1436509052.249713000,,0.0525,0\n"
        "1436509052.250713000,0.2,,\n");
}

TEST_CASE("CSV lines are written to where there is room for them, whatever their names and units are",
          "[output]") {
  const std::string name(600, 'n'), unit(600, 'u');
  std::array<protocol::Field, 2> of_first;
  for (std::size_t i = 0; i < of_first.size(); ++i) {
    of_first[i].name = i == 0 ? std::string_view{"a"} : std::string_view{name};
    of_first[i].position = {static_cast<std::uint16_t>(8 * i), 8, protocol::ByteOrder::little};
    of_first[i].unit = unit;
    of_first[i].raw_max = 255;
  }
  std::vector<std::string> names;
  for (int i = 0; i < 150; ++i) names.push_back(fmt::format("b{}", i));
  std::vector<protocol::Field> of_second(names.size(), of_first[0]);
  for (std::size_t i = 0; i < names.size(); ++i) of_second[i].name = names[i];
  std::array<protocol::FrameLayout, 2> layouts;
  std::array<protocol::Topic, 2> topics;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    layouts[i].length = 2;
    layouts[i].address = {protocol::Address::By::identifier, false, 0x123 + static_cast<std::uint32_t>(i)};
    topics[i].name = i == 0 ? "First" : "Second";
    topics[i].kind = protocol::Kind::message;
    topics[i].board = protocol::no_board;
    topics[i].frames = {&layouts[i], 1};
  }
  layouts[0].fields = of_first;
  layouts[1].fields = of_second;
  protocol::Catalogue catalogue;
  catalogue.topics = topics;
  const log::Entry entry{base::Time{base::Duration{1'436'509'052'249'713'000}},
                         *can::parse_frame("123#0305")};
  client::Receiver receiver{catalogue};
  const client::Reception reception = cli::understand(receiver, entry);
  const auto check = [&](const cli::Selection& choice, const std::string& lines, std::size_t step) {
    const auto output = cli::make_csv(catalogue, choice);
    log::Bytes out;
    output->write(out, {"can0", entry, reception});
    CHECK((out.view() == lines));
    test::check_room([&](log::Bytes& to) { output->write(to, {"can0", entry, reception}); }, step);
  };
  check(
      {},
      "1436509052.249713000,First,a,3," + unit + "\n1436509052.249713000,First," + name + ",5," + unit + "\n",
      17);
  const std::vector<std::string> words{"First.a", "Second"};
  const auto chosen = cli::Selection::of(catalogue, words);
  REQUIRE(chosen);
  check(*chosen, "1436509052.249713000,3" + std::string(names.size(), ',') + "\n", 1);
}

TEST_CASE("pretty lines are for a person", "[output]") {
  const std::string text = shown(cli::make_pretty(amiro::catalogue, {}, false), frames);
  CHECK(
      text.find(
          "    0.000000  medium  gyroscope                 x    0.0525  y   -0.0175  z         0 deg/s\n") !=
      std::string::npos);
  CHECK(text.find("    0.003000  medium  gyroscope                 <- publish every 500ms\n") !=
        std::string::npos);
  CHECK(text.find("    0.004000  -       unknown: 4FF#00\n") != std::string::npos);
  CHECK(text.find("plugged|charging") != std::string::npos);
  CAPTURE(text);
  CHECK(std::count(text.begin(), text.end(), '\n') == 6);  // the odometry's two frames are one sample
  CHECK(text.find(" velocity.x ") != std::string::npos);   // a field of several frames has its frame's name
  const std::string chosen = shown(cli::make_pretty(amiro::catalogue, selection({"gyro.y"}), false), frames);
  CHECK(std::count(chosen.begin(), chosen.end(), '\n') == 1);
  CHECK(chosen.find("y   -0.0175 deg/s") != std::string::npos);
}

TEST_CASE("pretty lines have a unit that all fields share at the end, behind a name, too", "[output]") {
  static constexpr std::array<protocol::NamedValue, 1> names{{{5, "five"}}};
  const auto lines = [](std::string_view unit) {
    std::array<protocol::Field, 2> fields;
    fields[0].name = "A";
    fields[0].position = {0, 8, protocol::ByteOrder::little};
    fields[0].unit = "h";
    fields[1].name = "B";
    fields[1].position = {8, 8, protocol::ByteOrder::little};
    fields[1].unit = unit;
    fields[1].values = names;
    for (protocol::Field& field : fields) field.raw_max = 255;
    protocol::FrameLayout layout;
    layout.length = 2;
    layout.fields = fields;
    layout.address = {protocol::Address::By::identifier, false, 0x123};
    protocol::Topic topic;
    topic.name = "M";
    topic.kind = protocol::Kind::message;
    topic.board = protocol::no_board;
    topic.frames = {&layout, 1};
    protocol::Catalogue catalogue;
    catalogue.topics = {&topic, 1};
    return shown(cli::make_pretty(catalogue, {}, false), {"123#0305", "123#0304"},
                 std::chrono::milliseconds{1}, catalogue);
  };
  CHECK(lines("h") ==
        "    0.000000      123 M  A   3  B five (5) h\n"
        "    0.001000      123 M  A   3  B   4 h\n");
  CHECK(lines("V") ==
        "    0.000000      123 M  A   3 h  B five (5 V)\n"
        "    0.001000      123 M  A   3 h  B   4 V\n");
}

template <std::size_t columns>
std::size_t terminal() {
  return columns;
}

TEST_CASE("pretty lines fit a terminal, and no number is broken", "[output]") {
  const std::string whole = shown(cli::make_pretty(amiro::catalogue, {}, false), frames);
  const auto words = [](const std::string& text) {
    std::vector<std::string> found;
    std::istringstream in{text};
    for (std::string word; in >> word;) found.push_back(word);
    return found;
  };
  for (const auto& [columns, size] : {std::pair<cli::Columns, std::size_t>{terminal<40>, 40},
                                      {terminal<57>, 57},
                                      {terminal<80>, 80},
                                      {terminal<120>, 120},
                                      {terminal<200>, 200}})
    for (const bool colour : {false, true}) {
      const std::string text = shown(cli::make_pretty(amiro::catalogue, {}, colour, columns), frames);
      CAPTURE(text);
      std::istringstream lines{text};
      for (std::string line; std::getline(lines, line);) CHECK(cli::extent(line).all <= size);
      if (!colour) CHECK(words(text) == words(whole));
    }
  CHECK(shown(cli::make_pretty(amiro::catalogue, {}, false, terminal<200>), frames) == whole);
  CHECK(shown(cli::make_pretty(amiro::catalogue, {}, false, terminal<40>), {frames[0]}) ==
        "    0.000000  medium  gyroscope\n"
        "    x    0.0525  y   -0.0175\n"
        "    z         0 deg/s\n");
  CHECK(shown(cli::make_pretty(amiro::catalogue, {}, false, terminal<80>), {frames[0]}) ==
        "    0.000000  medium  gyroscope  x    0.0525  y   -0.0175  z         0 deg/s\n");
  // Names have a column of 24 where 40 are left behind it.
  CHECK(shown(cli::make_pretty(amiro::catalogue, {}, false, terminal<85>), {frames[0]}) ==
        "    0.000000  medium  gyroscope  x    0.0525  y   -0.0175  z         0 deg/s\n");
  CHECK(shown(cli::make_pretty(amiro::catalogue, {}, false, terminal<86>), {frames[0]}) ==
        "    0.000000  medium  gyroscope                 x    0.0525  y   -0.0175\n"
        "                      z         0 deg/s\n");
}

TEST_CASE("pretty lines say the time since the first frame, and how far before it a frame came", "[output]") {
  const std::vector<std::string> two{"4FF#00", "4FF#00"};
  const auto second = [&](base::Duration step) {
    const std::string text = shown(cli::make_pretty(amiro::catalogue, {}, false), two, step);
    const std::string line = text.substr(text.find('\n') + 1);
    return line.substr(0, line.find("  -"));
  };
  using std::chrono::microseconds;
  CHECK(second(microseconds{999'999}) == "    0.999999");
  CHECK(second(microseconds{1'000'000}) == "    1.000000");
  CHECK(second(microseconds{10'000'001}) == "   10.000001");
  CHECK(second(microseconds{9'999'000'000}) == " 9999.000000");
  CHECK(second(microseconds{10'000'000'000}) == "10000.000000");
  CHECK(second(microseconds{-1'500'000}) == "-    1.500000");
  CHECK(second(base::Duration{-999}) == "    0.000000");
  CHECK(second(base::Duration::min()) == "-9223372036.854775");
}

TEST_CASE("raw lines are candump's", "[output]") {
  CHECK(shown(cli::make_raw(), {frames[0], frames[4]}) ==
        "(1436509052.249713) can0 608#0300FFFF0000\n(1436509052.250713) can0 4FF#00\n");
}

}  // namespace tool_output_formats_test
