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
  // The last bit of a filter of 32 bits is of no identifier, and does not count.
  only(1, 1, 0x123U << 21 | 1, 0x125U << 21 | 1);
  CHECK((base(0x123) && base(0x125) && !base(0x124)));
  only(0, 1, 0x400U << 21 | 1, 0x700U << 21 | 1);
  CHECK((base(0x400) && base(0x4FF) && !base(0x500)));
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

TEST_CASE("registers as they are after a reset [RM0008 24.9.2, 24.9.4]") {
  Model model;
  CHECK(model.read(Register::mcr) == 0x1'0002);
  CHECK(model.read(Register::msr) == 0xC02);
  CHECK(model.read(Register::tsr) == 0x1C00'0000);
  CHECK(model.read(Register::btr) == 0x0123'0000);
  CHECK(model.read(Register::fmr) == 0x2A1C'0E01);
  for (const Register which : {Register::rf0r, Register::rf1r, Register::ier, Register::esr, Register::fm1r,
                               Register::fs1r, Register::ffa1r, Register::fa1r})
    CHECK(model.read(which) == 0);
  CHECK(model.violations.empty());
  CHECK_FALSE(model.initialising());
  CHECK_FALSE(model.begin());  // asleep
  CHECK_FALSE(model.deliver({0x100, 0, {}}));
  CHECK(model.read(Register::rf0r) == 0);
  model.write(Register::mcr, 0x1234'0004);  // out of sleep; what is reserved is not kept
  CHECK(model.read(Register::mcr) == 0x0'0004);
  CHECK(model.read(Register::msr) == 0xC00);
  CHECK(model.read(static_cast<Register>(0x400)) == 0);
  CHECK(model.violations == std::vector<std::string>{"read of a register that is not there"});
  model.write(Register::esr, 0);
  CHECK(model.violations.back() == "write to a register that cannot be written");
  CHECK(model.violations.size() == 2);
}

TEST_CASE(
    "initialisation is entered and left some accesses after it is asked for, and not in a frame [RM0008 "
    "24.4.1]") {
  Model model;
  for (const unsigned delay : {0U, 1U, 2U, 5U}) {
    CAPTURE(delay);
    model.handshake_delay = delay;
    for (const std::uint32_t wanted : {1U, 0U}) {
      model.write(Register::mcr, wanted);
      for (unsigned access = 1; access < delay; ++access) CHECK((model.read(Register::msr) & 1) != wanted);
      CHECK((model.read(Register::msr) & 3) == wanted);
      model.write(Register::mcr, wanted);  // asked again, nothing begins
      CHECK((model.read(Register::msr) & 1) == wanted);
    }
  }
  model.handshake_delay = 0;
  model.write(Register::mcr, 1);
  REQUIRE((model.read(Register::msr) & 1) == 1);
  model.write(Register::btr, 0x1C'0003);
  CHECK(model.read(Register::btr) == 0x1C'0003);
  model.dominant = true;
  model.write(Register::mcr, 0);
  for (int i = 0; i < 100; ++i) CHECK((model.read(Register::msr) & 1) == 1);
  CHECK_FALSE(model.deliver({0x100, 0, {}}));
  model.dominant = false;
  CHECK((model.read(Register::msr) & 1) == 0);
  CHECK(model.violations.empty());

  Running running;
  running.request(0, 0x100, 1);
  REQUIRE(running.begin());
  running.write(Register::mcr, 1);
  for (int i = 0; i < 10; ++i) CHECK((running.read(Register::msr) & 1) == 0);
  running.end(End::acknowledged);
  running.read(Register::msr);
  running.read(Register::msr);
  CHECK((running.read(Register::msr) & 1) == 1);
  CHECK_FALSE(running.begin());
}

TEST_CASE("asleep, in initialisation or bus-off it neither sends nor receives [RM0008 24.4, 24.7.6]") {
  Model model;
  model.handshake_delay = 0;
  model.write(Register::fs1r, 1);
  model.write(Register::fa1r, 1);  // one mask of 32 bits, of which none counts
  model.write(Register::fmr, 0);
  model.write(bxcan::of_mailbox(Register::tir, 0), 0x100U << 21 | 1);
  const auto on_the_bus = [&model] {
    const bool received = model.deliver({0x200, 0, {}});
    CHECK((model.read(Register::rf0r) & 3) == (received ? 1U : 0U));
    if (received) model.write(Register::rf0r, 0x20);
    model.read(Register::rf0r);
    const bool sends = model.begin().has_value();
    CHECK(sends == received);
    return sends;
  };
  CHECK_FALSE(on_the_bus());  // asleep
  model.write(Register::mcr, 1);
  REQUIRE((model.read(Register::msr) & 3) == 1);
  CHECK_FALSE(on_the_bus());
  model.write(Register::mcr, 0);
  REQUIRE((model.read(Register::msr) & 3) == 0);
  for (int i = 0; i < 32; ++i) {
    CHECK(on_the_bus());
    model.end(End::bit_error);
  }
  REQUIRE((model.read(Register::esr) & 4) != 0);
  CHECK_FALSE(on_the_bus());
  CHECK(model.violations.empty());
}

TEST_CASE("a mailbox's frame, and what its status says of it [RM0008 24.9.3]") {
  Running model;
  const auto send = [&model](std::uint32_t tir, std::uint32_t tdtr) {
    model.write(bxcan::of_mailbox(Register::tdtr, 1), tdtr);
    model.write(bxcan::of_mailbox(Register::tdlr, 1), 0x4433'2211);
    model.write(bxcan::of_mailbox(Register::tdhr, 1), 0x8877'6655);
    model.write(bxcan::of_mailbox(Register::tir, 1), tir | 1);
    const auto sent = model.begin();
    REQUIRE(sent);
    return *sent;
  };
  CHECK(send(0x7FFU << 21, 8) == can::Frame{0x7FF, 8, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}});
  CHECK(model.read(bxcan::of_mailbox(Register::tir, 1)) == 0x7FFU << 21);  // TXRQ is not kept
  CHECK(model.read(bxcan::of_mailbox(Register::tdtr, 1)) == 8);
  CHECK(model.read(bxcan::of_mailbox(Register::tdlr, 1)) == 0x4433'2211);
  CHECK(model.read(bxcan::of_mailbox(Register::tdhr, 1)) == 0x8877'6655);
  CHECK(model.read(bxcan::of_mailbox(Register::tdlr, 0)) == 0);
  CHECK(model.read(bxcan::of_mailbox(Register::tdlr, 2)) == 0);
  // TSR: CODE is the lowest empty mailbox, TME of the others.
  CHECK(model.read(Register::tsr) == 0x1400'0000);
  CHECK(model.on_wire());
  CHECK(model.state(1) == Model::MailboxState::transmit);
  CHECK_FALSE(model.begin());
  const auto ends = [&model](End how) {
    model.end(how);
    CHECK_FALSE(model.on_wire());
    return model.read(Register::tsr);
  };
  CHECK(ends(End::lost_arbitration) == (0x1400'0000 | 4U << 8));
  CHECK(model.state(1) == Model::MailboxState::scheduled);
  REQUIRE(model.begin());
  CHECK(ends(End::no_acknowledge) == (0x1400'0000 | 8U << 8));
  CHECK(model.read(Register::esr) == (3U << 4 | 8U << 16));
  REQUIRE(model.begin());
  CHECK(ends(End::bit_error) == (0x1400'0000 | 8U << 8));
  CHECK(model.read(Register::esr) == (4U << 4 | 16U << 16));
  REQUIRE(model.begin());
  CHECK_FALSE(model.transmit_interrupt());
  CHECK(ends(End::acknowledged) == (0x1C00'0000 | 3U << 8));
  CHECK(model.read(Register::esr) == 15U << 16);
  CHECK_FALSE(model.transmit_interrupt());  // TMEIE is not set
  model.write(Register::ier, 1);
  CHECK(model.transmit_interrupt());
  model.write(Register::tsr, 1U << 8);
  CHECK_FALSE(model.transmit_interrupt());
  CHECK(model.read(Register::tsr) == 0x1C00'0000);
  model.end(End::acknowledged);  // nothing is on the wire
  CHECK(model.transmitted.size() == 1);

  CHECK(send(0x1ABC'DEF0U << 3 | 4, 2) == can::Frame{0x1ABC'DEF0, 2, {0x11, 0x22}, can::Format::extended});
  model.end(End::acknowledged);
  model.write(Register::tsr, 1U << 8);
  CHECK(send(0x123U << 21 | 2, 3).format == can::Format::base_remote);
  model.end(End::acknowledged);
  model.write(Register::tsr, 1U << 8);
  CHECK(send(0x123U << 3 | 6, 0) == can::Frame{0x123, 0, {}, can::Format::extended_remote});
  model.end(End::acknowledged);
  model.write(Register::tsr, 1U << 8);
  CHECK(model.violations.empty());
  send(0x100U << 21, 9);
  CHECK(model.violations == std::vector<std::string>{"DLC above 8"});
}

TEST_CASE("CODE is the lowest empty mailbox, and there is none of three [RM0008 24.9.2, CAN_TSR]") {
  Running model;
  model.request(0, 0x100, 1);
  CHECK(model.read(Register::tsr) >> 24 == (0x18 | 1));
  model.request(1, 0x100, 2);
  CHECK(model.read(Register::tsr) >> 24 == (0x10 | 2));
  model.request(2, 0x100, 3);
  CHECK(model.read(Register::tsr) >> 24 == 0);
  model.write(Register::tsr, 0x80U | 0x80U << 16);  // aborts two of them
  CHECK(model.read(Register::tsr) == (0x1400'0000 | 1U | 1U << 16));
  CHECK(model.drain() == std::vector<std::uint8_t>{2});
}

TEST_CASE("an abort that is granted later is seen later, and not of what went on the wire meanwhile") {
  Running model;
  model.abort_delay = 3;
  model.request(0, 0x100, 1);
  model.request(2, 0x200, 2);
  model.write(Register::tsr, 0x80U << 16);
  CHECK(model.read(Register::tsr) >> 16 == (0x0800 | 1U << 8 | 0x80));
  CHECK(model.read(Register::tsr) >> 16 == (0x0800 | 1U << 8 | 0x80));
  CHECK(model.read(Register::tsr) >> 16 == (0x1800 | 1U << 8 | 1));
  model.write(Register::tsr, 0x80U);
  REQUIRE(model.begin());
  for (int i = 0; i < 5; ++i) model.read(Register::tsr);
  CHECK((model.read(Register::tsr) & 0xFF) == 0x80);
  model.end(End::acknowledged);
  CHECK((model.read(Register::tsr) & 0xFF) == 3);
  CHECK(model.transmitted.size() == 1);
}

TEST_CASE("with NART a frame has one attempt [RM0008 24.7.2]") {
  Running model{1U << 4};
  model.request(0, 0x100, 1);
  REQUIRE(model.begin());
  model.end(End::lost_arbitration);
  CHECK((model.read(Register::tsr) & 0xFF) == 5);
  CHECK_FALSE(model.begin());
}

TEST_CASE("a FIFO holds three; what is above its length, and when it is released [RM0008 24.7.3, 24.9.3]") {
  for (const bool second : {false, true}) {
    for (const bool locked : {false, true}) {
      CAPTURE(second, locked);
      Running model{locked ? 1U << 3 : 0U};
      const Register rfr = second ? Register::rf1r : Register::rf0r;
      const auto word = [&](Register of_fifo_0) {
        return model.read(
            static_cast<Register>(static_cast<std::uint32_t>(of_fifo_0) + (second ? 0x10U : 0U)));
      };
      model.write(Register::fs1r, 1);
      model.write(Register::ffa1r, second ? 1 : 0);
      model.write(Register::fa1r, 1);              // one mask of 32 bits, of which none counts
      CHECK_FALSE(model.deliver({0x100, 0, {}}));  // while filters are set up
      model.write(Register::fmr, 0);
      CHECK(word(Register::rir) == 0xDEAD'BEEF);
      const auto frame = [](std::uint32_t id) {
        return can::Frame{id, 6, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66}};
      };
      CHECK(model.deliver(frame(0x101)));
      CHECK(model.read(rfr) == 1);
      CHECK(word(Register::rir) == 0x101U << 21);
      CHECK((word(Register::rdtr) & 0xF) == 6);
      CHECK(word(Register::rdlr) == 0x4433'2211);
      CHECK(word(Register::rdhr) == 0x6655);
      CHECK(model.read(second ? Register::rf0r : Register::rf1r) == 0);
      CHECK(model.deliver({0x1ABC'DEF0, 0, {}, can::Format::extended_remote}));
      CHECK(model.deliver(frame(0x103)));
      CHECK(model.read(rfr) == (3 | 8));
      CHECK(model.deliver(frame(0x104)));  // one too many
      CHECK(model.read(rfr) == (3 | 8 | 0x10));
      model.write(rfr, 0x10);
      CHECK(model.read(rfr) == (3 | 8));
      model.write(rfr, 0x20);
      CHECK(model.read(rfr) == (3 | 8 | 0x20));
      CHECK(word(Register::rir) == (0x1ABC'DEF0U << 3 | 6));
      CHECK(model.read(rfr) == 2);
      model.write(rfr, 0x20);
      model.read(rfr);
      CHECK(word(Register::rir) == (locked ? 0x103U : 0x104U) << 21);
      CHECK_FALSE(model.receive_interrupt());
      CHECK_FALSE(model.receive_interrupt_of_fifo_1());
      model.write(Register::ier, 0x02);
      CHECK(model.receive_interrupt() == !second);
      CHECK_FALSE(model.receive_interrupt_of_fifo_1());
      model.write(Register::ier, 0x10);
      CHECK_FALSE(model.receive_interrupt());
      CHECK(model.receive_interrupt_of_fifo_1() == second);
      model.write(rfr, 0x20);
      CHECK(model.violations.empty());
      model.write(rfr, 0x20);  // in release
      CHECK(model.violations.size() == 1);
      CHECK(model.read(rfr) == 0);
    }
  }
}

TEST_CASE("an overrun is there until it is acknowledged, however many frames are released [RM0008 24.9.5]") {
  Running model;
  model.write(Register::fs1r, 1);
  model.write(Register::fa1r, 1);
  model.write(Register::fmr, 0);
  for (std::uint32_t id = 0x101; id < 0x105; ++id) CHECK(model.deliver({id, 0, {}}));
  CHECK(model.read(Register::rf0r) == (3 | 8 | 0x10));
  model.write(Register::rf0r, 0x20);
  CHECK(model.read(Register::rf0r) == (3 | 8 | 0x10 | 0x20));
  model.read(Register::rir);
  CHECK(model.read(Register::rf0r) == (2 | 0x10));
  model.write(Register::rf0r, 0x10);
  CHECK(model.read(Register::rf0r) == 2);
}

TEST_CASE("each bank has a place, and filters are set up while they are off [RM0008 24.9.4]") {
  Running model;
  for (std::uint32_t bank = 0; bank < 14; ++bank)
    for (std::uint32_t half = 0; half < 2; ++half)
      model.write(static_cast<Register>(0x240 + 8 * bank + 4 * half), 0x100 * bank + half + 1);
  for (std::uint32_t bank = 0; bank < 14; ++bank)
    for (std::uint32_t half = 0; half < 2; ++half)
      CHECK(model.read(static_cast<Register>(0x240 + 8 * bank + 4 * half)) == 0x100 * bank + half + 1);
  CHECK(model.violations.empty());
  model.write(Register::fa1r, 0x2001);
  model.write(static_cast<Register>(0x240), 7);  // FINIT is set: it may be
  CHECK(model.violations.empty());
  model.write(Register::fmr, 0);
  for (const std::uint32_t where : {0x240U, 0x244U, 0x240U + 13 * 8}) {
    model.violations.clear();
    model.write(static_cast<Register>(where), 9);
    CHECK(model.violations == std::vector<std::string>{"filter changed while it is active"});
  }
  model.violations.clear();
  model.write(static_cast<Register>(0x248), 9);
  CHECK(model.violations.empty());
  CHECK(model.read(static_cast<Register>(0x240)) == 7);
  CHECK(model.read(static_cast<Register>(0x248)) == 9);
  for (const Register which : {Register::fm1r, Register::fs1r, Register::ffa1r}) {
    model.violations.clear();
    model.write(which, 1);
    CHECK(model.violations == std::vector<std::string>{"filter set up outside its initialisation"});
    CHECK(model.read(which) == 0);
  }
  model.violations.clear();
  CHECK(model.read(static_cast<Register>(0x240 + 14 * 8)) == 0);
  CHECK(model.violations.size() == 1);
}

TEST_CASE(
    "wide filters go before narrow ones, lists before masks, lower banks before higher [RM0008 24.7.4]") {
  // Bank 0: mask of 16 bits, 1: list of 16, 2: mask of 32, 3: list of 32. All take identifier 0x123; of two
  // FIFOs in turn.
  for (std::uint32_t active = 1; active < 16; ++active) {
    CAPTURE(active);
    Running model;
    model.write(Register::fm1r, 0b1010);
    model.write(Register::fs1r, 0b1100);
    model.write(Register::ffa1r, 0b1010);
    const std::uint32_t narrow = 0x123U << 5, wide = 0x123U << 21;
    const std::uint32_t words[4][2] = {{0xFFE0'0000 | narrow, 0xFFFF'0000 | 0x7FF << 5},
                                       {narrow | 0xFFFF'0000, 0xFFFF'FFFF},
                                       {wide, 0xFFE0'0000},
                                       {wide, 0xFFFF'FFFF}};
    for (std::uint32_t bank = 0; bank < 4; ++bank)
      for (std::uint32_t half = 0; half < 2; ++half)
        model.write(static_cast<Register>(0x240 + 8 * bank + 4 * half), words[bank][half]);
    model.write(Register::fa1r, active);
    model.write(Register::fmr, 0);
    CHECK(model.deliver({0x123, 0, {}}));
    std::size_t best = 0;
    for (std::size_t bank = 0; bank < 4; ++bank)
      if ((active >> bank & 1) != 0) best = bank;  // they are in this order
    for (std::size_t bank = 0; bank < 14; ++bank) CHECK(model.filters_used[bank] == (bank == best));
    CHECK((model.read(Register::rf0r) & 3) == (best % 2 == 0 ? 1U : 0U));
    CHECK((model.read(Register::rf1r) & 3) == (best % 2 == 1 ? 1U : 0U));
    CHECK(model.violations.empty());
    CHECK_FALSE(model.deliver({0x124, 0, {}}));
  }
}

TEST_CASE("filters of 16 bits see the extended identifier's first bits [RM0008 figure 231]") {
  Running model;
  model.write(Register::fm1r, 1);
  model.write(Register::fa1r, 1);
  const std::uint32_t id = 0x1555'4000 | 5U << 15;  // STID, EXID[17:15]
  const std::uint32_t word = (id >> 18) << 5 | 8 | (id >> 15 & 7);
  model.write(Register::fr1, 0xFFFF'0000 | word);
  model.write(Register::fr2, (word | 0x10) << 16 | 0xFFFF);
  model.write(Register::fmr, 0);
  CHECK(model.deliver({id, 0, {}, can::Format::extended}));
  CHECK(model.deliver({id | 0x7FFF, 0, {}, can::Format::extended}));
  CHECK(model.deliver({id, 0, {}, can::Format::extended_remote}));
  CHECK_FALSE(model.deliver({id ^ 1U << 15, 0, {}, can::Format::extended}));
  CHECK_FALSE(model.deliver({id >> 18, 0, {}}));
}

TEST_CASE("limits of the error counters, and which of them asks for an interrupt [RM0008 24.7.6]") {
  const auto esr = [](Running& model) { return model.read(Register::esr) & 7; };
  Running model;
  for (int errors = 1; errors <= 128; ++errors) {
    model.disturb(static_cast<std::uint8_t>(errors % 7));
    CHECK(esr(model) == (errors > 127 ? 3U : errors >= 96 ? 1U : 0U));
    CHECK((model.read(Register::esr) >> 4 & 7) == static_cast<std::uint32_t>(errors % 7));
    CHECK(model.read(Register::esr) >> 24 == static_cast<std::uint32_t>(errors));
  }
  model.deliver({0x100, 0, {}});  // one that is good brings it back to below 128
  CHECK(model.read(Register::esr) >> 24 == 120);
  CHECK(esr(model) == 1);
  model.deliver({0x100, 0, {}});
  CHECK(model.read(Register::esr) >> 24 == 119);
  Running fresh;
  fresh.deliver({0x100, 0, {}});
  CHECK(fresh.read(Register::esr) == 0);

  // EWGIE, EPVIE and BOFIE, each alone, with and without ERRIE.
  for (const std::uint32_t which : {1U << 8, 1U << 9, 1U << 10})
    for (const std::uint32_t all : {0U, 1U << 15}) {
      CAPTURE(which, all);
      Running one;
      one.write(Register::ier, which | all);
      one.request(0, 0x100, 1);
      int first = 0;
      for (int attempt = 1; attempt <= 40 && one.begin(); ++attempt) {
        one.end(End::bit_error);
        if (first == 0 && one.error_interrupt()) first = attempt;
      }
      CHECK(first == (all == 0 ? 0 : which == 1U << 8 ? 12 : which == 1U << 9 ? 16 : 32));
      CHECK(((one.read(Register::msr) & 4) != 0) == (first != 0));
      one.write(Register::msr, 4);
      CHECK_FALSE(one.error_interrupt());
      one.disturb();  // no news of that kind
      CHECK_FALSE(one.error_interrupt());
    }
}

TEST_CASE(
    "a transmitter at the last count of a state is in it, and one more error is in the next [RM0008 "
    "24.7.6]") {
  Running model;
  const auto esr = [&model] { return model.read(Register::esr) & 7; };
  const auto fails = [&model](End how, int times) {
    for (int i = 0; i < times; ++i) {
      REQUIRE(model.begin());
      model.end(how);
    }
  };
  model.request(0, 0x100, 1);
  fails(End::bit_error, 1);
  fails(End::acknowledged, 1);
  CHECK(model.transmit_errors() == 7);
  model.write(Register::tsr, 1);
  model.request(0, 0x100, 2);
  fails(End::bit_error, 15);
  CHECK(model.transmit_errors() == 127);
  CHECK(esr() == 1);
  fails(End::no_acknowledge, 1);  // it was active: this counts
  CHECK(model.transmit_errors() == 135);
  CHECK(esr() == 3);
  fails(End::no_acknowledge, 1);  // now it is passive
  CHECK(model.transmit_errors() == 135);
  fails(End::bit_error, 15);
  CHECK(model.transmit_errors() == 255);
  CHECK(esr() == 3);
  fails(End::bit_error, 1);
  CHECK(esr() == 7);
  CHECK_FALSE(model.begin());

  Running receiver;
  for (int i = 0; i < 127; ++i) receiver.disturb();
  receiver.deliver({0x100, 0, {}});
  CHECK(receiver.read(Register::esr) >> 24 == 126);
}

TEST_CASE("bus-off without ABOM stays, and ends all but what is counted [RM0008 24.7.6]") {
  Running model;
  model.request(0, 0x100, 1);
  for (int i = 0; i < 32; ++i) {
    REQUIRE(model.begin());
    CHECK((model.read(Register::esr) & 4) == 0);
    model.end(End::bit_error);
  }
  CHECK((model.read(Register::esr) & 4) != 0);
  CHECK_FALSE(model.begin());
  CHECK_FALSE(model.deliver({0x100, 0, {}}));
  model.recessive(1000);
  CHECK((model.read(Register::esr) & 4) != 0);
  model.write(Register::mcr, 1U << 6);
  model.recessive(100);
  CHECK((model.read(Register::esr) & 4) != 0);
  model.recessive(28);
  CHECK((model.read(Register::esr) & 7) == 0);
  CHECK(model.transmit_errors() == 0);
  CHECK(model.drain() == std::vector<std::uint8_t>{1});
  // And once more from the beginning.
  model.write(Register::tsr, 1);
  model.request(0, 0x100, 2);
  for (int i = 0; i < 32 && model.begin(); ++i) model.end(End::bit_error);
  model.recessive(127);
  CHECK((model.read(Register::esr) & 4) != 0);
}

}  // namespace ocm::bxcan_tests
