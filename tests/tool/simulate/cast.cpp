// What sim plays of a spec, on which bus, and at which bit rates.
#include "cli/simulate/cast.hpp"

#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/simulate/run.hpp"
#include "tests/tool/captured.hpp"
#include "unit/host/host_testing.hpp"

namespace simulate_cast_test {

using namespace ocm;
using cli::simulate::Cast;
using Words = std::vector<std::string>;

/// One that lasts as long as the program: a spec is left to the end of it.
cli::Session& session_of(Words specs, std::string bus = {}) {
  static auto& all = *new std::vector<std::unique_ptr<cli::Session>>;
  all.push_back(std::make_unique<cli::Session>());
  all.back()->spec_files = std::move(specs);
  all.back()->bus_name = std::move(bus);
  return *all.back();
}

struct Played {
  Cast cast = Cast::amiro;
  std::string said;
  Words specs;  ///< that are left
};
Played played(Words specs, std::string bus = {}) {
  cli::Session& session = session_of(std::move(specs), std::move(bus));
  test::Captured said{STDERR_FILENO};
  const Cast cast = cli::simulate::cast_of(session);
  return {cast, said.text(), session.spec_files};
}

const std::string message =
    R"({"name": "Extra", "id": "0x7F0", "length": 1, "period": "20ms", "fields": []})";
const std::string field = R"({"name": "x", "byte": 0, "type": "i16"})";

std::string topic(const std::string& name, const std::string& id, const std::string& more = {}) {
  return R"({"name": ")" + name + R"(", "id": ")" + id +
         R"(", "board": "wheels", "source": "decided: for tests", )" + more + R"("frames": [{"fields": [)" +
         field + "]}]}";
}

/// Specs, one with these topics, and with messages, too.
struct Files {
  test::TemporaryDirectory folder;

  [[nodiscard]] std::string file(const std::string& name, const std::string& text) const {
    const std::string path = folder.file(name);
    std::ofstream{path} << text;
    return path;
  }
  [[nodiscard]] std::string of_messages(const std::string& name = "car.json",
                                        const std::string& bus = {}) const {
    return file(name, R"({"robot": "car", )" + bus + R"("messages": [)" + message + "]}");
  }
  [[nodiscard]] std::string of_topics(const std::string& topics, bool has_message = false) const {
    const std::string messages = has_message ? R"(, "messages": [)" + message + "]" : "";
    return file("robot.json", R"({"robot": "Other", "namespace": "other", "description": "a few topics",
      "bus": {"bit_rate": 500000, "source": "decided"},
      "defaults": {"period": "100ms", "deadline": "100ms", "jitter": "1ms", "priority": "medium",
                   "source": "decided: for tests"},
      "boards": [{"name": "wheels", "description": "all of it", "mcu": "STM32G0B1", "source": "decided"}],
      "topics": [)" + topics + "]" +
                                  messages + "}");
  }
};

TEST_CASE("sim: the AMiRo is played, or the messages of a spec, or both") {
  const Files files;
  const Played without_spec = played({});
  CHECK(without_spec.cast == Cast::amiro);
  CHECK(without_spec.said.empty());
  const Played of_messages = played({files.of_messages()});
  CHECK(of_messages.cast == Cast::messages);
  CHECK(of_messages.said.empty());
  const std::string own = topic("gyroscope", "0x08");  // as the AMiRo has it
  const Played of_topics = played({files.of_topics(own)});
  CHECK(of_topics.cast == Cast::amiro);
  CHECK(of_topics.said.empty());
  const Played of_both = played({files.of_topics(own, true)});
  CHECK(of_both.cast == Cast::both);
  CHECK(of_both.said.empty());
  // Of nodes alone there is nothing to say.
  CHECK(played({files.file("nodes.dbc", "VERSION \"\"\nBU_: A\n")}).cast == Cast::messages);
}

TEST_CASE("sim: beside messages, topics that are not the AMiRo's are left out, and that is said") {
  const Files files;
  const std::string own = topic("gyroscope", "0x08");
  const std::string two_frames =
      R"({"name": "gyroscope", "id": "0x08", "board": "wheels", "source": "decided: for tests", "frames": [
           {"name": "a", "id": "0x08", "fields": [)" +
      field + R"(]}, {"name": "b", "id": "0x09", "fields": [)" + field + "]}]}";
  for (const std::string& topics :
       {topic("gyroscope", "0x10"), topic("speedometer", "0x08"),
        topic("gyroscope", "0x08", R"("kind": "actuator", )"), two_frames,
        own + ", " + topic("speedometer", "0x10"), topic("speedometer", "0x10") + ", " + own}) {
    CAPTURE(topics);
    const Played beside = played({files.of_topics(topics, true)});
    CHECK(beside.cast == Cast::messages);
    CHECK(beside.said ==
          "only the messages of the spec are played: its topics are not the AMiRo's, and no other robot's "
          "boards are simulated\n");
    const Played alone = played({files.of_topics(topics)});
    CHECK(alone.cast == Cast::amiro);
    CHECK(alone.said.empty());
  }
}

TEST_CASE("sim: of specs for single interfaces it plays that of its bus, or else says whose it plays") {
  const Files files;
  const std::string messages = files.of_messages(), robot = files.of_topics(topic("gyroscope", "0x08"));
  const Played of_the_only_one = played({"can0=" + messages});
  CHECK(of_the_only_one.cast == Cast::messages);
  CHECK(of_the_only_one.specs == Words{messages});
  CHECK(of_the_only_one.said ==
        fmt::format("what --spec has for can0 is played on the bus sim: for other verbs, --spec sim={}\n",
                    messages));
  const Played of_sim = played({"can0=" + messages, "sim=" + robot});
  CHECK(of_sim.cast == Cast::amiro);
  CHECK(of_sim.specs == Words{robot});
  CHECK(of_sim.said.empty());
  const Played of_can0 = played({"can0=" + messages, "sim=" + robot}, "can0");
  CHECK(of_can0.cast == Cast::messages);
  CHECK(of_can0.specs == Words{messages});
  CHECK(of_can0.said.empty());
}

TEST_CASE("sim: bit rates are as typed, else as the spec says that is played, else the usual ones") {
  const Files files;
  using Rate = std::optional<std::uint32_t>;
  const auto rates = [](Rate typed, Rate typed_data, Words specs, bool plays = true) {
    const auto found =
        cli::simulate::bit_rates(typed, typed_data, 500'000, session_of(std::move(specs)), plays);
    return fmt::format("{} {}", found.nominal, found.data);
  };
  const Words says_both = {
      files.of_messages("both.json", R"("bus": {"bit_rate": 250000, "data_bit_rate": 1000000}, )")};
  const Words says_one = {files.of_messages("one.json", R"("bus": {"bit_rate": 250000}, )")};
  const Words says_none = {files.of_messages()};
  CHECK(rates({}, {}, says_both) == "250000 1000000");
  CHECK(rates({}, {}, says_one) == "250000 1000000");  // four times as fast
  CHECK(rates({}, {}, says_none) == "500000 2000000");
  CHECK(rates(125'000, {}, says_one) == "125000 500000");
  CHECK(rates({}, 3'000'000, says_both) == "250000 3000000");
  CHECK(rates(125'000, 125'000, says_both) == "125000 125000");
  // What the spec says of data holds as long as these are no slower than the rest.
  CHECK(rates(500'000, {}, says_both) == "500000 1000000");
  CHECK(rates(1'000'000, {}, says_both) == "1000000 1000000");
  CHECK(rates(1'000'001, {}, says_both) == "1000001 4000004");
  // Four times as fast, as far as there is such a bus.
  CHECK(rates(250'000'000, {}, says_none) == "250000000 1000000000");
  CHECK(rates(250'000'001, {}, says_none) == "250000001 250000001");
  // A spec that is not played is not asked, nor read.
  CHECK(rates({}, {}, says_both, false) == "500000 2000000");
  CHECK(rates({}, {}, {files.folder.file("missing.json")}, false) == "500000 2000000");
}

TEST_CASE("sim: it has a bus of its own where --bus names a virtual one, or none") {
  cli::Session session;
  for (const char* const name : {"", "sim", "sim:/tmp/a_bus"}) {
    CAPTURE(name);
    session.bus_name = name;
    CHECK(cli::simulate::on_virtual_bus(session));
  }
  for (const char* const name : {"can0", "simm", "slcan:/dev/ttyACM0"}) {
    CAPTURE(name);
    session.bus_name = name;
    CHECK_FALSE(cli::simulate::on_virtual_bus(session));
  }
}

}  // namespace simulate_cast_test
