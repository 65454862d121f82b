// The model itself, by what the reference manual says: a test against it is worth what it is.
#include <catch2/catch.hpp>

#include "tests/firmware/bxcan/bench.hpp"

namespace ocm::bxcan_tests {
namespace {

struct Running : Model {
  explicit Running(std::uint32_t control = 0) {
    write(Register::mcr, 1);
    while ((read(Register::msr) & 1) == 0) {
    }
    write(Register::mcr, control);
    while ((read(Register::msr) & 1) != 0) {
    }
  }
  void request(std::size_t n, std::uint32_t id, std::uint8_t serial) {
    write(bxcan::of_mailbox(Register::tdtr, n), 1);
    write(bxcan::of_mailbox(Register::tdlr, n), serial);
    write(bxcan::of_mailbox(Register::tir, n), id << 21 | 1);
  }
  std::vector<std::uint8_t> drain() {
    while (begin()) end(End::acknowledged);
    std::vector<std::uint8_t> serials;
    for (const can::Frame& sent : transmitted) serials.push_back(sent.data[0]);
    return serials;
  }
  bool bit(std::uint32_t which, std::size_t n) {
    return (read(Register::tsr) & bxcan::tsr::at(which, n)) != 0;
  }
};

}  // namespace

TEST_CASE("mailboxes go by identifier, equals by mailbox [RM0008 24.7.2]") {
  Running model;
  model.request(0, 0x300, 1);
  model.request(2, 0x200, 2);
  model.request(1, 0x300, 3);
  CHECK(model.state(2) == Model::MailboxState::scheduled);
  CHECK(model.drain() == std::vector<std::uint8_t>{2, 1, 3});

  Running equals;  // the younger one in the lower mailbox overtakes
  equals.request(2, 0x300, 1);
  equals.request(0, 0x300, 2);
  CHECK(equals.drain() == std::vector<std::uint8_t>{2, 1});
}

TEST_CASE("with TXFP mailboxes go by request [RM0008 24.7.2]") {
  Running model{bxcan::mcr::txfp};
  model.request(1, 0x600, 1);
  model.request(0, 0x700, 2);
  model.request(2, 0x000, 3);
  CHECK(model.drain() == std::vector<std::uint8_t>{1, 2, 3});
}

TEST_CASE(
    "an abort empties a waiting mailbox at once, one on the wire when its attempt ends [RM0008 24.7.2]") {
  using bxcan::tsr::abrq, bxcan::tsr::rqcp, bxcan::tsr::txok, bxcan::tsr::tme;
  Running model;
  model.request(0, 0x100, 1);
  model.request(1, 0x200, 2);
  REQUIRE(model.begin()->id == 0x100);

  model.write(Register::tsr, bxcan::tsr::at(abrq, 1));
  CHECK(model.bit(rqcp, 1));
  CHECK_FALSE(model.bit(txok, 1));
  CHECK(model.bit(tme, 1));

  model.write(Register::tsr, bxcan::tsr::at(abrq, 0));
  CHECK_FALSE(model.bit(rqcp, 0));
  SECTION("sent all the same") {
    model.end(End::acknowledged);
    CHECK(model.bit(rqcp, 0));
    CHECK(model.bit(txok, 0));
  }
  SECTION("failed, and not tried again") {
    model.end(End::lost_arbitration);
    CHECK(model.bit(rqcp, 0));
    CHECK_FALSE(model.bit(txok, 0));
    CHECK(model.bit(tme, 0));
    CHECK_FALSE(model.begin());
  }
}

TEST_CASE("without an abort a failed attempt is repeated") {
  Running model;
  model.request(0, 0x100, 1);
  REQUIRE(model.begin());
  model.end(End::bit_error);
  CHECK(model.transmit_errors() == 8);
  CHECK_FALSE(model.bit(bxcan::tsr::rqcp, 0));
  CHECK(model.drain() == std::vector<std::uint8_t>{1});
  CHECK(model.transmit_errors() == 7);
}

TEST_CASE("an abort of an empty mailbox does nothing") {
  Running model;
  model.write(Register::tsr, bxcan::tsr::at(bxcan::tsr::abrq, 0));
  CHECK_FALSE(model.bit(bxcan::tsr::rqcp, 0));
}

TEST_CASE("what a program must not do is recorded") {
  Running model;
  model.request(0, 0x100, 1);
  model.write(Register::tir, 0);
  CHECK(model.violations.size() == 1);
  model.write(Register::btr, 0);
  CHECK(model.violations.size() == 2);
  model.write(Register::rf0r, bxcan::rfr::rfom);
  CHECK(model.violations.size() == 3);
  REQUIRE(model.begin());
  model.end(End::acknowledged);
  model.request(0, 0x100, 2);  // the note that 1 was sent is overwritten
  CHECK(model.violations.size() == 4);
}

TEST_CASE("filters of all four kinds [RM0008 figure 231]") {
  Running model;
  const auto only = [&model](std::uint32_t list, std::uint32_t wide, std::uint32_t first,
                             std::uint32_t second) {
    model.write(Register::fmr, 1);
    model.write(Register::fa1r, 0);
    model.write(Register::fm1r, list);
    model.write(Register::fs1r, wide);
    model.write(Register::fr1, first);
    model.write(Register::fr2, second);
    model.write(Register::fa1r, 1);
    model.write(Register::fmr, 0);
  };
  const auto base = [&model](std::uint32_t id) { return model.deliver({id, 0, {}}); };
  only(0, 0, (0x7F0U << 5) << 16 | 0x120 << 5, (0x7FFU << 5) << 16 | 0x555 << 5);  // two masks of 16 bits
  CHECK((base(0x120) && base(0x12F) && base(0x555) && !base(0x130) && !base(0x554)));
  CHECK(model.deliver({0x120, 0, {}, can::Format::base_remote}));                  // RTR is not in that mask
  only(1, 0, (0x301U << 5) << 16 | 0x300 << 5, (0x303U << 5) << 16 | 0x302 << 5);  // four identifiers
  CHECK((base(0x300) && base(0x301) && base(0x302) && base(0x303) && !base(0x304)));
  only(0, 1, 0x400U << 21, 0x700U << 21 | 6);  // one mask of 32 bits
  CHECK((base(0x400) && base(0x4FF) && !base(0x500)));
  CHECK_FALSE(model.deliver({0x400U << 18, 0, {}, can::Format::extended}));
  only(1, 1, 0x123U << 21, 0x1ABC'DEF0U << 3 | 4);  // two identifiers of 32 bits
  CHECK((base(0x123) && !base(0x124)));
  CHECK(model.deliver({0x1ABC'DEF0, 0, {}, can::Format::extended}));
}

TEST_CASE("error counters, and bus-off with and without ABOM [RM0008 24.7.6]") {
  Running model{bxcan::mcr::abom};
  model.request(0, 0x100, 1);
  for (int i = 0; i < 40; ++i) {
    if (!model.begin()) break;
    model.end(End::no_acknowledge);
  }
  CHECK(model.transmit_errors() == 128);  // passive, and no further
  for (int i = 0; model.begin(); ++i) {
    REQUIRE(i < 17);
    model.end(End::bit_error);
  }
  CHECK((model.read(Register::esr) & 7) == 7);
  model.recessive(127);
  CHECK((model.read(Register::esr) & 4) != 0);
  model.recessive(1);
  CHECK(model.read(Register::esr) >> 16 == 0);
  CHECK(model.drain() == std::vector<std::uint8_t>{1});
}

}  // namespace ocm::bxcan_tests
