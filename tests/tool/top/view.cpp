#include "cli/top/view.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <sstream>

#include <catch2/catch.hpp>

#include "ocm/base/utf8.hpp"

#include "tool/bus_model/bus.hpp"

namespace top_view_test {

using namespace ocm::test;
using namespace ocm::cli::top;
using ocm::base::columns;
using ocm::cli::TerminalSize;
using ocm::protocol::Mode;
using Kind = Key::Kind;

constexpr TerminalSize usual{80, 24};

Key letter(std::string text) {
  return {Kind::character, std::move(text)};
}

/// A bus with a scale, a lamp and a stranger.
struct Robot {
  Robot() {
    models.of("can0");
    for (int i = 0; i < 20; ++i) weigh(model(), i * 100ms, {4 * i, 7});
    const auto lamp = ocm::protocol::Identifier{ocm::protocol::Direction::command,
                                                ocm::protocol::Priority::low, ocm::protocol::TopicId{0x30}};
    model().take(entry(1950ms, lamp.encode(), {42}));
    model().take(entry(1960ms, 0x7FF, {0xDE, 0xAD}));
  }
  Model& model() { return models.of("can0"); }
  std::vector<std::string> draw(TerminalSize size = usual) {
    buses = models.buses();
    return text(view.draw(scene(), size));
  }
  Scene scene() {
    Scene scene;
    scene.robot = "example";
    scene.source = "can0";
    scene.buses = buses;
    scene.now = now;
    scene.playing = playing;
    return scene;
  }
  /// The line that begins with these letters; empty: none.
  std::string line(std::string_view beginning, TerminalSize size = usual) {
    for (const std::string& line : draw(size))
      if (line.starts_with(beginning)) return line;
    return {};
  }
  std::vector<std::string> names() {
    std::vector<std::string> names;
    const auto lines = draw();
    for (std::size_t i = 4; i + 1 < lines.size(); ++i)
      if (!lines[i].empty())
        names.push_back(lines[i].substr(0, lines[i].find(' ', lines[i].find_first_not_of(' '))));
    return names;
  }

