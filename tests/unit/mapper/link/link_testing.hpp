/// What the tests of the line share: the corrupted log of the second thesis, sentences of random numbers, and
/// a stream through a reader.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/mapper/link/sentence.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"

#include "unit/base/random.hpp"

namespace ocm::test {

/// Second thesis, listing 15.1, as printed, blanks and all. Sent by robot 0; lines end with a line feed.
inline constexpr std::string_view listing_15_1 =
    "[0] :AVR:{U,-177,-61,-68,49,0[0]:AVR:,0,0,0}\n"
    "[0] :AVR:{S,IDL}\n"
    "[0] :AVR:{U,-177,-61,-68,47,0[0]:AVR:-68,46,0,0,0,0}\n"
    ",0,0[0]:AVR:,0}\n"
    "{U,-177,-61,{U,-[0]:AVR:,0}\n"
    "{U,-177,-61,-72,[0]:AVR:,-69,45,0,0,0{U,-177[0]:AVR:,0,43,0,0}\n"
    "}\n"
    "{U,-177,-[0]:AVR:,-63,39,0,34,0,0}\n"
    ",0[0]:AVR:,-74,41,0,36,0,0}\n"
    "{U[0]:AVR:,-177,-61,-59,38,0,3[0]:AVR:77,-61,-60,37,0,32,0\n"
    "[0]:AVR:{S,IDL}\n"
    "{U,-1{U,-177[0]:AVR:0}\n"
    ",0}\n"
    "61,-73,42{U,-[0]:AVR:,23,80,0}\n"
    "[0]:AVR:4,0,22,70,0}\n"
    "36,0,32[0]:AVR:40,0{U3,0,0}\n"
    "2,0,0,0}\n"
    "}\n"
    "177,-61[0]:AVR:L}0,17,58,0,-177{U,-[0]:AVR:171,-6{S,IDL\n"
    "[0]:AVR:{U,-177,-60,142,29,0[0]:AVR:,16,0,0}\n";

inline constexpr mapper::link::Update first_of_listing{-177, -61, -68, 49, 0, 0, 0, 0};
inline constexpr mapper::link::Update last_of_listing{-177, -60, 142, 29, 0, 16, 0, 0};

/// Every field within its range.
template <class T>
[[nodiscard]] T random_sentence(Random& random) {
  T out{};
  for (const auto& field : T::fields)
    out.*field.member = static_cast<std::int16_t>(random.within(field.min, field.max));
  return out;
}

/// As a robot in a room prints: some metres each way, distances of the part's range or none.
[[nodiscard]] inline mapper::link::Update likely_update(Random& random) {
  const auto number = [&](int low, int high) { return static_cast<std::int16_t>(random.within(low, high)); };
  const auto distance = [&] { return random.below(2) == 0 ? std::int16_t{0} : number(10, 80); };
  mapper::link::Update update;
  update.x = number(-200, 200);
  update.y = number(-200, 200);
  update.heading = number(-180, 180);
  update.servo = number(0, 90);
  update.s1 = distance();
  update.s2 = distance();
  update.s3 = distance();
  update.s4 = distance();
  return update;
}

/// All that is heard of a text.
[[nodiscard]] inline std::vector<mapper::link::Sentence> read(mapper::link::Reader& reader,
                                                              std::string_view text) {
  std::vector<mapper::link::Sentence> heard;
  for (const char c : text)
    if (reader.feed(c) != mapper::link::Kind::none) heard.push_back(reader.sentence());
  return heard;
}

}  // namespace ocm::test
