#include <chrono>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "ocm/protocol/wire_hash.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/serve/fleet_state.hpp"
#include "cli/serve/state.hpp"
#include "generator/spec/model.hpp"
#include "tool/bus_model/bus.hpp"

namespace serve_states_test {

using namespace std::chrono_literals;
using namespace std::string_literals;
using namespace ocm;
using namespace ocm::cli::serve;
using Json = nlohmann::json;

// --- the robot ---

TEST_CASE("states: a robot's topics, as a page needs them") {
  const Channels channels{test::catalogue, std::vector{"can0"s}};
  const Json robot = Json::parse(robot_state(test::catalogue, {}, channels, {"sim", true, false}));
  CHECK(robot["robot"] == "example");
  CHECK(robot["source"] == "sim");
  CHECK(robot["live"] == true);
  CHECK(robot["commands"] == false);
  CHECK(robot["boards"] == Json{"left", "right"});
  REQUIRE(robot["topics"].size() == 4);
  CHECK(robot["topics"][0] == Json::parse(R"({
    "channel": "/scale", "name": "scale", "interface": "can0", "kind": "sensor", "role": "", "board": "right",
    "frames": [
      {"name": "weight", "fields": [{"name": "weight", "unit": "g", "min": 0, "max": 1100}]},
      {"name": "state", "fields": [{"name": "state", "unit": "", "min": 0, "max": 255, "flags": true,
                                    "values": [{"name": "stable", "bit": 0}, {"name": "overload", "bit": 7}]}]}],
    "period_ms": 1000, "shortest_period_ms": 10})"));
  CHECK(robot["topics"][2] == Json::parse(R"({
    "channel": "/lamp_2", "name": "lamp_2", "interface": "can0", "kind": "actuator", "role": "light", "board": "left",
    "frames": [{"name": "", "fields": [{"name": "level", "unit": "", "min": 0, "max": 200}]}],
    "group": "lamp", "instance": 2})"));
}

TEST_CASE("states: each interface has the topics, and a log no commands") {
  const Channels channels{test::catalogue, std::vector{"can0"s, "can1"s}};
  const Json robot = Json::parse(robot_state(test::catalogue, {}, channels, {"drive.log", false, true}));
  CHECK(robot["live"] == false);
  CHECK(robot["commands"] == true);
  REQUIRE(robot["topics"].size() == 8);
  CHECK(robot["topics"][0]["channel"] == "/can0/scale");
  CHECK(robot["topics"][5]["channel"] == "/can1/lamp_1");
  CHECK(robot["topics"][5]["interface"] == "can1");
}

TEST_CASE("states: only a ring has a geometry, and names of values are numbers of the spec's unit") {
  spec::Model model;
  spec::TopicModel ring;
  ring.name = "proximity_ring";
  ring.geometry = spec::RingGeometry{{5, -2}, {2, 0}, {-5, -1}};
  model.topics.push_back(ring);
  model.topics.push_back({});
  model.topics.back().name = "gyroscope";
  const Channels channels{amiro::catalogue, std::vector{"sim"s}};
  const Json robot = Json::parse(robot_state(amiro::catalogue, model, channels, {"sim"}));
  std::size_t with_geometry = 0;
  for (const Json& topic : robot["topics"]) {
    if (topic.contains("geometry")) ++with_geometry;
    if (topic["name"] == "proximity_ring")
      CHECK(topic["geometry"] == Json{{"radius_m", 0.05},
                                      {"first_rad", 2.0},
                                      {"step_rad", -0.5},
                                      {"counts_at_one_metre", 0.942693757},
                                      {"range_m", 0.2}});
    if (topic["name"] == "power_status")
      CHECK(topic["frames"][0]["fields"][2]["values"] ==
            Json::parse(R"([{"name":"unknown","value":65535}])"));
  }
  CHECK(with_geometry == 1);
}

// --- the bus ---

TEST_CASE("states: a bus is its figures, and a row a topic") {
  cli::bus_model::Model model{test::catalogue, 250'000};
  // A sample of two frames a tenth of a second; the last one a little late, and half a one behind it.
  test::ask(model, -100ms, protocol::Mode::publish, {100, protocol::PeriodUnit::milliseconds});
  for (int i = 0; i < 10; ++i) test::weigh(model, i * 100ms, {i, 0});
  model.take(test::entry(910ms, 0x510, {0, 0, 0, 0}));
  model.take(test::entry(920ms, 0x510, {0, 0, 0, 0}));
  model.take(test::entry(930ms, 0x510, {0}));
  model.take(test::entry(940ms, 0x123, {1, 2}));
  model.lost(3);
  const std::vector<cli::bus_model::Bus> buses{{"can0", &model}};
  const Json state = Json::parse(bus_state(buses, test::morning + 950ms, {2, 5, 7}));
  CHECK(state["viewers"] == 2);
  CHECK(state["lost"] == 5);
  CHECK(state["refused"] == 7);
  REQUIRE(state["buses"].size() == 1);
  const Json& bus = state["buses"][0];
  const auto sum = model.summary(test::morning + 950ms);
  Json figures = bus;
  figures.erase("rows");
  CHECK(figures == Json{{"name", "can0"},
                        {"load", sum.load},
                        {"worst_load", sum.worst_load},
                        {"rate_hz", sum.rate_hz},
                        {"frames", 25},
                        {"errors", 0},
                        {"lost", 3},
                        {"incomplete", 1},
                        {"wrong_length", 1},
                        {"unknown", 1},
                        {"transport", 0},
                        {"transport_lost", 0},
                        {"not_in_load", 0},
                        {"not_shown", 0}});
  CHECK(sum.load > 0.005);
  REQUIRE(bus["rows"].size() == 2);
  Json scale = bus["rows"][0];
  CHECK(scale["rate_hz"].get<double>() == Approx(10));
  CHECK(scale["jitter_ms"].get<double>() == Approx(0).margin(1e-6));
  CHECK(scale["share"].get<double>() > 0.005);
  for (const char* const measured : {"rate_hz", "jitter_ms", "share"}) scale.erase(measured);
  CHECK(scale == Json{{"name", "scale"},
                      {"known", true},
                      {"count", 10},
                      {"frames", 23},
                      {"incomplete", 1},
                      {"wrong_length", 1},
                      {"faults", 2},
                      {"age_s", 0.05},
                      {"period_s", 0.1},
                      {"health", "fine"}});
  const Json& unknown = bus["rows"][1];
  CHECK(unknown["name"] == "123");
  CHECK(unknown["known"] == false);
  CHECK(unknown["count"] == 1);
  for (const char* const open : {"rate_hz", "jitter_ms", "period_s"}) CHECK(unknown[open].is_null());
  CHECK(unknown["age_s"] == 0.01);
  // Later it is late, and then missing.
  const auto health = [&](base::Duration at) {
    return Json::parse(bus_state(buses, test::morning + at, {}))["buses"][0]["rows"][0]["health"];
  };
  CHECK(health(900ms + 170ms) == "late");
  CHECK(health(900ms + 310ms) == "missing");
}

TEST_CASE("states: jitter is in milliseconds") {
  cli::bus_model::Model model{test::catalogue, 250'000};
  // 90 and 110 ms in turns: 10 ms from their mean.
  for (int i = 0; i < 10; ++i) test::weigh(model, i * 100ms + (i % 2 == 0 ? 0ms : 10ms), {i, 0});
  const std::vector<cli::bus_model::Bus> buses{{"can0", &model}};
  const Json row = Json::parse(bus_state(buses, test::morning + 950ms, {}))["buses"][0]["rows"][0];
  CHECK(row["jitter_ms"].get<double>() > 5);
  CHECK(row["jitter_ms"].get<double>() < 25);
}

TEST_CASE("states: of a bus without a bit rate no load is known") {
  cli::bus_model::Model model{test::catalogue, 0};
  test::weigh(model, 0s, {1, 0});
  const std::vector<cli::bus_model::Bus> buses{{"can0", &model}, {"can1", &model}};
  const Json state = Json::parse(bus_state(buses, test::morning + 1s, {}));
  REQUIRE(state["buses"].size() == 2);
  CHECK(state["buses"][1]["name"] == "can1");
  CHECK(state["buses"][0]["load"].is_null());
  CHECK(state["buses"][0]["worst_load"].is_null());
  CHECK(state["buses"][0]["rows"][0]["share"].is_null());
  for (const char* const figure : {"viewers", "lost", "refused"}) CHECK(state[figure] == 0);
}

// --- the boards ---

/// What boards have said, and were asked.
struct Boards {
  void take(std::uint32_t id, std::initializer_list<int> bytes) {
    const log::Entry entry = test::entry(0s, id, bytes);
    const client::Reception reception = receiver.take({entry.time, *entry.classic()});
    diagnosis.take(reception);
    asked.take({entry.time, *entry.classic()}, reception);
  }
  Json state(std::vector<client::Finding> findings = {}) const {
    return Json::parse(boards_state(amiro::catalogue, diagnosis, asked, findings));
  }
  client::Receiver receiver{amiro::catalogue, client::Transport::together};
  client::Diagnosis diagnosis{amiro::catalogue};
  client::StatusRequests asked{amiro::catalogue};
};

TEST_CASE("states: of boards that say nothing there is only that") {
  const Json state = Boards{}.state();
  REQUIRE(state["boards"].size() == 3);
  CHECK(state["boards"][0] == Json{{"board", "di_wheel_drive"},
                                   {"answers", false},
                                   {"heard", false},
                                   {"asked", false},
                                   {"has_status", true}});
  CHECK(state["boards"][2]["board"] == "light_ring");
  CHECK(state["battery_percent"].is_null());
  CHECK(state["plugged"] == false);
  CHECK(state["findings"] == Json::array());
}

TEST_CASE("states: a board's status, the battery, and what was found") {
  Boards boards;
  constexpr std::uint32_t hash = protocol::wire_hash(amiro::catalogue);
  const auto byte = [](unsigned i) { return static_cast<int>(hash >> 8 * i & 0xFF); };
  // Up for 258 s, started by a watchdog; a load of 42 %, its controller passive; the first and the third of
  // its sensors are published, the second one's part is silent; 5 errors on the bus.
  boards.take(0x71B, {2, 1, 0, 4, byte(0), byte(1), byte(2), byte(3)});
  boards.take(0x71C, {42, 2, 5, 2, 0, 0, 5, 0});
  boards.take(0x71D, {2, 7, 3, 0, 0, 0, 9, 0});  // three refusals, nine frames lost on the line
  boards.take(0x61E, {1, 87, 0, 0, 0, 0});       // a battery at 87 %, plugged
  const Json state = boards.state({{client::Severity::warning, "light_ring", "is odd", "look"}});
  Json sensors;
  for (const protocol::Topic& topic : amiro::catalogue.topics)
    if (topic.kind == protocol::Kind::sensor && topic.board == 0) sensors.push_back(topic.name);
  CHECK(state["boards"][0] ==
        Json{{"board", "di_wheel_drive"},
             {"answers", true},
             {"heard", true},
             {"asked", false},
             {"has_status", true},
             {"uptime_s", 258},
             {"reset", "watchdog"},
             {"same_spec", true},
             {"load_percent", 42},
             {"bus", "passive"},
             {"publishing", sensors[0].get<std::string>() + ", " + sensors[2].get<std::string>()},
             {"faults", sensors[1]},
             {"bus_errors", 5},
             {"refused", 3},
             {"line_lost", 9}});
  CHECK(state["boards"][1]["heard"] == true);
  CHECK(state["boards"][1]["answers"] == false);
  CHECK(state["battery_percent"] == 87);
  CHECK(state["plugged"] == true);
  CHECK(state["findings"] ==
        Json::parse(R"([{"severity":"warning","board":"light_ring","what":"is odd","remedy":"look"}])"));
  // Of another spec, and with a load that it does not know.
  boards.take(0x71B, {2, 1, 0, 4, byte(0) ^ 1, byte(1), byte(2), byte(3)});
  boards.take(0x71C, {255, 0, 0, 0, 0, 0, 0, 0});
  boards.take(0x61E, {0, 87, 0, 0, 0, 0});
  const Json other = boards.state();
  CHECK(other["boards"][0]["same_spec"] == false);
  CHECK(other["boards"][0]["load_percent"].is_null());
  CHECK(other["plugged"] == false);
}

TEST_CASE("states: which boards were asked") {
  Boards boards;
  for (const protocol::Topic& topic : amiro::catalogue.topics)
    if (topic.name == "power_management_status") {
      const can::Frame request = protocol::once(topic.id, topic.priority);
      const client::Reception reception = boards.receiver.take({test::morning, request});
      boards.asked.take({test::morning, request}, reception);
    }
  const Json state = boards.state();
  CHECK(state["boards"][0]["asked"] == false);
  CHECK(state["boards"][1]["asked"] == true);
}

TEST_CASE("states: where a log is") {
  CHECK(playback_state({1500ms, 3min, 0.25, true}, false, 4) ==
        R"({"at_s":1.5,"length_s":180.0,"speed":0.25,"paused":false,"ended":true,"jumps":4})");
  CHECK(playback_state({0s, 1ns, 64, false}, true, 0) ==
        R"({"at_s":0.0,"length_s":1e-09,"speed":64.0,"paused":true,"ended":false,"jumps":0})");
}

// --- robots behind a central ---

TEST_CASE("states: a robot behind a central") {
  cli::fleet::RobotNow robot;
  robot.name = "AVR";
  robot.by = "goto (process 12)";
  const base::Time now{1h};
  const auto json = [&](std::optional<motion::Point> target = {}) {
    return Json::parse(fleet_robot(robot, now, target).line());
  };
  Json first = json();
  CHECK(first["robot"] == "AVR");
  CHECK(first["progress"] == false);
  CHECK(first["by"] == "goto (process 12)");
  for (const char* const open : {"age_s", "at", "target"}) CHECK(first[open].is_null());
  robot.progress = mapper::server::Progress::heard;
  robot.updated = now - 1500ms;
  robot.update.emplace();
  robot.update->x = 100;
  robot.update->y = 50;
  robot.update->heading = 0;
  robot.origin = {1, 2, 0};
  const Json second = json(motion::Point{0.5F, -0.25F});
  CHECK(second["progress"] == true);
  CHECK(second["age_s"] == 1.5);
  CHECK(second["at"].is_null());  // where it began is not known
  CHECK(second["target"] == Json{{"x_m", 0.5}, {"y_m", -0.25}});
  robot.origin_known = true;
  const Json third = json();
  CHECK(third["at"]["x_m"].get<double>() == Approx(2));
  CHECK(third["at"]["y_m"].get<double>() == Approx(2.5));
  CHECK(third["at"]["heading_rad"].get<double>() == Approx(0).margin(1e-6));
  CHECK(third["target"].is_null());
  robot.update.reset();
  CHECK(json()["at"].is_null());
}

TEST_CASE("states: all robots, and the map's message") {
  CHECK(fleet_state("drive.txt", cli::Json::array(), cli::Json::array()).line() ==
        R"({"line":"drive.txt","own":false,"gone":"","scans":false,"map_by":"","unplaced":[],"robots":[]})");
  CHECK(map_message(R"({"frame_id":"map"})", 1'700'000'000'987'654'321) ==
        R"({"timestamp":{"sec":1700000000,"nsec":987654321},"frame_id":"map"})");
}

TEST_CASE("states: a map comes once a second, and is no more than half a megabyte of it") {
  CHECK(map_interval(0) == 1s);
  CHECK(map_interval(512 * 1024) == 1s);
  CHECK(map_interval(768 * 1024) == 1500ms);
  CHECK(map_interval(2 * 1024 * 1024) == 4s);
}

}  // namespace serve_states_test
