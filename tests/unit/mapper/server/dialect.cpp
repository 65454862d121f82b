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
  for (const char* none : {"", ":", "0:C0:AVR", "0:C0000000000A:", "x:C0000000000A:AVR", "0:G0000000000A:A"})
    CHECK_FALSE(detail::parse_listed(none, robot));
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

TEST_CASE("dialect: a command that the base firmware does not answer holds up nothing") {
  Translator translator{Dialect::at};
  translator.from_client("start\n", begin);
  CHECK(translator.take_for_dongle() == "AT+SCAN+.");
  translator.from_client("conn 2\n", begin);
  translator.expire(begin + 500ms);
  CHECK(translator.take_for_dongle().empty());
  translator.expire(begin + 1s);
  CHECK(translator.take_for_dongle() == "AT+SWITCH=2.");
  translator.from_dongle("ERROR.", begin + 1s);
  CHECK(translator.take_for_dongle() == "AT+CONN=2.");
  translator.from_dongle("WAIT.ERROR.", begin + 1s);
  CHECK(translator.take_for_client() == "connecting 2\nerror: no link to 2\n");
  CHECK(translator.idle());
  // No answer is no list: that it has found none would be a lie.
  Translator silent{Dialect::at};
  silent.from_client("stop\n", begin);
  CHECK(silent.take_for_dongle() == "AT+FOUND=0.");
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

}  // namespace mapper_server_dialect_test
