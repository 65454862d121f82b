#include "ocm/log/mcap_frame.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "tests/unit/log/log_testing.hpp"

namespace log_mcap_frame_test {

using namespace ocm;
using namespace ocm::log;

std::string text_of(const Entry& entry) {
  char text[mcap::frame_room];
  return {text, mcap::put_frame(text, entry)};
}
Entry entry_of(std::string_view text) {
  Entry entry;
  entry.data.fill(0xAA);  // what the entry before left
  const auto cause = mcap::FrameParser{text}.parse(entry);
  INFO(text);
  REQUIRE_FALSE(cause);
  REQUIRE(log::testing::can_exist(entry));
  return entry;
}
std::optional<Cause> cause_of(std::string_view text) {
  Entry entry;
  return mcap::FrameParser{text}.parse(entry);
}

TEST_CASE("mcap_frame: as it is written") {
  Entry entry{{}, {0x608, 4, {0x00, 0xD2, 0x00, 0x0F}}};
  CHECK(text_of(entry) == R"({"id":1544,"data":"00D2000F"})");
  entry.direction = Direction::received;
  CHECK(text_of(entry) == R"({"id":1544,"data":"00D2000F","direction":"received"})");
  entry.direction = Direction::sent;
  entry.format = can::Format::extended_remote;
  CHECK(text_of(entry) ==
        R"({"id":1544,"data":"","direction":"sent","extended":true,"remote":true,"length":4})");
  entry.format = can::Format::error;
  entry.direction = Direction::unknown;
  CHECK(text_of(entry) == R"({"id":1544,"data":"00D2000F","error":true})");
  entry.format = can::Format::extended;
  entry.flags = flag::fd | flag::bit_rate_switch | flag::error_state;
  CHECK(text_of(entry) == R"({"id":1544,"data":"00D2000F","extended":true,"fd":true,"brs":true,"esi":true})");
  Entry early{base::Time{base::Duration{INT64_MIN}}, {1, 8, {}}};
  early.raw_dlc = 15;
  CHECK(text_of(early) ==
        R"({"id":1,"data":"0000000000000000","raw_dlc":15,"time_ns":"-9223372036854775808"})");
}

TEST_CASE("mcap_frame: whatever is written is read the same, in the room that is said") {
  test::RandomEntries entries{7, {.interfaces = 1}};
  for (int i = 0; i < 20'000; ++i) {
    Entry entry = entries.next();
    if (i % 3 == 0) entry.time = base::Time{-entry.time.time_since_epoch()};
    const std::string text = text_of(entry);
    REQUIRE(text.size() <= mcap::frame_room);
    Entry read = entry_of(text);
    if (entry.time.time_since_epoch().count() >= 0) read.time = entry.time;
    REQUIRE(read == entry);
  }
}

TEST_CASE("mcap_frame: the usual ones are read the same in a short way") {
  test::RandomEntries entries{8, {.fd = false, .errors = false, .interfaces = 1}};
  std::size_t short_ways = 0;
  for (int i = 0; i < 20'000; ++i) {
    const std::string text = text_of(entries.next());
    const Entry careful = entry_of(text);
    Entry usual;
    usual.data.fill(0xAA);
    if (!mcap::parse_usual(text, usual)) continue;
    ++short_ways;
    REQUIRE(usual == careful);
    REQUIRE(log::testing::can_exist(usual));
  }
  CHECK(short_ways > 2000);
}

TEST_CASE("mcap_frame: in a short way nothing is read that cannot be") {
  const std::string_view usual = R"({"id":1544,"data":"00D2000F11223344","direction":"received"})";
  Entry entry;
  REQUIRE(mcap::parse_usual(usual, entry));
  CHECK_FALSE(mcap::parse_usual(R"({"id":,"data":"00D2000F11223344","direction":"received"})", entry));
  CHECK(entry.id == 1544);
  for (std::size_t size = 0; size < usual.size(); ++size) {
    const std::string cut{usual.substr(0, size)};
    REQUIRE_FALSE(mcap::parse_usual(cut, entry));
  }
  for (std::size_t at = 0; at < usual.size(); ++at) {
    for (const char c : {'"', '}', ' ', 'x', '9', 'A', '\0'}) {
      std::string other{usual};
      other[at] = c;
      Entry careful = entry, quick = entry;
      if (mcap::parse_usual(other, quick)) {
        REQUIRE_FALSE(mcap::FrameParser{other}.parse(careful));
        REQUIRE(quick == careful);
      }
    }
  }
  CHECK_FALSE(mcap::parse_usual(R"({"id":2048,"data":"00D2000F11223344"})", entry));
  CHECK_FALSE(mcap::parse_usual(R"({"id":5,"data":"00D2000","direction":"sent"})", entry));
  CHECK_FALSE(mcap::parse_usual(R"({"id":5,"data":"00D2000F112233445","direction":"sent"})", entry));
  CHECK_FALSE(mcap::parse_usual(R"({"id":5,"data":"00D2000F1122334455","direction":"sent"})", entry));
  CHECK_FALSE(mcap::parse_usual(R"({"id":5,"data":"00D2000F","direction":"both"})", entry));
}

TEST_CASE("mcap_frame: as other programs write it") {
  const Entry wanted{{}, {0x608, 4, {0x00, 0xD2, 0x00, 0x0F}}};
  CHECK(entry_of(" {\n \"data\" : \"00d2000f\" ,\r\t\"id\" : 1544 }\n") == wanted);
  CHECK(
      entry_of(
          R"({"extended":false,"note":"a \" } ,","more":{"id":[1,{"x":"]"}]},"id":1544,"data":"00D2000F"})") ==
      wanted);
  CHECK(entry_of(R"({"id":1544,"fd":false,"brs":false,"raw_dlc":0,"length":0,"data":"00D2000F"})") == wanted);
  CHECK(entry_of(R"({"id":5})").length == 0);
  CHECK(entry_of(R"({"id":5,"data":"0011","data":"22"})").length == 1);  // the last one counts
  const std::string long_one(128, 'A');
  CHECK(entry_of(R"({"id":5,"fd":true,"data":")" + long_one + R"("})").length == 64);
}

