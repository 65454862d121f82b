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

TEST_CASE("slcan address: every bit rate, as it may be written, and the nearest of one that is none") {
  for (const std::uint32_t rate : can::slcan::bit_rates) {
    for (const std::string& text : {std::to_string(rate), transport::detail::rate_text(rate)}) {
      CAPTURE(text);
      const auto address = parse_slcan_address("/dev/x@" + text + ",9600");
      REQUIRE(address);
      CHECK(address->options.bit_rate == rate);
      CHECK(address->options.baud == 9600);
    }
  }
  CHECK(parse_slcan_address("/dev/x@500K")->options.bit_rate == 500'000);
  CHECK(parse_slcan_address("/dev/x@1M,4M")->options.baud == 4'000'000);
  CHECK(transport::detail::rate_text(83'333) == "83333");
  CHECK(transport::detail::rate_text(83'000) == "83k");
  CHECK(transport::detail::rate_text(2'000'000) == "2M");

  const auto refused = [](std::string_view name) {
    const auto wrong = parse_slcan_address(name);
    REQUIRE_FALSE(wrong);
    return wrong.error.what + " | " + wrong.error.remedy;
  };
  const std::string form = " | write slcan:/dev/ttyACM0@500k, or slcan:/dev/ttyUSB0@500k,57600";
  const std::string only = ": only 10k, 20k, 50k, 100k, 125k, 250k, 500k, 800k, 1M | the nearest is ";
  const std::string all = "; every node of a bus has the same, and the robot's is 500k";
  CHECK(refused("/dev/x@0") == "'0' in 'slcan:/dev/x@0' is not a bit rate" + form);
  CHECK(refused("/dev/x@k") == "'k' in 'slcan:/dev/x@k' is not a bit rate" + form);
  CHECK(refused("/dev/x@4295M") == "'4295M' in 'slcan:/dev/x@4295M' is not a bit rate" + form);
  CHECK(refused("/dev/x@4294M") == "an SLCAN adapter has no bit rate 4294M" + only + "1M" + all);
  CHECK(refused("/dev/x@4294967295") == "an SLCAN adapter has no bit rate 4294967295" + only + "1M" + all);
  CHECK(refused("/dev/x@4294967296") == "'4294967296' in 'slcan:/dev/x@4294967296' is not a bit rate" + form);
  CHECK(refused("/dev/x@1") == "an SLCAN adapter has no bit rate 1" + only + "10k" + all);
  CHECK(refused("/dev/x@500k,fast") ==
        "'fast' in 'slcan:/dev/x@500k,fast' is not a speed of a serial line" + form);
  CHECK(refused("/dev/x@500k,9601") ==
        "a serial line has no speed 9601 here | the nearest is 9600; USB adapters mostly ignore it");
}

TEST_CASE("slcan address: what is not chosen is that of most adapters") {
  using namespace std::chrono_literals;
  const transport::SlcanOptions options = parse_slcan_address("/dev/x")->options;
  CHECK(options.bit_rate == 500'000);
  CHECK(options.baud == 115'200);
  CHECK(options.window == 8);
  CHECK(options.first_answer == 1s);
  CHECK(options.patience == 300ms);
  CHECK(options.answer_limit == 500ms);
  CHECK(options.status_period == 1s);
  CHECK(options.farewell == 300ms);
}

}  // namespace transport_slcan_address_test
