#include "ocm/simulation/dongle.hpp"

#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace simulation_dongle_test {

using namespace ocm;
using namespace std::chrono_literals;
using simulation::Dongle;
using simulation::DongleModel;
using simulation::PacketCutter;
using test::Random;

base::Time at(base::Duration time) {
  return base::Time{time};
}
std::span<const std::uint8_t> bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}
/// All packets that wait, a bar behind each.
template <std::size_t N>
std::string taken(Dongle<N>& dongle, base::Time now) {
  std::string out;
  while (const auto packet = dongle.take(now)) {
    for (const std::uint8_t byte : packet->bytes()) out += static_cast<char>(byte);
    out += '|';
  }
  return out;
}

TEST_CASE("a dongle cuts at the line feed and at 20 bytes") {
  Dongle<> dongle;
  dongle.link(true, at(0s));
  CHECK(dongle.write(bytes("{S,IDL}\n{U,-177,-61,-68,49,0,0,0,0}\n"), at(0s)) == 36);
  CHECK(taken(dongle, at(1s)) == "{S,IDL}\n|{U,-177,-61,-68,49,0|,0,0,0}\n|");
  CHECK(dongle.write(bytes("{U,-177,-61,-68,1}\n.{U,-177,-61,-68,12}\n"), at(1s)) == 40);
  CHECK(taken(dongle, at(2s)) == "{U,-177,-61,-68,1}\n|.{U,-177,-61,-68,12}|\n|");  // the feed by itself
  CHECK(dongle.outbox().sent == 6);
}