TEST_CASE("mcap_frame: what cannot be") {
  for (const char* text : {"",
                           "{",
                           "{}x",
                           "[]",
                           "null",
                           R"({"id":5)",
                           R"({"id":5,})",
                           R"({"id":5}})",
                           R"({"id":5 "data":""})",
                           R"({"id":"5"})",
                           R"({"id":-5})",
                           R"({"id":5.5})",
                           R"({"id":5,"data":"0"})",
                           R"({"id":5,"data":"0G"})",
                           R"({"id":5,"data":"00)",
                           R"({"id":5,"data":12})",
                           R"({"id":5,"fd":1})",
                           R"({"id":5,"direction":"both"})",
                           R"({"id":5,"brs":true})",
                           R"({"id":5,"esi":true})",
                           R"({"id":5,"error":true,"extended":true})",
                           R"({"id":5,"error":true,"fd":true})",
                           R"({"id":5,"remote":true,"fd":true})",
                           R"({"id":5,"error":true,"remote":true})",
                           R"({"id" 5})",
                           R"({:5,"id":5})",
                           R"({"id":5,"time_ns":"-5")",
                           R"({"id":5,"x":]})",
                           R"({"id":5,"x":"\)",
                           R"({"x)"}) {
    INFO(text);
    CHECK(cause_of(text) == Cause::syntax);
  }
  for (const char* text : {"{}", R"({"data":""})", R"({"id":2048})", R"({"id":536870912,"extended":true})",
                           R"({"id":536870912,"error":true})", R"({"id":99999999999})"}) {
    INFO(text);
    CHECK(cause_of(text) == Cause::identifier);
  }
  const std::string nine(18, '0'), many(130, '0');
  for (const std::string& text :
       {R"({"id":5,"data":")" + nine + R"("})", R"({"id":5,"fd":true,"data":")" + nine + R"("})",
        R"({"id":5,"fd":true,"data":")" + many + R"("})",
        std::string{R"({"id":5,"remote":true,"data":"00"})"},
        std::string{R"({"id":5,"remote":true,"length":9})"}, std::string{R"({"id":5,"length":4})"},
        std::string{R"({"id":5,"raw_dlc":1})"}, std::string{R"({"id":5,"raw_dlc":9})"},
        std::string{R"({"id":5,"raw_dlc":9,"fd":true,"data":"0000000000000000"})"},
        std::string{R"({"id":5,"raw_dlc":8,"data":"0000000000000000"})"},
        std::string{R"({"id":5,"raw_dlc":16,"data":"0000000000000000"})"},
        std::string{R"({"id":5,"raw_dlc":9,"error":true,"data":"0000000000000000"})"}}) {
    INFO(text);
    CHECK(cause_of(text) == Cause::length);
  }
  for (const char* text : {R"({"id":5,"time_ns":5})", R"({"id":5,"time_ns":""})", R"({"id":5,"time_ns":"-"})",
                           R"({"id":5,"time_ns":"-5x"})", R"({"id":5,"time_ns":"9223372036854775808"})"}) {
    INFO(text);
    CHECK(cause_of(text) == Cause::time);
  }
}

}  // namespace log_mcap_frame_test
