#include "ocm/mapper/link/whole_update.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/sentence_reader.hpp"

#include "unit/mapper/link/link_testing.hpp"

namespace mapper_link_whole_update_test {

using namespace ocm::mapper::link;
using ocm::test::Random;
using ocm::test::read;

// --- a number ----------------------------------------------------------------------------------------------

constexpr int not_taken = 12345;
constexpr int number(const char (&text)[9]) {
  const detail::ShortNumber number = detail::short_number(ocm::base::swar::load64(text));
  return number.size == 0 ? not_taken : number.value;
}
static_assert(number("0,123456") == 0);
static_assert(number("9}123456") == 9);
static_assert(number("-9,12345") == -9);
static_assert(number("1000,-12") == 1000);
static_assert(number("-9999,12") == -9999);
static_assert(number("10000,12") == not_taken);  // right, but the reader's
static_assert(number("12345678") == not_taken);
static_assert(number(",1234567") == not_taken);
static_assert(number("-,123456") == not_taken);
static_assert(number("-0,12345") == not_taken);
static_assert(number("007,1234") == not_taken);
static_assert(number("1-1,1234") == not_taken);
static_assert(number("1.5,1234") == not_taken);
static_assert(number("1/5,1234") == not_taken);
static_assert(number("+5,12345") == not_taken);
// The least of each length, and the greatest of one less with a zero in front.
static_assert(number("10,12345") == 10 && number("09,12345") == not_taken);
static_assert(number("100,1234") == 100 && number("099,1234") == not_taken);
static_assert(number("1000,123") == 1000 && number("0999,123") == not_taken);
static_assert(number("-1,12345") == -1);
static_assert(number("-10,1234") == -10 && number("-09,1234") == not_taken);
static_assert(number("-100,123") == -100 && number("-099,123") == not_taken);
static_assert(number("-1000,12") == -1000 && number("-0999,12") == not_taken);
// Longer ones are the reader's, whatever their last four digits are.
static_assert(number("99999,12") == not_taken && number("-99999,1") == not_taken);
static_assert(number("999999,1") == not_taken && number("-999999,") == not_taken);
static_assert(number("9999999,") == not_taken && number("-9999999") == not_taken);
static_assert(number("99999999") == not_taken);

// --- an update ---------------------------------------------------------------------------------------------

/// How many characters are taken of an update that is followed by blanks, `size` characters in all.
constexpr std::size_t taken(std::string_view update, std::size_t size = 60) {
  std::array<char, 60> text{};
  text.fill(' ');
  update.copy(text.data(), update.size());
  std::array<std::int16_t, 8> integers{};
  return detail::whole_update({text.data(), size}, integers);
}
// Each field at both ends of what it can be, and beyond them.
constexpr std::string_view greatest = "{U,9999,9999,360,90,255,255,255,255}";
constexpr std::string_view least = "{U,-9999,-9999,-360,0,0,0,0,0}";
static_assert(taken(greatest) == greatest.size() && taken(least) == least.size());
static_assert(taken("{U,0,0,361,0,0,0,0,0}") == 0 && taken("{U,0,0,-361,0,0,0,0,0}") == 0);
static_assert(taken("{U,0,0,0,91,0,0,0,0}") == 0 && taken("{U,0,0,0,-1,0,0,0,0}") == 0);
static_assert(taken("{U,0,0,0,0,256,0,0,0}") == 0 && taken("{U,0,0,0,0,0,0,0,256}") == 0);
static_assert(taken("{U,0,0,0,0,0,0,0,0,") == 0 && taken("{U,0,0,0,0,0,0,0}") == 0);
static_assert(taken("{C,0,0,0,0,0,0,0,0}") == 0 && taken("{U}0,0,0,0,0,0,0,0}") == 0);
// Three characters, seven numbers of five and a comma, and a word of eight: less is not looked at.
static_assert(taken(least, 53) == least.size() && taken(least, 52) == 0);

// --- blocks ------------------------------------------------------------------------------------------------

/// All that can be seen of a reader.
struct Seen {
  std::vector<Kind> kinds;
  std::vector<std::int16_t> integers;  ///< of all sentences, one behind the other
  ReaderFaults faults{};
  std::uint32_t heard = 0;
  std::uint32_t stray = 0;
  bool mid_sentence = false;
  friend bool operator==(const Seen&, const Seen&) = default;

