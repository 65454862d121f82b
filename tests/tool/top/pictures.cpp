// Whole pictures with their styles.
#include <algorithm>
#include <sstream>

#include <catch2/catch.hpp>

#include "ocm/can/error_frame.hpp"

#include "cli/top/short_number.hpp"
#include "cli/top/view.hpp"
#include "tests/tool/golden.hpp"
#include "tool/bus_model/bus.hpp"

namespace top_pictures_test {

using namespace ocm::test;
using namespace ocm::cli::top;
using ocm::cli::TerminalSize;
using Kind = Key::Kind;

Key letter(std::string text) {
  return {Kind::character, std::move(text)};
}

std::string_view name(Style style) {
  switch (style) {
    case Style::plain:
      return "";
    case Style::bold:
      return "bold";
    case Style::dim:
      return "dim";
    case Style::good:
      return "good";
    case Style::warning:
      return "warning";
    case Style::bad:
      return "bad";
    case Style::heading:
      return "heading";
    case Style::sorted:
      return "sorted";
    case Style::selected:
      return "selected";
  }
  return "";
}

/// Each line, and below it where which style begins.
std::string shown(const Picture& picture) {
  std::string text;
  for (const Line& line : picture) {
    std::string words, styles;
    for (const auto& piece : line) {
      words += piece.text;
      styles += std::string{styles.empty() ? "" : ","} +
                (name(piece.style).empty() ? "plain" : std::string{name(piece.style)}) + ":" +
                std::to_string(ocm::base::columns(piece.text));
    }
    text += "|" + words + "|\n" + (styles.empty() ? "" : "    " + styles + "\n");
  }
  return text;
}

/// A scale that should come ten times a second, a lamp and a stranger; a controller that has seen errors.
struct Bus2 {
  Bus2() {
    models.of("can0");
    ask(model(), -100ms, ocm::protocol::Mode::publish, {100, ocm::protocol::PeriodUnit::milliseconds});
    for (int i = 0; i < 30; ++i)
      weigh(model(), i * 100ms + (i % 3 == 0 ? 4ms : 0ms),
            {i < 25 ? 4 * i : 96, i < 20 ? std::uint8_t{0} : std::uint8_t{129}});
    const auto lamp = ocm::protocol::Identifier{ocm::protocol::Direction::command,
                                                ocm::protocol::Priority::low, ocm::protocol::TopicId{0x30}};
    for (int i = 0; i < 4; ++i) model().take(entry(i * 500ms, lamp.encode(), {42}));
    for (int i = 0; i < 40; ++i) model().take(entry(2s + i * 20ms, 0x7FF, {0xDE, 0xAD, i}));
    model().take(entry(2900ms, 0x18FF0001, {1, 2, 3, 4, 5, 6, 7, 8}, ocm::can::Format::extended));
    buses = models.buses();
  }
  Model& model() { return models.of("can0"); }
  std::string draw(TerminalSize size, ocm::base::Duration at = 3s) {
    scene.robot = "example";
    scene.source = "can0";
    buses = models.buses();
    scene.buses = buses;
    scene.now = morning + at;
    return shown(view.draw(scene, size));
  }
  void press(std::initializer_list<Key> keys, TerminalSize size = {100, 24}) {
    for (const Key& key : keys) {
      static_cast<void>(draw(size));
      static_cast<void>(view.press(key));
    }
  }
  Models models{catalogue, 250'000};
  View view{true};
  std::vector<ocm::cli::bus_model::Bus> buses;
  Scene scene;
};

TEST_CASE("top pictures: rows, at several widths") {
  std::string all;
  for (const std::size_t width : {130U, 100U, 80U, 60U, 40U, 20U}) all += Bus2{}.draw({width, 10});
  is_as_in("tests/tool/top/golden/rows.txt", all);
}

TEST_CASE("top pictures: what is late, what is missing, and what else the first line says") {
  std::string all;
  for (const auto at : {3060ms, 3070ms, 3200ms, 3210ms, 20000ms}) all += Bus2{}.draw({120, 9}, at);
  Bus2 bus;
  bus.scene.paused = bus.scene.waiting = true;
  bus.press({letter(">"), letter(">"), letter("I"), letter("/"), letter("l")});
  all += bus.draw({120, 9});
  bus.press({Key{Kind::enter}});
  all += bus.draw({120, 9});
  bus.scene.message = "the log is damaged";
  all += bus.draw({120, 9});
  bus.press({letter("/"), letter("x"), letter("y")});
  all += bus.draw({120, 9});
  is_as_in("tests/tool/top/golden/first_line.txt", all);
}

TEST_CASE("top pictures: frames of no whole sample are a warning, what never came or is selected is none") {
  Bus2 bus;
  bus.models = Models{catalogue, 250'000};
  for (int i = 0; i < 5; ++i) bus.model().take(entry(2500ms + i * 100ms, 0x510, {0, 0, 0, 1}));
  bus.press({letter("a")});
  const auto styles_of = [&bus](const std::string& row) {
    std::istringstream lines{bus.draw({120, 9})};
    std::string styles;
    for (std::string line; styles.empty() && std::getline(lines, line);)
      if (line.starts_with("|" + row + " ")) std::getline(lines, styles);
    return styles;
  };
  // Its faults, and "no whole sample, 3 incomplete".
  CHECK(styles_of("scale") == "    bold:9,plain:7,dim:7,plain:7,dim:15,warning:7,dim:10,warning:29");
  CHECK(styles_of("lamp_2") == "    bold:9,plain:7,dim:7,plain:7,dim:44");
  bus.press({Key{Kind::home}});
  CHECK(styles_of("scale") == "    selected:120");
  CHECK(styles_of("lamp_2") == "    bold:9,plain:7,dim:7,plain:7,dim:44");
  bus.press({Key{Kind::down}, Key{Kind::down}});
  CHECK(styles_of("lamp_2") == "    selected:120");
}

TEST_CASE("top pictures: in each order, and reversed") {
  std::string all;
  Bus2 bus;
  for (std::size_t i = 0; i <= sorts.size(); ++i) {
    for (int reversed = 0; reversed < 2; ++reversed) {
      std::istringstream lines{bus.draw({80, 9})};
      for (std::string line; std::getline(lines, line);)
        if (line.starts_with("|")) all += line.substr(0, 10) + "\n";
      bus.press({letter("I")});
    }
    all += "\n";
    bus.press({letter("<")});
  }
  is_as_in("tests/tool/top/golden/orders.txt", all);
}

TEST_CASE("top pictures: an open row, its fields, and their graphs") {
  std::string all;
  Bus2 bus;
  bus.press({Key{Kind::home}, Key{Kind::enter}});
  all += bus.draw({100, 12});
  all += bus.draw({100, 12}, 3900ms);
  all += bus.draw({100, 12}, 5s);
  for (const std::size_t width : {70U, 46U, 30U}) all += bus.draw({width, 12}, 5s);
  bus.press({Key{Kind::down}, letter(" ")});
  all += bus.draw({100, 12}, 5s);  // nothing was kept yet
  bus.models.follow(0, bus.view.graphs(0));
  for (int i = 0; i < 12; ++i) {
    weigh(bus.model(), 5s + i * 250ms, {i < 6 ? 4 * i : -4 * i, 1});
    bus.models.until(morning + 5s + i * 250ms);
  }
  for (const std::size_t width : {100U, 60U, 52U, 46U}) all += bus.draw({width, 12}, 7800ms);
  bus.press({Key{Kind::down}});
  all += bus.draw({100, 12}, 7800ms);
  is_as_in("tests/tool/top/golden/fields.txt", all);
}

TEST_CASE("top pictures: the bar of a log, and two buses") {
  std::string all;
  Bus2 bus;
  for (const auto& playing : {Playing{0s, 90s, 1, false}, Playing{45s, 90s, 0.5, false},
                              Playing{90s, 90s, 64, true}, Playing{0s, 0s, 1, false}}) {
    bus.scene.playing = playing;
    all += bus.draw({80, 10});
  }
  bus.scene.paused = true;
  all += bus.draw({40, 10});
  all += bus.draw({26, 10});
  weigh(bus.models.of("can1"), 2950ms, {-1, 0});
  bus.models.lost("can1", 7);
  all += bus.draw({110, 14});
  all += bus.draw({50, 14});
  is_as_in("tests/tool/top/golden/log.txt", all);
}

TEST_CASE("top pictures: how loaded the bus is, and what its controller says") {
  std::string all;
  for (const int frames : {10, 800, 1100, 1400, 1800}) {
    Bus2 bus;
    for (int i = 0; i < frames; ++i)
      bus.model().take(entry(2s + i * 1s / frames, 0x7FE, {0, 0, 0, 0, 0, 0, 0, 0}));
    all += bus.draw({100, 4}, 3s);
  }
  Bus2 bus;
  using State = ocm::can::ControllerState;
  for (const State state : {State::active, State::warning, State::passive, State::bus_off}) {
    bus.model().controller_is(state, ocm::can::ErrorCounters{static_cast<std::uint8_t>(state), 9});
    all += bus.draw({100, 4});
  }
  bus.models = Models{catalogue, 0};
  weigh(bus.model(), 2900ms, {1, 0});
  all += bus.draw({100, 6});
  is_as_in("tests/tool/top/golden/load.txt", all);
}

TEST_CASE("top pictures: what was counted of a bus, of one and of several") {
  namespace cls = ocm::can::error_class;
  namespace what = ocm::can::controller_error;
  using ocm::can::Format;
  // A broadcast of 17 bytes in three packets. [SAE J1939-21, figure C3]
  ocm::protocol::Field last;
  last.name = "last";
  last.position = {128, 8};
  ocm::protocol::FrameLayout layout;
  layout.length = 20;
  layout.fields = {&last, 1};
  layout.address = {ocm::protocol::Address::By::pgn, true, 0x18FEECFE};
  ocm::protocol::Topic group;
  group.name = "VI";
  group.board = ocm::protocol::no_board;
  group.kind = ocm::protocol::Kind::message;
  group.frames = {&layout, 1};
  ocm::protocol::Catalogue truck;
  truck.robot = "truck";
  truck.topics = {&group, 1};

  Bus2 bus;
  const auto start_again = [&bus] { bus.models = Models{catalogue, 250'000}; };
  const auto counted = [&bus] {  // below the load, with its styles
    std::istringstream lines{bus.draw({200, 6})};
    std::string line, styles;
    for (int i = 0; i < 5; ++i) std::getline(lines, line);
    std::getline(lines, styles);
    return line + styles;
  };
  const auto overflow = [&bus] {
    bus.model().take(entry(2s, cls::controller, {0, what::rx_overflow, 0, 0, 0, 0, 0, 0}, Format::error));
  };
  start_again();
  overflow();
  CHECK(counted() == "|1 frame  1 error frame  1 overflow|    dim:7,bad:27");
  overflow();
  bus.models.lost("can0", 1);
  CHECK(counted() == "|2 frames  2 error frames  2 overflows  1 lost|    dim:8,bad:37");
  start_again();  // counters without a state
  bus.model().take(entry(2s, cls::counters, {0, 0, 0, 0, 0, 0, 104, 3}, Format::error));
  CHECK(counted() == "|TEC 104 REC 3  1 frame  1 error frame|    dim:22,bad:15");
  start_again();
  for (int i = 0; i < 5; ++i) bus.model().take(entry(2500ms + i * 100ms, 0x510, {0, 0, 0, 1}));
  CHECK(counted() == "|5 frames  3 incomplete|    dim:8,warning:14");
  start_again();
  bus.model().take(entry(2s, 0x510, {0, 0}));
  CHECK(counted() == "|1 frame  1 of a wrong length|    dim:7,warning:21");
  start_again();
  ocm::can::AnyFrame fd;
  fd.id = 0x7F0;
  fd.length = 12;
  fd.flags = ocm::can::frame_flag::fd | ocm::can::frame_flag::bit_rate_switch;
  bus.model().take(ocm::log::Entry{morning + 2s, fd});
  CHECK(counted() == "|1 frame  1 unknown  1 CAN FD, not in the load|    dim:45");
  start_again();
  for (std::uint32_t id = 0; id <= Model::most_unknown; ++id)
    bus.model().take(entry(2s, 0x100'0000 + id, {}, Format::extended));
  CHECK(counted() ==
        "|1025 frames  1025 unknown  1 of more identifiers than are shown|    dim:25,warning:38");

  bus.models = Models{truck, 250'000};
  const auto broadcast = [&bus](ocm::base::Duration at, int packets) {
    bus.model().take(entry(at, 0x1CECFF00, {0x20, 17, 0, 3, 0xFF, 0xEC, 0xFE, 0}, Format::extended));
    for (int i = 1; i <= packets; ++i)
      bus.model().take(entry(at + i * 50ms, 0x1CEBFF00, {i, 0, 0, 7, 0, 0, 0, 0}, Format::extended));
  };
  broadcast(0s, 3);
  CHECK(counted() == "|4 frames  1 message put together|    dim:32");
  broadcast(1s, 2);  // followed by the next before its end
  broadcast(2s, 3);
  CHECK(counted() == "|11 frames  2 messages put together  1 not put together|    dim:34,warning:20");
}

TEST_CASE("top pictures: nothing came, and the help") {
  Bus2 bus;
  bus.models = Models{catalogue, 250'000};
  bus.models.of("can0");
  std::string all = bus.draw({80, 8});
  bus.press({letter("/"), letter("q"), Key{Kind::enter}});
  all += bus.draw({80, 8});
  bus.press({letter("?")});
  all += bus.draw({100, 20});
  all += bus.draw({60, 20});
  all += bus.draw({60, 5});
  is_as_in("tests/tool/top/golden/help.txt", all);
}

TEST_CASE("top pictures: a click chooses a row, and none beside them does") {
  const auto chosen = [](unsigned line, bool long_list = false) {
    Bus2 bus;
    for (std::uint32_t id = 0x700; long_list && id < 0x714; ++id) bus.model().take(entry(2990ms, id, {1}));
    bus.press({Key{Kind::click, {}, line}}, {80, 10});
    std::istringstream lines{bus.draw({80, 10})};
    std::string before;
    for (std::string text; std::getline(lines, text);) {
      if (text.find("selected:") != std::string::npos) return before.substr(1, before.find(' ') - 1);
      before = text;
    }
    return std::string{"none"};
  };
  CHECK(chosen(3) == "none");  // the heading
  CHECK(chosen(4) == "scale");
  CHECK(chosen(5) == "lamp_1");
  CHECK(chosen(7) == "18FF0001");
  CHECK(chosen(8) == "none");  // below the last
  CHECK(chosen(9) == "none");
  // Of a list that is longer than the screen the last line in sight, and not the keys below it.
  CHECK(chosen(8, true) == "700");
  CHECK(chosen(9, true) == "none");
}

TEST_CASE("top pictures: pages, and the ends of the list") {
  const auto in_view = [](std::initializer_list<Key> keys) {
    Bus2 bus;
    for (std::uint32_t id = 0x700; id < 0x714; ++id) bus.model().take(entry(2990ms, id, {1}));
    bus.press(keys, {80, 10});
    std::istringstream lines{bus.draw({80, 10})};
    std::vector<std::string> rows;
    for (std::string text; std::getline(lines, text);)
      if (text.starts_with("|")) rows.push_back(text.substr(1, text.find(' ') - 1));
    return rows[4] + ".." + rows[8];
  };
  const Key down{Kind::down}, up{Kind::up}, next{Kind::page_down}, back{Kind::page_up}, end{Kind::end};
  CHECK(in_view({}) == "scale..700");
  CHECK(in_view({down}) == "scale..700");  // it shows the cursor, in the first line
  CHECK(in_view({down, down, down, down, down}) == "scale..700");
  CHECK(in_view({down, down, down, down, down, down}) == "lamp_1..701");
  CHECK(in_view({down, next}) == "scale..700");
  CHECK(in_view({down, next, next}) == "700..704");
  CHECK(in_view({end, back}) == in_view({end}));
  CHECK(in_view({end, back, up}) == "70D..712");
  CHECK(in_view({end, next, down}) == "70E..713");
  CHECK(in_view({end, letter("g")}) == "scale..700");
  CHECK(in_view({letter("G"), letter("k"), letter("j")}) == "70E..713");
}

TEST_CASE("top pictures: other keys of the same meaning, and keys that mean nothing") {
  Bus2 bus;
  using Effects = Effect::Kind;
  const auto effect = [&](const Key& key) { return bus.view.press(key); };
  static_cast<void>(bus.draw({80, 10}));
  CHECK(effect(letter("Z")).kind == Effects::pause);
  CHECK(effect(letter(",")).by == -1s);
  CHECK(effect(letter(".")).by == 1s);
  CHECK(effect(Key{Kind::left}).by == -10s);
  CHECK(effect(Key{Kind::right}).by == 10s);
  CHECK(effect(letter("[")).kind == Effects::slower);
  CHECK(effect(letter("]")).kind == Effects::faster);
  CHECK(effect(letter("0")).kind == Effects::rewind);
  for (const Key& key :
       {letter("qq"), letter("x"), Key{Kind::tabulator}, Key{Kind::function, {}, 2}, Key{Kind::backspace}})
    CHECK(effect(key).kind == Effects::none);
  CHECK(bus.draw({80, 10}) == Bus2{}.draw({80, 10}));
  for (const Key& key : {letter("h"), letter("?"), Key{Kind::function, {}, 1}}) {
    static_cast<void>(effect(key));
    CHECK(bus.draw({80, 10}).starts_with("|Up Down"));
    static_cast<void>(effect(key));
  }
  for (const Key& key : {letter("/"), letter("\\"), Key{Kind::function, {}, 3}, Key{Kind::function, {}, 4}}) {
    static_cast<void>(effect(key));
    CHECK(bus.draw({80, 10}).find("|/_ ") != std::string::npos);
    static_cast<void>(effect(Key{Kind::escape}));
  }
}

TEST_CASE("top pictures: a row's graphs are drawn or taken away together") {
  Bus2 bus;
  const auto graphs = [&] { return bus.view.graphs(0).size(); };
  bus.press({Key{Kind::home}, Key{Kind::enter}, Key{Kind::down}, letter(" ")});
  CHECK(graphs() == 1);
  bus.press({Key{Kind::home}, letter(" ")});
  CHECK(graphs() == 2);  // one was there already
  bus.press({letter(" ")});
  CHECK(graphs() == 0);
  bus.press({letter(" "), Key{Kind::down}, letter(" ")});
  CHECK(graphs() == 1);
}

TEST_CASE("top: times that are short") {
  CHECK(short_time(0ns) == "0us");
  CHECK(short_time(-1ns) == "-0us");
  CHECK(short_time(500ns) == "0us");
  CHECK(short_time(-1500us) == "-1.5ms");
  CHECK(short_time(9949us) == "9.9ms");
  CHECK(short_time(9950us) == "10ms");
}

}  // namespace top_pictures_test
