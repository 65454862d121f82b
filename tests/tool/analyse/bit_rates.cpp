// Which bit rates hold for a set: those that are given, its own, or what is usual.
#include <cstdint>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "cli/analyse/study.hpp"
#include "cli/shared/messages.hpp"
#include "tests/tool/captured.hpp"

namespace tool_analyse_bit_rates_test {

using namespace ocm;
using namespace ocm::cli::analyse;

using Rates = std::pair<std::int64_t, std::int64_t>;

Rates held(const BusSet& set, const BusOptions& options) {
  const BusOptions at = at_rates_of(set, options);
  return {at.bit_rate, at.data_bit_rate};
}
/// What is said as it is refused.
std::string refused(const BusSet& set, const BusOptions& options) {
  const auto left = test::leaving([&] { static_cast<void>(at_rates_of(set, options)); });
  CHECK(left.code == cli::exit_usage);
  return left.text;
}

TEST_CASE("bit rates: what is given goes before what the set says, and that before what is usual",
          "[shared]") {
  BusSet set;
  BusOptions options;
  options.usual_bit_rate = 100'000;
  CHECK(held(set, options) == Rates{100'000, 0});
  set.bit_rate = 250'000;
  set.data_bit_rate = 1'000'000;
  CHECK(held(set, options) == Rates{250'000, 1'000'000});
  options.bit_rate = 500'000;
  CHECK(held(set, options) == Rates{500'000, 1'000'000});
  options.data_bit_rate = 2'000'000;
  CHECK(held(set, options) == Rates{500'000, 2'000'000});
  options.data_bit_rate = 500'000;  // as fast is enough
  CHECK(held(set, options) == Rates{500'000, 500'000});
}

TEST_CASE("bit rates: there is one, and the data are not slower", "[shared]") {
  const std::string none = refused({}, {});
  CHECK_THAT(none, Catch::Contains("the spec says no bit rate\n"));
  CHECK_THAT(none, Catch::Contains("--bitrate gives it, such as --bitrate 500k\n"));
  BusOptions options;
  options.bit_rate = 500'000;
  options.data_bit_rate = 499'999;
  const std::string slower = refused({}, options);
  CHECK_THAT(slower, Catch::Contains("--data-bitrate: 499999 bit/s is slower than the rest of the frame, 500 "
                                     "kbit/s\n"));
  CHECK_THAT(slower, Catch::Contains("the data of CAN FD are sent at least as fast\n"));
  BusSet set;
  set.bit_rate = 125'000;
  set.data_bit_rate = 499'999;
  options.data_bit_rate = 0;
  const std::string of_set = refused(set, options);
  CHECK_THAT(of_set, Catch::Contains("the data rate of the set: 499999 bit/s is slower than the rest of the "
                                     "frame, 500 kbit/s\n"));
  CHECK_THAT(of_set, Catch::Contains("--data-bitrate gives another one\n"));
  options.bit_rate = 0;
  CHECK(held(set, options) == Rates{125'000, 499'999});
}

}  // namespace tool_analyse_bit_rates_test
