// What the generated header says, typed by hand from the theses' tables. sentence.cpp holds writing and
// reading against spec/sentences.json.
#include "ocm/mapper/link/sentences.hpp"

#include <catch2/catch.hpp>

namespace mapper_link_sentences_test {

using namespace ocm::mapper::link;

// [Thesis 2, tables 4.3 and 4.4]
static_assert(SetPoint::letter == 'U' && SetPoint::direction == Direction::to_robot);
static_assert(Update::letter == 'U' && Update::direction == Direction::from_robot);
static_assert(Handshake::letter == 'H' && Handshake::direction == Direction::from_robot);
static_assert(word_letter == 'S' && word_length == 3);
static_assert(SetPoint::kind == Kind::set_point && Update::kind == Kind::update);
static_assert(static_cast<int>(Kind::none) == 0 && static_cast<int>(Kind::pong) == 14);

static_assert(SetPoint::fields.size() == 2 && SetPoint::fields[0].min == -360 &&
              SetPoint::fields[0].max == 360);
static_assert(SetPoint::fields[1].min == -32768 && SetPoint::fields[1].unit == "cm");
static_assert(Update::fields.size() == 8 && Update::fields[3].name == "servo" && Update::fields[3].max == 90);
static_assert(Update::fields[4].member == &Update::s1 && Update::fields[7].max == 255);
static_assert(Handshake::fields.size() == 11 && Handshake{}.given == 11);
static_assert(Calibrate::letter == 'C' && Calibrate::direction == Direction::to_robot);
static_assert(Calibration::letter == 'C' && Calibration::direction == Direction::from_robot);
static_assert(Calibrate::fields.size() == 1 && Calibration::fields.size() == 7);
static_assert(Calibration::none == 0 && Calibration::turning == 1 && Calibration::good == 2);
static_assert(Calibration::silent == 8 && Calibration::fields[1].max == Calibration::silent);
static_assert(Calibration::unused == 0 && Calibration::until_off == 1 && Calibration::stored == 2);
static_assert(Handshake::fewest_integers == 1 && Handshake::most_integers == max_integers);

// [Thesis 2, table 4.1 and 16.1]
static_assert(max_packet == 20 && max_integers == 16);

TEST_CASE("words and fixed texts, each with its direction") {
  CHECK(words.size() == 7);
  CHECK(words[0].kind == Kind::confirm);
  CHECK(words[0].text == "CON");
  CHECK(words[6].direction == Direction::from_robot);
  CHECK(fixed_text(Kind::ping) == "{}");
  CHECK(fixed_text(Kind::pong) == "\t!");
  CHECK(fixed_text(Kind::idle).empty());
}

TEST_CASE("a packed update fills a packet: tag, seven bits a byte, and the CRC in three bytes") {
  CHECK(packed_version == 1);
  CHECK(packed_tag == 0xB1);
  int bits = packed_sequence_bits;
  for (const auto width : packed_widths) bits += width;
  CHECK(bits == 7 * (static_cast<int>(max_packet) - 4));
}

}  // namespace mapper_link_sentences_test
