#include "ocm/mapper/link/central.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/demultiplexer.hpp"

#include "unit/base/random.hpp"

namespace mapper_link_central_test {

using namespace ocm::mapper::link;
using ocm::base::Error;

constexpr Address a{0xC0, 0, 0, 0, 0, 0x0A};
constexpr Address b{0xC0, 0, 0, 0, 0, 0x0B};
constexpr Address c{0xC0, 0, 0, 0, 0, 0x0C};
constexpr Address d{0xC0, 0, 0, 0, 0, 0x0D};

/// Writes down what the central does: text as it is, calls of the radio in angle brackets.
struct Recorder {
  std::string said;
  void say(std::string_view text) { said += text; }
  void start_scan() { said += "<scan>"; }
  void stop_scan() { said += "<no scan>"; }
  void connect(const Address& address) { said += std::string{"<connect "} + name(address) + ">"; }
  void disconnect(const Address& address) { said += std::string{"<disconnect "} + name(address) + ">"; }
  void restart() { said += "<restart>"; }
  static char name(const Address& address) { return static_cast<char>('a' + (address[5] - 0x0A)); }
};

/// Counts what it is asked for: the compiler can, too.
struct Counter {
  int said = 0, asked = 0;
  constexpr void say(std::string_view) { ++said; }
  constexpr void start_scan() { ++asked; }
  constexpr void stop_scan() { ++asked; }
  constexpr void connect(const Address&) { ++asked; }
  constexpr void disconnect(const Address&) { ++asked; }
  constexpr void restart() { ++asked; }
};
constexpr bool a_session() {
  Central<> central;
  Counter port;
  const auto type = [&](std::string_view text) {
    for (const char character : text) central.feed(character, port);
  };
  type("start\n");
  central.found(a, "AVR", port);
  type("conn 0\n{U,90,130}\n{S,PAU}\n");
  central.connected(a, port);
  const auto first = central.take(a);
  central.closed(a, port);
  type("*reset\n");
  return first.ok() && first->size == 11 && first->data[3] == '9' &&
         central.counters().dropped_packets == 1 && port.said == 6 && port.asked == 4;
}
static_assert(a_session());

template <std::size_t Robots = 8, std::size_t Links = 3, std::size_t Waiting = 8>
struct Bench {
  Central<Robots, Links, Waiting> central;
  Recorder port;

