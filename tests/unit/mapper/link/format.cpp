#include "ocm/mapper/link/format.hpp"

#include <string>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/demultiplexer.hpp"

#include "unit/mapper/link/link_testing.hpp"

namespace mapper_link_format_test {

using namespace ocm::mapper::link;
using ocm::base::Error;

constexpr Handshake old_robot{.width = 15, .length = 20, .given = 9};
constexpr Handshake new_robot{.width = 15, .length = 20, .formats = Handshake::packed_offer, .given = 10};
static_assert(offers_packed(Handshake{.formats = Handshake::packed_offer, .sensor_out = 3}));

static_assert(offers_packed(new_robot));
static_assert(!offers_packed(old_robot));
static_assert(!offers_packed(Handshake{.formats = 1}));  // a number of some other meaning
static_assert(!offers_packed(Handshake{.formats = Handshake::packed_offer, .given = 9}));  // not said
static_assert(answer(old_robot, true) == "{S,CON}\n");  // new server, old robot
static_assert(answer(new_robot, true) == "{S,BIN}\n{S,CON}\n");
static_assert(answer(new_robot, false) == "{S,CON}\n");  // old server
static_assert(UpdateWriter{true}.offer() == Handshake::packed_offer && UpdateWriter{false}.offer() == 0);

TEST_CASE("format: text until asked, and on every new link; a robot that did not offer is never asked") {
  const Update update{1, 2, 3, 4, 5, 6, 7, 8};
  UpdateWriter writer{true};
  Outbox<8> outbox;
  REQUIRE(writer.send(update, outbox));
  CHECK_FALSE(is_packed(outbox.take()->data[0]));
  writer.hear(Kind::confirm);
  CHECK_FALSE(writer.packed());
  writer.hear(Kind::packed);
  for (const int number : {0, 1, 2}) {
    REQUIRE(writer.send(update, outbox));
    const Packet packet = *outbox.take();
    CHECK(unpack(std::span<const std::uint8_t, 20>{packet.data}).value ==
          PackedUpdate{static_cast<std::uint8_t>(number), update});
  }
  writer.hear(Kind::text);
  CHECK_FALSE(writer.packed());
  writer.hear(Kind::packed);
  writer.restart();
  CHECK_FALSE(writer.packed());

  UpdateWriter plain{false};
  plain.hear(Kind::packed);
  CHECK_FALSE(plain.packed());
}

TEST_CASE("format: an update that the queue refuses takes a number; one that cannot be takes none") {
  UpdateWriter writer{true};
  writer.hear(Kind::packed);
  Outbox<1> outbox;
  REQUIRE(writer.send({}, outbox));
  CHECK(writer.send({}, outbox).error == Error::full);
  CHECK(writer.send({.servo = 91}, outbox).error == Error::out_of_range);
  CHECK(outbox.size() == 1);
  (void)outbox.take();
  REQUIRE(writer.send({}, outbox));
  CHECK(unpack(std::span<const std::uint8_t, 20>{outbox.take()->data})->sequence == 2);
  CHECK(UpdateWriter{false}.send({.servo = 91}, outbox).error == Error::out_of_range);
}

TEST_CASE("format: robot and server agree over the line, also if one of them is old") {
  for (const bool robot_can : {false, true}) {
    for (const bool server_wants : {false, true}) {
      CAPTURE(robot_can, server_wants);
      UpdateWriter writer{robot_can};
      Handshake handshake{.width = 15, .length = 20};
      handshake.formats = writer.offer();
      Ear server;
      Reader robot{Direction::to_robot};
      const Line hello = *write(handshake);
      for (const char c : hello.view()) (void)server.feed(static_cast<std::uint8_t>(c));
      bool confirmed = false;
      const auto reply = answer(server.sentence().as<Handshake>().value, server_wants);
      for (const char c : reply.view()) {
        const Kind kind = robot.feed(c);
        writer.hear(kind);
        confirmed = confirmed || kind == Kind::confirm;
      }
      CHECK(confirmed);
      CHECK(writer.packed() == (robot_can && server_wants));
      Outbox<4> outbox;
      const Update update{-177, -61, -68, 49, 12, 30, 45, 80};
      REQUIRE(writer.send(update, outbox));
      CHECK(outbox.size() == (writer.packed() ? 1 : 2));
      Kind last = Kind::none;
      while (const auto packet = outbox.take())
        for (const std::uint8_t byte : packet->bytes())
          if (const Kind kind = server.feed(byte); kind != Kind::none) last = kind;
      CHECK(last == Kind::update);
      CHECK(server.sentence().as<Update>().value == update);
    }
  }
}

}  // namespace mapper_link_format_test
