#include "cli/words/command.hpp"

#include <array>
#include <sstream>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

#include "tests/tool/golden.hpp"

namespace tool_words_command_test {

using namespace ocm;
using namespace ocm::cli::words;
using namespace std::chrono_literals;

base::Result<Command, WordError> parse(const std::string& line) {
  static std::vector<std::string> kept;
  kept.clear();
  std::istringstream stream{line};
  for (std::string word; stream >> word;) kept.push_back(word);
  const std::vector<std::string_view> words(kept.begin(), kept.end());
  return CommandParser{amiro::catalogue}.parse_line(words);
}

/// The frames of a command, in candump notation.
std::string frames(const std::string& line) {
  const auto command = parse(line);
  INFO(line << ": " << command.error.what);
  REQUIRE(command.ok());
  std::string text;
  for (const auto& frame : command->frames)
    text += (text.empty() ? "" : " ") + std::string{can::to_text(frame).view()};
  return text;
}

TEST_CASE("requests become the thesis's frames") {  // thesis 4.2.1
  CHECK(frames("publish mag 900us") == "205#01840302");
  CHECK(frames("once floor") == "204#02");
  CHECK(frames("stop magnetometer") == "205#00");
  CHECK(frames("publish mag") == "205#01");
  CHECK(frames("publish gyro 500ms") == "208#01F40100");
  CHECK(frames("publish gyro 1.5s") == "208#01DC0500");
  CHECK(frames("publish gyro 65535s") == "208#01FFFF01");
  CHECK(frames("publish ring 1s --priority high") == "11F#01E80300");
  CHECK(frames("--priority low once power") == "31E#02");
  CHECK(frames("publish 0x1f 1s --priority 1") == frames("publish ring 1s --priority high"));  // figure 6.2
  CHECK(frames("stop 0x1F --priority 1") == "11F#00");
  CHECK(frames("once 0x4") == "204#02");
  CHECK(frames("set 0x01 x=5cm/s --priority 0") == frames("set motors x=5cm/s --priority urgent"));
  CHECK(frames("publish mag 900us --priority normal") == "205#01840302");  // 4.2.1: "with normal priority"
  CHECK(frames("once power --priority 2") == "21E#02");
  CHECK(frames("once power --priority 3") == "31E#02");
}

TEST_CASE("a request says whose sample answers it; what is not answered does not") {
  const auto answered_by = [](const char* line) {
    const auto command = parse(line);
    INFO(line);
    REQUIRE(command.ok());
    return command->answers == nullptr ? std::string_view{} : command->answers->name;
  };
  CHECK(answered_by("publish gyro 500ms") == "gyroscope");
  CHECK(answered_by("publish mag") == "magnetometer");
  CHECK(answered_by("once floor") == "floor_proximity");
  CHECK(answered_by("stop gyro").empty());
  CHECK(answered_by("led 1 red").empty());
}

TEST_CASE("set points become the thesis's frames") {  // thesis 4.2.2, figure 6.1
  CHECK(frames("led 5 100,50,120") == "240#643278");
  CHECK(frames("led 5 #643278") == "240#643278");
  CHECK(frames("led 1 red") == "23C#FF0000");
  CHECK(frames("led 8 blue") == "243#0000FF");
  constexpr std::array<std::pair<std::string_view, std::string_view>, 12> colours{{{"off", "000000"},
                                                                                   {"black", "000000"},
                                                                                   {"white", "FFFFFF"},
                                                                                   {"red", "FF0000"},
                                                                                   {"green", "00FF00"},
                                                                                   {"blue", "0000FF"},
                                                                                   {"yellow", "FFFF00"},
                                                                                   {"cyan", "00FFFF"},
                                                                                   {"magenta", "FF00FF"},
                                                                                   {"orange", "FF8000"},
                                                                                   {"purple", "8000FF"},
                                                                                   {"pink", "FF60A0"}}};
  for (const auto& [name, digits] : colours)
    CHECK(frames("led 1 " + std::string{name}) == "23C#" + std::string{digits});
  CHECK(frames("led all off") ==
        "23C#000000 23D#000000 23E#000000 23F#000000 240#000000 241#000000 242#000000 243#000000");
  CHECK(frames("drive 0.05m/s 0.2rad/s") == "201#50C30000400D0300");
  CHECK(frames("drive 50000um/s") == "201#50C3000000000000");
  CHECK(frames("drive -.1m/s") == "201#6079FEFF00000000");
  CHECK(frames("drive 5cm/s -30deg/s") == frames("drive 50000um/s -523599urad/s"));  // 30 deg = 0.523599 rad
  CHECK(frames("drive stop") == "201#0000000000000000");
  CHECK(frames("set motors x=0.05m/s z=0.2rad/s") == "201#50C30000400D0300");
  CHECK(frames("set motors z=0.2rad/s --priority urgent") == "001#00000000400D0300");
  CHECK(frames("set led_8 green=255") == "243#00FF00");
  CHECK(frames("send 205#01840302") == "205#01840302");
  CHECK(frames("send 1F334455#DEADBEEF") == "1F334455#DEADBEEF");
}

TEST_CASE("stop brings the motors to rest first, then every sensor") {
  const std::string all = frames("stop");
  CHECK(all == frames("stop all"));
  CHECK(all.starts_with("201#0000000000000000 "));
  for (const auto& topic : amiro::catalogue.topics)
    if (topic.kind == protocol::Kind::sensor)
      CHECK(all.find(can::to_text(protocol::stop(topic.id, topic.priority)).view()) != std::string::npos);
  CHECK(parse("stop")->ends_hold);
  CHECK(parse("stop motors")->ends_hold);
  CHECK_FALSE(parse("stop gyro")->ends_hold);
}

TEST_CASE("options are values, and a script's line is split into words and values") {
  const CommandParser parser{amiro::catalogue, "amiroctl "};
  const std::string_view gyro[] = {"publish", "gyro", "500ms"};
  CHECK(can::to_text(parser.parse(gyro, {})->frames[0]) == "208#01F40100");
  CHECK(can::to_text(parser.parse(gyro, {protocol::Priority::high, {}})->frames[0]) == "108#01F40100");
  CHECK(frames("publish gyro --priority=high 500ms") == "108#01F40100");
  const std::string_view drive[] = {"drive", "5cm/s"};
  CHECK(parser.parse(drive, {{}, 2s})->hold->lasting == 2s);
  CHECK(parse("drive --for=2s 5cm/s")->hold->lasting == 2s);
  const std::string_view option[] = {"once", "--priority"};  // no option any more, but a word
  CHECK(parser.parse(option, {}).error.what == "no topic '--priority'");
  const std::string_view once[] = {"once"};
  CHECK(parser.parse(once, {}).error == WordError{1, "missing TOPIC", "usage: amiroctl once TOPIC"});
}

TEST_CASE("the value of an option is read alone, too") {
  CHECK(*read_lasting("1ns") == 1ns);
  CHECK(read_lasting("0s").error == WordError{0, "not a time above zero", "write 2s, 500ms or 1min"});
  CHECK(read_lasting("-1s").error.what == "not a time above zero");
  CHECK(read_lasting("5").error.what == "a time without a unit");
  CHECK(*read_every("100us") == 100us);
  CHECK(read_every("99999ns").error ==
        WordError{0, "not a time of 100us or more", "write 10ms, 1s or 500us"});
  CHECK(*read_priority("3") == protocol::Priority::low);
  CHECK(*read_priority("0") == protocol::Priority::urgent);
  CHECK(read_priority("").error ==
        WordError{0, "not a priority", "write urgent, high, medium or low, or 0 to 3"});
}

TEST_CASE("drive holds, until told otherwise or for a time") {
  const auto command = parse("drive 5cm/s --for 2s");
  REQUIRE(command.ok());
  REQUIRE(command->hold.has_value());
  CHECK(command->hold->lasting == 2s);
  CHECK(can::to_text(command->hold->rest) == "201#0000000000000000");
  CHECK(parse("drive 5cm/s")->hold->lasting == 0s);
  CHECK_FALSE(parse("drive stop")->hold.has_value());
}

TEST_CASE("what is wrong is said of the word where it stands") {
  struct Row {
    const char* line;
    std::size_t word;
    const char* what;
    const char* remedy;
  };
  const Row rows[] = {
      {"", 0, "no command", "publish"},
      {"pubish gyro", 0, "unknown command 'pubish'", "did you mean 'publish'?"},
      {"travel 10cm", 0, "unknown command 'travel'", "its set point: set travel FIELD=VALUE ..."},
      {"gyro 500ms", 0, "unknown command 'gyro'", "one of: publish, once, stop, drive, led, set, send"},
      {"publish", 1, "missing TOPIC", "usage: publish TOPIC [PERIOD]"},
      {"publish gyr 1s", 1, "no topic 'gyr'", "did you mean 'gyro'?"},
      {"publish zzzzzz 1s", 1, "no topic 'zzzzzz'", "one of: "},
      {"publish 0x99 1s", 1, "no topic '0x99'", "one of: "},
      {"publish 0x108 1s", 1, "no topic '0x108'", "it is the identifier of a request to gyroscope"},
      {"publish 0x06 1s", 1, "no topic '0x06'", "one of: "},  // a frame of the magnetometer, not a topic
      {"publish 1f 1s", 1, "no topic '1f'", "did you mean '0x1F' (proximity_ring)?"},
      {"publish 0x01 1s", 1, "'0x01' is an actuator", "set"},
      {"publish motor 1s", 1, "no topic 'motor'", "one of: "},  // actuators are not asked
      {"publish gyro --priority 4", 3, "'4' is not a priority", "0 to 3"},
      {"publish gyro --priority 00", 3, "'00' is not a priority", "0 to 3"},
      {"publish motors 1s", 1, "'motors' is an actuator", "set"},
      {"set gyro x=1", 1, "'gyro' is a sensor", "publish"},
      {"publish gyro 65.536s", 2, "cannot carry", "nearest: 65.535s"},
      {"publish gyro 0s", 2, "cannot carry", "nearest: 1us"},
      {"publish gyro 1.5us", 2, "cannot carry", "nearest: 1us"},
      {"publish gyro 0.1ns", 2, "cannot carry", "nearest: 1us"},
      {"publish gyro -1s", 2, "cannot carry", "nearest: 1us"},
      {"publish gyro -99999999999h", 2, "cannot carry", "nearest: 1us"},
      {"publish gyro 2.0000000001s", 2, "cannot carry", "nearest: 2s"},
      {"publish gyro 499.9999999ms", 2, "cannot carry", "nearest: 500ms"},
      {"publish gyro 65536s", 2, "cannot carry", "nearest: 65535s"},
      {"publish gyro 99999999999h", 2, "cannot carry", "nearest: 65535s"},
      {"publish gyro 500", 2, "'500' needs a unit: us, ms or s", "500ms"},
      {"publish gyro fast", 2, "not a period", "500ms"},
      {"publish gyro 1s 2s", 3, "unexpected argument '2s'", "usage: publish TOPIC"},
      {"publish gyro 500 ms", 3, "unexpected argument 'ms'", "write it as one word, 500ms"},
      {"publish gyro 500 sheep", 3, "unexpected argument 'sheep'", "usage: publish TOPIC"},
      {"drive 0 30 deg/s", 3, "unexpected argument 'deg/s'", "write it as one word, 30deg/s"},
      {"drive 5 cm/s", 1, "'5' needs a unit", "write it as one word, 5cm/s"},
      {"drive 5 deg/s", 1, "'5' needs a unit", "write 0.05m/s, 5cm/s or 50000um/s"},  // of the other field
      {"drive 50 cm/h/h", 1, "'50' needs a unit", "write 0.05m/s, 5cm/s or 50000um/s"},
      {"drive 5 cm/s 10 deg/s", 3, "unexpected argument '10'", "write it as one word, 5cm/s"},
      {"set motors x=5 cm/s", 2, "'5' needs a unit", "write it as one word, x=5cm/s"},
      {"set motors x=5 deg/s", 2, "'5' needs a unit", "for example x=0.1m/s"},
      {"set motors x=5 sheep", 2, "'5' needs a unit", "for example x="},
      {"publish gyro 5 cm", 3, "unexpected argument 'cm'", "usage: publish TOPIC"},
      {"led 1 grene", 2, "'grene' is not a colour", "did you mean 'green'?"},
      {"publish gyro 1s --priority top", 4, "'top' is not a priority", "urgent, high, medium or low"},
      {"publish gyro 1s --priority=top", 3, "'top' is not a priority", "urgent, high, medium or low"},
      {"publish gyro --priority", 2, "missing value for --priority", "write --priority high"},
      {"publish gyro --for 1s", 3, "--for goes with drive, and with set --every, only", ""},
      {"publish gyro --every 1s", 3, "--every goes with set only", "drop --every"},
      {"drive 5cm/s --force", 2, "--force goes with set only", "drop --force"},
      {"set led_1 red=1 --every 50us", 4, "'50us' is not a time of 100us or more", "write 10ms"},
      {"set led_1 red=1 --for 1s", 0, "--for without --every", "--every 100ms"},
      {"set motors x=1m/s --every 1s", 0, "motors is not set again and again", "use drive"},
      {"set led_1 red=1 --every", 3, "missing value for --every", "write --every 10ms"},
      {"once gyro --wait", 2, "a line takes no --wait", "of the verb alone"},
      {"drive 1 --dry-run", 2, "a line takes no --dry-run", "of the verb alone"},
      {"publish gyro --no-confirm 1s", 2, "a line takes no --no-confirm", "of the verb alone"},
      {"publish gyro --wat", 2, "unknown option '--wat'", "one of: --priority, --for"},
      {"publish gyro --priorty=low", 2, "unknown option '--priorty'", "did you mean '--priority'?"},
      {"once", 1, "missing TOPIC", "usage: once TOPIC"},
      {"stop gyr", 1, "no topic 'gyr'", "gyro"},
      {"led", 1, "missing N|all", "usage: led N|all COLOUR|off"},
      {"led 1", 2, "missing COLOUR|off", "usage: led N|all COLOUR|off"},
      {"led 0 red", 1, "no LED '0'", "1 to 8"},
      {"led 9 red", 1, "no LED '9'", "1 to 8"},
      {"led 1 reddish", 2, "not a colour", "#643278"},
      {"led 1 256,0,0", 2, "over 255", ""},
      {"led 1 1,2", 2, "not a colour", ""},
      {"led 1 1,2,3,4", 2, "not a colour", ""},
      {"led 1 #12345", 2, "not a colour", ""},
      {"led 1 #12345G", 2, "not a colour", ""},
      {"drive", 1, "missing X|stop", "usage: drive X|stop [Z]"},
      {"drive 1 2 3", 3, "unexpected argument '3'", "usage: drive X|stop [Z]"},
      {"drive fast", 1, "'fast' is not a number", "0.05m/s"},
      {"drive 5cm", 1, "another unit", "m/s"},
      {"drive 1.5", 1, "'1.5' needs a unit: x takes -1 to 1 m/s", "write 0.05m/s, 5cm/s or 50000um/s"},
      {"drive 500", 1, "'500' needs a unit", "50000um/s"},
      {"drive 0 1", 2, "'1' needs a unit: z takes -28.985507 to 28.985507 rad/s",
       "write 0.2rad/s or 30deg/s"},
      {"drive 99999999999", 1, "needs a unit", ""},
      {"drive 99999km/s", 1, "out of range: x takes -1 to 1 m/s", ""},
      {"drive 2000m/s", 1, "out of range: x takes -1 to 1 m/s", ""},
      {"drive 0.1m/s 1661deg/s", 2, "out of range: z takes", "rad/s"},
      {"set motors x=1000001um/s", 2, "out of range: x takes -1 to 1 m/s", "x=0.1m/s"},
      {"set motors x=1", 2, "'1' needs a unit: x takes -1 to 1 m/s", "for example x=1m/s"},
      {"set motors x=2", 2, "'2' needs a unit: x takes -1 to 1 m/s", "for example x=0.1m/s"},
      {"drive stop 5", 0, "drive stop takes no velocity", "usage: drive stop"},
      {"drive stop --for 2s", 0, "no --for", "usage: drive stop"},
      {"--for 2s drive stop", 2, "no --for", "usage: drive stop"},
      {"drive 1cm/s --for 0s", 3, "not a time above zero", "write 2s"},
      {"drive 1cm/s --for ever", 3, "not a time above zero", "write 2s"},
      {"drive 1cm/s --for 5", 3, "a time without a unit", "write 2s"},
      {"set motors", 2, "missing FIELD=VALUE", "usage: set ACTUATOR|MESSAGE [FIELD=VALUE ...]"},
      {"set motors y=1", 2, "no field 'y'", "x"},
      {"set motors x", 2, "not of the form FIELD=VALUE", "x=0"},
      {"set led_1 red", 2, "not of the form FIELD=VALUE", "red=0; `amiroctl led` takes colours"},
      {"set led_1 gren", 2, "no field 'gren'", "did you mean 'green'?"},
      {"set motors x=1cm/s x=2cm/s", 3, "given twice", ""},
      {"set motors x=", 2, "is not a number", "x"},
      {"set led_1 red=256", 2, "out of range", ""},
      {"set led_1 red=-1", 2, "out of range", ""},
      {"set led_1 red=1m", 2, "has a unit", ""},
      {"send", 1, "missing FRAME", "usage: send FRAME"},
      {"send 205", 1, "'205'", "205#01840302"},
      {"send 205#0", 1, "'205#0'", "205#01840302"},
      {"send 20#00", 1, "identifier", ""},
      {"send 0x205#00", 1, "the identifier is not three hex digits, or eight", ""},
      {"send 20G#00", 1, "the identifier is not three hex digits, or eight", ""},
      {"send FFF#00", 1, "identifier out of range for its format", ""},
      {"send FFFFFFFF#00", 1, "identifier out of range for its format", ""},
      {"send 1FFFFFFG#00", 1, "the identifier is not three hex digits, or eight", ""},
      {"send 205#001122334455667788", 1, "length", ""},
      {"send 20000004#", 1, "is an error frame", ""},
      {"send 123##", 1, "not of the expected form", "205##101840302"},
      {"send 123##8AA", 1, "not of the expected form", "205##101840302"},
      {"send 123##0112233445566778899", 1, "length", "12, 16, 20, 24, 32, 48 and 64"},
      {"send 205#00 --priority low", 3, "in its identifier", ""},
  };
  std::string whole;
  for (const auto& row : rows) {
    CAPTURE(row.line);
    const auto command = parse(row.line);
    REQUIRE_FALSE(command.ok());
    CHECK(command.error.word == row.word);
    CHECK_THAT(command.error.what, Catch::Contains(row.what));
    CHECK_THAT(command.error.remedy, Catch::Contains(row.remedy));
    whole += std::string{row.line} + "\n    " + command.error.what + "\n    " + command.error.remedy + "\n";
  }
  test::is_as_in("tests/tool/words/golden/command_errors.txt", whole);
}

TEST_CASE("a period that is written as a rate is met by the period, one in another unit by the units") {
  CHECK(parse("publish gyro 20Hz").error == WordError{2, "'20Hz' is a rate", "write its period, 50ms"});
  CHECK(parse("publish gyro 1.5kHz").error ==
        WordError{2, "'1.5kHz' is a rate", "write its period, 667us"});  // the nearest that there is
  CHECK(parse("publish gyro 5cm").error ==
        WordError{2, "'5cm' is in another unit", "write 500ms, 2s or 900us"});
}

TEST_CASE("a robot without motors and lights has neither drive nor led, but set and send") {
  const protocol::Catalogue bare{"bare", 500'000, {}, {}};
  const CommandParser parser{bare};
  const std::string_view drive[] = {"drive", "5cm/s"};
  const std::string_view led[] = {"led", "1", "red"};
  const std::string_view send[] = {"send", "123#"};
  const std::string_view stop[] = {"stop", "all"};
  CHECK_THAT(parser.parse_line(drive).error.what, Catch::Contains("nothing to drive"));
  CHECK_THAT(parser.parse_line(stop).error.what, Catch::Contains("nothing to stop"));
  CHECK_FALSE(parser.parse_line(std::span{stop}.first(1)).ok());
  CHECK_THAT(parser.parse_line(led).error.what, Catch::Contains("no lights"));
  CHECK(parser.parse_line(send).ok());
}

}  // namespace tool_words_command_test
