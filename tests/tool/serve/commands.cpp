#include "cli/serve/commands.hpp"

#include <chrono>
#include <optional>
#include <string>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace serve_commands_test {

using ocm::cli::serve::command_of;
using ocm::cli::serve::period_command;
using ocm::cli::serve::playback_of;

using namespace std::chrono_literals;

const auto& catalogue = amiro::catalogue;

TEST_CASE("serve: fields that are published become a set point, in the spec's units") {
  const auto drive = command_of(catalogue, "/motors", R"({"x":0.1,"z":-5e-1})");
  REQUIRE(drive);
  REQUIRE(drive->hold);
  CHECK(drive->frames.empty());
  CHECK(drive->hold->frame.id == 0x201);
  CHECK(drive->hold->frame.data == ocm::can::Payload{0xA0, 0x86, 0x01, 0x00, 0xE0, 0x5E, 0xF8, 0xFF});
  CHECK(drive->hold->rest.data == ocm::can::Payload{});
  const auto light = command_of(catalogue, "/led_2", R"({"red":255,"blue":1})");
  REQUIRE(light);
  CHECK_FALSE(light->hold);
  REQUIRE(light->frames.size() == 1);
  CHECK(light->frames[0].data[0] == 255);
  CHECK(light->frames[0].data[2] == 1);
}

TEST_CASE("serve: lines are those of a script, of what is sent once") {
  const auto line = command_of(catalogue, "/ocm/command", R"({"line":"  publish gyro   50ms "})");
  REQUIRE(line);
  CHECK(line->frames.size() == 1);
  CHECK(command_of(catalogue, "/ocm/command", R"({"line":"stop all"})")->ends_hold);
  CHECK_FALSE(command_of(catalogue, "/ocm/command", R"({"line":"drive 0.1m/s"})"));
  CHECK_FALSE(command_of(catalogue, "/ocm/command", R"({"line":"set led_1 red=1 --every 10ms"})"));
  CHECK(command_of(catalogue, "/ocm/command", R"({"line":"fly"})").error.find("'fly'") != std::string::npos);
  CHECK_FALSE(command_of(catalogue, "/ocm/command", R"({"line":""})"));
  CHECK_FALSE(command_of(catalogue, "/ocm/command", R"({"words":1})"));
}

TEST_CASE("serve: what cannot be commanded is refused in words") {
  CHECK(command_of(catalogue, "/gyroscope", "{}").error.find("takes nothing") != std::string::npos);
  CHECK_FALSE(command_of(catalogue, "/unheard", "{}"));
  CHECK_FALSE(command_of(catalogue, "", "{}"));
  for (const char* const other : {"/can0/motors", "motors", "//motors", "/motors/", "/", "x/motors"})
    CHECK(command_of(catalogue, other, R"({"x":0.1})").error.find("takes nothing") != std::string::npos);
  CHECK_FALSE(command_of(catalogue, "/motors", std::string{R"({"x":0.1})"} + '\0'));
  CHECK_FALSE(command_of(catalogue, "/motors", "0.1"));
  CHECK_FALSE(command_of(catalogue, "/motors", R"({"x":)"));
  CHECK(command_of(catalogue, "/motors", R"({"y":1})").error.find("y") != std::string::npos);
  CHECK_FALSE(command_of(catalogue, "/motors", R"({"x":1e300})"));
  CHECK_FALSE(command_of(catalogue, "/motors", R"({"x":[1]})"));
  CHECK_FALSE(command_of(catalogue, "/motors", R"({"x":"fast"})"));
}

TEST_CASE("serve: what is no number, and what is missing, is refused by its name") {
  const auto why = [](std::string_view topic, std::string_view payload) {
    const auto command = command_of(catalogue, topic, payload);
    return command ? std::string{"taken"} : command.error;
  };
  CHECK(why("/motors", R"({"x":null})") == R"(x: expected a number in m/s, such as {"x":0}, and got null)");
  CHECK(why("/motors", R"({"z":true})") == R"(z: expected a number in rad/s, such as {"z":0}, and got true)");
  CHECK(why("/motors", R"({"x":[1]})") == R"(x: expected a number in m/s, such as {"x":0}, and got a list)");
  CHECK(why("/led_1", R"({"red":{}})") == R"(red: expected a number, such as {"red":0}, and got an object)");
  CHECK(why("/led_1", R"({"red":true})") == "taken");
  CHECK(why("/motors", "{}") == R"(no field in it: expected at least one, such as {"x":0})");
  for (const char* const empty : {"", "  \n"})
    CHECK(why("/motors", empty) == R"(an empty message: expected an object of fields, such as {"x":0.1})");
}

