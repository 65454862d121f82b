#include "ocm/mapper/server/central_stream.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace mapper_server_central_stream_test {

using namespace ocm::mapper::server;
using Kind = CentralLine::Kind;

/// The robots' stream, and what the central said, each line in angle brackets.
std::string parted(std::string_view text) {
  CentralStream stream;
  std::string robots, lines;
  for (const char c : text)
    stream.feed(
        c, [&](char robot) { robots += robot; },
        [&](const CentralLine& line) {
          lines += "<" + std::to_string(static_cast<int>(line.kind)) + ":" + std::to_string(line.index) +
                   ":" + std::string{line.text} + ">";
        });
  return robots + "|" + lines;
}
std::string said(Kind kind, unsigned index, std::string_view text = "") {
  return "<" + std::to_string(static_cast<int>(kind)) + ":" + std::to_string(index) + ":" +
         std::string{text} + ">";
}

TEST_CASE("central stream: lines of the central, word for word as mapper/link/central.hpp says them") {
  CHECK(parse_central_line("scanning").kind == Kind::scanning);
  CHECK(parse_central_line("found 2").kind == Kind::found);
  CHECK(parse_central_line("found 2").index == 2);
  CHECK(parse_central_line("end of list").kind == Kind::end_of_list);
  CHECK(parse_central_line("connecting 1").kind == Kind::connecting);
  CHECK(parse_central_line("connected 7").index == 7);
  CHECK(parse_central_line("closing 0").kind == Kind::closing);
  CHECK(parse_central_line("closed 0").kind == Kind::closed);
  CHECK(parse_central_line("lost 0").kind == Kind::lost);
  CHECK(parse_central_line("data 2").kind == Kind::data);
  CHECK(parse_central_line("command").kind == Kind::command);
  CHECK(parse_central_line("reset").kind == Kind::reset);
  const CentralLine listed = parse_central_line("12:C0000000000A:my robot");
  CHECK(listed.kind == Kind::listed);
  CHECK(listed.index == 12);
  CHECK(listed.address == "C0000000000A");
  CHECK(listed.text == "my robot");
  CHECK(parse_central_line("error: no link to 3").index == 3);
}

TEST_CASE("central stream: what only looks like a line of the central") {
  for (const char* text :
       {"", "found", "found x", "found 1 2", "connected", "connected -1", "commando", "data 999",
        "0:C000:AVR", "x:C0000000000A:AVR", "0:C0000000000G:AVR", "0:C0000000000A:", "300:C0000000000A:a"})
    CHECK(parse_central_line(text).kind == Kind::unknown);
}

TEST_CASE("central stream: numbers of lines, to their ends") {
  for (const char* text :
       {"found 0", "found 256", "data 0", "closed 255", "0:C0000000000A:a", "255:C0000000000A:a"})
    CHECK(parse_central_line(text).kind != Kind::unknown);
  for (const char* text : {"found 257", "closed 257", "256:C0000000000A:a", ":C0000000000A:a"})
    CHECK(parse_central_line(text).kind == Kind::unknown);
  CHECK(parse_central_line("error: no link to 255; conn first").index == 255);
  CHECK(parse_central_line("error: no link to 256").index == 0);
  CHECK(parse_central_line("error: no link to any").index == 0);
  CHECK(parse_central_line("error: 7 is no robot").index == 0);
}

TEST_CASE("central stream: 80 characters may be a line of the central, 81 are none") {
  const std::string longest(80, 'x');
  CHECK(parted("[0]:A:" + longest) == "[0]:A:|");
  CHECK(parted("[0]:A:" + longest + "x") == "[0]:A:" + longest + "x|");
  for (const char* of : {"a", "z"})  // the first and the last small letter begin one
    CHECK(parted(std::string{"[0]:A:"} + of) == "[0]:A:|");
  for (const char* of : {"`", "{"})
    CHECK(parted(std::string{"[0]:A:"} + of) == std::string{"[0]:A:"} + of + "|");
}