  Models models{catalogue, 250'000};
  View view{true};
  std::vector<Bus> buses;
  ocm::base::Time now = morning + 2s;
  std::optional<Playing> playing;
};

using Names = std::vector<std::string>;

TEST_CASE("top: a picture by hand") {
  Robot robot;
  const auto lines = robot.draw();
  REQUIRE(lines.size() == 24);
  CHECK(lines[0] == "can0 example");
  CHECK(lines[2] == "42 frames  1 unknown");
  CHECK(lines[3] == "NAME         HZ JITTER    AGE    BUS VALUES" + std::string(37, ' '));
  CHECK(robot.line("scale") == "scale      10.0    0us  100ms   0.6% weight 119 g  state stable");
  CHECK(robot.line("7FF") == "7FF           -      -   40ms  <0.1% DE AD");
  CHECK(lines[23].starts_with("? help  q quit"));
}

TEST_CASE("top: each column has a width from which on there is room for it") {
  Robot robot;
  const auto heading = [&](std::size_t width) {
    const std::string line = robot.line("NAME", {width, 24});
    return line.substr(0, line.find_last_not_of(' ') + 1);
  };
  CHECK(heading(120) == "NAME         HZ JITTER    AGE    BUS CHANGED FAULTS     COUNT VALUES");
  CHECK(heading(119) == "NAME         HZ JITTER    AGE    BUS CHANGED FAULTS VALUES");
  CHECK(heading(110) == heading(119));
  CHECK(heading(109) == "NAME         HZ JITTER    AGE    BUS CHANGED VALUES");
  CHECK(heading(96) == heading(109));
  CHECK(heading(95) == "NAME         HZ JITTER    AGE    BUS VALUES");
  CHECK(heading(78) == heading(95));
  CHECK(heading(77) == "NAME         HZ JITTER    AGE VALUES");
  CHECK(heading(70) == heading(77));
  CHECK(heading(69) == "NAME         HZ    AGE VALUES");
  CHECK(heading(56) == heading(69));
  CHECK(heading(55) == "NAME         HZ VALUES");
  CHECK(robot.line("scale", {120, 24}) ==
        "scale      10.0    0us  100ms   0.6%   100ms      0        20 weight 119 g  state stable");
}

TEST_CASE("top: a value is there where it just fits") {
  Robot robot;
  CHECK(robot.line("scale", {42, 24}) == "scale      10.0 weight 119 g  state stable");
  CHECK(robot.line("scale", {41, 24}) == "scale      10.0 weight 119 g …");
  // The first one without its name, rather than not.
  CHECK(robot.line("scale", {28, 24}) == "scale      10.0 weight 119 g");
  CHECK(robot.line("scale", {27, 24}) == "scale      10.0 119 g …");
}

TEST_CASE("top: each value of a frame is as wide as it ever was, and a long name of it is cut") {
  using ocm::protocol::ByteOrder;
  const ocm::protocol::Field fields[2] = {
      {"speed", {0, 16, ByteOrder::little}, false, {1, 0}, {}, "", 0, 65535, {}},
      {"temperature_of_the_motor", {16, 8, ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}}};
  ocm::protocol::FrameLayout layout;
  layout.length = 3;
  layout.fields = fields;
  layout.address = {ocm::protocol::Address::By::identifier, false, 0x121};
  ocm::protocol::Topic topic;
  topic.name = "drive";
  topic.board = ocm::protocol::no_board;
  topic.kind = ocm::protocol::Kind::message;
  topic.frames = {&layout, 1};
  ocm::protocol::Catalogue car;
  car.robot = "car";
  car.topics = {&topic, 1};
  Robot robot;
  robot.models = Models{car, 250'000};
  robot.model().take(entry(1000ms, 0x121, {0xE8, 0x03, 5}));
  CHECK(robot.line("drive").ends_with(" speed 1000  temperature_of_the_motor 5"));
  robot.model().take(entry(1100ms, 0x121, {7, 0, 200}));
  CHECK(robot.line("drive").ends_with(" speed    7  temperature_of_the_motor 200"));
  robot.model().take(entry(1200ms, 0x121, {8, 0, 4}));
  CHECK(robot.line("drive").ends_with(" speed    8  temperature_of_the_motor   4"));
  // On a line of its own it has two fifths of the width.
  robot.view.press(Key{Kind::down});
  robot.view.press(Key{Kind::enter});
  CHECK(robot.line("  temp", {80, 24}).starts_with("  temperature_of_the_motor            4"));
  CHECK(robot.line("  temp", {50, 24}).starts_with("  temperature_of_the            4"));
}

TEST_CASE("top: of several frames a value has its frame's name, and its own where the frame has more") {
  auto frames = scale_frames;
  frames[0].name = "plate";
  std::array<ocm::protocol::Field, 2> of_state{state_fields[0], state_fields[0]};
  of_state[1].name = "again";
  frames[1].fields = of_state;
  auto renamed_topics = topics;
  renamed_topics[0].frames = frames;
  ocm::protocol::Catalogue renamed = catalogue;
  renamed.topics = renamed_topics;
  Robot robot;
  robot.models = Models{renamed, 250'000};
  weigh(robot.model(), 1900ms, {76, 7});
  CHECK(robot.line("scale", {109, 24}).ends_with(" plate 119 g  state.state stable  state.again stable"));
}

TEST_CASE("top: how often a row is due is said where there is room for its value, too") {
  const ocm::protocol::Period every_100ms{100, ocm::protocol::PeriodUnit::milliseconds};
  Robot robot;
  ask(robot.model(), 2s, Mode::publish, every_100ms);
  robot.now = morning + 2400ms;
  CHECK(robot.line("scale", {59, 24}).find(" due every 100ms weight 119 g") != std::string::npos);
  CHECK(robot.line("scale", {58, 24}).find("due") == std::string::npos);
  CHECK(robot.line("scale", {58, 24}).find(" weight 119 g") != std::string::npos);
  // Of a row without a value it is said on a narrow screen, too.
  robot.models = Models{catalogue, 250'000};
  ask(robot.model(), 2s, Mode::publish, every_100ms);
  CHECK(robot.line("scale", {50, 24}) == "scale         - due every 100ms nothing came");
}

TEST_CASE("top: fits every terminal, and breaks no number") {
  Robot robot;
  robot.view.press(letter("*"));
  robot.draw();
  robot.view.press(letter("*"));
  robot.draw();
  robot.view.press(Key{Kind::down});
  robot.view.press(letter(" "));
  for (const bool help : {false, true}) {
    if (help) robot.view.press(letter("?"));
    for (std::size_t width = 1; width <= 220; ++width)
      for (const std::size_t rows : {2U, 3U, 5U, 8U, 24U, 70U}) {
        const auto lines = robot.draw({width, rows});
        CAPTURE(width, rows);
        REQUIRE(lines.size() == rows);
        for (const auto& line : lines) REQUIRE(columns(line) <= width);
      }
  }
  robot.view.press(letter("x"));
  for (std::size_t width = 40; width <= 220; ++width) {
    const std::string line = robot.line("scale", {width, 24});
    CAPTURE(width, line);
    if (line.find("weight") != std::string::npos) REQUIRE(line.find("weight 119 g") != std::string::npos);
  }
  CHECK(robot.line("scale", {40, 24}).find("10.0") != std::string::npos);
  CHECK(robot.line("scale", {200, 24}).find("CHANGED") == std::string::npos);
  CHECK(robot.draw({200, 24})[3].find("CHANGED FAULTS     COUNT VALUES") != std::string::npos);
}

TEST_CASE("top: the help cuts no word, at any width from 40 columns on") {
  const auto words_of = [](const std::vector<std::string>& lines) {
    std::vector<std::string> words;
    for (const auto& line : lines) {
      std::istringstream text{line};
      for (std::string word; text >> word;) words.push_back(word);
    }
    return words;
  };
  Robot robot;
  robot.view.press(letter("?"));
  const auto words = words_of(robot.draw({220, 70}));
  CHECK(words.size() > 100);
  for (std::size_t width = 40; width < 220; ++width) {
    CAPTURE(width);
    REQUIRE(words_of(robot.draw({width, 70})) == words);
  }
  // Keys have a column from the usual width on; on a narrower screen words follow them.
  const auto has = [&](std::size_t width, const std::string& line) {
    const auto lines = robot.draw({width, 70});
    return std::find(lines.begin(), lines.end(), line) != lines.end();
  };
  CHECK(has(80, "q                            quit"));
  CHECK(has(79, "q  quit"));
  // On the usual screen all of it, and nothing is below its end.
  CHECK(words_of(robot.draw(usual)) == words);
}

TEST_CASE("top: a narrow screen has the rate of the frames, and a value a row") {
  Robot robot;
  for (int i = 0; i < 1500; ++i) robot.model().take(entry(1000ms + i * 600us, 0x7FF, {0xDE, 0xAD}));
  for (std::size_t width = 40; width <= 120; ++width) {
    CAPTURE(width);
    const auto lines = robot.draw({width, 24});
    REQUIRE(lines[1].find(" frames/s") != std::string::npos);
    REQUIRE(robot.line("scale", {width, 24}).find("119") != std::string::npos);
  }
  CHECK(robot.line("scale", {40, 24}).find("weight 119 g") != std::string::npos);
  CHECK(robot.draw({40, 24})[1].find("frames/s") != std::string::npos);
}

TEST_CASE("top: a value that has no room beside its name is there without it") {
  Robot robot;
  weigh(robot.models.of("a-long-name-of-a-bus"), 1900ms, {2'147'483'647, 7});
  // A name of two buses takes the room.
  for (std::size_t width = 40; width <= 60; ++width) {
    bool found = false;
    for (const auto& line : robot.draw({width, 24}))
      found = found || (line.starts_with("a-long-n") && line.find("536871011.75") != std::string::npos);
    CAPTURE(width);
    CHECK(found);
  }
}

TEST_CASE("top: HZ and JITTER end when nothing comes any more") {
  Robot robot;
  CHECK(robot.line("scale").starts_with("scale      10.0    0us"));
  robot.now = morning + 3800ms;
  CHECK(robot.line("scale").starts_with("scale      10.0    0us"));
  robot.now = morning + 14s;
  CHECK(robot.line("scale").starts_with("scale         -      -  12.1s"));
}

TEST_CASE("top: the state and the counters of the CAN controller, where it reports them") {
  namespace cls = ocm::can::error_class;
  namespace what = ocm::can::controller_error;
  Robot robot;
  CHECK(robot.draw()[2] == "42 frames  1 unknown");
  const auto report = [&](std::uint32_t id, std::initializer_list<int> bytes) {
    robot.model().take(entry(1990ms, id, bytes, ocm::can::Format::error));
  };
  report(cls::controller | cls::counters, {0, what::tx_warning, 0, 0, 0, 0, 104, 3});
  CHECK(robot.draw()[2] == "error warning  TEC 104 REC 3  43 frames  1 error frame  1 unknown");
  report(cls::protocol, {0, 0, 4, 0, 0, 0, 0, 0});  // says nothing of either
  CHECK(robot.draw()[2].starts_with("error warning  TEC 104 REC 3  "));
  report(cls::bus_off, {0, 0, 0, 0, 0, 0, 0, 0});
  CHECK(robot.draw()[2].starts_with("bus-off  TEC 104 REC 3  "));
  report(cls::restarted | cls::counters, {0, 0, 0, 0, 0, 0, 0, 0});
  CHECK(robot.draw({40, 24})[2].starts_with("error active  TEC 0 REC 0  46 frames"));
}

TEST_CASE("top: what is missing comes first") {
  Robot robot;
  CHECK(robot.names() == Names{"scale", "lamp_1", "7FF"});
  for (int i = 0; i < 5; ++i) robot.model().take(entry(2s, 0x7FE, {1}));
  ask(robot.model(), 2s, Mode::publish, {100, ocm::protocol::PeriodUnit::milliseconds});
  robot.view.press(letter(">"));  // by name
  robot.now = morning + 2s;
  CHECK(robot.names() == Names{"7FE", "7FF", "lamp_1", "scale"});
  robot.now = morning + 2200ms;
  CHECK(robot.names() == Names{"scale", "7FE", "7FF", "lamp_1"});
  CHECK(robot.draw()[0].find("1 late") != std::string::npos);
  CHECK(robot.line("scale").find("due every 100ms") != std::string::npos);
  robot.now = morning + 2400ms;
  CHECK(robot.draw()[0].find("1 missing") != std::string::npos);
}

TEST_CASE("top: orders") {
  Robot robot;
  CHECK(robot.names() == Names{"scale", "lamp_1", "7FF"});
  robot.view.press(letter("I"));
  CHECK(robot.names() == Names{"7FF", "lamp_1", "scale"});
  robot.view.press(letter("I"));
  robot.view.press(letter(">"));
  CHECK(robot.names() == Names{"7FF", "lamp_1", "scale"});
  robot.view.press(letter(">"));
  CHECK(robot.names() == Names{"scale", "lamp_1", "7FF"});  // the only one with a rate
  robot.view.press(letter("<"));
  robot.view.press(letter("<"));
  robot.view.press(letter("<"));  // the last: by count
  CHECK(robot.names()[0] == "scale");
  CHECK(robot.draw()[0].find("  by count") != std::string::npos);
  // All orders are reached, and the first again.
  for (int i = 0; i < 8; ++i) robot.view.press(Key{Kind::function, {}, 6});
  CHECK(robot.draw()[0].find("  by count") != std::string::npos);
}

TEST_CASE("top: only names with these letters") {
  Robot robot;
  robot.view.press(letter("/"));
  robot.view.press(letter("L"));
  robot.view.press(letter("A"));
  robot.view.press(letter("q"));  // a letter like any other
  CHECK(robot.draw().back().starts_with("/LAq_"));
  CHECK(robot.names() == Names{"no"});  // no name has these letters
  robot.view.press(Key{Kind::backspace});
  CHECK(robot.names() == Names{"lamp_1"});
  robot.view.press(Key{Kind::enter});
  CHECK(robot.draw()[0].find("/LA") != std::string::npos);
  // A field's name counts, too.
  robot.view.press(letter("/"));
  for (const char* text : {"s", "t", "a", "t", "e"}) robot.view.press(letter(text));
  CHECK(robot.names() == Names{"scale"});
  robot.view.press(Key{Kind::escape});
  CHECK(robot.names() == Names{"lamp_1"});
  robot.view.press(Key{Kind::escape});
  CHECK(robot.names().size() == 3);
  // A character of two bytes is deleted whole.
  robot.view.press(letter("/"));
  robot.view.press(letter("ä"));
  robot.view.press(Key{Kind::backspace});
  CHECK(robot.draw().back().starts_with("/_"));
}

TEST_CASE("top: a row opens into a line a field, and the cursor stays where it is") {
  Robot robot;
  robot.draw();
  robot.view.press(Key{Kind::down});
  robot.view.press(Key{Kind::enter});
  CHECK(robot.names() == Names{"scale", "  weight", "  state", "lamp_1", "7FF"});
  CHECK(robot.line("  weight").find(" 119 g") != std::string::npos);
  robot.view.press(Key{Kind::down});
  robot.view.press(Key{Kind::down});
  robot.view.press(letter("-"));  // on a field: closes its row
  CHECK(robot.names() == Names{"scale", "lamp_1", "7FF"});
  robot.view.press(letter("-"));  // it is closed
  CHECK(robot.names().size() == 3);
  robot.view.press(letter("+"));
  CHECK(robot.names().size() == 5);
  robot.view.press(letter("+"));  // it is open
  CHECK(robot.names().size() == 5);
  robot.view.press(letter("*"));
  CHECK(robot.names().size() == 3);
  robot.view.press(letter("*"));
  CHECK(robot.names() == Names{"scale", "  weight", "  state", "lamp_1", "  level", "7FF"});
  // A stranger has nothing to open.
  robot.view.press(Key{Kind::end});
  robot.view.press(letter("+"));
  robot.view.press(letter(" "));
  CHECK(robot.names().size() == 6);
}

TEST_CASE("top: no key goes beyond the first row") {
  for (const Kind kind : {Kind::up, Kind::page_up}) {
    Robot robot;
    robot.draw();
    robot.view.press(Key{Kind::down});  // it shows the cursor
    robot.view.press(Key{kind});
    robot.view.press(Key{Kind::enter});
    CHECK(robot.names() == Names{"scale", "  weight", "  state", "lamp_1", "7FF"});
  }
}

TEST_CASE("top: a page is a row less than those in sight, and at least one") {
  const auto opened = [](std::size_t rows) {
    Robot robot;
    for (const Kind kind : {Kind::down, Kind::page_down, Kind::enter}) {
      robot.draw({80, rows});
      robot.view.press(Key{kind});
    }
    return robot.names();
  };
  const Names second{"scale", "lamp_1", "  level", "7FF"};
  CHECK(opened(6) == second);  // one is in sight
  CHECK(opened(7) == second);
  CHECK(opened(8) == Names{"scale", "lamp_1", "7FF"});  // the third, which has nothing to open
}

TEST_CASE("top: of a field that has kept its value for a second it is said for how long") {
  Robot robot;
  robot.draw();
  robot.view.press(Key{Kind::down});
  robot.view.press(Key{Kind::enter});
  CHECK(robot.line("  weight").find("unchanged") == std::string::npos);  // it is seen now
  robot.now += 1s - 1ns;
  CHECK(robot.line("  weight").find("unchanged") == std::string::npos);
  robot.now += 1ns;
  CHECK(robot.line("  weight").ends_with("  unchanged 1.0s"));
  // A value of zero begins like any other when it is seen first.
  Robot zero;
  weigh(zero.model(), 1990ms, {0, 0});
  zero.draw();
  zero.view.press(Key{Kind::down});
  zero.view.press(Key{Kind::enter});
  CHECK(zero.line("  weight").find("unchanged") == std::string::npos);
  zero.now += 1s;
  CHECK(zero.line("  weight").find("  unchanged 1.0s") != std::string::npos);
}

TEST_CASE("top: a multiplexer's other pages keep their values and their places") {
  using ocm::protocol::ByteOrder;
  constexpr ocm::protocol::SelectorRange pages[] = {{0, 0}, {1, 1}};
  ocm::protocol::Field fields[3] = {{"page", {0, 8, ByteOrder::little}, false, {1, 0}, {}, "", 0, 255, {}},
                                    {"volts", {8, 8, ByteOrder::little}, false, {1, 0}, {}, "V", 0, 255, {}},
                                    {"amps", {8, 8, ByteOrder::little}, false, {1, 0}, {}, "A", 0, 255, {}}};
  for (std::size_t i : {1U, 2U}) {
    fields[i].selector = 0;
    fields[i].selected = std::span{pages}.subspan(i - 1, 1);
  }
  ocm::protocol::FrameLayout layout;
  layout.length = 2;
  layout.fields = fields;
  layout.address = {ocm::protocol::Address::By::identifier, false, 0x120};
  ocm::protocol::Topic topic;
  topic.name = "cells";
  topic.board = ocm::protocol::no_board;
  topic.kind = ocm::protocol::Kind::message;
  topic.frames = {&layout, 1};
  ocm::protocol::Catalogue paged;
  paged.robot = "paged";
  paged.topics = {&topic, 1};
  Models models{paged, 250'000};
  View view{true};
  std::vector<Bus> buses;
  const auto lines = [&](ocm::base::Duration at) {
    buses = models.buses();
    Scene scene;
    scene.robot = "paged";
    scene.source = "can0";
    scene.buses = buses;
    scene.now = morning + at;
    std::vector<std::string> of_fields;
    for (const auto& line : text(view.draw(scene, usual)))
      if (line.starts_with("  ")) of_fields.push_back(line.substr(0, 40));
    return of_fields;
  };
  const auto has = [](const std::string& line, const char* what) {
    return line.find(what) != std::string::npos;
  };
  models.of("can0").take(entry(0ms, 0x120, {0, 12}));
  static_cast<void>(lines(10ms));
  view.press(Key{Kind::down});
  view.press(Key{Kind::enter});
  CHECK(lines(20ms).size() == 2);  // amps was not there yet
  models.of("can0").take(entry(100ms, 0x120, {1, 7}));
  static_cast<void>(lines(110ms));
  for (const int page : {0, 1, 0}) {
    models.of("can0").take(entry(200ms + page * 1ms, 0x120, {page, page == 0 ? 13 : 8}));
    const auto now = lines(300ms);
    REQUIRE(now.size() == 3);
    CHECK(has(now[1], "13 V"));
  }
  CHECK(has(lines(310ms)[2], "8 A"));
}

TEST_CASE("top: a field's graph") {
  Robot robot;
  robot.draw();
  robot.view.press(Key{Kind::home});
  robot.view.press(Key{Kind::enter});
  robot.draw();
  robot.view.press(Key{Kind::down});
  robot.view.press(letter(" "));
  CHECK(robot.view.graphs(0) == std::set<FieldKey>{{0, 0, 0}});
  CHECK(robot.view.graphs(1).empty());
  CHECK(robot.models.follow(0, robot.view.graphs(0)));
  CHECK_FALSE(robot.models.follow(0, robot.view.graphs(0)));
  for (int i = 0; i < 8; ++i) {
    weigh(robot.model(), 2s + i * 250ms, {4 * i, 7});
    robot.models.until(morning + 2s + i * 250ms);
  }
  robot.now = morning + 3750ms;
  CHECK(robot.line("  weight").find(" ▁▂▃▄▅▆▇█ 100..107") != std::string::npos);
  // Where there is room for at least four values beside their range.
  CHECK(robot.line("  weight", {41, 24}).ends_with(" ▁▃▆█ 100..107"));
  CHECK(robot.line("  weight", {40, 24}).find("..") == std::string::npos);
  // It stays when its row is closed.
  robot.view.press(letter("-"));
  CHECK(robot.names() == Names{"scale", "  weight", "lamp_1", "7FF"});
  robot.view = View{false};
  robot.draw();
  robot.view.press(Key{Kind::home});
  robot.view.press(letter(" "));
  CHECK(robot.line("  weight").find(" _.-:=+*# 100..107") != std::string::npos);
  CHECK(robot.names() == Names{"scale", "  weight", "  state", "lamp_1", "7FF"});
  robot.view.press(letter(" "));
  CHECK(robot.names() == Names{"scale", "lamp_1", "7FF"});
}

TEST_CASE("top: a graph is empty where there was no value yet") {
  Robot robot;
  robot.models = Models{catalogue, 250'000};
  robot.models.of("can0");
  robot.view.press(letter("a"));
  robot.draw();
  robot.view.press(Key{Kind::home});
  robot.view.press(letter(" "));
  CHECK(robot.models.follow(0, robot.view.graphs(0)));
  robot.models.until(morning);
  robot.models.until(morning + 250ms);
  weigh(robot.model(), 300ms, {4, 0});
  robot.models.until(morning + 500ms);
  weigh(robot.model(), 600ms, {8, 0});
  robot.models.until(morning + 750ms);
  robot.now = morning + 750ms;
  CHECK(robot.line("  weight") == "  weight          102 g       ▁█ 101..102");
}

TEST_CASE("top: on a screen that becomes higher a list is shown up to its end") {
  Robot robot;
  for (std::uint32_t id = 0x740; id < 0x780; ++id) robot.model().take(entry(1990ms, id, {1}));
  robot.draw();
  robot.view.press(Key{Kind::end});
  robot.draw();
  const auto lines = robot.draw({80, 40});  // 67 rows, of which 35 have a line
  REQUIRE(lines.size() == 40);
  CHECK(lines[4].starts_with("75D "));
  CHECK(lines[38].starts_with("77F "));
  const auto low = robot.draw();
  CHECK(low[22].starts_with("77F "));
}

TEST_CASE("top: a list that is longer than the screen follows the cursor") {
  Robot robot;
  for (std::uint32_t id = 0x740; id < 0x780; ++id) robot.model().take(entry(1990ms, id, {1}));
  CHECK(robot.names().size() == 19);  // 24 lines, 4 above and 1 below
  CHECK(robot.names().front() == "scale");
  robot.view.press(Key{Kind::end});
  CHECK(robot.names().back() == "77F");
  robot.view.press(Key{Kind::up});
  CHECK(robot.names().back() == "77F");
  robot.view.press(Key{Kind::page_up});
  robot.view.press(Key{Kind::page_up});
  robot.view.press(letter("k"));
  CHECK(robot.names().front() == "759");
  robot.view.press(Key{Kind::home});
  CHECK(robot.names().front() == "scale");
  robot.view.press(Key{Kind::page_down});
  robot.view.press(letter("j"));
  CHECK(robot.names().back() == "750");
  // A click in the first line of the list.
  robot.view.press(Key{Kind::click, {}, 4});
  robot.view.press(letter("k"));
  CHECK(robot.names().front() == "scale");
}

TEST_CASE("top: a list that was empty begins again, and goes as far as the cursor is in sight") {
  Robot robot;
  for (std::uint32_t id = 0x740; id < 0x780; ++id) robot.model().take(entry(1990ms, id, {1}));
  robot.draw();
  robot.view.press(Key{Kind::end});
  robot.draw();
  robot.view.press(Key{Kind::page_up});
  CHECK(robot.names().front() == "76D");  // the cursor is there
  for (const char* text : {"/", "q"}) robot.view.press(letter(text));
  CHECK(robot.names() == Names{"no"});  // no name has these letters
  robot.view.press(Key{Kind::escape});
  const Names names = robot.names();
  CHECK(names.front() == "75B");
  CHECK(names.back() == "76D");
}

TEST_CASE("top: topics that were asked for, and all of the spec") {
  Robot robot;
  robot.view.press(letter("a"));
  CHECK(robot.names() == Names{"scale", "lamp_1", "lamp_2", "lamp_3", "7FF"});
  CHECK(robot.line("lamp_3") == "lamp_3        -      -      -      - nothing came");
  robot.view.press(letter("a"));
  robot.view.only({&catalogue.topics[3], &catalogue.topics[0]});
  CHECK(robot.names() == Names{"scale", "lamp_3"});
}

TEST_CASE("top: a topic of which frames came and no whole sample says so, with its load") {
  const auto high = [](std::uint8_t number) {
    return ocm::protocol::Identifier{ocm::protocol::Direction::sensor, ocm::protocol::Priority::high,
                                     ocm::protocol::TopicId{number}}
        .encode();
  };
  Robot robot;
  robot.models = Models{catalogue, 250'000};
  robot.model().take(entry(1s, high(0x10), {0, 0, 0, 1}));
  CHECK(robot.line("scale") == "scale         -      -      -  <0.1% no whole sample yet");
  for (int i = 1; i < 5; ++i) robot.model().take(entry(1s + i * 100ms, high(0x10), {0, 0, 0, 1}));
  CHECK(robot.line("scale") == "scale         -      -      -   0.2% no whole sample, 3 incomplete");
  robot.models = Models{catalogue, 250'000};
  robot.model().take(entry(1s, high(0x10), {0, 0}));
  CHECK(robot.line("scale") == "scale         -      -      -  <0.1% no sample, 1 frame of a wrong length");
  weigh(robot.model(), 1900ms, {4, 0});
  CHECK(robot.line("scale").find("weight 101 g") != std::string::npos);
}

TEST_CASE("top: keys for the program") {
  Robot robot;
  robot.draw();
  using Effect = ocm::cli::top::Effect;
  CHECK(robot.view.press(letter("q")).kind == Effect::Kind::quit);
  CHECK(robot.view.press(Key{Kind::function, {}, 10}).kind == Effect::Kind::quit);
  CHECK(robot.view.press(letter("p")).kind == Effect::Kind::pause);
  CHECK(robot.view.press(Key{Kind::left}).by == -10s);
  CHECK(robot.view.press(letter(".")).by == 1s);
  CHECK(robot.view.press(letter("]")).kind == Effect::Kind::faster);
  CHECK(robot.view.press(letter("0")).kind == Effect::Kind::rewind);
  // Any key leaves the help, and does nothing else.
  robot.view.press(letter("?"));
  CHECK(robot.draw()[0].starts_with("Up Down"));
  CHECK(robot.view.press(letter("q")).kind == Effect::Kind::none);
  CHECK(robot.draw()[0] == "can0 example");
}

TEST_CASE("top: the bar of a log") {
  Robot robot;
  robot.playing = Playing{15s, 60s, 2, false};
  const std::string bar = robot.draw()[22];
  CHECK(bar.starts_with("15.0 of 60.0 s [====="));
  CHECK(bar.ends_with("] x2"));
  CHECK(std::count(bar.begin(), bar.end(), '=') == 15);
  robot.playing = Playing{0s, 0s, 1, true};
  CHECK(robot.draw({40, 24})[22].ends_with(" end"));
  // With less room than for five columns there is none.
  robot.playing = Playing{0s, 0s, 1, false};
  CHECK(robot.draw({23, 24})[22] == "0.0 of 0.0 s [=====] x1");
  CHECK(robot.draw({22, 24})[22] == "0.0 of 0.0 s  x1");
}

TEST_CASE("top: several buses have a line each, and their name before each row") {
  Robot robot;
  weigh(robot.models.of("can1"), 1s, {0, 0});
  const auto lines = robot.draw();
  CHECK(lines[1].starts_with("can0 ["));
  CHECK(lines[3].starts_with("can1 ["));
  CHECK_FALSE(robot.line("can0:scale").empty());
  CHECK_FALSE(robot.line("can1:scale").empty());
}

TEST_CASE("top: of two buses a name filters their rows, and the cursor stays on its bus") {
  Robot robot;
  weigh(robot.models.of("can1"), 1900ms, {0, 0});
  robot.draw();
  for (const char* text : {"/", "N", "1"}) robot.view.press(letter(text));
  robot.view.press(Key{Kind::enter});
  CHECK(robot.line("can0:").empty());
  CHECK_FALSE(robot.line("can1:scale").empty());
  robot.view.press(Key{Kind::escape});
  CHECK_FALSE(robot.line("can0:scale").empty());
  const auto below = [&robot](std::string_view row) {
    const auto lines = robot.draw();
    const auto at = std::find_if(lines.begin(), lines.end(),
                                 [row](const std::string& line) { return line.starts_with(row); });
    return at == lines.end() || at + 1 == lines.end() ? std::string{} : *(at + 1);
  };
  robot.view.press(Key{Kind::end});
  robot.view.press(Key{Kind::enter});
  CHECK(below("can1:scale").starts_with("  weight"));
  robot.view.press(Key{Kind::down});
  robot.view.press(letter("-"));
  CHECK(below("can1:scale").empty());
  robot.view.press(letter("+"));
  CHECK(below("can0:scale").starts_with("can0:lamp_1"));
  CHECK(below("can1:scale").starts_with("  weight"));
}

TEST_CASE("top: whatever is pressed, it draws") {
  std::mt19937 random{16};
  Robot robot;
  robot.playing = Playing{1s, 2s, 1, false};
  const std::vector<std::string> texts{"/", " ", "+", "-", "*", "a", "<", ">", "I",
                                       "p", "?", "j", "k", "g", "G", "e", "ä"};
  for (int i = 0; i < 20'000; ++i) {
    Key key{static_cast<Kind>(random() % 14), {}, static_cast<unsigned>(random() % 30)};
    if (key.kind == Kind::character || random() % 2 == 0) key = letter(texts[random() % texts.size()]);
    robot.view.press(key);
    if (i % 10 == 0) weigh(robot.model(), 2s + i * 1ms, {i, i % 2 == 0 ? std::uint8_t{7} : std::uint8_t{0}});
    robot.now = morning + 2s + i * 1ms;
    if (i % 5 != 0) continue;
    const TerminalSize size{1 + random() % 130, 2 + random() % 40};
    const auto lines = robot.draw(size);
    REQUIRE(lines.size() == size.rows);
    for (const auto& line : lines) REQUIRE(columns(line) <= size.columns);
  }
}

}  // namespace top_view_test