TEST_CASE("serve: a parameter is a period in milliseconds") {
  CHECK(period_command(catalogue, "gyroscope", 50)->frames[0] ==
        command_of(catalogue, "/ocm/command", R"({"line":"publish gyro 50ms"})")->frames[0]);
  CHECK(period_command(catalogue, "gyroscope", 1.25)->frames[0] ==
        command_of(catalogue, "/ocm/command", R"({"line":"publish gyro 1250us"})")->frames[0]);
  CHECK(period_command(catalogue, "gyroscope", 0)->frames[0] ==
        command_of(catalogue, "/ocm/command", R"({"line":"stop gyro"})")->frames[0]);
  CHECK_FALSE(period_command(catalogue, "gyroscope", -1));
  CHECK_FALSE(period_command(catalogue, "gyroscope", 1e12));
}

TEST_CASE("serve: a time bar") {
  const auto all = playback_of(R"({"at_s":12.5,"speed":2,"paused":true})");
  REQUIRE(all);
  CHECK(all->at == 12500ms);
  CHECK(all->speed == 2);
  CHECK(all->paused == 1);
  CHECK(playback_of("{}")->paused == -1);
  CHECK(playback_of("{}")->at == std::nullopt);
  CHECK(playback_of(R"({"at_s":4.261999625})")->at == 4261999625ns);  // times 1e9 it is 4261999624.9999995
  for (const char* const text :
       {R"({"at_s":-1})", R"({"speed":0})", R"({"speed":1e9})", R"({"paused":1})", R"({"x":1})", "[]"}) {
    INFO(text);
    CHECK_FALSE(playback_of(text));
  }
}

TEST_CASE("serve: the ends of a time bar, and of a period") {
  for (const char* const text :
       {R"({"speed":0.015625})", R"({"speed":1024})", R"({"at_s":0})", R"({"at_s":999999999})"}) {
    INFO(text);
    CHECK(playback_of(text));
  }
  for (const char* const text : {R"({"speed":0.0156})", R"({"speed":1024.5})", R"({"at_s":1e9})",
                                 R"({"at_s":"1"})", R"({"speed":true})", R"({"paused":"true"})"}) {
    INFO(text);
    CHECK(playback_of(text).error == "a time bar takes at_s in seconds, speed from 1/64 to 1024, and paused");
  }
  CHECK(playback_of(R"({"paused":false})")->paused == 0);
  CHECK(playback_of("{}")->speed == 0);
  CHECK(period_command(catalogue, "gyroscope", 65'535)->frames[0] ==
        command_of(catalogue, "/ocm/command", R"({"line":"publish gyro 65535ms"})")->frames[0]);
  CHECK(period_command(catalogue, "gyroscope", 1e9).error.find("1000000000 ms") == std::string::npos);
  CHECK(period_command(catalogue, "gyroscope", 1.1e9).error.find("1100000000 ms is no period") == 0);
}

TEST_CASE("serve: numbers as JSON writes them") {
  const auto x = [](const char* number) {
    return command_of(catalogue, "/motors", std::string{R"({"x":)"} + number + "}")->hold->frame;
  };
  for (const char* const number : {"1E-1", "1e-1", "0.10", "100e-3"}) {
    INFO(number);
    CHECK(x(number) == x("0.1"));
  }
  CHECK(command_of(catalogue, "/led_1", R"({"red":false,"green":true})")->frames[0].data[1] == 1);
  CHECK(command_of(catalogue, "/motors", R"({"x":"0.1m/s"})")->hold->frame == x("0.1"));
}

}  // namespace serve_commands_test
