// What programs on one central's line say to each other: a row that is read is written, and read again to the
// same; a request that is taken is within its ranges.
#include <cmath>

#include "cli/fleet/line_request.hpp"
#include "cli/fleet/robot_now.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto text = fuzz::text_of(data, size);
  if (const auto row = cli::fleet::parse_row(text)) {
    fuzz::expect(row->index < cognitive::Fleet::most_robots, "a robot is one of the list");
    fuzz::expect(row->quality_per_mille <= 1000, "a quality is a share");
    fuzz::expect(std::isfinite(row->off_cm) && std::isfinite(row->off_deg), "a distance is a number");
    fuzz::expect(!cli::fleet::state_of(*row).empty(), "a robot is in a state");
    const auto written = cli::fleet::to_row(*row);
    fuzz::expect(written.find('\n') == std::string::npos, "a row is one line");
    const auto again = cli::fleet::parse_row(written);
    fuzz::expect(again && cli::fleet::to_row(*again) == written, "a row reads again to the same");
  }
  if (const auto request = cli::fleet::parse_line_request(text)) {
    fuzz::expect(request->robot < cognitive::Fleet::most_robots, "a request is of a robot of the list");
    fuzz::expect(request->set_point.angle >= -360 && request->set_point.angle <= 360, "a turn either way");
    fuzz::expect(request->time >= base::Duration::zero() && request->time <= std::chrono::minutes{1},
                 "a scan ends");
  }
  return 0;
}