TEST_CASE("central stream: an answer behind half a packet, and the packet's other half behind it") {
  CHECK(parted("[0]:AVR:{U,1,2,3,4,5,6connected 1\n[0]:AVR:,7,8}\n") ==
        "[0]:AVR:{U,1,2,3,4,5,6[0]:AVR:,7,8}\n|" + said(Kind::connected, 1));
}

TEST_CASE("central stream: names in prefixes have small letters") {
  CHECK(parted("[1]:command:{S,IDL}\nfound 2\n") == "[1]:command:{S,IDL}\n|" + said(Kind::found, 2));
}

TEST_CASE("central stream: the list is read behind a line of the central, and nowhere else") {
  CHECK(parted("[0]:A:,0,0found 1\n0:C0000000000A:AVR\nend of list\n[0]:A:}\n") ==
        "[0]:A:,0,0[0]:A:}\n|" + said(Kind::found, 1) + said(Kind::listed, 0, "AVR") +
            said(Kind::end_of_list, 0));
  // A robot's digits stay a robot's.
  CHECK(parted("[0]:A:,0,00:C0000000000A:AVR\n") == "[0]:A:,0,00:C0000000000A:AVR\n|");
}

TEST_CASE("central stream: small letters that are no line go back to the robot") {
  CHECK(parted("[0]:A:{S,idl}\n[0]:A:{S,IDL}\n") == "[0]:A:{S,idl}\n[0]:A:{S,IDL}\n|");
  const std::string noise(300, 'x');
  CHECK(parted("[0]:A:" + noise + "\n").starts_with("[0]:A:" + noise.substr(0, 243)));
}

TEST_CASE("central stream: packed updates pass") {
  const std::string packed = "[0]:A:\xB1\x80\xFF\x81";
  CHECK(parted(packed) == packed + "|");
}

TEST_CASE("central stream: a line that a packet cuts short is dropped, and counted") {
  CentralStream stream;
  int lines = 0;
  for (const char c : std::string_view{"connec[0]:A:{S,IDL}\nted 0\n"})
    stream.feed(
        c, [](char) {}, [&](const CentralLine&) { ++lines; });
  CHECK(lines == 0);
  CHECK(stream.cut() == 1);
  CHECK(parted("connec[0]:A:{S,IDL}\nted 0\n") == "[0]:A:{S,IDL}\nted 0\n|");
}

TEST_CASE("central stream: before the first packet, and behind a line of its own, only the central speaks") {
  CHECK(parted("0:C0000000000A:AVR\n") == "|" + said(Kind::listed, 0, "AVR"));
  // What is no line of it, or too long for one, is no robot's: it is dropped, and counted.
  CentralStream stream;
  std::string robots;
  int lines = 0;
  const std::string text = "scanning\nwhat is this\n" + std::string(81, 'x') + "\n\nfound 1\n";
  for (const char c : text)
    stream.feed(
        c, [&](char robot) { robots += robot; }, [&](const CentralLine&) { ++lines; });
  CHECK(robots.empty());
  CHECK(lines == 2);
  CHECK(stream.cut() == 2);
}

TEST_CASE("central stream: any bytes, any number: nothing is held for ever") {
  ocm::test::Random random{1};
  for (int run = 0; run < 200; ++run) {
    CentralStream stream;
    std::size_t in = 0, out = 0;
    const auto feed = [&](char c) {
      ++in;
      stream.feed(
          c, [&](char) { ++out; }, [&](const CentralLine&) {});
    };
    for (int i = 0; i < 500; ++i)
      feed(random.below(3) == 0 ? "[]:\na0z{}"[random.below(9)] : static_cast<char>(random()));
    REQUIRE(out <= in);
    // After a whole prefix a robot's capital comes through at once.
    for (const char c : std::string_view{"\n[0]:A:"}) feed(c);
    const std::size_t before = out;
    feed('{');
    REQUIRE(out == before + 1);
  }
}

}  // namespace mapper_server_central_stream_test