TEST_CASE("a dongle's UART takes its time: 10 bits a byte") {
  Dongle<> dongle{DongleModel{.baud = 10'000, .uart_room = 256}};  // 1 ms a byte
  dongle.link(true, at(0s));
  CHECK(dongle.write(bytes("{S,IDL}\n"), at(5ms)) == 8);
  CHECK(taken(dongle, at(13ms - 1ns)) == "");
  CHECK(taken(dongle, at(13ms)) == "{S,IDL}\n|");
  CHECK(dongle.write(bytes("a\n"), at(13ms)) == 2);  // the line has just become free
  CHECK(dongle.write(bytes("b\n"), at(14ms)) == 2);  // and is busy until 15 ms
  CHECK(taken(dongle, at(15ms)) == "a\n|");
  CHECK(taken(dongle, at(17ms - 1ns)) == "");
  CHECK(taken(dongle, at(17ms)) == "b\n|");
}

TEST_CASE("a dongle's UART has 38400 baud and room for 256 bytes, unless more is said") {
  const DongleModel model;
  CHECK(model.baud == 38'400);
  CHECK(model.uart_room == 256);
}

TEST_CASE("a dongle's UART has at least 1 baud: 10 s a byte") {
  for (const std::uint32_t baud : {0U, 1U}) {
    Dongle<> dongle{DongleModel{.baud = baud, .uart_room = 256}};
    dongle.link(true, at(0s));
    CHECK(dongle.write(bytes("a\n"), at(0s)) == 2);
    CHECK(taken(dongle, at(20s - 1ns)) == "");
    CHECK(taken(dongle, at(20s)) == "a\n|");
  }
}

TEST_CASE("a dongle's UART has so much room, and says what it did not take") {
  Dongle<> dongle{DongleModel{.baud = 10'000, .uart_room = 8}};
  dongle.link(true, at(0s));
  CHECK(dongle.write(bytes("0123456789"), at(0s)) == 8);
  CHECK(dongle.write(bytes("ab"), at(3ms - 1ns)) == 2);  // two bytes are through
  CHECK(dongle.write(bytes("c"), at(3ms - 1ns)) == 0);
  CHECK(dongle.counters() == simulation::DongleCounters{0, 3, 0});
  CHECK(dongle.write(bytes("\n"), at(100ms)) == 1);
  CHECK(taken(dongle, at(1s)) == "01234567ab\n|");
}

TEST_CASE("a dongle whose queue is full loses packets, not its mind: sentences are torn as in listing 15.1") {
  Dongle<2> dongle;
  dongle.link(true, at(0s));
  (void)dongle.write(bytes("{U,-177,-61,-68,49,0,0,0,0}\n{S,IDL}\n{S,IDL}\n"), at(0s));
  CHECK(taken(dongle, at(1s)) == "{U,-177,-61,-68,49,0|,0,0,0}\n|");
  CHECK(dongle.outbox().refused == 2);
  (void)dongle.write(bytes("{S,IDL}\n{U,-177,-61,-68,49,0,0,0,0}\n"), at(1s));
  CHECK(taken(dongle, at(2s)) == "{S,IDL}\n|{U,-177,-61,-68,49,0|");
  CHECK(dongle.outbox().refused == 3);
}

TEST_CASE("without a link nothing is kept, and what waits goes with its link") {
  Dongle<> dongle{DongleModel{.baud = 10'000, .uart_room = 256}};
  CHECK_FALSE(dongle.linked());
  CHECK(dongle.write(bytes("{S,IDL}\n"), at(0s)) == 8);
  CHECK(dongle.counters().unlinked == 8);
  dongle.link(true, at(1s));
  CHECK(dongle.linked());
  CHECK(taken(dongle, at(2s)) == "");

  (void)dongle.write(bytes("old\nolder\nbegun and not done"), at(2s));
  dongle.link(true, at(2s + 12ms));   // no news
  dongle.link(false, at(2s + 12ms));  // two packets, two bytes of the third, 16 on the UART
  CHECK(dongle.outbox().dropped == 2);
  CHECK(dongle.counters().dropped == 18);
  CHECK(taken(dongle, at(3s)) == "");
  dongle.link(true, at(3s));
  (void)dongle.write(bytes("new\n"), at(3s));
  CHECK(taken(dongle, at(4s)) == "new\n|");
}

TEST_CASE("of random writes, links and times every byte is sent, in order, or counted") {
  Random random{61};
  for (int round = 0; round < 50; ++round) {
    Dongle<4> dongle{DongleModel{.baud = 38'400, .uart_room = 64}};
    base::Time now{};
    std::uint64_t written = 0, sent = 0, torn = 0;
    std::uint8_t next = 0;
    std::string link;  // what was written on this link and may still come
    for (int step = 0; step < 500; ++step) {
      now += base::Duration{random.below(4'000'000)};
      switch (random.below(8)) {
        case 0:
          dongle.link(random.below(3) != 0, now);
          if (!dongle.linked()) link.clear();
          break;
        case 1: {
          const auto packet = dongle.take(now);
          if (!packet) break;
          CHECK(dongle.linked());
          sent += packet->size;
          std::string text;
          for (const std::uint8_t byte : packet->bytes()) text += static_cast<char>(byte);
          const auto place = link.find(text);  // whole and in order: what lies before was refused
          REQUIRE(place != std::string::npos);
          torn += place;
          link.erase(0, place + text.size());
          break;
        }
        default: {
          std::string text;
          for (auto n = random.below(30); n > 0; --n)
            text += random.below(12) == 0 ? '\n' : static_cast<char>(33 + next++ % 200);
          const std::size_t took = dongle.write(bytes(text), now);
          written += text.size();
          if (dongle.linked()) link += text.substr(0, took);
        }
      }
    }
    dongle.link(false, now);
    CHECK(sent <= written);
    CHECK(dongle.outbox().sent > 0);
    CHECK(dongle.outbox().refused > 0);
    CHECK(dongle.counters().unlinked > 0);
    CHECK(sent + dongle.counters().unlinked + dongle.counters().refused + dongle.counters().dropped + torn <=
          written);
    CHECK(dongle.take(now).error == base::Error::no_answer);
  }
}

TEST_CASE("a packet cutter") {
  PacketCutter cutter;
  CHECK(cutter.begun() == 0);
  for (int i = 0; i < 19; ++i) CHECK_FALSE(cutter.feed('x'));
  CHECK(cutter.begun() == 19);
  CHECK(cutter.feed('x'));
  CHECK(cutter.take().size == 20);
  CHECK(cutter.feed('\n'));
  CHECK(cutter.take().size == 1);
  CHECK_FALSE(cutter.feed('a'));
  CHECK(cutter.take().size == 1);  // begun is taken, too
  CHECK(cutter.begun() == 0);
}

}  // namespace simulation_dongle_test
