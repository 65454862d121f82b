#include "ocm/log/entry.hpp"

#include <catch2/catch.hpp>

namespace log_entry_test {

using namespace ocm;
using log::Entry;

TEST_CASE("an entry keeps what a classic frame has, and gives it back") {
  const can::Frame frame{0x605, 4, {0, 0xD2, 0, 0}, can::Format::base};
  const Entry entry{base::Time{base::Duration{5}}, frame, 2};
  CHECK(entry.interface == 2);
  CHECK(entry.bytes().size() == 4);
  REQUIRE(entry.classic());
  CHECK(*entry.classic() == frame);
}

TEST_CASE("an entry of which nothing is said is of a frame without identifier and data") {
  const Entry none;
  CHECK(none == Entry{{}, can::Frame{}, 0});
  CHECK(none.id == 0);
  CHECK(none.interface == 0);
  CHECK(none.length == 0);
  CHECK(none.flags == 0);
  CHECK(none.raw_dlc == 0);
  for (std::size_t i = 0; i < 8; ++i) CHECK(none.data[i] == 0);
  CHECK(Entry{{}, can::Frame{}}.interface == 0);
  CHECK(Entry{{}, can::AnyFrame{}}.interface == 0);
}

TEST_CASE("an entry of a frame of either kind is that frame again") {
  can::AnyFrame frame;
  frame.id = 0x1F334455;
  frame.format = can::Format::extended;
  frame.length = 12;
  frame.flags = can::frame_flag::fd | can::frame_flag::bit_rate_switch;
  frame.data[11] = 0xAB;
  const log::Entry entry{base::Time{base::Duration{5}}, frame, 3};
  CHECK(entry.time == base::Time{base::Duration{5}});
  CHECK(entry.interface == 3);
  CHECK(entry.is_fd());
  CHECK(entry.frame() == frame);
  const can::Frame classic{0x205, 2, {1, 2}};
  CHECK(log::Entry{{}, classic}.frame() == can::AnyFrame{classic});
  // What lies behind the data, and flags that a bus does not have, stay in the log.
  log::Entry odd{{}, classic};
  odd.data[40] = 0xFF;
  odd.flags = 0xF8;
  CHECK(odd.frame() == can::AnyFrame{classic});
}

TEST_CASE("a CAN FD entry is no classic frame; a remote one has no bytes") {
  Entry entry;
  entry.flags = log::flag::fd;
  CHECK(entry.is_fd());
  CHECK_FALSE(entry.classic());
  Entry remote;
  remote.format = can::Format::base_remote;
  remote.length = 8;
  CHECK(remote.bytes().empty());
  CHECK(remote.classic()->dlc == 8);
}

TEST_CASE("entries differ in each member, and not in what lies behind their length") {
  Entry a{base::Time{}, can::Frame{0x10, 2, {1, 2}}};
  Entry b = a;
  a.data[20] = 1;
  b.data[20] = 2;
  CHECK(a == b);
  const auto differs = [&a](auto change) {
    Entry other = a;
    change(other);
    return !(other == a);
  };
  CHECK(differs([](Entry& e) { e.time += base::Duration{1}; }));
  CHECK(differs([](Entry& e) { e.id = 1; }));
  CHECK(differs([](Entry& e) { e.interface = 1; }));
  CHECK(differs([](Entry& e) { e.format = can::Format::extended; }));
  CHECK(differs([](Entry& e) { e.length = 1; }));
  CHECK(differs([](Entry& e) { e.flags = log::flag::fd; }));
  CHECK(differs([](Entry& e) { e.raw_dlc = 9; }));
  CHECK(differs([](Entry& e) { e.direction = log::Direction::sent; }));
  CHECK(differs([](Entry& e) { e.data[1] = 9; }));
}

// The length codes of CAN FD. [ISO 11898-1:2015, table 5]
static_assert(log::fd_length(8) == 8 && log::fd_length(9) == 12 && log::fd_length(12) == 24 &&
              log::fd_length(13) == 32 && log::fd_length(14) == 48 && log::fd_length(15) == 64 &&
              log::fd_length(99) == 64);
static_assert(log::fd_dlc(0) == 0 && log::fd_dlc(8) == 8 && log::fd_dlc(9) == 9 && log::fd_dlc(13) == 10 &&
              log::fd_dlc(33) == 14 && log::fd_dlc(64) == 15);

TEST_CASE("lengths of CAN FD are those that a length code has") {
  for (std::size_t length = 0; length <= 70; ++length)
    CHECK(log::is_fd_length(length) == (length <= 64 && log::fd_length(log::fd_dlc(length)) == length));
}

}  // namespace log_entry_test
