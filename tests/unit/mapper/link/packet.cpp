#include "ocm/mapper/link/packet.hpp"

#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/sentence.hpp"

#include "unit/mapper/link/link_testing.hpp"

namespace mapper_link_packet_test {

using namespace ocm::mapper::link;
using ocm::base::Error;

constexpr bool is(const Packet& packet, std::string_view text) {
  if (packet.size != text.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (packet.data[i] != static_cast<std::uint8_t>(text[i])) return false;
  return true;
}

static_assert(packets_of(0) == 0 && packets_of(1) == 1 && packets_of(20) == 1 && packets_of(21) == 2);

// An update in two packets, cut where listing 15.1 shows it cut. [Thesis 2]
constexpr bool cut_as_in_the_listing() {
  const Line line = *write(ocm::test::first_of_listing);
  std::string_view rest = line.view();
  return is(take_packet(rest), "{U,-177,-61,-68,49,0") && is(take_packet(rest), ",0,0,0}\n") &&
         rest.empty() && take_packet(rest).size == 0;
}
static_assert(cut_as_in_the_listing());
// Two to four packets. [Thesis 2, 17.7]
static_assert(packets_of(write(Update{-177, -161, -168, 49, 110, 120, 130, 140})->view().size()) == 2);
static_assert(packets_of(write(Update{-32768, -32768, -360, 90, 255, 255, 255, 255})->view().size()) == 3);

TEST_CASE("packets of a text make the text again, each full but the last") {
  ocm::test::Random random{3};
  for (int n = 0; n < 500; ++n) {
    std::string text;
    for (std::uint32_t i = random.below(120); i > 0; --i) text += static_cast<char>(random.below(256));
    std::string again;
    std::size_t count = 0;
    for (std::string_view rest = text; !rest.empty(); ++count) {
      const Packet packet = take_packet(rest);
      CHECK((packet.full() || rest.empty()));
      for (const std::uint8_t byte : packet.bytes()) again += static_cast<char>(byte);
    }
    CHECK(again == text);
    CHECK(count == packets_of(text.size()));
  }
}

TEST_CASE("outbox: a line goes in whole or not at all, and comes out in order, round the end as well") {
  Outbox<3> outbox;
  const std::string long_line(41, 'x');  // three packets
  for (int round = 0; round < 5; ++round) {
    REQUIRE(outbox.put("ab"));
    CHECK(outbox.put(long_line).error == Error::full);
    CHECK(outbox.size() == 1);
    REQUIRE(outbox.put(std::string(21, 'y')));
    CHECK(outbox.put(Packet{}).error == Error::full);
    CHECK(is(*outbox.take(), "ab"));
    CHECK(is(*outbox.take(), std::string(20, 'y')));
    CHECK(is(*outbox.take(), "y"));
    CHECK(outbox.take().error == Error::no_answer);
  }
  CHECK(outbox.counters() == OutboxCounters{.sent = 15, .refused = 20, .dropped = 0});
  REQUIRE(outbox.put(long_line));
  CHECK(outbox.drop_all() == 3);
  CHECK(outbox.drop_all() == 0);
  CHECK(outbox.take().error == Error::no_answer);
  CHECK(outbox.counters() == OutboxCounters{.sent = 15, .refused = 20, .dropped = 3});
}

TEST_CASE("packets are equal by what they hold, not by what lies behind it") {
  Packet a;
  Packet b;
  CHECK(a.push('x'));
  CHECK_FALSE(a == b);
  CHECK(b.push('y'));
  CHECK_FALSE(a == b);
  b.data[0] = 'x';
  b.data[7] = 'z';
  CHECK(a == b);
  while (a.push('.')) continue;
  CHECK(a.size == 20);
}

}  // namespace mapper_link_packet_test
