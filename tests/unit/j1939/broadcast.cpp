// The frames of a broadcast: typed by hand from SAE J1939-21, and put together again by the listener.
#include "ocm/j1939/broadcast.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <catch2/catch.hpp>

namespace j1939_broadcast_test {

using namespace ocm::j1939;
using namespace std::chrono_literals;
using Data = std::array<std::uint8_t, 8>;

constexpr Identifier message{3, 0xFECA, global_address, 0x2A};
constexpr std::array<std::uint8_t, 16> bytes{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

// Announced with 16 bytes in 3 packets; 7 of priority, whatever the message has. [5.10.3.5]
static_assert(broadcast_frame(message, bytes, 0).id == 0x1CEC'FF2A);
static_assert(broadcast_frame(message, bytes, 0).data == Data{32, 16, 0, 3, 0xFF, 0xCA, 0xFE, 0x00});
static_assert(broadcast_frame(message, bytes, 1).id == 0x1CEB'FF2A);
static_assert(broadcast_frame(message, bytes, 1).data == Data{1, 1, 2, 3, 4, 5, 6, 7});
static_assert(broadcast_frame(message, bytes, 2).data == Data{2, 8, 9, 10, 11, 12, 13, 14});
static_assert(broadcast_frame(message, bytes, 3).data == Data{3, 15, 16, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF});
// A group that goes to one address is announced with its number alone, to all.
static_assert(broadcast_frame({6, 0x1'EF00, 0x21, 0x80}, bytes, 0).id == 0x1CEC'FF80);
static_assert(broadcast_frame({6, 0x1'EF00, 0x21, 0x80}, bytes, 0).data ==
              Data{32, 16, 0, 3, 0xFF, 0x00, 0xEF, 0x01});

static_assert(broadcast_frames(9) == 3 && broadcast_frames(14) == 3 && broadcast_frames(15) == 4);
static_assert(broadcast_frames(most_transported) == 256);
static_assert(broadcast_time(9) == 150ms);
static_assert(broadcast_distance >= 50ms && broadcast_distance <= 200ms);  // [5.10.2.1]

TEST_CASE("broadcasts of every size come out as they went in") {
  Transport<1> listener;
  ocm::base::Time now{1s};
  for (std::size_t size = least_transported; size <= most_transported; ++size) {
    std::vector<std::uint8_t> data(size);
    for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(i * 31 + size);
    for (std::uint32_t i = 0; i < broadcast_frames(size); ++i) {
      const auto frame = broadcast_frame(message, data, i);
      const auto heard = listener.take(frame.id, frame.data, now += broadcast_distance);
      const bool last = i + 1 == broadcast_frames(size);
      if (heard != (i == 0 ? Heard::control : last ? Heard::message : Heard::packet))
        FAIL("frame " << i << " of " << size << " bytes");
    }
    const auto& out = listener.message();
    REQUIRE(std::equal(out.data.begin(), out.data.end(), data.begin(), data.end()));
    REQUIRE((out.id.pgn == message.pgn && out.id.source == message.source));
  }
  CHECK(listener.counters().complete == most_transported - least_transported + 1);
  CHECK(listener.counters().lost() == 0);
}

}  // namespace j1939_broadcast_test
