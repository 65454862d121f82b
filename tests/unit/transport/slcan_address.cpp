#include "ocm/transport/slcan_address.hpp"

#include <catch2/catch.hpp>

namespace transport_slcan_address_test {

using namespace ocm;
using Catch::Matchers::Contains;
using transport::parse_slcan_address;

TEST_CASE("slcan address: device, bit rate, speed of the line") {
  const auto address = parse_slcan_address("/dev/ttyACM0@250k,57600");
  REQUIRE(address);
  CHECK(address->path == "/dev/ttyACM0");
  CHECK(address->options.bit_rate == 250'000);
  CHECK(address->options.baud == 57'600);
  CHECK(parse_slcan_address("/dev/ttyACM0")->options.bit_rate == 500'000);
  CHECK(parse_slcan_address("/dev/ttyACM0@1M")->options.bit_rate == 1'000'000);
  CHECK(parse_slcan_address("/dev/ttyACM0@125000")->options.bit_rate == 125'000);
  CHECK(parse_slcan_address("/tmp/a@b/tty@10k")->path == "/tmp/a@b/tty");

  const auto refused = [](std::string_view name) {
    const auto wrong = parse_slcan_address(name);
    REQUIRE_FALSE(wrong);
    return wrong.error.what + " | " + wrong.error.remedy;
  };
  CHECK_THAT(refused(""), Contains("names no device"));
  CHECK_THAT(refused("@500k"), Contains("names no device"));
  CHECK_THAT(refused("/dev/x@"), Contains("is not a bit rate"));
  CHECK_THAT(refused("/dev/x@fast"), Contains("'fast'") && Contains("slcan:/dev/ttyACM0@500k"));
  CHECK_THAT(refused("/dev/x@99999999999k"), Contains("is not a bit rate"));
  CHECK_THAT(refused("/dev/x@83333"), Contains("nearest is 100k") && Contains("10k, 20k, 50k, 100k, 125k"));
  CHECK_THAT(refused("/dev/x@500k,"), Contains("is not a speed"));
  CHECK_THAT(refused("/dev/x@500k,110000"), Contains("nearest is 115200"));
}

}  // namespace transport_slcan_address_test
