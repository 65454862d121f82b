// spec/tasks.json against the schema that an editor has of it, and what the schema must see.
#include <fstream>
#include <string>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

namespace {

using Json = nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

Json read(const std::string& name) {
  std::ifstream in{std::string{OCM_SOURCE_DIR} + "/spec/" + name};
  REQUIRE(in);
  return Json::parse(in);
}

}  // namespace

TEST_CASE("the task sets keep to their schema, which tells what does not") {
  valijson::Schema schema;
  const Json text = read("tasks.schema.json");
  valijson::SchemaParser{}.populateSchema(Adapter{text}, schema);
  const auto good = [&](const Json& sets) {
    valijson::Validator validator;
    return validator.validate(schema, Adapter{sets}, nullptr);
  };
  const Json sets = read("tasks.json");
  CHECK(good(sets));

  const auto changed = [&](const char* pointer, const Json& value) {
    Json other = sets;
    other[Json::json_pointer{pointer}] = value;
    return other;
  };
  CHECK(good(changed("/sets/0/tasks/0/cost", "53us")));
  CHECK_FALSE(good(changed("/sets/0/tasks/0/cost", "53")));
  CHECK_FALSE(good(changed("/sets/0/tasks/0/cost", 53)));
  CHECK_FALSE(good(changed("/sets/0/tasks/0/costs", "53us")));
  CHECK_FALSE(good(changed("/sets/0/tasks/0/name", "Control")));
  CHECK_FALSE(good(changed("/sets/0/tasks", Json::array())));
  CHECK_FALSE(good(changed("/sets/0/bus_percent", 101)));
  CHECK_FALSE(good(Json::object()));
  for (const char* needed : {"name", "cost", "period", "level"}) {
    Json other = sets;
    other["sets"][0]["tasks"][0].erase(needed);
    CAPTURE(needed);
    CHECK_FALSE(good(other));
  }
}
