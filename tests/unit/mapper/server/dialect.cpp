#include "ocm/mapper/server/dialect.hpp"

#include <string>

#include <catch2/catch.hpp>

namespace mapper_server_dialect_test {

using namespace std::chrono_literals;
using namespace ocm::mapper::server;
using ocm::base::Time;

constexpr Time begin{1s};

TEST_CASE("dialect: a line of a list, behind a robot's words too, with or without colons in its address") {
  ListedRobot robot;
  REQUIRE(detail::parse_listed("0:C0000000000A:AVR", robot));
  CHECK(robot.index == 0);
  CHECK(robot.address == "C0000000000A");
  CHECK(robot.name == "AVR");
  REQUIRE(detail::parse_listed("{S,IDL}12:c0:00:00:00:00:0b:B", robot));
  CHECK(robot.index == 12);
  CHECK(robot.address == "c0000000000b");
  CHECK(robot.name == "B");
  REQUIRE(detail::parse_listed("255:C0000000000A:A", robot));
  CHECK(robot.index == 255);
  REQUIRE(
      detail::parse_listed("1255:C0000000000A:A", robot));  // three digits at most; the rest was before it
  CHECK(robot.index == 255);
  for (const char* none : {"", ":", "0:C0:AVR", "0:C0000000000A:", "x:C0000000000A:AVR", "0:G0000000000A:A",
                           "256:C0000000000A:A", ":C0000000000A:A", "0:C000000000A:A"})
    CHECK_FALSE(detail::parse_listed(none, robot));
}

/// What one side says at some time, and what goes to the dongle and to the client then.
struct Line {
  int ms;
  char from;  ///< c: the client, d: the dongle; t: time passes
  const char* words;
  const char* to_dongle;
  const char* to_client;
};
void talk(Dialect dialect, std::initializer_list<Line> lines) {
  Translator translator{dialect};
  int number = 0;
  for (const Line& line : lines) {
    ++number;
    CAPTURE(number, line.ms, line.words);
    const Time now = begin + line.ms * 1ms;
    if (line.from == 'c') translator.from_client(line.words, now);
    if (line.from == 'd') translator.from_dongle(line.words, now);
    if (line.from == 't') translator.expire(now);
    CHECK(translator.take_for_dongle() == line.to_dongle);
    CHECK(translator.take_for_client() == line.to_client);
  }
}

TEST_CASE("dialect: the base firmware is asked for each robot of a scan, and its list is remembered") {
  talk(Dialect::at, {
                        {0, 'c', "start\n", "AT+SCAN+.", ""},
                        {1, 'd', "ERROR.", "", "error: the dongle does not scan\n"},
                        {2, 'c', "start\n", "AT+SCAN+.", ""},
                        {3, 'd', "OK.", "", "scanning\n"},
                        {4, 'c', "stop\n", "AT+SCAN-.", ""},
                        {5, 'd', "OK-2.", "AT+FOUND=0.", ""},
                        {6, 'd', "OK-C0000000000A-AVR.", "AT+FOUND=1.", ""},
                        {7, 'd', "OK-C0000000000B-.", "", "found 2\n"},
                        {8, 'c', "list\n", "", "0:C0000000000A:AVR\n1:C0000000000B:?\nend of list\n"},
                        {9, 'c', "stop\n", "", "found 2\n"},
                        // Behind a reset it is not known any more; then the dongle says where the list ends.
                        {10, 'c', "reset\n", "AT+RESET.", ""},
                        {11, 'd', "OK.", "", "reset\n"},
                        {12, 'c', "stop\n", "AT+FOUND=0.", ""},
                        {13, 'd', "OK-C0000000000A-AVR.", "AT+FOUND=1.", ""},
                        {14, 'd', "ERROR.", "", "found 1\n"},
                        // Or says nothing more; a scan that has found none is none.
                        {15, 'c', "reset\nstop\n", "AT+RESET.", ""},
                        {16, 'd', "OK.", "AT+FOUND=0.", "reset\n"},
                        {17, 'd', "OK-C0000000000A-AVR.", "AT+FOUND=1.", ""},
                        {816, 't', "", "", ""},
                        {817, 't', "", "", "found 1\n"},
                        {820, 'c', "start\nstop\n", "AT+SCAN+.", ""},
                        {821, 'd', "OK.", "AT+SCAN-.", "scanning\n"},
                        {822, 'd', "OK-0.", "AT+FOUND=0.", "found 0\n"},
                        {823, 'd', "ERROR.", "", ""},
                        {824, 'c', "list\n", "", "end of list\n"},
                    });
}

TEST_CASE("dialect: links of the base firmware: one that is there, one that comes, and one that does not") {
  talk(Dialect::at, {
                        {0, 'c', "conn 2\n", "AT+SWITCH=2.", ""},
                        {1, 'd', "OK.", "", "data 2\n"},
                        {2, 'c', "{S,CON}\n{", "{S,CON}\n.", ""},
                        {3, 'c', "*", "*", ""},  // what was begun is not said
                        {4, 'd', "OK.", "", "command\n"},
                        {5, 'c', "conn 3\n", "AT+SWITCH=3.", ""},
                        {6, 'd', "ERROR.", "AT+CONN=3.", ""},
                        {7, 'd', "WAIT.", "", "connecting 3\n"},
                        {9'006, 't', "", "", ""},
                        {9'006, 'd', "OK.", "", "connected 3\n"},
                        {9'007, 'c', "{}\n", "{}\n.", ""},
                        {9'008, 'c', "*conn 4\n", "*", ""},
                        {9'009, 'd', "OK.", "AT+SWITCH=4.", "command\n"},
                        {9'010, 'd', "ERROR.", "AT+CONN=4.", ""},
                        {9'011, 'd', "WAIT.", "", "connecting 4\n"},
                        {18'010, 't', "", "", ""},
                        {18'011, 't', "", "", "error: no link to 4\n"},
                        // Its last answer may come yet: it is brought into command mode first. The client is
                        // in data mode: what it says goes nowhere.
                        {18'012, 'c', "{}\n*", "*.AT?.", ""},
                        {18'013, 'd', "ERROR.OK.", "", ""},
                        {18'212, 't', "", "", ""},
                        {18'213, 't', "", "", "command\n"},
                        {18'313, 'c', "switch 1\n", "AT+SWITCH=1.", ""},
                        {18'314, 'd', "ERROR.", "", "error: no link to 1; conn first\n"},
                        {18'315, 'c', "drop 1\n", "AT+DROP=1.", ""},
                        {18'316, 'd', "WAIT.", "", ""},
                        {18'317, 'd', "OK.", "", "closing 1\nclosed 1\n"},
                        {18'318, 'c', "drop 1\n", "AT+DROP=1.", ""},
                        {18'319, 'd', "ERROR.", "", "error: no link to 1\n"},
                        {18'320, 'c', "switch 5\n", "AT+SWITCH=5.", ""},
                        {18'321, 'd', "OK.", "", "data 5\n"},
                    });
}

TEST_CASE("dialect: what is no request, and what is no answer") {
  talk(Dialect::at, {
                        {0, 'c', "*list\n\nlists\nli*st\nswitch\n", "", "end of list\nend of list\n"},
                        {1, 'd', "OK.", "", ""},  // nothing was asked
                        {2, 'd', "{S,IDL}\n", "", "[0]:?:{S,IDL}\n"},
                        {3, 'd', "OWE.", "", ""},
                        {4, 'd', "OWE\n", "", "OWE\n"},  // of the same robot
                        {5, 'c', "start\n", "AT+SCAN+.", ""},
                        {6, 'd', "WHAT.", "", ""},
                        {7, 'd', "OK.", "", "scanning\n"},
                    });
}

TEST_CASE("dialect: at the thesis's dongle each word goes through, and its answer is put in") {
  talk(Dialect::thesis, {
                            {0, 'c', "stop\n", "list\n", ""},
                            {499, 't', "", "", ""},
                            {500, 't', "", "", "found 0\n"},
                            {501, 'c', "stop\n", "", "found 0\n"},
                            {510, 'c', "start\n", "start\n", "scanning\n"},
                            {520, 'c', "stop\n", "stop\nlist\n", ""},
                            {530, 'd', "0:C0000000000A:AVR\n", "", "0:C0000000000A:AVR"},
                            {540, 'd', "0:C0000000000B:B\n", "", "0:C0000000000B:B"},
                            {1'039, 't', "", "", ""},
                            {1'040, 't', "", "", "found 1\n"},
                            {1'041, 'c', "list\n", "", "0:C0000000000B:B\nend of list\n"},
                            {1'050, 'c', "switch 1\n", "switch 1\n", "data 1\n"},
                            {1'051, 'c', "{}\n*", "{}\n*", "command\n"},
                            {1'052, 'c', "drop 1\n", "drop 1\n", "closing 1\nclosed 1\n"},
                            {1'053, 'c', "reset\n", "reset\n", "reset\n"},
                            // A link that comes is one of whom a packet comes; none, after nine seconds.
                            {2'000, 'c', "conn 2\n", "conn 2\n", "connecting 2\n"},
                            {10'999, 't', "", "", ""},
                            {11'000, 't', "", "", "error: no link to 2\n"},
                            {11'001, 'c', "*", "*", "command\n"},
                            // Who has spoken within two and a half seconds has a link.
                            {12'000, 'd', "[2]:B:{}\n", "", "[2]:B:{}\n"},
                            {14'500, 'c', "conn 2\n", "switch 2\n", "data 2\n"},
                            {14'501, 'c', "*conn 2\n", "*conn 2\n", "command\nconnecting 2\n"},
                            {14'502, 'd', "[2]:B:", "", "connected 2\n[2]:B:"},
                        });
}

TEST_CASE("dialect: small letters of the thesis's dongle are its own, and a robot's words are not") {
  Translator translator{Dialect::thesis};
  translator.from_dongle("[1]:R:{U,AZ}azmode\n", begin);
  CHECK(translator.take_for_client() == "[1]:R:{U,AZ}\n");
}

TEST_CASE("dialect: our own central's words go through as they are") {
  Translator translator{Dialect::words};
  translator.from_client("*\nstop\n", begin);
  translator.from_dongle("found 0\n", begin);
  CHECK(translator.take_for_dongle() == "*\nstop\n");
  CHECK(translator.take_for_client() == "found 0\n");
}

TEST_CASE("dialect: an answer of the base firmware in the middle of a sentence takes nothing from it") {
  Translator translator{Dialect::at};
  translator.from_client("switch 0\n", begin);
  CHECK(translator.take_for_dongle() == "AT+SWITCH=0.");
  translator.from_dongle("{U,1,2OK.,3}\n", begin);
  CHECK(translator.take_for_client() == "[0]:?:{U,1,2data 0\n[0]:?:,3}\n");
  translator.from_client("{S,CON}\n", begin);
  CHECK(translator.take_for_dongle() == "{S,CON}\n.");
  // With prefixes nothing is put in, and a name may begin as an answer does.
  translator.from_dongle("[3]:OWE:{S,IDL}\n", begin);
  CHECK(translator.take_for_client() == "[3]:OWE:{S,IDL}\n");
}

TEST_CASE("dialect: an answer of the base firmware that comes too late leaves no side in the wrong mode") {
  talk(Dialect::at,
       {
           {0, 'c', "conn 2\n", "AT+SWITCH=2.", ""},
           {800, 't', "", "", ""},     // it is given up
           {900, 'd', "OK.", "", ""},  // and the dongle is in data mode
           {1'000, 'c', "*\nstop\n", "*.AT?.", ""},
           {1'010, 'd', "OK.", "", ""},  // of the star, of an empty command, and of the question
           {1'020, 'd', "ERROR.OK.", "", ""},
           {1'219, 't', "", "", ""},
           {1'220, 't', "", "AT+FOUND=0.", ""},
           {1'221, 'd', "OK-C0000000000A-AVR.", "AT+FOUND=1.", ""},
           {1'222, 'd', "ERROR.", "", "found 1\n"},
           // What is known asks nothing, nor does the dongle that is known to be in command mode.
           {1'230, 'c', "list\n", "", "0:C0000000000A:AVR\nend of list\n"},
           {1'240, 'c', "conn 2\n", "AT+SWITCH=2.", ""},
           {2'040, 't', "", "", ""},
           {2'041, 'c', "stop\nlist\n", "", "found 1\n0:C0000000000A:AVR\nend of list\n"},
           // One that answers nothing holds up nothing, and is not believed the next time either.
           {2'050, 'c', "conn 2\n", "*.AT?.", ""},
           {2'649, 't', "", "", ""},
           {2'650, 't', "", "", ""},
           {2'651, 'c', "conn 2\n", "*.AT?.", ""},
           {2'652, 'd', "WAIT.ERROR.", "", ""},  // no answer to the question
           {3'250, 'd', "OK.", "", ""},
           {3'450, 't', "", "AT+SWITCH=2.", ""},
           {3'451, 'd', "OK.", "", "data 2\n"},
           {3'452, 'c', "{S,CON}\n", "{S,CON}\n.", ""},
       });
}

TEST_CASE("dialect: a command that the base firmware does not answer holds up nothing") {
  Translator translator{Dialect::at};
  translator.from_client("start\n", begin);
  CHECK(translator.take_for_dongle() == "AT+SCAN+.");
  translator.from_client("conn 2\n", begin);
  translator.expire(begin + 500ms);
  CHECK(translator.take_for_dongle().empty());
  translator.expire(begin + 1s);
  CHECK(translator.take_for_dongle() == "*.AT?.");
  translator.from_dongle("ERROR.OK.", begin + 1s);
  translator.expire(begin + 1200ms);
  CHECK(translator.take_for_dongle() == "AT+SWITCH=2.");
  translator.from_dongle("ERROR.", begin + 1200ms);
  CHECK(translator.take_for_dongle() == "AT+CONN=2.");
  translator.from_dongle("WAIT.ERROR.", begin + 1200ms);
  CHECK(translator.take_for_client() == "connecting 2\nerror: no link to 2\n");
  CHECK(translator.idle());
  // No answer is no list: that it has found none would be a lie.
  Translator silent{Dialect::at};
  silent.from_client("stop\n", begin);
  CHECK(silent.take_for_dongle() == "AT+FOUND=0.");
  CHECK_FALSE(silent.idle());
  silent.expire(begin + 800ms);
  CHECK(silent.take_for_client().empty());
  CHECK(silent.idle());
}

TEST_CASE(
    "dialect: at the thesis's dongle a packet proves a link, and a robot that speaks is not connected "
    "again") {
  Translator translator{Dialect::thesis};
  translator.from_client("conn 1\n", begin);
  CHECK(translator.take_for_dongle() == "conn 1\n");
  CHECK(translator.take_for_client() == "connecting 1\n");
  translator.from_dongle("Data mode\r\n[3]:OWE:{H,", begin);
  CHECK(translator.take_for_client().find("connected") == std::string::npos);  // another's link
  translator.from_dongle("[1]:AVR:{H,", begin);
  const std::string heard = translator.take_for_client();
  CHECK(heard.find("connected 1\n[1]:AVR:{H,") != std::string::npos);
  translator.from_client("*conn 1\n", begin + 1s);
  CHECK(translator.take_for_dongle() == "*switch 1\n");
  CHECK(translator.take_for_client() == "command\ndata 1\n");
  translator.from_client("*conn 2\n", begin + 1s);
  (void)translator.take_for_client();
  translator.expire(begin + 11s);
  CHECK(translator.take_for_client() == "error: no link to 2\n");
}

TEST_CASE("dialect: behind a scan the thesis's dongle has two seconds to its first line") {
  Translator translator{Dialect::thesis};
  translator.from_client("start\nstop\n", begin);
  CHECK(translator.take_for_dongle() == "start\nstop\nlist\n");
  CHECK(translator.take_for_client() == "scanning\n");
  translator.expire(begin + 1999ms);
  CHECK(translator.take_for_client().empty());
  translator.from_dongle("0:0123456789AB:AVR\n", begin + 1999ms);
  translator.expire(begin + 2498ms);
  CHECK(translator.take_for_client().find("found") == std::string::npos);
  translator.expire(begin + 2499ms);
  CHECK(translator.take_for_client().find("found 1\n") != std::string::npos);
  // None: the same words later are answered of the list.
  translator.from_client("*start\nstop\n", begin + 10s);
  (void)translator.take_for_client();
  translator.expire(begin + 12s);
  CHECK(translator.take_for_client() == "found 0\n");
}

TEST_CASE("dialect: an answer of the base firmware that names no robot ends its list") {
  talk(Dialect::at, {
                        {0, 'c', "stop\n", "AT+FOUND=0.", ""},
                        {1, 'd', "OK.", "", "found 0\n"},
                        {2, 'c', "reset\nstop\n", "AT+RESET.", ""},
                        {3, 'd', "OK.", "AT+FOUND=0.", "reset\n"},
                        {4, 'd', "OK-C0000000000A.", "", "found 0\n"},  // without a name behind it
                        {5, 'c', "reset\nstop\n", "AT+RESET.", ""},
                        {6, 'd', "OK.", "AT+FOUND=0.", "reset\n"},
                        {7, 'd', "OK-C000000000-A.", "", "found 0\n"},  // no address
                        {8, 'c', "list\n", "", "end of list\n"},
                    });
}

TEST_CASE("dialect: of a list without an end 32 robots are asked for, whatever the scan has counted") {
  Translator translator{Dialect::at};
  const auto lists_32 = [&translator] {
    for (int i = 0; i < 32; ++i) {
      CHECK(translator.take_for_dongle() == "AT+FOUND=" + std::to_string(i) + ".");
      translator.from_dongle("OK-C0000000000A-R.", begin);
    }
    CHECK(translator.take_for_dongle().empty());
    CHECK(translator.take_for_client() == "found 32\n");
  };
  translator.from_client("stop\n", begin);
  lists_32();
  for (const char* count : {"OK-32.", "OK-33.", "OK-x."}) {
    translator.from_client("start\n", begin);
    translator.from_dongle("OK.", begin);
    translator.from_client("stop\n", begin);
    CHECK(translator.take_for_dongle() == "AT+SCAN+.AT+SCAN-.");
    CHECK(translator.take_for_client() == "scanning\n");
    translator.from_dongle(count, begin);
    lists_32();
  }
}

TEST_CASE("dialect: a link of the base firmware that is to end has as long as one that is to come") {
  talk(Dialect::at, {
                        {0, 'c', "drop 1\n", "AT+DROP=1.", ""},
                        {1, 'd', "WAIT.", "", ""},
                        {9'000, 't', "", "", ""},
                        {9'000, 'd', "OK.", "", "closing 1\nclosed 1\n"},
                        {9'001, 'c', "drop 1\n", "AT+DROP=1.", ""},
                        {9'002, 'd', "WAIT.", "", ""},
                        {18'002, 't', "", "", ""},  // given up
                        {18'003, 'd', "OK.", "", ""},
                        {18'004, 'c', "drop 1\n", "*.AT?.", ""},
                    });
}

TEST_CASE(
    "dialect: what is too long for an answer is a robot's, and a line of a list is read behind anything") {
  Translator at{Dialect::at};
  at.from_dongle("O" + std::string(63, 'x'), begin);
  CHECK(at.take_for_client().empty());
  at.from_dongle("x", begin);
  CHECK(at.take_for_client() == "[0]:?:O" + std::string(64, 'x'));
  const std::string listed = "0:C0000000000A:AVR\n";
  for (const std::size_t before : {78U, 79U, 95U, 100U, 500U}) {  // five packed updates are 100
    Translator thesis{Dialect::thesis};
    thesis.from_dongle(std::string(before, 'X') + listed, begin);
    (void)thesis.take_for_client();
    thesis.from_client("list\n", begin);
    CHECK(thesis.take_for_client() == listed + "end of list\n");
  }
}

TEST_CASE("dialect: a prefix ends what looked like an answer, and one that is broken is not put in again") {
  Translator translator{Dialect::at};
  translator.from_dongle("{U,1E[3]:A:x", begin);
  CHECK(translator.take_for_client() == "[0]:?:{U,1E[3]:A:x");
  translator.from_client("switch 2\n", begin);
  CHECK(translator.take_for_dongle() == "AT+SWITCH=2.");
  translator.from_dongle("[0xAOK.B", begin);
  CHECK(translator.take_for_client() == "[0xAdata 2\nB");
}

TEST_CASE("dialect: a line of a list has 96 characters at most") {
  for (const std::size_t name : {81U, 82U}) {  // behind 15 others
    const std::string listed = "0:C0000000000A:" + std::string(name, 'N') + "\n";
    Translator thesis{Dialect::thesis};
    thesis.from_dongle(listed, begin);
    (void)thesis.take_for_client();
    thesis.from_client("list\n", begin);
    CHECK(thesis.take_for_client() == (name == 81 ? listed : "") + "end of list\n");
  }
}

TEST_CASE("dialect: an index that no robot has is handed on, and no link comes") {
  talk(Dialect::thesis, {
                            {0, 'c', "conn 256\n", "conn 256\n", "connecting 256\n"},
                            {1, 'd', "[255]:B:", "", "[255]:B:"},
                            {9'000, 't', "", "", "error: no link to 256\n"},
                        });
}

}  // namespace mapper_server_dialect_test
