#include "cli/fleet/line_log.hpp"

#include <chrono>
#include <fstream>
#include <string>

#include <catch2/catch.hpp>

#include "cli/fleet/line_log_file.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"
#include "tests/unit/host/host_testing.hpp"

namespace fleet_line_log_test {

using namespace std::chrono_literals;
using namespace std::string_literals;
using namespace ocm;
using cli::fleet::parse_line_log;
using cli::fleet::parse_log_line;
using cli::fleet::to_log_line;

TEST_CASE("line log: any piece comes back, as a line that can be read") {
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  const base::Time time{1795599207s + 123456us};
  for (const std::string& text :
       {"[0]:AVR:{U,1,-2,3,4,5,6,7,8}\n"s, all, ""s, "\\x41"s, "ends \\"s, "(1.000000) x"s}) {
    const std::string line = to_log_line(time, text);
    CHECK(line.find('\n') == line.size() - 1);
    const auto said = parse_log_line(std::string_view{line}.substr(0, line.size() - 1));
    REQUIRE(said);
    CHECK(said->time == time);
    CHECK(said->text == text);
  }
  CHECK(to_log_line(base::Time{5s + 7us}, "a\n") == "(5.000007) a\\x0a\n");
  // What is printed stays as it is, from the first such byte to the last, but for the backslash.
  CHECK(to_log_line(base::Time{5s}, "\x1f !}~\x7f[]\\\xff") == "(5.000000) \\x1f !}~\\x7f[]\\x5c\\xff\n");
}

TEST_CASE("line log: what is no line of it") {
  for (const char* const line : {"",
                                 "(",
                                 "()",
                                 "( ) ",
                                 "(1) x",
                                 "(1.5) x",
                                 "(1.0000000) x",
                                 "(.000000) x",
                                 "(-1.000000) x",
                                 "(1.00000a) x",
                                 "(1.-00001) x",
                                 "(1.000000)x",
                                 "1.000000 x",
                                 "(7258118401.000000) x",
                                 "(99999999999999999999.000000) x",
                                 "(1.000000) \\",
                                 "(1.000000) \\x",
                                 "(1.000000) \\x1",
                                 "(1.000000) \\xg0",
                                 "(1.000000) \\n",
                                 "(1.000000) a\tb",
                                 "(1.000000) \xC3\xA4"}) {
    INFO(line);
    CHECK_FALSE(parse_log_line(line));
  }
  CHECK(parse_log_line("(0.000000) ")->text.empty());
  CHECK(parse_log_line("(7258118400.999999) x"));
}

TEST_CASE("line log: what could not be read of one is counted, and the first is named") {
  const std::string first = std::string{cli::fleet::line_log_begins} + "\n";
  const auto good = parse_line_log(first + "(1.000000) a\n(1.000000) b\n");
  REQUIRE(good);
  CHECK(good->said.size() == 2);
  CHECK(good->said[1].text == "b");
  CHECK(good->damaged == 0);
  CHECK(good->first_damaged == 0);
  // Line 3 goes back in time, 4 has no form, 6 no end: its writer was ended.
  const auto damaged = parse_line_log(first + "(2.000000) a\n(1.999999) b\n\n(2.000000) c\n(3.000000) d");
  REQUIRE(damaged);
  REQUIRE(damaged->said.size() == 2);
  CHECK(damaged->said[1].text == "c");
  CHECK(damaged->damaged == 3);
  CHECK(damaged->first_damaged == 3);
  CHECK(parse_line_log(first)->said.empty());
  CHECK_FALSE(parse_line_log(""));
  CHECK_FALSE(parse_line_log("# line of a central, version 2\n(1.000000) a\n"));
  CHECK_FALSE(parse_line_log("(1.000000) a\n" + first));
}

TEST_CASE("line log: a file of it is known by its first line, and none is overwritten") {
  const test::TemporaryDirectory folder;
  const std::string path = folder.path() + "/room.line";
  const base::Time before = cli::unix_time();
  {
    cli::fleet::LineLog log{"central", path};
    log.write("[0]:A:{S,IDL}\n");
    log.write("");
    log.write("found 2\n");
    CHECK(log.is_whole());
  }
  CHECK(cli::fleet::is_line_log(path));
  const auto log = cli::fleet::read_line_log("serve", path);
  CHECK(log.damaged == 0);
  REQUIRE(log.said.size() == 2);
  CHECK(log.said[0].text == "[0]:A:{S,IDL}\n");
  CHECK(log.said[1].text == "found 2\n");
  CHECK(log.said[0].time >= before - 1us);  // it is cut to microseconds
  CHECK(log.said[1].time < before + 1h);
  const auto left = test::leaving([&] { const cli::fleet::LineLog again{"central", path}; });
  CHECK(left.code == cli::exit_failure);
  CHECK(left.text == "amiroctl: central: --record " + path +
                         ": File exists\n          give another name: a file that is there is not "
                         "overwritten\n");
  const std::string nowhere = folder.path() + "/none/room.line";
  CHECK(test::leaving([&] {
          const cli::fleet::LineLog none{"map", nowhere};
        }).text == "amiroctl: map: --record " + nowhere +
                       ": No such file or directory\n          name a file in a folder that you may write\n");
}

TEST_CASE("line log: a file that begins otherwise, or is not there, is none") {
  const test::TemporaryDirectory folder;
  const std::string path = folder.path() + "/other.line";
  CHECK_FALSE(cli::fleet::is_line_log(path));
  const std::string first{cli::fleet::line_log_begins};
  for (const std::string& begin :
       {""s, first, first + "2\n", "\n" + first + "\n", "x" + first.substr(1) + "\n"}) {
    CAPTURE(begin);
    std::ofstream{path} << begin;
    CHECK_FALSE(cli::fleet::is_line_log(path));
  }
  std::ofstream{path} << first << "\n";
  CHECK(cli::fleet::is_line_log(path));
  std::ofstream{path} << "(1.000000) a\n";
  const auto left = test::leaving([&] { static_cast<void>(cli::fleet::read_line_log("serve", path)); });
  CHECK(left.code == cli::exit_failure);
  CHECK(left.text == "amiroctl: serve: " + path +
                         " is no log of a central's line\n          map --record and central --own --record "
                         "write one\n");
}

TEST_CASE("line log: a file that cannot be read says why, and what is expected") {
  const test::TemporaryDirectory folder;
  const auto read = [](const std::string& path) {
    return test::leaving([&] { static_cast<void>(cli::fleet::read_line_log("serve", path)); });
  };
  const std::string none = folder.file("none.line");
  const auto missing = read(none);
  CHECK(missing.code == cli::exit_failure);
  CHECK(missing.text == "amiroctl: serve: cannot read " + none +
                            ": No such file or directory\n          expected a log that --record has "
                            "written\n");
  CHECK(read(folder.path()).text == "amiroctl: serve: cannot read " + folder.path() +
                                        ": Is a directory\n          expected a log that --record has "
                                        "written\n");
}

}  // namespace fleet_line_log_test
