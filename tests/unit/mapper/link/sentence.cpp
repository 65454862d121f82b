#include "ocm/mapper/link/sentence.hpp"

#include <fstream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "ocm/mapper/link/format.hpp"
#include "ocm/mapper/link/packed.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"

#include "unit/mapper/link/link_testing.hpp"

namespace mapper_link_sentence_test {

using namespace ocm::mapper::link;
using ocm::base::Error;

// --- vectors, typed by hand --------------------------------------------------------------------------------

// [Thesis 2, tables 4.3 and 4.4]
static_assert(*write(Kind::confirm) == "{S,CON}\n");
static_assert(*write(Kind::pause) == "{S,PAU}\n");
static_assert(*write(Kind::unpause) == "{S,UNP}\n");
static_assert(*write(Kind::idle) == "{S,IDL}\n");
static_assert(*write(Kind::ping) == "{}\n");
static_assert(*write(Kind::pong) == "\t!\n");
static_assert(*write(Kind::packed) == "{S,BIN}\n");
static_assert(*write(Kind::text) == "{S,TXT}\n");
static_assert(write(Kind::update).error == Error::bad_syntax);
static_assert(write(Kind::none).error == Error::bad_syntax);
// [Thesis 2, table 13.1 and appendix J]
static_assert(*write(SetPoint{90, 130}) == "{U,90,130}\n");
static_assert(*write(SetPoint{0, 0}) == "{U,0,0}\n");
// [Thesis 2, listing 15.1, first and last]
static_assert(*write(ocm::test::first_of_listing) == "{U,-177,-61,-68,49,0,0,0,0}\n");
static_assert(*write(ocm::test::last_of_listing) == "{U,-177,-60,142,29,0,16,0,0}\n");
static_assert(*write(Handshake{15, 20, 2, 3, 0, 90, 180, 270, 1000, 0, 0, 10}) ==
              "{H,15,20,2,3,0,90,180,270,1000,0}\n");
static_assert(*write(Handshake{.width = 15, .given = 1}) == "{H,15}\n");
// [docs/decisions/0029]
static_assert(*write(Calibrate{7}) == "{C,7}\n");
static_assert(*write(Calibration{7, Calibration::good, 41, -57, 152, 1, Calibration::stored}) ==
              "{C,7,2,41,-57,152,1,2}\n");

// --- bounds ------------------------------------------------------------------------------------------------

static_assert(write(SetPoint{361, 0}).error == Error::out_of_range);
static_assert(write(SetPoint{-361, 0}).error == Error::out_of_range);
static_assert(write(Update{.servo = 91}).error == Error::out_of_range);
static_assert(write(Update{.servo = -1}).error == Error::out_of_range);
static_assert(write(Update{.s4 = 256}).error == Error::out_of_range);
static_assert(write(Calibrate{-1}).error == Error::out_of_range);
static_assert(write(Calibration{.verdict = 9}).error == Error::out_of_range);
static_assert(write(Handshake{.given = 0}).error == Error::bad_length);
static_assert(write(Handshake{.given = 12}).error == Error::bad_length);

constexpr std::int16_t least = INT16_MIN;
constexpr Handshake longest{least, least, least, least, least, least, least, least, least, least, least, 11};
static_assert(write(longest)->view().size() == max_line && !write(longest)->overflowed());
// What is said to a robot fits one packet, so that it comes whole or not at all. [Thesis 2, 15.3]
static_assert(write(SetPoint{-360, least})->view().size() <= 20);
static_assert(write(Kind::confirm)->view().size() <= 20);
static_assert(write(Calibrate{9999})->view().size() <= 20);
static_assert(write(Calibration{9999, 8, -2000, -2000, 2000, 180, 2})->view().size() <= 2 * 20,
              "what comes back takes two");

static_assert(kind_of_word(Direction::to_robot, "CON") == Kind::confirm);
static_assert(kind_of_word(Direction::from_robot, "CON") == Kind::none);
static_assert(kind_of_word(Direction::from_robot, "IDL") == Kind::idle);
static_assert(kind_of_word(Direction::from_robot, "") == Kind::none);
static_assert(kind_of_word(Direction::from_robot, "ID") == Kind::none);

static_assert(Sentence{Kind::set_point, 2, {90, 130}}.as<SetPoint>().value == SetPoint{90, 130});
static_assert(Sentence{Kind::set_point, 2, {90, 130}}.as<Update>().error == Error::bad_syntax);
static_assert(Sentence{Kind::handshake, 2, {15, 20}}.as<Handshake>().value ==
              Handshake{.width = 15, .length = 20, .given = 2});
// What a longer sentence of before has left behind the last integer is none of it.
static_assert(Sentence{Kind::handshake, 2, {15, 20, 7}}.as<Handshake>().value ==
              Handshake{.width = 15, .length = 20, .given = 2});

// --- the spec, held against the code -----------------------------------------------------------------------

using nlohmann::json;

json spec() {
  std::ifstream file{OCM_SOURCE_DIR "/spec/sentences.json"};
  REQUIRE(file);
  return json::parse(file);
}

const json& entry(const json& all, std::string_view name) {
  for (const json& sentence : all["sentences"])
    if (sentence["name"] == std::string{name}) return sentence;
  FAIL("spec/sentences.json has no sentence " << name);
  return all;
}

template <class T>
void check_fields(const json& all, std::string_view name) {
  const json& sentence = entry(all, name);
  INFO(name);
  REQUIRE(sentence["fields"].size() == T::fields.size());
  for (std::size_t i = 0; i < T::fields.size(); ++i) {
    const json& field = sentence["fields"][i];
    INFO(field);
    CHECK(field["name"] == std::string{T::fields[i].name});
    CHECK(field["unit"] == std::string{T::fields[i].unit});
    const json range = field.value("range", json::array({all["integer"]["min"], all["integer"]["max"]}));
    CHECK(range[0] == T::fields[i].min);
    CHECK(range[1] == T::fields[i].max);
  }
}

TEST_CASE("sentences.json and the structs say the same of every field") {
  const json all = spec();
  check_fields<SetPoint>(all, "set_point");
  check_fields<Update>(all, "update");
  check_fields<Handshake>(all, "handshake");
  check_fields<Calibrate>(all, "calibrate");
  check_fields<Calibration>(all, "calibration");
  CHECK(entry(all, "handshake")["integers"] == json::array({1, max_integers}));
  CHECK(all["packet"]["bytes"] == max_packet);
}

TEST_CASE("each sentence of sentences.json is written and read as it says, and there are no others") {
  const json all = spec();
  std::set<std::string> written;
  for (const json& sentence : all["sentences"]) {
    const std::string name = sentence["name"];
    INFO(name);
    const bool to_robot = sentence["direction"] == "to_robot";
    std::string text = sentence.value("text", "");
    if (text.empty()) {
      text = "{" + sentence["letter"].get<std::string>();
      if (sentence.contains("word")) text += "," + sentence["word"].get<std::string>();
      if (sentence.contains("fields"))
        for (std::size_t i = 0; i < sentence["fields"].size(); ++i) text += ",0";
      text += "}";
    }
    Reader reader{to_robot ? Direction::to_robot : Direction::from_robot};
    const auto heard = ocm::test::read(reader, text + "\n");
    REQUIRE(heard.size() == 1);
    const Kind kind = heard[0].kind;
    std::string again;
    if (kind == Kind::set_point) again = write(SetPoint{})->view();
    if (kind == Kind::update) again = write(Update{})->view();
    if (kind == Kind::calibrate) again = write(Calibrate{})->view();
    if (kind == Kind::calibration) again = write(Calibration{})->view();
    if (kind == Kind::handshake) again = write(Handshake{})->view();
    if (again.empty()) again = write(kind)->view();
    CHECK(again == text + "\n");
    written.insert(name);
    Reader other{to_robot ? Direction::from_robot : Direction::to_robot};
    CHECK(ocm::test::read(other, text + "\n").empty());
  }
  const std::set<std::string> known{"confirm", "set_point", "pause",       "unpause",   "packed",
                                    "text",    "who",       "ping",        "calibrate", "handshake",
                                    "update",  "idle",      "calibration", "pong"};
  CHECK(written == known);
  CHECK(known.size() == static_cast<std::size_t>(Kind::pong));  // every kind but none
}

TEST_CASE("sentences.json and the packed update have the same bits") {
  const json packed = spec()["packed"];
  CHECK(packed["tag"] == packed_tag);
  REQUIRE(packed["fields"].size() == 1 + Update::fields.size());
  CHECK(packed["fields"][0]["name"] == "sequence");
  CHECK(packed["fields"][0]["bits"] == 8);
  int bits = 8;
  for (std::size_t i = 0; i < Update::fields.size(); ++i) {
    CHECK(packed["fields"][i + 1]["name"] == std::string{Update::fields[i].name});
    CHECK(packed["fields"][i + 1]["bits"] == packed_widths[i]);
    bits += packed_widths[i];
  }
  CHECK(bits == 112);
  CHECK(entry(spec(), "handshake")["fields"][9]["values"]["packed_offer"] == Handshake::packed_offer);
  CHECK(Handshake::packed_offer == 20225);  // docs/mapper-link.md, packed updates
  CHECK(std::string{name(Kind::set_point)} == "set_point");
  CHECK(std::string{name(Kind::none)} == "none");
}

}  // namespace mapper_link_sentence_test
