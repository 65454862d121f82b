#include "cli/fleet/line_request.hpp"

#include <chrono>
#include <string>

#include <catch2/catch.hpp>

namespace fleet_line_request_test {

using namespace std::chrono_literals;
using ocm::cli::fleet::LineRequest;
using ocm::cli::fleet::parse_line_request;
using Kind = LineRequest::Kind;

TEST_CASE("line request: each one") {
  const auto go = parse_line_request("go 3 -360 32767");
  REQUIRE(go);
  CHECK(go->kind == Kind::go);
  CHECK(go->robot == 3);
  CHECK(go->set_point == ocm::mapper::link::SetPoint{-360, 32767});
  const auto scan = parse_line_request("scan 60000");
  REQUIRE(scan);
  CHECK(scan->kind == Kind::scan);
  CHECK(scan->time == 60s);
  const auto list = parse_line_request("scan 0");  // what is known
  REQUIRE(list);
  CHECK(list->time == 0s);
  const auto back = parse_line_request("go 0 360 -32768");
  REQUIRE(back);
  CHECK(back->robot == 0);
  CHECK(back->set_point == ocm::mapper::link::SetPoint{360, -32768});
  const auto map = parse_line_request("map svg");
  REQUIRE(map);
  CHECK(map->kind == Kind::map);
  CHECK(map->form == "svg");
  const auto more = parse_line_request("more 48000");
  REQUIRE(more);
  CHECK(more->kind == Kind::more);
  CHECK(more->offset == 48000);
  REQUIRE(parse_line_request("more 0"));
  CHECK(parse_line_request("more 0")->offset == 0);
  for (const char* const form : {"svg", "png", "pdf", "pgm", "yaml", "grid"})
    CHECK(parse_line_request(std::string{"map "} + form));
  REQUIRE(parse_line_request("robots"));
  CHECK(parse_line_request("robots")->robot == 0);
  CHECK(parse_line_request("robots 127")->robot == 127);
  CHECK(parse_line_request("json 5")->kind == Kind::json);
  struct Word {
    const char* word;
    Kind kind;
  };
  for (const auto& [word, kind] :
       {Word{"connect", Kind::connect}, Word{"stop", Kind::stop}, Word{"leave", Kind::leave},
        Word{"pause", Kind::pause}, Word{"unpause", Kind::unpause}, Word{"ping", Kind::ping},
        Word{"who", Kind::who}, Word{"calibrate", Kind::calibrate}, Word{"compass", Kind::compass}}) {
    CAPTURE(word);
    const auto request = parse_line_request(std::string{word} + " 127");
    REQUIRE(request);
    CHECK(request->kind == kind);
    CHECK(request->robot == 127);
    CHECK_FALSE(parse_line_request(word));
    CHECK_FALSE(parse_line_request(std::string{word} + " 128"));
    CHECK_FALSE(parse_line_request(std::string{word} + " 1 1"));
  }
}

TEST_CASE("line request: what is none") {
  for (const char* text : {"",
                           " ",
                           "go",
                           "go 0 1",
                           "go 0 1 1 1",
                           "go 0 361 1",
                           "go 0 -361 1",
                           "go 0 1 32768",
                           "go 0 1 -32769",
                           "go -1 1 1",
                           "go 0x0 1 1",
                           "go +0 1 1",
                           "go 0 1.5 1",
                           "go 0  1 1",
                           " go 0 1 1",
                           "go 0 1 1 ",
                           "go\t0 1 1",
                           "stop 0\n",
                           "scan",
                           "scan -1",
                           "scan 60001",
                           "scan 1s",
                           "map",
                           "map SVG",
                           "map exe",
                           "more",
                           "more -1",
                           "more 99999999999999999999",
                           "robots 128",
                           "robots x",
                           "Stop 0",
                           "halt 0"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_line_request(text));
  }
  CHECK_FALSE(parse_line_request(std::string_view{"stop 0\0", 7}));
  CHECK_FALSE(parse_line_request(std::string(4096, ' ')));
}

}  // namespace fleet_line_request_test
