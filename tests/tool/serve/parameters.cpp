#include "cli/serve/parameters.hpp"

#include <chrono>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace serve_parameters_test {

using namespace std::chrono_literals;
using namespace ocm::cli::serve;
using ocm::cli::bus_model::Row;
using Kind = Order::Kind;

struct Desk {
  Viewers viewers{1};
  Parameters parameters{amiro::catalogue, viewers};
  ViewerId viewer = viewers.add();
  std::vector<Row> rows;

  void publishes(std::string_view sensor, std::optional<ocm::base::Duration> period) {
    Row row;
    row.topic = amiro::catalogue.find(sensor);
    row.name = sensor;
    row.period = period;
    rows.push_back(row);
  }
  void take(Kind kind, std::vector<std::string> names, std::string request = {}) {
    Order order{kind, viewer};
    order.names = std::move(names);
    order.payload = std::move(request);
    parameters.take(order, rows);
  }
  std::string said() {
    std::string text;
    while (const auto message = viewers.next(viewer, ocm::base::Time{})) text += *message->payload + "\n";
    return text;
  }
};

TEST_CASE("parameters: a period is what the bus shows") {
  Desk desk;
  desk.publishes("gyroscope", 50ms);
  desk.publishes("accelerometer", std::nullopt);
  desk.take(Kind::get_parameters,
            {"/gyroscope/period_ms", "/accelerometer/period_ms", "/magnetometer/period_ms", "/x"}, "r");
  const std::string said = desk.said();
  CHECK(said.find(R"("name":"/gyroscope/period_ms","value":50)") != std::string::npos);
  CHECK(said.find(R"("name":"/accelerometer/period_ms","value":0)") != std::string::npos);
  CHECK(said.find(R"("name":"/magnetometer/period_ms"})") != std::string::npos);  // nothing of it came
  CHECK(said.find("/x") == std::string::npos);
  CHECK(said.find(R"("id":"r")") != std::string::npos);
  desk.take(Kind::get_parameters, {});
  CHECK(desk.said().find("/proximity_ring/period_ms") != std::string::npos);
}

TEST_CASE("parameters: what was set is confirmed as the bus shows it a while later") {
  Desk desk;
  desk.publishes("gyroscope", 5ms);
  desk.take(Kind::confirm_parameters, {"/gyroscope/period_ms"}, "r");
  CHECK(desk.parameters.wanted());
  desk.parameters.update(desk.rows);
  CHECK(desk.said().empty());
  desk.rows[0].period = 50ms;  // refused since
  desk.parameters.update(desk.rows);
  const std::string said = desk.said();
  CHECK(said.find(R"("name":"/gyroscope/period_ms","value":50)") != std::string::npos);
  CHECK(said.find(R"("id":"r")") != std::string::npos);
  CHECK_FALSE(desk.parameters.wanted());
  desk.parameters.update(desk.rows);
  CHECK(desk.said().empty());

  desk.take(Kind::confirm_parameters, {"/gyroscope/period_ms"}, "s");
  desk.take(Kind::gone, {});
  CHECK_FALSE(desk.parameters.wanted());
  for (std::size_t i = 0; i < Orders::most; ++i)
    desk.take(Kind::confirm_parameters, {"/gyroscope/period_ms"}, "t");
  CHECK(desk.said().empty());
  desk.take(Kind::confirm_parameters, {"/gyroscope/period_ms"}, "u");  // too many wait: this one does not
  CHECK(desk.said().find(R"("id":"u")") != std::string::npos);
}

TEST_CASE("parameters: who subscribes gets the value, and each change of it") {
  Desk desk;
  desk.publishes("gyroscope", 50ms);
  CHECK_FALSE(desk.parameters.wanted());
  desk.take(Kind::subscribe_parameters, {"/gyroscope/period_ms", "/x"});
  CHECK(desk.parameters.wanted());
  CHECK(desk.said().find("\"value\":50") != std::string::npos);
  desk.parameters.update(desk.rows);
  CHECK(desk.said().empty());
  desk.rows[0].period = 20'500us;
  desk.parameters.update(desk.rows);
  CHECK(desk.said().find("\"value\":20.5") != std::string::npos);
  desk.rows[0].period.reset();
  desk.parameters.update(desk.rows);
  CHECK(desk.said().find("\"value\":0") != std::string::npos);
  desk.take(Kind::unsubscribe_parameters, {"/gyroscope/period_ms"});
  CHECK_FALSE(desk.parameters.wanted());
  desk.take(Kind::subscribe_parameters, {"/gyroscope/period_ms"});
  CHECK_FALSE(desk.said().empty());
  desk.take(Kind::gone, {});
  CHECK_FALSE(desk.parameters.wanted());
  desk.take(Kind::subscribe_parameters, {"/x"});
  CHECK_FALSE(desk.parameters.wanted());
}

TEST_CASE("parameters: a period in whole microseconds, and of all parameters those of sensors alone") {
  Desk desk;
  desk.publishes("gyroscope", 33'333'333ns);
  desk.take(Kind::get_parameters, {});
  const std::string said = desk.said();
  CHECK(said.find(R"("name":"/gyroscope/period_ms","value":33.333,)") != std::string::npos);
  CHECK(said.find("/motors/") == std::string::npos);
  std::size_t count = 0, sensors = 0;
  for (std::size_t at = 0; (at = said.find("/period_ms", at)) != std::string::npos; ++at) ++count;
  for (const auto& topic : amiro::catalogue.topics)
    sensors += topic.kind == ocm::protocol::Kind::sensor ? 1U : 0U;
  CHECK(count == sensors);
}

TEST_CASE("parameters: their names") {
  CHECK(sensor_of(amiro::catalogue, "/gyroscope/period_ms") == amiro::catalogue.find("gyroscope"));
  for (const char* name :
       {"", "/", "gyroscope", "/gyroscope", "/period_ms", "/motors/period_ms", "/nothing/period_ms"})
    CHECK(sensor_of(amiro::catalogue, name) == nullptr);
  CHECK(parameter_of(*amiro::catalogue.find("gyroscope")) == "/gyroscope/period_ms");
}

}  // namespace serve_parameters_test
