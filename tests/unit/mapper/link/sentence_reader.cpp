#include "ocm/mapper/link/sentence_reader.hpp"

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/packet.hpp"

#include "unit/mapper/link/link_testing.hpp"

namespace mapper_link_sentence_reader_test {

using namespace ocm::mapper::link;
using ocm::test::Random;
using ocm::test::read;

/// The only sentence of a text, or none.
constexpr Sentence only(std::string_view text, Direction direction = Direction::from_robot) {
  Reader reader{direction};
  Sentence heard;
  for (const char c : text)
    if (reader.feed(c) != Kind::none) heard = reader.sentence();
  return heard;
}
constexpr ReaderFaults faults(std::string_view text, Direction direction = Direction::from_robot) {
  Reader reader{direction};
  for (const char c : text) (void)reader.feed(c);
  return reader.faults();
}

// --- vectors, typed by hand --------------------------------------------------------------------------------

// [Thesis 2, tables 4.3, 4.4 and 13.1, listing 15.1]
static_assert(only("{S,CON}\n", Direction::to_robot).kind == Kind::confirm);
static_assert(only("{S,PAU}\n", Direction::to_robot).kind == Kind::pause);
static_assert(only("{S,UNP}\n", Direction::to_robot).kind == Kind::unpause);
static_assert(only("{}\n", Direction::to_robot).kind == Kind::ping);
static_assert(only("{ }\n", Direction::to_robot).kind == Kind::ping);  // as printed
static_assert(only("{U,90,130}\n", Direction::to_robot).as<SetPoint>().value == SetPoint{90, 130});
static_assert(only("{S,IDL}\n").kind == Kind::idle);
static_assert(only("\t!\n").kind == Kind::pong);
static_assert(only("\t ! \n").kind == Kind::pong);  // as printed
static_assert(only("{U,-177,-61,-68,49,0,0,0,0}\n").as<Update>().value == ocm::test::first_of_listing);
static_assert(only("{C,7}\n", Direction::to_robot).as<Calibrate>().value == Calibrate{7});
static_assert(only("{C,7,2,41,-57,152,1,2}\n").as<Calibration>().value ==
              Calibration{7, Calibration::good, 41, -57, 152, 1, 2});
static_assert(only("{H,15,20}\n").as<Handshake>().value == Handshake{.width = 15, .length = 20, .given = 2});

// The brace completes it: the line feed may be lost.
static_assert(only("{U,-177,-61,-68,49,0,0,0,0}").kind == Kind::update);
static_assert(only("{U,-177,-61,-68,49,0,0,0,0").kind == Kind::none);
// Both ends of what 16 bits hold.
static_assert(only("{U,-32768,32767,0,0,0,0,0,0}").as<Update>().value == Update{.x = -32768, .y = 32767});
static_assert(only("{H,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16}").as<Handshake>().value.given == 16);

// --- each wrong shape, and its cause -----------------------------------------------------------------------

static_assert(faults("{U,1{S,IDL}") == ReaderFaults{.torn = 1});
static_assert(faults("{U,1\n") == ReaderFaults{.unclosed = 1});
static_assert(faults("{U,1\r\n") == ReaderFaults{.unclosed = 1});
static_assert(faults(",0,0}") == ReaderFaults{.headless = 1});
static_assert(faults("}\n") == ReaderFaults{.headless = 1});
static_assert(faults("{X}") == ReaderFaults{.unknown = 1});
static_assert(faults("{u,1}") == ReaderFaults{.unknown = 1});
static_assert(faults("{}") == ReaderFaults{.unknown = 1});  // no robot pings
static_assert(faults("{ U}", Direction::to_robot) == ReaderFaults{.unknown = 1});
static_assert(faults("{S}") == ReaderFaults{.unknown = 1});
static_assert(faults("{S,}") == ReaderFaults{.unknown = 1});
static_assert(faults("{S,ID}") == ReaderFaults{.unknown = 1});
static_assert(faults("{S,IDLE}") == ReaderFaults{.unknown = 1});
static_assert(faults("{S,CON}") == ReaderFaults{.unknown = 1});  // the other way
static_assert(faults("{H,1}", Direction::to_robot) == ReaderFaults{.unknown = 1});
static_assert(faults("{U3,0,0}") == ReaderFaults{.unknown = 1});
static_assert(faults("{U,}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,0,0,0,0,0,0,0,}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,0,0,,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,-,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,0,0,0,0,0,0,0,-}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,--1,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,1-1,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,-0,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,007,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,+5,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U, 5,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,5x,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U,1.5,0,0,0,0,0,0,0}") == ReaderFaults{.bad_number = 1});
static_assert(faults("{U}") == ReaderFaults{.wrong_count = 1});
static_assert(faults("{H}") == ReaderFaults{.wrong_count = 1});
static_assert(faults("{U,0,0,0,0,0,0,0}") == ReaderFaults{.wrong_count = 1});
static_assert(faults("{U,0,0,0,0,0,0,0,0,0}") == ReaderFaults{.wrong_count = 1});
static_assert(faults("{U,90}", Direction::to_robot) == ReaderFaults{.wrong_count = 1});
static_assert(faults("{U,90,60,0}", Direction::to_robot) == ReaderFaults{.wrong_count = 1});
static_assert(faults("{U,32768,0,0,0,0,0,0,0}") == ReaderFaults{.out_of_range = 1});
static_assert(faults("{U,-32769,0,0,0,0,0,0,0}") == ReaderFaults{.out_of_range = 1});
static_assert(faults("{U,123456,0,0,0,0,0,0,0}") == ReaderFaults{.out_of_range = 1});
static_assert(faults("{U,99999999999999999999}") == ReaderFaults{.out_of_range = 1});
static_assert(faults("{U,123456\n") == ReaderFaults{.out_of_range = 1});  // known at its sixth digit
static_assert(faults("{U,0,0,361,0,0,0,0,0}") == ReaderFaults{.out_of_range = 1});
static_assert(faults("{U,0,0,0,91,0,0,0,0}") == ReaderFaults{.out_of_range = 1});
static_assert(faults("{U,0,0,0,0,0,0,0,-1}") == ReaderFaults{.out_of_range = 1});
static_assert(faults("{U,0,0,0,0,0,0,0,256}") == ReaderFaults{.out_of_range = 1});
static_assert(faults("{H,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17}") == ReaderFaults{.too_long = 1});
// One fault, whatever follows until the end; then the next is heard.
static_assert(faults("{U,x,y,-,99999,}{S,IDL}\n") == ReaderFaults{.bad_number = 1});
static_assert(only("{U,x,y,-,99999,}{S,IDL}\n").kind == Kind::idle);
static_assert(only("{U,1{U,2{S,IDL}").kind == Kind::idle);
// An answer needs its tab, and no sentence around it.
static_assert(only("!\n").kind == Kind::none);
static_assert(only("\tx!\n").kind == Kind::none);
static_assert(only("\t\n!\n").kind == Kind::none);
static_assert(only("\t!\n", Direction::to_robot).kind == Kind::none);
static_assert(only("{U\t!}").kind == Kind::none);
static_assert(only("\t{S,IDL}!\n").kind == Kind::idle);

constexpr Reader after(std::string_view text) {
  Reader reader;
  for (const char c : text) (void)reader.feed(c);
  return reader;
}
// One tab, one answer, and none of the integers of before in it.
static_assert(after("\t!!").heard() == 1 && after("\t!!").stray() == 1);
static_assert(after("{U,1,2,3,4,5,6,7,8}").sentence().count == 8);
static_assert(after("{U,1,2,3,4,5,6,7,8}\t!").sentence().kind == Kind::pong);
static_assert(after("{U,1,2,3,4,5,6,7,8}\t!").sentence().count == 0);
// What was heard is gone with the next brace.
static_assert(after("{S,IDL}").sentence().kind == Kind::idle);
static_assert(after("{S,IDL}{").sentence().kind == Kind::none);

static_assert(sizeof(Reader) <= 92);

// --- the listing -------------------------------------------------------------------------------------------

/// Listing 15.1 without its prefixes, by hand.
constexpr std::string_view stripped_listing =
    "{U,-177,-61,-68,49,0,0,0,0}\n{S,IDL}\n{U,-177,-61,-68,47,0-68,46,0,0,0,0}\n,0,0,0}\n{U,-177,-61,{U,-,0}"
    "\n"
    "{U,-177,-61,-72,,-69,45,0,0,0{U,-177,0,43,0,0}\n}\n{U,-177,-,-63,39,0,34,0,0}\n,0,-74,41,0,36,0,0}\n"
    "{U,-177,-61,-59,38,0,377,-61,-60,37,0,32,0\n{S,IDL}\n{U,-1{U,-1770}\n,0}\n61,-73,42{U,-,23,80,0}\n"
    "4,0,22,70,0}\n36,0,3240,0{U3,0,0}\n2,0,0,0}\n}\n177,-61L}0,17,58,0,-177{U,-171,-6{S,IDL\n"
    "{U,-177,-60,142,29,0,16,0,0}\n";

TEST_CASE("listing 15.1 holds four whole sentences: U, IDL, IDL, U") {
  Reader reader;
  const auto heard = read(reader, stripped_listing);
  REQUIRE(heard.size() == 4);
  CHECK(heard[0].as<Update>().value == ocm::test::first_of_listing);
  CHECK(heard[1].kind == Kind::idle);
  CHECK(heard[2].kind == Kind::idle);
  CHECK(heard[3].as<Update>().value == ocm::test::last_of_listing);
  // Counted by hand, line by line.
  CHECK(reader.faults() == ReaderFaults{.torn = 3,      // {U,-177,-61,   {U,-1   {U,-171,-6
                                        .unclosed = 2,  // ..,32,0   {S,IDL
                                        .headless = 8,  // ,0,0,0}  }  ,0,-74..}  ,0}  4,0..}  2,0..}  }  ..L}
                                        .unknown = 1,   // {U3,0,0}
                                        .bad_number = 5,   // 0-68   -,   ,,   -,   -,
                                        .wrong_count = 2,  // {U,-177,0,43,0,0}   {U,-1770}
                                        .out_of_range = 0,
                                        .too_long = 0});
}

// --- properties --------------------------------------------------------------------------------------------

template <class T>
void check_round_trip(Random& random, Direction direction) {
  Reader reader{direction};
  for (int n = 0; n < 2000; ++n) {
    const T sent = ocm::test::random_sentence<T>(random);
    const std::vector<Sentence> heard = read(reader, write(sent)->view());
    REQUIRE(heard.size() == 1);
    REQUIRE(heard[0].template as<T>().value == sent);
  }
  CHECK(reader.faults().total() == 0);
  CHECK(reader.stray() == 0);
  CHECK(reader.heard() == 2000);
}

TEST_CASE("sentence: what is written is read equal") {
  Random random{1};
  check_round_trip<SetPoint>(random, Direction::to_robot);
  check_round_trip<Update>(random, Direction::from_robot);
  check_round_trip<Handshake>(random, Direction::from_robot);
}

TEST_CASE("an update cut off at any byte, or begun at any, is none; the next one is heard") {
  const std::string line{write(Update{-177, -61, -68, 49, 12, 30, 45, 80})->view()};
  for (std::size_t cut = 0; cut + 1 < line.size(); ++cut) {
    INFO(cut);
    Reader reader;
    const auto heard = read(reader, line.substr(0, cut) + line);
    REQUIRE(heard.size() == 1);
    CHECK(heard[0].as<Update>().value == Update{-177, -61, -68, 49, 12, 30, 45, 80});
    CHECK(reader.faults().torn == (cut == 0 ? 0 : 1));
    CHECK(reader.faults().total() == (cut == 0 ? 0 : 1));

    Reader later;
    const auto tail = read(later, line.substr(cut + 1) + line);
    CHECK(tail.size() == 1);
    // All that is left of the longest cut is the line feed.
    CHECK(later.faults() == ReaderFaults{.headless = cut + 2 < line.size() ? 1U : 0U});
  }
}

TEST_CASE("an update with one bit wrong is none, or one that could have been sent") {
  const Update sent{-177, -61, -68, 49, 12, 30, 45, 80};
  const std::string line{write(sent)->view()};
  int taken = 0;
  for (std::size_t bit = 0; bit < 8 * (line.size() - 1); ++bit) {
    std::string wrong = line;
    wrong[bit / 8] = static_cast<char>(wrong[bit / 8] ^ 1 << bit % 8);
    Reader reader;
    for (const Sentence& heard : read(reader, wrong)) {
      const auto update = heard.as<Update>();
      REQUIRE(update.ok());
      REQUIRE(*update != sent);
      REQUIRE(write(*update)->view() == wrong);
      ++taken;
    }
    CHECK(reader.heard() + reader.faults().total() >= 1);  // nothing silent
  }
  // A digit that became another digit: no text can tell. Packed updates can (packed.cpp).
  CHECK(taken > 0);
  CHECK(taken < 64);
}

TEST_CASE("a sentence that is begun is counted when the link is a new one, and not continued") {
  Reader reader;
  CHECK(read(reader, "{U,-177,-61,-68,49,0").empty());
  CHECK(reader.mid_sentence());
  reader.restart();
  CHECK_FALSE(reader.mid_sentence());
  CHECK(read(reader, ",0,0,0}\n").empty());
  CHECK(reader.faults() == ReaderFaults{.unclosed = 1, .headless = 1});
  CHECK(reader.stray() == 6);
}

// --- splices -----------------------------------------------------------------------------------------------

struct Splices {
  int sent = 0;
  int whole = 0;    ///< heard as sent
  int spliced = 0;  ///< heard, and never sent so
};

/// Updates as a robot in a room sends them, of whose packets `loss_percent` never come.
Splices measure(int loss_percent, int updates, std::uint64_t seed) {
  Random random{seed};
  Reader reader;
  Splices out;
  for (int n = 0; n < updates; ++n) {
    const Update update = ocm::test::likely_update(random);
    const Line line = *write(update);
    ++out.sent;
    for (std::string_view rest = line.view(); !rest.empty();) {
      const Packet packet = take_packet(rest);
      if (random.within(0, 99) < loss_percent) continue;
      for (const std::uint8_t byte : packet.bytes()) {
        if (reader.feed(static_cast<char>(byte)) == Kind::none) continue;
        const auto heard = reader.sentence().as<Update>();
        *heard == update ? ++out.whole : ++out.spliced;
      }
    }
  }
  return out;
}

TEST_CASE("splices of updates that look whole are rare, and as rare as docs/mapper-link.md says") {
  CHECK(measure(0, 20'000, 7).whole == 20'000);
  for (const int loss : {1, 5, 10, 20, 30, 50}) {
    const Splices s = measure(loss, 20'000, 7);
    INFO(loss << " % of packets lost: " << s.whole << " whole, " << s.spliced << " spliced");
    CHECK(s.spliced * 1000 < s.sent * 40);
    CHECK(s.whole > 0);
  }
  CHECK(measure(20, 20'000, 7).spliced > 0);  // there are some: text has no cure
}

// unit_mapper_link "[.measure]" prints the table of docs/mapper-link.md.
TEST_CASE("sentence: measured rate of splices", "[.measure]") {
  std::puts("packets lost   updates   whole      spliced    spliced/heard");
  for (const int loss : {1, 2, 5, 10, 20, 30, 50}) {
    const Splices s = measure(loss, 1'000'000, 20'260'000);
    std::printf("%9d %%  %9d  %9d  %9d  %10.3f %%\n", loss, s.sent, s.whole, s.spliced,
                100.0 * s.spliced / (s.whole + s.spliced));
  }
}

}  // namespace mapper_link_sentence_reader_test
