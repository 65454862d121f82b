#include "ocm/transport/virtual_bus_protocol.hpp"

#include <fstream>

#include <catch2/catch.hpp>

#include "unit/transport/virtual_bus_setup.hpp"

namespace transport_virtual_bus_protocol_test {

using namespace ocm;
using namespace ocm::test;

static_assert(sizeof(vb::Hello) == vb::record_size);
static_assert(sizeof(vb::FrameRecord) == vb::record_size);
static_assert(sizeof(vb::Count) == vb::record_size);
static_assert(sizeof(vb::FilterRecord) == vb::record_size);
static_assert(sizeof(vb::Goodbye) == vb::record_size);

constexpr can::Frame request{.id = 0x205, .dlc = 4, .data = {0x01, 0x84, 0x03, 0x02}};
static_assert(*vb::decode(vb::from_record<vb::FrameRecord>(vb::to_record(request))) == request);
static_assert(vb::type_of(vb::to_record(request)) == vb::Type::frame);

constexpr vb::Reason reason(vb::FrameRecord record) {
  return vb::decode(record).error.reason;
}
static_assert(reason({.dlc = 200}) == vb::Reason::bad_dlc);
static_assert(reason({.id = 0x800}) == vb::Reason::bad_identifier);
static_assert(reason({.format = 1, .id = 0x2000'0000}) == vb::Reason::bad_identifier);
static_assert(reason({.format = 5}) == vb::Reason::bad_format);
static_assert(vb::decode({.dlc = 200}).error.detail == 200);

// What lies behind the data is no part of a frame, and a remote frame has none.
static_assert(*vb::decode({.dlc = 1, .data = {1, 2, 3}}) == can::Frame{.dlc = 1, .data = {1}});
static_assert(*vb::decode({.format = 2, .dlc = 3, .data = {1, 2, 3}}) ==
              can::Frame{.dlc = 3, .format = can::Format::base_remote});

static_assert(sizeof(vb::FdFrameRecord) == vb::record_size);
static_assert(sizeof(vb::FdDataRecord) == vb::record_size);

std::string hex(const vb::Record& record) {
  std::string text;
  for (const std::byte byte : record) {
    constexpr std::string_view digits = "0123456789ABCDEF";
    text += digits[static_cast<std::size_t>(byte) / 16];
    text += digits[static_cast<std::size_t>(byte) % 16];
  }
  return text;
}

TEST_CASE("records are those of docs/virtual-bus.md, byte by byte") {
  // Numbers of a machine that writes the low byte first; what is not used is zero.
  const auto padded = [](std::string bytes) { return bytes + std::string(64 - bytes.size(), '0'); };
  CHECK(hex(vb::to_record(vb::Hello{})) == padded("01000000626F636D01000000"));  // "bocm"
  CHECK(hex(vb::to_record(vb::Hello{.fd = 4, .bit_rate = 500'000, .credit = 16, .name = {'s', 'i', 'm'}})) ==
        padded("01040000626F636D0100000020A107001000000073696D"));
  CHECK(hex(vb::to_record(can::Frame{0x205, 4, {1, 0x84, 3, 2}}, base::Time{base::Duration{0x1122}})) ==
        padded("02000400050200002211000000000000"
               "01840302"));
  CHECK(hex(vb::to_record(can::Frame{.id = 0x1F334455, .dlc = 2, .format = can::Format::extended_remote})) ==
        padded("020302005544331F"));
  CHECK(hex(vb::to_record(vb::Count{.type = vb::Type::credit, .count = 0x0102})) ==
        padded("03000000000000000201"));
  CHECK(hex(vb::to_record(vb::Count{.type = vb::Type::overrun, .count = 7})) == padded("040000000000000007"));
  CHECK(hex(vb::to_record(vb::Count{.type = vb::Type::filters, .count = 2})) == padded("050000000000000002"));
  CHECK(hex(vb::to_record(vb::FilterRecord{.id = 0x600, .mask = 0x7F0})) ==
        padded("0600000000060000F0070000"));
  CHECK(hex(vb::to_record(vb::Goodbye{})) == padded("0700000001000000"));
  CHECK(hex(vb::to_record(vb::Goodbye{.reason = vb::Reason::torn_fd_frame, .detail = 0x99})) ==
        padded("070F00000100000099"));
  // 20 bytes of CAN FD with bit-rate switch: 16 of them in the first record.
  const auto records = vb::to_fd_records(any("123##1" + std::string(32, 'A') + std::string(8, 'B')),
                                         base::Time{base::Duration{5}});
  REQUIRE(records.all().size() == 2);
  CHECK(hex(records.records[0]) ==
        "08001405"
        "23010000"
        "0500000000000000" +
            std::string(32, 'A'));
  CHECK(hex(records.records[1]) == padded("0900000000000000" + std::string(8, 'B')));
  CHECK(hex(vb::to_record(vb::FrameRecord{})) == padded("02"));
  CHECK(hex(vb::to_record(vb::FdFrameRecord{})) == padded("08"));
  CHECK(hex(vb::to_record(vb::FdDataRecord{})) == padded("09"));
  CHECK(hex(vb::to_record(vb::FilterRecord{})) == padded("06"));
  CHECK(hex(vb::to_record(vb::Count{})) == padded(""));
  CHECK(vb::max_message == 4096);
  CHECK(vb::max_filters == 512);
}

TEST_CASE("one assembly takes one frame after the other, and none keeps what was another's") {
  vb::FdAssembly assembly;
  const auto take = [&](const can::AnyFrame& frame) {
    bool whole = false;
    const auto records = vb::to_fd_records(frame);
    for (const auto& record : records.all()) {
      const auto taken = assembly.take(record);
      REQUIRE(taken);
      whole = *taken;
    }
    CHECK(whole);
    return assembly.frame();
  };
  for (const char* text : {"1F334455##3", "123##0", "001##1AA"}) CHECK(take(any(text)) == any(text));
  const can::AnyFrame longest = any("7FF##1" + std::string(128, 'C'));
  CHECK(take(longest) == longest);
  CHECK(take(any("001##1AA")) == any("001##1AA"));
  // Records with bytes behind the data, as another program may leave them.
  vb::FdFrameRecord first{.length = 20, .flags = 4, .id = 2};
  first.data.fill(0x11);
  vb::FdDataRecord rest;
  rest.data.fill(0x22);
  CHECK_FALSE(*assembly.take(vb::to_record(first)));
  CHECK(*assembly.take(vb::to_record(rest)));
  CHECK(assembly.frame() == any("002##0" + std::string(32, '1') + std::string(8, '2')));
  CHECK(assembly.take(vb::to_record(rest)).error ==
        vb::Goodbye{.reason = vb::Reason::torn_fd_frame, .detail = 9});
  CHECK(assembly.take(vb::to_record(vb::Count{.type = vb::Type::credit})).error ==
        vb::Goodbye{.reason = vb::Reason::torn_fd_frame, .detail = 3});
}

TEST_CASE("a classic frame at every bound of its record") {
  const auto error_of = [](const vb::FrameRecord& record) {
    const auto frame = vb::decode(record);
    REQUIRE_FALSE(frame);
    return frame.error;
  };
  CHECK(error_of({.dlc = 9}) == vb::Goodbye{.reason = vb::Reason::bad_dlc, .detail = 9});
  CHECK(error_of({.format = 5}) == vb::Goodbye{.reason = vb::Reason::bad_format, .detail = 5});
  CHECK(error_of({.id = 0x800}) == vb::Goodbye{.reason = vb::Reason::bad_identifier, .detail = 0x800});
  CHECK(*vb::decode({.dlc = 8, .id = 0x7FF, .data = {1, 2, 3, 4, 5, 6, 7, 8}}) ==
        can::Frame{0x7FF, 8, {1, 2, 3, 4, 5, 6, 7, 8}});
  CHECK(vb::decode({.format = 4, .dlc = 8, .id = 4})->format == can::Format::error);
  CHECK(vb::decode({.format = 1, .id = 0x1FFF'FFFF})->id == 0x1FFF'FFFF);
}

TEST_CASE("a CAN FD frame of any length goes through its records, and takes no more of them than it needs") {
  for (unsigned dlc = 0; dlc < 16; ++dlc) {
    can::AnyFrame frame = any("1F334455##3");
    frame.length = can::fd_length(dlc);
    for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = static_cast<std::uint8_t>(i + 1);
    const auto records = vb::to_fd_records(frame, base::Time{base::Duration{42}});
    CHECK(records.count == (frame.length <= 16 ? 1U : frame.length <= 32 ? 2U : 3U));
    vb::FdAssembly assembly;
    for (std::size_t i = 0; i < records.count; ++i) {
      const auto whole = assembly.take(records.records[i]);
      REQUIRE(whole);
      CHECK(*whole == (i + 1 == records.count));
      CHECK(assembly.waits() == !*whole);
    }
    CHECK(assembly.frame() == frame);
    CHECK(assembly.time() == base::Time{base::Duration{42}});
  }
}

TEST_CASE("records that are no CAN FD frame") {
  const auto reason_of = [](const vb::FdFrameRecord& record) {
    vb::FdAssembly assembly;
    const auto whole = assembly.take(vb::to_record(record));
    REQUIRE_FALSE(whole);
    CHECK_FALSE(assembly.waits());
    return whole.error.reason;
  };
  CHECK(reason_of({.format = 2, .flags = 4}) == vb::Reason::bad_format);
  CHECK(reason_of({.format = 4, .flags = 4}) == vb::Reason::bad_format);
  CHECK(reason_of({.length = 9, .flags = 4}) == vb::Reason::bad_fd_length);
  CHECK(reason_of({.length = 65, .flags = 4}) == vb::Reason::bad_fd_length);
  CHECK(reason_of({.flags = 0}) == vb::Reason::bad_fd_flags);
  CHECK(reason_of({.flags = 0x0C}) == vb::Reason::bad_fd_flags);
  CHECK(reason_of({.flags = 4, .id = 0x800}) == vb::Reason::bad_identifier);
  vb::FdAssembly assembly;
  CHECK(assembly.take(vb::to_record(vb::FdDataRecord{})).error.reason == vb::Reason::torn_fd_frame);
  const auto records = vb::to_fd_records(any("123##1" + std::string(128, 'A')));
  REQUIRE(assembly.take(records.records[0]));
  CHECK(assembly.waits());
  CHECK(assembly.take(records.records[0]).error.reason == vb::Reason::torn_fd_frame);
  // What lies behind the data is no part of a frame.
  vb::FdAssembly other;
  REQUIRE(
      other.take(vb::to_record(vb::FdFrameRecord{.length = 1, .flags = 5, .id = 1, .data = {0xAA, 0xBB}})));
  CHECK(other.frame() == any("001##1AA"));
}

TEST_CASE("the socket lies in the user's runtime directory, or else in one in /tmp") {
  const TemporaryDirectory directory;
  const std::string fallback = "/tmp/ocm-" + std::to_string(::geteuid()) + "/sim.sock";
  {
    const Environment set{"XDG_RUNTIME_DIR", directory.path().c_str()};
    CHECK(vb::default_path() == directory.path() + "/ocm/sim.sock");
  }
  for (const char* value :
       {static_cast<const char*>(nullptr), "", "relative", "/nowhere/at/all", "/dev/null"}) {
    const Environment set{"XDG_RUNTIME_DIR", value};
    CHECK(vb::default_path() == fallback);
  }
}

TEST_CASE("every reason has words of its own") {
  std::vector<std::string> words;
  for (unsigned i = 0; i <= static_cast<unsigned>(vb::Reason::torn_fd_frame); ++i)
    words.push_back(vb::describe({.reason = static_cast<vb::Reason>(i), .detail = 200}));
  CHECK(words[static_cast<unsigned>(vb::Reason::bad_dlc)] == "it sent a frame with DLC 200; at most 8");
  CHECK_THAT(words[static_cast<unsigned>(vb::Reason::bad_identifier)], Catch::Contains("0x000000C8"));
  std::sort(words.begin(), words.end());
  CHECK(std::unique(words.begin(), words.end()) == words.end());
  CHECK(vb::describe({.reason = static_cast<vb::Reason>(99)}) == "reason 99");
}

TEST_CASE("what a client did is said in words, with its number") {
  const auto words = [](vb::Reason reason) { return vb::describe({.reason = reason, .detail = 200}); };
  using vb::Reason;
  CHECK(words(Reason::leaving) == "it left");
  CHECK(words(Reason::ended) == "the simulator was ended");
  CHECK(words(Reason::full) == "the simulator has no file descriptor left for it");
  CHECK(words(Reason::other_user) == "it belongs to another user (uid 200)");
  CHECK(words(Reason::bad_version) == "it speaks another version (200) of the virtual bus's protocol");
  CHECK(words(Reason::no_hello) == "it began with a record of type 200 and not with a greeting");
  CHECK(words(Reason::bad_size) ==
        "it sent a message of 200 bytes; records have 32, and at most 128 go together");
  CHECK(words(Reason::unknown_record) == "it sent a record of unknown type 200");
  CHECK(words(Reason::bad_format) == "it sent a frame of format 200, which is none for the wire");
  CHECK(words(Reason::bad_identifier) ==
        "it sent a frame with identifier 0x000000C8, too wide for its format");
  CHECK(words(Reason::no_credit) == "it sent more frames than its transmit queue has room for");
  CHECK(words(Reason::bad_filters) == "it sent filters that it had not announced, or more than 512 (200)");
  CHECK(words(Reason::bad_fd_length) ==
        "it sent a CAN FD frame of 200 bytes, a length that such frames do not have");
  CHECK(words(Reason::bad_fd_flags) == "it sent a CAN FD frame with flags 200");
  CHECK(words(Reason::torn_fd_frame) == "it sent a part of a CAN FD frame alone (a record of type 200)");
}

TEST_CASE("a CAN FD frame that is refused says its reason, and the number that is wrong") {
  const auto refused = [](const vb::FdFrameRecord& record) {
    vb::FdAssembly assembly;
    return assembly.take(vb::to_record(record)).error;
  };
  CHECK(refused({.format = 2, .flags = 4}) == vb::Goodbye{.reason = vb::Reason::bad_format, .detail = 2});
  CHECK(refused({.length = 9, .flags = 4}) == vb::Goodbye{.reason = vb::Reason::bad_fd_length, .detail = 9});
  CHECK(refused({.flags = 12}) == vb::Goodbye{.reason = vb::Reason::bad_fd_flags, .detail = 12});
  CHECK(refused({.flags = 3}) == vb::Goodbye{.reason = vb::Reason::bad_fd_flags, .detail = 3});
  CHECK(refused({.flags = 4, .id = 0x801}) ==
        vb::Goodbye{.reason = vb::Reason::bad_identifier, .detail = 0x801});
  CHECK(refused({.format = 1, .length = 12, .flags = 7, .id = 0x1FFF'FFFF}) == vb::Goodbye{});
}

TEST_CASE("the rest of a CAN FD frame lies behind what was there, record by record") {
  vb::FdFrameRecord first{.length = 48, .flags = 4, .id = 2};
  for (std::size_t i = 0; i < 16; ++i) first.data[i] = static_cast<std::uint8_t>(1 + i);
  vb::FdDataRecord second;
  for (std::size_t i = 0; i < 24; ++i) second.data[i] = static_cast<std::uint8_t>(17 + i);
  vb::FdDataRecord third;
  for (std::size_t i = 0; i < 24; ++i) third.data[i] = static_cast<std::uint8_t>(41 + i);
  vb::FdAssembly assembly;
  CHECK_FALSE(*assembly.take(vb::to_record(first)));
  CHECK_FALSE(*assembly.take(vb::to_record(second)));
  CHECK(*assembly.take(vb::to_record(third)));
  for (std::size_t i = 0; i < 48; ++i) CHECK(assembly.frame().data[i] == i + 1);
  CHECK(assembly.frame().data[48] == 0);  // the third record has more
}

}  // namespace transport_virtual_bus_protocol_test
