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

}  // namespace transport_virtual_bus_protocol_test