  std::string type(std::string_view text) {
    for (const char character : text) central.feed(character, port);
    return std::exchange(port.said, {});
  }
  void found(const Address& address, std::string_view name) { central.found(address, name, port); }
  std::string connected(const Address& address) {
    central.connected(address, port);
    return std::exchange(port.said, {});
  }
  std::string closed(const Address& address) {
    central.closed(address, port);
    return std::exchange(port.said, {});
  }
  std::string heard(const Address& address, std::string_view text) {
    std::vector<std::uint8_t> bytes{text.begin(), text.end()};
    central.heard(address, bytes, port);
    return std::exchange(port.said, {});
  }
  /// All that waits for a robot, as text, a bar behind each packet.
  std::string taken(const Address& address) {
    std::string out;
    while (const auto packet = central.take(address)) {
      for (const std::uint8_t byte : packet->bytes()) out += static_cast<char>(byte);
      out += '|';
    }
    return out;
  }
  /// Two robots in the list, a connected and spoken to.
  void one_link() {
    (void)type("start\n");
    found(a, "AVR");
    found(b, "Arduino");
    (void)type("stop\nconn 0\n");
    (void)connected(a);
  }
};

TEST_CASE("central: the commands of table 4.2, in the order that the thesis asks for") {
  Bench<> bench;
  CHECK(bench.type("start\n") == "<scan>scanning\n");
  bench.found(a, "AVR");
  bench.found(b, "Arduino");
  bench.found(a, "AVR");  // advertises again
  CHECK(bench.type("list\n") == "0:C0000000000A:AVR\n1:C0000000000B:Arduino\nend of list\n");
  CHECK(bench.type("stop\n") == "<no scan>found 2\n");
  CHECK(bench.type("conn 0\n") == "<connect a>connecting 0\n");
  CHECK(bench.connected(a) == "connected 0\n");
  CHECK(bench.type("{S,CON}\n{U,90,130}\n").empty());
  CHECK(bench.taken(a) == "{S,CON}\n|{U,90,130}\n|");
  CHECK(bench.heard(a, "{S,IDL}\n") == "[0]:AVR:{S,IDL}\n");
  CHECK(bench.type("*") == "command\n");
  CHECK(bench.type("conn 1\n") == "<connect b>connecting 1\n");
  CHECK(bench.connected(b) == "connected 1\n");
  CHECK(bench.type("{S,CON}\n*switch 0\n{S,PAU}\n*switch 1\n{S,UNP}\n") ==
        "command\ndata 0\ncommand\ndata 1\n");
  CHECK(bench.taken(a) == "{S,PAU}\n|");
  CHECK(bench.taken(b) == "{S,CON}\n|{S,UNP}\n|");
  CHECK(bench.type("*drop 0\n") == "command\n<disconnect a>closing 0\n");  // [Thesis 2, appendix J]
  CHECK(bench.closed(a) == "closed 0\n");
  CHECK(bench.type("reset\n") == "<restart>reset\n");
  CHECK(bench.central.links() == 0);
  CHECK(bench.type("list\n") == "end of list\n");
  CHECK(bench.central.counters() == CentralCounters{});
}

TEST_CASE("central: what is not possible now is refused, and changes nothing") {
  Bench<> bench;
  CHECK(bench.type("list\n") == "end of list\n");
  CHECK(bench.type("stop\n") == "found 0\n");
  for (const std::string_view command : {"conn 0", "switch 0", "drop 0", "conn", "conn ", "conn x", "conn -1",
                                         "conn 0 ", "conn 99999999999999999999", "conn 256", "start now",
                                         "START", "{U,0,0}", "dropp 0", "a line that is longer"}) {
    INFO(command);
    const std::string answer = bench.type(std::string{command} + "\n");
    CHECK(answer.substr(0, 7) == "error: ");
    CHECK(answer.back() == '\n');
    CHECK(std::count(answer.begin(), answer.end(), '<') == 0);
  }
  CHECK(bench.central.counters().refused_commands == 15);
  CHECK(bench.type("\n\r\n**\n").empty());
  (void)bench.type("start\n");
  CHECK(bench.type("start\n") == "error: scans already\n");
  bench.found(a, "AVR");
  CHECK(bench.type("switch 0\n") == "error: no link to 0; conn first\n");
  CHECK(bench.type("drop 0\n") == "error: no link to 0\n");
  CHECK(bench.type("conn 0\r") == "<no scan><connect a>connecting 0\n");  // from a terminal
}

TEST_CASE("central: what is no command is refused in words, to the ends of what there is room for") {
  Bench<> bench;
  const std::string commands = "error: start, list, stop, conn i, switch i, drop i, *, reset\n";
  CHECK(bench.type("1234567890123456\n") == commands);
  CHECK(bench.type("12345678901234567\n") == "error: longer than any command\n");
  CHECK(bench.type("start now\n") == commands);
  for (const char* of_none : {"conn\n", "switch x\n", "drop -1\n"})
    CHECK(bench.type(of_none) == "error: an index is missing, as in conn 0\n");
  for (const char* of_another : {"conn 7\n", "conn 8\n"})  // the last that there is room for, and the next
    CHECK(bench.type(of_another) == "error: not in the list; see list\n");
}

TEST_CASE("central: one attempt at a time, no more links than there are, and none while it closes") {
  Bench<8, 2> bench;
  (void)bench.type("start\n");
  for (const Address& address : {a, b, c}) bench.found(address, "r");
  (void)bench.type("conn 0\n*");
  CHECK(bench.type("conn 1\n") == "error: still connecting to 0\n");
  CHECK(bench.type("conn 0\n*") == "data 0\ncommand\n");
  (void)bench.connected(a);
  CHECK(bench.type("conn 0\n*") == "data 0\ncommand\n");
  (void)bench.type("conn 1\n*");
  (void)bench.connected(b);
  CHECK(bench.type("conn 2\n") == "error: no more links than 2; drop one\n");
  (void)bench.type("drop 0\n");
  CHECK(bench.type("conn 0\n") == "error: still closing 0\n");
  CHECK(bench.type("drop 0\n") == "error: no link to 0\n");
  CHECK(bench.type("conn 2\n").substr(0, 6) == "error:");
  (void)bench.closed(a);
  CHECK(bench.type("conn 2\n") == "<connect c>connecting 2\n");
  CHECK(bench.central.links() == 2);
}

TEST_CASE(
    "central: what waits for a link that dies is dropped and counted, and the next connection does not hear "
    "it") {
  Bench<> bench;
  bench.one_link();
  (void)bench.type("{U,90,130}\n{U,90,60}\n{S,P");
  CHECK(bench.central.waiting() == 2);
  CHECK(bench.closed(a) == "lost 0\n");
  CHECK(bench.central.counters() == CentralCounters{.unsent_bytes = 4, .dropped_packets = 2});
  // Still in data mode: the rest of the line, and more, is no command, and goes nowhere.
  CHECK(bench.type("AU}\nreset\n").empty());
  CHECK(bench.central.counters().unsent_bytes == 4 + 4 + 6);
  CHECK(bench.type("*conn 0\n{S,CON}\n") == "command\n<connect a>connecting 0\n");
  (void)bench.connected(a);
  CHECK(bench.taken(a) == "{S,CON}\n|");
}

TEST_CASE(
    "central: what waits for an attempt that fails, or for a link that is dropped or reset, goes nowhere") {
  Bench<> bench;
  (void)bench.type("start\n");
  bench.found(a, "AVR");
  (void)bench.type("conn 0\n{S,CON}\n");
  CHECK(bench.taken(a).empty());  // no link yet
  CHECK(bench.closed(a) == "error: no link to 0\n");
  CHECK(bench.central.counters().dropped_packets == 1);
  (void)bench.type("*conn 0\n{S,CON}\n");
  (void)bench.connected(a);
  (void)bench.type("*drop 0\n");
  CHECK(bench.taken(a).empty());
  CHECK(bench.central.counters().dropped_packets == 2);
  (void)bench.closed(a);
  (void)bench.type("conn 0\n{S,CON}\n");
  (void)bench.connected(a);
  (void)bench.type("*reset\nstart\n");
  CHECK(bench.central.counters().dropped_packets == 3);
  bench.found(a, "AVR");
  (void)bench.type("conn 0\n");
  (void)bench.connected(a);
  CHECK(bench.taken(a).empty());
}

TEST_CASE("central: a reset ends a scan, too") {
  Bench<> bench;
  (void)bench.type("start\n");
  CHECK(bench.central.scanning());
  (void)bench.type("*reset\n");
  CHECK_FALSE(bench.central.scanning());
  bench.found(a, "AVR");
  CHECK(bench.central.counters().stray_reports == 1);
}

TEST_CASE("central: a link that is asked for ends a scan, too") {
  Bench<> bench;
  (void)bench.type("start\n");
  bench.found(a, "AVR");
  CHECK(bench.type("conn 0\n") == "<no scan><connect a>connecting 0\n");
  CHECK_FALSE(bench.central.scanning());
  CHECK(bench.type("*stop\n") == "command\nfound 1\n");
  CHECK(bench.type("start\n") == "<scan>scanning\n");
}

TEST_CASE("central: a full queue drops whole ends of lines, counted, and takes the next line again") {
  Bench<8, 3, 2> bench;
  bench.one_link();
  (void)bench.type("{S,PAU}\n{S,UNP}\n{U,90,130}\n");
  CHECK(bench.central.counters().unsent_bytes == 11);
  CHECK(bench.taken(a) == "{S,PAU}\n|{S,UNP}\n|");
  (void)bench.type("{S,CON}\n");
  CHECK(bench.taken(a) == "{S,CON}\n|");
  (void)bench.type(std::string(70, 'x') + "\n{}\n");
  CHECK(bench.taken(a) == std::string(20, 'x') + "|" + std::string(20, 'x') + "|");
  CHECK(bench.central.counters().unsent_bytes == 11 + 31 + 3);
}

TEST_CASE(
    "central: of a line whose beginning was refused the rest is refused, too, though there is room again") {
  Bench<8, 3, 1> bench;
  bench.one_link();
  (void)bench.type("{S,PAU}\n" + std::string(20, 'x'));
  CHECK(bench.taken(a) == "{S,PAU}\n|");
  (void)bench.type("yyy\n");
  CHECK(bench.taken(a).empty());
  CHECK(bench.central.counters().unsent_bytes == 24);
  (void)bench.type("{S,UNP}\n");
  CHECK(bench.taken(a) == "{S,UNP}\n|");
}

TEST_CASE("central: an index stays with its robot while it has a link, whatever is scanned") {
  Bench<2> bench;
  bench.one_link();
  (void)bench.type("*start\n");
  CHECK(bench.type("list\n") == "0:C0000000000A:AVR\nend of list\n");
  bench.found(c, "new");
  bench.found(d, "too many");
  CHECK(bench.type("list\n") == "0:C0000000000A:AVR\n1:C0000000000C:new\nend of list\n");
  CHECK(bench.central.counters().unlisted == 1);
  CHECK(bench.heard(a, "x") == "[0]:AVR:x");
}

TEST_CASE("central: reports about links that are none change nothing; a link that is not needed is ended") {
  Bench<> bench;
  bench.found(a, "AVR");  // without a scan
  CHECK(bench.closed(a).empty());
  CHECK(bench.heard(a, "x").empty());
  CHECK(bench.connected(a) == "<disconnect a>");
  CHECK(bench.central.counters().stray_reports == 4);
  bench.one_link();
  CHECK(bench.connected(a).empty());
  CHECK(bench.connected(b) == "<disconnect b>");
  (void)bench.type("*drop 0\n");
  CHECK(bench.connected(a) == "<disconnect a>");  // came too late
  CHECK(bench.heard(a, "x").empty());
  CHECK(bench.closed(a) == "closed 0\n");
}

TEST_CASE("central: a name cannot forge a prefix or a sentence") {
  Bench<> bench;
  (void)bench.type("start\n");
  bench.found(a, "]:x:{S,IDL}\n and so on");
  (void)bench.type("conn 0\n");
  (void)bench.connected(a);
  const std::string said = bench.heard(a, "{S,IDL}\n");
  Demultiplexer<1> ears;
  int heard = 0;
  for (const char character : said)
    heard += ears.feed(static_cast<std::uint8_t>(character)).kind == Kind::idle ? 1 : 0;
  CHECK(heard == 1);
  CHECK(ears.broken_prefixes() == 0);
  CHECK(ears.of_no_robot() == 0);
}

TEST_CASE("central: a packet longer than the radio's is passed on whole") {
  Bench<> bench;
  bench.one_link();
  const std::string text(53, 'y');
  CHECK(bench.heard(a, text) == "[0]:AVR:" + text);
}

TEST_CASE(
    "central: in any order of commands and reports each command has one answer, and no packet goes to a "
    "later link") {
  ocm::test::Random random{23};
  const Address addresses[] = {a, b, c, d};
  using Mode = Central<4, 3, 2>::Mode;
  Bench<4, 3, 2> bench;
  std::uint32_t link_of[4]{};  // counts the links of each robot
  int delivered = 0;
  for (int n = 0; n < 50'000; ++n) {
    const std::uint32_t i = random.below(4);
    const std::string index = std::to_string(i);
    const auto command = [&](const std::string& text) {
      const bool data = bench.central.mode() == Mode::data;
      const std::string answer = bench.type(text + "\n");
      REQUIRE(answer.empty() == data);
      if (!data && text != "list") REQUIRE(std::count(answer.begin(), answer.end(), '\n') == 1);
    };
    switch (random.below(12)) {
      case 0:
        command("start");
        break;
      case 1:
        command("list");
        break;
      case 2:
        command("stop");
        break;
      case 3:
        command("conn " + index);
        break;
      case 4:
        command("switch " + index);
        break;
      case 5:
        command("drop " + index);
        break;
      case 6:
        (void)bench.type("*");
        break;
      case 7:
        if (random.below(20) == 0) command("reset");
        break;
      case 8:
        bench.found(addresses[i], index);
        break;
      case 9:
        (void)bench.connected(addresses[i]);
        break;
      case 10:
        (void)bench.closed(addresses[i]);
        ++link_of[i];
        break;
      default: {
        // Says for which links it is meant: only those may hear it.
        std::string line = "=";
        for (const std::uint32_t link : link_of) line += std::to_string(link % 1000) + ' ';
        if (bench.central.mode() == Mode::data) (void)bench.type(line + "\n");
      }
    }
    REQUIRE(bench.central.links() <= 3);
    REQUIRE(bench.central.waiting() <= 3 * 2);
    if (random.below(3) == 0) {
      const std::string taken = bench.taken(addresses[i]);
      for (std::size_t begin = 0; begin < taken.size(); begin = taken.find('|', begin) + 1) {
        if (taken[begin] != '=') continue;  // a command, typed in data mode
        std::size_t position = begin + 1;
        for (std::uint32_t k = 0; k < i; ++k) position = taken.find(' ', position) + 1;
        REQUIRE(std::stoul(taken.substr(position)) == link_of[i] % 1000);
        ++delivered;
      }
    }
  }
  CHECK(delivered > 50);
  (void)bench.type("*reset\n");
  CHECK(bench.central.links() == 0);
  CHECK(bench.central.waiting() == 0);
  CHECK(bench.type("start\n") == "<scan>scanning\n");  // it never hangs
}

}  // namespace mapper_link_central_test
