// Several specs become one: what is added, what of two counts, and what is reported where both cannot be.
#include "generator/spec/merge.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "generator/spec/spec.hpp"

namespace generator_merge_test {

using namespace ocm;
using spec::Model;
using Lines = std::vector<std::string>;

Model parse(const std::string& text) {
  auto loaded = spec::parse(text, text.starts_with("BO_") || text.starts_with("BU_") ? "f.dbc" : "f.json");
  for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
  REQUIRE(loaded.spec);
  return loaded.spec->take_model();
}

/// A spec of topics on one board.
Model robot(const std::string& name, const std::string& board, const std::string& topics) {
  return parse(R"({"robot": ")" + name + R"(", "namespace": "n", "bus": {"bit_rate": 500000, "source": "s"},
    "boards": [{"name": ")" +
               board + R"(", "mcu": "m", "source": "s"}], "topics": [)" + topics + "]}");
}
std::string topic(const std::string& name, const std::string& id, const std::string& board,
                  const std::string& more = {}) {
  return R"({"name": ")" + name + R"(", "id": ")" + id + R"(", "board": ")" + board +
         R"(", "source": "s", "frames": [{"dlc": 0, "fields": []}])" + more + "}";
}

Lines told(Model& into, Model from) {
  std::vector<spec::Problem> problems;
  spec::merge(into, std::move(from), "b.json", problems);
  Lines lines;
  for (const auto& problem : problems) {
    CHECK(problem.place == "b.json");
    lines.push_back(problem.what + "; " + problem.remedy);
  }
  return lines;
}

const std::string leave_out = "; leave one of the files out, or name their interfaces: --spec can0=FILE";
const std::string rename = "; another name for one of them, or interfaces: --spec can0=FILE";

TEST_CASE("merge: topics, messages and boards of both, each with its board") {
  Model into = robot("one", "left", topic("a", "0x10", "left"));
  CHECK(told(into, robot("two", "right", topic("b", "0x20", "right"))).empty());
  CHECK(told(into,
             parse("BU_: right other\nBO_ 100 M: 8 other\nBO_ 101 N: 8 right\nBO_ 102 O: 8 Vector__XXX\n"))
            .empty());
  REQUIRE(into.boards.size() == 3);
  CHECK((into.boards[0].name == "left" && into.boards[1].name == "right" && into.boards[2].name == "other"));
  REQUIRE(into.topics.size() == 2);
  CHECK((into.topics[0].board == 0 && into.topics[1].board == 1));
  CHECK((into.topics[0].name == "a" && into.topics[1].name == "b"));
  REQUIRE(into.messages.size() == 3);
  CHECK((into.messages[0].board == 2 && into.messages[1].board == 1 &&
         into.messages[2].board == protocol::no_board));
  CHECK(into.robot == "one");
}

