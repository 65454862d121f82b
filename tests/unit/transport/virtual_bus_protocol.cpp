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

TEST_CASE("a path that no socket can have") {
  CHECK(vb::to_address("/tmp/" + std::string(102, 'x')).ok());
  const auto refused = vb::to_address("/tmp/" + std::string(103, 'x'));
  CHECK_THAT(refused.error.what, Catch::Contains("108 bytes"));
  CHECK_THAT(refused.error.remedy, Catch::Contains("107"));
  CHECK_FALSE(vb::to_address(""));
  CHECK_FALSE(vb::to_address(std::string("a\0b", 3)));
}

TEST_CASE("every reason has words of its own") {
  std::vector<std::string> words;
  for (unsigned i = 0; i <= static_cast<unsigned>(vb::Reason::bad_filters); ++i)
    words.push_back(vb::describe({.reason = static_cast<vb::Reason>(i), .detail = 200}));
  CHECK(words[static_cast<unsigned>(vb::Reason::bad_dlc)] == "it sent a frame with DLC 200; at most 8");
  CHECK_THAT(words[static_cast<unsigned>(vb::Reason::bad_identifier)], Catch::Contains("0x000000C8"));
  std::sort(words.begin(), words.end());
  CHECK(std::unique(words.begin(), words.end()) == words.end());
  CHECK(vb::describe({.reason = static_cast<vb::Reason>(99)}) == "reason 99");
}

}  // namespace transport_virtual_bus_protocol_test