  void take(const Sentence& sentence) {
    kinds.push_back(sentence.kind);
    integers.insert(integers.end(), sentence.integers.begin(), sentence.integers.begin() + sentence.count);
  }
  Seen& end(const Reader& reader) {
    faults = reader.faults();
    heard = reader.heard();
    stray = reader.stray();
    mid_sentence = reader.mid_sentence();
    return *this;
  }
};

Seen by_character(std::string_view text, Direction direction) {
  Reader reader{direction};
  Seen seen;
  for (const Sentence& sentence : read(reader, text)) seen.take(sentence);
  return seen.end(reader);
}
/// Cut into blocks of a length that `next` gives.
template <class Next>
Seen by_block(std::string_view text, Direction direction, Next next) {
  Reader reader{direction};
  Seen seen;
  while (!text.empty()) {
    std::string_view block = text.substr(0, next());
    text.remove_prefix(block.size());
    while (!block.empty())
      if (reader.feed(block) != Kind::none) seen.take(reader.sentence());
  }
  return seen.end(reader);
}

/// Whole, and in random blocks, both ways.
void check_blocks(Random& random, const std::string& text) {
  for (const Direction direction : {Direction::from_robot, Direction::to_robot}) {
    const Seen seen = by_character(text, direction);
    INFO(text);
    REQUIRE(by_block(text, direction, [] { return std::string_view::npos; }) == seen);
    REQUIRE(by_block(text, direction, [&] { return random.below(200) + 1; }) == seen);
  }
}

/// Behind it stands enough for an update to be read at once.
const std::string room(80, ' ');

// Read at once, and in a constant expression.
static_assert([] {
  std::string_view text = "{U,-177,-61,-68,49,0,0,0,0}\n{S,IDL}\n                                   ";
  Reader reader;
  return reader.feed(text) == Kind::update && text.front() == '\n' &&
         reader.sentence().as<Update>().value == ocm::test::first_of_listing &&
         reader.feed(text) == Kind::idle && reader.feed(text) == Kind::none && text.empty();
}());

TEST_CASE("a block is left where a sentence has become whole") {
  const std::string stream = "{U,-9999,9999,-360,90,255,0,10,1}\n{S,IDL}x" + room;
  std::string_view text = stream;
  Reader reader;
  CHECK(reader.feed(text) == Kind::update);
  CHECK(reader.sentence().as<Update>().value == Update{-9999, 9999, -360, 90, 255, 0, 10, 1});
  CHECK(text.substr(0, 2) == "\n{");
  CHECK(reader.feed(text) == Kind::idle);
  CHECK(reader.feed(text) == Kind::none);
  CHECK(text.empty());
  CHECK(reader.feed(text) == Kind::none);
  CHECK(reader.stray() == 1);
}

TEST_CASE("an update ends what a tab began") {
  const std::string stream = "\t{U,-177,-61,-68,49,0,0,0,0}!" + room;
  std::string_view text = stream;
  Reader reader;
  CHECK(reader.feed(text) == Kind::update);
  CHECK(reader.feed(text) == Kind::none);
  CHECK(reader.stray() == 1);
}

TEST_CASE("any numbers are read the same in blocks as by characters") {
  Random random{2};
  const std::vector<std::string> numbers{"0",
                                         "9",
                                         "10",
                                         "99",
                                         "100",
                                         "999",
                                         "1000",
                                         "9999",
                                         "10000",
                                         "32767",
                                         "32768",
                                         "-1",
                                         "-9",
                                         "-10",
                                         "-99",
                                         "-100",
                                         "-999",
                                         "-1000",
                                         "-9999",
                                         "-10000",
                                         "-32768",
                                         "-32769",
                                         "90",
                                         "91",
                                         "255",
                                         "256",
                                         "360",
                                         "361",
                                         "-360",
                                         "-361",
                                         "",
                                         "-",
                                         "-0",
                                         "00",
                                         "007",
                                         "0007",
                                         "-01",
                                         "+5",
                                         "--1",
                                         "1-1",
                                         "1-",
                                         "1.5",
                                         "/",
                                         ":",
                                         "1:",
                                         "0x1",
                                         " 1",
                                         "1 ",
                                         "1}",
                                         "1{",
                                         "12345678",
                                         "123456789",
                                         "-12345678",
                                         "0-",
                                         "{U,1",
                                         "\n",
                                         "\x80",
                                         "1\xAC",
                                         "1\xBA",
                                         "\xFF"
                                         "1",
                                         "12\xAD"
                                         "3",
                                         "1\x80"
                                         "2"};
  const std::string likely[8] = {"-177", "61", "-68", "49", "0", "12", "30", "80"};
  for (std::size_t place = 0; place < 8; ++place)
    for (const std::string& number : numbers)
      for (const char* const close : {"}", ",", "}}", ",1}", "", "-}", "\n"}) {
        std::string text = "{U";
        for (std::size_t i = 0; i < 8; ++i) text += ',' + (i == place ? number : likely[i]);
        check_blocks(random, text + close + room + text + close);
      }
}

TEST_CASE("listing 15.1 is read the same in blocks of any size") {
  using ocm::test::listing_15_1;
  Random random{3};
  check_blocks(random, std::string{listing_15_1} + room);
  const Seen seen = by_character(listing_15_1, Direction::from_robot);
  for (std::size_t size = 1; size <= listing_15_1.size(); ++size) {
    INFO(size);
    CHECK(by_block(listing_15_1, Direction::from_robot, [&] { return size; }) == seen);
  }
}

TEST_CASE("damaged streams are read the same in blocks as by characters") {
  Random random{4};
  constexpr std::string_view characters = "0123456789,,--{}US\n\t! x./:+\x80\xFF";
  for (int n = 0; n < 2'000; ++n) {
    std::string text = "\t!\t";
    for (int i = 0; i < 12; ++i) {
      const Update update = random.below(2) == 0 ? ocm::test::likely_update(random)
                                                 : ocm::test::random_sentence<Update>(random);
      text += random.below(8) == 0 ? write(Kind::idle)->view() : write(update)->view();
    }
    for (std::uint32_t changes = random.below(12); changes > 0; --changes) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(text.size()));
      const char c = characters[random.below(characters.size())];
      if (random.below(3) == 0)
        text.erase(at, random.below(25));
      else if (random.below(2) == 0)
        text.insert(at, 1, c);
      else
        text[at] = c;
    }
    check_blocks(random, text);
  }
}

}  // namespace mapper_link_whole_update_test