TEST_CASE("merge: bit rates are the same, or of one of them") {
  const auto rates = [](std::uint32_t first, std::uint32_t second, const Lines& lines, std::uint32_t both) {
    Model into = parse("BO_ 1 A: 8 X\n"), from = parse("BO_ 2 B: 8 X\n");
    into.robot = "one";
    into.bit_rate = first, from.bit_rate = second;
    into.data_bit_rate = 4 * first, from.data_bit_rate = 4 * second;
    CHECK(told(into, std::move(from)) == lines);
    CHECK(into.bit_rate == both);
    CHECK(into.data_bit_rate == 4 * both);
  };
  rates(0, 0, {}, 0);
  rates(250'000, 0, {}, 250'000);
  rates(0, 250'000, {}, 250'000);
  rates(250'000, 250'000, {}, 250'000);
  rates(250'000, 500'000,
        {"its bus has 500000 bit/s, that of one 250000; specs of one bus have one bit rate",
         "its bus has 2000000 bit/s for data, that of one 1000000; specs of one bus have one data bit rate"},
        250'000);
}

TEST_CASE("merge: the bit rates of interfaces, each by itself") {
  const auto on = [](const std::string& bus, std::uint32_t rate, const std::string& text) {
    Model model = parse(text);
    model.robot = bus;
    model.bit_rate = rate;
    model.data_bit_rate = 2 * rate;
    model.put_on(bus);
    return model;
  };
  Model into = on("can0", 250'000, "BO_ 1 A: 8 X\n");
  CHECK(told(into, on("can1", 500'000, "BO_ 1 A: 8 X\n")).empty());  // the same identifier and name elsewhere
  CHECK(into.buses.size() == 2);
  CHECK((into.bus("can0").bit_rate == 250'000 && into.bus("can1").bit_rate == 500'000));
  CHECK(told(into, on("can1", 125'000, "BO_ 2 B: 8 X\n")) ==
        Lines{"its bus has 125000 bit/s, that of can0 500000; specs of one bus have one bit rate",
              "its bus has 250000 bit/s for data, that of can0 1000000; specs of one bus have one data bit "
              "rate"});
  CHECK(into.buses.size() == 2);
  CHECK(into.bit_rate == 0);
  // What is on any interface meets all.
  CHECK(told(into, parse("BO_ 1 C: 8 X\n")) == Lines{"C has the identifier 001 of A in can0" + leave_out});
  CHECK(told(into, parse("BO_ 3 B: 8 X\n")).size() == 1);
}

TEST_CASE("merge: an identifier and a name are given once on an interface, and again on another one") {
  const auto on = [](const std::string& bus, const std::string& text) {
    Model model = parse(text);
    model.robot = bus;
    model.put_on(bus);
    return model;
  };
  Model into = on("can0", "BO_ 1 A: 8 X\n");
  CHECK(told(into, on("can1", "BO_ 1 B: 8 X\n")).empty());
  CHECK(told(into, on("can0", "BO_ 1 C: 8 X\n")) ==
        Lines{"C has the identifier 001 of A in can0" + leave_out});
  CHECK(told(into, on("can1", "BO_ 1 D: 8 X\n")) ==
        Lines{"D has the identifier 001 of B in can0" + leave_out});
  CHECK(told(into, on("can1", "BO_ 2 B: 8 X\n")) ==
        Lines{"a second B: can0 has a message of that name" + rename});
  CHECK(told(into, on("can1", "BO_ 3 A: 8 X\n")).empty());
}

TEST_CASE("merge: identifiers of 11 and of 29 bits, and groups, are distinguished") {
  Model into = parse(
      "BO_ 100 A: 8 X\nBO_ 2566844926 G: 8 X\nBA_DEF_ BO_ \"VFrameFormat\" ENUM "
      "\"StandardCAN\",\"ExtendedCAN\",\"J1939PG\";\nBA_ \"VFrameFormat\" BO_ 2566844926 2;\n");
  into.robot = "one";
  REQUIRE(into.messages[1].is_j1939());
  CHECK(told(into, parse("BO_ 2147483748 B: 8 X\n")).empty());  // 100, too, with 29 bits
  CHECK(told(into, parse("BO_ 100 C: 8 X\n")) == Lines{"C has the identifier 064 of A in one" + leave_out});
  CHECK(told(into, parse("BO_ 2147483748 D: 8 X\n")) ==
        Lines{"D has the identifier 00000064 of B in one" + leave_out});
  CHECK(told(into, parse("BO_ 2566844926 E: 8 X\n")).empty());  // an identifier is no group
  Model other = parse("BO_ 2566844700 H: 8 X\n");
  other.messages[0].address.by = protocol::Address::By::pgn;
  const auto lines = told(into, other);
  REQUIRE(lines.size() <= 1);
  if (other.messages[0].address.number >> 8 == into.messages[1].address.number >> 8)
    CHECK(lines == Lines{"H has the parameter group 0000FEF1 of G in one" + leave_out});
}

TEST_CASE(
    "merge: a topic's identifiers are its requests' and its samples', at each priority, and its set "
    "points'") {
  const std::string sensor = topic("s", "0x10", "left");
  const auto against = [](const std::string& own, std::uint32_t id) {
    Model into = robot("one", "left", own);
    return told(into, parse("BO_ " + std::to_string(id) + " M: 8 X\n"));
  };
  for (std::uint32_t priority = 0; priority < 4; ++priority) {
    CAPTURE(priority);
    for (const std::uint32_t direction : {0U, 0x400U}) {
      CHECK(against(sensor, direction | priority << 8 | 0x10).size() == 1);
      CHECK(against(sensor, direction | priority << 8 | 0x11).empty());
      CHECK(against(sensor, direction | priority << 8 | 0x0F).empty());
    }
    const std::string lamps = topic("l", "0x20", "left", R"(, "kind": "actuator", "count": 2)");
    for (const std::uint32_t id : {0x20U, 0x21U}) {
      CHECK(against(lamps, priority << 8 | id).size() == 1);
      CHECK(against(lamps, 0x400 | priority << 8 | id).empty());
    }
    CHECK(against(lamps, priority << 8 | 0x22).empty());
    const std::string ring =
        R"({"name": "r", "id": "0x30", "board": "left", "source": "s", "frames": [{"name": "f", "id": "0x40", "count": 2, "dlc": 0, "fields": []}]})";
    CHECK(against(ring, 0x400 | priority << 8 | 0x40).size() == 1);
    CHECK(against(ring, 0x400 | priority << 8 | 0x41).size() == 1);
    CHECK(against(ring, 0x400 | priority << 8 | 0x42).empty());
    CHECK(against(ring, 0x400 | priority << 8 | 0x30).empty());
    CHECK(against(ring, priority << 8 | 0x30).size() == 1);
    CHECK(against(ring, priority << 8 | 0x31).empty());
  }
}

TEST_CASE(
    "merge: three conflicts of identifiers and three of names are reported one by one, and how many more "
    "there are") {
  const auto messages = [](int count, int first_id, const std::string& name) {
    std::string text;
    for (int i = 0; i < count; ++i)
      text += "BO_ " + std::to_string(first_id + i) + " " + name + std::to_string(i) + ": 8 X\n";
    return parse(text);
  };
  for (const int count : {1, 3, 4, 6}) {
    CAPTURE(count);
    Model into = messages(count, 1, "A");
    into.robot = "one";
    Lines lines;
    for (int i = 0; i < std::min(count, 3); ++i)
      lines.push_back("B" + std::to_string(i) + " has the identifier 00" + std::to_string(i + 1) + " of A" +
                      std::to_string(i) + " in one" + leave_out);
    if (count > 3)
      lines.push_back(std::to_string(count - 3) +
                      " more conflicts with one; is it the same file, or another version of it?");
    CHECK(told(into, messages(count, 1, "B")) == lines);

    Model names = messages(count, 1, "A");
    names.robot = "one";
    lines.clear();
    for (int i = 0; i < std::min(count, 3); ++i)
      lines.push_back("a second A" + std::to_string(i) + ": one has a message of that name" + rename);
    if (count > 3)
      lines.push_back(std::to_string(count - 3) +
                      " more conflicts with one; is it the same file, or another version of it?");
    CHECK(told(names, messages(count, 100, "A")) == lines);

    Model both = messages(count, 1, "A");
    both.robot = "one";
    CHECK(told(both, messages(count, 1, "A")).size() ==
          static_cast<std::size_t>(2 * std::min(count, 3) + (count > 3 ? 1 : 0)));
  }
  // Topics of one name, too.
  const auto topics = [](int count, int first_id) {
    std::string all;
    for (int i = 0; i < count; ++i)
      all +=
          (i == 0 ? "" : ", ") + topic("a" + std::to_string(i), "0x" + std::to_string(first_id + i), "left");
    return all;
  };
  for (const int count : {3, 4, 5}) {
    CAPTURE(count);
    Model names = robot("one", "left", topics(count, 10));
    Lines lines;
    for (int i = 0; i < 3; ++i)
      lines.push_back("a second a" + std::to_string(i) + ": one has a topic of that name" + rename);
    if (count > 3)
      lines.push_back(std::to_string(count - 3) +
                      " more conflicts with one; is it the same file, or another version of it?");
    CHECK(told(names, robot("two", "left", topics(count, 20))) == lines);
  }
  // A topic has many identifiers: one conflict.
  Model into = robot("one", "left", topic("a", "0x10", "left"));
  CHECK(told(into, robot("two", "left", topic("b", "0x10", "left"))) ==
        Lines{"b has the identifier 010 of a in one" + leave_out});
  Model same = robot("one", "left", topic("a", "0x10", "left"));
  CHECK(told(same, robot("two", "left", topic("a", "0x20", "left"))) ==
        Lines{"a second a: one has a topic of that name" + rename});
}

TEST_CASE(
    "merge: attributes and definitions, of which the first counts; what is not kept, and what is too long, "
    "of both") {
  Model into = parse(
      "BO_ 1 A: 8 X\nBO_ 3 L: 65 X\nVAL_TABLE_ T 0 \"a\" ;\nBA_DEF_ \"K\" STRING ;\nBA_DEF_ BO_ \"K\" STRING "
      ";\nBA_ \"K\" \"one\";\n");
  CHECK(
      told(into, parse("BO_ 2 B: 8 X\nBO_ 4 M: 65 X\nVAL_TABLE_ T 0 \"a\" ;\nBA_DEF_ \"K\" INT 0 1;\nBA_DEF_ "
                       "SG_ \"K\" STRING ;\nBA_DEF_ \"J\" STRING ;\nBA_ \"K\" 1;\nBA_ \"J\" \"two\";\n"))
          .empty());
  CHECK(into.attributes == std::vector<spec::AttributeModel>{{"K", "one"}, {"J", "two"}});
  using Definition = spec::AttributeDefinitionModel;
  REQUIRE(into.definitions.size() == 4);
  CHECK((into.definitions[0].of == Definition::Of::bus &&
         into.definitions[0].type == Definition::Type::string));
  CHECK(
      (into.definitions[1].of == Definition::Of::message && into.definitions[2].of == Definition::Of::field));
  CHECK((into.definitions[3].of == Definition::Of::bus && into.definitions[3].name == "J"));
  CHECK(into.not_kept.size() == 2);
  CHECK(into.too_long == Lines{"L", "M"});
}

TEST_CASE("merge: what was put on an interface is on it alone, in the catalogue, too") {
  const auto make = [] {
    Model model = robot("one", "left", topic("a", "0x10", "left"));
    model.data_bit_rate = 2'000'000;
    model.messages = parse("BO_ 1 M: 8 left\n").messages;
    return model;
  };
  const auto buses = [](Model model) {
    const spec::Spec loaded{std::move(model)};
    Lines lines;
    for (const auto& each : loaded.catalogue().topics)
      lines.push_back(std::string{each.name} + " " + std::string{each.bus});
    return lines;
  };
  CHECK(buses(make()) == Lines{"a ", "M "});
  Model model = make();
  model.put_on("can1");
  CHECK((model.bit_rate == 0 && model.data_bit_rate == 0));
  REQUIRE(model.buses.size() == 1);
  CHECK(model.buses[0].name == "can1");
  CHECK((model.buses[0].bit_rate == 500'000 && model.buses[0].data_bit_rate == 2'000'000));
  CHECK(buses(std::move(model)) == Lines{"a can1", "M can1"});
}

TEST_CASE("merge: an interface has its own bit rates, and those of all where it has none") {
  Model model;
  model.bit_rate = 250'000;
  model.data_bit_rate = 1'000'000;
  model.buses = {{"can0", 500'000, 0}, {"can1", 0, 2'000'000}, {"can2", 125'000, 4'000'000}};
  const auto rates = [&model](std::string_view interface) {
    const spec::BusModel bus = model.bus(interface);
    CHECK(bus.name == interface);
    return std::pair{bus.bit_rate, bus.data_bit_rate};
  };
  CHECK(rates("can0") == std::pair{500'000U, 1'000'000U});
  CHECK(rates("can1") == std::pair{250'000U, 2'000'000U});
  CHECK(rates("can2") == std::pair{125'000U, 4'000'000U});
  CHECK(rates("can3") == std::pair{250'000U, 1'000'000U});
}

TEST_CASE("merge: the bit rate that all interfaces have is that of the bus") {
  const auto shared = [](std::uint32_t of_all, std::vector<spec::BusModel> buses) {
    Model model;
    model.bit_rate = of_all;
    model.data_bit_rate = 4 * of_all;
    model.buses = std::move(buses);
    model.share_bit_rate();
    return std::pair{model.bit_rate, model.data_bit_rate};
  };
  CHECK(shared(0, {}) == std::pair{0U, 0U});
  CHECK(shared(0, {{"can0", 500'000, 2'000'000}}) == std::pair{500'000U, 2'000'000U});
  CHECK(shared(0, {{"can0", 500'000, 2'000'000}, {"can1", 500'000, 2'000'000}}) ==
        std::pair{500'000U, 2'000'000U});
  CHECK(shared(0, {{"can0", 500'000, 2'000'000}, {"can1", 250'000, 2'000'000}}) == std::pair{0U, 2'000'000U});
  CHECK(shared(0, {{"can0", 500'000, 2'000'000}, {"can1", 500'000, 1'000'000}}) == std::pair{500'000U, 0U});
  CHECK(shared(125'000, {{"can0", 500'000, 2'000'000}}) == std::pair{125'000U, 500'000U});
}

TEST_CASE("merge: 255 boards in all, and no more") {
  const auto boards = [](int first, int count) {
    std::string text = "BU_:";
    for (int i = 0; i < count; ++i) text += " N" + std::to_string(first + i);
    return parse(text + "\nBO_ " + std::to_string(first + 1) + " M" + std::to_string(first) + ": 8 N" +
                 std::to_string(first) + "\n");
  };
  Model into = boards(0, 200);
  CHECK(told(into, boards(200, 55)).empty());
  CHECK(into.boards.size() == 255);
  CHECK(into.messages[1].board == 200);
  CHECK(told(into, boards(100, 100)).empty());  // there already
  CHECK(told(into, boards(300, 1)) == Lines{"more than 255 boards in all; fewer files"});
  CHECK(into.boards.size() == 255);
}

}  // namespace generator_merge_test
